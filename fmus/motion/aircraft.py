"""The aircraft's true motion as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.motion.flight_plans import FLIGHT_PLANS
from models.air import atmosphere, turbulence
from models.earth import earth
from models.motion import aircraft, wander
from models.motion.flight_plan import GRID, LIMITS, SEGMENTS, FlightPlan, straight, turn
from models.processes import gauss_markov, lags
from models.processes.known import known
from navfmu.export import Component, Example, Input, Output, Parameter, State, every, require, start

_PLAN = FLIGHT_PLANS["livermore"].parameters()
_EXAMPLE = FlightPlan(
    _PLAN["initial_latitude"],
    _PLAN["initial_longitude"],
    _PLAN["initial_altitude"],
    0.0,
    _PLAN["initial_speed"],
    (
        straight(20.0, _PLAN["initial_speed"]),
        turn(np.pi / 3, np.radians(3.0), _PLAN["initial_speed"], -2.5),
        straight(60.0, _PLAN["initial_speed"]),
    ),
)
"""A right turn with a descent, for the picture in the documentation."""


class Aircraft(Component):
    """True motion of an aircraft over the WGS-84 ellipsoid, from a flight plan of up to 24 segments.

    In each segment the ground speed V, the rate of turn of the ground track omega and the vertical speed w go from the
    previous segment's values to its own along the smooth step

        s(x) = 10 x^3 - 15 x^4 + 6 x^5,   x = (t - t_segment) / T                                                (1)

    and then keep them. T is 1.875 times the change divided by its limit (1.875 is the largest slope of s), and at least
    1 s; the limits are on roll rate, acceleration and vertical acceleration. Segments begin at multiples of
    plan_period, the nearest to the sum of the durations; the last one lasts for ever. The initial state is level,
    straight flight. What a roll-in takes away from a turn, the roll-out at the begin of the next segment returns: a
    turn through 360 degrees is a segment whose duration times turn rate is 2 pi, followed by a straight one.

    Track and altitude are integrals of (1) in closed form. In n two deviations are added to this motion:

    wander  d'' is stationary with wander_sigma and wander_time: white noise through four equal lags (motion.wander).
            The aircraft is flown so: bank, heading and pitch belong to it.
    gusts   g of the Dryden form, MIL-F-8785C, with the intensity gust_sigma and the length gust_length, in axes along
            the planned track. The aircraft keeps its attitude and is carried: e'' = Z (g - e') - (Z / hold_time) e
            with Z = rho V C_L_alpha g_0 / (2 wing_loading) vertically, with side_force_slope in place of C_L_alpha
            horizontally, rho and V those of t = 0. The pilot holds the path with bank and climb.

    Position is integrated by Simpson's rule over the radii of curvature at that place. With W the wind as the pilot is
    used to it, wind_n (and the gust along) through two equal lags of weathercock_time:

        velocity    v^n = (V cos(track), V sin(track), -w) + d' + e'
        wind axes   heading and climb angle are those of v^n - e' - W, less e_D / hold_time downward
        bank        tan(bank) = (acceleration across these, held path included) / (9.80665 m/s2 + the upward one)
        attitude    wind axes, nose up by alpha = zero_lift_angle + 2 wing_loading n / (rho C_L_alpha |v - W|^2)
                    n the load factor of this turn, rho that of t = 0
        force       f^b = C_bn (v'^n + (2 Omega_e + rho) x v^n - g^n)           thesis (A.1)
        rate        omega_ib^b = C_bn (Omega_e + rho) + rate of b with respect to n, from the exact Euler rates (4.4)

    All derivatives are analytic: integrating specific force and rate returns the trajectory. The ground trajectory does
    not depend on the wind. angle_of_attack, sideslip and true_airspeed are of the velocity relative to air_velocity_n,
    which is wind and gust. Noise is drawn every turbulence_period; in between all motion is exact.

    With wander_sigma, gust_sigma, wing_loading and zero_lift_angle 0 the aircraft is on its plan, its nose on the path.

    The start values are a flight of 35 minutes in the manner of thesis section 7.3 (p. 215): 360-degree turns around a
    point 16 nmi east and 6 nmi north of Livermore airport, then straight in to runway 25L at 90 kn.
    """

    name = "aircraft"
    example = Example(
        {**_EXAMPLE.parameters(), "wander_sigma": np.zeros(3), "gust_sigma": np.zeros(3)},
        steps={"wind_n": (0.0, 8.0, 0.0)},
        text="Smooth air. A wind of 8 m/s to the east sets in during straight flight to the north: the nose turns into "
        "it, the track does not change. At 20 s a right turn through 60 degrees with a descent begins: roll, turn rate "
        "and specific force change smoothly, and the aircraft descends.",
    )

    wind_n = Input(3, "m/s", display_unit="kn", description="velocity of the air over ground, north, east, down")

    initial_latitude = Parameter(
        "rad",
        start=_PLAN["initial_latitude"],
        min=-1.55,
        max=1.55,
        display_unit="deg",
        description="geodetic latitude at t = 0",
    )
    initial_longitude = Parameter(
        "rad", start=_PLAN["initial_longitude"], min=-7.0, max=7.0, display_unit="deg", description="longitude at t = 0"
    )
    initial_altitude = Parameter(
        "m",
        start=_PLAN["initial_altitude"],
        min=-500.0,
        max=30000.0,
        display_unit="ft",
        description="height above the ellipsoid at t = 0",
    )
    initial_track = Parameter(
        "rad",
        start=_PLAN["initial_track"],
        min=-7.0,
        max=7.0,
        display_unit="deg",
        description="direction of motion over ground at t = 0, from true north to the east",
    )
    initial_speed = Parameter(
        "m/s",
        start=_PLAN["initial_speed"],
        min=5.0,
        max=350.0,
        display_unit="kn",
        description="speed over ground at t = 0; thesis section 5.5.2: 90 kn",
    )
    segment_duration = Parameter(
        SEGMENTS,
        "s",
        start=_PLAN["segment_duration"],
        min=0.0,
        max=1e6,
        description="how long the segment lasts; 0 ends the plan",
    )
    segment_turn_rate = Parameter(
        SEGMENTS,
        "rad/s",
        start=_PLAN["segment_turn_rate"],
        min=-0.5,
        max=0.5,
        display_unit="deg/s",
        description="rate of turn of the ground track, positive to the right",
    )
    segment_vertical_speed = Parameter(
        SEGMENTS,
        "m/s",
        start=_PLAN["segment_vertical_speed"],
        min=-50.0,
        max=50.0,
        display_unit="ft/min",
        description="vertical speed, positive up",
    )
    segment_speed = Parameter(
        SEGMENTS,
        "m/s",
        start=_PLAN["segment_speed"],
        min=0.0,
        max=350.0,
        display_unit="kn",
        description="speed over ground",
    )
    roll_rate_limit = Parameter(
        "rad/s",
        start=LIMITS[0],
        min=0.001,
        max=3.0,
        display_unit="deg/s",
        description="largest roll rate of a transition",
    )
    acceleration_limit = Parameter(
        "m/s2", start=LIMITS[1], min=0.001, max=50.0, description="largest rate of the ground speed in a transition"
    )
    vertical_acceleration_limit = Parameter(
        "m/s2", start=LIMITS[2], min=0.001, max=50.0, description="largest rate of the vertical speed in a transition"
    )
    wander_sigma = Parameter(
        3,
        "m/s2",
        start=(0.24, 0.24, 0.12),
        min=0.0,
        max=10.0,
        description="standard deviation of the acceleration in which the pilot lets the aircraft wander, north, east, "
        "down; recorded flights: 0.21 to 0.30 along and across, 0.09 to 0.18 vertically",
    )
    wander_time = Parameter(
        3,
        "s",
        start=(10.0, 10.0, 7.0),
        min=0.5,
        max=1e4,
        description="time constant of its lags, north, east, down; recorded flights: 8 to 12 s, vertically 6 to 9 s",
    )
    gust_sigma = Parameter(
        3,
        "m/s",
        start=turbulence.GUST_SIGMA,
        min=0.0,
        max=30.0,
        display_unit="kn",
        description="intensity of the gusts along, across and down: 5 ft/s; light turbulence of MIL-F-8785C has 7 ft/s",
    )
    gust_length = Parameter(
        "m",
        start=turbulence.GUST_LENGTH,
        min=1.0,
        max=1e5,
        display_unit="ft",
        description="scale of turbulence, MIL-F-8785C: 1750 ft",
    )
    hold_time = Parameter(
        "s",
        start=30.0,
        min=1.0,
        max=1e5,
        description="time constant by which the pilot returns to the path after gusts",
    )
    wing_loading = Parameter(
        "Pa",
        start=673.0,
        min=0.0,
        max=2e4,
        description="weight over wing area, 673 N/m2 for a Cessna 172; 0: the angle of attack does not change with "
        "lift, and gusts do not carry the aircraft",
    )
    lift_slope = Parameter("1", start=5.14, min=0.1, max=20.0, description="C_L_alpha per rad, 5.14 for a Cessna 172")
    zero_lift_angle = Parameter(
        "rad",
        start=-0.0603,
        min=-0.5,
        max=0.5,
        display_unit="deg",
        description="angle of attack without lift, -C_L_0 / C_L_alpha; -3.5 degrees for a Cessna 172",
    )
    side_force_slope = Parameter(
        "1", start=0.31, min=0.0, max=20.0, description="-C_Y_beta per rad, 0.31 for a Cessna 172"
    )
    weathercock_time = Parameter(
        "s", start=1.25, min=0.1, max=60.0, description="time constant of each of the two lags of the wind W"
    )
    update_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="period at which the motion is computed")
    plan_period = Parameter("s", start=GRID, min=1e-3, max=10.0, description="segments begin at multiples of this time")
    turbulence_period = Parameter(
        "s", start=0.1, min=1e-3, max=1.0, description="period at which noise is drawn for wander and gusts"
    )

    latitude = Output("rad", display_unit="deg", description="geodetic latitude")
    longitude = Output("rad", display_unit="deg", description="longitude, continuous")
    altitude = Output("m", display_unit="ft", description="height above the ellipsoid")
    velocity_n = Output(3, "m/s", display_unit="kn", description="velocity over ground, north, east, down")
    roll = Output("rad", display_unit="deg", description="roll angle, right wing down positive")
    pitch = Output("rad", display_unit="deg", description="pitch angle, nose up positive")
    heading = Output("rad", display_unit="deg", description="heading from true north, continuous (not wrapped)")
    specific_force = Output(3, "m/s2", description="specific force in body axes")
    rate = Output(3, "rad/s", display_unit="deg/s", description="rate with respect to inertial space, body axes")

    air_velocity_n = Output(
        3, "m/s", display_unit="kn", description="velocity of the air at the aircraft over ground: wind and gust"
    )
    true_airspeed = Output("m/s", display_unit="kn", description="speed relative to the air")
    angle_of_attack = Output("rad", display_unit="deg", description="of the air-relative velocity, positive from below")
    sideslip = Output("rad", display_unit="deg", description="of the air-relative velocity, positive from the right")

    segment_begin = State(SEGMENTS, "s", description="time at which the segment begins")
    segment_end = State(SEGMENTS, "s", description="time at which the segment ends")
    segment_track = State(SEGMENTS, "rad", description="track at the begin of the segment")
    segment_altitude = State(SEGMENTS, "m", description="altitude at the begin of the segment")
    segment_roll_time = State(SEGMENTS, "s", start=1.0, description="duration T of the change of turn rate")
    segment_climb_time = State(SEGMENTS, "s", start=1.0, description="duration T of the change of vertical speed")
    segment_speed_time = State(SEGMENTS, "s", start=1.0, description="duration T of the change of speed")
    begin = State("s", description="begin of the segment being flown")
    base_track = State("rad", description="track at its begin")
    base_altitude = State("m", description="altitude at its begin")
    turn_rate_before = State("rad/s", description="rate of turn at its begin")
    turn_rate_step = State("rad/s", description="change of the rate of turn in it")
    vertical_speed_before = State("m/s", description="vertical speed at its begin")
    vertical_speed_step = State("m/s", description="change of the vertical speed in it")
    speed_before = State("m/s", description="speed at its begin")
    speed_step = State("m/s", description="change of the speed in it")
    roll_time = State("s", start=1.0, description="duration T of the change of turn rate")
    climb_time = State("s", start=1.0, description="duration T of the change of vertical speed")
    speed_time = State("s", start=1.0, description="duration T of the change of speed")
    lift_length = State("m", description="2 wing_loading / (rho g C_L_alpha)")
    wander_levels = State((4, 3), "1", description="lags of the wander, models.motion.wander")
    wander_held = State(3, "1", description="their input until the next draw")
    wander_decay = State(3, "1", description="their decay over half an update_period")
    gust_levels = State((2, 3), "1", description="lags of the gusts along, across, down, models.air.turbulence")
    gust_held = State(3, "1", description="their input until the next draw")
    gust_ratio = State("1", description="half an update_period over their time constant")
    gust_decay = State("1", description="exp(-gust_ratio)")
    gust_drive = State("1", description="standard deviation of their input")
    gust_n = State(3, "m/s", description="gust, north, east, down")
    aerodynamic_rate = State(3, "1/s", description="Z north, east, down")
    response = State((4, 3), "1", description="transition of (e, e') over half an update_period")
    carried = State(3, "m", description="displacement by gusts, e, north, east, down")
    carried_velocity = State(3, "m/s", description="its rate")
    felt_wind = State(3, "m/s", description="wind through two lags, W")
    felt_wind_rate = State(3, "m/s2", description="its rate")
    felt_wind_target = State(3, "m/s", description="input of the lags at the last tick")
    weathercock_decay = State("1", description="exp(-T/tau) of the lags of the wind")

    @require("the flight plan has a gap: a segment after one of duration 0 has a duration, or the first has none")
    def plan_has_no_gap(self):
        used = self.segment_duration > 0.0
        return np.logical_and(used[0], np.all(np.logical_or(used[:-1], np.logical_not(used[1:]))))

    @require("a segment of the flight plan has a segment_speed below 5 m/s")
    def plan_flies(self):
        return np.all(np.logical_or(self.segment_duration <= 0.0, self.segment_speed >= 5.0))

    @require(
        "a segment of the flight plan is shorter than the transition to its values: raise its "
        "segment_duration, roll_rate_limit {roll_rate_limit} rad/s, acceleration_limit {acceleration_limit} m/s2 or "
        "vertical_acceleration_limit {vertical_acceleration_limit} m/s2"
    )
    def transitions_fit(self):
        return np.all(aircraft.fits(*self._plan()))

    @require("plan_period {plan_period} s must be a whole multiple of update_period {update_period} s")
    def plan_period_fits(self):
        return _whole(self.plan_period / self.update_period)

    @require("turbulence_period {turbulence_period} s must be a whole multiple of update_period {update_period} s")
    def turbulence_period_fits(self):
        return _whole(self.turbulence_period / self.update_period)

    def _plan(self):
        return (
            self.segment_duration,
            self.segment_turn_rate,
            self.segment_vertical_speed,
            self.segment_speed,
            (self.initial_track, self.initial_altitude, self.initial_speed),
            (self.roll_rate_limit, self.acceleration_limit, self.vertical_acceleration_limit),
            self.plan_period,
        )

    @start
    def begin_flight(self, noise):
        plan = aircraft.schedule(*self._plan())
        self.segment_begin = plan["begin"]
        self.segment_end = plan["end"]
        self.segment_track = plan["track"]
        self.segment_altitude = plan["altitude"]
        self.segment_roll_time = plan["roll_time"]
        self.segment_climb_time = plan["climb_time"]
        self.segment_speed_time = plan["speed_time"]
        self._choose_segment(0.0)
        self._begin_deviations(noise(24))
        motion = self._motion(0.0)
        deviation = wander.deviation(self.wander_levels, self.wander_sigma, self.wander_time)[0]
        north_south, east_west = earth.radii(self.initial_latitude)
        self.latitude = self.initial_latitude + deviation[0] / (north_south + self.initial_altitude)
        self.longitude = self.initial_longitude + deviation[1] / (
            (east_west + self.initial_altitude) * np.cos(self.latitude)
        )
        track = self.base_track
        self.gust_n = self._gust(np.sin(track), np.cos(track))
        self.felt_wind_target = self._felt(np.sin(track), np.cos(track))
        self.felt_wind = self.felt_wind_target
        self._publish(track, np.sin(track), np.cos(track), *motion)

    def _begin_deviations(self, n):
        """Constants of wander and gusts, and their first values from 24 normal numbers."""
        half = 0.5 * self.update_period
        height = atmosphere.geopotential(self.initial_altitude)
        density = atmosphere.density(atmosphere.pressure(height), atmosphere.temperature(height))
        self.weathercock_decay = gauss_markov.decay(self.update_period, self.weathercock_time)
        self.lift_length = aircraft.lift_length(self.wing_loading, density, self.lift_slope)
        slopes = np.array([self.side_force_slope, self.side_force_slope, self.lift_slope])
        self.aerodynamic_rate = turbulence.aerodynamic_rate(density, self.initial_speed, slopes, self.wing_loading)
        self.response = turbulence.response(self.aerodynamic_rate, self.hold_time, half)
        gust_time = self.gust_length / self.initial_speed
        self.gust_ratio = half / gust_time
        self.gust_decay = gauss_markov.decay(half, gust_time)
        self.gust_drive = lags.held_drive(gust_time, self.turbulence_period)
        self.wander_decay = gauss_markov.decay(half, self.wander_time)
        self.wander_levels = wander.stationary(n[0:12].reshape(4, 3))
        self.gust_levels = turbulence.stationary(n[12:18].reshape(2, 3))
        self._hold(n[18:24])

    def _hold(self, n):
        """New inputs of the lags from six normal numbers."""
        self.wander_held = lags.held_drive(self.wander_time, self.turbulence_period) * n[0:3]
        self.gust_held = self.gust_drive * n[3:6]

    @every("update_period")
    def move(self):
        speed, turn, climb = self._motion(self.time - self.begin)
        middle_speed, middle_turn, _ = self._motion(self.time - self.begin - 0.5 * self.period)
        track = self.base_track + turn[3]
        half_turn = self.base_track + middle_turn[3] - track
        sine, cosine = np.sin(track), np.cos(track)
        middle_sine, middle_cosine = aircraft.turned(sine, cosine, half_turn)
        self._deviate(middle_sine, middle_cosine)
        middle = self._deviation_rate()
        self._deviate(sine, cosine)
        end = self._deviation_rate()
        offset = wander.deviation(self.wander_levels, self.wander_sigma, self.wander_time)[0] + self.carried
        self.latitude, self.longitude = aircraft.move(
            self.latitude,
            self.longitude,
            self.altitude,
            self.velocity_n,
            (middle_speed[0] * middle_cosine + middle[0], middle_speed[0] * middle_sine + middle[1]),
            (speed[0] * cosine + end[0], speed[0] * sine + end[1]),
            self.base_altitude + climb[3] - offset[2],
            self.period,
        )
        target = self._felt(sine, cosine)
        self.felt_wind, self.felt_wind_rate = lags.follow(
            self.felt_wind,
            self.felt_wind_rate,
            self.felt_wind_target,
            target,
            self.period,
            self.weathercock_time,
            self.weathercock_decay,
        )
        self.felt_wind_target = target
        self._publish(track, sine, cosine, speed, turn, climb)

    def _deviate(self, sine, cosine):
        """Wander and gusts half an update_period later; sine and cosine of the planned track then."""
        half = 0.5 * self.period
        self.wander_levels = lags.advance(
            self.wander_levels, self.wander_held, half / self.wander_time, self.wander_decay
        )
        self.gust_levels = lags.advance(self.gust_levels, self.gust_held, self.gust_ratio, self.gust_decay)
        gust_n = self._gust(sine, cosine)
        self.carried, self.carried_velocity = turbulence.carried(
            self.carried, self.carried_velocity, self.gust_n, gust_n, self.response, self.hold_time, half
        )
        self.gust_n = gust_n

    def _gust(self, sine, cosine):
        """Gust in n."""
        along, across, down = turbulence.gust(self.gust_levels, self.gust_sigma)
        return np.array([along * cosine - across * sine, along * sine + across * cosine, down])

    def _felt(self, sine, cosine):
        """What the felt wind follows: the wind, and what there is of a gust along the track."""
        along_n = np.array([cosine, sine, 0.0])
        return known(self.wind_n, self.felt_wind) + along_n * (along_n @ (self.gust_n - self.carried_velocity))

    def _deviation_rate(self):
        """Velocity of wander and gusts, n."""
        return wander.deviation(self.wander_levels, self.wander_sigma, self.wander_time)[1] + self.carried_velocity

    @every("turbulence_period")
    def draw(self, noise):
        self._hold(noise(6))

    @every("plan_period")
    def choose_segment(self):
        self._choose_segment(self.time)

    def _motion(self, elapsed):
        """Speed, rate of turn and vertical speed: value, first and second derivative, integral."""
        return (
            aircraft.change(elapsed, self.speed_before, self.speed_step, self.speed_time),
            aircraft.change(elapsed, self.turn_rate_before, self.turn_rate_step, self.roll_time),
            aircraft.change(elapsed, self.vertical_speed_before, self.vertical_speed_step, self.climb_time),
        )

    def _choose_segment(self, time):
        """Take over the segment that begins at this time or was flown already; from here on it is flown."""
        now = time + 1e-6 * self.plan_period
        flown = np.logical_and(self.segment_begin <= now, self.segment_end > now)

        def pick(values):
            return np.sum(np.where(flown, values, 0.0))

        def before(values, initial):
            return np.concatenate([np.reshape(initial, (1,)), values[:-1]])

        self.begin = pick(self.segment_begin)
        self.base_track = pick(self.segment_track)
        self.base_altitude = pick(self.segment_altitude)
        self.turn_rate_before = pick(before(self.segment_turn_rate, 0.0))
        self.turn_rate_step = pick(self.segment_turn_rate) - self.turn_rate_before
        self.vertical_speed_before = pick(before(self.segment_vertical_speed, 0.0))
        self.vertical_speed_step = pick(self.segment_vertical_speed) - self.vertical_speed_before
        self.speed_before = pick(before(self.segment_speed, self.initial_speed))
        self.speed_step = pick(self.segment_speed) - self.speed_before
        self.roll_time = pick(self.segment_roll_time)
        self.climb_time = pick(self.segment_climb_time)
        self.speed_time = pick(self.segment_speed_time)

    def _publish(self, track, sine, cosine, speed, turn, climb):
        """Outputs from the motion; latitude, longitude, deviations and felt wind are up to date."""
        velocity, acceleration, jerk = aircraft.planned(sine, cosine, speed[:3], turn[:2], climb[:3])
        d, d1, d2, d3 = wander.deviation(self.wander_levels, self.wander_sigma, self.wander_time)
        velocity, acceleration, jerk = velocity + d1, acceleration + d2, jerk + d3
        stiffness = self.aerodynamic_rate / self.hold_time
        returning = stiffness * np.array([1.0, 1.0, 0.0])
        climbing = np.array([0.0, 0.0, 1.0]) / self.hold_time
        c_nb, rate_nb = aircraft.trimmed(
            (velocity - climbing * self.carried, acceleration - climbing * self.carried_velocity),
            (acceleration - returning * self.carried, jerk - returning * self.carried_velocity),
            (self.felt_wind, self.felt_wind_rate),
            (self.zero_lift_angle, self.lift_length),
        )
        self.altitude = self.base_altitude + climb[3] - d[2] - self.carried[2]
        self.velocity_n = velocity + self.carried_velocity
        pushed = self.aerodynamic_rate * (self.gust_n - self.carried_velocity) - stiffness * self.carried
        self.specific_force, self.rate = aircraft.inertial(
            self.latitude, self.altitude, self.velocity_n, acceleration + pushed, c_nb, rate_nb
        )
        self.roll, self.pitch, self.heading = aircraft.euler(c_nb, track, sine, cosine)
        self.air_velocity_n = self.wind_n + self.gust_n
        self.true_airspeed, self.angle_of_attack, self.sideslip = aircraft.flow(
            c_nb, self.velocity_n - self.air_velocity_n
        )


def _whole(ratio):
    """True for a whole number from 1 on."""
    return np.logical_and(ratio > 0.5, np.abs(ratio - np.floor(ratio + 0.5)) < 1e-6 * ratio)
