"""Orbits, clocks and the choice of ephemerides: published states, an independent solution, closed forms, in C."""

from datetime import date

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from models.earth import earth
from models.satellite import broadcast, gps_time, kepler, orbit, satellite_clock, selection, sines, slots
from models.satellite.ephemeris import COLUMNS, Ephemeris
from navfmu.constants import SPEED_OF_LIGHT
from navfmu.export import Component, Output, Parameter, Table, every
from navfmu.satellite import calendar
from navfmu.satellite import orbits as files
from navfmu.satellite.file import read_orbits
from tests.models.native import Native
from tests.satellite import made


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    """Rows of the two published messages: the older one first."""
    folder = tmp_path_factory.mktemp("orbits")
    return read_orbits(made.written(folder, "two.01n", made.navigation_2(made.REMONDI, made.GLAB))).rows


def test_the_package_and_the_models_mean_the_same_columns():
    assert files.COLUMNS == COLUMNS
    assert files.APART == selection.APART


def test_position_and_velocity_that_remondi_published(published):
    """Without harmonics it is 281 m off, with the earth's rate of models.earth 2.3 m. The published velocity has
    the harmonics' rates at the corrected argument of latitude, which is 2e-7 m/s off its own differences."""
    position, velocity = orbit.state(Ephemeris.of(published[0]), 1124, 86400.0)
    np.testing.assert_allclose(position, [-12611434.19782219, -13413103.97797041, 19062913.07357877], rtol=0, atol=1e-6)
    np.testing.assert_allclose(velocity, [266.2803795674, -2424.7683468482, -1529.7620784616], rtol=0, atol=2e-6)


def test_relativistic_term_that_the_program_where_has(published):
    """For Remondi's message, in m; the other sign, or degrees in the place of radians, is another number."""
    one = Ephemeris.of(published[0])
    relative, _ = satellite_clock.relativity(one, orbit.anomaly(one, 1124, 86400.0))
    assert SPEED_OF_LIGHT * relative == pytest.approx(-0.012570413426601913, rel=1e-9)


def test_state_and_clock_that_glab_has(published):
    """Position, velocity, relativistic term and clock polynomial in m, as printed. The velocity is that of the frame of
    reception, which has turned meanwhile (15 mm/s), and is a difference over 1 ms (0.3 mm/s; 0.05 mm below). Its
    relativistic term is that of the product of position and velocity, harmonics of the radius included, which are 2 mm.
    """
    one = Ephemeris.of(published[1])
    at = (1886, 172799.92312317)
    position, velocity = orbit.state(one, *at)
    np.testing.assert_allclose(position, [-4833470.67769, 15130611.05029, 21132240.92266], rtol=0, atol=2e-5)
    turned = orbit.EARTH_RATE * (172800.0 - at[1]) * np.array([velocity[1], -velocity[0], 0.0])
    np.testing.assert_allclose(velocity + turned, [-2632.8593, -735.4519, -69.6660], rtol=0, atol=3e-4)
    relative, _ = satellite_clock.relativity(one, orbit.anomaly(one, *at))
    told, _ = satellite_clock.polynomial(one, *at)
    light = SPEED_OF_LIGHT
    assert -2.0 * position @ velocity / light == pytest.approx(-0.83775, abs=6e-5)
    assert light * relative == pytest.approx(-0.83775, abs=2.5e-3)
    assert light * told == pytest.approx(118787.68054, abs=2e-5)
    error, _ = satellite_clock.error(one, *at)
    assert error == pytest.approx(told + relative, abs=1e-18)
    assert satellite_clock.on_l1(one, error) - error == pytest.approx(8.38190317154e-9, rel=1e-12)


def test_keplers_equation_against_bracketing():
    """At every anomaly, up to twice the eccentricity of any satellite; one step fewer is 3e-8 off at 0.05."""
    for eccentricity in (0.0, 0.005, 0.03, 0.05):
        mean = np.linspace(-7.0, 7.0, 57)
        true = [
            brentq(lambda E, m=m, e=eccentricity: E - e * np.sin(E) - m, m - 0.2, m + 0.2, xtol=1e-15) for m in mean
        ]
        found = kepler.eccentric_anomaly(mean, eccentricity)
        np.testing.assert_allclose(found, [np.sin(true), np.cos(true)], rtol=0, atol=4e-15)


def test_sines_of_small_angles_and_of_sums():
    """To the last place of what the library has; with a term less the sine is 6e-14 of itself off, the cosine
    5e-13."""
    angles = np.linspace(-sines.SMALL, sines.SMALL, 1001)
    np.testing.assert_allclose(sines.small(angles), [np.sin(angles), np.cos(angles)], rtol=3e-16, atol=0)
    for other in (-3.0, 0.7, 2.0):
        both = sines.both(sines.of(angles), sines.of(other))
        np.testing.assert_allclose(both, [np.sin(angles + other), np.cos(angles + other)], rtol=0, atol=5e-16)


def test_velocity_and_drift_are_derivatives(published):
    """Of the whole orbit, harmonics and rates included, by central differences of fourth order over 2 s: they are
    within 1e-6 m/s, the cancellation of 2.6e7 m in doubles; a term of a harmonic left out is 1e-3."""
    strange = Ephemeris.of(published)._replace(cis=5e-5, cic=4e-5, cus=6e-5, cuc=-5e-5, inclination_rate=3e-9)
    week = strange.toe_week

    def around(f):
        return [f(strange, week, strange.toe + 3000.0 + h) for h in (-2.0, -1.0, 1.0, 2.0)]

    _, velocity = orbit.state(strange, week, strange.toe + 3000.0)
    a, b, c, d = (position for position, _ in around(orbit.state))
    np.testing.assert_allclose(velocity, (a - 8 * b + 8 * c - d) / 12.0, rtol=0, atol=1e-6)
    curved = strange._replace(clock_drift_rate=1e-15)
    _, drift = satellite_clock.error(curved, week, strange.toe + 3000.0)
    a, b, c, d = (satellite_clock.error(curved, week, strange.toe + 3000.0 + h)[0] for h in (-200, -100, 100, 200))
    np.testing.assert_allclose(drift, (a - 8 * b + 8 * c - d) / 1200.0, rtol=0, atol=1e-18)


def test_weeks_make_no_seam(published):
    """The same moment in two ways of saying it, before and after the turn of the week; seconds since 1980 in one
    double move the satellite by 0.4 mm."""
    one = Ephemeris.of(published[1])._replace(toe=604784.0, toc=604784.0, toc_week=1886.0)
    for second in (604799.123, 604801.2345678):
        week, rest = gps_time.normal(1886.0, second)
        assert 0.0 <= rest < gps_time.WEEK
        a, b = orbit.state(one, 1886, second)[0], orbit.state(one, week, rest)[0]
        np.testing.assert_allclose(a, b, rtol=0, atol=2e-6)
        assert satellite_clock.error(one, week, rest)[0] == pytest.approx(
            satellite_clock.error(one, 1886, second)[0], abs=1e-18
        )


def test_sending_time_is_that_of_the_signal(published):
    """A made pseudorange: light from where the satellite is when its clock, which is off, shows the time."""
    one, week, sent = Ephemeris.of(published[1]), 1886, 172799.5
    error, _ = satellite_clock.error(one, week, sent)
    received, pseudorange = sent + 0.07, (0.07 - error) * SPEED_OF_LIGHT
    assert satellite_clock.sending_time(one, week, received, pseudorange) == pytest.approx(sent, abs=5e-11)


def test_a_signal_is_sent_when_it_is_received_less_its_way():
    """To a receiver in Esbjerg from all satellites of the slots: the way that it took, by the satellite then and an
    earth that turns, is as long as its time times c to 0.03 mm where
    the satellite is above the horizon; without the turn of the earth it is 19 m off, with the
    satellite of the reception 49 m."""
    o = Ephemeris.of(slots.constellation())._replace(clock_bias=np.linspace(-1e-3, 1e-3, 24), group_delay=5e-9)
    place, (week, second) = earth.to_ecef(0.9685, 0.1476, 60.0), slots.EPOCH
    time = broadcast.travel(o, week, second, place)
    assert np.all(time > 0.067)
    seen = time < 0.0867
    assert np.count_nonzero(seen) > 6
    then = second - time
    position, velocity, clock, rate = broadcast.at(o, week, then)
    angle = -orbit.EARTH_RATE * time
    inertial = np.stack(
        [
            np.cos(angle) * position[:, 0] - np.sin(angle) * position[:, 1],
            np.sin(angle) * position[:, 0] + np.cos(angle) * position[:, 1],
            position[:, 2],
        ],
        -1,
    )
    way = np.linalg.norm(inertial - place, axis=1)
    np.testing.assert_allclose(SPEED_OF_LIGHT * time[seen], way[seen], rtol=0, atol=4e-5)
    pseudorange = SPEED_OF_LIGHT * (time - satellite_clock.error(o, week, then)[0])
    for told, true in zip(broadcast.sent(o, week, second, pseudorange), (position, velocity, clock, rate), strict=True):
        np.testing.assert_allclose(told, true, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(clock, np.linspace(-1e-3, 1e-3, 24) - 5e-9, rtol=0, atol=1e-12)


def test_slots_are_a_nominal_constellation():
    """Six planes of four, 60 degrees apart, 55 degrees steep; two turns in a sidereal day within 10 s. The poles are
    those of velocity and position, with planes that do not turn: so they tell of signs and frames, too."""
    o = Ephemeris.of(slots.constellation())._replace(node_rate=np.zeros(24))
    week, second = slots.EPOCH
    position, velocity = orbit.state(o, week, second)
    np.testing.assert_allclose(np.linalg.norm(position, axis=1), 26559700.0, rtol=1e-12)
    pole = np.cross(position, velocity + np.cross([0, 0, orbit.EARTH_RATE], position)).T
    pole = pole / np.linalg.norm(pole, axis=0)
    np.testing.assert_allclose(np.arccos(pole[2]), np.radians(55.0), rtol=0, atol=1e-6)
    node = np.degrees(np.arctan2(pole[0], -pole[1])) + slots.HOUR_ANGLE
    planes = np.round(np.mod(node, 360.0), 3).reshape(6, 4)
    np.testing.assert_allclose(planes, np.mod(272.847 + 60.0 * np.arange(6), 360.0)[:, None] * np.ones(4), atol=2e-3)
    assert 2.0 * np.pi / orbit.mean_motion(o)[0] == pytest.approx(43082.045, abs=10.0)
    latitude = np.arcsin(position[:, 2] / 26559700.0 / np.sin(np.radians(55.0)))  # of A3 and D2
    assert np.degrees(latitude[[2, 13]]) == pytest.approx([11.676, 180.0 - 265.446], abs=1e-3)


def test_slots_at_their_epoch():
    """1993-07-01, 0 h UTC, when GPS time was 9 s ahead: slots by turning a point about three axes, to a millimetre; A1
    and D3 also as an independent calculation has them. Without the leap seconds they are 25 km off."""
    week, second = calendar.gps_time(date(1993, 7, 1), calendar.leap_seconds(date(1993, 7, 1)))
    position, _ = orbit.state(Ephemeris.of(slots.constellation()), week, second)
    for name, found in zip(slots.NAMES, position, strict=True):
        latitude = slots.LATITUDES[name[0]][int(name[1]) - 1]
        turn = Rotation.from_euler("ZXZ", [slots.PLANES[name[0]] - 279.060, 55.0, latitude], degrees=True)
        np.testing.assert_allclose(found, turn.apply([26559700.0, 0.0, 0.0]), rtol=0, atol=1e-3)
    np.testing.assert_allclose(position[0], [-2511262.8, -15042441.8, -21744796.3], rtol=0, atol=0.06)
    np.testing.assert_allclose(position[14], [-22536659.6, -6370205.7, 12527454.5], rtol=0, atol=0.06)


@pytest.mark.parametrize(
    ("latitude", "mask", "visible", "median", "large"),
    [
        (0, 5, 8.66, (0.866, 1.496, 1.730, 0.805), (1.048, 1.941, 2.135)),
        (45, 5, 7.62, (1.011, 1.459, 1.792, 0.916), (1.370, 2.147, 2.521)),
        (45, 10, 6.72, (1.183, 1.785, 2.140, 1.189), (1.607, 2.564, 3.054)),
        (80, 10, 8.03, (0.932, 2.251, 2.437, 1.239), (1.216, 3.632, 3.803)),
    ],
)
def test_a_day_of_the_slots_has_the_dilutions_of_an_independent_calculation(latitude, mask, visible, median, large):
    """HDOP, VDOP, PDOP, TDOP (median) and the first three (95 %) at twelve longitudes every ten minutes of a day, from
    a calculation of others with the same table, to the digits given. With a plane turned by a degree the third digit is
    another one, with D3 at 35.136 degrees the fourth."""
    o = Ephemeris.of(slots.constellation())
    week, second = slots.EPOCH
    found, count = [], []
    for longitude in np.radians(30.0 * np.arange(12)):
        for t in 600.0 * np.arange(144):
            up, east, north = _sight(o, np.radians(latitude), longitude, week, second + t)
            seen = up > np.sin(np.radians(mask))
            count.append(np.count_nonzero(seen))
            rows = np.stack([east[seen], north[seen], up[seen], np.ones(count[-1])], -1)
            e, n, u, time = np.diag(np.linalg.inv(rows.T @ rows))
            found.append(np.sqrt([e + n, u, e + n + u, time]))
    assert np.mean(count) == pytest.approx(visible, abs=0.006)
    np.testing.assert_allclose(np.median(found, axis=0), median, rtol=0, atol=6e-4)
    np.testing.assert_allclose(np.quantile(found, 0.95, axis=0)[:3], large, rtol=0, atol=2e-3)


def _sight(ephemeris, latitude, longitude, week, second):
    """Unit vectors to the satellites: up, east, north."""
    position, _ = orbit.state(ephemeris, week, second)
    d = position - earth.to_ecef(latitude, longitude, 0.0)
    x, y, z = (d / np.linalg.norm(d, axis=1)[:, None]).T
    out = np.cos(longitude) * x + np.sin(longitude) * y
    up = np.cos(latitude) * out + np.sin(latitude) * z
    return up, np.cos(longitude) * y - np.sin(longitude) * x, np.cos(latitude) * z - np.sin(latitude) * out


def rows(*toes, prn=7, week=2111, **more):
    """Rows of one satellite, sent an hour before t_oe, good for two hours."""
    toe = np.array(toes, float)
    zero = np.zeros_like(toe)
    return Ephemeris(
        **{
            **{name: zero for name in Ephemeris._fields},
            "place": selection.place(prn, week, toe),
            "prn": zero + prn,
            "toe_week": zero + week,
            "toe": toe,
            "sent_week": zero + week,
            "sent": toe - 3600.0,
            "limit": zero + 7200.0,
            **more,
        }
    ).rows()


def chosen(table, prn, second, future=True, week=2111):
    """t_oe of what is chosen, None if it is not usable."""
    around = selection.around(selection.finder(table), prn, week, second)
    one = selection.nearest(around, prn, week, second, future)
    return float(one.toe) if selection.usable(one, prn, week, second, future) else None


@pytest.mark.parametrize(
    ("second", "future", "expected"),
    [
        (7200.0, True, 7200.0),
        (10799.0, True, 7200.0),
        (10800.0, True, 14400.0),  # of two as near the later one
        (10801.0, True, 14400.0),
        (10799.0, False, 7200.0),
        (10801.0, False, 14400.0),
        (10740.0, False, 7200.0),
        (21601.0, True, None),  # two hours and a second behind the last one
        (21600.0, True, 14400.0),
        (0.0, True, 7200.0),
        (0.0, False, None),  # not sent yet
        (-1.0, True, None),
    ],
)
def test_the_nearest_ephemeris_is_chosen(second, future, expected):
    assert chosen(rows(7200.0, 14400.0), 7, second, future) == expected


def test_a_receiver_does_not_hear_what_was_not_sent():
    """An upload at the middle of the hours: the file knows it before it was sent."""
    table = rows(7200.0, 14400.0, sent=np.array([0.0, 13000.0]))
    assert chosen(table, 7, 12000.0) == 14400.0
    assert chosen(table, 7, 12000.0, future=False) == 7200.0
    assert chosen(table, 7, 13000.0, future=False) == 14400.0


def test_what_was_sent_is_found_behind_what_was_not_sent_yet():
    """An upload with a t_oe 16 s before that of the orbit which is known, as real files have it, and one behind it.

    Of a file of 257 orbits, looking at two neighbours alone left 895 of 111 631 satellites in time without the right
    one.
    """
    uploaded = rows(0.0, 7184.0, 7200.0, 14400.0, sent=np.array([-3600.0, 6800.0, 1800.0, 10800.0]))
    assert chosen(uploaded, 7, 6000.0) == 7184.0
    assert chosen(uploaded, 7, 6000.0, future=False) == 7200.0
    assert chosen(uploaded, 7, 6900.0, future=False) == 7184.0
    late = rows(7200.0, 7216.0, 14400.0, sent=np.array([1800.0, 9000.0, 10800.0]))
    assert chosen(late, 7, 8000.0) == 7216.0
    assert chosen(late, 7, 8000.0, future=False) == 7200.0
    assert chosen(late, 7, 9000.0, future=False) == 7216.0
    others = [rows(7184.0, 7200.0, prn=prn, sent=np.array([6800.0, -1e4])) for prn in (6, 8)]
    assert chosen(np.concatenate([others[0], late, others[1]]), 7, -1.0, future=False) is None


def test_no_ephemeris_of_another_satellite_and_none_of_an_unhealthy_one():
    table = np.concatenate([rows(7200.0, prn=6), rows(7200.0, prn=7), rows(7200.0, prn=9)])
    assert chosen(table, 7, 7300.0) == 7200.0
    assert chosen(table, 8, 7200.0) is None
    assert chosen(table, 1, 7200.0) is None
    assert chosen(table, 32, 7200.0) is None
    ill = np.concatenate([rows(7200.0, prn=6), rows(7200.0, prn=7, health=np.array([1.0]))])
    assert chosen(ill, 7, 7200.0) is None and chosen(ill, 6, 7200.0) == 7200.0


def test_ephemerides_across_the_turn_of_the_week():
    table = np.concatenate([rows(597600.0, week=2111), rows(0.0, week=2112)])
    assert chosen(table, 7, 604000.0, week=2111) == 0.0
    assert chosen(table, 7, 10.0, week=2112) == 0.0
    assert chosen(table, 7, 598000.0, week=2111) == 597600.0


class Sky(Component):
    """Satellites of a table, at GPS times."""

    week = Parameter("1", start=1886.0, description="GPS week at the beginning")
    second = Parameter("s", start=172000.0, description="second of the week at the beginning")
    sample_period = Parameter("s", start=1.0, description="period")
    orbits = Table(columns=COLUMNS, rows=rows(0.0, 7200.0))
    position_e = Output((24, 3), "m", description="positions")
    velocity_e = Output((24, 3), "m/s", description="velocities")
    clock = Output(24, "s", description="errors of the clocks")
    usable = Output(24, "1", description="whether they can be used")

    @every("sample_period")
    def look(self):
        prn = np.arange(1.0, 25.0)
        now = self.week, self.second + self.time
        found = self.orbits.around(place=selection.place(prn, *now))
        one = selection.nearest((Ephemeris.of(found.row), Ephemeris.of(found.next_row)), prn, *now)
        anomaly = orbit.anomaly(one, *now)
        self.position_e, self.velocity_e = orbit.state_at(one, anomaly, *now)
        self.clock = satellite_clock.error_at(one, anomaly, *now)[0]
        self.usable = selection.usable(one, prn, *now)


def test_an_fmu_has_the_same_states_from_its_table(tmp_path, published):
    """Satellites of the slots and two broadcast ones, six minutes around the moment at which the next ephemeris is
    nearer; positions within 1e-6 m of NumPy's (sines may differ in the last place), the choice exactly."""
    glab = Ephemeris.of(published[1])
    second = glab._replace(
        place=selection.place(20.0, 1886.0, 180000.0), toe=180000.0, toc=180000.0, mean_anomaly=1.3, clock_bias=1e-5
    )
    table = slots.constellation()
    table = np.concatenate([table[:19], [glab.rows(), second.rows()], table[20:]])

    class Full(Sky):
        """The same with the table."""

        name = "sky"
        orbits = Table(columns=COLUMNS, rows=table)

    start = 176400.0 - 180.0
    found = Native(Full, tmp_path).run(
        360.0, 1.0, ["position_e", "velocity_e", "clock", "usable"], parameters={"second": start}
    )
    prn = np.arange(1.0, 25.0)
    jumped = []
    for k in range(1, 361):
        now = 1886.0, start + float(k)
        one = selection.nearest(selection.around(selection.finder(table), prn, *now), prn, *now)
        jumped.append(float(one.toe[19]))
        position, velocity = orbit.state(one, *now)
        np.testing.assert_allclose(found["position_e"][k].reshape(24, 3), position, rtol=0, atol=1e-6)
        np.testing.assert_allclose(found["velocity_e"][k].reshape(24, 3), velocity, rtol=0, atol=1e-9)
        np.testing.assert_allclose(found["clock"][k], satellite_clock.error(one, *now)[0], rtol=0, atol=1e-19)
        assert np.all(found["usable"][k] == selection.usable(one, prn, *now))
    assert jumped == [172800.0] * 179 + [180000.0] * 181
