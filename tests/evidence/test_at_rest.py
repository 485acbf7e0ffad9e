"""A unit at rest: what is quiet, what is fitted, and that a model which does not fit is called so."""

from __future__ import annotations

import allantools
import numpy as np
import pandas as pd
import pytest

from evidence.sensors import at_rest
from evidence.sensors.rest import COLUMNS, Rest, deviation
from navfmu.system import shipped
from tests.built import fmu

PERIOD = 0.01


def recording(values: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame(values, columns=list(COLUMNS)).assign(time=PERIOD * np.arange(1, len(values) + 1))


def test_deviation_of_one_stretch_is_that_of_allantools_and_of_two_alike_the_same():
    values = np.random.default_rng(2).standard_normal((2000, 3))
    times = np.array([0.01, 0.1, 1.0])
    expected = np.transpose([allantools.oadev(x, 100.0, "freq", times)[1] for x in values.T])
    np.testing.assert_allclose(deviation([values], PERIOD, times), expected, rtol=1e-12)
    np.testing.assert_allclose(deviation([values, values], PERIOD, times), expected, rtol=1e-12)


@pytest.fixture
def built(monkeypatch, tmp_path_factory):
    monkeypatch.setattr(shipped, "path", lambda name: fmu(name.removesuffix(".fmu"), tmp_path_factory))


def white(sigma: float, runs: int = 4) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(3)
    return tuple(sigma * rng.standard_normal((3000, 6)) for _ in range(runs))


def test_the_model_of_white_noise_has_its_sigma_and_lies_in_the_band(built):
    unit = at_rest.Unit(Rest("made", PERIOD, white(0.02)))
    for name in ("gyro", "accelerometer"):
        # 3000 x 4 samples tell sigma to 0.65 %; the fit also has the drift, some three times as much
        assert unit.recorded.parameters[f"{name}_noise_sigma"] == pytest.approx(0.02, rel=0.05)
    assert unit.claim.holds and unit.inside.shape == (len(unit.recorded.times), 6)


def test_either_half_is_held_against_the_model_of_the_other(built, monkeypatch):
    """Every second stretch twice as noisy: the model of the whole hides it, that of the other half does not."""
    monkeypatch.setattr(at_rest, "MODELLED", 20)
    quiet_, loud = white(0.02, 2), white(0.04, 2)
    unit = at_rest.Unit(Rest("made", PERIOD, (quiet_[0], loud[0], quiet_[1], loud[1])))
    one, two = unit.halves
    assert one.recorded.deviation[0, 0] == pytest.approx(0.02, rel=0.05)
    assert one.modelled[:, 0, 0].mean() == pytest.approx(0.04, rel=0.05)
    assert two.modelled[:, 0, 0].mean() == pytest.approx(0.02, rel=0.05)
    assert at_rest.elsewhere(unit).startswith("Of models made of one half of the stretches, the runs contain")
    assert max(one.missed.max(), two.missed.max()) > 1.7


def test_what_the_model_cannot_have_is_called_so(built, monkeypatch):
    """Noise that alternates has a deviation that falls with the time, not with its root."""
    monkeypatch.setattr(at_rest, "MODELLED", 20)
    alternating = tuple(np.diff(x, axis=0) for x in white(0.02))
    unit = at_rest.Unit(Rest("made", PERIOD, alternating))
    assert not unit.claim.holds and "misses" in unit.claim.sentence
    assert at_rest.title(unit, slice(0, 3)).startswith("its model is off")


def test_without_recordings_it_says_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in at_rest.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    assert "thor75" in at_rest.run(tmp_path).left_out
