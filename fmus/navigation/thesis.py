"""What the navigators of the thesis have in common: all but the states of their filters, and ranges.

One filter, whose estimates are position and ``errors``, what is to be added to airspeed, heading, a forecast of the
wind and so on; its covariance has position first and ``errors`` behind it. A navigator says

    over_ground(errors), velocity_rows(errors)   velocity over ground, m/s, and its derivatives by the first of them
    error_model(speed, seen)                     sigma and correlation time of each
    fix_rows(rows)                               what a fix tells of the states: position, velocity, altitude
    height()                                     altitude, m
"""

from __future__ import annotations

import numpy as np

from fmus.navigation.interface import LEFT_OUT, NONE, Reckoning, known_share
from models.filters import kalman
from models.navigation import navigator
from models.satellite import gps
from navfmu.export import Output, Parameter, State, every, on_new

BEGUN_ANEW = 1.0e8
"""Variance of a position that is not believed at all, in variances of what it is begun anew from: more would leave
nothing of these in the digits of a number."""
PRINTED = {"gust_sigma": 0.0, "innovation_gate": 0.0}
"""The thesis has no gusts and no gates."""


def covariance(states: int) -> State:
    """The covariance of a filter with so many states."""
    elements = states * (states + 1) // 2
    return State(elements, "1", description="upper triangle of the filter's covariance, row by row")


def sigmas(states: int, meaning: str) -> Output:
    """Standard deviations of a filter's states."""
    return Output(states, "1", description=f"standard deviations of the filter's states: {meaning}")


class Thesis(Reckoning):
    """Dead reckoning, its covariance, and what GPS says."""

    calibration = Parameter(
        kind="boolean",
        start=True,
        description="whether what is wrong with wind, heading and airspeed is learned while there is GPS; false: each "
        "fix begins anew, with what the thesis knows at the start (Table 7.1)",
    )
    altitude_sigma = Parameter(
        "m",
        start=gps.VERTICAL_SIGMA,
        min=1.0e-3,
        description="standard deviation of the altitude of a fix (thesis section 3.10)",
    )

    known_share = known_share()

    latitude = State("rad", display_unit="deg", description="geodetic latitude")
    longitude = State("rad", display_unit="deg", description="longitude")
    velocity = State(2, "m/s", display_unit="kn", description="velocity over ground: north, east")
    had_seen = State(kind="boolean", description="there were air data and heading at the last step")

    def rescaled(self, sigmas, seen):
        """What errors are multiplied by as their sigmas change."""
        return 1.0

    def shaken(self, upper, step):
        """The covariance with what white noise does to it in ``step`` s."""
        return upper

    def first_sigmas(self):
        """Of the errors at the first fix."""
        return self.modelled

    @every("update_period")
    def dead_reckon(self):
        step = self.period
        seen = self.attitude_told() & self.air_told()
        self.airspeed = np.where(seen, self.air.true_airspeed, self.airspeed)
        self.nose = self.nose_now(seen)
        sigmas, times = self.error_model(np.sqrt(np.sum(self.velocity * self.velocity)), seen)
        factor, added = navigator.follow(self.modelled, sigmas, np.exp(-step / times), self.rescaled(sigmas, seen))
        errors = factor * self.errors
        now = self.over_ground(errors)
        mean = 0.5 * (np.where(self.had_air, self.velocity, now) + now)
        latitude, longitude = navigator.advance(self.latitude, self.longitude, self.height(), mean, step)
        rows = np.concatenate([np.eye(2), step * self.velocity_rows(errors)], -1)
        noise = np.concatenate([self.gusts(step) * step * step * np.ones(2), added])
        upper = self.shaken(kalman.propagate(self.upper, rows, factor, noise), step)
        running = self.initialised
        self.latitude = np.where(running, latitude, self.latitude)
        self.longitude = np.where(running, longitude, self.longitude)
        self.errors = np.where(running, errors, self.errors)
        self.upper = np.where(running, upper, self.upper)
        self.velocity = now
        self.modelled = sigmas
        self.remember()
        self.climb_on(step)
        self.had_seen = seen
        self.had_air = np.logical_or(self.had_air, seen)

    @on_new("fix")
    def take_fix(self):
        good = self.fix_told()
        first = good & np.logical_not(self.initialised)
        begins = good & (first | np.logical_not(self.calibration))
        self.learn_altitude(good, begins)
        self.errors = np.where(begins, 0.0, self.errors)
        self.velocity = self.over_ground(self.errors)
        moment, sigma = self.fix_moment(), self.fix_sigma_told()
        turned, carried, _ = self.turned_since(moment)
        passed = self.velocity * (self.time - moment) + carried
        there = navigator.advance(self.fix.latitude, self.fix.longitude, self.height(), passed, 1.0)
        self.latitude = np.where(begins, there[0], self.latitude)
        self.longitude = np.where(begins, there[1], self.longitude)
        start = np.concatenate([sigma * np.ones(2), self.first_sigmas()])
        start = (1.0 - self.known_share) * start * start
        upper = np.where(begins, kalman.of_variances(start), self.upper)

        away = navigator.offset(self.latitude, self.longitude, self.height(), *there)
        squares = away * away
        within = self.innovation_gate**2 * (kalman.diagonal(upper)[:2] + sigma**2)
        beyond = good & (self.innovation_gate > 0.0) & np.any(squares > within)
        since = np.maximum(moment - self.fix_time, 1.0e-3)
        velocity = self.fix.velocity_n[:2] - turned - self.velocity
        of_velocity = self.velocity_sigma**2 + self.gusts(since)
        placed, moving = good & np.logical_not(begins), good & self.had_air & self.calibration
        correction, self.upper, *_ = kalman.updates(
            np.zeros(kalman.order(upper)),
            np.where(beyond, navigator.anew(upper, BEGUN_ANEW * sigma**2), upper),
            self.fix_rows(self.velocity_rows(self.errors)),
            np.concatenate([sigma**2 * np.ones(2), of_velocity * np.ones(2), self.altitude_sigma[None] ** 2]),
            np.concatenate([away, velocity, (self.fix.altitude - self.height())[None]]),
            np.stack([placed, placed, moving, moving, placed]),
        )
        self.correct(correction)
        self.note_fix(good)

    @on_new("ranging")
    def take_ranges(self):
        self.gate = np.where(self.ranges_there() & self.ranging.valid, LEFT_OUT, NONE)

    def correct(self, correction):
        """Blend the corrections into the estimates, thesis (6.43)-(6.51)."""
        self.latitude, self.longitude = navigator.advance(
            self.latitude, self.longitude, self.height(), correction[:2], 1.0
        )
        self.errors = self.errors + correction[2:]
        self.velocity = self.over_ground(self.errors)

    @every("update_period")
    def report(self):
        self.state_sigma = np.sqrt(kalman.diagonal(self.upper))
        self.position_covariance = kalman.pack(kalman.unpack(self.upper)[:2, :2])
        self.north_sigma = self.state_sigma[0]
        self.east_sigma = self.state_sigma[1]
        self.tell_mode()
        self.solution.publish(
            latitude=self.latitude,
            longitude=self.longitude,
            altitude=self.height(),
            velocity_n=np.stack([self.velocity[0], self.velocity[1], -self.climb]),
            wind_n=self.wind_mean + self.wind_error(),
            valid=self.initialised,
        )
