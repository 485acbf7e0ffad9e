"""The aircraft's true motion as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.flight_plans import FLIGHT_PLANS
from models import aircraft, gauss_markov
from models.flight_plan import GRID, LIMITS, SEGMENTS, FlightPlan, straight, turn
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

    Track and altitude are integrals of (1) in closed form, position is integrated by Simpson's rule over the radii of
    curvature at that place, and

        velocity    v^n = (V cos(track), V sin(track), -w)
        pitch       tan(theta) = w / V                  the nose is on the flight path
        heading     psi = track + c                     c is the crab angle
        roll        tan(phi) = (V omega cos(c) - V' sin(c)) / (9.80665 m/s2 + w')   the coordinated turn
        force       f^b = C_bn (v'^n + (2 Omega_e + rho) x v^n - g^n)           thesis (A.1)
        rate        omega_ib^b = C_bn (Omega_e + rho) + rate of b with respect to n, from the exact Euler rates (4.4)

    All derivatives are analytic: integrating specific force and rate returns the trajectory. The ground trajectory
    follows the plan whatever the wind. The crab angle follows the direction of the air-relative velocity, v^n - wind,
    through two equal first-order lags (a weathercock), so that the yaw rate stays continuous in a stepping wind; it
    starts at zero and is limited to 60 degrees.

    The start values are a flight of 35 minutes in the manner of thesis section 7.3 (p. 215): 360-degree turns around a
    point 16 nmi east and 6 nmi north of Livermore airport, then straight in to runway 25L at 90 kn.
    """

    name = "aircraft"
    example = Example(
        _EXAMPLE.parameters(),
        steps={"wind_n": (0.0, 8.0, 0.0)},
        text="A wind of 8 m/s to the east sets in during straight flight to the north: the nose turns into it, the "
        "track does not change. At 20 s a right turn through 60 degrees with a descent begins: roll, turn rate and "
        "specific force change smoothly, and the aircraft descends with its nose on the flight path.",
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
    weathercock_time = Parameter(
        "s", start=1.25, min=0.1, max=60.0, description="time constant of each of the two lags of the crab angle"
    )
    update_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="period at which the motion is computed")
    plan_period = Parameter("s", start=GRID, min=1e-3, max=10.0, description="segments begin at multiples of this time")

    latitude = Output("rad", display_unit="deg", description="geodetic latitude")
    longitude = Output("rad", display_unit="deg", description="longitude, continuous")
    altitude = Output("m", display_unit="ft", description="height above the ellipsoid")
    velocity_n = Output(3, "m/s", display_unit="kn", description="velocity over ground, north, east, down")
    roll = Output("rad", display_unit="deg", description="roll angle, right wing down positive")
    pitch = Output("rad", display_unit="deg", description="pitch angle, nose up positive")
    heading = Output("rad", display_unit="deg", description="heading from true north, continuous (not wrapped)")
    specific_force = Output(3, "m/s2", description="specific force in body axes")
    rate = Output(3, "rad/s", display_unit="deg/s", description="rate with respect to inertial space, body axes")

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
    crab = State("rad", description="angle from track to heading, c")
    crab_rate = State("rad/s", description="its rate")
    crab_target = State("rad", description="angle from track to the air-relative velocity at the last tick")
    weathercock_decay = State("1", description="exp(-T/tau) of the weathercock")

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
    def periods_fit(self):
        ratio = self.plan_period / self.update_period
        return np.logical_and(ratio > 0.5, np.abs(ratio - np.floor(ratio + 0.5)) < 1e-6 * ratio)

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
    def begin_flight(self):
        plan = aircraft.schedule(*self._plan())
        self.segment_begin = plan["begin"]
        self.segment_end = plan["end"]
        self.segment_track = plan["track"]
        self.segment_altitude = plan["altitude"]
        self.segment_roll_time = plan["roll_time"]
        self.segment_climb_time = plan["climb_time"]
        self.segment_speed_time = plan["speed_time"]
        self.weathercock_decay = gauss_markov.decay(self.update_period, self.weathercock_time)
        self._choose_segment(0.0)
        self.latitude = self.initial_latitude
        self.longitude = self.initial_longitude
        self._publish(*self._motion(0.0))

    @every("update_period")
    def move(self):
        speed, turn, climb = self._motion(self.time - self.begin)
        middle_speed, middle_turn, _ = self._motion(self.time - self.begin - 0.5 * self.period)
        track = self.base_track + turn[3]
        half_turn = self.base_track + middle_turn[3] - track
        sine, cosine = np.sin(track), np.cos(track)
        middle_sine, middle_cosine = aircraft.turned(sine, cosine, half_turn)
        self.latitude, self.longitude = aircraft.move(
            self.latitude,
            self.longitude,
            self.altitude,
            self.velocity_n,
            (middle_speed[0] * middle_cosine, middle_speed[0] * middle_sine),
            (speed[0] * cosine, speed[0] * sine),
            self.base_altitude + climb[3],
            self.period,
        )
        target = aircraft.desired_crab(sine, cosine, speed[0], self.wind_n)
        self.crab, self.crab_rate = aircraft.weathercock(
            self.crab,
            self.crab_rate,
            self.crab_target,
            target,
            self.period,
            self.weathercock_time,
            self.weathercock_decay,
        )
        self.crab_target = target
        self._publish(speed, turn, climb)

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

    def _publish(self, speed, turn, climb):
        """Outputs from the motion; latitude, longitude and crab angle are up to date."""
        track = self.base_track + turn[3]
        self.altitude = self.base_altitude + climb[3]
        self.heading = track + self.crab
        self.velocity_n, self.roll, self.pitch, self.specific_force, self.rate = aircraft.kinematics(
            self.latitude,
            self.altitude,
            np.sin(track),
            np.cos(track),
            speed[:3],
            turn[:2],
            climb[:3],
            self.crab,
            self.crab_rate,
        )
