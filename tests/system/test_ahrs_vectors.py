"""``ahrs_vectors`` in the place of ``ahrs`` in the backup navigator: wired the same, and honest about its errors."""

import numpy as np
import pytest

from fmus.grades import GRADES
from fmus.motion.flight_plans import FLIGHT_PLANS
from navfmu import System
from navfmu.ssp.writer import SystemSource
from system_ssp.backup_navigator import system as backup
from tests import built

SEEDS = range(1, 11)
ANGLES = ("roll", "pitch", "heading")


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """The backup navigator; every input of ``ahrs`` and every angle that is told is where it was, or this fails."""
    for name in (*backup.COMPONENTS, "ahrs_vectors"):
        built.fmu(name, tmp_path_factory)
    source = SystemSource("vectors", fmus=built.folder(tmp_path_factory), stop_time=2100.0, step=0.01)
    for name in backup.COMPONENTS:
        source.component(name, "ahrs_vectors.fmu" if name == "ahrs" else f"{name}.fmu")
    backup.connect(source)
    source.parameters("aircraft", FLIGHT_PLANS["livermore"].parameters())
    source.parameters("imu", GRADES["automotive"])
    backup.use_stations(source.parameters, "thesis_like")
    folder = tmp_path_factory.mktemp("system")
    source.write(folder)
    return System.load(folder)


def test_errors_in_flight_are_within_what_it_says(system):
    """Mean squares of errors over sigmas of ten flights are below 1 with three sigma of their own mean.

    With V' from one sample of the airspeed to the next, gusts are taken for motion, and they are 3 to 9. Errors are
    small, too: a claim of half a turn would be honest as well.
    """
    signals = [f"aircraft.{angle}" for angle in ANGLES] + ["ahrs.attitude"]
    squares, errors = [], []
    for seed in SEEDS:
        run = system.run(seed=seed, record=signals, record_period=1.0)
        known = run["ahrs.attitude.valid"].to_numpy() > 0.0
        assert np.mean(known) > 0.99
        error = np.stack([run[f"ahrs.attitude.{a}"] - run[f"aircraft.{a}"] for a in ANGLES])[:, known]
        error = (error + np.pi) % (2.0 * np.pi) - np.pi
        sigma = np.stack([run[f"ahrs.attitude.{a}_sigma"] for a in ANGLES])[:, known]
        squares.append(np.mean((error / sigma) ** 2, axis=1))
        errors.append(np.degrees(np.sqrt(np.mean(error**2, axis=1))))
    of_mean = np.std(squares, axis=0, ddof=1) / np.sqrt(len(SEEDS))
    assert np.all(np.mean(squares, axis=0) + 3.0 * of_mean < 1.0)
    assert np.all(np.mean(errors, axis=0) < [2.0, 2.0, 6.0])
