"""Observability beside flights with errors on navpy's ellipsoid, and the cases of thesis section 6.3."""

from __future__ import annotations

import navpy
import numpy as np
import pytest

from navfmu.analysis.direction import apart, words
from navfmu.analysis.error_state import DISTANCE_NOISE, states
from navfmu.analysis.observability import Path, effects, observability
from navfmu.errors import NavfmuError
from navfmu.navaids.coverage import Points
from navfmu.navaids.station import Station

MIDDLE = np.radians(37.7), np.radians(-121.8), 2000.0
STEP = 1.0


def place(north, east, up=0.0):
    """Latitude, longitude, altitude of what lies so many m from the middle in its level plane, (...)."""
    ned = np.stack(np.broadcast_arrays(north, east, -np.asarray(up, float)), axis=-1).reshape(-1, 3)
    return [np.ravel(of) for of in navpy.ned2lla(ned, *MIDDLE, latlon_unit="rad")]


def at(north, east, ident, reach=400e3):
    """A station so many km from the middle."""
    latitude, longitude, _ = (float(of[0]) for of in place(1e3 * north, 1e3 * east))
    return Station(ident, "", latitude, longitude, 100.0, 110.0, reach)


def flown(heading, speed, seconds=900.0, north=0.0, east=0.0):
    """A track of heading (rad) and speed (m/s) over time, without wind, around the middle; and its times, headings and
    speeds."""
    time = np.arange(0.0, seconds + STEP, STEP)
    psi, v = (np.broadcast_to(of(time) if callable(of) else of, time.shape) for of in (heading, speed))
    way = np.cumsum(np.stack([v * np.cos(psi), v * np.sin(psi)]) * STEP, axis=1)
    latitude, longitude, _ = place(north + way[0] - way[0].mean(), east + way[1] - way[1].mean())
    return Points(latitude, longitude, np.full(time.shape, 2000.0), time=time), time, psi, v


ALONG_NORTH = at(60.0, 0.0, "N"), at(-70.0, 0.0, "S")
ALONG_EAST = at(0.0, 60.0, "E"), at(0.0, -70.0, "W")
DIAGONAL = at(50.0, 30.0, "D"), at(-75.0, -45.0, "U")
BESIDE = at(40.0, 40.0, "A"), at(-40.0, 40.0, "B")
SLANTED = np.arctan2(30.0, 50.0)
TURNING = (lambda t: 2.0 * np.pi * t / 300.0), (lambda t: 50.0 + 15.0 * np.sin(t / 60.0))


@pytest.mark.parametrize("model", ["position", "reduced", "sensors", "full"])
def test_rows_are_what_errors_do_to_distances(model):
    """Dead reckoning with each error in turn, summed up step by step, and distances by navpy; of a turning flight.

    Wrong: (6.19) as printed (the sign of V sin(psi)), heading and speed of now over the whole window as (6.15), errors
    that do not decay, an altitude with the wrong sign."""
    track, time, psi, v = flown(*TURNING)
    path = Path.of(track, STEP)
    found = states(model, [one.ident for one in BESIDE], path.speed)
    end = 300
    level, high, far = effects(path, found, ["A", "B"], 0, end)
    at_end = [float(of[end - 1]) for of in (track.latitude, track.longitude, track.altitude)]
    for i, state in enumerate(found):
        left = state.sigma * np.exp(-time[:end] / state.time)
        rate = {
            "wind to north": (left, 0.0 * left),
            "wind to east": (0.0 * left, left),
            "heading": (v[:end] * (np.cos(psi[:end] + left) - np.cos(psi[:end])),
                        v[:end] * (np.sin(psi[:end] + left) - np.sin(psi[:end]))),
            "airspeed": (left * np.cos(psi[:end]), left * np.sin(psi[:end])),
        }.get(state.name)  # fmt: skip
        north, east = (float(np.sum(of[1:]) * STEP) for of in rate) if rate else (0.0, 0.0)
        north += state.sigma * (state.name == "position to north")
        east += state.sigma * (state.name == "position to east")
        up = left[-1] * (state.name == "altitude")
        assert level[-1, :, i] == pytest.approx([north, east], rel=0.03, abs=12.0), state.name
        assert high[-1, i] == pytest.approx(up)
        for which, one in enumerate(BESIDE):
            here = np.ravel(navpy.lla2ned(*at_end, one.latitude, one.longitude, one.elevation, latlon_unit="rad"))
            there = np.ravel(navpy.ned2lla([north, east, -up], *at_end, latlon_unit="rad"))
            off = np.ravel(navpy.lla2ned(*there, one.latitude, one.longitude, one.elevation, latlon_unit="rad"))
            change = np.linalg.norm(off) - np.linalg.norm(here)
            seen = here / np.linalg.norm(here)
            row = seen[:2] @ level[-1, :, i] - seen[2] * high[-1, i]
            assert row == pytest.approx(change, rel=0.05, abs=25.0), state.name
            bias = left[-1] if state.name == f"distance of {one.ident}" else 0.0
            assert far[-1, which, i] == pytest.approx(bias, abs=1e-12)


CASES = {"a": (ALONG_NORTH, 0.0), "b": (ALONG_EAST, np.pi / 2.0), "c": (DIAGONAL, SLANTED)}


@pytest.mark.parametrize("together", [False, True], ids=["in turn", "together"])
@pytest.mark.parametrize("case", CASES)
def test_position_is_lost_across_a_track_through_both_stations(case, together):
    """The three cases of Fig 6.3, and the direction. Wrong: rank 2 by what rounding and a round Earth leave."""
    stations, heading = CASES[case]
    track = flown(heading, 60.0)[0]
    found = observability(track, stations, "position", together=together, sigma=DISTANCE_NOISE)
    assert np.all(found.ranks == 1)
    across = found.weakest.directions[1]
    assert abs(across @ [np.cos(heading), np.sin(heading)]) < 4e-3  # over 27 km to the east, north turns by 3.3e-3
    assert found.weakest.values[1] < 1e-2 * found.weakest.values[0]
    assert np.all(observability(track, stations, "reduced", sigma=DISTANCE_NOISE).ranks == 2)


def test_beside_the_track_position_and_wind_are_told():
    """The same track, other stations; and the same stations, another track."""
    for stations, heading in ((BESIDE, 0.0), (ALONG_NORTH, np.pi / 2.0)):
        track = flown(heading, 60.0, east=70e3)[0]
        assert np.all(observability(track, stations, "position").ranks == 2)
        assert np.all(observability(track, stations, "reduced").ranks == 4)


@pytest.mark.parametrize("heading", [0.0, 0.7, 4.0])
def test_heading_and_airspeed_are_wind_at_constant_heading_and_speed(heading):
    """Section 6.3.2: 4 of 6, and which: heading as a wind across, airspeed as one along. Variety tells all 6.

    Wrong: the thesis's "columns 4 through 6": 3 to 6 have a rank of 2, and with a heading to north column 6 is
    column 3."""
    sigmas = np.array([926.0, 926.0, 5.0, 5.0, np.radians(2.5), 2.6])
    found = observability(flown(heading, 50.0)[0], BESIDE, "sensors", sigma=DISTANCE_NOISE)
    assert np.all(found.ranks == 4)
    across = np.array([0.0, 0.0, 50.0 * np.sin(heading), -50.0 * np.cos(heading), 1.0, 0.0]) / sigmas
    along = np.array([0.0, 0.0, -np.cos(heading), -np.sin(heading), 0.0, 1.0]) / sigmas
    seen = found.weakest.directions[:4]
    for unseen in (across, along):
        assert np.linalg.norm(seen @ unseen) < 2e-3 * np.linalg.norm(unseen)
    assert np.all(observability(flown(*TURNING)[0], BESIDE, "sensors", sigma=DISTANCE_NOISE).ranks == 6)


def test_values_are_what_least_squares_leave():
    """Of what is known beforehand and distances together. Wrong: values of the squares, noise left out."""
    track = flown(0.3, 50.0, 300.0)[0]
    found = observability(track, BESIDE, "reduced", together=True)
    (window,) = found.windows
    path = Path.of(track, 5.0)
    level, _, _ = effects(path, states("reduced", ["A", "B"], 50.0), ["A", "B"], 0, 61)
    rows = []
    for k in range(0, 61, 3):
        where = [float(of[k]) for of in (path.points.latitude, path.points.longitude, path.points.altitude)]
        for one in BESIDE:
            ned = np.ravel(navpy.lla2ned(one.latitude, one.longitude, one.elevation, *where, latlon_unit="rad"))
            rows.append(-(ned[:2] / np.linalg.norm(ned)) @ level[k])
    assert window.count == len(rows) == 42
    left = np.linalg.inv(np.eye(4) + np.transpose(rows) @ np.array(rows) / (0.17**2 + 0.004**2) / 1852.0**2)
    assert np.sort(window.left**2) == pytest.approx(np.sort(np.linalg.eigvalsh(left)), rel=1e-6)


def test_wind_that_was_flown_in_is_no_way_through_the_air():
    """A drift without airspeed: heading has nothing to turn. Wrong: ground for air."""
    drifting = Path.of(flown(0.0, 20.0)[0], 5.0, (20.0, 0.0))
    assert np.max(np.abs(drifting.air_n)) < 5.0
    assert np.max(np.abs(drifting.moved_n)) == pytest.approx(18000.0, rel=2e-3)


def test_stations_that_are_not_heard_tell_nothing():
    near = at(40.0, 40.0, "A", 1000.0)
    found = observability(flown(0.0, 60.0)[0], (near, BESIDE[1]), "position")
    assert {one.count for one in found.windows} <= {10, 11}


def test_mixed_directions_come_apart():
    """The same space, each with an error of its own. Wrong: another space, directions that stay mixed."""
    pure = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.4]])
    mixed = np.array([[np.cos(0.7), np.sin(0.7)], [-np.sin(0.7), np.cos(0.7)]]) @ pure
    found = apart(mixed)
    assert np.linalg.matrix_rank(np.vstack([pure, found]), tol=1e-9) == 2
    assert sorted(np.sum(np.abs(found) > 1e-9, axis=1)) == [1, 2]


def test_words_of_a_direction():
    six = states("sensors", [], 50.0)
    assert words(np.array([0, 0, 0, -0.5, 1.0, 0]), six) == "heading +2.5 deg with wind 2.5 m/s to 270 deg"
    assert words(np.array([0.0, -1.0, 0, 0, 0, 0.05]), six) == "position 926 m to 90 deg"
    nine = states("full", ["A", "B"], 50.0)
    assert words(np.eye(9)[8], nine) == "distance of B +315 m"


REFUSED = {
    "one station": (dict(stations=BESIDE[:1]), "A is the only station"),
    "a short track": (dict(window=1000.0), "is too short, 900 s for a window of 1000 s"),
    "a short window": (dict(window=10.0), "has no two distances that are 15 s apart"),
    "no motion": (dict(track=flown(0.0, 0.0)[0]), "does not move (it stays within 0 m)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_is(name):
    change, sentence = REFUSED[name]
    with pytest.raises(NavfmuError) as refused:
        observability(**dict(track=flown(0.0, 60.0)[0], stations=BESIDE, model="reduced", source="f.csv") | change)
    assert sentence in str(refused.value)
