"""The recommendation of a sweep in words; every one of them follows from its rows and counters."""

from __future__ import annotations

import math
from itertools import groupby

from navfmu.sweep.result import ALGORITHMS, Row, Sweep

NAMED = 3  # signals that are named in a sentence


def recommendation(result: Sweep) -> str:
    """Which step to take and what it costs, or why none can be recommended; then what could not be compared."""
    found = {algorithm: result.recommended(algorithm) for algorithm in ALGORITHMS}
    useful = [algorithm for algorithm in ALGORITHMS if found[algorithm] not in (None, result.steps[0])]
    sentences = _take(result, useful[0], found) if useful else _take_none(result)
    return " ".join([*sentences, *_apart(result), *findings(result)])


def findings(result: Sweep) -> list[str]:
    """Sentences on the signals that cannot be compared; none if all can."""
    sentences = []
    by_signal = [(signal, [row for row in result.problems if row.signal == signal]) for signal in result.signals]
    failing = [(signal, rows) for signal, rows in by_signal if rows]
    for signal, rows in failing[:NAMED]:
        sentences.append(f"Cannot be compared: {signal} {_where(rows)}.")
    if len(failing) > NAMED:
        sentences.append(f"Nor can {len(failing) - NAMED} more signals, which the table names.")
    if result.idle:
        more = f" and {len(result.idle) - NAMED} more" if len(result.idle) > NAMED else ""
        sentences.append(f"Not compared, because valid in no run: {', '.join(result.idle[:NAMED])}{more}.")
    return sentences


def _where(rows: list[Row]) -> str:
    """ "is not finite at 3 of 10 points (jacobi, 0.5 s), ..." for one signal."""
    parts = []
    for (algorithm, problem), group in groupby(rows, key=lambda row: (row.algorithm, row.problem)):
        steps = ", ".join(f"{row.step:g} s" for row in group)
        parts.append(f"{problem} ({algorithm}, {steps})")
    return ", ".join(parts)


def _take(result: Sweep, best: str, found: dict[str, float | None]) -> list[str]:
    step, smallest = found[best], result.steps[0]
    worst = result.worst(best, step)
    size = f"worst: {worst.signal}, rms error {measure(worst.rms, worst.unit)}" if worst.rms else "no error at all"
    text = f"Use {best} with steps up to {step:g} s: every signal stays within {_limit(result)} ({size})"
    sentences = [f"{text}{_losses(result, best, step)}."]
    if step < result.steps[-1]:
        sentences.append(f"At {_why_not(result, best, result.steps[result.steps.index(step) + 1])}")
    other = next(algorithm for algorithm in ALGORITHMS if algorithm != best)
    if found[other] is None:
        sentences.append(f"{other} cannot be judged.")
    elif found[other] == smallest:
        sentences.append(f"With {other} that is so at no step above {smallest:g} s.")
    else:
        lose = any(result.lost_at(*run) for a in ALGORITHMS for run in ((a, found[a]), (a, smallest)))
        losses = _losses(result, other, found[other]) if lose else ""
        sentences.append(f"With {other} that is so up to {found[other]:g} s{losses}.")
    return sentences


def _take_none(result: Sweep) -> list[str]:
    smallest = result.steps[0]
    sentences = [f"No step above {smallest:g} s can be recommended."]
    for algorithm in ALGORITHMS:
        failing = next((step for step in result.steps if not result.acceptable(algorithm, step)), None)
        if failing is not None:
            sentences.append(f"{algorithm} at {_why_not(result, algorithm, failing)}")
    already = max(result.lost_at(algorithm, smallest) for algorithm in ALGORITHMS)
    if already:
        sentences.append(f"{_samples(already)} lost at {smallest:g} s already: compare smaller steps.")
    return sentences


def _why_not(result: Sweep, algorithm: str, step: float) -> str:
    """What is wrong with a step that is not acceptable: "0.1 s: 3 samples are lost." """
    worst, lost = result.worst(algorithm, step), result.loses(algorithm, step)
    reasons = []
    if worst.problem:
        reasons.append(f"{worst.signal} {worst.problem}")
    elif worst.relative > result.tolerance:
        share = f"{percent(worst.relative)} of its range" if math.isfinite(worst.relative) else "though it is constant"
        reasons.append(f"{worst.signal} is off by {measure(worst.rms, worst.unit)} rms, {share}")
    if lost:
        before = result.lost_at(algorithm, result.steps[0])
        more = f" more than the {before} at {result.steps[0]:g} s" if before else ""
        reasons.append(f"{_samples(lost)} lost{more}")
    return f"{step:g} s: {' and '.join(reasons)}."


def _losses(result: Sweep, algorithm: str, step: float) -> str:
    """How many samples an acceptable run loses."""
    if not result.lost:
        return "; no component counts lost samples"
    lost, before = result.lost_at(algorithm, step), result.lost_at(algorithm, result.steps[0])
    if not lost and not before:
        return " and no sample is lost"
    if not lost:
        return f" and no sample is lost there, though {before} at {result.steps[0]:g} s"
    return f", but {_samples(lost)} lost, and {before} at {result.steps[0]:g} s already: compare smaller steps, too"


def _apart(result: Sweep) -> list[str]:
    comparable = [signal for signal in result.signals if not math.isnan(result.apart[signal])]
    signal = max(comparable, key=result.share_apart, default=None)
    if signal is None or result.share_apart(signal) <= result.tolerance:
        return []
    share = result.share_apart(signal)
    up_to = f"by up to {percent(share)} of a signal's range" if math.isfinite(share) else "in a constant signal"
    size = measure(result.apart[signal], result.of(ALGORITHMS[0], signal)[0].unit)
    return [f"At {result.steps[0]:g} s the two algorithms differ {up_to} ({signal}, {size} rms)."]


def percent(share: float) -> str:
    """A share in percent: two digits, no exponent."""
    return f"{100 * share:.0f} %" if share >= 1.0 else f"{100 * share:.2g} %"


def measure(value: float, unit: str) -> str:
    """A number with its unit, which numbers of unit 1 do without."""
    return f"{value:.3g} {unit}" if unit and unit != "1" else f"{value:.3g}"


def _samples(count: int) -> str:
    return "1 sample is" if count == 1 else f"{count} samples are"


def _limit(result: Sweep) -> str:
    return f"{100 * result.tolerance:g} % of its range"
