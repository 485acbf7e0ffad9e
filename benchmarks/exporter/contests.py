"""Each case measured: run time against the loops and NumPy, size of the code, seconds to make it, agreement.

Goals: at most 1.5 x the time of the loops, 5 s of a processor for each platform, and 250 kB of C for 42 states; for 15
states a prediction in 0.5 us and a scalar update in 0.3 us; a fix from 24 satellites in 10 us.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from benchmarks.contest import Contest, compete
from benchmarks.exporter.cases import STATES_DRIVEN, Case, cases
from benchmarks.exporter.loops import Loops
from benchmarks.exporter.translated import Translated

WORK = "All do the same from the same numbers and give the same results to one part in 10^12, which is checked."
AGREE = 1e-12


def run(rounds: int = 7) -> list[Contest]:
    """Return a contest for each case, each measured in so many rounds."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        loops = {states: Loops(states, driven, Path(scratch)) for states, driven in STATES_DRIVEN.items()}
        measured = [_measured(case, loops[case.states], Path(scratch), rounds) for case in cases()]
    contests = [contest for contest, _ in measured]
    forms = [(contest, form, one) for contest, made in measured for form, one in made.items()]
    ratios = ((contest.ratio(form, "loops in C"), f"{contest.name}, {form}") for contest, form, _ in forms)
    largest = [(contest, form, one) for contest, form, one in forms if f"{max(STATES_DRIVEN)} states" in contest.name]
    sizes = ((len(one.text) / 1e3, f"{contest.name}, {form}") for contest, form, one in largest)
    seconds = (
        (spent, f"{contest.name}, {form}, {platform}")
        for contest, form, one in forms
        for platform, spent in one.to_compile.items()
    )
    _claim(contests, "time over that of loops in C", 1.5, ratios)
    _claim(contests, "size of the C code", 250.0, sizes, "kB")
    _claim(contests, "time of a processor to compile it", 5.0, seconds, "s")
    return contests


def _claim(
    contests: list[Contest], what: str, bound: float, measured: Iterable[tuple[float, str]], unit: str = ""
) -> None:
    """Claim something of the worst of all."""
    worst, where = max(measured)
    contests[-1].claim(f"Exporter: {what}, the largest: {where}", bound, worst, at_least=False, unit=unit)


def _measured(case: Case, loops: Loops, folder: Path, rounds: int) -> tuple[Contest, dict[str, Translated]]:
    given = np.concatenate([np.ravel(np.asarray(argument, float)) for argument in case.arguments])
    expected = {form: flat(function)(*case.arguments) for form, function in case.forms.items()}
    size = next(iter(expected.values())).size
    made = {form: Translated(flat(f), case.arguments, case.modules, folder) for form, f in case.forms.items()}
    watches = {"loops in C": loops.stopwatch(loops.address(case.loops), given, size)}
    watches |= {form: loops.stopwatch(one.address, given, size) for form, one in made.items()}
    for name, watch in watches.items():
        for form, right in expected.items():
            _check(f"{case.name}, {name} and {form} in NumPy", watch.result, right)
    contenders = {**watches, "NumPy": lambda: _timed(next(iter(case.forms.values())), case)}
    notes = "; ".join(f"{form}: {_note(one)}" for form, one in made.items())
    contest = compete(case.name, "call", contenders, rounds, f"{WORK} {notes}.")
    if case.seconds:
        for form in made:
            spent = 1e6 * contest.median(form)
            contest.claim(f"Exporter: {case.name}, {form}", 1e6 * case.seconds, spent, at_least=False, unit="us")
    return contest, made


def flat(function: Callable) -> Callable:
    """Return the function with all its results in one array."""

    def flat(*arguments: np.ndarray) -> np.ndarray:
        results = function(*arguments)
        return np.concatenate([np.ravel(x) for x in (results if isinstance(results, tuple) else (results,))])

    return flat


def _check(what: str, one: np.ndarray, other: np.ndarray) -> None:
    apart = np.max(np.abs(one - other)) / np.max(np.abs(other))
    if not apart <= AGREE:
        raise AssertionError(f"{what} differ by {apart:.1e} of the largest number; expected at most {AGREE:g}")


def _timed(function: Callable, case: Case) -> float:
    before = time.perf_counter()
    function(*case.arguments)
    return time.perf_counter() - before


def _note(one: Translated) -> str:
    seconds = ", ".join(f"{platform} {seconds:.1f}" for platform, seconds in one.to_compile.items())
    size = f"{len(one.text) / 1e3:.0f} kB of C"
    return f"{size}, traced and printed in {one.to_trace:.2f} s, compiled in seconds of a processor: {seconds}"
