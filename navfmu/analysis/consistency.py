"""Whether errors are what their covariance claims: normalised squares over many runs, and what chance allows.

e' P^-1 e of a normal error e with the covariance P is chi-square with 2 degrees of freedom, and the sum over N
independent runs with 2 N (Bar-Shalom, Estimation with Applications, section 5.4). The runs differ in their seed and
are independent, the points of one are not. So what is said of a point is bounded by chi-square; what is said of the
whole is said of the means of the runs, N independent numbers, with Student's distribution. They are skewed where all
points of a run are alike: its 95 % are then 90 % with 10 runs, 92 with 20, 93 with 40 (100 000 draws).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from navfmu.analysis.ensemble import Ensemble

AXES = 2
CONFIDENCE = 0.95
LEAST = 10  # runs without which the whole is not judged


def normalised_squares(ensemble: Ensemble) -> np.ndarray:
    """e' P^-1 e of each run and point, (runs, points)."""
    first, both, second = np.moveaxis(ensemble.covariance, -1, 0)
    x, y = np.moveaxis(ensemble.error, -1, 0)
    return (second * x * x - 2.0 * both * x * y + first * y * y) / (first * second - both * both)


def bounds(runs: int, degrees: int = AXES) -> tuple[float, float]:
    """Between what the mean over ``runs`` of a square with these degrees of freedom is, with ``CONFIDENCE``."""
    tails = (0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE))
    low, high = stats.chi2.ppf(tails, degrees * runs) / runs
    return float(low), float(high)


@dataclass(frozen=True)
class Verdict:
    """The mean of all normalised squares, between what it is with ``CONFIDENCE``, and what that means."""

    runs: int
    mean: float
    low: float
    high: float
    inside: float  # share of points at which the mean over the runs lies within its chi-square bounds
    points: int
    greatest: float  # of the means over the runs
    time: float  # of that, s

    @property
    def word(self) -> str:
        """One word: consistent, overconfident, cautious, or undecided with too few runs."""
        if self.runs < LEAST:
            return "undecided"
        return "overconfident" if self.low > AXES else "cautious" if self.high < AXES else "consistent"

    @property
    def sentence(self) -> str:
        """What was found, with its sample size."""
        if self.runs < LEAST:
            return (
                f"normalised square {self.mean:.2f} in the mean of {self.runs} {'runs' if self.runs > 1 else 'run'} "
                f"(an honest claim: {AXES}); at least {LEAST} seeds are needed to judge it"
            )
        told = {
            "overconfident": "errors are greater than claimed",
            "cautious": "errors are smaller than claimed",
            "consistent": "errors are as claimed",
        }[self.word]
        return (
            f"{self.word}: {told}; normalised square {self.mean:.2f} in the mean of {self.runs} runs, {self.low:.2f} "
            f"to {self.high:.2f} with {100 * CONFIDENCE:g} % (an honest claim: {AXES}); the mean over the runs is "
            f"within its chi-square bounds at {100 * self.inside:.0f} % of the points (honest: {100 * CONFIDENCE:g} %)"
        )

    @property
    def chance(self) -> float:
        """The most that the probability of such a greatest mean can be, however the points depend on each other."""
        one = float(stats.chi2.sf(self.greatest * self.runs, AXES * self.runs))
        return min(1.0, max(one, 1e-99) * self.points)

    @property
    def peak(self) -> str:
        """Where the claim is worst, and whether chance could do it."""
        rare = self.chance < 1.0 - CONFIDENCE
        told = "more than chance: errors are greater than claimed there" if rare else "which chance may do"
        return (
            f"greatest mean of the runs: {self.greatest:.2f} at {self.time:g} s, {told} (probability at most "
            f"{self.chance:.2g} that one of {self.points} points of an honest claim has it)"
        )


def judge(ensemble: Ensemble) -> Verdict:
    """The verdict on the whole."""
    squares = normalised_squares(ensemble)
    means = squares.mean(axis=1)
    mean, reach = float(means.mean()), math.inf
    if ensemble.runs > 1:
        quantile = stats.t.ppf(0.5 * (1.0 + CONFIDENCE), ensemble.runs - 1)
        reach = float(quantile * means.std(ddof=1) / math.sqrt(ensemble.runs))
    low, high = bounds(ensemble.runs)
    over_runs = squares.mean(axis=0)
    inside = float(np.mean((over_runs >= low) & (over_runs <= high)))
    worst = int(over_runs.argmax())
    found = len(over_runs), float(over_runs[worst]), float(ensemble.time[worst])
    return Verdict(ensemble.runs, mean, mean - reach, mean + reach, inside, *found)
