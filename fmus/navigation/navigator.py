"""The FMU ``navigator``: DME-aided dead reckoning, the backup when GPS is lost."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.navigation.interface import PLACES, Reckoning
from fmus.navigation.small_aircraft import SETS
from models.filters import kalman
from models.navigation import navigator
from models.processes.known import known
from models.radio import dme
from navfmu.export import Component, Example, Output, Parameter, State, every, on_new

STATES = 2 + navigator.VELOCITIES + PLACES
FOREVER = 1.0e12
"""Correlation time of what is constant, s."""
SLOW = 1.0
"""Speed and error of a speed below which neither says how an error grows, m/s."""
BEGUN_ANEW = 1.0e4
"""Variance of a position that is not believed at all, in squares of what it is wrong by."""


class Navigator(Reckoning, Component):
    """Backup navigator: dead reckoning with airspeed, heading and wind, aided by GPS while there is GPS, then by DME.

    Thesis section 2.3 (calibrating and coasting phase) and 6.4 (full-order filter). Position is propagated by

        d(latitude)/dt = (V cos(heading) + V_NS) / (R_NS + h)                                (6.22)
        d(longitude)/dt = (V sin(heading) + V_EW) / ((R_EW + h) cos(latitude))               (6.23)

    every `update_period`, with heading carried from its time of validity to now by the yaw rate (at most 1 s), and h
    positive up. An extended Kalman filter has the perturbations (6.24) as states: north and east position, north and
    east wind and its mean, the error of air velocity along the nose (airspeed) and across it (heading times airspeed),
    and the bias of the range of each station. It is corrected in two phases:

    - *calibrating* (`mode` 1): each GPS fix corrects position (2 m) and velocity. A position beyond the gate is begun
      anew from the fix, without conclusions as to the wind.
    - *coasting* (`mode` 2): from the moment a fix is invalid or overdue by `fix_timeout`. Each DME range corrects
      along its line of sight, one scalar update after the other: L = P H' (H P H' + R)^-1 (the thesis prints H' P H in
      (6.39)), P+ = (I - L H) P (6.42). Residuals are measured minus predicted slant range on the ellipsoid, at the
      range's time of validity, instead of the ranges projected on a plane of (6.32). When GPS returns, so does the
      calibrating phase.

    The same filter runs through both: there is no switch-over, hence no step at the switch. Where only the augmentation
    of GPS (WAAS, LAAS) is lost, `augmented_protection` says so: it goes on to calibrate, by the larger sigma that the
    fix tells, and `guidance` falls from 1 to 2 (Fig 2.2). A fix whose sigma is beyond `fix_sigma_limit` is none.

    *Late fixes* are compared with position and velocity of the time at which they were valid, `fix_delay` before their
    `time_of_validity`, up to 1 s ago: with how the measured air velocity has changed since.

    *Error model.* Wind, airspeed, heading and range biases are Gauss-Markov with the sigmas and times of Table 6.1; the
    bias's time is 0.5 nmi / V, V the ground speed. The sigmas of heading and airspeed are what their instruments say of
    themselves (`attitude.heading_sigma`, `air.true_airspeed_sigma`). Gusts are too short to be states: a random walk of
    position and white noise on GPS velocity with their long-run density. The estimates decay as their models say, wind
    to its mean over the flight (the thesis keeps the estimates and lets their errors decay, which contradicts each
    other). That mean is a constant that nobody knows beforehand: forecast `wind_mean` with `wind_mean_sigma`, learned
    from what GPS shows, and afterwards from ranges, with what is not known of it in the claim. The thesis flies with
    the four states (6.54) and the wide-band noise of the ranges alone (6.40): `bias_sigma` 0 leaves the biases out as
    it does, and the filter then claims 10 m and is hundreds of metres wrong.

    *Without heading or airspeed* (`attitude.valid` or `air.valid` false) the last air velocity is held. The aircraft
    may turn anywhere: the errors along and across the nose get the ground speed that GPS last showed, or the airspeed
    if that is more, as their sigma, and live for `blind_time`. The DME ranges then carry the solution.

    *Gate.* A range whose innovation is larger than `innovation_gate` standard deviations is not used, and counted in
    `rejected`. The variant as printed has none.

    *Doubt.* Heading and airspeed may be wrong by more than they say. So there are two of this filter, on the same
    measurements: one believes them, to the other the error of the air velocity has that speed as its sigma (divided by
    sqrt(2) along and across). The ranges tell which one is right: their likelihoods by either make the odds
    (`log_odds`), from `prior` on and never below it, and the solution and its covariance are those of the mixture.
    From odds of 1 / prior^2 on, or if an estimate is further from what its model expects than `estimate_limit` allows,
    the first filter is no longer heard (`doubted`) until GPS is back.

    A range that the first filter refuses counts as far as it is news, 1 - exp(-dt / tau) with the time tau of the bias.
    One that the second refuses, too, widens its position, by what its variance lacks of the innovation's square,
    as far as it is news. Neither is so while the station is outvoted: by more stations whose ranges are used and cross
    well (dilution at most `dilution_limit`). A single station whose range jumps by more than bias and aircraft can have
    changed since it was last heard is not used until it jumps again or GPS is back (`astray`).

    *Altitude* is pressure altitude plus an offset learned from GPS while calibrating.
    """

    parameter_sets = SETS
    example = Example(
        text="Level flight to the west at 90 kn in a wind of 15 kn, with heading wrong by 1 degree and airspeed by "
        "2 m/s. GPS is lost at 300 s (dotted). While there is GPS the position is good to metres and the wind "
        "is learned (together with what heading and airspeed are wrong by). Then one DME range every 15 s, each "
        "wrong by some 315 m, keeps the error inside three sigma (dashed).",
        duration=1200.0,
        step=0.1,
        mark=examples.GPS_LOST,
        inputs=examples.navigator_inputs,
        periods={"fix": 1.0, "ranging": 15.0},
        shows=("solution.wind_n", "mode", "hdop", "used"),
        panels=examples.navigator_panels,
    )

    wind_mean_sigma = Parameter(
        "m/s",
        start=8.0,
        min=0.0,
        max=100.0,
        display_unit="kn",
        description="standard deviation of the mean wind about this forecast, on each axis; 0: it is known",
    )
    prior = Parameter(
        "1",
        start=1.0e-3,
        min=0.0,
        max=0.5,
        description="probability, before any range tells, that heading or airspeed are wrong by more than they say; "
        "0: they are believed whatever ranges say (own choice)",
    )
    estimate_limit = Parameter(
        "1",
        start=5.0,
        min=0.0,
        description="standard deviations of its own model beyond which an estimate contradicts it (own choice)",
    )

    state_sigma = Output(
        STATES,
        "1",
        description="standard deviations of the filter's states: position (m), wind and its mean (m/s), north and "
        "east each; air velocity along and across the nose (m/s); bias of each station's ranges (m)",
    )
    doubted = Output(kind="boolean", description="ranges have contradicted heading or airspeed since GPS was lost")

    latitude = State(2, "rad", display_unit="deg", description="geodetic latitude by either filter")
    longitude = State(2, "rad", display_unit="deg", description="longitude by either filter")
    wind = State((2, 2), "m/s", description="wind of either filter: north, east")
    mean_wind = State((2, 2), "m/s", description="its mean over the flight")
    air_error = State((2, 2), "m/s", description="to be added to the measured air velocity: along the nose, across")
    range_bias = State((2, PLACES), "m", description="bias of each station's ranges")
    modelled = State(
        (2, STATES - 2), "1", description="standard deviations of wind, its mean, air_error and range_bias"
    )
    air_velocity = State((2, 2), "m/s", description="velocity relative to the air: north, east; corrected")
    covariances = State(
        (2, STATES * (STATES + 1) // 2),
        "1",
        description="of either filter the upper triangle of the covariance of (6.24), row by row; m and m/s",
    )
    log_odds = State("1", description="logarithm of the odds that air data and heading are not to be believed")
    misfit = State(
        (2, PLACES), "m", description="each station's last range less what the solution now says, taken or not"
    )
    astray = State(PLACES, kind="boolean", description="stations whose range jumped further than the aircraft can")

    def error_model(self, speed, seen):
        """Sigma (m/s and m) and correlation time of each Gauss-Markov state at the ground speed ``speed`` of each
        filter, shape (2, states); ``seen``: there are heading and airspeed."""
        doubt = np.where(seen, np.array([0.0, np.sqrt(0.5)]), 1.0) * self.top_speed()
        own = np.ones((2, 1))
        sigmas = np.concatenate(
            [
                self.wind_sigma * np.ones((2, 2)),
                self.wind_mean_sigma * np.ones((2, 2)),
                np.hypot(known(self.air.true_airspeed_sigma, 0.0), doubt)[:, None],
                np.hypot(known(self.attitude.heading_sigma * self.air.true_airspeed, 0.0), doubt)[:, None],
                self.bias_sigma * np.ones((2, PLACES)),
            ],
            -1,
        )
        bias_time = self.correlation_distance / np.maximum(speed, 1.0)
        times = np.concatenate(
            [
                self.wind_time * np.ones((2, 2)),
                FOREVER * np.ones((2, 2)),
                own * np.where(seen, np.stack([self.airspeed_time, self.heading_time]), self.blind_time),
                bias_time[:, None] * np.ones(PLACES),
            ],
            -1,
        )
        return sigmas, times

    def rescaled(self, sigmas, airspeed, seen):
        """What errors are multiplied by as the speed changes, shape (2, states): what is wrong with the airspeed goes
        with its sigma, heading with the airspeed, and air velocity that is not believed with its own speed. What is
        slower than ``SLOW`` counts as that: an error that is next to nothing tells nothing of a larger one."""
        grown = np.maximum(sigmas[:, 4:6], SLOW) / np.maximum(self.modelled[:, 4:6], SLOW)
        faster = np.maximum(airspeed, SLOW) / np.maximum(self.airspeed, SLOW)
        air = np.where(seen, np.where(np.array([[0.0, 1.0], [0.0, 0.0]]) > 0.5, faster, grown), 1.0)
        return np.concatenate([np.ones((2, 4)), air, np.ones((2, PLACES))], -1)

    def estimates(self):
        """Of the Gauss-Markov states by either filter, and of the mean wind less its forecast, shape (2, states)."""
        winds = self.wind - self.mean_wind, self.mean_wind - self.wind_mean
        return np.concatenate([*winds, self.air_error, self.range_bias], -1)

    def least_odds(self):
        """Logarithm of the odds before any range tells."""
        return np.log(np.maximum(self.prior, 1.0e-300))

    def doubt(self):
        """Probability that air data and heading are not to be believed."""
        return np.where(self.doubted, 1.0, 1.0 / (1.0 + np.exp(-self.log_odds)))

    @every("update_period")
    def dead_reckon(self):
        step = self.period
        seen = self.attitude_told() & self.air_told()
        before = self.air_velocity + self.wind
        sigmas, times = self.error_model(np.sqrt(np.sum(before * before, axis=-1)), seen)
        decay = np.exp(-step / times)
        airspeed = np.where(seen, self.air.true_airspeed, self.airspeed)
        factor, added = navigator.follow(self.modelled, sigmas, decay, self.rescaled(sigmas, airspeed, seen))
        air_error = factor[:, 4:6] * self.air_error
        wind = self.mean_wind + factor[:, :2] * (self.wind - self.mean_wind)

        heading = self.nose_now(seen)
        rows = navigator.velocity_rows(heading)
        now = navigator.air_velocity(airspeed, heading) + air_error @ rows[:, 4:].T
        over_ground = 0.5 * (np.where(self.had_air, before, now + self.wind) + now + wind)
        latitude, longitude = navigator.advance(self.latitude, self.longitude, self.altitude, over_ground.T, step)
        walk = self.gusts(step) * step * step
        covariances = navigator.propagate(self.covariances, step, rows, factor, added, walk)
        running = self.initialised
        self.latitude = np.where(running, latitude, self.latitude)
        self.longitude = np.where(running, longitude, self.longitude)
        self.wind = np.where(running, wind, self.wind)
        self.air_error = np.where(running, air_error, self.air_error)
        self.range_bias = factor[:, 6:] * self.range_bias
        self.covariances = np.where(running, covariances, self.covariances)
        self.modelled = sigmas
        self.nose = heading
        self.airspeed = airspeed

        self.remember()
        self.climb_on(step)
        self.air_velocity = now
        self.had_air = np.logical_or(self.had_air, seen)

    @on_new("fix")
    def take_fix(self):
        good = self.fix_told()
        first = np.logical_and(good, np.logical_not(self.initialised))
        fix_sigma = self.fix_sigma_told()
        start = np.concatenate([fix_sigma * np.ones((2, 2)), self.modelled], -1) ** 2
        latitude = np.where(first, self.fix.latitude, self.latitude)
        longitude = np.where(first, self.fix.longitude, self.longitude)
        self.wind = np.where(first, self.wind_mean, self.wind)
        self.mean_wind = np.where(first, self.wind_mean, self.mean_wind)
        start_covariances = np.stack([kalman.of_variances(start[0]), kalman.of_variances(start[1])])
        covariances = np.where(first, start_covariances, self.covariances)

        moment = self.fix_moment()
        turned, carried, angle = self.turned_since(moment)
        velocity = self.air_velocity + self.wind
        rows, rows_now = navigator.velocity_rows(self.nose + angle), navigator.velocity_rows(self.nose)
        velocity_then = velocity + turned + self.air_error @ (rows - rows_now)[:, 4:].T
        offset = navigator.offset(latitude, longitude, self.altitude, self.fix.latitude, self.fix.longitude)
        residual = velocity * (self.time - moment) + carried + offset.T
        squares = residual * residual
        within = self.innovation_gate**2 * (kalman.diagonal(covariances)[:, :2] + fix_sigma**2)
        beyond = good & (self.innovation_gate > 0.0) & np.any(squares > within, axis=-1)
        begun = navigator.anew(covariances, (BEGUN_ANEW * np.max(squares, axis=-1))[:, None])
        since = np.maximum(moment - self.fix_time, 1.0e-3)
        correction, self.covariances = navigator.fix_updates(
            np.zeros((2, STATES)),
            np.where(beyond[:, None], begun, covariances),
            residual,
            self.fix.velocity_n[:2] - velocity_then,
            rows,
            (fix_sigma**2, self.velocity_sigma**2 + self.gusts(since)),
            (good, np.logical_and(good, self.had_air)),
        )
        self.latitude, self.longitude = latitude, longitude
        self.correct(correction)

        self.learn_altitude(good, first)
        self.note_fix(good)
        self.doubted = np.logical_and(self.doubted, np.logical_not(good))
        self.log_odds = np.where(good, self.least_odds(), self.log_odds)
        self.astray = np.logical_and(self.astray, np.logical_not(good))

    def correct(self, correction):
        """Blend the corrections of (6.24) into the estimates, thesis (6.43)-(6.51)."""
        self.latitude, self.longitude = navigator.advance(
            self.latitude, self.longitude, self.altitude, correction[:, :2].T, 1.0
        )
        self.wind = self.wind + correction[:, 2:4] + correction[:, 4:6]
        self.mean_wind = self.mean_wind + correction[:, 4:6]
        self.air_error = self.air_error + correction[:, 6:8]
        self.air_velocity = self.air_velocity + correction[:, 6:8] @ navigator.velocity_rows(self.nose)[:, 4:].T
        self.range_bias = self.range_bias + correction[:, 8:]

    def sights(self, latitude, longitude):
        """Direction cosines north and east of the lines of sight and their lengths (m), each of shape (2, stations)."""
        seen = []
        for filter_ in range(2):
            sight = dme.line_of_sight(
                latitude[filter_],
                longitude[filter_],
                self.altitude,
                self.station_latitude,
                self.station_longitude,
                self.station_altitude,
            )
            seen.append(navigator.direction_cosines(latitude[filter_], longitude[filter_], sight))
        return tuple(np.stack(parts) for parts in zip(*seen, strict=True))

    @on_new("ranging")
    def take_ranges(self):
        moment = self.ranging.time_of_validity
        velocity = self.air_velocity + self.wind
        latitude, longitude = navigator.advance(
            self.latitude, self.longitude, self.altitude, velocity.T, moment - self.time
        )
        north, east, distance = self.sights(latitude, longitude)
        wanted = self.wants_ranges()
        measured = self.ranges_there() & wanted
        innovation = np.where(measured, self.ranging.slant_range - distance - self.range_bias, 0.0)
        doubted = self.doubted

        def leading(values):
            return np.where(doubted, values[1], values[0])

        # a station whose range jumps, in the time since it was last heard, further than the aircraft and its bias can
        heard = np.maximum(self.range_time, self.refused_time)
        since = moment - heard
        speed = self.top_speed()
        news = navigator.news(since, self.correlation_distance / np.maximum(speed, 1.0))
        reach = self.innovation_gate * np.sqrt(2.0) * self.bias_sigma + speed * since
        jumped = measured & (heard > self.fix_time) & (leading(np.abs(innovation - self.misfit)) > reach)
        astray = self.astray & np.logical_not(jumped)

        offered = measured & np.logical_not(astray)
        unused = np.maximum(moment - self.range_time, 1.0e-3)
        curvature = navigator.curvature(self.covariances, north, east, distance)
        lasting = navigator.lasting(curvature, unused, self.wind_time)
        correction, covariances, taken, innovations, spreads = navigator.range_updates(
            np.zeros((2, STATES)),
            self.covariances,
            north,
            east,
            innovation,
            self.noise_sigma**2 + curvature + lasting,
            offered,
            self.innovation_gate,
        )
        self.correct(correction)
        told = navigator.evidence(innovations, spreads, lasting, self.innovation_gate)
        by_first, by_second = taken
        taken = leading(taken)
        self.judge(offered, taken, leading(innovations), leading(spreads))
        refused = np.logical_and(measured, np.logical_not(taken))
        self.rejected = self.rejected + np.sum(np.where(refused, 1.0, 0.0))
        self.used = self.used + np.sum(np.where(taken, 1.0, 0.0))

        was_against = self.refused_time > self.range_time
        moved = north * correction[:, :1] + east * correction[:, 1:2] + correction[:, 8:]
        self.misfit = np.where(measured, innovation, self.misfit) - moved
        self.range_time = np.where(taken, moment, self.range_time)
        self.refused_time = np.where(refused, moment, self.refused_time)
        used = self.used_lately(moment)
        recent = moment - self.refused_time <= self.geometry_window
        against = recent & (self.refused_time > np.maximum(self.range_time, self.fix_time))
        believed = used & np.logical_not(against)
        cosines = leading(north), leading(east)
        self.hdop = np.where(wanted, dme.dilution(*cosines, used), self.hdop)

        several = np.sum(np.where(against, 1.0, 0.0)) > 1.5
        alone = jumped & refused & np.logical_not(was_against | doubted)
        self.astray = np.logical_and(astray | alone, np.logical_not(several))
        outvoted = navigator.outvoted(against, believed, dme.dilution(*cosines, believed), self.dilution_limit)
        heeded = measured & np.logical_not(astray) & np.logical_not(against & (outvoted | self.astray))
        lacking = np.maximum(innovation**2 - navigator.variance_along(covariances, north, east), 0.0)[1]
        lacking = np.max(np.where(heeded & np.logical_not(by_second), news * lacking, 0.0))
        self.covariances = navigator.widen(covariances, np.stack([0.0, lacking]))
        told = np.where(heeded & (self.prior > 0.0), told * np.where(by_first, 1.0, news), 0.0)
        least = self.least_odds()
        self.log_odds = np.maximum(self.log_odds + np.sum(told), least)
        improbable = navigator.improbable(self.estimates()[0], self.modelled[0], self.estimate_limit)
        heard = (self.prior > 0.0) & np.any(heeded)
        self.doubted = self.doubted | (heard & (improbable | (self.log_odds > -2.0 * least)))

    @every("update_period")
    def report(self):
        doubt = self.doubt()
        weights = np.stack([1.0 - doubt, doubt])
        velocity = weights @ (self.air_velocity + self.wind)
        latitude, longitude = weights @ self.latitude, weights @ self.longitude
        apart = navigator.offset(
            self.latitude[0], self.longitude[0], self.altitude, self.latitude[1], self.longitude[1]
        )
        shared = (1.0 - doubt) * doubt * np.stack([apart[0] * apart[0], apart[0] * apart[1], apart[1] * apart[1]])
        parts = kalman.unpack(self.covariances)[:, :2, :2]
        self.position_covariance = weights @ kalman.pack(parts) + shared
        self.north_sigma = np.sqrt(self.position_covariance[0])
        self.east_sigma = np.sqrt(self.position_covariance[2])
        others = self.estimates()
        spread = (
            weights @ kalman.diagonal(self.covariances)[:, 2:] + (1.0 - doubt) * doubt * (others[0] - others[1]) ** 2
        )
        self.state_sigma = np.concatenate(
            [self.north_sigma[None], self.east_sigma[None], np.sqrt(np.maximum(spread, 0.0))]
        )
        self.tell_mode()
        self.solution.publish(
            latitude=latitude,
            longitude=longitude,
            altitude=self.altitude,
            velocity_n=np.stack([velocity[0], velocity[1], -self.climb]),
            wind_n=weights @ self.wind,
            valid=self.initialised,
        )
