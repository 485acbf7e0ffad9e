"""The FMU ``ahrs``: attitude and heading reference system."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.attitude.interface import AIRCRAFT, Reference
from models.attitude import ahrs, attitude
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Component, Example, Output, Parameter, State, every, on_new


class Ahrs(Reference, Component):
    """Attitude and heading reference: gyros, aided by accelerometers, airspeed and a magnetometer.

    Thesis section 4.12 with the filter of 4.11.1. With every IMU sample the Euler angles are advanced by the rates less
    their estimated biases,

        d(roll, pitch, heading)/dt = f(roll, pitch) (p, q, r)                                (4.4), (4.45)

    by the trapezoidal rule over the time between the samples (row 2, column 3 of f is -sin(roll); (4.35), (4.45) print
    -cos). Every `aiding_period` a Kalman filter with eleven states, errors of the angles, gyro biases, dip of the
    field, hard iron and airspeed, takes

    - the mean specific force of the period, always, with what the airspeed V says about acceleration:
      f_x = V' + g sin(pitch), f_y = V r - g sin(roll) cos(pitch);
    - the direction of the magnetic field as a vector, always.

    *Noise of the tilt.* What the airspeed does not show is the change of the wind, slip and angle of attack. Their
    level is learned from the innovations, roll and pitch apart: output `tilt_noise`. What does not fit the level raises
    it; nothing is gated. Gates by yaw rate (4.67) and magnitude (thesis p. 150) see neither the accelerations of a real
    straight flight nor those of a long turn's begin. Where in straight flight the level is off by `doubt_angle` for a
    whole window, the attitude is lost, and the filter begins anew.

    *Without air data* (not connected, not valid, older than `air_timeout`) the last airspeed is kept, at first
    `airspeed`, its error grows to `blind_airspeed_sigma`, and the tilt has `blind_tilt_sigma`: all sigmas are wider.

    *Hard iron and dip* are told apart from heading and tilt as the aircraft turns. A field that jumps, so
    that the sum of its innovations is beyond `field_limit` sigma, is taken for a change of the hard iron. What no
    measurement here can see, because it stands still in the aircraft or in the chart, is added to the published sigmas:
    `level_sigma`, `mounting_sigma`, and the error of the declination.

    *GPS attitude* (`gps`, thesis 4.11.1): where three antennas tell it, roll, pitch and heading are measurements, too,
    (4.48)-(4.51), and calibrate gyros and hard iron while there is GPS (thesis sections 2.3 and 4.11). As long as it
    was told within `gps_timeout` nothing that stands still in the aircraft or in the chart is in the angles. It is
    taken for right to `gps_sigma`, whatever it says; older than `gps_timeout` it is not taken.

    *Declination* (output `local_declination`) is that of the World Magnetic Model of the `date` at `position`, every
    `chart_period` while that is valid, and its error is the model's own. Without a position the last one stays, at
    first the parameter `declination`, and its error is `declination_sigma`. When a position comes, heading, which is
    known from magnetic north, turns by the difference at once.

    Covariance and gains are computed, P+ = Phi P Phi' + C_d (4.46), L = P H' (H P H' + R)^-1 (4.50, corrected); they
    are not scheduled. Phi has the derivatives by roll and pitch, which (4.34) sets to zero. Biases are random walks of
    2 sigma^2 / tau.

    At the first aiding with field and specific force the angles are set from these; until then `attitude.valid` is
    false.
    """

    tick = "sample_period"
    parameter_sets = AIRCRAFT
    example = Example(
        {"sample_period": 0.05},
        text="A full circle at 3 deg/s in level flight (60 to 184 s), with gyros that are wrong by 0.15 deg/s in roll "
        "and -0.1 deg/s in yaw. The angles follow the truth (dashed), the biases of the gyros are learned. Sigmas "
        "shrink as the noise of the tilt turns out to be small.",
        duration=300.0,
        step=0.05,
        inputs=examples.ahrs_inputs,
        shows=("gyro_bias", "attitude.heading_sigma", "tilt_noise"),
        panels=examples.ahrs_panels,
    )

    tilt_sigma = Parameter(
        "rad",
        start=np.radians(4.0),
        min=1.0e-6,
        display_unit="deg",
        description="error of roll and pitch from one mean specific force with air data, at first: the wind of (3.36), "
        "5 m/s and 400 s, changes by 2.9 deg of g in 0.5 s",
    )
    tilt_sigma_min = Parameter(
        "rad",
        start=np.radians(2.0),
        min=1.0e-6,
        display_unit="deg",
        description="the least that is believed of it later on",
    )
    tilt_window = Parameter(
        "s", start=60.0, min=0.001, description="time over which innovations are summed to learn the noise of the tilt"
    )
    tilt_time = Parameter(
        "s", start=600.0, min=0.01, description="time constant with which the noise of the tilt is learned"
    )
    tilt_limit = Parameter(
        "1",
        start=2.5,
        min=1.0,
        description="sigmas beyond which a sum of innovations, of a third of the window or more, raises the noise",
    )
    doubt_angle = Parameter(
        "rad",
        start=np.radians(15.0),
        min=1.0e-6,
        display_unit="deg",
        description="mean misfit of the level in a window of straight flight from which the attitude is taken for lost",
    )
    doubt_rate = Parameter(
        "rad/s",
        start=np.radians(0.5),
        min=0.0,
        display_unit="deg/s",
        description="mean yaw rate below which flight is straight (thesis (4.67), p. 149)",
    )
    blind_tilt_sigma = Parameter(
        "rad",
        start=np.radians(20.0),
        min=1.0e-6,
        display_unit="deg",
        description="tilt_sigma without air data: accelerations of 0.25 m/s2 for 15 s at a time",
    )
    field_window = Parameter(
        "s", start=30.0, min=0.001, description="time over which innovations of the field are summed to find a jump"
    )
    field_limit = Parameter(
        "1",
        start=4.0,
        min=1.0,
        description="sigmas beyond which a sum of innovations says that the hard iron has changed",
    )
    tilt_noise = Output(
        2, "rad", display_unit="deg", description="learned noise of roll and pitch from one mean specific force"
    )
    angles = State(3, "rad", display_unit="deg", description="roll, pitch, heading")
    covariance = State(66, "1", description="upper triangle of the filter's covariance, row by row; rad, rad/s, m/s")
    rate = State(3, "rad/s", description="last rate less bias")
    force = State(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="last specific force")
    rate_sum = State(3, "rad/s", description="sum of rates less bias since the last aiding")
    force_sum = State(3, "m/s2", description="sum of specific forces since the last aiding")
    tilt_sum = State(2, "rad", description="sums of the tilt residuals, lateral and longitudinal, since they were used")
    sample_count = State(2, "1", description="number of IMU samples in these")
    airspeed_error = State("m/s", description="estimated error of the airspeed")
    airspeed_used = State("m/s", description="airspeed at the last longitudinal aiding")
    airspeed_used_time = State("s", description="its time of validity")
    tilt_level = State(2, "1", start=1.0, description="learned variance of the tilt over that of tilt_sigma")
    innovation_sum = State(2, "1", description="sum of innovations over their sigma in this window")
    innovation_count = State(2, "1", description="number of innovations in this window")
    field_misfit = State(4, "1", description="sums of innovations of the field over their sigma, and their number")
    turn_sum = State("rad", description="integral of the size of the yaw rate in this window")
    window_time = State("s", description="time since this window began")

    @on_new("imu")
    def integrate(self):
        step = self.imu_step()
        known = self.imu_told()
        rate = np.where(known, self.imu.rate - self.gyro_bias, self.rate)
        force = np.where(known, self.imu.specific_force, self.force)
        # the angles are still those at the last sample
        airspeed = self.airspeed_seen - self.airspeed_error
        residuals = ahrs.tilt_residuals(self.force, airspeed, self.rate, self.angles[0], self.angles[1])
        euler_rates = attitude.euler_rates(0.5 * (rate + self.rate), self.angles[0], self.angles[1])
        moved = self.angles + step * euler_rates
        self.angles = np.stack([attitude.wrap(moved[0]), moved[1], attitude.wrap(moved[2])])
        self.tilt_sum = self.tilt_sum + residuals
        self.sample_count = self.sample_count + 1.0
        self.force_sum = self.force_sum + force
        self.rate_sum = self.rate_sum + rate
        self.rate = rate
        self.force = force
        self.imu_time = self.imu.time_of_validity
        self.tell(self.angles, euler_rates[2], known)

    @every("chart_period")
    def look_up(self):
        _, turned = self.chart()
        roll, pitch, heading = self.angles
        self.angles = np.stack([roll, pitch, attitude.wrap(heading + turned)])

    @every("aiding_period")
    def aid(self):
        count = np.maximum(self.sample_count, 1.0)
        felt = self.sample_count[0] > 0.5
        force, rate = self.force_sum / count[0], self.rate_sum / count[0]

        # airspeed: a new one has a new error
        fresh = self.fresh_air()
        back = fresh & np.logical_not(self.had_air)
        airspeed_error = np.where(back, 0.0, self.airspeed_error)
        airspeed = self.airspeed_seen - airspeed_error
        airspeed_sigma = np.where(fresh, self.air.true_airspeed_sigma, self.blind_airspeed_sigma)
        since = self.air.time_of_validity - self.airspeed_used_time
        changed = since > 1.0e-6
        speeding = np.where(fresh, (self.airspeed_seen - self.airspeed_used) / np.where(changed, since, 1.0), 0.0)

        # initial alignment
        new_field = felt & self.new_field()
        direction = self.field.field_b / np.maximum(ahrs.length(self.field.field_b), 1.0e-9)
        align = np.logical_not(self.aligned) & felt & new_field
        turning = ahrs.turning_acceleration(np.where(fresh, airspeed, 0.0), rate)
        level_roll, level_pitch = ahrs.level(force, turning)
        magnetic, down = ahrs.levelled_heading(direction, level_roll, level_pitch)
        angles = np.where(align, np.stack([level_roll, level_pitch, magnetic + self.local_declination]), self.angles)
        dip = np.where(align, np.arcsin(np.clip(down, -1.0, 1.0)), self.dip)
        initial = ahrs.initial_covariance(
            self.initial_sigma,
            np.sqrt(self.gyro_null_shift_sigma**2 + self.gyro_drift_sigma**2),
            self.dip_sigma,
            self.hard_iron_sigma,
            airspeed_sigma,
        )

        # time update
        decay = np.exp(-self.period / self.airspeed_time)
        noise = ahrs.process_noise(
            (self.alpha * self.gyro_noise) ** 2 * self.sample_period,
            self.gyro_scale_sigma,
            rate,
            self.gyro_drift_sigma,
            self.gyro_drift_time,
            self.dip_walk,
            airspeed_sigma**2 * (1.0 - decay * decay),
            self.period,
        )
        moved = kalman.propagate(
            ahrs.renewed(self.covariance, airspeed_sigma**2, back),
            ahrs.dynamics(angles[0], angles[1], rate, self.period),
            np.concatenate([np.ones(ahrs.AIRSPEED - ahrs.MOVING), np.reshape(decay, (1,))]),
            noise,
        )
        covariance = np.where(align, initial, moved)
        airspeed_error = decay * airspeed_error

        # measurement update: tilt
        sigma = np.where(fresh, self.tilt_sigma, self.blind_tilt_sigma)
        residuals = self.tilt_sum / count - np.stack([0.0, speeding / STANDARD_GRAVITY])
        rows = ahrs.tilt_rows(airspeed, rate[2], angles[0], angles[1])
        use = felt & self.aligned
        uses = use, use & (np.logical_not(fresh) | (self.had_air & changed))
        learning = np.stack([self.tilt_level, self.innovation_sum, self.innovation_count])
        least = np.maximum(ahrs.ENOUGH * self.tilt_window / self.period, 1.0)
        correction, covariance, learning = ahrs.tilt_updates(
            covariance, rows, residuals, sigma, uses, learning, least, self.tilt_limit
        )

        # measurement update: field
        turning_rates = attitude.euler_rates(rate, angles[0], angles[1])
        then = angles - turning_rates * self.before(self.field)
        expected, rows = ahrs.field_rows(*then, dip, self.local_declination, self.hard_iron)
        correction, covariance, misfit = ahrs.field_updates(
            correction,
            covariance,
            rows,
            direction - expected,
            self.field_sigma**2,
            new_field,
            self.field_misfit,
            self.field_limit,
        )

        # measurement update: GPS attitude
        told = np.stack([self.gps.roll, self.gps.pitch, self.gps.heading])
        new_gps = felt & self.new_gps()
        then = angles - turning_rates * self.before(self.gps)
        correction, covariance = ahrs.angle_updates(
            correction, covariance, attitude.wrap(told - then), self.gps_sigma**2, new_gps
        )
        self.gps_seen = np.where(new_gps, self.gps.sequence, self.gps_seen)
        self.gps_time = np.where(new_gps, self.time, self.gps_time)

        # end of the window
        window = self.window_time + self.period
        turned = self.turn_sum + np.abs(rate[2]) * self.period
        ended = window >= self.tilt_window - 1.0e-6
        floor = (self.tilt_sigma_min / self.tilt_sigma) ** 2
        levels = np.where(ended, ahrs.learned(learning, self.tilt_window / self.tilt_time, floor), learning[0])
        lost = ended & fresh & ahrs.lost(learning, sigma, turned / window, self.doubt_angle, self.doubt_rate)

        roll, pitch, heading, dip, over, under = ahrs.upright(*(angles + correction[:3]), dip + correction[ahrs.DIP])
        covariance = ahrs.mirrored(ahrs.mirrored(covariance, over, ahrs.PITCH), under, ahrs.DIP)
        running = np.logical_or(self.aligned, align)
        begin = np.logical_not(running) | lost | np.logical_not(ahrs.sound(covariance))
        self.aligned = np.logical_not(begin)
        self.angles = np.where(begin, self.angles, np.stack([attitude.wrap(roll), pitch, attitude.wrap(heading)]))
        self.covariance = np.where(begin, 0.0, covariance)
        self.dip = np.where(begin, 0.0, dip)
        self.rate = self.rate + np.where(begin, self.gyro_bias, -correction[3:6])
        self.gyro_bias = np.where(begin, np.zeros(3), self.gyro_bias + correction[3:6])
        self.hard_iron = np.where(begin, np.zeros(3), self.hard_iron + correction[ahrs.IRON])
        self.airspeed_error = np.where(begin, 0.0, airspeed_error + correction[ahrs.AIRSPEED])
        self.field_seen = np.where(new_field, self.field.sequence, self.field_seen)

        over_again = ended | begin
        self.tilt_level = np.where(begin, 1.0, levels)
        self.innovation_sum = np.where(over_again, 0.0, learning[1])
        self.innovation_count = np.where(over_again, 0.0, learning[2])
        summed = misfit[3] * self.period >= self.field_window - 1.0e-6
        self.field_misfit = np.where(summed | begin, 0.0, misfit)
        self.turn_sum = np.where(over_again, 0.0, turned)
        self.window_time = np.where(over_again, 0.0, window)
        kept = fresh & self.had_air & np.logical_not(changed)
        self.tilt_sum = np.stack([0.0, np.where(kept, self.tilt_sum[1], 0.0)])
        self.sample_count = np.stack([0.0, np.where(kept, self.sample_count[1], 0.0)])
        self.force_sum = np.zeros(3)
        self.rate_sum = np.zeros(3)
        self.airspeed_used = self.airspeed_seen
        self.airspeed_used_time = self.air.time_of_validity
        self.had_air = fresh

        self.sigmas = np.sqrt(np.maximum(kalman.diagonal(self.covariance)[:3], 0.0) + self.unseen() ** 2)
        self.tilt_noise = sigma * np.sqrt(self.tilt_level)
