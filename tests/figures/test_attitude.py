"""Rows T10 to T12: what the filters do in flights of their FMUs, and verdicts that follow the data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from navfmu.figures import Task, collection
from navfmu.figures.comparison import AGREES, DIFFERS, EXPLAINED
from navfmu_figures.thesis import attitude_flight, t10, t11, t12
from tests import built

ROWS = {row.name: row for row in collection.collection("thesis").rows}


def verdicts(comparisons):
    return [one.verdict for one in comparisons]


@pytest.fixture
def task(tmp_path_factory, tmp_path):
    def made(row):
        return Task(1, tmp_path, {name: built.fmu(name, tmp_path_factory) for name in ROWS[row].fmus})

    return made


def test_tables_are_those_of_the_components():
    """What a row writes out of the thesis, and the parameter sets beside the FMUs."""
    from fmus.attitude.thesis import SETS

    printed = {
        "table_4_2": t10.TABLES["euler"],
        "table_4_4": t12.TABLE,
        "table_4_3_slow": attitude_flight.table(10.0, 1.0),
        "table_4_3_fast": attitude_flight.table(10.0, 10.0),
    }
    for name, values in printed.items():
        assert values == pytest.approx(dict(SETS[name].values)), name


# ---- T10 -------------------------------------------------------------------------------------------------------------


def test_t10_biases_settle_and_gps_is_lost(task):
    """Six flights: GPS tells until 600 s and not after; a bias with the wrong sign would be twice what it was."""
    flights = t10.flown(task("T10"), 0.01, runs=6)
    late = flights.time > 300.0
    assert np.sqrt(np.mean(flights.missing["euler"][:, late] ** 2)) < 0.01
    assert np.sqrt(np.mean(flights.missing["printed"][:, late] ** 2)) > 0.05
    assert np.abs(flights.off[:, 0]).max() < 1.0
    assert np.abs(flights.off[:, -1]).max() > 1.0


def settling(pole, off=1.0, printed=1e5):
    """Biases that settle with a pole, s, and errors after GPS is lost that grow to ``off``, degrees."""
    time = np.arange(5.0, 600.0, t10.EVERY)

    def missing(pole):
        signs = np.ones((2, len(time), 3))
        return np.degrees(t10.NULL_SHIFT) * signs * np.exp(-time / pole)[:, None]

    grown = np.ones((2, 3)) * np.linspace(0.0, off, 61)[:, None, None]
    both = {"euler": missing(pole), "printed": missing(printed)}
    return t10.Flown(time, both, missing(pole)[0], np.moveaxis(grown, 0, 1))


@pytest.mark.parametrize(("pole", "verdict"), [(46.0, DIFFERS), (60.0, AGREES), (80.0, AGREES), (120.0, DIFFERS)])
def test_t10_time_to_settle_is_that_of_the_pole(pole, verdict):
    """5 % are left after three poles."""
    found = t10.settled(dict.fromkeys(t10.DRIFTS, settling(pole)))
    assert found[0].found == pytest.approx(pole * np.log(20.0) / 60.0, abs=t10.EVERY / 60.0)
    assert verdicts(found) == [verdict, EXPLAINED]


def test_t10_what_is_explained_is_a_pole_at_hours():
    assert t10.settled(dict.fromkeys(t10.DRIFTS, settling(60.0, printed=600.0)))[1].verdict == DIFFERS


def test_t10_one_flight_below_the_limit_is_none_of_those_that_are_all_above():
    by_drift = dict(zip(t10.DRIFTS, (settling(60.0, 5.0), settling(60.0, 3.0)), strict=True))
    assert verdicts(t10.coasted(by_drift)) == [DIFFERS, AGREES]
    assert t10.picture(by_drift).startswith(b"\x89PNG")


# ---- T11 -------------------------------------------------------------------------------------------------------------


def test_t11_both_err_alike_and_one_passes_the_vertical(task):
    made = task("T11")
    flights, climbs = t11.side_by_side(made, 2), t11.climbed(made, 2)
    assert verdicts([*t11.accurate(flights), *t11.vertical(climbs)]) == [AGREES] * 4
    assert t11.picture(flights, climbs).startswith(b"\x89PNG")


def test_t11_a_filter_that_is_worse_differs():
    flights = np.ones((2, 2, 2, 3))
    flights[:, 1, 0] = 1.02
    assert verdicts(t11.accurate(flights)) == [DIFFERS, AGREES]


def test_t11_a_quaternion_that_is_thrown_off_differs():
    off = {case: np.full((3, 3601), 0.2) for case in t11.CASES}
    valid = {case: np.ones((3, 3601), bool) for case in t11.CASES}
    assert verdicts(t11.vertical(t11.Climbs(off, valid))) == [AGREES, DIFFERS]
    off["quaternion, scheduled"][1, -1] = 5.0
    valid["Euler angles, computed"][:2, -1] = False
    assert verdicts(t11.vertical(t11.Climbs(off, valid))) == [DIFFERS, AGREES]


# ---- T12 -------------------------------------------------------------------------------------------------------------


def test_t12_gates_close_in_turns_and_aiding_keeps_roll(task):
    flights = t12.flown(task("T12"), "vibrating structure", runs=3)
    by_unit = {"vibrating structure": flights, "fibre optic": replace(flights, off=flights.off)}
    assert verdicts([*t12.gated(by_unit), *t12.kept(by_unit)]) == [AGREES] * 3
    assert flights.rms("compensated") < flights.rms("aided") < flights.rms("open loop")
    assert 0.05 < np.mean(~flights.closed) < 0.5


def walking(spread):
    """Errors of fibre optic gyros that walk, so many times as (4.7), away from Earth's rate."""
    rng, time = np.random.default_rng(3), np.arange(0.5, 1395.0, 0.5)
    walk = 0.2 * np.sqrt(0.05 * time[-1])
    off = {name: np.ones((t12.RUNS, len(time), 3)) for name in t12.FILTERS}
    off["open loop"] = 3.0 + spread * walk * rng.standard_normal((t12.RUNS, len(time), 3))
    here = np.zeros((t12.RUNS, len(time)))
    return t12.Flown(time, off, here > 1.0, here)


@pytest.mark.parametrize(("spread", "verdict"), [(0.5, DIFFERS), (1.0, AGREES), (2.0, DIFFERS)])
def test_t12_the_walk_is_that_of_its_noise(spread, verdict):
    flights = walking(spread)
    assert t12.walked({"fibre optic": flights}).verdict == verdict


def test_t12_gates_that_stay_open_and_aiding_that_does_not_help_differ():
    flights = walking(1.0)
    flights = replace(flights, rate=flights.rate + 0.05, off=dict.fromkeys(t12.FILTERS, flights.off["aided"]))
    by_unit = dict.fromkeys(t12.UNITS, flights)
    assert verdicts([*t12.gated(by_unit), *t12.kept(by_unit)]) == [DIFFERS] * 3
    assert t12.picture(by_unit).startswith(b"\x89PNG")
