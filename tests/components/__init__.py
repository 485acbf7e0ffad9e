"""Small components that tests connect into systems: sources, a lag, a noisy sensor, an estimator."""

from __future__ import annotations

import numpy as np

from navfmu.export import Bundle, Component, Input, Output, Parameter, State, every, on_new, start


class Source(Component):
    """A sine wave, as an aircraft is: known at all times, also at t = 0."""

    y = Output("m", description="amplitude * sin(t / time_constant)")
    amplitude = Parameter("m", start=10.0, min=0.0, max=1000.0, display_unit="ft", description="amplitude")
    time_constant = Parameter("s", start=1.0, min=0.01, description="period / 2 pi")
    sample_period = Parameter("s", start=0.01, min=1e-4, description="time between values")

    @start
    def begin(self):
        self.y = 0.0 * self.amplitude

    @every("sample_period")
    def step(self):
        self.y = self.amplitude * np.sin(self.time / self.time_constant)


class Lag(Component):
    """A first-order lag by explicit Euler: y <- y + (u - y) sample_period / tau."""

    u = Input("m", description="input")
    bias = Input("m", fault=True, description="added to the input: a physical fault")
    y = Output("m", description="output")
    tau = Parameter("s", start=1.0, min=0.01, description="time constant")
    y0 = Parameter("m", start=0.0, description="output at t = 0")
    sample_period = Parameter("s", start=0.1, min=1e-4, description="time between values")

    @start
    def begin(self):
        self.y = self.y0

    @every("sample_period")
    def step(self):
        self.y = self.y + (self.u + self.bias - self.y) * self.period / self.tau


class Sensor(Component):
    """Measures a length with white noise at its own period."""

    length = Input("m", description="true length")
    reading = Bundle(length=Output("m", description="measured length"), description="measurement")
    sigma = Parameter("m", start=0.5, min=0.0, description="standard deviation of the noise")
    sample_period = Parameter("s", start=0.1, min=1e-4, max=10.0, description="time between measurements")

    @every("sample_period")
    def sample(self, noise):
        self.reading.publish(length=self.length + self.sigma * noise(1)[0], valid=True)


class Estimator(Component):
    """Averages measurements with a fixed gain and knows how many it has used."""

    reading = Bundle(length=Input("m", description="measured length"), description="measurement")
    solution = Bundle(length=Output("m", description="estimated length"), description="estimate")
    sigma = Output("m", start=1.0, description="standard deviation that the estimate claims")
    gain = Parameter("1", start=0.2, min=0.0, max=1.0, description="share of the newest measurement")
    used = State("1", description="measurements used")
    sample_period = Parameter("s", start=0.1, min=1e-4, description="tick")
    tick = "sample_period"

    @on_new("reading")
    def update(self):
        estimate = self.solution.length + self.gain * (self.reading.length - self.solution.length)
        self.used = self.used + 1.0
        self.sigma = 1.0 / np.sqrt(1.0 + self.used)
        self.solution.publish(length=estimate, valid=True)


class Two(Component):
    """Two lengths that are known at all times."""

    y = Output("m", description="sin(t)")
    z = Output("m", description="10 + t")
    sample_period = Parameter("s", start=0.01, min=1e-4, description="time between values")

    @start
    def begin(self):
        self.y = 0.0 * self.sample_period
        self.z = 10.0 + 0.0 * self.sample_period

    @every("sample_period")
    def step(self):
        self.y = np.sin(self.time)
        self.z = 10.0 + self.time


ALL = (Source, Lag, Sensor, Estimator, Two)
