"""The FMU ``gps_errors``: what is wrong with satellites and the air, the same for all receivers of a neighbourhood."""

from __future__ import annotations

import numpy as np

from fmus.satellite.gps_signals import SATELLITES, GpsSignals
from models.processes import gauss_markov
from models.processes.known import known
from models.satellite import ageing
from navfmu.export import Component, Example, Output, Parameter, State, every, start


class GpsErrors(Component):
    """Errors of GPS that receivers near each other share: orbits and clocks, ionosphere, troposphere.

    They are those that each gps_signals draws for itself, with the same parameters: own errors of satellites with
    sqrt(`own_sigma`^2 + (60 m / 7 d `upload_age`)^2), a factor of the ionosphere's delay, a delay of the troposphere at
    the zenith, all first-order Gauss-Markov processes that start in their stationary distributions. gps_signals takes
    them as inputs of the same names, and has its own `own_sigma`, `ionosphere_sigma` and `troposphere_sigma` at 0 then:
    what both have is added.

    A system of several receivers has one of it, as it has one `weather` for all that measures the air.
    """

    name = "gps_errors"
    example = Example(
        {"own_time": 600.0, "ionosphere_time": 600.0},
        steps={},
        duration=3600.0,
        text="An hour; errors that last for 10 min and not an hour.",
        shows=("range_error[1]", "range_error[2]", "ionosphere_error", "zenith_error"),
    )

    accuracy_lie = GpsSignals.accuracy_lie

    own_sigma = GpsSignals.own_sigma
    own_time = GpsSignals.own_time
    upload_age = GpsSignals.upload_age
    ionosphere_sigma = GpsSignals.ionosphere_sigma
    ionosphere_time = GpsSignals.ionosphere_time
    troposphere_sigma = GpsSignals.troposphere_sigma
    troposphere_time = GpsSignals.troposphere_time
    sample_period = Parameter("s", start=1.0, min=1e-3, max=100.0, description="period at which they change")

    range_error = Output(SATELLITES, "m", description="error of orbit and clock in a range, by PRN")
    ionosphere_error = Output("1", description="delay of the ionosphere over that by what is sent, less 1")
    zenith_error = Output("m", description="delay of the troposphere at the zenith beyond the model")

    own = State(SATELLITES, "1", description="errors of satellites, over their sigma")
    common = State(2, "1", description="error of ionosphere and troposphere, over their sigmas")

    @start
    def draw(self, noise):
        self.own, self.common = noise(SATELLITES), noise(2)
        self._publish()

    @every("sample_period")
    def advance(self, noise):
        phi = gauss_markov.decay(self.period, self.own_time)
        self.own = gauss_markov.advance(self.own, phi, gauss_markov.drive(1.0, phi), noise(SATELLITES))
        phi = gauss_markov.decay(self.period, np.stack([self.ionosphere_time, self.troposphere_time]))
        self.common = gauss_markov.advance(self.common, phi, gauss_markov.drive(1.0, phi), noise(2))
        self._publish()

    def _publish(self):
        sigma = ageing.sigma(self.own_sigma, self.upload_age) * (1.0 + known(self.accuracy_lie, 0.0))
        self.range_error = sigma * self.own
        self.ionosphere_error = self.ionosphere_sigma * self.common[0]
        self.zenith_error = self.troposphere_sigma * self.common[1]
