"""Fixes by distances and bearings beside navpy's geodesy, scipy's minimisation, closed forms and draws."""

from __future__ import annotations

import navpy
import numpy as np
import pytest
from scipy.optimize import least_squares

from navfmu.analysis.circle import principal
from navfmu.analysis.fix import covariance, crossing, direction, drawn, measured, methods, solve, useless
from navfmu.analysis.ghost import ghost
from navfmu.analysis.line import BEARING, DISTANCE, Line
from navfmu.analysis.place import Place, moved
from navfmu.navaids.station import Station

HERE = Place(float(np.radians(47.3)), float(np.radians(11.2)), 3000.0)
FAR, TURN = 315.0, float(np.radians(1.0))


def at(north, east, ident, elevation=None):
    """A station so many km from the place in its level plane, or below that, m."""
    told = navpy.ned2lla([1e3 * north, 1e3 * east, 0.0], *HERE.values(), latlon_unit="rad", alt_unit="m")
    latitude, longitude, level = map(float, told)
    return Station(ident, "", latitude, longitude, level if elevation is None else elevation, 110.0, 400e3)


A, B, C = at(30.0, -10.0, "A", 200.0), at(25.0, 40.0, "B", 500.0), at(-35.0, 5.0, "C", 900.0)


def by_navpy(line, latitude, longitude, altitude):
    """What a line measures, by another program."""
    one = line.station
    ned = navpy.lla2ned(latitude, longitude, altitude, one.latitude, one.longitude, one.elevation, latlon_unit="rad")
    return np.linalg.norm(ned) if line.kind == DISTANCE else np.arctan2(ned[1], ned[0]) % (2.0 * np.pi)


def covariance_here(lines, place=HERE):
    return covariance(lines, *map(np.asarray, place.values()))


def matrix(packed):
    return np.array([[packed[0], packed[1]], [packed[1], packed[2]]])


@pytest.mark.parametrize("kind", [DISTANCE, BEARING])
@pytest.mark.parametrize("station", [A, B, C], ids=["A", "B", "C"])
def test_a_line_and_its_slope_are_those_of_navpy(kind, station):
    """Differences over 20 m. Wrong: east for north, no cos(latitude), a slope of the level distance, bearings to it."""
    line = Line(station, kind, 1.0)
    value, slope = line.seen(*map(np.asarray, HERE.values()))
    assert value == pytest.approx(by_navpy(line, *HERE.values()), rel=1e-8)
    for axis, step in enumerate(np.eye(2) * 10.0):
        ends = [
            by_navpy(line, *(float(of) for of in moved(*HERE.values(), *(sign * step))), HERE.altitude)
            for sign in (-1, 1)
        ]
        assert slope[axis] == pytest.approx((ends[1] - ends[0]) / 20.0, rel=1e-4, abs=1e-9)


@pytest.mark.parametrize("angle", [20.0, 60.0, 90.0, 150.0])
def test_two_distances_have_the_axes_of_a_closed_form(angle):
    """sigma / sqrt(1 -+ cos) of the angle between the stations. Wrong: eigenvalues of P^-1 as (D.11) is read."""
    turn = np.radians(angle)
    pair = at(20.0, 0.0, "N"), at(20.0 * np.cos(turn), 20.0 * np.sin(turn), "O")
    packed = covariance_here(methods(pair, FAR, TURN)["rho-rho N O"])
    expected = sorted(FAR / np.sqrt(1.0 + np.array([1, -1]) * np.cos(turn)))
    assert [float(axis) for axis in principal(packed)[::-1]] == pytest.approx(expected, rel=1e-9)


def test_distance_and_bearing_have_the_axes_of_a_closed_form():
    """Along the ray the sigma of the distance, across it the turn times the distance."""
    (lines,) = methods([at(0.0, 30.0, "E")], FAR, TURN).values()
    packed = covariance_here(lines)
    assert np.sqrt(packed[2]) == pytest.approx(FAR, rel=1e-3)
    assert np.sqrt(packed[0]) == pytest.approx(30e3 * TURN, rel=1e-3)
    assert np.sin(direction(packed)) == pytest.approx(0.0, abs=0.02)


def test_the_longer_axis_points_where_eigenvectors_do():
    for name, lines in methods((A, B), FAR, TURN).items():
        packed = covariance_here(lines)
        values, vectors = np.linalg.eigh(matrix(packed))
        north, east = vectors[:, 1]
        assert np.sin(direction(packed) - np.arctan2(east, north)) == pytest.approx(0.0, abs=1e-9), name
        assert principal(packed)[0] ** 2 == pytest.approx(values[1])


@pytest.mark.parametrize("name", methods((A, B, C), FAR, TURN))
def test_a_fix_is_the_least_that_scipy_finds_on_the_ellipsoid(name):
    """With errors of three sigma, from 20 km away. Wrong: no weights, bearings without their turn, a plane."""
    lines = methods((A, B, C), FAR, TURN)[name]
    rng = np.random.default_rng(3)
    told = measured(lines, HERE) + 3.0 * np.array([line.sigma for line in lines]) * rng.uniform(-1, 1, len(lines))
    start = [float(of) for of in moved(*HERE.values(), 12e3, -12e3)]

    def residuals(place):
        off = [z - by_navpy(line, *place, HERE.altitude) for z, line in zip(told, lines, strict=True)]
        off = [
            o if line.kind == DISTANCE else (o + np.pi) % (2 * np.pi) - np.pi
            for o, line in zip(off, lines, strict=True)
        ]
        return np.array(off) / [line.sigma for line in lines]

    best = least_squares(residuals, start, x_scale=1e-3, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    found = solve(lines, told, *start, HERE.altitude)
    assert np.hypot(*(HERE.offset(*found) - HERE.offset(*best.x))) < 1.0


@pytest.mark.parametrize("name", methods((A, B, C), FAR, TURN))
def test_draws_are_those_of_the_ellipse(name):
    """e' P^-1 e of 20 000 fixes has a mean of 2; it is 4 / N in variance: five of its sigma, and 1 % that lines are
    not straight. Wrong: bearings in degrees, one sigma for all lines, a covariance that is the information."""
    lines = methods((A, B, C), FAR, TURN)[name]
    errors = drawn(lines, HERE, 20000, 1)
    square = np.einsum("ni,ij,nj->n", errors, np.linalg.inv(matrix(covariance_here(lines))), errors)
    assert np.mean(square) == pytest.approx(2.0, abs=5.0 * 2.0 / np.sqrt(20000) + 0.02)
    assert np.mean(square <= -2.0 * np.log(0.05)) == pytest.approx(0.95, abs=5.0 * np.sqrt(0.95 * 0.05 / 20000) + 0.002)
    assert np.array_equal(errors, drawn(lines, HERE, 20000, 1))


def test_circles_cross_a_second_time_beyond_their_stations():
    """The same distances by navpy, on the other side of the line. Wrong: the place itself, a mirror in the plane."""
    lines = methods((A, B), FAR, TURN)["rho-rho A B"]
    other = ghost(lines, HERE)
    for line in lines:
        assert by_navpy(line, *other.values()) == pytest.approx(by_navpy(line, *HERE.values()), abs=0.01)
    assert np.hypot(*HERE.offset(other.latitude, other.longitude)) > 50e3
    back = ghost(lines, other)
    assert np.hypot(*HERE.offset(back.latitude, back.longitude)) < 0.01


def test_other_fixes_have_no_second_place():
    some = methods((A, B, C), FAR, TURN)
    assert not any(ghost(lines, HERE) for name, lines in some.items())
    assert ghost(methods((at(0.0, 20.0, "E"), at(0.0, -30.0, "W")), FAR, TURN)["rho-rho E W"], HERE) is None


@pytest.mark.parametrize("east", [-30.0, 50.0], ids=["between", "beyond"])
def test_there_is_no_fix_on_the_line_through_both(east):
    """Wrong: huge numbers that look like a fix, a sentence that does not say why."""
    pair = at(0.0, 20.0, "E"), at(0.0, east, "W")
    some = methods(pair, FAR, TURN)
    for name in ("rho-rho E W", "theta-theta E W"):
        assert np.all(np.isinf(covariance_here(some[name]))), name
        assert np.degrees(crossing(some[name], HERE)) < 0.5
        assert "they must cross" in useless(some[name], HERE.points(), HERE)
    for name in ("rho-theta E", "rho-theta W", "all of E W"):
        assert np.all(np.isfinite(covariance_here(some[name]))), name


def test_a_station_below_is_none():
    (lines,) = methods([at(0.001, 0.0, "D", 0.0)], FAR, TURN).values()
    assert np.all(np.isinf(covariance_here(lines)))
    silent = Station("S", "", A.latitude, A.longitude, 0.0, 110.0, 1000.0)
    assert useless([Line(silent, DISTANCE, FAR)], HERE.points(), HERE) == "S is not heard there"


@pytest.mark.parametrize(("elevation", "known"), [(59.0, True), (61.0, False)])
def test_no_bearing_is_taken_from_steep_above(elevation, known):
    """Wrong: the cone around the level direction, an ellipse of nothing over the station."""
    low = at(2.8 / np.tan(np.radians(elevation)), 0.0, "L", 200.0)
    lines = methods((low, A), FAR, TURN)
    assert np.isfinite(covariance_here(lines["all of L A"])).all() == known
    assert np.isfinite(covariance_here(lines["rho-theta A"])).all()
    if not known:
        assert "L stands too steep below" in useless(lines["all of L A"], HERE.points(), HERE)


def test_lines_cross_at_the_angle_between_stations():
    lines = methods((at(20.0, 0.0, "N"), at(20.0, 20.0, "O")), FAR, TURN)["rho-rho N O"]
    assert np.degrees(crossing(lines, HERE)) == pytest.approx(45.0, abs=0.2)
