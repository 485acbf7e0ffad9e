"""The FMU ``navigator_reduced``: DME-aided dead reckoning of reduced order, the one that the thesis flew."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.navigation.ranges import Ranges
from fmus.navigation.seven_states import AT_ONCE
from fmus.navigation.thesis import PRINTED, covariance, sigmas
from models.navigation import reduced_order
from models.processes import gauss_markov
from navfmu.export import Component, Example, ParameterSet, State

STATES = reduced_order.STATES
SETS = {
    "as_printed": ParameterSet(
        "R (6.40) as it is printed, no gate: what the thesis flew.", {**PRINTED, "bias_sigma": 0.0}
    )
}


class NavigatorReduced(Ranges, Component):
    """DME-aided dead reckoning with the filter of reduced order, thesis section 6.5 and Fig 6.5.

    The states are (6.54), position and wind; errors of heading and airspeed and the biases of ranges are none of its
    business: what they do goes into wind and position. Everything else is as in `navigator_full`, whose gate and
    recovery it has; altitude is pressure altitude plus an offset learned from GPS. It stands in the place of
    `navigator`.

    *Measurement noise.* R has the bias as independent noise that carries as much information, R = noise^2 +
    sigma^2 (1 + rho) / (1 - rho), rho = exp(-dt / tau), tau = 0.5 nmi / V. (6.40) leaves it out: `bias_sigma` 0 flies
    that, and the filter claims some tens of metres where it is hundreds wrong (parameter set `as_printed`).

    *Its claim* is not what is wrong with it: nothing in it accounts for heading and airspeed. Where the wind is as
    large as it supposes, that is little (docs/navigators.md).

    *Without heading or airspeed* the last air velocity is held, and the wind has the speed of the aircraft as its
    sigma; when they are back, the wind is what nothing has measured.
    """

    parameter_sets = SETS
    example = Example(
        text="Level flight to the west at 90 kn in a wind of 15 kn, with heading wrong by 1 degree and airspeed by "
        "2 m/s. GPS is lost at 300 s (dotted). What GPS shows of heading and airspeed goes into the wind. Then one DME "
        "range every 15 s, each wrong by some 315 m.",
        duration=1200.0,
        step=0.1,
        mark=examples.GPS_LOST,
        inputs=examples.navigator_inputs,
        periods={"fix": 1.0, "ranging": 15.0},
        shows=("solution.wind_n", "innovation", "gate", "hdop"),
        panels=examples.navigator_panels,
    )

    state_sigma = sigmas(STATES, "position north and east (m), wind north and east (m/s)")
    upper = covariance(STATES)
    errors = State(STATES - 2, "m/s", description="what is to be added to the forecast of the wind: north, east")
    modelled = State(STATES - 2, "m/s", description="standard deviations of this that nothing has measured")

    def over_ground(self, errors):
        """Velocity, m/s."""
        return reduced_order.velocity(errors, self.airspeed, self.nose, self.wind_mean)

    def velocity_rows(self, errors):
        """Its derivatives by the wind."""
        return reduced_order.velocity_rows()

    def fix_rows(self, rows):
        """What a fix tells of the states; its altitude tells nothing."""
        return reduced_order.fix_rows()

    def height(self):
        """Altitude, m."""
        return self.altitude

    def wind_error(self):
        """What is to be added to the forecast of the wind, m/s."""
        return self.errors

    def error_model(self, speed, seen):
        """Sigma and correlation time of the wind, and without heading or airspeed of air velocity with it."""
        sigma = np.where(seen, self.wind_sigma, np.hypot(self.wind_sigma, self.top_speed()))
        time = np.where(seen, np.where(self.had_seen, self.wind_time, AT_ONCE), self.blind_time)
        return sigma * np.ones(2), time * np.ones(2)

    def range_rows(self, north, east, up):
        """H."""
        return reduced_order.range_rows(north, east)

    def range_biases(self):
        """None are estimated."""
        return 0.0

    def range_variance(self, since):
        """R."""
        return self.noise_sigma**2 + gauss_markov.white_equivalent(self.bias_sigma**2, since, self.bias_time())
