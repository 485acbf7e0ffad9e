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
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from navfmu.engine.clock import exact
from navfmu.errors import NavfmuError, check_progress
from navfmu.fmi import names
from navfmu.sweep.compare import comparable, compare, not_real, validity
from navfmu.sweep.result import ALGORITHMS, Sweep
from navfmu.system.experiment import Experiment, number
from navfmu.system.pool import fly_all
from navfmu.system.result import other_notes

if TYPE_CHECKING:
    from navfmu.system.assembly import Assembly

POINTS = 10_000  # the shared points are thinned to at most about so many


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
    check_progress(progress)
    period = _shared_period(ordered, experiment.stop)
    system = experiment.system
    wanted = [*experiment.record, *_validities(system, experiment.record)]
    common = {"record": wanted, "record_period": period, "seed": 1 if experiment.seed is None else experiment.seed}
    runs = {
        (algorithm, step): replace(experiment, algorithm=algorithm, step=step, **common)
        for algorithm in ALGORITHMS
        for step in ordered
    }
    frames = fly_all(runs, jobs, progress)
    compared, idle = comparable(frames)
    rows, apart = compare(frames, compared, ordered[0])
    counters = next(iter(frames.values())).attrs["lost"]
    lost = {name: {key: frame.attrs["lost"][name] for key, frame in frames.items()} for name in counters}
    notes = tuple(dict.fromkeys(note for frame in frames.values() for note in other_notes(frame, lost=False)))
    about = _provenance(experiment, ordered, period, tolerance, common["seed"])
    return Sweep(
        system=system.name,
        steps=tuple(ordered),
        stop=experiment.stop,
        period=period,
        rows=tuple(rows),
        apart=apart,
        lost=lost,
        tolerance=tolerance,
        provenance=about,
        notes=notes,
        idle=idle,
        not_real=not_real(frames),
        seed=common["seed"],
        seed_given=experiment.seed is not None,
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
        words += ["--signals", ",".join(experiment.record)]
    return about | {"steps": list(steps), "period": period, "tolerance": tolerance, "command": shlex.join(words)}


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
    known = {str(output) for output in names.outputs(system.descriptions)}
    return sorted({validity(name) for signal in signals for name in _expanded(system, signal)} & known)


def _expanded(system: Assembly, signal: str) -> list[str]:
    return [str(s) for s in names.signals(system.descriptions, signal.removesuffix("@true"), f"signal '{signal}'")]
