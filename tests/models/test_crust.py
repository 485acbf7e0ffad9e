"""How the fields of the ground fall with the height, against potential theory."""

import numpy as np
import pytest
from scipy.special import j0, struve, y0

from models.magnetic import crust


def test_a_random_field_falls_as_its_waves_do():
    """The closed form of the variance, 1 - pi x / 2 (H_0(x) - Y_0(x)), x = 2 h / L; waves of one direction only, whose
    spectrum is 1 / (1 + u^2), would leave 85 % and not 79 % at a tenth of the length."""
    for x in np.geomspace(1e-6, 20.0, 200):
        exact = np.sqrt(1.0 - 0.5 * np.pi * x * (struve(0, x) - y0(x)))
        assert crust.wave_share(0.5 * x * 7e3, 7e3) == pytest.approx(exact, abs=2e-3)
    assert crust.wave_share(0.0, 7e3) == pytest.approx(1.0, abs=1e-12)
    assert crust.wave_share(1e3, 10e3) == pytest.approx(0.7877, abs=1e-3)


def test_its_spectrum_is_that_of_a_correlation_that_falls_exponentially():
    """The waves' own sum, J_0(u d / L), is exp(-d / L) on the ground: as along a flight in the FMU."""
    for d in (0.2, 0.5, 1.0, 2.0):
        waves, parts = crust._waves(200)
        # the shortest waves carry little and turn fast: what a 200 point rule makes of them is below a hundredth
        assert np.sum(parts * j0(waves * d)) == pytest.approx(np.exp(-d), abs=0.01)


def test_a_dipole_falls_with_the_third_power():
    """mu_0 m / (2 pi r^3) above a vertical one, by the field of a small loop of current on its axis."""
    loop = 0.01

    def above(r):
        return loop**2 / (loop**2 + r**2) ** 1.5

    for height in (0.0, 5.0, 30.0, 500.0):
        assert crust.dipole_share(height, 20.0) == pytest.approx(above(20.0 + height) / above(20.0), rel=1e-5)
