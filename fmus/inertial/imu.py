"""The inertial measurement unit as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.inertial.grades import INERTIAL
from fmus.inertial.increments import Increments
from fmus.inertial.lever_arm import LeverArm
from fmus.inertial.triad import Triad, triad
from fmus.inertial.vibration import Vibration
from models.attitude import attitude
from models.inertial import axes, flicker, heating, latency, shaping
from models.processes import gauss_markov
from models.processes.known import known
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, require, start

_DEFAULT = INERTIAL["automotive"].values
ROOM = 293.15
"""20 degC in K."""


class Imu(
    Vibration,
    LeverArm,
    Increments,
    triad("accelerometer", "accelerometers", "m/s2", ("mg", "mg"), _DEFAULT),
    triad("gyro", "gyros", "rad/s", ("deg/h", "deg/s"), _DEFAULT),
    Component,
):
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

    What follows is off unless a parameter turns it on, each for both triads and in the order in which it acts:

    - axes that are not at right angles (`nonorthogonality`), sensitivity of the gyros to specific force
      (`gyro_g_sensitivity`), asymmetry of the scale factor and its change with temperature;
    - a lag of first or second order (`bandwidth`), exact for an input that is linear between samples;
    - change of the null shift with temperature, flicker noise (`flicker`: B, Allan deviation 0.664 B) and rate random
      walk (`walk_sigma`), both advanced every wander_period;
    - `range`; `resolution` and `latency` of the reading, which leaves later with the time at which it was taken.

    `lever_arm` says where the accelerometers are: w' x r + w x (w x r) more, w' from the last three rates, wrong by
    (2 pi f T)^2 / 3. While `vibrating`, the unit swings and is shaken by the vibration_ parameters at the samples.

    The bundle `increment` is what has been sensed in `increment_samples` samples: trapezoids, plus T b_w, in whole
    quanta if there are any; with coning and sculling of order 2 `coning_samples` (RTO MP-43 (1999), Mark and Tazartes,
    (A-54)). Velocity is the sum in body axes as they turned, not turned to those of the beginning.

    The sensors follow the temperature around them, with `thermal_time`, and become warmer by `self_heating` after
    turn-on, thesis Fig 3.5. Their errors are those of `calibration_temperature` there.

    The start values are the automotive grade of Table 3.2 (p. 56), which is the Crossbow DMU-6X of Table 3.1:
    gyros 180 deg/h, 300 s, 0.05 deg/s; accelerometers 1.2 mg, 100 s, 1 mg. What is drawn at turn-on is of units of this
    class: gyros 0.1 deg/s and 0.75 %, accelerometers 5 mg and 0.5 %, mounting 0.25 degrees.

    Inputs and outputs are in body axes, forward, right, down. The specific force at rest is (0, 0, -g).
    """

    name = "imu"
    parameter_sets = INERTIAL
    example = Example(
        steps={"rate": (0.0, 0.0, 0.05), "specific_force": (0.0, 2.4, 0.0)},
        text="The readings step with the truth, offset by null shift and drift of each axis (tenths of a degree per "
        "second with the gyros of this grade, some milli-g with the accelerometers) and under wide-band noise. The "
        "increments are what a sample adds to angle and velocity.",
        shows=("reading.rate", "reading.specific_force", "increment.angle", "increment.velocity"),
    )

    specific_force = Input(
        3, "m/s2", start=(0.0, 0.0, -STANDARD_GRAVITY), description="true specific force in body axes"
    )
    rate = Input(3, "rad/s", display_unit="deg/s", description="true rate with respect to inertial space, body axes")
    temperature = Input("K", start=ROOM, min=0.0, display_unit="degC", description="temperature around the unit")
    misalignment_change = Input(
        3,
        "rad",
        fault=True,
        display_unit="deg",
        description="fault F13: the unit turns about the body axes in its mounting",
    )
    gyro_g_sensitivity_change = Input(
        3,
        "rad.s/m",
        fault=True,
        description="fault F13: gyros become sensitive to the specific force along their own axes",
    )

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
    gyro_g_sensitivity = Parameter(
        3, 3, "rad.s/m", description="given part of G, what each gyro shows of the specific force along the three axes"
    )
    gyro_g_sensitivity_sigma = Parameter(
        "rad.s/m", min=0.0, description="standard deviation of the part of each element of G that is drawn at turn-on"
    )
    self_heating = Parameter(
        "K", min=0.0, difference=True, description="by how much the sensors become warmer than what is around them"
    )
    thermal_time = Parameter(
        "s",
        start=3600.0,
        min=1.0,
        description="time constant of the temperature of the sensors: thesis Fig 3.5, a third of 3 h",
    )
    calibration_temperature = Parameter(
        "K",
        start=ROOM,
        min=0.0,
        display_unit="degC",
        description="temperature of the sensors at which it causes no errors",
    )
    sample_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="sampling period")
    drift_period = Parameter("s", start=0.1, min=1e-4, max=10.0, description="period at which the drift is advanced")
    wander_period = Parameter(
        "s", start=1.0, min=1e-3, max=60.0, description="period at which flicker noise and random walk are advanced"
    )
    flicker_time = Parameter(
        "s",
        start=10.0,
        min=0.1,
        description="shortest correlation time of the flicker noise; from 3 times that on its floor is flat",
    )
    latency = Parameter(
        kind="integer",
        min=0,
        max=latency.LONGEST,
        description="by how many samples later a reading leaves the unit; increments leave at once",
    )

    reading = Bundle(
        rate=Output(3, "rad/s", display_unit="deg/s", description="measured rate, body axes"),
        specific_force=Output(
            3, "m/s2", start=(0.0, 0.0, -STANDARD_GRAVITY), description="measured specific force, body axes"
        ),
        description="measurement",
    )
    sensor_temperature = Output(
        "K", start=ROOM, display_unit="degC", description="temperature of the sensors, as a probe beside them shows it"
    )

    force_to_rate = State(3, 3, "rad.s/m", description="G after turn-on")
    flicker_decay = State(flicker.DECADES, 1, "1", description="exp(-T / tau_i) of the flicker noise")
    thermal_decay = State("1", description="exp(-T/tau) of the temperature")
    taken = State(kind="integer", description="samples taken so far")

    @require(
        "flicker_time is {flicker_time} s and wander_period {wander_period} s; expected a wander_period that is not "
        "longer, as held values make more flicker noise than gyro_flicker and accelerometer_flicker tell"
    )
    def flicker_is_followed(self):
        flickers = np.stack([sensors.flicker for sensors in self.triads()])
        return np.logical_or(self.wander_period <= self.flicker_time, np.all(flickers == 0.0))

    @require("a resolution is larger than the range of its axis; expected steps that fit into it, or 0 for none")
    def steps_fit_the_range(self):
        fits = [(sensors.range == 0.0) | (sensors.resolution <= sensors.range) for sensors in self.triads()]
        return np.all(np.stack(fits))

    def triads(self):
        """Gyros and accelerometers."""
        return Triad(self, "gyro"), Triad(self, "accelerometer")

    @start
    def turn_on(self, noise):
        both = self.triads()
        for sensors in both:
            sensors.draw("null_shift", noise)
        for sensors in both:
            sensors.begin_drift(self.drift_period, noise)
        mounting = attitude.mounting(self.misalignment + self.misalignment_sigma * noise(3))
        for sensors in both:
            sensors.draw("scale_factor", noise)
        self.force_to_rate = self.gyro_g_sensitivity + self.gyro_g_sensitivity_sigma * np.reshape(noise(9), (3, 3))
        for sensors in both:
            for error in ("scale_factor_asymmetry", "scale_factor_temperature", "null_shift_temperature"):
                sensors.draw(error, noise)
            sensors.draw("nonorthogonality", noise)
            sensors.begin_wander(noise)
            sensors.begin_lag(mounting, self.sample_period)
        self.flicker_decay = gauss_markov.decay(self.wander_period, flicker.correlation_times(self.flicker_time))
        self.thermal_decay = gauss_markov.decay(self.drift_period, self.thermal_time)
        self.sensor_temperature = known(self.temperature, self.calibration_temperature)
        self.begin_rates()
        for sensors, scaled in zip(both, self.scaled(), strict=True):
            sensors.settle(scaled)
        sensed = (sensors.within(sensors.sensed(sensors.lagged[0], self.warmer())) for sensors in both)
        gyros, _ = both
        self.begin_increments(
            *sensed, shaping.squared(gyros.transition, (gyros.delay, gyros.inverse), self.sample_period)
        )

    def warmer(self):
        """Temperature of the sensors above that of their calibration, K."""
        return self.sensor_temperature - self.calibration_temperature

    def scaled(self):
        """What gyros and accelerometers show but for their lags: axes, sensitivity to force, scale factors."""
        gyros, accelerometers = self.triads()
        rate, force = self.shaken(self.rate, self.force_at_the_arm())
        rate, force = (axes.turned(vector, self.misalignment_change) for vector in (rate, force))
        felt, force, rate = gyros.axes @ force, accelerometers.axes @ force, gyros.axes @ rate
        rate = rate + self.force_to_rate @ felt + self.gyro_g_sensitivity_change * felt
        return gyros.scaled(rate, self.warmer()), accelerometers.scaled(force, self.warmer())

    @every("drift_period")
    def drift(self, noise):
        for sensors in self.triads():
            sensors.advance_drift(noise)
        self.sensor_temperature = heating.advance(
            self.sensor_temperature,
            known(self.temperature, self.sensor_temperature - self.self_heating),
            self.self_heating,
            self.thermal_decay,
        )

    @every("sample_period")
    def sample(self, noise):
        gyros, accelerometers = self.triads()
        rate, force = self.scaled()
        whole = np.all(np.isfinite(rate)) & np.all(np.isfinite(force))
        self.remember_rate()
        rate, force = np.where(whole, rate, gyros.before), np.where(whole, force, accelerometers.before)
        rate = gyros.sensed(gyros.follow(rate, self.period), self.warmer())
        force = accelerometers.sensed(accelerometers.follow(force, self.period), self.warmer())
        noisy_rate = rate + gyros.noise_sigma * noise(3)
        noisy_force = force + accelerometers.noise_sigma * noise(3)
        self.taken = self.taken + 1
        read_rate, read_force = gyros.read(noisy_rate), accelerometers.read(noisy_force)
        read_rate = gyros.leave(np.where(whole, read_rate, np.nan), self.latency)
        self.reading.publish(
            rate=read_rate,
            specific_force=accelerometers.leave(np.where(whole, read_force, np.nan), self.latency),
            valid=np.all(np.isfinite(read_rate)),
            time_of_validity=self.time - self.latency * self.period,
            when=self.taken > self.latency,
        )
        rate, noisy_rate = gyros.within(rate), gyros.within(noisy_rate)
        force, noisy_force = accelerometers.within(force), accelerometers.within(noisy_force)
        self.integrate(rate, force, noisy_rate - rate, noisy_force - force, whole)

    @every("wander_period")
    def wander(self, noise):
        for sensors in self.triads():
            sensors.advance_wander(self.period, self.flicker_decay, noise)
