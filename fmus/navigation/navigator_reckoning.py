"""The FMU ``navigator_reckoning``: dead reckoning alone, and what its errors grow to."""

from __future__ import annotations

from fmus import examples
from fmus.navigation.seven_states import MEANING, SevenStates
from fmus.navigation.thesis import PRINTED, covariance, sigmas
from models.navigation import reckoning
from navfmu.export import Component, Example, ParameterSet, State

SETS = {
    "table_7_1": ParameterSet(
        "The errors of thesis Table 7.1 at every fix: position is known, wind, heading and airspeed are not.",
        {**PRINTED, "calibration": False},
    )
}


class NavigatorReckoning(SevenStates, Component):
    """Dead reckoning with airspeed, heading and wind, open loop, and the covariance of its errors.

    Thesis section 5.3: position is propagated by (5.5)-(5.10) with wind, (6.22), (6.23), the covariance of the states
    (5.11), north, east, altitude, wind, heading and airspeed, by F_DR (5.13) and the noise (5.28)-(5.31) with discrete
    steps that are exact for each error. It stands in the place of `navigator`, and leaves ranges alone: `gate` says so.

    *While there is GPS* (`mode` 1) fixes correct position, altitude and, by their velocity, wind, heading and
    airspeed, in a Kalman filter; with `calibration` false each fix begins anew, with the errors of Table 7.1: 2 m, and
    nothing is known of the wind beyond its forecast. *Afterwards* (`mode` 2) the estimates decay as their models say,
    the wind to `wind_mean`, which the filter takes for right. (The thesis keeps the estimates and lets their errors
    decay.)

    Heading and airspeed have the sigmas that their instruments say of themselves. *Without them* the last air velocity
    is held, as in `navigator`; what had been learned of their errors is forgotten when they are back. A fix beyond the
    gate begins position anew.
    """

    parameter_sets = SETS
    example = Example(
        text="Level flight to the west at 90 kn in a wind of 15 kn, with heading wrong by 1 degree and airspeed by "
        "2 m/s. GPS is lost at 300 s (dotted). What GPS has taught of the wind is worth less and less: three sigma "
        "(dashed) are a mile after five minutes.",
        duration=1200.0,
        step=0.1,
        mark=examples.GPS_LOST,
        inputs=examples.navigator_inputs,
        periods={"fix": 1.0, "ranging": 15.0},
        shows=("solution.wind_n", "mode", "north_sigma"),
        panels=examples.navigator_panels,
    )

    state_sigma = sigmas(reckoning.STATES, MEANING)
    upper = covariance(reckoning.STATES)
    errors = State(reckoning.STATES - 2, "1", description="estimates of altitude, wind, heading and airspeed error")
    modelled = State(reckoning.STATES - 2, "1", description="standard deviations of these that nothing has measured")
