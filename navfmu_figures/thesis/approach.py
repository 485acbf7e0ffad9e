"""The approach of section 7.2 by the filter of full order: 50 nmi to the north, stations abeam of the airport."""

from __future__ import annotations

from collections.abc import Iterable

import pandas as pd

from navfmu.figures import Task
from navfmu_figures.thesis.claims import FMUS, Flight
from navfmu_figures.thesis.error_models import ABEAM, DURATION, TABLE_7_1, approach

NEEDED = (*FMUS, "navigator_full")
METHODS = {1: "1 receiver", 2: "2 receivers", 3: "scanning"}
NOTES = (
    "H12 of (6.35) is zero, as printed: no range then tells of the biases, which are states of (6.24). Here it has a "
    "one for the bias of the station. With R (6.40) alone the covariances would be 20 to 50 m at 15 s, and that of two "
    "receivers at 30 s and of one at 15 s would not be alike.",
    "Fig 7.5 gives no distances of the transponders: 20 nmi to the west and the east of the airport, as in Figs 7.1 to "
    "7.3.",
)


def flown(task: Task, cases: Iterable[tuple[int, float]]) -> dict[tuple[int, float], pd.DataFrame]:
    """Claims by mode of the receiver and interval (s) of its ranges."""
    cases = list(cases)
    found = {}
    for mode, interval in cases:
        flight = Flight(task.folder / f"{mode}-{interval:g}", task.fmus, approach(), ABEAM)
        receiver = {"mode": mode, "interval": interval}
        values = {**TABLE_7_1, "update_period": 1.0}
        found[mode, interval] = flight.claims("navigator_full", float(int(DURATION)), values, receiver)
        task.progress(len(found), len(cases))
    return found
