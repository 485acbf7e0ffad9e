"""Differential corrections: what a receiver at a known place finds wrong with each pseudorange."""

from __future__ import annotations

import numpy as np

from models.satellite import sight


def corrections(station_e, satellite_e, pseudorange, used):
    """What another receiver near the station adds to its pseudoranges, m, shape (satellites,).

    ``pseudorange`` is free of the satellites' clocks. Delays of the atmosphere are in it, so who takes it applies no
    model of them. The clock of the station goes with the mean of the satellites that it uses, and what is left of it
    is in the clock of the other receiver.
    """
    distance, _ = sight.ranges(station_e, satellite_e)
    wrong = distance - pseudorange
    count = np.maximum(np.sum(np.where(used, 1.0, 0.0)), 1.0)
    return np.where(used, wrong - np.sum(np.where(used, wrong, 0.0)) / count, 0.0)
