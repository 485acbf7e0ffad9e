"""Distance, horizon, dilution and choice of stations against closed forms and an independent calculation."""

from __future__ import annotations

import itertools
from dataclasses import replace

import navpy
import numpy as np
import pytest

from models.radio import dme
from navfmu.constants import FOOT, NAUTICAL_MILE, RADIO_EARTH_RADIUS
from navfmu.navaids import picture
from navfmu.navaids.choice import choose
from navfmu.navaids.coverage import Coverage, Points
from navfmu.navaids.sight import ANTENNA, Sight, dilution, horizon, sight
from navfmu.navaids.station import Station, plane

MIDDLE = np.radians([37.7, -121.8])
LOW = 300.0


def at(bearing: float, far: float, ident: str = "X", **others: float) -> Station:
    """A station in this direction (deg) and distance (m) of MIDDLE; 200 nmi of range."""
    angle = np.radians(bearing)
    latitude, longitude, _ = navpy.ned2lla(
        [far * np.cos(angle), far * np.sin(angle), 0.0], *np.degrees(MIDDLE), 0.0, latlon_unit="deg"
    )
    told = {"elevation": 0.0, "frequency": 110.0, "range": 200 * NAUTICAL_MILE} | others
    return Station(ident, "", float(np.radians(latitude)), float(np.radians(longitude)), **told)


def middle(altitude: float = LOW, ground: float = 0.0) -> Points:
    return Points(*(np.array([x]) for x in (*MIDDLE, altitude)), ground)


def test_distance_and_direction_are_those_of_navpy():
    """Wrong: a sphere, east for north, the station's direction for the aircraft's level distance (no cos elevation)."""
    rng = np.random.default_rng(1)
    stations = [at(b, far, elevation=h) for b, far, h in rng.uniform([0, 1e3, 0], [360, 3e5, 3e3], (50, 3))]
    seen = sight(stations, *(np.array([x]) for x in (*MIDDLE, 5000.0)))
    for i, one in enumerate(stations):
        ned = navpy.lla2ned(
            np.degrees(one.latitude), np.degrees(one.longitude), one.elevation, *np.degrees(MIDDLE), 5000.0
        )
        far = np.linalg.norm(ned)
        np.testing.assert_allclose(seen.distance[i, 0], far, rtol=1e-9)
        np.testing.assert_allclose([seen.north[i, 0], seen.east[i, 0]], ned[:2] / far, atol=1e-8)


def test_the_horizon_is_that_of_a_ray_that_touches_the_sphere():
    """And as the receiver has it. Wrong: the true radius, one horizon of two."""
    height = np.array([10.0, 150.0, 457.0, 3000.0, 12000.0])
    touching = RADIO_EARTH_RADIUS * np.arccos(RADIO_EARTH_RADIUS / (RADIO_EARTH_RADIUS + height))
    np.testing.assert_allclose(horizon(height), touching, rtol=1e-3)
    for h in height:
        np.testing.assert_allclose(horizon(h) + horizon(200.0 + ANTENNA), dme.horizon(h, 200.0, ANTENNA), rtol=1e-12)


@pytest.mark.parametrize("ground", [0.0, 500.0])
def test_a_station_is_heard_up_to_the_horizon_above_the_ground(ground):
    """Wrong: heights above the sea over a plateau, where all see farther, or below the ground."""
    reach = horizon(LOW) + horizon(ANTENNA)
    for share, heard in ((0.999, True), (1.001, False)):
        seen = sight(
            [at(90.0, share * reach, elevation=ground)], *(np.array([x]) for x in (*MIDDLE, ground + LOW)), ground
        )
        assert seen.heard[0, 0] == heard


def test_a_station_is_heard_up_to_its_range():
    for share, heard in ((0.999, True), (1.001, False)):
        assert Coverage.of([at(0.0, share * 30e3, range=30e3)], middle()).count[0] == heard


@pytest.mark.parametrize("count", [2, 3, 4, 5, 8])
def test_dilution_in_the_middle_of_a_regular_polygon(count):
    """sqrt(trace((H' H)^-1)) is 2 / sqrt(n), of two at right angles sqrt(2)."""
    turn = 90.0 if count == 2 else 360.0 / count
    stations = [at(10.0 + turn * i, 20 * NAUTICAL_MILE) for i in range(count)]
    expected = np.sqrt(2.0) if count == 2 else 2.0 / np.sqrt(count)
    assert Coverage.of(stations, middle()).hdop[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("angle", [5.0, 30.0, 60.0, 120.0, 150.0])
def test_dilution_of_two_is_root_two_over_the_sine(angle):
    """F32; wrong: without the root, or of the wrong angle."""
    found = Coverage.of([at(0.0, 30e3), at(angle, 50e3)], middle())
    assert found.hdop[0] == pytest.approx(np.sqrt(2.0) / np.sin(np.radians(angle)), rel=2e-3)


def test_circles_of_one_and_of_none_do_not_cross():
    """Also two on one line as these lie on an Earth that is round: the line, 20 nmi to both sides."""
    assert np.isinf(Coverage.of([at(0.0, 30e3)], middle()).hdop[0])
    assert np.isinf(Coverage.of([at(0.0, 300e3)], middle()).hdop[0])
    assert Coverage.of([at(0.0, 37e3), at(180.0, 37e3)], middle()).hdop[0] > 100.0


def test_dilution_is_that_of_the_inverse_matrix_and_of_the_receiver():
    rng = np.random.default_rng(2)
    north, east = rng.uniform(-1.0, 1.0, (2, 6, 40))
    used = rng.random((6, 40)) < 0.7
    found = dilution(Sight(north, north, east, used), used)
    for i in range(40):
        h = np.stack([north[used[:, i], i], east[used[:, i], i]], axis=1)
        assert found[i] == pytest.approx(np.sqrt(np.trace(np.linalg.inv(h.T @ h))), rel=1e-9)
        assert found[i] == pytest.approx(dme.dilution(north[:, i], east[:, i], used[:, i]), rel=1e-9)


def test_a_grid_lies_around_its_middle():
    """Wrong: rows to the east, degrees of equal length, heights above the sea, the date line forgotten."""
    points = Points.around(np.radians(60.0), np.radians(179.9), 20e3, 3, [100.0, 200.0], ground=50.0)
    assert points.altitude.reshape(points.shape)[:, 0, 0].tolist() == [150.0, 250.0]
    lat, lon = (np.degrees(x).reshape(points.shape)[0] for x in (points.latitude, points.longitude))
    assert np.all(np.abs(lon) <= 180.0) and lon[1, 2] < 0.0 < lon[1, 0]
    ned = navpy.lla2ned(lat[2, 2], lon[2, 2], 0.0, 60.0, 179.9, 0.0)
    np.testing.assert_allclose(ned[:2], [20e3, 20e3], rtol=1e-3)


def test_points_are_looked_at_in_parts_as_together(monkeypatch):
    """Wrong: parts in another order, a share of a part for that of all."""
    points = Points.around(*MIDDLE, 60e3, 9, [LOW, 5 * LOW])
    stations = [at(0.0, 40e3, range=50e3), at(100.0, 30e3), at(200.0, 50e3, range=30e3)]
    whole = Coverage.of(stations, points)
    monkeypatch.setattr("navfmu.navaids.coverage.BLOCK", 100)
    parts = Coverage.of(stations, points)
    for name in ("count", "hdop", "share"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))


def test_a_map_shows_a_station_where_the_grid_has_it():
    one = at(30.0, 20e3)
    np.testing.assert_allclose(plane(one, *MIDDLE), [10e3, 17.32e3], rtol=1e-3)


@pytest.fixture
def axes(monkeypatch):
    """Axes of the pictures that are drawn."""
    kept = []
    monkeypatch.setattr(picture, "png", lambda drawing, **_: kept.extend(drawing.axes))
    return kept


def test_a_picture_shows_small_dilutions(axes):
    """Of 36 stations it is 1 / 3. Wrong: a scale that begins at one half, and an empty panel."""
    coverage = Coverage.of([at(10.0 * i, 30e3) for i in range(36)], replace(middle(), time=np.zeros(1)))
    assert coverage.hdop == pytest.approx(1.0 / 3.0, rel=1e-3)
    picture.draw(coverage, "many")
    hdop = next(axis for axis in axes if "HDOP" in axis.get_ylabel())
    assert hdop.get_ylim()[0] < coverage.hdop < hdop.get_ylim()[1]


def test_a_track_across_the_date_line_is_drawn_in_one_piece(axes):
    """From 179 to 181 degrees, with a station at 180.5. Wrong: a course around the Earth; times of two axes."""
    lon = np.radians(np.linspace(179.0, 181.0, 21))
    track = Points(np.full(21, 0.3), (lon + np.pi) % (2.0 * np.pi) - np.pi, np.full(21, 3e3), time=60.0 * np.arange(21))
    one = replace(at(0.0, 1e4), latitude=0.3, longitude=np.radians(-179.5), range=60e3)
    picture.draw(Coverage.of([one], track), "date line")
    course, (count, hdop) = axes[0], (axis for axis in axes if axis.get_xlabel() == "time, min")
    drawn = [line.get_xdata() for line in course.lines]
    np.testing.assert_allclose(drawn[0], np.degrees(lon))
    np.testing.assert_allclose(drawn[1], 180.5)
    assert np.ptp(course.get_xlim()) < 3.0
    assert hdop.get_xlim() == count.get_xlim()


def test_share_and_parts_count_points():
    """A station 30 nmi ahead with a range of 20: heard in a third of a row of points over 30 nmi, within two points."""
    rows = Points(
        np.linspace(MIDDLE[0], at(0.0, 30 * NAUTICAL_MILE).latitude, 301), *(np.full(301, x) for x in (MIDDLE[1], LOW))
    )
    found = Coverage.of([at(0.0, 30 * NAUTICAL_MILE, range=20 * NAUTICAL_MILE)], rows)
    assert found.part(1) == pytest.approx(2 / 3, abs=2 / 301) and found.part(2) == 0.0
    assert found.share[0] == found.part(1)
    assert set(found.columns()) == {"latitude (deg)", "longitude (deg)", "altitude (ft)", "stations", "hdop"}
    np.testing.assert_allclose(found.columns()["altitude (ft)"], LOW / FOOT)


def test_the_pair_is_the_best_of_all_pairs_and_nothing_useless_is_taken():
    """By all pairs. Wrong: the nearest ones, one that is not heard."""
    rng = np.random.default_rng(3)
    stations = [at(b, far, str(i)) for i, (b, far) in enumerate(rng.uniform([0, 1e4], [100, 5e4], (8, 2)))]
    stations.append(at(90.0, 10e3, "short", range=5e3))
    best = min(itertools.combinations(stations, 2), key=lambda pair: Coverage.of(pair, middle()).hdop[0])
    assert {one.ident for one in choose(stations, middle(), 2)} == {one.ident for one in best}
    five = choose(stations, middle(), 5)
    assert {one.ident for one in best} == {one.ident for one in five[:2]} and len(five) == 5
    assert "short" not in {one.ident for one in choose(stations, middle(), 9)}


def test_one_that_helps_nothing_is_not_taken():
    """Right below the aircraft: its distance says nothing of where that is."""
    stations = [at(0.0, 20e3, "a"), at(90.0, 20e3, "b"), at(0.0, 1.0, "below")]
    assert {one.ident for one in choose(stations, middle(), 5)} == {"a", "b"}


def test_of_one_that_is_heard_one_is_taken_and_of_none_none():
    assert [one.ident for one in choose([at(0.0, 10e3, "a"), at(0.0, 300e3, "b")], middle(), 5)] == ["a"]
    assert choose([at(0.0, 300e3)], middle(), 5) == []
