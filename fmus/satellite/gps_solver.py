"""The FMU ``gps_solver``: pseudoranges in, position, velocity and time out."""

from __future__ import annotations

import numpy as np

from fmus.satellite import examples
from fmus.satellite.gps import Gps
from fmus.satellite.signals import PLACES, signals
from models.earth import earth
from models.satellite import (
    augmentation,
    chi_square,
    dilution,
    least_squares,
    protection_level,
    raim,
    saastamoinen,
    sight,
    solution,
)
from navfmu.constants import SPEED_OF_LIGHT
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, on_new, start

ROWS = PLACES + 1
FREEDOM = ROWS - 4
FARTHEST = 1e9
"""m, of a satellite and of a pseudorange by a clock that is seconds off: more is a mistake, as is NaN."""
KLOBUCHAR = 1


class GpsSolver(Component):
    """Position, velocity and time from satellites: weighted least squares with integrity monitoring.

    Pseudoranges are freed of the satellites' clocks, of the ionosphere (Klobuchar, IS-GPS-200) and of the troposphere
    (Saastamoinen, by the cosecant of the elevation or Niell's mapping), or corrected by differential corrections;
    weights are those of RTKLIB's single point solution. Gauss and Newton's steps begin at the last position, or below
    the satellites: 8 steps find a position from anywhere on the earth. Velocity comes from range rates.

    Integrity: the weighted sum of squares of the residuals is tested against chi square with n - 4 degrees of freedom
    at `false_alarm`. If it is larger, up to `exclusions` satellites are left out, each time the one without which the
    sum is least; with n = 5 nobody knows which, and the `alarm` stays. Protection levels say how far off the position
    may be while the test is silent: Walter and Enge's, and Brown's (`..._slope`); 1000 km where
    nothing protects, and with an alarm.

    A barometric altitude takes the place of a satellite while fewer than `altitude_below` are seen (three satellites
    and altitude: AGARD CP-298 (1981), Peterson). With fewer `channels` than satellites those are left out without which
    the dilution grows least. `valid` is false without a solution, with a PDOP above `pdop_limit`, and with an alarm if
    `withhold` is set; then the last good values stand.

    What measures (a receiver's model, or recorded observations) is another component.
    """

    example = Example(
        text="Eight satellites over level flight to the west; from 40 s on (dotted) one of them is 100 m too far. It "
        "is found and left out at once, and the protection levels grow by what is missing without it.",
        step=1.0,
        mark=examples.FAULT,
        inputs=examples.signals_inputs,
        periods={"altitude": 1.0},
        shows=("satellites", "squares"),
        panels=examples.solver_panels,
    )

    signals = signals(Input)
    altitude = Bundle(
        height=Input("m", display_unit="ft", description="height above the ellipsoid, positive up"),
        description="altitude that may take the place of a satellite",
    )

    tick_period = Parameter("s", start=0.1, min=1e-3, max=60.0, description="how often new measurements are looked for")
    elevation_mask = Parameter(
        "rad",
        start=float(np.radians(10.0)),
        min=0.0,
        max=1.0,
        display_unit="deg",
        description="lower satellites are not used",
    )
    signal_mask = Parameter("1", start=0.0, min=0.0, description="satellites with less C/N0, dB-Hz, are not used")
    channels = Parameter(kind="integer", start=PLACES, min=4, max=PLACES, description="satellites used at most")
    ionosphere_alpha = Parameter(
        4,
        "s",
        start=(3.82e-8, 1.49e-8, -1.79e-7, 0.0),
        description="Klobuchar's amplitude as sent, s by semicircles; start values of a published example",
    )
    ionosphere_beta = Parameter(
        4, "s", start=(1.43e5, 0.0, -3.28e5, 1.13e5), description="Klobuchar's period as sent, s by semicircles"
    )
    humidity = Parameter("1", start=saastamoinen.HUMIDITY, min=0.0, max=1.0, description="relative humidity, no unit")
    ionosphere = Parameter(
        kind="enumeration", items=("klobuchar", "off"), description="model of the ionosphere's delay"
    )
    troposphere = Parameter(
        kind="enumeration",
        items=("cosecant", "niell", "off"),
        description="Saastamoinen's delay of the troposphere, by the cosecant of the elevation or Niell's mapping",
    )
    equal_sigma = Parameter(
        "m", start=0.0, min=0.0, description="standard deviation of all pseudoranges; 0: each by its elevation"
    )
    differential_sigma = Parameter(
        "m", start=0.3, min=0.0, description="standard deviation that corrections leave which do not tell any"
    )
    altitude_sigma = Parameter("m", start=10.0, min=0.01, description="standard deviation of the altitude")
    altitude_below = Parameter(
        kind="integer", start=4, min=0, max=PLACES + 1, description="altitude is used with fewer satellites than this"
    )
    pdop_limit = Parameter("1", start=20.0, min=1.0, description="no fix with a larger position dilution")
    false_alarm = Parameter(
        "1", start=3.333e-7, min=1e-12, max=0.1, description="probability of an alarm without a fault, each fix"
    )
    missed_detection = Parameter(
        "1", start=1e-3, min=1e-6, max=0.4, description="probability of no alarm in protection levels"
    )
    exclusions = Parameter(kind="integer", start=1, min=0, max=4, description="rows left out at most after an alarm")
    withhold = Parameter(kind="boolean", start=True, description="whether a fix with an alarm is not valid")

    fix = Gps.fix
    clock_bias = Output("s", description="receiver clock ahead of GPS time")
    clock_drift = Output("1", description="rate of it")
    satellites = Output(kind="integer", description="number of satellites used")
    used = Output(PLACES, kind="boolean", description="whether this satellite was used")
    excluded = Output(PLACES, kind="boolean", description="whether this satellite was left out after an alarm")
    gdop = Output("1", start=dilution.NONE, description="geometric dilution of precision, of what was used")
    pdop = Output("1", start=dilution.NONE, description="position dilution of precision")
    hdop = Output("1", start=dilution.NONE, description="horizontal dilution of precision")
    vdop = Output("1", start=dilution.NONE, description="vertical dilution of precision")
    tdop = Output("1", start=dilution.NONE, description="time dilution of precision")
    horizontal_sigma = Output(
        "m", start=protection_level.NONE, description="horizontal standard deviation by the weights"
    )
    vertical_sigma = Output("m", start=protection_level.NONE, description="vertical standard deviation by the weights")
    augmented_horizontal_protection = Output(
        "m", start=protection_level.NONE, description="horizontal protection level of WAAS, RTCA DO-229"
    )
    augmented_vertical_protection = Output(
        "m", start=protection_level.NONE, description="vertical protection level of WAAS, RTCA DO-229"
    )
    squares = Output("1", description="weighted sum of squares of the residuals, before anything was left out")
    threshold = Output("1", description="what it is tested against; 0: too few satellites for a test")
    detected = Output(kind="boolean", description="the sum of squares was above the threshold")
    alarm = Output(kind="boolean", description="it is, of what is used")
    horizontal_protection = Output(
        "m", start=protection_level.NONE, description="horizontal protection level, Walter and Enge"
    )
    vertical_protection = Output(
        "m", start=protection_level.NONE, description="vertical protection level, Walter and Enge"
    )
    horizontal_protection_slope = Output(
        "m", start=protection_level.NONE, description="horizontal protection level, Brown"
    )
    vertical_protection_slope = Output("m", start=protection_level.NONE, description="vertical protection level, Brown")
    residual = Output(PLACES, "m", description="residuals of the pseudoranges, of all that are tracked")
    elevation = Output(PLACES, "rad", display_unit="deg", description="elevation of the satellites")
    azimuth = Output(PLACES, "rad", display_unit="deg", description="azimuth of the satellites, from north over east")

    position_e = State(3, "m", description="last position, e")
    clock = State("m", description="last clock, by the speed of light")
    thresholds = State(FREEDOM, "1", description="of the sum of squares by degrees of freedom")
    non_centralities = State(FREEDOM, "1", description="what is missed as often as wanted, by degrees of freedom")
    multiple = State("1", description="sigmas that stand for missed detection")

    tick = "tick_period"

    @start
    def declare_risk(self):
        by = np.arange(1, FREEDOM + 1)
        self.thresholds = chi_square.threshold(self.false_alarm, by)
        self.non_centralities = chi_square.non_centrality(self.missed_detection, self.thresholds, by)
        self.multiple = chi_square.normal_threshold(self.missed_detection)

    @on_new("signals")
    def solve(self):
        s = self.signals
        clean = s.pseudorange + SPEED_OF_LIGHT * s.satellite_clock + np.where(s.corrected, s.correction, 0.0)
        told = np.maximum(np.abs(clean), np.max(np.abs(s.satellite_e), axis=1)) < FARTHEST
        tracked = s.tracked & told & (s.signal_to_noise >= self.signal_mask) & s.valid
        satellite_e = np.where(tracked[:, None], s.satellite_e, np.array([4.0 * earth.EQUATORIAL_RADIUS, 0.0, 0.0]))
        height = np.array([np.where(self._altitude_told(), self.altitude.height, 0.0)])

        # near enough for delays and elevations
        known = self.fix.valid
        measured = least_squares.Measured(
            satellite_e,
            np.concatenate([np.where(tracked, clean, 0.0), height]),
            np.zeros(PLACES),
            self.humidity,
        )
        place, clock = solution.approach(
            np.where(known, self.position_e, least_squares.start(satellite_e, tracked)),
            self.clock,
            measured,
            self._rows(tracked, 1.0),
            np.where(known, 1, solution.SETTLING),
        )
        geodetic = earth.from_ecef(place)
        unit_n = solution.directions(place, geodetic, satellite_e)
        sine, azimuth = sight.sky(unit_n)
        elevation = np.arcsin(sine)
        delay, slant = self._delays(geodetic, sine, elevation, azimuth)
        measured = measured._replace(
            values=np.concatenate([np.where(tracked, clean - delay, 0.0), height]), slant=np.where(tracked, slant, 0.0)
        )

        seen = self._rows(tracked & (elevation >= self.elevation_mask), 1.0)
        kept = solution.choose(least_squares.design(unit_n), seen, self.channels)
        remains = np.where(s.correction_sigma > 0.0, s.correction_sigma, self.differential_sigma)
        weight = solution.weights(kept[:-1] > 0.0, sine, delay, s.accuracy, s.corrected, remains, self.equal_sigma)
        weight = self._rows(weight, self.altitude_sigma**-2)
        place, clock = least_squares.step(place, clock, measured, weight)
        place, clock, found = solution.solution(place, clock, measured, weight)
        detected = solution.alarmed(found, weight, self.thresholds)
        self.squares, self.detected = found.squares(weight), detected
        self.threshold = solution.of_freedom(self.thresholds, weight)
        place, clock, found, left = solution.exclude(
            place, clock, found, measured, weight, self.thresholds, np.where(detected, self.exclusions, 0)
        )
        self._tell(found, place, clock, left, satellite_e)
        self.excluded = (weight[:-1] > 0.0) & (left[:-1] <= 0.0)
        self.residual = np.where(tracked, found.residual[:-1], 0.0)
        self.elevation = np.where(tracked, elevation, 0.0)
        self.azimuth = np.where(tracked, np.arctan2(unit_n[:, 1], unit_n[:, 0]), 0.0)

    def _delays(self, geodetic, sine, elevation, azimuth):
        """Delay of the ionosphere, m, and of the troposphere, over that at the zenith."""
        s = self.signals
        of_ionosphere = solution.ionosphere(
            geodetic, elevation, azimuth, s.seconds, self.ionosphere_alpha, self.ionosphere_beta
        )
        of_troposphere = solution.troposphere(
            geodetic, sine, solution.day_of_year(s.week, s.seconds), self.troposphere, self.humidity
        )
        modelled = np.logical_not(s.corrected)
        return (
            np.where(modelled & (self.ionosphere == KLOBUCHAR), of_ionosphere, 0.0),
            np.where(modelled, of_troposphere, 0.0),
        )

    def _altitude_told(self):
        return self.altitude.valid & np.isfinite(self.altitude.height)

    def _rows(self, satellites, altitude):
        """Weights of satellites and of the altitude, if that is used with so many of them."""
        count = np.sum(np.where(satellites > 0.0, 1.0, 0.0))
        aided = self._altitude_told() & (count < self.altitude_below)
        return np.concatenate([np.where(satellites > 0.0, satellites, 0.0), np.array([np.where(aided, altitude, 0.0)])])

    def _tell(self, found, place, clock, weight, satellite_e):
        s = self.signals
        travel = sight.travel_time(place, satellite_e)
        velocity_n, drift = least_squares.velocity(
            found.unit_e,
            place,
            sight.turned(s.satellite_velocity_e, travel),
            s.range_rate + SPEED_OF_LIGHT * s.satellite_clock_rate,
            found.h,
            weight,
            found.rotation,
        )
        latitude, longitude, altitude = earth.from_ecef(place)
        once = np.where(weight > 0.0, 1.0, 0.0)
        self.gdop, self.pdop, self.hdop, self.vdop, self.tdop = dilution.dilutions(
            least_squares.covariance(found.h, once)
        )
        self.alarm = solution.alarmed(found, weight, self.thresholds)
        good = self.pdop <= self.pdop_limit
        good = good & np.isfinite(latitude + longitude + altitude + np.sum(velocity_n))
        self._protect(found, weight, good)
        self.position_e = np.where(good, place, self.position_e)
        self.clock = np.where(good, clock, self.clock)
        self.clock_bias = self.clock / SPEED_OF_LIGHT
        self.clock_drift = np.where(good, drift / SPEED_OF_LIGHT, self.clock_drift)
        self.used = weight[:-1] > 0.0
        self.satellites = np.sum(np.where(weight[:-1] > 0.0, 1, 0))
        valid = good & np.logical_not(self.alarm & self.withhold)
        self.fix.publish(
            latitude=np.where(valid, latitude, self.fix.latitude),
            longitude=np.where(valid, longitude, self.fix.longitude),
            altitude=np.where(valid, altitude, self.fix.altitude),
            velocity_n=np.where(valid, velocity_n, self.fix.velocity_n),
            valid=valid,
            time_of_validity=s.time_of_validity,
        )

    def _protect(self, found, weight, good):
        tested = good & (solution.freedom(weight) > 0.5) & np.logical_not(self.alarm)
        share = raim.redundancy(found.p, found.h, weight)
        horizontal, vertical = raim.slopes(found.p, found.h, weight, share)
        threshold = np.sqrt(solution.of_freedom(self.thresholds, weight))
        non_centrality = solution.of_freedom(self.non_centralities, weight)
        levels = []
        variances = np.maximum(np.stack([found.p[0, 0] + found.p[1, 1], found.p[2, 2]]), 0.0)
        self.horizontal_sigma, self.vertical_sigma = np.where(good, np.sqrt(variances), protection_level.NONE)
        told = (self.signals.corrected & (self.signals.correction_sigma > 0.0)) | (weight[:-1] <= 0.0)
        self.augmented_horizontal_protection, self.augmented_vertical_protection = np.where(
            good & np.all(told), np.stack(augmentation.protection(found.p)), protection_level.NONE
        )
        for slope, sigma in ((horizontal, self.horizontal_sigma), (vertical, self.vertical_sigma)):
            levels.append(protection_level.of_slope_and_noise(slope, threshold, sigma, self.multiple))
            levels.append(protection_level.of_slope(slope, non_centrality))
        levels = [np.where(tested, level, protection_level.NONE) for level in levels]
        self.horizontal_protection, self.horizontal_protection_slope = levels[0], levels[1]
        self.vertical_protection, self.vertical_protection_slope = levels[2], levels[3]
