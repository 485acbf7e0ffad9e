"""The FMU ``navigator``: DME-aided dead reckoning, the backup when GPS is lost."""

from __future__ import annotations

import numpy as np

from fmus import examples, stations
from models import dme, gauss_markov, gps, kalman, navigator
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, on_new

PLACES = stations.PLACES
STATES = 2 + navigator.VELOCITIES + PLACES
LONG_AGO = -1.0e9
BEGUN_ANEW = 1.0e4
"""Variance of a position that is not believed at all, in squares of what it is wrong by."""


class Navigator(stations.StationTable, Component):
    """Backup navigator: dead reckoning with airspeed, heading and wind, aided by GPS while there is GPS, then by DME.

    Thesis section 2.3 (calibrating and coasting phase) and 6.4 (full-order filter). Position is propagated by

        d(latitude)/dt = (V cos(heading) + V_NS) / (R_NS + h)                                (6.22)
        d(longitude)/dt = (V sin(heading) + V_EW) / ((R_EW + h) cos(latitude))               (6.23)

    every `update_period`, with heading carried from its time of validity to now by the yaw rate (at most 1 s), and h
    positive up. An extended Kalman filter has the perturbations (6.24) as states: north and east position, north and
    east wind, the error of air velocity along the nose (airspeed) and across it (heading times airspeed), and the bias
    of the range of each station. It is corrected in two phases:

    - *calibrating* (`mode` 1): each GPS fix corrects position (2 m) and velocity. A position beyond the gate is begun
      anew from the fix, without conclusions as to the wind.
    - *coasting* (`mode` 2): from the moment a fix is invalid or overdue by `fix_timeout`. Each DME range corrects
      along its line of sight, one scalar update after the other: L = P H' (H P H' + R)^-1 (the thesis prints H' P H in
      (6.39)), P+ = (I - L H) P (6.42). Residuals are measured minus predicted slant range on the ellipsoid, at the
      range's time of validity, instead of the ranges projected on a plane of (6.32). When GPS returns, so does the
      calibrating phase.

    The same filter runs through both: there is no switch-over, hence no step at the switch.

    *Error model.* Wind, airspeed, heading and range biases are Gauss-Markov with the sigmas and times of Table 6.1;
    the bias's time is 0.5 nmi / V, V the ground speed. Heading's sigma is what the heading reference says of itself
    (`attitude.heading_sigma`). Gusts are too short to be states: a random walk of position and white noise on GPS
    velocity with their long-run density. The estimates decay as their models say, wind to `wind_mean` (the thesis keeps
    the estimates and lets their errors decay, which contradicts each other). The thesis flies with the four states
    (6.54) and the wide-band noise of the ranges alone (6.40): `bias_sigma` 0 leaves the biases out as it does, and the
    filter then claims 10 m and is hundreds of metres wrong.

    *Without heading or airspeed* (`attitude.valid` or `air.valid` false) the last air velocity is held. The aircraft
    may turn anywhere: the errors along and across the nose get the ground speed that GPS last showed, or the airspeed
    if that is more, as their sigma, and live for `blind_time`. The DME ranges then carry the solution.

    *Gate.* A range whose innovation is larger than `innovation_gate` standard deviations is not used, and counted in
    `rejected`. The variant as printed has none.

    *Doubt.* Ranges that are refused again and again are evidence against the state. A refusal counts as far as it is
    news, 1 - exp(-dt / tau) with the time tau of the bias, and those of all stations whose last range was refused
    add up. When they reach `patience`, either these stations or the filter are wrong. The stations are, if they are
    fewer than those whose ranges are used and these cross well (dilution at most `dilution_limit`); and so is a
    single one, whatever the others, that was refused when its range jumped by more than bias and aircraft can have
    changed since it was last heard: it is not used until it jumps again or GPS is back
    (`astray`). Otherwise dead reckoning is: `doubted` stays true until GPS is back, position gets what its variance
    lacks of the refused innovation's square, and the air velocity counts as little as if it were missing, but keeps its
    correlation times.

    *Altitude* is pressure altitude plus an offset learned from GPS while calibrating.
    """

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

    attitude = Bundle(
        heading=Input("rad", display_unit="deg", description="true heading"),
        yaw_rate=Input("rad/s", display_unit="deg/s", description="rate of heading"),
        heading_sigma=Input(
            "rad",
            start=np.radians(2.5),
            min=0.0,
            display_unit="deg",
            description="standard deviation of heading by its reference (thesis (3.84), p. 101: 2.5 deg)",
        ),
        description="attitude",
    )
    air = Bundle(
        true_airspeed=Input("m/s", display_unit="kn", description="true airspeed"),
        pressure_altitude=Input("m", display_unit="ft", description="pressure altitude"),
        description="air data",
    )
    fix = Bundle(
        latitude=Input("rad", display_unit="deg", description="geodetic latitude of the fix"),
        longitude=Input("rad", display_unit="deg", description="longitude of the fix"),
        altitude=Input("m", display_unit="ft", description="height of the fix above the ellipsoid"),
        velocity_n=Input(3, "m/s", display_unit="kn", description="velocity over ground: north, east, down"),
        description="GPS fix",
    )
    ranging = Bundle(
        slant_range=Input(PLACES, "m", display_unit="nmi", description="measured distance to each station"),
        measured=Input(PLACES, kind="boolean", description="which ranges were measured"),
        description="DME ranges",
    )

    dme_aiding = Parameter(kind="boolean", start=True, description="whether DME ranges are used; false: open loop")
    update_period = Parameter("s", start=0.1, min=0.001, max=1.0, description="period of dead reckoning")
    fix_timeout = Parameter(
        "s", start=3.0, min=0.0, max=3600.0, description="age of the last good fix from which GPS counts as lost"
    )
    wind_mean = Parameter(
        2,
        "m/s",
        start=0.0,
        min=-100.0,
        max=100.0,
        display_unit="kn",
        description="forecast wind, north and east, to which the estimate decays",
    )
    wind_sigma = Parameter(
        "m/s",
        start=5.0,
        min=0.0,
        display_unit="kn",
        description="standard deviation of the wind about its mean (thesis (3.36), p. 69)",
    )
    wind_time = Parameter("s", start=400.0, min=1.0, description="correlation time of the wind (thesis (3.36))")
    heading_time = Parameter(
        "s", start=120.0, min=1.0, description="correlation time of the heading error (thesis (3.85))"
    )
    airspeed_sigma = Parameter(
        "m/s",
        start=2.6,
        min=0.0,
        display_unit="kn",
        description="standard deviation of the airspeed error (thesis (3.32), p. 64)",
    )
    airspeed_time = Parameter("s", start=400.0, min=1.0, description="its correlation time (thesis (3.32))")
    gust_sigma = Parameter(
        "m/s",
        start=1.524,
        min=0.0,
        display_unit="kn",
        description="intensity of the gusts on each axis; light turbulence of MIL-F-8785C: 5 ft/s",
    )
    gust_length = Parameter(
        "m", start=533.4, min=1.0, display_unit="ft", description="scale of the gusts, MIL-F-8785C: 1750 ft"
    )
    fix_sigma = Parameter(
        "m",
        start=gps.HORIZONTAL_SIGMA,
        min=1.0e-3,
        description="standard deviation of north and of east of a fix (thesis section 3.10)",
    )
    velocity_sigma = Parameter(
        "m/s", start=gps.VELOCITY_SIGMA, min=1.0e-3, description="standard deviation of GPS velocity, each component"
    )
    bias_sigma = Parameter(
        "m",
        start=dme.BIAS_SIGMA,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of the bias of DME ranges: 0.17 nmi (thesis (3.38), p. 72)",
    )
    correlation_distance = Parameter(
        "m",
        start=dme.CORRELATION_DISTANCE,
        min=1.0,
        display_unit="nmi",
        description="distance over which that bias is correlated: 0.5 nmi (thesis (3.38))",
    )
    noise_sigma = Parameter(
        "m",
        start=dme.NOISE_SIGMA,
        min=1.0e-3,
        display_unit="nmi",
        description="standard deviation of the wide-band noise of DME ranges: 0.004 nmi (thesis (3.38), (6.40))",
    )
    innovation_gate = Parameter(
        "1",
        start=4.0,
        min=0.0,
        description="ranges with a larger innovation, in standard deviations, are rejected; 0: none (own choice)",
    )
    geometry_window = Parameter(
        "s",
        start=90.0,
        min=0.0,
        description="stations whose ranges were used within this time count in `hdop` "
        "(own choice: five stations in turn, one every 15 s)",
    )
    patience = Parameter(
        "1",
        start=2.0,
        min=0.0,
        description="refused ranges, counted as far as they are news, that raise doubt (own choice)",
    )
    dilution_limit = Parameter(
        "1",
        start=2.83,
        min=1.0,
        description="dilution up to which stations fix a position: lines of sight that cross at 30 to 150 degrees "
        "(AC 90-100A)",
    )
    blind_time = Parameter(
        "s",
        start=60.0,
        min=1.0,
        description="time in which the aircraft may turn away while heading or airspeed are missing (own choice)",
    )
    climb_time = Parameter(
        "s", start=10.0, min=0.01, description="time constant of the vertical speed filter (own choice)"
    )
    altitude_gain = Parameter(
        "1",
        start=0.05,
        min=0.0,
        max=1.0,
        description="part of the altitude error corrected by each GPS fix (own choice)",
    )

    solution = Bundle(
        latitude=Output("rad", display_unit="deg", description="estimated geodetic latitude"),
        longitude=Output("rad", display_unit="deg", description="estimated longitude"),
        altitude=Output("m", display_unit="ft", description="estimated height above the ellipsoid"),
        velocity_n=Output(3, "m/s", display_unit="kn", description="estimated velocity over ground: north, east, down"),
        wind_n=Output(2, "m/s", display_unit="kn", description="estimated wind: north, east"),
        description="navigation solution",
    )
    north_sigma = Output("m", description="standard deviation of north position by the filter's covariance")
    east_sigma = Output("m", description="standard deviation of east position by the filter's covariance")
    mode = Output(kind="integer", min=0, max=2, description="0 initialising, 1 calibrating (GPS), 2 coasting (no GPS)")
    hdop = Output(
        "1", start=99.0, description="dilution of precision of the ranges used lately; 99: lines do not cross"
    )
    doubted = Output(kind="boolean", description="ranges have contradicted dead reckoning since GPS was lost")
    rejected = Output(kind="integer", min=0, description="number of ranges that the innovation gate rejected")
    used = Output(kind="integer", min=0, description="number of ranges that corrected the solution")

    latitude = State("rad", display_unit="deg", description="geodetic latitude")
    longitude = State("rad", display_unit="deg", description="longitude")
    altitude = State("m", display_unit="ft", description="height above the ellipsoid")
    altitude_offset = State("m", description="altitude minus pressure altitude, learned from GPS")
    pressure_altitude = State("m", description="last pressure altitude")
    climb = State("m/s", description="filtered vertical speed, positive up")
    wind = State(2, "m/s", description="wind: north, east")
    air_error = State(2, "m/s", description="to be added to the measured air velocity: along the nose, across it")
    range_bias = State(PLACES, "m", description="bias of each station's ranges")
    modelled = State(STATES - 2, "1", description="standard deviations of wind, air_error and range_bias; m/s and m")
    airspeed = State("m/s", display_unit="kn", description="measured airspeed in use")
    nose = State("rad", display_unit="deg", description="heading of the air velocity in use")
    air_velocity = State(2, "m/s", description="velocity relative to the air: north, east; corrected")
    covariance = State(
        STATES * (STATES + 1) // 2, "1", description="upper triangle of the covariance of (6.24), row by row; m and m/s"
    )
    had_air = State(kind="boolean", description="air data and heading have been seen")
    initialised = State(kind="boolean", description="the first fix has been seen")
    fix_time = State("s", start=LONG_AGO, description="time of the last good fix")
    last_speed = State("m/s", display_unit="kn", description="ground speed by the last good fix")
    fix_good = State(kind="boolean", description="the last report of the receiver was a good fix")
    range_time = State(PLACES, "s", start=LONG_AGO, description="when each station's range was last used")
    refused_time = State(PLACES, "s", start=LONG_AGO, description="when each station's range was last refused")
    refusals = State(PLACES, "1", description="ranges refused in a row, counted as far as they are news")
    innovation = State(
        PLACES, "m", description="each station's last range less what the solution now says, taken or not"
    )
    astray = State(PLACES, kind="boolean", description="stations whose range jumped further than the aircraft can")

    def error_model(self, speed, seen):
        """Sigma (m/s and m) and correlation time of each Gauss-Markov state at the ground speed ``speed``; ``seen``:
        there are heading and airspeed."""
        doubt = np.where(np.logical_and(seen, np.logical_not(self.doubted)), 0.0, self.top_speed())
        along = np.hypot(self.airspeed_sigma, doubt)
        across = np.hypot(self.attitude.heading_sigma * self.air.true_airspeed, doubt)
        bias_time = self.correlation_distance / np.maximum(speed, 1.0)
        sigmas = np.concatenate(
            [
                np.stack([self.wind_sigma, self.wind_sigma, along, across]),
                self.bias_sigma * np.ones(PLACES),
            ]
        )
        times = np.concatenate(
            [
                np.stack([self.wind_time, self.wind_time]),
                np.where(seen, np.stack([self.airspeed_time, self.heading_time]), self.blind_time),
                bias_time * np.ones(PLACES),
            ]
        )
        return sigmas, times

    def top_speed(self):
        """The faster of ground speed by the last fix and airspeed, m/s: GPS may have been lost before take-off."""
        return np.maximum(self.last_speed, self.airspeed)

    def gusts(self, since):
        """Variance of independent gusts every ``since`` s that do the same to position as those that last, (m/s)^2."""
        time = self.gust_length / np.maximum(self.last_speed, 1.0)
        return gauss_markov.white_equivalent(self.gust_sigma**2, since, time)

    @every("update_period")
    def dead_reckon(self):
        step = self.period
        seen = np.logical_and(self.attitude.valid, self.air.valid)
        before = self.air_velocity + self.wind
        sigmas, times = self.error_model(np.sqrt(np.sum(before * before)), seen)
        decay = np.exp(-step / times)
        factor, added = navigator.follow(self.modelled, sigmas, decay)
        air_error = factor[2:4] * self.air_error
        wind = self.wind_mean + factor[:2] * (self.wind - self.wind_mean)

        age = np.clip(self.time - self.attitude.time_of_validity, -1.0, 1.0)
        heading = np.where(seen, self.attitude.heading + self.attitude.yaw_rate * age, self.nose)
        airspeed = np.where(seen, self.air.true_airspeed, self.airspeed)
        rows = navigator.velocity_rows(heading)
        now = navigator.air_velocity(airspeed, heading) + rows[:, 2:] @ air_error
        over_ground = 0.5 * (np.where(self.had_air, before, now + self.wind) + now + wind)
        latitude, longitude = navigator.advance(self.latitude, self.longitude, self.altitude, over_ground, step)
        walk = self.gusts(step) * step * step
        covariance = navigator.propagate(self.covariance, step, rows, factor, added, walk)
        running = self.initialised
        self.latitude = np.where(running, latitude, self.latitude)
        self.longitude = np.where(running, longitude, self.longitude)
        self.wind = np.where(running, wind, self.wind)
        self.air_error = np.where(running, air_error, self.air_error)
        self.range_bias = factor[4:] * self.range_bias
        self.covariance = np.where(running, covariance, self.covariance)
        self.modelled = sigmas
        self.nose = heading
        self.airspeed = airspeed

        pressure_altitude = np.where(self.air.valid, self.air.pressure_altitude, self.pressure_altitude)
        rise = np.where(self.had_air, pressure_altitude - self.pressure_altitude, 0.0)
        self.climb = self.climb + (rise - self.climb * step) / np.maximum(self.climb_time, step)
        self.pressure_altitude = pressure_altitude
        self.altitude = pressure_altitude + self.altitude_offset
        self.air_velocity = now
        self.had_air = np.logical_or(self.had_air, seen)

    @on_new("fix")
    def take_fix(self):
        good = self.fix.valid
        first = np.logical_and(good, np.logical_not(self.initialised))
        start_covariance = kalman.of_variances(np.concatenate([np.stack([self.fix_sigma] * 2), self.modelled]) ** 2)
        latitude = np.where(first, self.fix.latitude, self.latitude)
        longitude = np.where(first, self.fix.longitude, self.longitude)
        self.wind = np.where(first, self.wind_mean, self.wind)
        covariance = np.where(first, start_covariance, self.covariance)

        age = self.time - self.fix.time_of_validity
        velocity = self.air_velocity + self.wind
        residual = velocity * age + navigator.offset(
            latitude, longitude, self.altitude, self.fix.latitude, self.fix.longitude
        )
        squares = residual * residual
        within = self.innovation_gate**2 * (kalman.diagonal(covariance)[:2] + self.fix_sigma**2)
        beyond = good & (self.innovation_gate > 0.0) & np.any(squares > within)
        since = np.maximum(self.fix.time_of_validity - self.fix_time, 1.0e-3)
        correction, self.covariance = navigator.fix_updates(
            np.zeros(STATES),
            np.where(beyond, navigator.anew(covariance, BEGUN_ANEW * np.max(squares)), covariance),
            residual,
            self.fix.velocity_n[:2] - velocity,
            navigator.velocity_rows(self.nose),
            (self.fix_sigma**2, self.velocity_sigma**2 + self.gusts(since)),
            (good, np.logical_and(good, self.had_air)),
        )
        self.latitude, self.longitude = latitude, longitude
        self.correct(correction)

        error = self.fix.altitude - self.pressure_altitude - self.altitude_offset
        gain = np.where(first, 1.0, self.altitude_gain)
        self.altitude_offset = self.altitude_offset + np.where(good, gain * error, 0.0)
        self.altitude = self.pressure_altitude + self.altitude_offset
        self.fix_time = np.where(good, self.fix.time_of_validity, self.fix_time)
        self.fix_good = good
        ground_speed = np.sqrt(np.sum(self.fix.velocity_n[:2] * self.fix.velocity_n[:2]))
        self.last_speed = np.where(good, ground_speed, self.last_speed)
        self.initialised = np.logical_or(self.initialised, good)
        self.doubted = np.logical_and(self.doubted, np.logical_not(good))
        self.refusals = np.where(good, 0.0, self.refusals)
        self.astray = np.logical_and(self.astray, np.logical_not(good))

    def correct(self, correction):
        """Blend the corrections of (6.24) into the estimates, thesis (6.43)-(6.51)."""
        self.latitude, self.longitude = navigator.advance(
            self.latitude, self.longitude, self.altitude, correction[:2], 1.0
        )
        self.wind = self.wind + correction[2:4]
        self.air_error = self.air_error + correction[4:6]
        self.air_velocity = self.air_velocity + navigator.velocity_rows(self.nose)[:, 2:] @ correction[4:6]
        self.range_bias = self.range_bias + correction[6:]

    def calibrating(self):
        """Whether there is GPS: the last report was good, is not too old, and still says so (a dropout clears
        `valid`)."""
        fresh = self.time - self.fix_time <= self.fix_timeout + 1.0e-6
        return self.fix_good & self.fix.valid & fresh

    @on_new("ranging")
    def take_ranges(self):
        moment = self.ranging.time_of_validity
        velocity = self.air_velocity + self.wind
        latitude, longitude = navigator.advance(
            self.latitude, self.longitude, self.altitude, velocity, moment - self.time
        )
        sight = dme.line_of_sight(
            latitude,
            longitude,
            self.altitude,
            self.station_latitude,
            self.station_longitude,
            self.station_altitude,
        )
        north, east, distance = navigator.direction_cosines(latitude, longitude, sight)
        wanted = self.initialised & self.dme_aiding & self.ranging.valid & np.logical_not(self.calibrating())
        measured = self.ranging.measured & (np.arange(PLACES) < self.station_count) & wanted
        innovation = np.where(measured, self.ranging.slant_range - distance - self.range_bias, 0.0)
        # a station whose range jumps, in the time since it was last heard, further than the aircraft and its bias can
        heard = np.maximum(self.range_time, self.refused_time)
        since = moment - heard
        speed = self.top_speed()
        news = navigator.news(since, self.correlation_distance / np.maximum(speed, 1.0))
        reach = self.innovation_gate * np.sqrt(2.0) * self.bias_sigma + speed * since
        jumped = measured & (heard > self.fix_time) & (np.abs(innovation - self.innovation) > reach)
        astray = self.astray & np.logical_not(jumped)

        curvature = navigator.curvature(self.covariance, north, east, distance)
        unused = np.maximum(moment - self.range_time, 1.0e-3)
        variance = self.noise_sigma**2 + curvature / navigator.news(unused, self.wind_time)
        correction, covariance, taken = navigator.range_updates(
            np.zeros(STATES),
            self.covariance,
            north,
            east,
            innovation,
            variance,
            measured & np.logical_not(astray),
            self.innovation_gate,
        )
        refused = np.logical_and(measured, np.logical_not(taken))
        self.correct(correction)
        self.rejected = self.rejected + np.sum(np.where(refused, 1.0, 0.0))
        self.used = self.used + np.sum(np.where(taken, 1.0, 0.0))

        self.astray = astray | (jumped & refused & (self.refusals == 0.0) & np.logical_not(self.doubted))
        moved = north * correction[0] + east * correction[1] + correction[6:]
        self.innovation = np.where(measured, innovation, self.innovation) - moved
        refusals = self.refusals + np.where(refused, news, 0.0)
        self.refusals = np.where(taken, 0.0, refusals)
        self.range_time = np.where(taken, moment, self.range_time)
        self.refused_time = np.where(refused, moment, self.refused_time)
        used = moment - self.range_time <= self.geometry_window
        against = (self.refusals > 0.0) & (moment - self.refused_time <= self.geometry_window)
        believed = used & np.logical_not(against)
        dilution = dme.dilution(north, east, believed)
        self.hdop = np.where(wanted, dme.dilution(north, east, used), self.hdop)

        # evidence against dead reckoning
        several = np.sum(np.where(against, 1.0, 0.0)) > 1.5
        counted = against & (several | np.logical_not(self.astray))
        doubt = (
            np.any(refused & counted)
            & (np.sum(np.where(counted, self.refusals, 0.0)) >= self.patience)
            & np.logical_not(navigator.outvoted(against, believed, dilution, self.dilution_limit))
        )
        lacking = np.maximum(innovation * innovation - navigator.variance_along(covariance, north, east), 0.0)
        self.covariance = navigator.widen(covariance, np.max(np.where(refused & counted & doubt, lacking, 0.0)))
        self.doubted = np.logical_or(self.doubted, doubt)

    @every("update_period")
    def report(self):
        velocity = self.air_velocity + self.wind
        variances = kalman.diagonal(self.covariance)
        self.north_sigma = np.sqrt(variances[0])
        self.east_sigma = np.sqrt(variances[1])
        self.mode = np.where(self.initialised, np.where(self.calibrating(), 1, 2), 0)
        self.hdop = np.where(np.any(self.time - self.range_time <= self.geometry_window), self.hdop, 99.0)
        self.solution.publish(
            latitude=self.latitude,
            longitude=self.longitude,
            altitude=self.altitude,
            velocity_n=np.stack([velocity[0], velocity[1], -self.climb]),
            wind_n=self.wind,
            valid=self.initialised,
        )
