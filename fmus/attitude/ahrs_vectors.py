"""The FMU ``ahrs_vectors``: attitude by matching field and gravity, without gyros' memory."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.attitude.ahrs import Ahrs
from fmus.attitude.interface import Instrument
from models.attitude import ahrs, attitude, quaternion, vectors
from navfmu.export import Component, Example, Output, Parameter, State, every, on_new, start


class AhrsVectors(Instrument, Component):
    """Attitude from one sample of field and specific force, by vector matching alone.

    Thesis section 4.9. With every new field the attitude is looked for that matches two vectors in b with what they are
    in n: the field with that of the World Magnetic Model at `position`, and the specific force less acceleration with
    gravity, (4.10)-(4.31), by `iterations` of least squares, of whose corrections the share `gain` is taken. Nothing is
    kept: errors do not grow, and nothing is learned or averaged. It is what an attitude filter is compared with, and
    can take its place in a system: inputs and the bundle `attitude` are those of `ahrs`.

    *Acceleration* is what airspeed and rate say, V' along the nose and w x (V, 0, 0). V' is the airspeed less the same
    through a lag of `speeding_time`, over that time, since gusts along change the airspeed and not the motion. Without
    air data (not connected, not valid, older than `air_timeout`) the last airspeed is kept, at first `airspeed`,
    without V', and the error of the tilt is `blind_tilt_sigma`.

    *Start.* With `level_start` the iteration begins with the attitude of level and needle, (4.8), (4.9), (2.3).
    Otherwise it begins at (1, 0, 0, 0) as in the thesis; attitudes close to half a turn from there are then not found
    in time, three of 10 000, and nothing but `residual` shows that.

    *Field in n.* Without a position (not connected, not valid) it has the last dip and declination, at first
    the parameters `first_dip` and `declination`. Its disturbance is not seen but in `misfit`, and not survived.

    Sigmas are those of the two directions, `field_sigma` with `hard_iron_sigma` and `tilt_sigma`, through the
    geometry, and what stands still in the aircraft or in the chart: `level_sigma`, `mounting_sigma`, the error of the
    declination. Near a magnetic pole or 90 degrees of pitch that of the heading is beyond half a turn, or the two
    vectors are along one line: then `attitude.valid` is false.

    GPS attitude (`gps`) is not looked at.
    """

    tick = "sample_period"
    example = Example(
        {"sample_period": 0.05},
        text="A full circle at 3 deg/s in level flight (60 to 184 s), with gyros that are wrong by 0.15 deg/s in roll "
        "and -0.1 deg/s in yaw, which only the compensation of the turn feels. Errors are those of single samples, and "
        "the same at the end as at the beginning.",
        duration=300.0,
        step=0.05,
        inputs=examples.ahrs_inputs,
        shows=("attitude.heading_sigma", "misfit"),
        panels=examples.ahrs_panels,
    )

    first_dip = Parameter(
        "rad",
        start=np.radians(61.2),
        min=-0.5 * np.pi,
        max=0.5 * np.pi,
        display_unit="deg",
        description="dip of the field, positive down, until there is a position; 61.2 deg at Livermore by the WMM2025",
    )
    gain = Parameter("1", start=0.1, min=0.0, max=2.0, description="share of a correction that is taken (thesis alpha)")
    iterations = Parameter(kind="integer", start=100, min=1, max=1000, description="number of iterations (thesis: 100)")
    level_start = Parameter(
        kind="boolean", start=True, description="whether to begin with level and needle; false: with (1, 0, 0, 0)"
    )
    tilt_sigma = Parameter(
        "rad",
        start=np.radians(2.0),
        min=1.0e-6,
        display_unit="deg",
        description="error of the direction of gravity by one sample with air data, each component: 1.5 deg in the "
        "backup navigator's flight",
    )
    blind_tilt_sigma = Ahrs.blind_tilt_sigma
    speeding_time = Parameter(
        "s",
        start=10.0,
        min=0.01,
        description="lag against which the airspeed's change is seen: what is faster is taken for gusts along",
    )

    misfit = Output(
        "rad",
        display_unit="deg",
        description="angle between field and gravity as measured less the known one: no attitude makes it smaller",
    )
    residual = Output(
        "rad", display_unit="deg", description="largest angle that is left between a matched vector and the known one"
    )

    airspeed_slow = State("m/s", description="airspeed through a lag of speeding_time")
    air_time = State("s", start=-1.0e9, description="time of validity of the last airspeed")

    @start
    def assume(self):
        self.airspeed_seen = self.airspeed
        self.local_declination = self.declination
        self.dip = self.first_dip

    @every("chart_period")
    def look_up(self):
        field_n, _ = self.chart()
        down = np.arctan2(field_n[2], np.sqrt(field_n[0] * field_n[0] + field_n[1] * field_n[1]))
        self.dip = np.where(self.charted, down, self.dip)

    @on_new("air")
    def take_air(self):
        told = self.air_told()
        since = self.air.time_of_validity - self.air_time
        follows = np.abs(since) <= self.air_timeout + 1.0e-6
        share = np.where(follows, -np.expm1(-np.maximum(since, 0.0) / self.speeding_time), 1.0)
        slow = self.airspeed_slow + share * (self.air.true_airspeed - self.airspeed_slow)
        self.airspeed_slow = np.where(told, slow, self.airspeed_slow)
        self.airspeed_seen = np.where(told, self.air.true_airspeed, self.airspeed_seen)
        self.air_time = np.where(told, self.air.time_of_validity, self.air_time)

    @on_new("field")
    def match(self):
        fresh = self.time - self.air_time <= self.air_timeout + 1.0e-6
        speeding = (self.airspeed_seen - self.airspeed_slow) / self.speeding_time
        along = np.stack([np.where(fresh, speeding, 0.0), 0.0, 0.0])
        acceleration = along + ahrs.turning_acceleration(self.airspeed_seen, self.imu.rate)
        minus_g = self.imu.specific_force - acceleration
        strength, weight = ahrs.length(self.field.field_b), ahrs.length(minus_g)
        measured = np.stack([self.field.field_b / np.maximum(strength, 1.0e-12), minus_g / np.maximum(weight, 1.0e-9)])
        known = np.stack([ahrs.field_n(self.dip, self.local_declination), np.array([0.0, 0.0, -1.0])])
        needle = np.hypot(self.field_sigma, self.hard_iron_sigma)
        sigmas = np.stack([needle, np.where(fresh, self.tilt_sigma, self.blind_tilt_sigma)])

        level_roll, level_pitch = ahrs.level(measured[1], np.zeros(3))
        magnetic, _ = ahrs.levelled_heading(measured[0], level_roll, level_pitch)
        level = quaternion.of_euler(level_roll, level_pitch, magnetic + self.local_declination)
        begin = np.where(self.level_start, level, np.array([1.0, 0.0, 0.0, 0.0]))
        weights = 1.0 / (sigmas * sigmas)
        q = vectors.matched(known, measured, weights, begin, self.gain, self.iterations, 1000)

        c_nb = quaternion.dcm(q)
        roll, pitch, heading = attitude.euler(c_nb)
        information = vectors.spread(known, weights)
        squares = vectors.variances(information, c_nb, roll, pitch) + self.still() ** 2
        known_well = (np.min(squares) >= 0.0) & (np.max(squares) < np.pi * np.pi)
        seen = self.imu.valid & self.imu_told() & self.field_told() & (strength > 1.0e-12) & (weight > 1.0e-9)
        found = seen & known_well & vectors.apart(known) & vectors.apart(measured)
        yaw_rate = attitude.euler_rates(self.imu.rate, roll, pitch)[2]
        angles = np.stack([roll, pitch, attitude.wrap(heading), yaw_rate, *np.sqrt(np.maximum(squares, 0.0))])
        roll, pitch, heading, yaw_rate, *deviations = np.where(found, angles, 0.0)
        self.attitude.publish(
            roll=roll,
            pitch=pitch,
            heading=heading,
            yaw_rate=yaw_rate,
            roll_sigma=deviations[0],
            pitch_sigma=deviations[1],
            heading_sigma=deviations[2],
            valid=found,
            time_of_validity=self.field.time_of_validity,
        )
        self.misfit = np.where(found, vectors.misfit(known, measured), 0.0)
        self.residual = np.where(found, vectors.residual(known, measured, c_nb), 0.0)
