"""Errors and claimed covariance of one navigator in many runs, at the same points in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.report.scene import words
from navfmu.system import analysed
from navfmu.system.analysed import Analysis
from navfmu.system.experiment import Experiment

if TYPE_CHECKING:
    import pandas

    from navfmu.system.assembly import Assembly

LEAST = 10  # points in time without which nothing is said about a trajectory


@dataclass(frozen=True)
class Window:
    """From when to when points count, s."""

    start: float = 0.0
    end: float = np.inf


@dataclass(frozen=True)
class Ensemble:
    """Runs with one covariance each: ``time`` (points), ``error`` (runs, points, 2), ``covariance`` (runs, points, 3).

    Errors and their covariance (first, both, second) are in ``unit`` and its square; all is finite.
    """

    axes: tuple[str, str]  # what the errors are called
    unit: str
    time: np.ndarray
    error: np.ndarray
    covariance: np.ndarray

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.error)

    @property
    def claimed(self) -> np.ndarray:
        """Mean of the claimed covariances, (points, 3)."""
        return self.covariance.mean(axis=0)

    @property
    def squares(self) -> np.ndarray:
        """Mean squares of both errors and of their product, as a covariance about 0, (points, 3)."""
        first, second = self.error[..., 0], self.error[..., 1]
        return np.stack([first * first, first * second, second * second], -1).mean(axis=0)


def table_of(system: Assembly) -> Analysis:
    """The system's table ``[analysis]``, whose signals the variant must have."""
    report = system.report
    if report is None or report.analysis is None:
        raise NavfmuError(
            f"{system.place}: says nothing about analyses; its report.toml needs a table [analysis] with the signals "
            "'errors' and the array 'covariance' that is claimed for them"
        )
    analysis = report.analysis
    wanted = [*analysis.errors, analysis.covariance, *([analysis.valid] if analysis.valid else [])]
    for name in wanted:
        if not analysed.signals(name, system.fmus):
            raise NavfmuError(f"{system.place}: this variant has no '{name}', which its table [analysis] names")
    return analysis


def recorded(experiment: Experiment) -> Experiment:
    """The experiment with what an analysis records."""
    analysis = table_of(experiment.system)
    names = [*analysis.errors, *analysed.signals(analysis.covariance, experiment.system.fmus)]
    names += [analysis.valid] if analysis.valid else []
    period = {} if analysis.period is None else {"record_period": float(analysis.period)}
    return replace(experiment, record=names, **period)


def with_seeds(experiment: Experiment, seeds: Sequence[int]) -> dict[int, Experiment]:
    """The experiment with each seed."""
    return {seed: replace(experiment, seed=seed) for seed in seeds}


Rows = tuple[np.ndarray, np.ndarray]  # times, values by signal


def rows_of(frame: pandas.DataFrame) -> Rows:
    """What an analysis keeps of a run."""
    return frame.index.to_numpy(), frame.to_numpy(float)


def together(experiment: Experiment, runs: Mapping[int, Rows], window: Window, definite: bool = True) -> Ensemble:
    """The points that all runs have, of runs of such an experiment by seed.

    With ``definite`` a covariance counts only where it is positive: where something is compared with it.
    """
    analysis = table_of(experiment.system)
    count = min(len(time) for time, _ in runs.values())
    time = next(iter(runs.values()))[0][:count]
    values = np.stack([values[:count] for _, values in runs.values()])
    error, covariance = values[..., :2], values[..., 2:5]
    inside = (time >= window.start - 1e-9) & (time <= window.end + 1e-9)
    valid = values[..., 5] != 0.0 if analysis.valid else np.ones(values.shape[:2], bool)
    _refuse_broken(analysis, list(runs), time, values, valid & inside)
    first, both, second = np.moveaxis(covariance, -1, 0)
    positive = (first > 0.0) & (first * second - both * both > 0.0)
    points = inside & (valid & (positive | (not definite))).all(axis=0)
    if np.count_nonzero(points) < LEAST:
        why = f" at which '{analysis.valid}' is not 0 in all runs" if analysis.valid else ""
        why += f" and '{analysis.covariance}' is positive" if definite else ""
        raise NavfmuError(
            f"the trajectory is too short: from {max(window.start, 0.0):g} s to {min(window.end, time[-1]):g} s there "
            f"are {np.count_nonzero(points)} points{why}, expected at least {LEAST}; "
            "a longer --stop gives more"
        )
    unit = experiment.system.variable(analysis.errors[0]).unit or ""
    axes = tuple(words(name).removesuffix(" error") for name in analysis.errors)
    return Ensemble(axes, unit, time[points], error[:, points], covariance[:, points])


def _refuse_broken(
    analysis: Analysis, seeds: Sequence[int], time: np.ndarray, values: np.ndarray, counts: np.ndarray
) -> None:
    """What is no number tells nothing, and is not left out unsaid."""
    broken = counts & ~np.isfinite(values[..., :5]).all(axis=-1)
    if broken.any():
        run, point = np.argwhere(broken)[0]
        raise NavfmuError(
            f"seed {seeds[run]}: '{analysis.covariance}' or an error is not a finite number at {time[point]:g} s"
        )
