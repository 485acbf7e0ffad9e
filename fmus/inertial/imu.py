"""The inertial measurement unit as an FMU."""

from __future__ import annotations

from fmus.grades import GRADES
from fmus.inertial.increments import Increments
from models.attitude import attitude
from models.earth.earth import STANDARD_GRAVITY
from models.inertial import inertial
from models.processes import gauss_markov
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start

_DEFAULT = GRADES["automotive"]


class Imu(Increments, Component):
    """Strapdown inertial measurement unit: three rate gyros and three accelerometers.

    Each axis measures, thesis (3.2)-(3.3), p. 38,

        s_m = (1 + s_f) s_t + b_0 + b_1(t) + b_w(t)

    s_t   true value in the sensors' axes, C_m times that in body axes, C_m = I - [misalignment x] as in (3.29)
    s_f   scale factor error
    b_0   null shift, constant in the run
    b_1   drift: first-order Gauss-Markov, db/dt = -b/tau + w, Q_w = 2 sigma^2/tau, (3.4)-(3.5); it starts in its
          stationary distribution and is advanced exactly, b <- phi b + sigma sqrt(1 - phi^2) n, phi = exp(-T/tau),
          every drift_period T, and held in between
    b_w   wide-band noise: one independent normal number per sample. Its sigma is that of a *sample*: the angle random
          walk it causes is sigma sqrt(sample_period) per root second, (B.10)

    Misalignment, scale factors and null shifts are each a given value plus one drawn at turn-on.

    The start values are the automotive grade of Table 3.2 (p. 56), which is the Crossbow DMU-6X of Table 3.1:
    gyros 180 deg/h, 300 s, 0.05 deg/s; accelerometers 1.2 mg, 100 s, 1 mg. What is drawn at turn-on is of units of this
    class: gyros 0.1 deg/s and 0.75 %, accelerometers 5 mg and 0.5 %, mounting 0.25 degrees.

    Inputs and outputs are in body axes, forward, right, down. The specific force at rest is (0, 0, -g).
    """

    name = "imu"
    example = Example(
        steps={"rate": (0.0, 0.0, 0.05), "specific_force": (0.0, 2.4, 0.0)},
        text="The readings step with the truth, offset by null shift and drift of each axis (tenths of a degree per "
        "second with the gyros of this grade, some milli-g with the accelerometers) and under wide-band noise.",
    )

    specific_force = Input(
        3, "m/s2", start=(0.0, 0.0, -STANDARD_GRAVITY), description="true specific force in body axes"
    )
    rate = Input(3, "rad/s", display_unit="deg/s", description="true rate with respect to inertial space, body axes")

    misalignment = Parameter(
        3,
        "rad",
        start=0.0,
        min=-0.2,
        max=0.2,
        display_unit="deg",
        description="given part of the rotation of the sensors about the body axes",
    )
    misalignment_sigma = Parameter(
        3,
        "rad",
        start=_DEFAULT["misalignment_sigma"],
        min=0.0,
        max=0.05,
        display_unit="deg",
        description="standard deviation of the part of that rotation that is drawn at turn-on",
    )
    gyro_scale_factor = Parameter(
        3,
        "1",
        start=0.0,
        min=-0.5,
        max=0.5,
        description="given part of the scale factor error of the gyros, s_f of thesis (3.2)",
    )
    gyro_scale_factor_sigma = Parameter(
        3,
        "1",
        start=_DEFAULT["gyro_scale_factor_sigma"],
        min=0.0,
        max=0.1,
        description="standard deviation of the part of the gyros' scale factor error that is drawn at turn-on",
    )
    gyro_null_shift = Parameter(
        3, "rad/s", start=0.0, display_unit="deg/h", description="given part of the gyros' null shift, b_0 of (3.3)"
    )
    gyro_null_shift_sigma = Parameter(
        3,
        "rad/s",
        start=_DEFAULT["gyro_null_shift_sigma"],
        min=0.0,
        display_unit="deg/h",
        description="standard deviation of the part of the gyros' null shift that is drawn at turn-on",
    )
    gyro_drift_sigma = Parameter(
        3,
        "rad/s",
        start=_DEFAULT["gyro_drift_sigma"],
        min=0.0,
        display_unit="deg/h",
        description="standard deviation of the gyros' drift b_1, thesis Table 3.2: 180 deg/h (automotive)",
    )
    gyro_drift_time = Parameter(
        "s",
        start=_DEFAULT["gyro_drift_time"],
        min=1.0,
        description="correlation time of the gyros' drift, thesis Table 3.2: 300 s (automotive)",
    )
    gyro_noise_sigma = Parameter(
        3,
        "rad/s",
        start=_DEFAULT["gyro_noise_sigma"],
        min=0.0,
        display_unit="deg/s",
        description="wide-band noise of the gyros per sample, thesis Table 3.2: 0.05 deg/s (automotive)",
    )
    accelerometer_scale_factor = Parameter(
        3,
        "1",
        start=0.0,
        min=-0.5,
        max=0.5,
        description="given part of the scale factor error of the accelerometers, s_f of (3.2)",
    )
    accelerometer_scale_factor_sigma = Parameter(
        3,
        "1",
        start=_DEFAULT["accelerometer_scale_factor_sigma"],
        min=0.0,
        max=0.1,
        description="standard deviation of the part of the accelerometers' scale factor error that is drawn at turn-on",
    )
    accelerometer_null_shift = Parameter(
        3,
        "m/s2",
        start=0.0,
        display_unit="mg",
        description="given part of the accelerometers' null shift, b_0 of (3.3)",
    )
    accelerometer_null_shift_sigma = Parameter(
        3,
        "m/s2",
        start=_DEFAULT["accelerometer_null_shift_sigma"],
        min=0.0,
        display_unit="mg",
        description="standard deviation of the part of the accelerometers' null shift that is drawn at turn-on",
    )
    accelerometer_drift_sigma = Parameter(
        3,
        "m/s2",
        start=_DEFAULT["accelerometer_drift_sigma"],
        min=0.0,
        display_unit="mg",
        description="standard deviation of the accelerometers' drift, thesis (3.24): 1.2 mg",
    )
    accelerometer_drift_time = Parameter(
        "s",
        start=_DEFAULT["accelerometer_drift_time"],
        min=1.0,
        description="correlation time of the accelerometers' drift, thesis (3.25): 100 s",
    )
    accelerometer_noise_sigma = Parameter(
        3,
        "m/s2",
        start=_DEFAULT["accelerometer_noise_sigma"],
        min=0.0,
        display_unit="mg",
        description="wide-band noise of the accelerometers per sample, thesis (3.26): 1 mg",
    )
    sample_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="sampling period")
    drift_period = Parameter("s", start=0.1, min=1e-4, max=10.0, description="period at which the drift is advanced")

    reading = Bundle(
        rate=Output(3, "rad/s", display_unit="deg/s", description="measured rate, body axes"),
        specific_force=Output(
            3, "m/s2", start=(0.0, 0.0, -STANDARD_GRAVITY), description="measured specific force, body axes"
        ),
        description="measurement",
    )

    mounting = State((3, 3), "1", description="C_m")
    gyro_gain_error = State(3, "1", description="scale factor error of the gyros, s_f")
    accelerometer_gain_error = State(3, "1", description="scale factor error of the accelerometers, s_f")
    gyro_bias = State(3, "rad/s", description="null shift of the gyros after turn-on, b_0")
    gyro_drift = State(3, "rad/s", description="drift of the gyros, b_1")
    gyro_decay = State("1", description="exp(-T/tau) of the gyros' drift")
    gyro_drive = State(3, "rad/s", description="sigma sqrt(1 - phi^2) of the gyros' drift")
    accelerometer_bias = State(3, "m/s2", description="null shift of the accelerometers after turn-on, b_0")
    accelerometer_drift = State(3, "m/s2", description="drift of the accelerometers, b_1")
    accelerometer_decay = State("1", description="exp(-T/tau) of the accelerometers' drift")
    accelerometer_drive = State(3, "m/s2", description="sigma sqrt(1 - phi^2) of the accelerometers' drift")

    @start
    def turn_on(self, noise):
        n = noise(21)
        rotation = self.misalignment + self.misalignment_sigma * n[12:15]
        self.mounting = attitude.mounting(rotation)
        self.gyro_gain_error = self.gyro_scale_factor + self.gyro_scale_factor_sigma * n[15:18]
        self.accelerometer_gain_error = (
            self.accelerometer_scale_factor + self.accelerometer_scale_factor_sigma * n[18:21]
        )
        self.gyro_bias = self.gyro_null_shift + self.gyro_null_shift_sigma * n[0:3]
        self.accelerometer_bias = self.accelerometer_null_shift + self.accelerometer_null_shift_sigma * n[3:6]
        self.gyro_drift = gauss_markov.stationary(self.gyro_drift_sigma, n[6:9])
        self.accelerometer_drift = gauss_markov.stationary(self.accelerometer_drift_sigma, n[9:12])
        self.gyro_decay = gauss_markov.decay(self.drift_period, self.gyro_drift_time)
        self.gyro_drive = gauss_markov.drive(self.gyro_drift_sigma, self.gyro_decay)
        self.accelerometer_decay = gauss_markov.decay(self.drift_period, self.accelerometer_drift_time)
        self.accelerometer_drive = gauss_markov.drive(self.accelerometer_drift_sigma, self.accelerometer_decay)
        self.begin_increments(*self.sensed())

    @every("drift_period")
    def drift(self, noise):
        n = noise(6)
        self.gyro_drift = gauss_markov.advance(self.gyro_drift, self.gyro_decay, self.gyro_drive, n[0:3])
        self.accelerometer_drift = gauss_markov.advance(
            self.accelerometer_drift, self.accelerometer_decay, self.accelerometer_drive, n[3:6]
        )

    @every("sample_period")
    def sample(self, noise):
        n = noise(6)
        rate, specific_force = self.sensed()
        rate_noise, force_noise = self.gyro_noise_sigma * n[0:3], self.accelerometer_noise_sigma * n[3:6]
        self.reading.publish(rate=rate + rate_noise, specific_force=specific_force + force_noise)
        self.integrate(rate, specific_force, rate_noise, force_noise)

    def sensed(self):
        """Rate and specific force with all errors but wide-band noise."""
        return (
            inertial.sense(self.mounting @ self.rate, self.gyro_gain_error, self.gyro_bias, self.gyro_drift),
            inertial.sense(
                self.mounting @ self.specific_force,
                self.accelerometer_gain_error,
                self.accelerometer_bias,
                self.accelerometer_drift,
            ),
        )
