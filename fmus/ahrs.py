"""The FMU ``ahrs``: attitude and heading reference system."""

from __future__ import annotations

import numpy as np

from fmus import examples
from models import ahrs, attitude, earth, kalman
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, on_new


class Ahrs(Component):
    """Attitude and heading reference: gyros, aided by accelerometers and a magnetometer.

    Thesis section 4.12 with the filter of 4.11.1. With every IMU sample the Euler angles are advanced by the rates less
    their estimated biases,

        d(roll, pitch, heading)/dt = f(roll, pitch) (p, q, r)                                (4.4), (4.45)

    by the trapezoidal rule over the time between the samples (row 2, column 3 of f is -sin(roll); (4.35), (4.45) print
    -cos). Every `aiding_period` a Kalman filter with six states, errors of the angles and gyro biases (4.32), takes

    - roll and pitch from the mean specific force of the period (4.8), (4.9), while the aircraft flies straight, that
      is the computed yaw rate (4.67) and roll rate are below `yaw_rate_limit`, and unaccelerated, within `force_limit`
      of 1 g: output `aiding`;
    - the direction of the magnetic field as a vector, always. In straight flight this is the levelled magnetic heading
      plus `declination`. In turns it keeps all angles observable; the thesis switches it off together with the
      accelerometers and lets the gyros run free, which with an automotive gyro (0.05 deg/s) loses degrees in each
      360-degree turn.

    The direction of the field relative to the horizontal (its dip) is learned while the accelerometers aid.

    Covariance and gains are computed, P+ = Phi P Phi' + C_d (4.46), L = P H' (H P H' + R)^-1 (4.50, corrected); they
    are not scheduled. Phi has the derivatives by roll and pitch, which (4.34) sets to zero. Biases are random walks of
    2 sigma^2 / tau. Parameters in the manner of Table 4.4; heading errors follow the magnetometer's calibration
    residuals (thesis section 3.12: up to 2.5 degrees), smoothed by the gyros.

    At the first aiding with field and specific force the angles are set from these; until then `attitude.valid` is
    false.
    """

    tick = "sample_period"
    example = Example(
        {"sample_period": 0.05},
        text="A full circle at 3 deg/s in level flight (60 to 184 s), with gyros that are wrong by 0.15 deg/s in roll "
        "and -0.1 deg/s in yaw. The angles follow the truth (dashed). In straight flight (`aiding` 1) the "
        "accelerometers aid and the biases of the gyros are learned, in the turn (0) the magnetic field aids alone.",
        duration=300.0,
        step=0.05,
        inputs=examples.ahrs_inputs,
        shows=("gyro_bias", "heading_sigma", "aiding"),
        panels=examples.ahrs_panels,
    )

    imu = Bundle(
        rate=Input(3, "rad/s", display_unit="deg/s", description="angular rate, body axes"),
        specific_force=Input(3, "m/s2", start=(0, 0, -9.80665), description="specific force, body axes"),
        description="inertial measurement",
    )
    field = Bundle(
        field_b=Input(3, "T", display_unit="mG", description="magnetic field, body axes"), description="magnetic field"
    )

    sample_period = Parameter(
        "s", start=0.01, min=1.0e-4, max=1.0, description="period at which new IMU samples are looked for and expected"
    )
    aiding_period = Parameter(
        "s", start=0.5, min=0.001, max=60.0, description="period of aiding (thesis Fig 4.7: 2 Hz)"
    )
    declination = Parameter(
        "rad",
        start=np.radians(13.0),
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="magnetic declination, east positive; 13 deg at Livermore (chart value)",
    )
    yaw_rate_limit = Parameter(
        "rad/s",
        start=np.radians(0.5),
        min=0.0,
        display_unit="deg/s",
        description="computed yaw rate above which accelerometers are not used (thesis (4.67), p. 149); also for roll",
    )
    force_limit = Parameter(
        "1",
        start=0.05,
        min=0.0,
        description="departure of the specific force from 1 g above which it is not used (thesis p. 150: 1.05 g)",
    )
    gyro_noise = Parameter(
        "rad/s",
        start=np.radians(0.05),
        min=0.0,
        display_unit="deg/s",
        description="wide-band noise of a gyro sample (thesis Table 3.2, Table 4.4 sigma_p, sigma_q, sigma_r)",
    )
    alpha = Parameter(
        "1", start=3.0, min=0.0, description="tuning factor on the gyro noise (thesis (4.39); Table 4.4 has 10)"
    )
    gyro_drift_sigma = Parameter(
        "rad/s",
        start=np.radians(0.05),
        min=0.0,
        display_unit="deg/s",
        description="standard deviation of the gyro drift and null shift (thesis Table 3.2, Table 4.4 sigma_w)",
    )
    gyro_drift_time = Parameter(
        "s", start=300.0, min=1.0, description="correlation time of the drift (thesis Table 3.2)"
    )
    tilt_sigma = Parameter(
        "rad",
        start=np.radians(0.3),
        min=1.0e-6,
        display_unit="deg",
        description="error of roll and pitch from accelerometers: noise, drift, small accelerations (own choice)",
    )
    field_sigma = Parameter(
        "1",
        start=0.05,
        min=1.0e-6,
        description="error of each component of the direction of the field: 4 to 7 mG (thesis Fig 3.27), "
        "widened because it depends on heading and so persists on each leg",
    )
    field_in_turns = Parameter(
        kind="boolean",
        start=True,
        description="whether the field is used in turns too; false: gyros alone, as in thesis section 4.12",
    )
    dip_time = Parameter(
        "s", start=120.0, min=0.01, description="time constant with which the dip is learned (own choice)"
    )
    initial_sigma = Parameter(
        "rad",
        start=np.radians(2.0),
        min=0.0,
        display_unit="deg",
        description="error of the initial alignment in straight flight",
    )

    attitude = Bundle(
        roll=Output("rad", display_unit="deg", description="roll"),
        pitch=Output("rad", display_unit="deg", description="pitch"),
        heading=Output("rad", display_unit="deg", description="true heading in [-pi, pi)"),
        yaw_rate=Output("rad/s", display_unit="deg/s", description="rate of heading"),
        description="attitude",
    )
    aiding = Output(kind="boolean", description="accelerometers are in use: straight and unaccelerated flight")
    gyro_bias = Output(3, "rad/s", display_unit="deg/s", description="estimated null shift and drift of the gyros")
    heading_sigma = Output("rad", display_unit="deg", description="standard deviation of heading by the filter")

    angles = State(3, "rad", display_unit="deg", description="roll, pitch, heading")
    covariance = State(21, "1", description="upper triangle of the filter's covariance, row by row; rad and rad/s")
    rate = State(3, "rad/s", description="last rate less bias")
    imu_time = State("s", description="time of validity of the last IMU sample")
    turned = State("rad", description="change of heading since the last aiding")
    rolled = State("rad", description="change of roll since the last aiding")
    force_sum = State(3, "m/s2", description="sum of specific forces since the last aiding")
    force_count = State("1", description="number of IMU samples since the last aiding")
    field_seen = State(kind="integer", description="sequence number of the last field used")
    dip = State("rad", display_unit="deg", description="dip of the field, positive down")
    aligned = State(kind="boolean", description="initial alignment has been done")

    @on_new("imu")
    def integrate(self):
        step = np.maximum(self.imu.time_of_validity - self.imu_time, 0.0)
        rate = self.imu.rate - self.gyro_bias
        euler_rates = attitude.euler_rates(0.5 * (rate + self.rate), self.angles[0], self.angles[1])
        moved = self.angles + step * euler_rates
        self.angles = np.stack([moved[0], moved[1], attitude.wrap(moved[2])])
        self.turned = self.turned + step * euler_rates[2]
        self.rolled = self.rolled + step * euler_rates[0]
        self.rate = rate
        self.imu_time = self.imu.time_of_validity
        self.force_sum = self.force_sum + self.imu.specific_force
        self.force_count = self.force_count + 1.0
        self.attitude.publish(
            roll=self.angles[0],
            pitch=self.angles[1],
            heading=self.angles[2],
            yaw_rate=euler_rates[2],
            valid=np.logical_and(self.aligned, self.imu.valid),
            time_of_validity=self.imu.time_of_validity,
        )

    @every("aiding_period")
    def aid(self):
        felt = self.force_count > 0.5
        force = np.where(felt, self.force_sum / np.maximum(self.force_count, 1.0), np.array([0.0, 0.0, -9.80665]))
        straight, quiet = ahrs.gates(
            self.turned,
            self.rolled,
            self.period,
            force,
            earth.STANDARD_GRAVITY,
            self.yaw_rate_limit,
            self.force_limit,
        )
        use_force = quiet & felt
        due = self.field.time_of_validity <= self.time + 1.0e-6
        new_field = self.field.valid & (self.field.sequence != self.field_seen) & due
        level_roll, level_pitch = ahrs.level(force)
        strength = np.maximum(ahrs.length(self.field.field_b), 1.0e-9)
        direction = self.field.field_b / strength
        magnetic, down = ahrs.levelled_heading(direction, level_roll, level_pitch)
        level_dip = np.arcsin(np.clip(down, -1.0, 1.0))

        # initial alignment
        align = np.logical_not(self.aligned) & felt & new_field
        use_field = new_field & (straight | self.field_in_turns)
        angles = np.where(
            align, np.stack([level_roll, level_pitch, attitude.wrap(magnetic + self.declination)]), self.angles
        )
        learning = np.where(
            align, 1.0, np.where(use_force & use_field, self.period / (self.period + self.dip_time), 0.0)
        )
        dip = self.dip + learning * (level_dip - self.dip)
        tilt = np.where(straight, self.initial_sigma, np.radians(15.0))
        drift = self.gyro_drift_sigma
        initial = kalman.of_variances(np.stack([tilt, tilt, 2.0 * tilt, drift, drift, drift]) ** 2)

        # time update
        transition = ahrs.dynamics(angles[0], angles[1], self.rate, self.period)
        noise = ahrs.process_noise(
            (self.alpha * self.gyro_noise) ** 2 * self.sample_period, drift, self.gyro_drift_time, self.period
        )
        covariance = np.where(align, initial, kalman.propagate(self.covariance, transition, noise))

        # measurement update
        correction = np.zeros(6)
        no_bias = np.zeros(3)
        tilts = (level_roll - angles[0], level_pitch - angles[1])
        for axis, residual in enumerate(tilts):
            correction, covariance, _ = kalman.update(
                correction, covariance, np.eye(6)[axis], self.tilt_sigma**2, attitude.wrap(residual), use_force
            )
        then = angles[2] - self.turned / self.period * (self.time - self.field.time_of_validity)
        expected, rows = ahrs.field_rows(angles[0], angles[1], then, ahrs.field_n(dip, self.declination))
        for axis in range(3):
            correction, covariance, _ = kalman.update(
                correction,
                covariance,
                np.concatenate([rows[axis], no_bias]),
                self.field_sigma**2,
                direction[axis] - expected[axis],
                use_field,
            )
        angles = angles + correction[:3]
        running = np.logical_or(self.aligned, align)
        self.angles = np.where(running, np.stack([angles[0], angles[1], attitude.wrap(angles[2])]), self.angles)
        self.gyro_bias = np.where(running, self.gyro_bias + correction[3:], self.gyro_bias)
        self.rate = np.where(running, self.rate - correction[3:], self.rate)
        self.covariance = np.where(running, covariance, self.covariance)
        self.heading_sigma = np.sqrt(np.maximum(kalman.diagonal(self.covariance)[2], 0.0))
        self.dip = np.where(running, dip, self.dip)
        self.aligned = running
        self.aiding = np.logical_and(running, use_force)
        self.field_seen = np.where(new_field, self.field.sequence, self.field_seen)
        self.force_sum = np.zeros(3)
        self.force_count = 0.0
        self.turned = 0.0
        self.rolled = 0.0
