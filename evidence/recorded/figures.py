"""How well a navigator did on a flight, and whether it knew: errors, normalised squared errors, time lost.

A normalised squared error is that of an honest filter when its mean is the number of its components: 1 for an angle, 2
for a position. Its interval follows from the scatter of the seeds, which are independent; samples of a run are not: its
mean over a run scatters as chi-square over as many degrees of freedom as their correlation leaves (:func:`freedom`).
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
    freedom: float
    runs: int

    def worst(self, chance: float) -> float:
        """Normalised squared error that the worst of the runs of an honest filter exceeds with this probability."""
        return worst(1.0, self.freedom, self.runs, chance)


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
    freedom: float
    runs: int

    def worst(self, chance: float) -> float:
        """As that of an angle."""
        return worst(2.0, self.freedom, self.runs, chance)


def worst(honest: float, freedom: float, runs: int, chance: float) -> float:
    """What the largest of so many independent means exceeds with the probability ``chance``: each is ``honest`` times
    chi-square over its degrees of freedom."""
    return float(honest * stats.chi2.isf(1.0 - (1.0 - chance) ** (1.0 / runs), freedom) / freedom)


def freedom(errors: np.ndarray) -> float:
    """Degrees of freedom of the mean of the squares of one run.

    The mean of x^2 over N samples of a normal process of mean zero with the autocorrelation rho has a variance of
    2 / nu of its own square, 1 / nu = sum over all lags k of (1 - |k| / N) rho(k)^2 / N (Isserlis; Bartlett). rho is
    that of all runs together, so that a part which stays for a run, and differs from run to run, counts as such.

    Parameters
    ----------
    errors
        Over their sigma, shape (run, sample).
    """
    count = errors.shape[1]
    spectrum = np.abs(np.fft.rfft(errors, 2 * count, axis=1)) ** 2
    sums = np.fft.irfft(np.mean(spectrum, axis=0), 2 * count)[:count]
    weights = 1.0 - np.arange(count) / count
    rho = np.clip(sums / weights / max(sums[0], 1.0e-300), -1.0, 1.0)
    return float(count / (2.0 * np.sum(weights * rho**2) - 1.0))


def angle(runs: list[pd.DataFrame], name: str) -> Angle:
    """Of one of ANGLES, over all seconds after the filter has settled."""
    squares, ratios = [], []
    for run in runs:
        run = run[run.index > SETTLED]
        error = run[f"ahrs.attitude.{name}"] - run[f"aircraft.{name}"]
        error = (error + np.pi) % (2.0 * np.pi) - np.pi
        ratio = error / run[f"ahrs.attitude.{name}_sigma"]
        squares.append(np.mean(error**2))
        ratios.append(ratio.to_numpy())
    every = np.array(ratios)
    return Angle(
        rms=float(np.degrees(np.sqrt(np.mean(squares)))),
        nees=Mean.of(np.mean(every**2, axis=1)),
        inside=Mean.of(100.0 * np.mean(np.abs(every) <= 3.0, axis=1)),
        freedom=freedom(every),
        runs=len(runs),
    )


def angles(flown: Flown) -> dict[str, Angle]:
    """Of all three; the attitude is the same in every variant, so that of the first is taken."""
    runs = next(iter(flown.runs.values()))
    return {name: angle(runs, name) for name in ANGLES}


def position(runs: list[pd.DataFrame]) -> Position:
    """Over all seconds without GPS; what is not finite is above every limit."""
    runs = [run[run.index > LOST] for run in runs]
    error = np.array([run["evaluation.horizontal_error"].to_numpy() for run in runs])
    inside = np.array([run["evaluation.consistent"].to_numpy(bool) for run in runs])
    whitened = np.array([white(run) for run in runs])
    normalised = np.mean(np.sum(whitened**2, axis=1), axis=1)
    gone = [stretch for each in inside for stretch in stretches(~each) if stretch > GONE]
    return Position(
        median=float(np.median(error)),
        percentile=float(np.percentile(error, 95, method="higher")),
        largest=float(np.max(error)),
        above=float(100.0 * np.mean(~(error <= LIMIT))),
        nees=Mean.of(normalised),
        inside=Mean.of(100.0 * np.mean(inside, axis=1)),
        used=float(np.mean([run["navigator.used"].iloc[-1] for run in runs])),
        rejected=float(np.mean([run["navigator.rejected"].iloc[-1] for run in runs])),
        lost=sum(gone) / 60.0 / len(runs),
        longest=max(gone, default=0.0) / 60.0,
        freedom=2.0 * freedom(np.nan_to_num(whitened.reshape(-1, whitened.shape[-1]))),
        runs=len(runs),
    )


def white(run: pd.DataFrame) -> np.ndarray:
    """L^-1 e of the position, P = L L', shape (2, sample).

    Its square is e' P^-1 e with the whole covariance: where one station leaves a long and narrow uncertainty, the error
    along its line of sight counts for what it is.
    """
    north, east = (run[f"evaluation.{axis}_error"] for axis in ("north", "east"))
    nn, ee = (run[f"navigator.{axis}_sigma"] ** 2 for axis in ("north", "east"))
    ne = run[NORTH_EAST]
    return np.array([north / np.sqrt(nn), (east - ne / nn * north) / np.sqrt(ee - ne**2 / nn)])


def stretches(flags: np.ndarray) -> list[int]:
    """How long each run of true samples is."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return (edges[1::2] - edges[::2]).tolist()
