"""A DME receiver with five places in a network of more stations: AGARD CP-298 (1981), Brokof and Hurrass."""

import numpy as np
import pymap3d
import pytest
from scipy import stats

from fmus.radio import stations
from fmus.radio.dme import Dme
from fmus.radio.grades import DME
from models.processes import places
from navfmu.errors import NavfmuError
from navfmu.export import Grid, Table
from tests.models.native import interpret
from tests.models.test_dme import RANGES, follow

LATITUDE, ALTITUDE, REACH = 52.0, 9000.0, 200e3
EAST = np.arange(0.0, 700e3, 70e3)
"""Of the ten stations of the flight of 700 km, m."""
NORTH = np.where(np.arange(10) % 2 == 0, 40e3, -25e3)
QUIET = {"bias_sigma": 0.0, "noise_sigma": 0.0}


def place(east, north=0.0, altitude=ALTITUDE):
    lat, lon, _ = pymap3d.enu2geodetic(east, north, 0.0, LATITUDE, 8.0, 0.0)
    return {"latitude": np.radians(lat), "longitude": np.radians(lon), "altitude": altitude}


def network(rows):
    class Networked(Dme):
        """With stations of a test."""

        network = Table(columns=stations.NETWORK_COLUMNS, rows=rows)

    return Networked


def rows(east, north, reach=REACH):
    where = [place(e, n, 50.0) for e, n in zip(east, north, strict=True)]
    return np.array([(k + 1.0, *p.values(), reach) for k, p in enumerate(where)])


FLIGHT = network(rows(EAST, NORTH))


def distances(here):
    """Of the ten stations, by another way."""
    ecef = [
        np.array(pymap3d.geodetic2ecef(np.degrees(lat), np.degrees(lon), h))
        for lat, lon, h in ((here["latitude"], here["longitude"], here["altitude"]), *rows(EAST, NORTH)[:, 1:4])
    ]
    return [float(np.linalg.norm(station - ecef[0])) for station in ecef[1:]]


def test_ten_stations_of_a_flight_of_700_km_pass_through_five_places():
    """Beside a manager that keeps a list. Catches places that are given away while their station is in reach, one
    station in two places, the first one in the place of the nearest, and stations beyond their range."""
    run = interpret(FLIGHT, stations_from="network", **QUIET, mode=3, **place(-60e3))
    expected, seen = [0] * 5, set()
    for k in range(82):
        here = place(-60e3 + 10e3 * k)
        for name, value in here.items():
            run.set(name, value)
        run.do_step(run.time, 10.0)
        away = distances(here)
        expected = [n if n and away[n - 1] <= REACH else 0 for n in expected]
        others = sorted((d, n + 1) for n, d in enumerate(away) if d <= REACH and n + 1 not in expected)
        expected = [n or (others.pop(0)[1] if others else 0) for n in expected]
        seen |= set(expected)
        run.do_step(run.time, 1.0)  # what was exchanged is told with the next ranges
        run.do_step(run.time, 9.0)
        assert run.get("station_number").tolist() == expected
    assert seen == set(range(11))


def test_readings_are_those_of_the_stations_that_are_told():
    run = interpret(FLIGHT, stations_from="network", **QUIET, mode=3, **place(330e3))
    run.do_step(0.0, 20.0)
    away = distances(place(330e3))
    numbers = run.get("station_number").astype(int)
    assert sorted(numbers) == sorted(np.argsort(away)[:5] + 1)
    assert run.get(RANGES) == pytest.approx(np.array(away)[numbers - 1], abs=1e-6)
    given = rows(EAST, NORTH)[numbers - 1]
    for k, name in enumerate(("place_latitude", "place_longitude", "place_altitude")):
        assert run.get(name).tolist() == given[:, 1 + k].tolist()


def test_the_scan_of_the_paper_takes_turns_among_those_in_the_places():
    scan = DME["five_station_scan"].values
    run = interpret(FLIGHT, **{**scan, "stations_from": "network"}, **place(330e3))
    turns = [m for _, m, _ in follow(run, 30.0)]
    assert turns[-10:] == [[k % 5] for k in range(turns[-10][0], turns[-10][0] + 10)]


def test_a_new_station_is_locked_in_anew():
    """Four seconds of search and one of ranging after the exchange at 101 s, also in places that were empty."""
    run = interpret(FLIGHT, stations_from="network", **QUIET, mode=3, exchange_period=100.0, **place(0.0))
    run.do_step(0.0, 99.0)
    for name, value in place(600e3).items():
        run.set(name, value)
    fresh = []
    for _ in range(8):
        run.do_step(run.time, 1.0)
        fresh.append(int(np.sum(run.get("ranging.measured"))))
    assert fresh == [0] * 6 + [4, 4]  # from 106 s on; until 101 s the three of the begin, out of reach


NEAR = rows(np.tile(np.arange(5) * 10e3, 2), np.repeat([50e3, 300e3], 5), 120e3)
"""Two groups of five."""


def test_a_station_that_comes_again_has_its_constant_error_and_another_one_its_own():
    """150 m of a station. Catches errors that belong to a place, and ones that are drawn anew."""
    Groups = network(NEAR)
    run = interpret(Groups, stations_from="network", **QUIET, mode=3, station_offset_sigma=150.0, **place(0.0))
    errors = []
    for north in (0.0, 350e3, 0.0):
        for name, value in place(0.0, north).items():
            run.set(name, value)
        run.do_step(run.time, 30.0)
        here = [run.get(name) for name in ("place_latitude", "place_longitude", "place_altitude")]
        x = np.array(pymap3d.geodetic2ecef(*np.degrees([*place(0.0, north).values()][:2]), ALTITUDE))
        true = np.linalg.norm(np.array(pymap3d.geodetic2ecef(*np.degrees(here[:2]), here[2])).T - x, axis=1)
        numbers = run.get("station_number").astype(int)
        error = run.get(RANGES) - true
        errors.append(dict(zip(numbers, error, strict=True)))
    assert errors[0].keys() == errors[2].keys() == {1, 2, 3, 4, 5} and errors[1].keys() == {6, 7, 8, 9, 10}
    for k in range(1, 6):
        assert errors[2][k] == pytest.approx(errors[0][k], abs=1e-6)
    values = [*errors[0].values(), *errors[1].values()]
    assert np.min(np.abs(np.subtract.outer(values, values)[np.triu_indices(10, 1)])) > 1e-3


def test_the_bias_of_a_new_station_is_its_own():
    """Over 300 exchanges the correlation of new and old is none and the variance is 0.17 nmi squared, at 1e-6. Where
    the bias is that of the place it goes on: 1 at the standing aircraft's correlation time of 185 s."""
    Groups = network(NEAR)
    before, after = [], []
    for seed in range(60):
        run = interpret(Groups, stations_from="network", seed=seed, exchange_period=4.0, **place(0.0))
        run.do_step(0.0, 2.0)
        before.extend(run.get("bias"))
        for name, value in place(0.0, 350e3).items():
            run.set(name, value)
        run.do_step(2.0, 3.0)
        assert run.get("placed").tolist() == [6, 7, 8, 9, 10]
        after.extend(run.get("bias"))
    count = len(after)
    assert abs(np.arctanh(np.corrcoef(before, after)[0, 1])) < 4.9 / np.sqrt(count - 3)
    low, high = stats.chi2.ppf([5e-7, 1 - 5e-7], count) / count
    assert low < np.mean(np.square(after)) / (0.17 * 1852.0) ** 2 < high


def test_places_go_to_the_best_and_to_none_twice():
    """Beside a sorted list, 200 times."""
    rng = np.random.default_rng(5)
    for _ in range(200):
        merit, wanted = rng.integers(0, 6, 12).astype(float), rng.uniform(size=12) < 0.5
        placed, most = np.where(rng.uniform(size=5) < 0.4, rng.permutation(12)[:5] + 1, 0), int(rng.integers(0, 6))
        wanted &= ~np.isin(np.arange(1, 13), placed)
        queue = sorted((merit[k], k + 1) for k in np.flatnonzero(wanted))
        expected = [int(n) or (queue.pop(0)[1] if k < most and queue else 0) for k, n in enumerate(placed)]
        assert places.filled(placed, wanted, merit, most).tolist() == expected


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (np.vstack([rows(EAST, NORTH), [[33.0, 0.9, 0.1, 0.0, 1e5]]]), "beyond the 32 that can be chosen from"),
        (rows(EAST, NORTH)[1:], "not numbered from 1 on"),
        (rows(EAST, NORTH) + np.outer(np.arange(10) == 4, [0.5, 0, 0, 0, 0]), "number that is not whole"),
        (rows(EAST, NORTH) + np.outer(np.arange(10) == 9, [0.5, 0, 0, 0, 0]), "number that is not whole"),
        (rows(EAST, NORTH) + np.outer(np.arange(10) == 4, [0, 0, 0, 1e5, 0]), "a height beyond -1000 to 10000 m"),
        (rows(EAST, NORTH) - np.outer(np.arange(10) == 9, [0, 0, 0, 0, REACH]), "a range that is none"),
        (np.array([[1.0, 52.0, 8.0, 50.0, 1e5], [2.0, 52.1, 8.1, 50.0, 1e5]]), "in rad, not degrees"),
    ],
)
def test_a_network_that_cannot_be_right_is_refused(wrong, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        interpret(network(wrong))


def test_a_station_without_a_row_of_terrain_is_behind_none():
    """Terrain of five stations hides the fifth; of those at 500 km, 6 to 10, none. Catches the last row for all."""

    class Behind(FLIGHT):
        """With a wall around the fifth one."""

        terrain = Grid(
            axes=(("station", "1", np.arange(1.0, 6.0)), ("azimuth", "rad", np.array([0.0, 2.0 * np.pi]))),
            surfaces=(("mask", "rad", np.vstack([np.full((4, 2), -0.5 * np.pi), np.full((1, 2), 1.2)])),),
        )

    assert hidden_at(Behind, 500e3) == []
    assert hidden_at(Behind, 200e3) == [5]


def test_terrain_of_a_single_station_far_on_in_the_network_hides_it():
    """A wall around the seventh of ten rows. Catches terrain that is taken for low because that of the stations in the
    five places of the parameters is."""

    class Behind(FLIGHT):
        """With a wall around the seventh one."""

        terrain = Grid(
            axes=(("station", "1", np.arange(1.0, 11.0)), ("azimuth", "rad", np.array([0.0, 2.0 * np.pi]))),
            surfaces=(("mask", "rad", np.where(np.arange(10)[:, None] == 6, [1.2, 1.2], -0.5 * np.pi)),),
        )

    assert hidden_at(Behind, 500e3) == [7]


def hidden_at(component, east):
    """Numbers of the stations that have a place and give no range."""
    run = interpret(component, stations_from="network", **QUIET, mode=3, **place(east))
    run.do_step(0.0, 20.0)
    numbers = run.get("station_number")
    assert np.all(numbers > 0)
    return sorted(numbers[~run.get("ranging.measured")])
