"""How well a navigator did on a flight, and whether it knew: errors, normalised squared errors, time lost.

A normalised squared error is that of an honest filter when its mean is the number of its components: 1 for an angle, 2
for a position. Its interval follows from the scatter of the seeds, which are independent; samples of a run are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from evidence.recorded.flight import ANGLES, LOST, NORTH_EAST, Flown

SETTLED = 60.0
"""Time after which the attitude is judged, s."""
GONE = 60.0
"""A navigator is lost when it is outside of its own 3 sigma for longer than this at a stretch, s."""
LIMIT = 926.0
"""Half a nautical mile, m."""


@dataclass(frozen=True)
class Mean:
    """A mean over seeds, half the width of its 95 % interval, and its extremes."""

    value: float
    half: float
    least: float
    most: float

    @classmethod
    def of(cls, values: np.ndarray) -> Mean:
        """From one value for each seed."""
        count = len(values)
        spread = np.std(values, ddof=1) / np.sqrt(count) if count > 1 else np.nan
        half = float(stats.t.ppf(0.975, count - 1) * spread) if count > 1 else np.nan
        return cls(float(np.mean(values)), half, float(np.min(values)), float(np.max(values)))

    def __str__(self) -> str:
        return f"{self.value:.2f} ± {self.half:.2f}"


@dataclass(frozen=True)
class Angle:
    """The error of an angle: rms in deg, normalised squared error (1), and share inside 3 sigma in %, by seeds."""

    rms: float
    nees: Mean
    inside: Mean


@dataclass(frozen=True)
class Position:
    """The error of position while GPS is lost, m; shares in %; ranges; stretches outside of 3 sigma, min."""

    median: float
    percentile: float
    largest: float
    above: float
    nees: Mean
    inside: Mean
    used: float
    rejected: float
    lost: float
    longest: float


def angle(runs: list[pd.DataFrame], name: str) -> Angle:
    """Of one of ANGLES, over all seconds after the filter has settled."""
    squares, normalised, inside = [], [], []
    for run in runs:
        run = run[run.index > SETTLED]
        error = run[f"ahrs.attitude.{name}"] - run[f"aircraft.{name}"]
        error = (error + np.pi) % (2.0 * np.pi) - np.pi
        ratio = error / run[f"ahrs.attitude.{name}_sigma"]
        squares.append(np.mean(error**2))
        normalised.append(np.mean(ratio**2))
        inside.append(100.0 * np.mean(np.abs(ratio) <= 3.0))
    return Angle(float(np.degrees(np.sqrt(np.mean(squares)))), Mean.of(np.array(normalised)), Mean.of(np.array(inside)))


def angles(flown: Flown) -> dict[str, Angle]:
    """Of all three; the attitude is the same in every variant, so that of the first is taken."""
    runs = next(iter(flown.runs.values()))
    return {name: angle(runs, name) for name in ANGLES}


def position(runs: list[pd.DataFrame]) -> Position:
    """Over all seconds without GPS; what is not finite is above every limit."""
    runs = [run[run.index > LOST] for run in runs]
    error = np.array([run["evaluation.horizontal_error"].to_numpy() for run in runs])
    inside = np.array([run["evaluation.consistent"].to_numpy(bool) for run in runs])
    normalised = [np.mean(normalised_squares(run)) for run in runs]
    gone = [stretch for each in inside for stretch in stretches(~each) if stretch > GONE]
    return Position(
        median=float(np.median(error)),
        percentile=float(np.percentile(error, 95, method="higher")),
        largest=float(np.max(error)),
        above=float(100.0 * np.mean(~(error <= LIMIT))),
        nees=Mean.of(np.array(normalised)),
        inside=Mean.of(100.0 * np.mean(inside, axis=1)),
        used=float(np.mean([run["navigator.used"].iloc[-1] for run in runs])),
        rejected=float(np.mean([run["navigator.rejected"].iloc[-1] for run in runs])),
        lost=sum(gone) / 60.0 / len(runs),
        longest=max(gone, default=0.0) / 60.0,
    )


def normalised_squares(run: pd.DataFrame) -> np.ndarray:
    """e' P^-1 e of the position with the whole covariance: where one station leaves a long and narrow uncertainty, the
    error along its line of sight counts for what it is."""
    north, east = (run[f"evaluation.{axis}_error"] for axis in ("north", "east"))
    nn, ee = (run[f"navigator.{axis}_sigma"] ** 2 for axis in ("north", "east"))
    ne = run[NORTH_EAST]
    return ((north**2 * ee - 2.0 * north * east * ne + east**2 * nn) / (nn * ee - ne**2)).to_numpy()


def stretches(flags: np.ndarray) -> list[int]:
    """How long each run of true samples is."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return (edges[1::2] - edges[::2]).tolist()
