"""What a sweep found: a row for each run and signal, the samples that were lost, and the step that may be taken."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from navfmu.sweep.order import Order, fit

ALGORITHMS = ("gauss_seidel", "jacobi")
ROUNDING = 1e-12  # errors below this share of a signal's range are none


@dataclass(frozen=True)
class Row:
    """One signal in one run, against the same algorithm at the smallest step.

    Where the two cannot be compared ``problem`` says why, and ``rms`` and ``largest`` are NaN.
    """

    algorithm: str
    step: float  # s
    signal: str
    unit: str
    rms: float  # of the error, in unit
    largest: float
    span: float  # of Gauss-Seidel at the smallest step: greatest minus least value
    problem: str = ""

    @property
    def relative(self) -> float:
        """The rms error as a share of the reference's range; 0 for no error, infinite with a problem."""
        if self.problem:
            return math.inf
        return 0.0 if self.rms == 0.0 else self.rms / self.span if self.span > 0.0 else math.inf

    @property
    def counts(self) -> bool:
        """Whether the error is more than rounding."""
        return not self.problem and self.rms > ROUNDING * self.span


@dataclass(frozen=True)
class Sweep:
    """All runs of a sweep, compared."""

    system: str
    steps: tuple[float, ...]  # s, the smallest first
    stop: float
    period: float  # s between the compared points
    rows: tuple[Row, ...]
    apart: dict[str, float]  # signal -> rms difference of the algorithms at the smallest step; NaN with a problem
    lost: dict[str, dict[tuple[str, float], int]]  # counter -> (algorithm, step) -> samples lost
    tolerance: float
    provenance: dict[str, Any] = field(repr=False)
    notes: tuple[str, ...] = ()  # of the runs, for the user
    idle: tuple[str, ...] = ()  # signals that are not compared because they are valid in no run
    not_real: tuple[str, ...] = ()  # signals that have no error: modes, flags
    seed: int = 1  # of every run
    seed_given: bool = True  # else it is the one that sweeps take

    @property
    def seeded(self) -> str:
        """The seed, in words."""
        return f"seed: {self.seed}{'' if self.seed_given else ', as none is given'}"

    @property
    def signals(self) -> list[str]:
        """Compared signals."""
        return list(dict.fromkeys(row.signal for row in self.rows))

    def of(self, algorithm: str, signal: str) -> list[Row]:
        """The rows of one signal and algorithm, by step."""
        return [row for row in self.rows if row.algorithm == algorithm and row.signal == signal]

    def at(self, algorithm: str, step: float) -> list[Row]:
        """The rows of one run."""
        return [row for row in self.rows if row.algorithm == algorithm and row.step == step]

    def order(self, algorithm: str, signal: str) -> Order | None:
        """Order of a signal's error; None without two errors that are more than rounding, or with a problem."""
        rows = self.of(algorithm, signal)
        if any(row.problem for row in rows):
            return None
        points = [(row.step, row.rms) for row in rows if row.counts and row.step > self.steps[0]]
        return fit([step for step, _ in points], [error for _, error in points], self.steps[0])

    def worst(self, algorithm: str, step: float) -> Row:
        """The signal with the greatest relative error of a run; a problem is the worst of all."""
        return max(self.at(algorithm, step), key=lambda row: (row.relative, math.inf if row.problem else row.rms))

    def lost_at(self, algorithm: str, step: float) -> int:
        """Samples that get lost in a run."""
        return sum(counts[algorithm, step] for counts in self.lost.values())

    def loses(self, algorithm: str, step: float) -> int:
        """Samples that get lost in a run beyond those that are lost at the smallest step already."""
        return sum(max(0, c[algorithm, step] - c[algorithm, self.steps[0]]) for c in self.lost.values())

    @property
    def problems(self) -> list[Row]:
        """Rows that cannot be compared."""
        return [row for row in self.rows if row.problem]

    def acceptable(self, algorithm: str, step: float) -> bool:
        """Whether a run keeps the tolerance in every signal and loses no more samples than at the smallest step."""
        return self.worst(algorithm, step).relative <= self.tolerance and not self.loses(algorithm, step)

    def recommended(self, algorithm: str) -> float | None:
        """The greatest step up to which every one is acceptable; None when the smallest is not."""
        best = None
        for step in self.steps:
            if not self.acceptable(algorithm, step):
                break
            best = step
        return best

    def share_apart(self, signal: str) -> float:
        """Difference of the algorithms at the smallest step as a share of the signal's range."""
        span, apart = self.of(ALGORITHMS[0], signal)[0].span, self.apart[signal]
        if not math.isfinite(apart):
            return math.inf
        return 0.0 if apart == 0.0 else apart / span if span > 0.0 else math.inf
