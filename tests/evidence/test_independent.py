"""A station's day beside an independent solution: what differs from it is said."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pymap3d

from evidence.sensors import independent, observed


def placed(off: np.ndarray, moving: np.ndarray) -> dict[str, np.ndarray]:
    """Positions that are ``off`` by east, north, up (m), by pymap3d, and velocities."""
    latitude, longitude, altitude = pymap3d.ecef2geodetic(*observed.TRUTH, deg=False)
    place = pymap3d.enu2geodetic(*off.T, latitude, longitude, altitude, deg=False)
    found = {f"fix.{name}": value for name, value in zip(("latitude", "longitude", "altitude"), place, strict=True)}
    return found | {"fix.velocity_n": moving[:, [1, 0, 2]] * [1.0, 1.0, -1.0]}


def test_errors_of_another_size_are_said():
    """12 % more in one axis miss the bound of 10 %, however good the others are."""
    theirs = np.tile([0.6, 0.9, 1.4], (10, 1))
    for scale, holds in ((1.0, True), (1.09, True), (1.12, False), (0.88, False)):
        position, velocity = independent.accurate(placed(theirs * [1.0, scale, 1.0], theirs), lambda name: theirs)
        assert position.holds == holds and velocity.holds
        assert ("otherwise" in position.sentence) != holds
        position, velocity = independent.accurate(placed(theirs, theirs * [1.0, 1.0, scale]), lambda name: theirs)
        assert position.holds and velocity.holds == holds


def test_a_model_that_is_missed_otherwise_is_said():
    columns = [f"ours_{axis}" for axis in "enu"] + ["rms_e", "rms_n", "rms_u"]
    for found, holds in ((1.19, True), (1.21, False)):
        spoilt = pd.DataFrame([[1.0, found, 1.0, 1.0, 1.0, 1.0]], columns=columns, index=["no TGD"])
        assert independent.missed(spoilt, "Each model").holds == holds


def test_ours_stand_beside_theirs_by_name(tmp_path):
    """Not by order: the file has them in another one, and more of them."""
    known = pd.DataFrame({"variant": ["b", "c", "a"], "rms_e": [2, 3, 1], "rms_n": [5, 6, 4], "rms_u": [8, 9, 7]})
    known.to_csv(tmp_path / "esbc1770_ablation.csv")
    off = np.array([[3.0, 0.0, 1.0], [4.0, 0.0, -1.0]])
    found = independent.Independent(tmp_path).beside({"a": off, "b": 2.0 * off})
    np.testing.assert_allclose(found.loc["a"], [np.sqrt(12.5), 0.0, 1.0, 1.0, 4.0, 7.0])
    np.testing.assert_allclose(found.loc["b"], [np.sqrt(50.0), 0.0, 2.0, 2.0, 5.0, 8.0])


def test_a_wrong_satellite_or_an_alarm_is_no_finding():
    cases = pd.DataFrame(
        {
            "bias_m": [0.0, 30.0, 100.0],
            "excluded_prn": [np.nan, 5.0, 5.0],
            "ours_excluded": [0.0, 5.0, 5.0],
            "alarm": [0, 0, 0],
        }
    )
    holds = partial(independent.discovered, what="Biases")
    assert holds(cases).holds
    for wrong in ({"ours_excluded": [0.0, 5.0, 7.0]}, {"ours_excluded": [2.0, 5.0, 5.0]}, {"alarm": [0, 1, 0]}):
        assert not holds(cases.assign(**wrong)).holds


def test_levels_are_those_of_their_epochs():
    """Errors 3 m east and 4 m north are 5 m; rows in another order than told would be seen."""
    found = placed(np.array([[9.0, 9.0, 9.0], [3.0, 4.0, -2.0]]), np.zeros((2, 3)))
    found |= {"horizontal_protection": np.array([1.0, 2.0]), "vertical_protection": np.array([3.0, 4.0])}
    level = independent.levels(found, np.array([1]), pd.DataFrame({"tow_s": [30.0]}))
    assert (level["ours"][0], level["ours_vertical"][0]) == (2.0, 4.0)
    np.testing.assert_allclose([level["off"][0], level["off_vertical"][0]], [5.0, 2.0], atol=1e-6)


def test_protection_levels_that_differ_are_said():
    levels = pd.DataFrame({"ours": [10.0], "hpl": [10.0], "ours_vertical": [20.0], "vpl": [20.0]})
    pairs = {"ours": "hpl", "ours_vertical": "vpl"}
    assert independent.protected(levels, pairs).holds
    assert not independent.protected(levels.assign(ours=10.1), pairs).holds
    assert not independent.protected(levels.assign(vpl=20.1), pairs).holds
