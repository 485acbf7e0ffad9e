"""Statistics of a backup navigator over many flights: the numbers beside the verdicts.

They need the outputs of ``evaluation`` and ``navigator`` and a requirement ``at_most`` on the horizontal error;
campaigns of other systems do without.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from navfmu.campaign.outcome import Judged, Outcome
    from navfmu.campaign.requirement import Requirement

ERROR = "evaluation.horizontal_error"
SIGNALS = (ERROR, "evaluation.north_error", "evaluation.east_error", "navigator.north_sigma", "navigator.east_sigma")


@dataclass(frozen=True)
class Statistics:
    """Of one variant in one case, while the requirement is asked."""

    variant: str
    case: str
    runs: int
    limit: float  # m
    median: float  # m, at the worst time
    median_time: float  # s
    high: float  # m, 95th percentile at the worst time
    high_time: float  # s
    above: float  # percent of the time of all runs beyond the limit
    predicted: float  # percent that the filter's covariance predicts
    ever: int  # runs that exceed the limit at least once
    inside: float  # percent of north and east errors within three sigma


def statistics(outcome: Outcome) -> list[Statistics]:
    """For every variant and case that a requirement on the horizontal error is asked of."""
    found = []
    for variant in outcome.campaign.systems:
        for case in outcome.campaign.cases:
            asked = (r for r in outcome.campaign.requirements if r.signal == ERROR and r.most is not None)
            requirement = max((r for r in asked if r.applies(variant, case.name)), key=_span, default=None)
            runs = [judged for judged in outcome.of(variant, case.name) if judged.error is None]
            if requirement is not None and runs:
                one = _of(outcome, requirement, variant, case.name, runs)
                found += [one] if one is not None else []
    return found


def _span(requirement: Requirement) -> tuple[float, float]:
    return requirement.end - requirement.start, requirement.most or 0.0


def _of(outcome: Outcome, requirement: Requirement, variant: str, case: str, runs: list[Judged]) -> Statistics | None:
    rows = [outcome.series(judged, SIGNALS) for judged in runs]
    if not all(name in row for row in rows for name in SIGNALS):
        return None
    time = rows[0]["time"]
    window = requirement.window(time)
    time = time[window]
    error, north, east, north_sigma, east_sigma = (np.stack([row[name][window] for row in rows]) for name in SIGNALS)
    median, high = np.quantile(error, (0.5, 0.95), axis=0, method="higher")  # runs that were flown, none in between
    both = (np.abs(north) <= 3 * north_sigma) & (np.abs(east) <= 3 * east_sigma)
    limit = requirement.most
    return Statistics(
        variant=variant,
        case=case,
        runs=len(runs),
        limit=limit,
        median=float(median.max()),
        median_time=float(time[median.argmax()]),
        high=float(high.max()),
        high_time=float(time[high.argmax()]),
        above=100 * float(np.mean(error > limit)),
        predicted=100 * float(np.mean(beyond(limit, north_sigma, east_sigma))),
        ever=int(np.count_nonzero((error > limit).any(axis=1))),
        inside=100 * float(np.mean(both)),
    )


def beyond(limit: float, north_sigma: np.ndarray, east_sigma: np.ndarray) -> np.ndarray:
    """Probability that a horizontal error exceeds ``limit`` when north and east are independent normal errors.

    With north = sn r cos(a), east = se r sin(a), the angle a is uniform and r^2/2 exponential, so that the probability
    is the mean over a of exp(-limit^2 / (2 (sn^2 cos^2 a + se^2 sin^2 a))), periodic and smooth in a: equal steps do.
    """
    total = np.zeros(np.shape(north_sigma))
    angles = (np.arange(64) + 0.5) * (np.pi / 2 / 64)
    for angle in angles:
        variance = (north_sigma * np.cos(angle)) ** 2 + (east_sigma * np.sin(angle)) ** 2
        total += np.exp(-0.5 * limit**2 / np.maximum(variance, 1e-12))
    return total / len(angles)
