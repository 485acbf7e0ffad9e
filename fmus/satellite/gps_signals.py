"""The FMU ``gps_signals``: what a GPS receiver measures of the satellites of a constellation."""

from __future__ import annotations

import numpy as np

from fmus.satellite import examples
from fmus.satellite.gps import Gps
from fmus.satellite.jamming import Jamming
from fmus.satellite.signals import PLACES, signals
from models.attitude import attitude
from models.earth import earth
from models.processes import gauss_markov, places
from models.processes.known import known
from models.satellite import (
    ageing,
    antenna,
    augmentation,
    broadcast,
    dilution,
    gps,
    gps_time,
    klobuchar,
    least_squares,
    multipath,
    receiver_clock,
    reception,
    saastamoinen,
    selection,
    sight,
    signal_power,
    slots,
    solution,
    tracking,
)
from models.satellite.ephemeris import COLUMNS, Ephemeris
from navfmu.constants import SPEED_OF_LIGHT, STANDARD_GRAVITY
from navfmu.export import Component, Example, Grid, Input, Output, Parameter, State, Table, every, require, start
from navfmu.repetition import repeat

SATELLITES = 32
LOWEST = float(np.sin(np.radians(2.0)))
"""Sine of the elevation below which delays grow no more."""


class GpsSignals(Jamming, Component):
    """Receiver of GPS at the level of signals: pseudoranges, range rates and C/N0 of the satellites that it tracks.

    Satellites. The table `orbits` has their orbits and clocks (IS-GPS-200): as built the 24 nominal slots;
    `navfmu orbits` makes it of broadcast ephemerides or of an almanac. What they say of themselves is told with the
    measurements; a range is longer or shorter by their own error of orbit and clock, a Gauss-Markov process whose
    standard deviation grows with `upload_age`.

        pseudorange = r + c (dt - dt_s) + I + T + own error + multipath + noise

    r through empty space while the earth turns, dt the receiver's clock, dt_s the satellite's with relativity and group
    delay; I Klobuchar's delay by the coefficients that are sent, times `ionosphere_scale` and a common Gauss-Markov
    factor; T Saastamoinen's with a common Gauss-Markov error; multipath that of RTCA DO-229 times `multipath_scale`.
    Errors that several receivers share are those of gps_errors, inputs that are added.

    Signals. C/N0 is of the free-space loss, the `antenna` (a grid over azimuth and elevation in the body's axes, which
    stands upright on the roof: a bank hides satellites) and noise with that of jammers, whose power falls with the
    square of the distance and ends at their radio horizon. Code and phase noise are those of loops (`loop_bandwidth`
    ...). A satellite is lost below the C/N0 at which `lock_sigmas` of the code's noise are half the spacing, but not
    less than `carrier_threshold`, or while three sigmas of the carrier's phase and what it stays behind acceleration
    (`loop_order` second) or jerk (third) of `specific_force` are above 45 degrees, and, with `slips`, at Viterbi's rate
    of cycle slips; and found again once it has been above `acquisition_threshold` for
    `acquisition_time` (RTO MP-43, Sabatini: 20 s). Each `search_period` satellites that have come above
    `elevation_mask` are given places, while one of `channels` is free, and keep them until they set. Where more have
    come than there are channels, those are left out without which the dilution grows least, and all are chosen anew
    when it is above `dilution_limit`; a channel on which nothing is heard goes to another one.

    Augmentation (`waas`). Corrections of orbit, clock and ionosphere, and a model of the troposphere, as one number for
    each satellite; they leave `waas_share` of the errors that they say they may leave (RTCA DO-229, appendix J). Lost,
    they are used for another `waas_timeout`.

    Clock. Bias and drift with white noise of frequency and of its rate; acceleration changes the frequency by
    `clock_sensitivity` times specific force.

    Not modelled: scintillation, half cycles, the message itself (a satellite that is tracked has told its orbit).
    """

    name = "gps_signals"
    example = Example(
        text="The 24 slots over level flight to the west. From 40 s on (dotted) a jammer of 100 W, 16 km ahead, is on "
        "the air for 20 s: C/N0 falls, all are lost, and found again 20 s after it has stopped.",
        duration=120.0,
        step=1.0,
        mark=40.0,
        inputs=examples.jammed_inputs,
        shows=("satellites", "jamming"),
        panels=examples.receiver_panels,
    )

    latitude = Gps.latitude
    longitude = Gps.longitude
    altitude = Gps.altitude
    velocity_n = Gps.velocity_n
    roll = Gps.roll
    pitch = Gps.pitch
    heading = Gps.heading
    specific_force = Input(3, "m/s2", description="true specific force in b, changes the frequency of the clock")
    range_error = Input(SATELLITES, "m", description="error of orbit and clock of gps_errors, by PRN")
    ionosphere_error = Input("1", description="error of the ionosphere's factor, of gps_errors")
    zenith_error = Input("m", description="error of the troposphere at the zenith, of gps_errors")
    waas_lost = Input(kind="boolean", fault=True, description="fault: no corrections of WAAS are received any more")
    satellite_off = Input(SATELLITES, kind="boolean", fault=True, description="fault: satellite of this PRN is silent")
    range_step = Input(SATELLITES, "m", fault=True, description="fault: satellite of this PRN is too far by this")
    range_ramp = Input(
        SATELLITES, "m/s", fault=True, description="fault: rate at which it runs away while this is not 0"
    )
    accuracy_lie = Input(
        "1", fault=True, description="fault: satellites' own errors are larger by this times what they say"
    )
    clock_jump = Input("s", fault=True, description="fault: the receiver's clock is ahead by this")

    start_week = Parameter(kind="integer", start=slots.EPOCH[0], min=0, max=9999, description="GPS week at t = 0")
    start_seconds = Parameter(
        "s", start=slots.EPOCH[1], min=0.0, max=gps_time.WEEK, description="GPS seconds of that week at t = 0"
    )
    measurement_period = Parameter("s", start=1.0, min=0.01, max=60.0, description="period of measurements")
    search_period = Parameter(
        "s", start=10.0, min=0.01, max=3600.0, description="how often is looked for new satellites"
    )
    elevation_mask = Parameter(
        "rad",
        start=float(np.radians(5.0)),
        min=float(np.radians(2.0)),
        max=1.0,
        display_unit="deg",
        description="lower satellites are not tracked",
    )
    channels = Parameter(kind="integer", start=PLACES, min=1, max=PLACES, description="satellites tracked at most")
    dilution_limit = Parameter(
        "1", start=6.0, min=1.0, description="with fewer channels than satellites: all are chosen anew above this GDOP"
    )
    signal_margin = Parameter("1", start=2.0, description="power above the least guaranteed one, dB")
    noise_density = Parameter("1", start=signal_power.NOISE_DENSITY, description="of receiver and antenna, dBW/Hz")
    loop_bandwidth = Parameter("Hz", start=0.5, min=1e-3, max=50.0, description="of the code loop, one-sided")
    detection_bandwidth = Parameter("Hz", start=50.0, min=1.0, max=1e3, description="before detection: 1 / time")
    spacing = Parameter("1", start=0.5, min=0.02, max=1.5, description="of early and late, chips")
    phase_bandwidth = Parameter("Hz", start=10.0, min=0.1, max=100.0, description="of the carrier loop")
    loop_order = Parameter(
        kind="enumeration",
        start=tracking.THIRD,
        items=("second", "third"),
        description="of the carrier loop: a second one is held up by acceleration, a third one by jerk",
    )
    slips = Parameter(kind="boolean", start=False, description="whether noise makes carrier loops slip, at a rate")
    rate_interval = Parameter("s", start=0.1, min=1e-3, max=10.0, description="between phases that make a range rate")
    lock_sigmas = Parameter("1", start=3.0, min=0.5, max=10.0, description="sigmas within half the spacing")
    carrier_threshold = Parameter("1", start=25.0, description="least C/N0 of the carrier loop, dB-Hz")
    acquisition_threshold = Parameter("1", start=33.0, description="least C/N0 to find a signal, dB-Hz")
    acquisition_time = Parameter("s", start=20.0, min=0.0, max=1e4, description="to find it (RTO MP-43: 20 s)")
    own_sigma = Parameter("m", start=1.0, min=0.0, description="standard deviation of orbit and clock in a range")
    own_time = Parameter("s", start=3600.0, min=1.0, description="correlation time of it")
    upload_age = Parameter("s", start=0.0, min=0.0, description="since satellites were told orbits and clocks")
    accuracy = Parameter("m", start=2.4, min=0.0, description="user range accuracy, where a satellite tells none")
    waas = Parameter(kind="boolean", start=False, description="whether corrections of WAAS are received and used")
    waas_udre = Parameter(
        "m", start=augmentation.UDRE, min=0.0, description="bound of orbit and clock that it tells, 99.9 %"
    )
    waas_give = Parameter(
        "m", start=augmentation.GIVE, min=0.0, description="bound of the ionosphere at the zenith that it tells, 99.9 %"
    )
    waas_share = Parameter(
        "1",
        start=augmentation.SHARE,
        min=0.0,
        description="errors that are left over those that are told (chosen: 95 % as measured in 2004)",
    )
    waas_timeout = Parameter(
        "s", start=augmentation.TIMEOUT, min=0.0, description="how long corrections hold that are not renewed"
    )
    ionosphere_alpha = Parameter(
        4,
        "s",
        start=(3.82e-8, 1.49e-8, -1.79e-7, 0.0),
        description="Klobuchar's amplitude as sent, s by semicircles; start values of a published example",
    )
    ionosphere_beta = Parameter(
        4, "s", start=(1.43e5, 0.0, -3.28e5, 1.13e5), description="Klobuchar's period as sent, s by semicircles"
    )
    ionosphere_scale = Parameter("1", start=1.0, min=0.0, description="true delay over that by what is sent")
    ionosphere_sigma = Parameter("1", start=0.2, min=0.0, description="standard deviation of this factor")
    ionosphere_time = Parameter("s", start=1800.0, min=1.0, description="correlation time of it")
    humidity = Parameter("1", start=saastamoinen.HUMIDITY, min=0.0, max=1.0, description="relative humidity, no unit")
    troposphere_sigma = Parameter("m", start=0.05, min=0.0, description="standard deviation at the zenith")
    troposphere_time = Parameter("s", start=3600.0, min=1.0, description="correlation time of it")
    multipath_scale = Parameter("1", start=1.0, min=0.0, description="times that of RTCA DO-229")
    multipath_time = Parameter("s", start=60.0, min=1.0, description="correlation time of it")
    clock_bias_start = Parameter("s", start=1e-4, min=-1.0, max=1.0, description="receiver's clock at t = 0")
    clock_drift_start = Parameter("1", start=1e-7, min=-1e-4, max=1e-4, description="rate of it, s/s")
    clock_h0 = Parameter("s", start=receiver_clock.H0, min=0.0, description="white frequency noise, Allan's h_0")
    clock_h2 = Parameter("1/s", start=receiver_clock.H2, min=0.0, description="random walk of it, Allan's h_-2")
    clock_sensitivity = Parameter(
        3, "s2/m", start=1e-10, description="frequency by specific force in b, relative: 1e-9 per g"
    )

    orbits = Table(columns=COLUMNS, rows=slots.constellation(), key="place")
    antenna = Grid(
        axes=(("azimuth", "rad", antenna.AZIMUTHS), ("elevation", "rad", antenna.ELEVATIONS)),
        surfaces=(("gain", "1", antenna.PATCH),),
    )

    signals = signals(Output)
    satellites = Output(kind="integer", description="number of satellites tracked")
    augmented = Output(kind="boolean", description="whether there are corrections of WAAS")
    elevation = Output(PLACES, "rad", display_unit="deg", description="of the satellites, above the horizon")
    jamming = Output("1", start=-300.0, description="power of all jammers at the antenna's element, dBW")
    clock_bias = Output("s", description="receiver's clock ahead of GPS time")
    clock_drift = Output("1", description="rate of it")

    placed = State(PLACES, kind="integer", description="PRN of the satellite that has this place, 0: none")
    vain = State(SATELLITES, kind="boolean", description="satellites on whose channel nothing was heard, of too many")
    strong_for = State(PLACES, "s", description="how long the signal has been strong enough to be found")
    own = State(PLACES, "1", description="own error, over its sigma; drawn when a satellite gets the place")
    reflected = State(PLACES, "1", description="multipath, over its sigma; drawn as this is")
    common = State(2, "1", description="error of ionosphere and troposphere, over their sigmas")
    unheard = State("s", start=augmentation.NEVER, description="since when no corrections have been received")
    felt_n = State(3, "m/s2", description="specific force at the last measurement, n")
    run_away = State(SATELLITES, "m", description="by range_ramp")
    bias = State("s", description="of the clock without a jump")
    drift = State("1", description="rate of it without acceleration")
    clock_covariance = State((2, 2), "s2", description="of what the clock gains in a period")
    least = State("1", description="C/N0 below which a satellite is lost, a ratio in Hz")

    @require("satellites are looked for before anything is measured: expected search_period from measurement_period on")
    def search_after_measurement(self):
        return self.search_period >= self.measurement_period

    @require(
        "of the table orbits none holds in week {start_week}, {start_seconds} s of it: expected start_week and "
        "start_seconds of a time for which it was made"
    )
    def orbits_hold_at_the_start(self):
        return np.any(self._told_at_the_start()[1])

    @require(
        "the table orbits has an orbit that no satellite of GPS has: expected semi_major_axis near 2.656e7 m, not its "
        "root, eccentricity below 0.1, inclination of 0.6 to 1.3 rad and other angles within 6.4 rad, not degrees"
    )
    def orbits_are_of_gps(self):
        told, hold = self._told_at_the_start()
        return np.all(told.of_gps() | np.logical_not(hold))

    def _told_at_the_start(self):
        at = gps_time.normal(self.start_week, self.start_seconds)
        prn = np.arange(1.0, SATELLITES + 1.0)
        told = self._told(prn, *at)
        return told, selection.holds(told, prn, *at)

    @require(
        "antenna does not have all directions: expected azimuths from -pi to pi and elevations from -pi/2 to pi/2, in "
        "rad and not degrees"
    )
    def antenna_reaches_around(self):
        all_of_it = np.array([-np.inf, np.inf])
        azimuths, elevations = self.antenna.around(azimuth=all_of_it, elevation=all_of_it).ends
        return _spans(azimuths, np.pi) & _spans(elevations, 0.5 * np.pi)

    @start
    def begin(self, noise):
        self.common = noise(2)
        self.bias, self.drift = self.clock_bias_start, self.clock_drift_start
        self.clock_covariance = receiver_clock.covariance(
            receiver_clock.densities(self.clock_h0, self.clock_h2), self.measurement_period
        )
        code = tracking.threshold(self.lock_sigmas, self.loop_bandwidth, self.detection_bandwidth, self.spacing)
        self.least = np.maximum(code, signal_power.ratio(self.carrier_threshold))
        self.strong_for = np.full(PLACES, 1.0) * self.acquisition_time

    @every("search_period", offset="measurement_period")
    def search(self):
        """Give free places to satellites above the mask that have none, in the order of their numbers; where there are
        too few, to those that lie best beside those that have one, or to the best of all if that is poor."""
        week, second = self._now()
        position_e, _, c_ne, finite = self._motion()
        prn = np.arange(1, SATELLITES + 1)
        orbit, usable = self._orbits(1.0 * prn, week, second)
        satellite, *_ = broadcast.at(orbit, week, second - broadcast.USUAL)  # within 1e-5 rad
        _, unit_e = sight.ranges(position_e, satellite)
        unit_n = unit_e @ c_ne.T
        seen = finite & usable & (-unit_n[:, 2] >= np.sin(self.elevation_mask))
        placed = places.has_one(self.placed, SATELLITES)
        wanted, held = self._promising(seen, placed)
        rows = np.concatenate([np.where(wanted, 1.0, 0.0), np.zeros(1)])  # no altitude
        h = least_squares.design(unit_n)
        kept = solution.choose(h, rows, self.channels, held)
        poor = dilution.dilutions(least_squares.covariance(h, kept))[0] > self.dilution_limit
        kept = solution.choose(h, np.where(poor, rows, kept), self.channels)[:-1] > 0.0
        number = np.where(np.any((self.placed[:, None] == prn) & kept, axis=1), self.placed, 0)
        self.placed = places.filled(number, kept & np.logical_not(placed), 1.0 * prn, self.channels)

    def _promising(self, seen, placed):
        """Satellites that may have a channel, and those of them that keep it.

        Where there are too few channels, one on which nothing was heard goes to others, until all have been tried.
        """
        wanted = seen | placed
        crowded = np.sum(np.where(wanted, 1, 0)) > self.channels
        mute = np.logical_not(self.signals.tracked) & (self.strong_for <= 0.0)
        vain = (self.vain | places.has_one(np.where(mute, self.placed, 0), SATELLITES)) & seen & crowded
        others = wanted & np.logical_not(vain)
        enough = np.sum(np.where(others, 1, 0)) >= self.channels
        self.vain = vain & enough
        return np.where(enough, others, wanted), np.where(enough, placed & others, others)

    @every("measurement_period")
    def measure(self, noise):
        week, second = self._now()
        self._carry_off(self.period)
        position_e, velocity_e, c_ne, finite = self._motion()
        number = self.placed
        orbit, usable = self._orbits(number, week, second)
        travel, satellite, satellite_velocity, clock, clock_rate = reception.received(orbit, week, second, position_e)
        distance = SPEED_OF_LIGHT * travel
        unit_e = (sight.turned(satellite, travel) - position_e) / distance[:, None]
        unit_n = unit_e @ c_ne.T
        sine, azimuth = sight.sky(unit_n)
        elevation = np.arcsin(sine)
        up = finite & usable & (number > 0) & (elevation >= self.elevation_mask)

        # what is received of it, and whether it is followed
        c_nb = self._c_nb()
        power = signal_power.of_satellite(distance, self.signal_margin + self._gain(unit_n, c_nb))
        interference = self._interference(c_ne, lambda unit_n: self._gain(unit_n, c_nb))
        ratio = signal_power.carrier_to_noise(power, interference, self.noise_density, self.jammer_spread)
        silent, wrong, running, shared_error = self._of_satellites(number)
        heard = up & np.logical_not(silent | self.jammed | self._within_region())
        strong = heard & (ratio >= signal_power.ratio(self.acquisition_threshold))
        normal, shared = np.reshape(noise(4 * PLACES), (4, PLACES)), noise(4)
        phase = tracking.phase_sigma(ratio, self.phase_bandwidth, self.detection_bandwidth)
        steady = tracking.holds(phase, unit_n @ self._lag(c_nb)) & np.logical_not(self._slipped(phase, normal[2:]))
        strong = strong & steady
        holding = heard & (ratio >= self.least) & steady
        another = number != self.signals.number
        swapped = another & (self.signals.number > 0)
        tracked, self.strong_for = tracking.locked(
            self.signals.tracked & np.logical_not(swapped),
            np.where(swapped, 0.0, self.strong_for),
            strong,
            holding,
            self.period,
            self.acquisition_time,
        )
        ratio = np.where(tracked, ratio, 1e4)

        # what is wrong with it
        self.own = np.where(another, normal[0], self._wander(self.own, self.own_time, normal[0]))
        self.reflected = np.where(another, normal[1], self._wander(self.reflected, self.multipath_time, normal[1]))
        self.common = np.stack(
            [
                self._wander(self.common[0], self.ionosphere_time, shared[0]),
                self._wander(self.common[1], self.troposphere_time, shared[1]),
            ]
        )
        own = ageing.sigma(self.own_sigma, self.upload_age) * (1.0 + known(self.accuracy_lie, 0.0)) * self.own
        own = own + shared_error
        sigma = tracking.code_sigma(ratio, self.loop_bandwidth, self.detection_bandwidth, self.spacing)
        error = own + wrong + self.multipath_scale * multipath.sigma(elevation) * self.reflected + sigma * normal[2]
        rate_sigma = tracking.rate_sigma(phase, self.rate_interval)
        rate_error = running + rate_sigma * normal[3]

        # the clock, and what the air adds
        felt = np.sum(self.clock_sensitivity * known(self.specific_force, 0.0))
        self.bias, self.drift = receiver_clock.advance(
            self.bias, self.drift, felt, self.clock_covariance, self.period, shared[2:]
        )
        self.clock_bias = self.bias + known(self.clock_jump, 0.0)
        self.clock_drift = self.drift + felt
        latitude, longitude, altitude = self._place()
        low = np.maximum(sine, LOWEST)
        factor = self.ionosphere_sigma * self.common[0] + known(self.ionosphere_error, 0.0)
        scale = self.ionosphere_scale * np.maximum(1.0 + factor, 0.0)
        ionosphere = scale * klobuchar.delay(
            latitude, longitude, elevation, azimuth, second, self.ionosphere_alpha, self.ionosphere_beta
        )
        modelled = sum(saastamoinen.zenith(latitude, altitude, self.humidity))
        zenith = modelled + self.troposphere_sigma * self.common[1] + known(self.zenith_error, 0.0)
        delay = ionosphere + saastamoinen.slant(zenith, low)
        correction, correction_sigma = self._augment(tracked, own, ionosphere, modelled, low)
        pseudorange = distance + delay + SPEED_OF_LIGHT * (self.clock_bias - clock) + error
        range_rate = sight.range_rates(unit_e, position_e, velocity_e, sight.turned(satellite_velocity, travel))
        range_rate = range_rate + SPEED_OF_LIGHT * (self.clock_drift - clock_rate) + rate_error

        self.elevation = np.where(up, elevation, 0.0)
        self.satellites = np.sum(np.where(tracked, 1, 0))
        self.jamming = signal_power.decibel(np.maximum(interference, 1e-30))
        self.placed = np.where(up, number, 0)
        tag_week, tag_second = gps_time.normal(week, second + self.clock_bias)
        row = tracked[:, None]
        self.signals.publish(
            week=tag_week,
            seconds=tag_second,
            tracked=tracked,
            number=self.placed,
            pseudorange=np.where(tracked, pseudorange, 0.0),
            range_rate=np.where(tracked, range_rate, 0.0),
            signal_to_noise=np.where(tracked, signal_power.decibel(ratio), 0.0),
            satellite_e=np.where(row, satellite, 0.0),
            satellite_velocity_e=np.where(row, satellite_velocity, 0.0),
            satellite_clock=np.where(tracked, clock, 0.0),
            satellite_clock_rate=np.where(tracked, clock_rate, 0.0),
            accuracy=np.where(tracked & (orbit.accuracy > 0.0), orbit.accuracy, self.accuracy),
            correction=correction,
            correction_sigma=correction_sigma,
            corrected=tracked & self.augmented,
            valid=finite,
        )

    def _augment(self, tracked, own, ionosphere, modelled, low):
        """Corrections of WAAS, m, and their sigma, with its own model of the troposphere; zeros without it."""
        self.unheard = np.where(self.waas & np.logical_not(self.waas_lost), 0.0, self.unheard + self.period)
        self.augmented = self.unheard <= self.waas_timeout

        def corrected(_):
            udre, give = self.waas_udre / augmentation.BOUND, self.waas_give / augmentation.BOUND
            left = self.own * udre + self.common[0] * give * augmentation.obliquity(low)
            air = saastamoinen.slant(modelled, low)
            correction = augmentation.correction(own, ionosphere, air, self.waas_share * left)
            return np.where(tracked, correction, 0.0), np.where(tracked, augmentation.sigma(low, udre, give), 0.0)

        return repeat(corrected, (np.zeros(PLACES), np.zeros(PLACES)), np.where(self.augmented, 1, 0), 1)

    def _lag(self, c_nb):
        """By how much the phase of a satellite towards north, east and down stays behind, rad, each.

        Acceleration and jerk are those of the specific force now and one period ago.
        """
        felt_n = c_nb @ known(self.specific_force, 0.0)
        jerk = np.where(self.signals.sequence > 0, (felt_n - self.felt_n) / self.period, 0.0)
        self.felt_n = felt_n
        acceleration = felt_n + np.array([0.0, 0.0, STANDARD_GRAVITY])
        return tracking.lag(self.loop_order, acceleration, jerk, self.phase_bandwidth)

    def _slipped(self, phase, normal):
        """Whether noise has made the loop slip: half the square of two normal numbers is below x with the chance
        1 - exp(-x). They are those of the noise of what is then not measured."""

        def by_chance(_):
            chance = self.period * tracking.slip_rate(phase, self.phase_bandwidth)
            return 0.5 * np.sum(normal * normal, axis=0) < chance

        return repeat(by_chance, np.zeros(PLACES) > 0.0, np.where(self.slips, 1, 0), 1)

    def _now(self):
        return gps_time.normal(self.start_week, self.start_seconds + self.time)

    def _place(self):
        finite = np.isfinite(self.latitude + self.longitude + self.altitude)
        (north, east, down), _ = self._spoofed()
        altitude = np.where(finite, self.altitude, 0.0)
        latitude, longitude = gps.displaced(
            np.where(finite, self.latitude, 0.0), np.where(finite, self.longitude, 0.0), altitude, north, east
        )
        return latitude, longitude, altitude - down

    def _motion(self):
        """Position and velocity in e of the place whose signals come, C_ne there, and whether it is known."""
        place = self._place()
        c_ne = earth.north_east_down(*place[:2])
        velocity_n = known(self.velocity_n, 0.0) + self._spoofed()[1]
        finite = np.isfinite(self.latitude + self.longitude + self.altitude + np.sum(self.velocity_n))
        return earth.to_ecef(*place), velocity_n @ c_ne, c_ne, finite

    def _c_nb(self):
        return attitude.dcm(known(self.roll, 0.0), known(self.pitch, 0.0), known(self.heading, 0.0))

    def _orbits(self, number, week, second):
        """What the satellites say of their orbits, and whether it may be used."""
        orbit = self._told(number, week, second)
        return orbit, selection.usable(orbit, number, week, second)

    def _told(self, number, week, second):
        around = self.orbits.around(place=selection.place(number, week, second))
        found = Ephemeris.of(around.row), Ephemeris.of(around.next_row)
        return selection.nearest(found, number, week, second)

    def _gain(self, unit_n, c_nb):
        azimuth, elevation = antenna.direction(unit_n, c_nb)
        return self.antenna.around(azimuth=azimuth, elevation=elevation).bilinear()[:, 0]

    def _of_satellites(self, number):
        """Whether the satellite in each place is silent, by how much it is too far, m, its rate, m/s, and its shared
        error, m."""
        rate = known(self.range_ramp, 0.0)
        self.run_away = np.where(self.range_ramp != 0.0, self.run_away + self.period * rate, 0.0)
        wrong = known(self.range_step, 0.0) + self.run_away
        prn = np.arange(1, SATELLITES + 1)
        shared = known(self.range_error, 0.0)
        found = np.stack([1.0 * self.satellite_off, wrong, rate, shared]) @ np.where(number == prn[:, None], 1.0, 0.0)
        return found[0] > 0.0, *found[1:]

    def _wander(self, value, time_constant, normal):
        phi = gauss_markov.decay(self.period, time_constant)
        return gauss_markov.advance(value, phi, gauss_markov.drive(1.0, phi), normal)


def _spans(ends, most):
    """Whether an axis, of which these are the first and the last two numbers, goes from -most to most."""
    return (np.abs(ends[0, 0] + most) < 1e-3) & (np.abs(ends[1, 1] - most) < 1e-3)
