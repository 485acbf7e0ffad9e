"""The standard atmosphere up to 20 km against the package ``ambiance``, the hydrostatic equation, and its inverse."""

import ambiance
import numpy as np
import pytest

from models.air import atmosphere

HEIGHTS = np.array([-4000.0, 0.0, 1800.0, 8500.0, 10900.0, 11019.0, 11100.0, 15000.0, 20000.0])
"""Above the sea, m; the tropopause is at 11019 m."""
STANDARD = ambiance.Atmosphere(HEIGHTS)
WIDE = np.linspace(*atmosphere.KNOWN, 51)


def test_geopotential_altitude():
    assert atmosphere.geopotential(HEIGHTS) == pytest.approx(STANDARD.H, abs=1e-6)


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (atmosphere.temperature, STANDARD.temperature),
        (atmosphere.pressure, STANDARD.pressure),
        (lambda h: atmosphere.speed_of_sound(atmosphere.temperature(h)), STANDARD.speed_of_sound),
        (lambda h: atmosphere.density(atmosphere.pressure(h), atmosphere.temperature(h)), STANDARD.density),
        (
            lambda h: atmosphere.viscosity_ratio(atmosphere.temperature(h)),
            STANDARD.dynamic_viscosity / ambiance.Atmosphere(0.0).dynamic_viscosity,
        ),
    ],
)
def test_standard_day(ours, theirs):
    """Where temperature goes on falling above the tropopause, pressure at 20 km is 20 % too low."""
    assert ours(atmosphere.geopotential(HEIGHTS)) == pytest.approx(theirs, rel=2e-6)


@pytest.mark.parametrize("deviation", [-30.0, 0.0, 25.0])
@pytest.mark.parametrize("altitude", [300.0, 10990.0, 11010.0, 17000.0])
def test_air_is_at_rest_on_any_day(altitude, deviation):
    """dp/dH = -rho g on both sides of the tropopause; the standard scale height above it is 11 % off at -30 K."""
    below, above = (atmosphere.pressure(altitude + d, deviation, 99000.0) for d in (-1.0, 1.0))
    here = atmosphere.pressure(altitude, deviation, 99000.0)
    density = here / (287.05287 * atmosphere.temperature(altitude, deviation))
    assert (above - below) / 2.0 == pytest.approx(-9.80665 * density, rel=1e-6)


def test_pressure_altitude_is_the_inverse():
    assert atmosphere.pressure_altitude(atmosphere.pressure(WIDE)) == pytest.approx(WIDE, abs=1e-6)
    assert np.all(atmosphere.is_known(WIDE))
    assert not np.any(atmosphere.is_known(np.array([-5001.0, 20001.0, np.nan])))
