"""What all navigators have in common, so that one stands for another in a system.

Bundles, outputs and parameters, and what is done with them around a filter: which samples are taken, whether there is
GPS, what became of each range; and, of those that reckon with airspeed and heading, altitude and what air data and
heading are worth.
"""

from __future__ import annotations

import numpy as np

from fmus.grades import AIR_DATA
from fmus.radio import stations
from models.air import turbulence
from models.navigation import phases
from models.processes import gauss_markov, past
from models.processes.known import known, told
from models.radio import dme
from models.satellite import gps
from navfmu.export import Bundle, Input, Output, Parameter, State

PLACES = stations.PLACES
LONG_AGO = -1.0e9
NONE, TAKEN, REFUSED, LEFT_OUT = range(4)
"""What `gate` says of a station in the last report of ranges: there was no range; it was taken; the innovation gate
refused it; it was there, but not asked for (there is GPS, or no aiding) or the station is not trusted."""
NO_DILUTION = 99.0
"""`hdop` where lines do not cross."""
MOMENTS = 12
"""Of the past that a late fix is compared with."""
LONGEST_DELAY = 1.0
"""How far it reaches, s."""


def known_share():
    """The parameter of analyses in which a fix leaves no error."""
    return Parameter(
        "1",
        start=0.0,
        min=0.0,
        max=1.0,
        description="part of the variance of all errors that is known when a fix begins anew: 1 where it leaves none, "
        "thesis (5.59), (5.60), which is for analyses",
    )


class Navigation(stations.StationTable):
    """Inputs, outputs and parameters of every navigator.

    Each has a `state_sigma` of its own beside these, the standard deviations of its filter's states in their order.
    """

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
        true_airspeed_sigma=Input(
            "m/s",
            start=AIR_DATA["airspeed_error_sigma"],
            min=0.0,
            display_unit="kn",
            description="standard deviation of true airspeed by its instrument (thesis (3.32), p. 64, has 2.6 m/s of "
            "the indicated one)",
        ),
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
    fix_error_sigma = Input(
        "m",
        start=0.0,
        min=0.0,
        description="horizontal standard deviation that the receiver tells of its fix, root of the sum of squares of "
        "north and east; 0: it tells none, and `fix_sigma` is taken",
    )
    augmented_protection = Input(
        "m",
        start=0.0,
        min=0.0,
        description="horizontal protection level by the augmentation (WAAS, LAAS); more than `protection_limit` where "
        "it is lost; 0: it is not watched",
    )
    ranging = Bundle(
        slant_range=Input(PLACES, "m", display_unit="nmi", description="measured distance to each station"),
        measured=Input(PLACES, kind="boolean", description="which ranges were measured"),
        description="DME ranges",
    )

    dme_aiding = Parameter(kind="boolean", start=True, description="whether DME ranges are used; false: open loop")
    fix_timeout = Parameter(
        "s", start=3.0, min=0.0, max=3600.0, description="age of the last good fix from which GPS counts as lost"
    )
    fix_sigma = Parameter(
        "m",
        start=gps.HORIZONTAL_SIGMA,
        min=1.0e-3,
        description="standard deviation of north and of east of a fix (thesis section 3.10)",
    )
    fix_delay = Parameter(
        "s",
        start=0.0,
        min=0.0,
        max=LONGEST_DELAY,
        description="how long before its `time_of_validity` a fix was valid: of receivers whose stamps are late "
        "(`navfmu calibrate delay`)",
    )
    fix_sigma_limit = Parameter(
        "m",
        start=236.0,
        min=0.0,
        description="largest standard deviation of north and of east by which a fix serves: one of which 95 % lie "
        "within 0.25 nmi, 463 m (own choice; thesis section 2.2 asks for 0.5 nmi)",
    )
    protection_limit = Parameter(
        "m",
        start=40.0,
        min=0.0,
        description="largest `augmented_protection` that serves precision approaches: 40 m (ICAO Annex 10, alert limit "
        "of approaches with vertical guidance)",
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
    dilution_limit = Parameter(
        "1",
        start=2.83,
        min=1.0,
        description="dilution up to which stations fix a position: lines of sight that cross at 30 to 150 degrees "
        "(AC 90-100A)",
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
    position_covariance = Output(3, "m2", description="covariance of position: north, north with east, east")
    mode = Output(kind="integer", min=0, max=2, description="0 initialising, 1 calibrating (GPS), 2 coasting (no GPS)")
    guidance = Output(
        kind="integer",
        min=phases.NO_GUIDANCE,
        max=phases.BACKUP,
        description="what serves by thesis Fig 2.2: 0 nothing yet, 1 GPS for all approaches, 2 GPS alone (its "
        "augmentation is lost: no precision approaches), 3 the backup: land as soon as practical",
    )
    hdop = Output(
        "1", start=99.0, description="dilution of precision of the ranges used lately; 99: lines do not cross"
    )
    rejected = Output(kind="integer", min=0, description="number of ranges that the innovation gate rejected")
    used = Output(kind="integer", min=0, description="number of ranges that corrected the solution")
    innovation = Output(
        PLACES, "m", description="last range of each station that was looked at, less what was expected of it"
    )
    innovation_sigma = Output(PLACES, "m", description="standard deviation of this by the filter")
    gate = Output(
        PLACES,
        kind="integer",
        min=NONE,
        max=LEFT_OUT,
        description="each station in the last report of ranges: 0 no range, 1 taken, 2 refused by the innovation gate, "
        "3 left out (there is GPS, ranges are not used, or the station is not trusted)",
    )

    initialised = State(kind="boolean", description="the first fix has been seen")
    fix_time = State("s", start=LONG_AGO, description="time of the last good fix")
    last_speed = State("m/s", display_unit="kn", description="ground speed by the last good fix")
    fix_good = State(kind="boolean", description="the last report of the receiver was a good fix")
    range_time = State(PLACES, "s", start=LONG_AGO, description="when each station's range was last used")
    refused_time = State(PLACES, "s", start=LONG_AGO, description="when each station's range was last refused")

    def attitude_told(self):
        """Whether there is a heading, and what it is worth."""
        return told(self.attitude.valid, self.attitude.heading, self.attitude.yaw_rate, self.attitude.heading_sigma)

    def air_told(self):
        """Whether there is an airspeed, and what it is worth."""
        return told(self.air.valid, self.air.true_airspeed, self.air.true_airspeed_sigma)

    def fix_told(self):
        """Whether there is a fix that serves."""
        fix = self.fix
        there = told(fix.valid, fix.latitude, fix.longitude, fix.altitude, fix.velocity_n)
        return there & (self.fix_sigma_told() <= np.maximum(self.fix_sigma_limit, self.fix_sigma))

    def fix_sigma_told(self):
        """Standard deviation (m) of north and of east of a fix, by what it says of itself."""
        return phases.sigma_of(known(self.fix_error_sigma, 0.0), self.fix_sigma)

    def fix_moment(self):
        """When a fix was valid, s."""
        return self.fix.time_of_validity - self.fix_delay

    def calibrating(self):
        """Whether there is GPS: the last report was good, is not too old, and still says so (a dropout clears
        `valid`)."""
        fresh = self.time - self.fix_time <= self.fix_timeout + self.fix_delay + 1.0e-6
        return self.fix_good & self.fix.valid & fresh

    def note_fix(self, good):
        """Remember a report of the receiver, and whether it was a ``good`` fix."""
        self.fix_time = np.where(good, self.fix_moment(), self.fix_time)
        self.fix_good = good
        ground_speed = np.sqrt(np.sum(self.fix.velocity_n[:2] * self.fix.velocity_n[:2]))
        self.last_speed = np.where(good, ground_speed, self.last_speed)
        self.initialised = np.logical_or(self.initialised, good)

    def wants_ranges(self):
        """Whether this report of ranges is to be used: there is a position, and no GPS."""
        return self.initialised & self.dme_aiding & self.ranging.valid & np.logical_not(self.calibrating())

    def ranges_there(self):
        """Which stations have a range in this report."""
        there = np.isfinite(self.ranging.slant_range) & (np.arange(PLACES) < self.station_count)
        return self.ranging.measured & there

    def judge(self, offered, taken, innovation, variance):
        """Show of each station what became of its range: ``offered`` to the filter or not, ``taken`` by it or not,
        with which innovation (m) of which variance (m2)."""
        there = self.ranges_there() & self.ranging.valid
        offered_gate = np.where(taken, TAKEN, REFUSED)
        self.gate = np.where(there, np.where(offered, offered_gate, LEFT_OUT), NONE)
        looked_at = there & self.wants_ranges()
        self.innovation = np.where(looked_at, innovation, self.innovation)
        self.innovation_sigma = np.where(looked_at, np.sqrt(np.maximum(variance, 0.0)), self.innovation_sigma)

    def used_lately(self, moment):
        """Which stations count in `hdop` at a ``moment``."""
        return moment - self.range_time <= self.geometry_window

    def tell_mode(self):
        """Show the phase, and that there is no dilution without ranges."""
        answers = (
            self.initialised,
            self.calibrating(),
            phases.augmented(self.augmented_protection, self.protection_limit),
        )
        self.mode = phases.outcome(phases.PHASES, answers[:2])
        self.guidance = phases.outcome(phases.GUIDANCE, answers)
        self.hdop = np.where(np.any(self.used_lately(self.time)), self.hdop, NO_DILUTION)


class Reckoning(Navigation):
    """What those have beside that which reckon with airspeed, heading and wind."""

    update_period = Parameter("s", start=0.1, min=0.001, max=1.0, description="period of dead reckoning")
    wind_mean = Parameter(
        2,
        "m/s",
        start=0.0,
        min=-100.0,
        max=100.0,
        display_unit="kn",
        description="forecast of the mean wind, north and east",
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
    airspeed_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time of the airspeed error (thesis (3.32))"
    )
    gust_sigma = Parameter(
        "m/s",
        start=turbulence.GUST_SIGMA,
        min=0.0,
        display_unit="kn",
        description="intensity of the gusts on each axis: 5 ft/s; light turbulence of MIL-F-8785C has 7 ft/s",
    )
    gust_length = Parameter(
        "m",
        start=turbulence.GUST_LENGTH,
        min=1.0,
        display_unit="ft",
        description="scale of the gusts, MIL-F-8785C: 1750 ft",
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

    altitude = State("m", display_unit="ft", description="height above the ellipsoid")
    altitude_offset = State("m", description="altitude minus pressure altitude, learned from GPS")
    pressure_altitude = State("m", description="last pressure altitude")
    climb = State("m/s", description="filtered vertical speed, positive up")
    airspeed = State("m/s", display_unit="kn", description="measured airspeed in use")
    nose = State("rad", display_unit="deg", description="heading of the air velocity in use")
    had_air = State(kind="boolean", description="air data and heading have been seen")
    past_times = State(MOMENTS, "s", start=LONG_AGO, description="moments of the past for late fixes")
    past_velocities = State(
        (MOMENTS, 2), "m/s", description="velocity relative to the air at these as measured: north, east"
    )

    def top_speed(self):
        """The faster of ground speed by the last fix and airspeed, m/s: GPS may have been lost before take-off."""
        return np.maximum(self.last_speed, self.airspeed)

    def gusts(self, since):
        """Variance of independent gusts every ``since`` s that do the same to position as those that last, (m/s)^2."""
        time = self.gust_length / np.maximum(self.last_speed, 1.0)
        return gauss_markov.white_equivalent(self.gust_sigma**2, since, time)

    def nose_now(self, seen):
        """Heading, carried from its time of validity to now by the yaw rate (at most 1 s); held where there is none
        (``seen``)."""
        age = np.clip(self.time - self.attitude.time_of_validity, -1.0, 1.0)
        return np.where(seen, self.attitude.heading + self.attitude.yaw_rate * age, self.nose)

    def remember(self):
        """Keep the measured air velocity of this tick; of `airspeed` and `nose`."""
        spacing = LONGEST_DELAY / (MOMENTS - 2)
        velocity = self.airspeed * np.stack([np.cos(self.nose), np.sin(self.nose)])
        self.past_times, self.past_velocities = past.remember(
            self.past_times, self.past_velocities, self.time, velocity, spacing
        )

    def turned_since(self, moment):
        """What the aircraft has done since a ``moment``, s: measured air velocity then less that of now (m/s), how far
        this carried (m), north and east each, and heading then less that of now (rad). All are 0 at the last tick."""
        then = past.at(self.past_times, self.past_velocities, moment)
        now = self.past_velocities[0]
        angle = np.arctan2(now[0] * then[1] - now[1] * then[0], now[0] * then[0] + now[1] * then[1])
        return then - now, past.since(self.past_times, self.past_velocities, moment), angle

    def climb_on(self, step):
        """Altitude, and the vertical speed, by what the pressure altitude has changed in ``step`` s."""
        pressure_altitude = np.where(
            told(self.air.valid, self.air.pressure_altitude), self.air.pressure_altitude, self.pressure_altitude
        )
        rise = np.where(self.had_air, pressure_altitude - self.pressure_altitude, 0.0)
        self.climb = self.climb + (rise - self.climb * step) / np.maximum(self.climb_time, step)
        self.pressure_altitude = pressure_altitude
        self.altitude = pressure_altitude + self.altitude_offset

    def learn_altitude(self, good, first):
        """The offset of the pressure altitude by a ``good`` fix, all of it by the ``first``."""
        error = self.fix.altitude - self.pressure_altitude - self.altitude_offset
        gain = np.where(first, 1.0, self.altitude_gain)
        self.altitude_offset = self.altitude_offset + np.where(good, gain * error, 0.0)
        self.altitude = self.pressure_altitude + self.altitude_offset
