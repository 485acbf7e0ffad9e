"""How big may the communication step be? The same system at several steps, with both algorithms and the same noise.

Components sample at their own periods and draw noise by counting samples, so what differs between the runs is the
coupling and nothing else. Errors are differences from the same algorithm's run at the smallest step, at the points in
time that all runs share. The two algorithms need not agree there: where components are sampled, Jacobi delivers each
measurement one sample late, however small the step is. That difference is reported beside the errors.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navfmu.engine.clock import exact
from navfmu.errors import NavfmuError
from navfmu.system.experiment import Experiment, number
from navfmu.system.pool import Board, in_threads

if TYPE_CHECKING:
    import pandas

    from navfmu.system.assembly import Assembly

ALGORITHMS = ("gauss_seidel", "jacobi")
ROUNDING = 1e-12  # errors below this share of a signal's range are none
POINTS = 10_000  # the shared points are thinned to at most about so many


@dataclass(frozen=True)
class Row:
    """One signal in one run, against the same algorithm at the smallest step."""

    algorithm: str
    step: float  # s
    signal: str
    unit: str
    rms: float  # of the error, in unit
    largest: float
    span: float  # of Gauss-Seidel at the smallest step: greatest minus least value

    @property
    def relative(self) -> float:
        """The rms error as a share of the reference's range; 0 where both are constant and equal."""
        return 0.0 if self.rms == 0.0 else math.inf if self.span == 0.0 else self.rms / self.span

    @property
    def counts(self) -> bool:
        """Whether the error is more than rounding."""
        return ROUNDING * self.span < self.rms < math.inf


@dataclass(frozen=True)
class Sweep:
    """What a sweep found."""

    system: str
    steps: tuple[float, ...]
    stop: float
    period: float  # s between the compared points
    rows: tuple[Row, ...]
    apart: dict[str, float]  # signal -> rms difference of the algorithms at the smallest step
    lost: dict[str, dict[tuple[str, float], int]]  # counter -> (algorithm, step) -> samples lost
    tolerance: float
    provenance: dict[str, Any] = field(repr=False)
    notes: tuple[str, ...] = ()  # of the runs, for the user

    def slope(self, algorithm: str, signal: str) -> float | None:
        """Order p of the error, which at the step h is C (h^p - h_0^p) with the smallest step h_0.

        By least squares of the logarithms; None without two errors that are more than rounding.
        """
        import numpy as np

        points = [(row.step, row.rms) for row in self.of(algorithm, signal) if row.counts]
        if len(points) < 2:
            return None
        h, error = np.array(points).T
        orders = np.linspace(0.05, 6.0, 596)[:, None]
        rest = np.log(error) - np.log(h**orders - self.steps[0] ** orders)
        return float(orders[np.argmin(np.var(rest, axis=1)), 0])

    def of(self, algorithm: str, signal: str) -> list[Row]:
        """The rows of one signal and algorithm, by step."""
        return [row for row in self.rows if row.algorithm == algorithm and row.signal == signal]

    @property
    def signals(self) -> list[str]:
        """Compared signals."""
        return list(dict.fromkeys(row.signal for row in self.rows))

    def worst(self, algorithm: str, step: float) -> Row:
        """The signal with the greatest relative error of a run."""
        chosen = [row for row in self.rows if row.algorithm == algorithm and row.step == step]
        return max(chosen, key=lambda row: (row.relative, row.rms))

    def loses(self, algorithm: str, step: float) -> int:
        """Samples that get lost in a run and not at the smallest step."""
        return sum(max(0, c[algorithm, step] - c[algorithm, self.steps[0]]) for c in self.lost.values())

    def recommended(self, algorithm: str) -> float | None:
        """The greatest step up to which every step keeps the tolerance and loses no samples."""
        best = None
        for step in self.steps:
            if self.worst(algorithm, step).relative > self.tolerance or self.loses(algorithm, step):
                break
            best = step
        return best

    def recommendation(self) -> str:
        """What to take, in a few sentences."""
        found = {algorithm: self.recommended(algorithm) for algorithm in ALGORITHMS}
        limit = f"{100 * self.tolerance:g} % of its range"
        best = next((algorithm for algorithm in ALGORITHMS if found[algorithm] not in (None, self.steps[0])), None)
        if best is None:
            return f"No step above {self.steps[0]:g} s keeps every signal within {limit} without losing samples."
        worst = self.worst(best, found[best])
        text = (
            f"Use {best} with steps up to {found[best]:g} s: every signal stays within {limit} "
            f"(worst: {worst.signal}, rms error {worst.rms:.3g} {worst.unit}) and no sample is lost."
        )
        other = next(algorithm for algorithm in ALGORITHMS if algorithm != best)
        text += f" {other} keeps that up to {found[other]:g} s" if found[other] else f" {other} never keeps that"
        signal = max(self.apart, key=lambda name: self._share_apart(name))
        if self._share_apart(signal) > self.tolerance:
            text += (
                f", but at {self.steps[0]:g} s the two differ by up to {100 * self._share_apart(signal):.2g} % "
                f"({signal}, {self.apart[signal]:.3g} {self.of(best, signal)[0].unit} rms): Jacobi delivers later"
            )
        return text + "."

    def _share_apart(self, signal: str) -> float:
        span = self.of(ALGORITHMS[0], signal)[0].span
        return 0.0 if self.apart[signal] == 0.0 else self.apart[signal] / span if span else math.inf


def sweep(
    experiment: Experiment,
    steps: Sequence[float],
    tolerance: float = 0.01,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Do the experiment at each of the ``steps`` (s) with both algorithms and compare its recorded Real signals.

    The seed is the same for all runs: 1 if the experiment has none. Its own step, algorithm and recording period do
    not matter.
    """
    ordered = _checked_steps(steps)
    if not 0.0 < tolerance < math.inf:
        raise NavfmuError(f"the tolerance is {100 * tolerance:g} %, expected a positive number")
    period = _shared_period(ordered, experiment.stop)
    system = experiment.system
    counters = lost_counters(system)
    wanted = [*experiment.record, *_validities(system, experiment.record), *counters]
    common = {"record": wanted, "record_period": period, "seed": 1 if experiment.seed is None else experiment.seed}
    runs = {
        (algorithm, step): replace(experiment, algorithm=algorithm, step=step, **common)
        for algorithm in ALGORITHMS
        for step in ordered
    }
    frames = _run_all(runs, jobs, progress)
    reference = frames[ALGORITHMS[0], ordered[0]]
    units = reference.attrs["units"]
    compared = [n for n in reference.columns if reference[n].dtype.kind == "f" and not n.endswith(".time_of_validity")]
    if not compared:
        raise NavfmuError("none of the chosen signals is Real: there is nothing to compare")
    spans = {name: _span(reference, name) for name in compared}
    rows = [
        Row(
            algorithm,
            step,
            name,
            units.get(name) or "",
            *_size(frame, frames[algorithm, ordered[0]], name),
            spans[name],
        )
        for (algorithm, step), frame in frames.items()
        for name in compared
    ]
    apart = {name: _size(frames[ALGORITHMS[1], ordered[0]], reference, name)[0] for name in compared}
    lost = {name: {key: int(frame[name].iloc[-1]) for key, frame in frames.items()} for name in counters}
    notes = tuple(dict.fromkeys(note for frame in frames.values() for note in frame.attrs["notes"]))
    about = _provenance(experiment, ordered, period, tolerance, common["seed"])
    return Sweep(
        system.name, tuple(ordered), experiment.stop, period, tuple(rows), apart, lost, tolerance, about, notes
    )


def _provenance(
    experiment: Experiment, steps: Sequence[float], period: float, tolerance: float, seed: int
) -> dict[str, Any]:
    """What is needed to repeat the sweep."""
    about = replace(experiment, seed=seed).provenance()
    for key in ("step", "algorithm", "record_period"):
        about.pop(key)
    words = replace(experiment, seed=seed).words("sweep")
    words += ["--steps", ",".join(map(number, steps)), "--tolerance", f"{100 * tolerance:.12g}"]
    if experiment.record != tuple(experiment.system.signals()):
        words += [word for name in experiment.record for word in ("--signals", name)]
    return about | {"steps": list(steps), "period": period, "tolerance": tolerance, "command": shlex.join(words)}


def lost_counters(system: Assembly) -> list[str]:
    """Outputs that count lost samples: ``component.bundle.lost``."""
    return [
        f"{name}.{variable.name}"
        for name, fmu in system.fmus.items()
        for variable in fmu.description.variables
        if variable.causality == "output" and variable.type == "Integer" and variable.name.endswith(".lost")
    ]


def _run_all(
    runs: dict[tuple[str, float], Experiment], jobs: int | None, progress: Callable[[int, int], None] | None
) -> dict[tuple[str, float], pandas.DataFrame]:
    """All runs in threads, the longest first; the compiled loop leaves the interpreter free."""
    steps = {key: round(run.stop / run.step) for key, run in runs.items()}
    board = Board(sum(steps.values()), None if progress is None else lambda done, all_, _: progress(done, all_))
    order = sorted(runs, key=lambda key: -steps[key])
    frames = dict(in_threads(order, lambda key: runs[key].run(board.of(key, steps[key])), jobs, board))
    return {key: frames[key] for key in runs}


def _checked_steps(steps: Sequence[float]) -> list[float]:
    for step in steps:
        if not (math.isfinite(step) and step > 0):
            raise NavfmuError(f"the step must be a positive number of seconds, not {step!r}")
    ordered = sorted(set(float(step) for step in steps))
    if len(ordered) < 2:
        raise NavfmuError("a sweep needs at least two different steps")
    return ordered


def _shared_period(steps: Sequence[float], stop: float) -> float:
    """The least common multiple of the steps, or a multiple of it if that gives too many points."""
    ratios = [exact(step) for step in steps]
    numerator = math.lcm(*(r.numerator for r in ratios))
    common = Fraction(numerator, math.gcd(*(r.denominator for r in ratios)))
    points = exact(stop) / common
    if points < 2:
        listed = ", ".join(f"{step:g}" for step in steps)
        raise NavfmuError(f"the steps {listed} s share fewer than two points up to the stop time {stop:g} s")
    thin = math.ceil(points / POINTS)
    return float(common * thin)


def _validities(system: Assembly, signals: Sequence[str]) -> list[str]:
    """The ``valid`` of every bundle that a signal belongs to."""
    known = {f"{name}.{variable.name}" for name, fmu in system.fmus.items() for variable in fmu.description.variables}
    return sorted({_validity(signal) for signal in signals} & known)


def _validity(signal: str) -> str:
    return f"{signal.rpartition('.')[0]}.valid"


def _valid(frame: pandas.DataFrame, name: str) -> Any:
    """Which points of a signal mean something: before its first measurement a bundle shows start values."""
    import numpy as np

    validity = _validity(name)
    return frame[validity].to_numpy(bool) if validity in frame.columns else np.ones(len(frame), bool)


def _span(frame: pandas.DataFrame, name: str) -> float:
    values = frame[name].to_numpy()[_valid(frame, name)]
    return float(values.max() - values.min()) if len(values) else 0.0


def _size(frame: pandas.DataFrame, reference: pandas.DataFrame, name: str) -> tuple[float, float]:
    """Root mean square and greatest size of the difference where both are valid; angles differ the short way round."""
    import numpy as np

    both = _valid(frame, name) & _valid(reference, name)
    error = (frame[name].to_numpy() - reference[name].to_numpy())[both]
    if not len(error):
        return 0.0, 0.0
    if reference.attrs["units"].get(name) == "rad":
        error = np.remainder(error + np.pi, 2.0 * np.pi) - np.pi
    return float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error)))


def show(result: Sweep, report: Path | None) -> None:
    """Print the table, the lost samples and the recommendation."""
    from rich.table import Table

    from navfmu.terminal.console import console

    out = console()
    table = Table(
        title=f"{result.system}: rms error against the step of {result.steps[0]:g} s", title_justify="left", box=None
    )
    table.add_column("signal", no_wrap=True)
    table.add_column("unit")
    table.add_column("algorithm")
    for step in result.steps:
        table.add_column(f"{step:g} s", justify="right")
    table.add_column("slope", justify="right")
    table.add_column("algorithms apart", justify="right")
    for signal in result.signals:
        for algorithm in ALGORITHMS:
            rows = result.of(algorithm, signal)
            slope = result.slope(algorithm, signal)
            order = "" if slope is None else f"{slope:.2f}"
            numbers = (f"{row.rms:.3g}" for row in rows)
            apart = f"{result.apart[signal]:.3g}" if algorithm == ALGORITHMS[0] else ""
            table.add_row(signal.replace("[", r"\["), rows[0].unit, algorithm, *numbers, order, apart)
    out.print(table)
    if any(any(counts.values()) for counts in result.lost.values()):
        table = Table(title="samples lost between components", title_justify="left", box=None)
        table.add_column("counter")
        table.add_column("algorithm")
        for step in result.steps:
            table.add_column(f"{step:g} s", justify="right")
        for name, counts in result.lost.items():
            for algorithm in ALGORITHMS:
                numbers = [counts[algorithm, step] for step in result.steps]
                if any(numbers):
                    table.add_row(name, algorithm, *map(str, numbers))
        out.print(table)
    elif result.lost:
        out.print("no samples were lost at any step")
    out.print(result.recommendation(), soft_wrap=True)
    if report is not None:
        out.print(f"report: {report}", soft_wrap=True)
