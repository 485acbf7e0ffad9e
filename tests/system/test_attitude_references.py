"""Attitude references in the place of ``ahrs`` in the backup navigator: wired the same, and honest about errors."""

import numpy as np
import pytest

from fmus.attitude.ahrs import Ahrs
from fmus.attitude.ahrs_velocity import AhrsVelocity
from fmus.attitude.interface import AIRCRAFT
from system_ssp.backup_navigator.system import ATTITUDES, BASE_GRADE
from tests.models.native import interpret

SEEDS = range(1, 11)
ANGLES = ("roll", "pitch", "heading")
SETTLED = 60
LARGEST = {
    "ahrs_euler": (2.0, 2.0, 5.0),
    "ahrs_quaternion": (2.0, 2.0, 5.0),
    "ahrs_velocity": (1.0, 1.0, 2.0),
    "ahrs_vectors": (2.0, 2.0, 6.0),
}
"""Errors of the angles, degrees rms. Twice the airspeed's V r, or none, is a bank of 18 degrees in the turns."""
THESIS = {"ahrs_euler": 20.0, "ahrs_quaternion": 6.0}
"""They do not model what changes of the wind do to the vertical: squares over sigmas are up to this."""
CAUTIOUS = {"ahrs_vectors"}
"""Their sigmas are those of single samples, and too large rather than too small."""


@pytest.mark.parametrize("variant", ATTITUDES)
def test_errors_in_flight_are_small_and_within_what_is_said(load, variant):
    """Mean squares of errors over sigmas of ten flights are 1 or less, but for three sigma of their own mean; of a
    cautious one they are less by that.

    An input or an angle that is wired otherwise than that of ``ahrs`` shows in all of them. With V' from one sample of
    the airspeed to the next, ``ahrs_vectors`` takes gusts for motion, and has 3 to 9. Errors are small, too: a claim
    of half a turn would be honest as well.
    """
    system = load(variant)
    signals = [f"aircraft.{angle}" for angle in ANGLES] + ["ahrs.attitude"]
    squares, errors = [], []
    for seed in SEEDS:
        run = system.run(seed=seed, record=signals, record_period=1.0).iloc[SETTLED:]
        assert run["ahrs.attitude.valid"].all()
        error = np.stack([run[f"ahrs.attitude.{a}"] - run[f"aircraft.{a}"] for a in ANGLES])
        error = (error + np.pi) % (2.0 * np.pi) - np.pi
        sigma = np.stack([run[f"ahrs.attitude.{a}_sigma"] for a in ANGLES])
        squares.append(np.mean((error / sigma) ** 2, axis=1))
        errors.append(np.degrees(np.sqrt(np.mean(error**2, axis=1))))
    of_mean = np.std(squares, axis=0, ddof=1) / np.sqrt(len(SEEDS))
    away = 3.0 if variant in CAUTIOUS else -3.0
    assert np.all(np.mean(squares, axis=0) + away * of_mean < THESIS.get(variant, 1.0))
    assert np.all(np.mean(errors, axis=0) < LARGEST[variant])


@pytest.mark.parametrize("grade", AIRCRAFT)
def test_parameter_sets_are_those_of_units_that_are_flown(load, grade):
    """Of the variant with this unit; only those of the unit that is built in are built in, too."""
    flown = load(None if grade == BASE_GRADE else f"imu_{grade}").values["ahrs"]
    assert flown == AIRCRAFT[grade].values
    for filter_ in (Ahrs, AhrsVelocity):
        assert filter_.parameter_sets[grade] is AIRCRAFT[grade]
        built_in = {name: interpret(filter_).get(name) for name in flown}
        assert (built_in == flown) == (grade == BASE_GRADE)
