"""The FMU ``navigator``: DME-aided dead reckoning, the backup when GPS is lost."""

from __future__ import annotations

import numpy as np

from fmus import examples, stations
from models import dme, gps, kalman, navigator
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, on_new

PLACES = stations.PLACES
LONG_AGO = -1.0e9


class Navigator(stations.StationTable, Component):
    """Backup navigator: dead reckoning with airspeed, heading and wind, aided by GPS while there is GPS, then by DME.

    Thesis section 2.3 (calibrating and coasting phase), 6.4 and 6.5 (reduced-order filter). Position is propagated by

        d(latitude)/dt = (V cos(heading) + V_NS) / (R_NS + h)                                (6.22)
        d(longitude)/dt = (V sin(heading) + V_EW) / ((R_EW + h) cos(latitude))               (6.23)

    every `update_period`, with heading carried from its time of validity to now by the yaw rate (at most 1 s), and h
    positive up. An extended Kalman filter with the states (6.54), errors of north and east position and of north
    and east wind, is corrected in two phases:

    - *calibrating* (`mode` 1): each GPS fix corrects position (2 m) and wind (GPS velocity minus air velocity).
    - *coasting* (`mode` 2): from the moment a fix is invalid or overdue by `fix_timeout`. Each DME range corrects
      along its line of sight, one scalar update after the other: L = P H' (H P H' + R)^-1 (the thesis prints H' P H in
      (6.39)), P+ = (I - L H) P (6.42). Residuals are measured minus predicted slant range on the ellipsoid, at the
      range's time of validity, instead of the ranges projected on a plane of (6.32). When GPS returns, so does the
      calibrating phase.

    The same filter runs through both: there is no switch-over, hence no step at the switch.

    *Measurement noise: a correction of the thesis.* (6.40) has the wide-band noise of 7.4 m alone; the bias of 315 m,
    which lives for 20 s at 90 kn, is left out. The filter then claims 10 m and is hundreds of metres wrong
    (`range_noise_model` 2). Here (`range_noise_model` 1) a range counts as

        R = sigma_b^2 (1 + rho) / (1 - rho) + sigma_w^2,  rho = exp(-dt / tau_r),  tau_r = 0.5 nmi / V,

    dt since the same station was last used: the independent measurement of the same information. It tends to sigma_b^2
    where ranges are rare and to sigma_b^2 2 tau_r / dt where they are frequent.

    *Process noise.* Wind: 2 sigma^2 / tau of (3.36). The deleted states, heading and airspeed, are lumped into the
    wind with their own 2 sigma^2 / tau, and what turns with the aircraft into a random walk of position
    (`position_walk`). Between measurements the wind estimate decays to `wind_mean`, as its model (3.36) says (the
    thesis keeps the estimate and lets the error decay, which contradicts each other).

    *Without heading or airspeed* (`attitude.valid` or `air.valid` false) the last air velocity is held, and the wind is
    driven as if the aircraft could turn anywhere within `blind_time`: the DME ranges then carry the solution alone.

    *Gate.* A range whose innovation is larger than `innovation_gate` standard deviations is not used, and counted in
    `rejected`. The variant as printed has none.

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
    range_noise_model = Parameter(
        kind="integer",
        start=1,
        min=1,
        max=2,
        description="1: with the correlated bias (our correction); 2: wide-band noise alone, thesis (6.40) as printed",
    )
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
    heading_sigma = Parameter(
        "rad",
        start=np.radians(2.5),
        min=0.0,
        display_unit="deg",
        description="standard deviation of the heading error (thesis (3.84), p. 101)",
    )
    heading_time = Parameter("s", start=120.0, min=1.0, description="its correlation time (thesis (3.85))")
    airspeed_sigma = Parameter(
        "m/s",
        start=2.6,
        min=0.0,
        display_unit="kn",
        description="standard deviation of the airspeed error (thesis (3.32), p. 64)",
    )
    airspeed_time = Parameter("s", start=400.0, min=1.0, description="its correlation time (thesis (3.32))")
    position_walk = Parameter(
        "m",
        start=5.0,
        min=0.0,
        description="random walk of position in one second, for the deleted errors that turn with the aircraft "
        "(own choice: in a turn at 1.5 to 3 deg/s they move it by 90 to 180 m, which this does in 5 to 20 minutes)",
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
        "s", start=90.0, min=0.0, description="stations ranged within this time count in `hdop` (own choice)"
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
        "1", start=99.0, description="dilution of precision of the stations ranged lately; 99: lines do not cross"
    )
    rejected = Output(kind="integer", min=0, description="number of ranges that the innovation gate rejected")
    used = Output(kind="integer", min=0, description="number of ranges that corrected the solution")

    latitude = State("rad", display_unit="deg", description="geodetic latitude")
    longitude = State("rad", display_unit="deg", description="longitude")
    altitude = State("m", display_unit="ft", description="height above the ellipsoid")
    altitude_offset = State("m", description="altitude minus pressure altitude, learned from GPS")
    pressure_altitude = State("m", description="last pressure altitude")
    climb = State("m/s", description="filtered vertical speed, positive up")
    wind = State(2, "m/s", description="wind: north, east")
    air_velocity = State(2, "m/s", description="velocity relative to the air: north, east")
    covariance = State(10, "1", description="upper triangle of the covariance of (6.54), row by row; m and m/s")
    had_air = State(kind="boolean", description="air data and heading have been seen")
    initialised = State(kind="boolean", description="the first fix has been seen")
    fix_time = State("s", start=LONG_AGO, description="time of the last good fix")
    fix_good = State(kind="boolean", description="the last report of the receiver was a good fix")
    range_time = State(PLACES, "s", start=LONG_AGO, description="when each station's range was last used")

    @every("update_period")
    def dead_reckon(self):
        step = self.period
        seen = np.logical_and(self.attitude.valid, self.air.valid)
        age = np.clip(self.time - self.attitude.time_of_validity, -1.0, 1.0)
        heading = self.attitude.heading + self.attitude.yaw_rate * age
        now = np.where(seen, navigator.air_velocity(self.air.true_airspeed, heading), self.air_velocity)
        before = np.where(self.had_air, self.air_velocity, now)

        decay = np.exp(-step / self.wind_time)
        wind = self.wind_mean + decay * (self.wind - self.wind_mean)
        over_ground = 0.5 * (before + now + self.wind + wind)
        latitude, longitude = navigator.advance(self.latitude, self.longitude, self.altitude, over_ground, step)
        airspeed = np.sqrt(np.sum(now * now))
        density = navigator.wind_noise(
            airspeed,
            (self.wind_sigma, self.wind_time),
            (self.heading_sigma, self.heading_time),
            (self.airspeed_sigma, self.airspeed_time),
        )
        density = density + np.where(seen, 0.0, navigator.blind_noise(airspeed, self.blind_time))
        covariance = kalman.propagate(
            self.covariance, navigator.transition(step, decay), navigator.noise(step, density, self.position_walk**2)
        )
        running = self.initialised
        self.latitude = np.where(running, latitude, self.latitude)
        self.longitude = np.where(running, longitude, self.longitude)
        self.wind = np.where(running, wind, self.wind)
        self.covariance = np.where(running, covariance, self.covariance)

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
        lumped = navigator.lumped_variance(self.air_velocity, self.heading_sigma, self.airspeed_sigma)
        start_covariance = kalman.of_variances(np.stack([self.fix_sigma**2] * 2 + [self.wind_sigma**2 + lumped] * 2))
        latitude = np.where(first, self.fix.latitude, self.latitude)
        longitude = np.where(first, self.fix.longitude, self.longitude)
        wind = np.where(first, self.wind_mean, self.wind)
        covariance = np.where(first, start_covariance, self.covariance)

        age = self.time - self.fix.time_of_validity
        way = (self.air_velocity + wind) * age
        residual = way + navigator.offset(latitude, longitude, self.altitude, self.fix.latitude, self.fix.longitude)
        correction, covariance = navigator.position_updates(np.zeros(4), covariance, residual, self.fix_sigma**2, good)
        wind_residual = self.fix.velocity_n[:2] - self.air_velocity - wind
        correction, covariance = navigator.wind_updates(
            correction, covariance, wind_residual, self.velocity_sigma**2 + lumped, np.logical_and(good, self.had_air)
        )
        self.latitude, self.longitude = navigator.advance(latitude, longitude, self.altitude, correction[:2], 1.0)
        self.wind = wind + correction[2:]
        self.covariance = covariance

        error = self.fix.altitude - self.pressure_altitude - self.altitude_offset
        gain = np.where(first, 1.0, self.altitude_gain)
        self.altitude_offset = self.altitude_offset + np.where(good, gain * error, 0.0)
        self.altitude = self.pressure_altitude + self.altitude_offset
        self.fix_time = np.where(good, self.fix.time_of_validity, self.fix_time)
        self.fix_good = good
        self.initialised = np.logical_or(self.initialised, good)

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
        time_constant = dme.correlation_time(velocity, 1.0, self.correlation_distance)
        since = np.maximum(moment - self.range_time, 1.0e-3)
        bias = dme.white_equivalent(self.bias_sigma**2, since, time_constant)
        corrected = self.range_noise_model == 1
        variance = self.noise_sigma**2 + np.where(corrected, bias, 0.0)
        gate = np.where(corrected, self.innovation_gate, 0.0)
        wanted = self.initialised & self.dme_aiding & self.ranging.valid & np.logical_not(self.calibrating())
        measured = self.ranging.measured & (np.arange(PLACES) < self.station_count) & wanted
        residual = np.where(measured, self.ranging.slant_range - distance, 0.0)
        correction, covariance, rejected = navigator.range_updates(
            np.zeros(4), self.covariance, north, east, residual, variance, measured, gate
        )
        self.latitude, self.longitude = navigator.advance(
            self.latitude, self.longitude, self.altitude, correction[:2], 1.0
        )
        self.wind = self.wind + correction[2:]
        self.covariance = covariance
        self.range_time = np.where(measured, moment, self.range_time)
        self.rejected = self.rejected + rejected
        self.used = self.used + np.sum(np.where(measured, 1.0, 0.0)) - rejected
        recent = moment - self.range_time <= self.geometry_window
        self.hdop = np.where(wanted, dme.dilution(north, east, recent), self.hdop)

    @every("update_period")
    def report(self):
        velocity = self.air_velocity + self.wind
        variances = kalman.diagonal(self.covariance)
        self.north_sigma = np.sqrt(variances[0])
        self.east_sigma = np.sqrt(variances[1])
        self.mode = np.where(self.initialised, np.where(self.calibrating(), 1, 2), 0)
        self.solution.publish(
            latitude=self.latitude,
            longitude=self.longitude,
            altitude=self.altitude,
            velocity_n=np.stack([velocity[0], velocity[1], -self.climb]),
            wind_n=self.wind,
            valid=self.initialised,
        )
