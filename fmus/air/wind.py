"""The wind along the flight as an FMU."""

from __future__ import annotations

from models.processes import gauss_markov
from navfmu.export import Component, Example, Output, Parameter, State, every, start


class Wind(Component):
    """Wind along the flight: a mean and the Berman-Powell random part.

    Thesis section 3.8, p. 66. On each axis the random part is a first-order Gauss-Markov process, (3.36)-(3.37),

        d(dV)/dt_r = -dV / tau + w,   sigma = 5 m/s,  tau = 400 s

    over the travelling time t_r of (3.35), t_r^2 = t_N^2 + t_E^2 + t_D^2 + dt^2 with t_N = dp_N / V_N and so on for
    the axes on which the aircraft moves. In steady flight t_r is a multiple of time: 1 as the thesis's own analyses
    take it (start value), sqrt(2) flying along one axis, sqrt(3) in level flight across both, 2 in a climb. It starts
    in its stationary distribution and is advanced exactly,
    dV <- phi dV + sigma sqrt(1 - phi^2) n with phi = exp(-ratio T / tau), every sample_period T, and held in between.
    The model was fitted between 2000 and 10000 ft.

    The wind is the velocity of the air over the ground: an air mass that moves north has a positive first component
    (in the aviation sense a wind *from* the south).
    """

    name = "wind"
    example = Example(
        duration=1800.0,
        text="Half an hour of wind, which wanders by 5 m/s (10 kn, 1 sigma) on each axis and forgets within some "
        "400 s. Another `seed` gives another wind.",
    )

    mean_n = Parameter(
        3, "m/s", start=0.0, min=-100.0, max=100.0, display_unit="kn", description="mean wind, north, east, down"
    )
    sigma = Parameter(
        3,
        "m/s",
        start=(5.0, 5.0, 0.0),
        min=0.0,
        max=50.0,
        display_unit="kn",
        description="standard deviation of the random part, thesis (3.36), (3.37): 5 m/s north and east",
    )
    correlation_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time, thesis (3.36), (3.37): 400 s"
    )
    travelling_time_ratio = Parameter(
        "1",
        start=1.0,
        min=1.0,
        max=2.0,
        description="travelling time of thesis (3.35) per time: 1 (as the thesis's analyses take it) to 2 (in a climb)",
    )
    sample_period = Parameter("s", start=0.1, min=1e-3, max=10.0, description="period at which the wind is advanced")

    wind_n = Output(3, "m/s", display_unit="kn", description="velocity of the air over the ground, north, east, down")

    variation = State(3, "m/s", description="random part")
    decay = State("1", description="exp(-T/tau)")
    drive = State(3, "m/s", description="sigma sqrt(1 - phi^2)")

    @start
    def draw(self, noise):
        self.variation = gauss_markov.stationary(self.sigma, noise(3))
        self.decay = gauss_markov.decay(self.travelling_time_ratio * self.sample_period, self.correlation_time)
        self.drive = gauss_markov.drive(self.sigma, self.decay)
        self.wind_n = self.mean_n + self.variation

    @every("sample_period")
    def advance(self, noise):
        self.variation = gauss_markov.advance(self.variation, self.decay, self.drive, noise(3))
        self.wind_n = self.mean_n + self.variation
