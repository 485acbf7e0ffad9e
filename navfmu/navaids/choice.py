"""The stations that serve points best, for a receiver that holds a few."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from navfmu.navaids.coverage import Points
from navfmu.navaids.sight import Sight, dilution, sight
from navfmu.navaids.station import Station

POOR = 10.0
"""A dilution that counts as none."""
NO_BETTER = 1e-3


def choose(stations: Sequence[Station], points: Points, most: int) -> list[Station]:
    """Up to ``most`` stations, the best pair first, then in turn the one that helps most.

    What is made least is the mean over the points of the dilution, at most ``POOR``. A station that is heard nowhere,
    or with which nothing becomes better, is not taken.
    """
    seen = sight(stations, points.latitude, points.longitude, points.altitude, points.ground)
    left = [i for i in range(len(stations)) if seen.heard[i].any()]
    pairs = [(_cost(seen, [i, j]), i, j) for k, i in enumerate(left) for j in left[k + 1 :]]
    chosen = list(min(pairs)[1:]) if pairs and most > 1 else left[: min(most, 1)]
    while len(chosen) < most and len(chosen) < len(left):
        cost, best = min((_cost(seen, [*chosen, i]), i) for i in left if i not in chosen)
        if cost >= _cost(seen, chosen) - NO_BETTER:
            break
        chosen.append(best)
    return [stations[i] for i in chosen]


def _cost(seen: Sight, chosen: list[int]) -> float:
    some = Sight(*(of[chosen] for of in (seen.distance, seen.north, seen.east, seen.heard)))
    return float(np.mean(np.minimum(dilution(some, some.heard), POOR)))
