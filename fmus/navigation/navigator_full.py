"""The FMU ``navigator_full``: DME-aided dead reckoning of full order."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.navigation.interface import PLACES
from fmus.navigation.ranges import Ranges
from fmus.navigation.seven_states import MEANING, SevenStates
from fmus.navigation.thesis import PRINTED, covariance, sigmas
from models.navigation import full_order, reckoning
from models.processes import gauss_markov
from navfmu.export import Component, Example, Parameter, ParameterSet, State

STATES = reckoning.STATES + PLACES
SETS = {
    "table_7_1": ParameterSet(
        "The errors of thesis Table 7.1 at every fix, no gusts, no gate: the analysis of section 7.2.",
        {**PRINTED, "calibration": False},
    ),
    "as_printed": ParameterSet(
        "H (6.35) and R (6.40) as they are printed: the biases of ranges are neither states nor noise.",
        {**PRINTED, "bias_states": False, "bias_sigma": 0.0},
    ),
}


class NavigatorFull(SevenStates, Ranges, Component):
    """DME-aided dead reckoning with the filter of full order, thesis section 6.4.

    The states are (6.24): north, east, altitude, wind, heading, airspeed and the bias of each station's ranges (nine
    with two stations). Time update by F (6.26), measurement update by (6.34)-(6.42) one range after the other,
    corrections by (6.43)-(6.51), all as `navigator_reckoning` has them; ranges are slant ranges at their time of
    validity. It stands in the place of `navigator`, which has the mean of the wind as a state and doubts what it is
    told, too.

    *Biases.* With `bias_states` true H has a one for the bias of its station. H12 of (6.35) has zeros: no range then
    tells of a bias, and seven states are left. `bias_states` false flies that, with the bias as independent noise that
    carries as much information, R = noise^2 + sigma^2 (1 + rho) / (1 - rho), rho = exp(-dt / tau); with `bias_sigma` 0
    also R (6.40) is the one that is printed.

    *Gate.* (`innovation_gate`; the thesis has none.) A range that is refused twice in a row widens position by what its
    variance lacks, as far as it is news, unless more stations, whose lines cross well, agree with position.
    """

    parameter_sets = SETS
    example = Example(
        text="Level flight to the west at 90 kn in a wind of 15 kn, with heading wrong by 1 degree and airspeed by "
        "2 m/s. GPS is lost at 300 s (dotted). Then one DME range every 15 s, each wrong by some 315 m, keeps the "
        "error inside three sigma (dashed).",
        duration=1200.0,
        step=0.1,
        mark=examples.GPS_LOST,
        inputs=examples.navigator_inputs,
        periods={"fix": 1.0, "ranging": 15.0},
        shows=("solution.wind_n", "innovation", "gate", "hdop"),
        panels=examples.navigator_panels,
    )

    bias_states = Parameter(
        kind="boolean",
        start=True,
        description="whether ranges tell of the biases of their stations; false: H (6.35) as it is printed",
    )
    state_sigma = sigmas(STATES, f"{MEANING}, bias of each station's ranges (m)")
    upper = covariance(STATES)
    errors = State(STATES - 2, "1", description="estimates of altitude, wind, heading, airspeed error, and biases")
    modelled = State(STATES - 2, "1", description="standard deviations of these that nothing has measured")

    def error_model(self, speed, seen):
        """With those of the biases, (3.38)."""
        sigmas, times = super().error_model(speed, seen)
        biases = np.ones(PLACES)
        bias_time = self.correlation_distance / np.maximum(speed, 1.0)
        return np.concatenate([sigmas, self.bias_sigma * biases]), np.concatenate([times, bias_time * biases])

    def range_rows(self, north, east, up):
        """H."""
        return full_order.range_rows(north, east, up, self.bias_states)

    def range_biases(self):
        """Estimated biases, m."""
        return np.where(self.bias_states, self.errors[reckoning.STATES - 2 :], 0.0)

    def range_variance(self, since):
        """R."""
        white = gauss_markov.white_equivalent(self.bias_sigma**2, since, self.bias_time())
        return self.noise_sigma**2 + np.where(self.bias_states, 0.0, white)
