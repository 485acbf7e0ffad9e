"""Flights past a jammer: the budget beside the FMUs on a made track, and what the claims say when it is otherwise."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from evidence import jammed_flights
from evidence.jammed_flights import Flight, Run
from evidence.recorded.link import Jammer, Link
from models.satellite import slots
from tests.models.receiving import PLACE, QUIET, Receiving

EARTH = 6.371e6


def test_without_data_it_is_left_out_with_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in jammed_flights.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    assert jammed_flights.run(tmp_path).left_out.endswith("has no dme_stations.csv")


@pytest.mark.parametrize("hour", [1, 9])
def test_the_budget_foretells_each_satellite_of_each_second(tmp_path, hour):
    """Three minutes at 300 m/s to the north past a jammer, weaving by 25 degrees of bank: loss, and finding 20 s later.
    A budget without banks, or with one way of the antenna, would differ for half of the seconds."""
    time = np.arange(1.0, 181.0)
    north = 300.0 * (time - 60.0)
    truth = {
        "latitude": PLACE["latitude"] + north / EARTH,
        "longitude": np.full(len(time), PLACE["longitude"]),
        "altitude": np.full(len(time), PLACE["altitude"]),
        "roll": np.radians(25.0) * np.sin(0.2 * time),
        "pitch": np.full(len(time), 0.05),
        "heading": np.full(len(time), 0.1),
    }
    jammer = Jammer(PLACE["latitude"], PLACE["longitude"] + 4e3 / EARTH / np.cos(PLACE["latitude"]), 300.0, 0.2)
    begins = 3600.0 * hour
    where = {f"jammer_{name}": getattr(jammer, name) for name in ("latitude", "longitude", "altitude")}
    found = Receiving(tmp_path).run(
        len(time),
        lambda t: {**{name: x[int(t)] for name, x in truth.items()}, "jammer_power": [jammer.power, 0.0, 0.0, 0.0]},
        **QUIET,
        **where,
        start_seconds=begins,
    )
    link = Link.of(truth, slots.EPOCH[0], begins + 1.0, jammer)
    satellites = link.tracked.sum(axis=1)
    assert np.mean(found["satellites"] == satellites) > 0.98
    assert np.mean((found["fix.valid"] > 0.0) == link.fix) > 0.98
    assert np.min(satellites) < 4 < np.max(satellites)


def test_the_jammer_stands_to_the_right_of_the_middle():
    track = {"latitude": np.array([0.7, 0.701, 0.702]), "longitude": np.full(3, 0.1), "altitude": np.array([9.0, 1, 5])}
    jammer = jammed_flights.beside(track)
    assert jammer.longitude - 0.1 == pytest.approx(5e3 / (6.39e6 * np.cos(0.701)), rel=0.01)
    assert jammer.latitude == pytest.approx(0.701, abs=1e-5) and jammer.altitude == 1.0


def made(foretold=None, error=100.0, sigma=70.7, consistent=1.0, back=5.0):
    """Runs of one flight of 400 s, without GPS from 100 to 200 s, flying away from the jammer by 100 m/s."""
    time = np.arange(400)
    fix = (time < 100) | (time > 200)
    runs = {}
    for level in jammed_flights.LEVELS:
        values = {
            jammed_flights.VALID[level]: fix * 1.0,
            "navigator.mode": np.where(fix, 1.0, 2.0),
            "evaluation.north_error": np.where(fix, back, error),
            "evaluation.east_error": 0.0 * time,
            "evaluation.horizontal_error": np.where(fix, back, error),
            "evaluation.consistent": np.full(len(time), consistent),
            "navigator.north_sigma": np.full(len(time), sigma),
            "navigator.east_sigma": np.full(len(time), sigma),
            jammed_flights.NORTH_EAST: 0.0 * time,
        }
        told = fix if foretold is None else foretold(time)
        link = SimpleNamespace(distance=1000.0 + 100.0 * time, fix=told, positions=told)
        runs[level] = [Run(values, link, level)]
    return [Flight("made", Jammer(0.7, 0.1, 0.0, 1.0), runs)]


def test_each_claim_is_missed_by_what_it_speaks_of_and_by_nothing_else():
    assert all(claim.holds for claim in jammed_flights.claims(made()))
    wrong = {
        0: made(lambda t: (t < 100) | (t > 210)),
        1: made(lambda t: (t < 97) | (t > 200)),
        2: made(consistent=0.0),
        3: made(sigma=50.0),
        4: made(sigma=100.0),
        5: made(back=30.0),
    }
    for missed, flights in wrong.items():
        assert [c.holds for c in jammed_flights.claims(flights)] == 2 * [k != missed for k in range(6)], missed


def test_the_titles_and_the_page_follow_the_flights():
    assert "lost where the link budget says. Without GPS: as wrong" in jammed_flights.document(made())
    other = jammed_flights.document(made(lambda t: (t < 50) | (t > 200), sigma=50.0))
    assert "lost elsewhere than the link budget says. Without GPS: not as wrong as it says" in other
    assert "| Made | signals | 1 | 2 | 11.0 (11.0 to 11.0) | 0 | 21.1" in jammed_flights.document(made())
