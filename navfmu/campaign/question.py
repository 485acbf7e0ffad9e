"""The kinds of requirements: what each asks of a run, how it is judged, and how it is told."""

from __future__ import annotations

import math
import re
from typing import Any, Protocol

import numpy as np

from navfmu.campaign.finding import Finding, enough, percent, times
from navfmu.engine.monitor import Monitor, Observed


class Terms(Protocol):
    """What a requirement says (:class:`navfmu.campaign.requirement.Requirement`), as far as its question needs it."""

    id: str
    signal: str
    most: float | None
    least: float | None
    unit: str
    percent: float | None
    quantile: float | None
    start: float
    end: float
    when: str
    tolerance: float
    expect_violated: bool
    fault: str

    @property
    def truth(self) -> bool:
        """Whether the expression itself says what is required."""

    def excess(self, values: np.ndarray) -> np.ndarray:
        """How far values lie outside the bound (positive) or inside it (negative)."""


class Question:
    """A bound on a value, for a share of the time of each run, or of the runs at each time."""

    of_faults = False  # whether it is asked only in runs in which its fault acts
    silent = "was asked at no point of the run"

    def monitor(self, r: Terms) -> Monitor:
        """What is asked at every communication point of a run."""
        bounds = {name: bound for name, bound in (("least", r.least), ("most", r.most)) if bound is not None}
        return Monitor(r.id, r.signal, **bounds, **self._time(r))

    def _time(self, r: Terms) -> dict[str, Any]:
        return {"begin": r.start, "end": r.end, "when": r.when, "tolerance": r.tolerance}

    def judge(self, r: Terms, seen: Observed) -> Finding | None:
        """What a run says; None where it was not asked at any point.

        Points that a run did not reach speak against the requirement: they are outside of its bound, or inside, where
        it should be violated.
        """
        total = seen.points + seen.missing
        if not total:
            return None
        outside = seen.outside + (0 if r.expect_violated else seen.missing)
        share = 100.0 * (total - outside) / total
        held = enough(share, 100.0 if r.percent is None else r.percent)
        return self._finding(seen, held, share, seen.worst, seen.worst_time, seen.first_outside)

    def _finding(
        self, seen: Observed, held: bool, share: float, worst: float, at: float, first_violation: float
    ) -> Finding:
        first = None if math.isnan(first_violation) else first_violation
        return Finding(held, share, worst, at, first, seen.missing, seen.rms, seen.greatest)

    # ---- in words ----------------------------------------------------------------------------------------------------

    def sentence(self, r: Terms) -> str:
        """The requirement: "evaluation.horizontal_error <= 926 m for 95 % of the time from 300 s"."""
        if r.quantile is not None:
            return f"{_bound(r)} at every time{_when(r)}, {100 * r.quantile:g}th percentile of the runs"
        share = "always" if r.percent == 100 else f"for {r.percent:g} % of the time"
        share += f", but for {r.tolerance:g} s at a time" if r.tolerance else ""
        return f"{_bound(r)} {share}{_when(r)}"

    def quantity(self, r: Terms) -> tuple[str, str, str]:
        """What the worst value of runs is, when, and on an axis: "a.x", " at its worst time", "worst x"."""
        plain = re.fullmatch(r"[\w.\[\],]+", r.signal)
        name = r.signal.rpartition(".")[2].replace("_", " ") if plain else "value"
        return r.signal, " at its worst time", f"worst {name}"

    def value(self, r: Terms, f: Finding) -> str:
        """What is worst in a run: "1403 m"."""
        if not f.reached:
            return "not reached"
        if r.truth:
            return "never false" if f.first_violation is None else "false"
        return told(r, f.worst)

    def at_worst(self, r: Terms, f: Finding) -> str:
        """Where that says more than the share: "1403 m at t = 1412.3 s"."""
        if not f.reached or r.truth or not (r.unit or math.isfinite(f.worst)):
            return ""
        return f"{told(r, f.worst) if math.isfinite(f.worst) else 'not finite'} at t = {f.worst_time:.9g} s"

    def share(self, f: Finding) -> str:
        """How much of the time it is as asked: "inside for 88.2 % of the time"."""
        return f"inside for {percent(f.percent)} of the time"

    def first(self, f: Finding) -> str:
        """When it is not: "first violated at t = 12 s"."""
        return "" if f.first_violation is None else f"first violated at t = {f.first_violation:.9g} s"

    def seen(self, r: Terms, f: Finding) -> str:
        """All of it: "inside for 88.2 % of the time, first violated at t = 1412.3 s, worst 1403 m at t = 1500 s"."""
        worst, excess = self.at_worst(r, f), float(r.excess(np.array([f.worst]))[0])
        beyond = f" ({with_unit(r, f'{excess:.4g}')} beyond the bound)" if 0 < excess < math.inf else ""
        return _joined(self.share(f), self.first(f), f"worst {worst}{beyond}" if worst else "", _missing(f))

    def badness(self, r: Terms, f: Finding) -> tuple[float, float]:
        """Sorts runs: the worst is the greatest."""
        return -f.percent, float(r.excess(np.array([f.worst]))[0])


class Events(Question):
    """How often an expression becomes true."""

    def monitor(self, r: Terms) -> Monitor:
        return Monitor(r.id, f"not ({r.signal})", **self._time(r))

    def judge(self, r: Terms, seen: Observed) -> Finding | None:
        total = seen.points + seen.missing
        if not total:
            return None
        share = 100.0 * (total - seen.outside - (0 if r.expect_violated else seen.missing)) / total
        held = seen.episodes <= r.most and (r.expect_violated or not seen.missing)
        return self._finding(seen, held, share, float(seen.episodes), seen.first_outside, seen.first_outside)

    def sentence(self, r: Terms) -> str:
        lasting = f" for more than {r.tolerance:g} s" if r.tolerance else ""
        return f"{r.signal}{lasting} at most {times(r.most)}{_when(r)}"

    def quantity(self, r: Terms) -> tuple[str, str, str]:
        return f"how often {r.signal}", "", "times"

    def value(self, r: Terms, f: Finding) -> str:
        return times(f.worst) if f.reached else "not reached"

    def at_worst(self, r: Terms, f: Finding) -> str:
        return times(f.worst)

    def share(self, f: Finding) -> str:
        return ""

    def first(self, f: Finding) -> str:
        return "" if f.first_violation is None else f"first at t = {f.first_violation:.9g} s"

    def seen(self, r: Terms, f: Finding) -> str:
        return _joined(self.at_worst(r, f), self.first(f), _missing(f))

    def badness(self, r: Terms, f: Finding) -> tuple[float, float]:
        return f.worst, 0.0


class Detects(Question):
    """For how long a fault goes unnoticed: an expression becomes true within a time of its first onset.

    Nothing can be said of a run that has its planned end before that time is over, unless the fault is noticed.
    """

    of_faults = True
    silent = "could not be asked: its fault did not act, or the run was over before its time was"
    after = "noticed"

    def monitor(self, r: Terms) -> Monitor:
        return Monitor(r.id, r.signal, counts_from="onset", fault=r.fault)

    def judge(self, r: Terms, seen: Observed) -> Finding | None:
        if not seen.points:
            return None
        in_time = seen.soonest <= r.most * (1.0 + 1e-9)
        if not in_time and too_short(r, seen):
            return None
        cut = seen.missing and math.isnan(seen.soonest) and seen.last_outside - seen.origin < r.most
        return self._judged(r, seen, r.expect_violated if cut else in_time, seen.origin, seen.soonest)

    def _judged(self, r: Terms, seen: Observed, held: bool, origin: float, took: float) -> Finding:
        """From how long it took after an origin (s; NaN: for ever)."""
        violated = math.nan if held else origin + r.most
        return self._finding(seen, held, 100.0 if held else 0.0, took, origin + took, violated)

    def sentence(self, r: Terms) -> str:
        which = f"fault '{r.fault}'" if r.fault else "the first fault"
        return f"{which} {self.after} within {r.most:g} s: {r.signal}"

    def quantity(self, r: Terms) -> tuple[str, str, str]:
        return f"how long until {r.signal}", "", f"time until {self.after}"

    def value(self, r: Terms, f: Finding) -> str:
        if math.isnan(f.worst):
            return f"not {self.after} before the early end" if f.missing else f"never {self.after}"
        return f"after {told(r, f.worst)}"

    def at_worst(self, r: Terms, f: Finding) -> str:
        return self.value(r, f)

    def share(self, f: Finding) -> str:
        return ""

    def seen(self, r: Terms, f: Finding) -> str:
        return _joined(self.at_worst(r, f), _missing(f))

    def badness(self, r: Terms, f: Finding) -> tuple[float, float]:
        return -f.percent, math.inf if math.isnan(f.worst) else f.worst


class Recovers(Detects):
    """How long it takes after the end of a fault until an expression is true, and stays so as long as none acts.

    Of a fault that comes several times the end counts after which it takes longest. One after which the fault comes
    again, or the run has its planned end, before the time is over and while the expression is false, says nothing.
    """

    silent = "could not be asked: its fault was never over, or it came again, or the run was over, before its time was"
    after = "recovered"

    def monitor(self, r: Terms) -> Monitor:
        return Monitor(r.id, r.signal, counts_from="over", fault=r.fault)

    def judge(self, r: Terms, seen: Observed) -> Finding | None:
        if not seen.points:
            return None
        false_at_last = seen.last_outside >= seen.origin + seen.left - 1e-9
        cut_short = false_at_last and seen.latest_from == seen.origin and too_short(r, seen)
        if seen.latest > r.most * (1.0 + 1e-9) and not cut_short:
            took = seen.latest if seen.settled == seen.latest else math.nan
            return self._judged(r, seen, False, seen.latest_from, took)
        if false_at_last or seen.missing:
            return None if too_short(r, seen) else self._judged(r, seen, r.expect_violated, seen.origin, math.nan)
        return None if math.isnan(seen.settled) else self._judged(r, seen, True, seen.origin, seen.settled)

    def first(self, f: Finding) -> str:
        return "" if f.first_violation is None else f"violated at t = {f.first_violation:.9g} s"

    def sentence(self, r: Terms) -> str:
        which = f"fault '{r.fault}'" if r.fault else "all faults"
        return f"{r.signal} within {r.most:g} s of the end of {which}, and from then on"


QUESTIONS = {"signal": Question(), "events": Events(), "detects": Detects(), "recovers": Recovers()}


def too_short(r: Terms, seen: Observed) -> bool:
    """Whether a run has its planned end before the time is over that it may take."""
    return seen.left < r.most * (1.0 - 1e-9)


def _joined(*words: str) -> str:
    return ", ".join(filter(None, words))


def _missing(f: Finding) -> str:
    return f"{f.missing} points were not reached" if f.missing else ""


def _bound(r: Terms) -> str:
    """ "3 m <= a.x <= 5 m"."""
    low = f"{with_unit(r, f'{r.least:g}')} <= " if r.least is not None else ""
    return low + r.signal + (f" <= {with_unit(r, f'{r.most:g}')}" if r.most is not None else "")


def _when(r: Terms) -> str:
    """ " from 300 s to 400 s while navigator.mode != 0"."""
    text = f" from {r.start:g} s" if r.start > 0 else ""
    text += f" to {r.end:g} s" if math.isfinite(r.end) else ""
    return text + (f" while {r.when}" if r.when else "")


def with_unit(r: Terms, number: str) -> str:
    """A number in the unit of a requirement."""
    return f"{number} {r.unit}" if r.unit and r.unit != "1" else number


def told(r: Terms, value: float) -> str:
    """A value with its unit, in as many digits as it takes to tell it from a bound that it is beyond."""
    bounds = [bound for bound in (r.most, r.least) if bound is not None and bound != value]
    for digits in range(4, 18):
        text = _digits(value, digits)
        if all(_digits(bound, digits) != text for bound in bounds):
            break
    return with_unit(r, text)


def _digits(value: float, digits: int) -> str:
    """A number for people: no exponent where a person would write none."""
    return f"{value:.{max(0, digits - 4)}f}" if 1e3 <= abs(value) < 1e6 else f"{value:.{digits}g}"
