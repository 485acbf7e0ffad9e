"""Axes and design of a campaign file, checked, and the cases that come of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from navfmu.campaign.axis import Axis, Goal, Listed, Span, Value, texts
from navfmu.campaign.case import Case
from navfmu.campaign.design import KINDS, Design
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.schema import AxisEntry, DesignEntry
from navfmu.campaign.search import Search
from navfmu.campaign.varied import varied_of
from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.seconds import is_finite, short
from navfmu.fmi.values import number_and_unit

Error = Callable[..., NavfmuError]  # of a sentence and the place of an entry in the table
TAKEN = (  # columns beside those of axes, in all tables of a campaign
    *("variant", "case", "seed", "requirement", "sentence", "verdict", "seen", "error", "not_finite", "idle", "notes"),
    *("held", "percent", "worst", "worst_time", "first_violation", "missing", "recording"),
    *("first_onset", "latency", "rms", "greatest"),
    *("runs_held", "runs", "interval_low_percent", "interval_high_percent"),
    *("axis", "unit", "holds_at", "violated_at", "tolerance", "runs_with_error"),
)
FINEST = 1e-9  # tolerance of a search, as a share of its range


def design_of(entry: DesignEntry | None, axes: bool, error: Error) -> Design:
    """The design of its table; ``axes`` says whether there are any."""
    if entry is None:
        return Design()
    if entry.kind not in KINDS:
        raise error(f"unknown kind '{entry.kind}'{nearest(entry.kind, KINDS)} (there are: {', '.join(KINDS)})", "kind")
    if not axes:
        raise error("there is no [[axis]] whose points this design could take")
    design = Design(entry.kind, entry.count or 1, 1 if entry.seed is None else entry.seed)
    for key in ("count", "seed"):
        if getattr(entry, key) is not None and not design.draws:
            raise error(f"'{key}' goes with points that are drawn, and {entry.kind} takes those that there are", key)
    if design.draws and entry.count is None:
        raise error(f"{entry.kind} needs 'count', the number of points", "kind")
    if design.kind == "sobol" and design.count & (design.count - 1):
        below = 2 ** (design.count.bit_length() - 1)
        raise error(
            f"'count' is {design.count}, expected a power of 2, for which Sobol's points are even: {below} or "
            f"{2 * below}",
            "count",
        )
    return design


@dataclass(frozen=True)
class Axes:
    """The axes of a campaign, in the order of the file, and the design that takes points of them."""

    design: Design
    all: tuple[Axis, ...] = ()

    def of(self, case: Case) -> tuple[Axis, ...]:
        """Those that make points of a case."""
        return tuple(axis for axis in self.all if axis.goal is None and axis.applies(case))

    def searches(self, case: Case) -> tuple[Search, ...]:
        """Those along which a requirement is searched in a case."""
        return tuple(Search(case, axis) for axis in self.all if axis.goal is not None and axis.applies(case))

    def runs(self, case: Case) -> int:
        """How many runs a case of the file stands for, at most, with one seed."""
        return self.design.size(self.of(case)) * (sum(search.most for search in self.searches(case)) or 1)

    def points(self, case: Case) -> Iterator[Case]:
        """The cases that a case of the file stands for."""
        axes = self.of(case)
        if not axes:
            yield case
            return
        points = list(dict.fromkeys(self.design.points(axes)))  # one that is drawn twice is one case
        told = [dict(zip(column, texts(axis, column), strict=True)) for axis, column in _columns(axes, points)]
        for point in points:
            found, words = case, []
            for axis, value, names in zip(axes, point, told, strict=True):
                found = axis.laid(found, value)
                words.append(f"{axis.name}={names[value]}")
            yield replace(found, name=f"{case.name} ({', '.join(words)})")


def _columns(axes: Sequence[Axis], points: Sequence[tuple[Value, ...]]) -> Iterator[tuple[Axis, list[Value]]]:
    for axis, column in zip(axes, zip(*points, strict=True), strict=True):
        yield axis, list(dict.fromkeys(column))


def axes_of(
    entries: Sequence[AxisEntry],
    design: Design,
    cases: Sequence[Case],
    requirements: Sequence[Requirement],
    error: Error,
    where: Callable[[int], str],
) -> Axes:
    """The axes of a file; places of errors begin with the number of the axis. ``where`` gives file and line."""
    found: list[Axis] = []
    for number, entry in enumerate(entries):

        def wrong(sentence: str, *place: str | int, number: int = number) -> NavfmuError:
            return error(sentence, number, *place)

        axis = _axis(entry, cases, wrong, where(number))
        if axis.name in (other.name for other in found):
            raise wrong(f"there are two axes '{axis.name}'; give them names", "name" if entry.name else "vary")
        if entry.search is not None:
            axis = _searched(entry, axis, requirements, wrong)
        else:
            _check_spread(entry, axis, design, wrong)
        found.append(axis)
        _check_together(Axes(design, tuple(found)), [case for case in cases if axis.applies(case)], wrong)
    return Axes(design, tuple(found))


def _axis(entry: AxisEntry, cases: Sequence[Case], error: Error, where: str) -> Axis:
    written = list(dict.fromkeys(case.written for case in cases))
    for number, name in enumerate(entry.cases or ()):
        if name not in written:
            raise error(f"'cases': there is no '{name}' in this campaign{nearest(name, written)}", "cases", number)
    asked = [case for case in cases if entry.cases is None or case.written in entry.cases]
    faults = [fault.id for case in asked for fault in case.faults]
    names = [entry.vary] if isinstance(entry.vary, str) else entry.vary
    varied = []
    for number, text in enumerate(names):
        try:
            varied.append(varied_of(text, faults))
        except NavfmuError as problem:
            place = ("vary",) if isinstance(entry.vary, str) else ("vary", number)
            raise error(f"'vary' {problem}", *place) from None
    name = varied[0].name if entry.name is None else entry.name
    if not name.strip() or not name.isprintable():
        raise error(f"'name' is {short(name)}, expected a text that can head a column", "name")
    if name in TAKEN:
        raise error(f"'name' is '{name}', which is a column of its own; take another one", "name")
    values, unit = _span(entry, error) if entry.values is None else _listed(entry, error)
    return Axis(name, tuple(varied), values, unit, None if entry.cases is None else tuple(entry.cases), where=where)


def _listed(entry: AxisEntry, error: Error) -> tuple[Listed, str]:
    """Values one by one, as numbers in one unit where all are; otherwise as they stand there."""
    for key in ("low", "high", "count"):
        if getattr(entry, key) is not None:
            raise error(f"'{key}' and 'values' exclude each other", key)
    if entry.scale != "linear":
        raise error("'scale' goes with 'low' and 'high', not with 'values'", "scale")
    given = entry.values or []
    parted = [_parted(value) for value in given]
    if all(part is not None for part in parted):
        for number, (_, unit) in enumerate(parted):
            if unit != parted[0][1]:
                units = " and ".join(f"'{u}'" if u else "none" for u in (parted[0][1], unit))
                raise error(f"'values' have different units, {units}: write them in one", "values", number)
        found, unit = [number for number, _ in parted], parted[0][1]
    else:
        found, unit = given, ""
    for number, value in enumerate(found):
        if isinstance(value, float | int) and not is_finite(value) and not isinstance(value, bool):
            raise error(f"'values' holds {short(given[number])}, expected a finite number", "values", number)
        if value in found[:number]:
            raise error(f"'values' holds {short(given[number])} twice", "values", number)
    return Listed(tuple(found)), unit


def _parted(value: Value) -> tuple[float, str] | None:
    """Number and unit of a value that has them."""
    if isinstance(value, bool):
        return None
    return number_and_unit(value) if isinstance(value, str) else (value, "")


def _span(entry: AxisEntry, error: Error) -> tuple[Span, str]:
    ends: dict[str, tuple[float, str]] = {}
    if entry.low is None and entry.high is None:
        raise error("this axis has neither 'values', nor 'low' and 'high'", "vary")
    for key, other in (("low", "high"), ("high", "low")):
        value = getattr(entry, key)
        if value is None:
            raise error(f"this axis has '{other}' and no '{key}'", other)
        ends[key] = _finite(key, value, error)
    (low, unit), (high, other) = ends["low"], ends["high"]
    if other != unit:
        units = " and ".join(f"'{u}'" if u else "no unit" for u in (unit, other))
        raise error(f"'low' and 'high' have different units, {units}: write them in one", "high")
    if not low < high:
        raise error(f"'high' is {short(entry.high)}, expected more than 'low', {short(entry.low)}", "high")
    if entry.scale == "log" and not low > 0:
        raise error(f"'low' is {short(entry.low)}, expected more than 0 where 'scale' is 'log'", "low")
    if not math.isfinite(high - low):
        raise error(f"from {short(entry.low)} to {short(entry.high)} is too far to be divided", "high")
    return Span(low, high, entry.scale == "log", entry.count), unit


def _finite(key: str, value: Value, error: Error) -> tuple[float, str]:
    """A number and its unit."""
    part = _parted(value)
    if part is None or not is_finite(part[0]):
        raise error(f"'{key}' is {short(value)}, expected a finite number, or a text such as '0.5 nmi'", key)
    return float(part[0]), part[1]


def _check_spread(entry: AxisEntry, axis: Axis, design: Design, error: Error) -> None:
    """Whether the design can take points of the axis."""
    if entry.tolerance is not None:
        raise error("'tolerance' goes with 'search'", "tolerance")
    if isinstance(axis.values, Span):
        if design.draws and axis.values.count is not None:
            raise error(f"'count' goes with a grid: {design.kind} draws as many points as the design says", "count")
        if not design.draws and axis.values.count is None:
            raise error(f"{design.kind} needs 'count', the number of values from 'low' to 'high'", "low")


def _searched(entry: AxisEntry, axis: Axis, requirements: Sequence[Requirement], error: Error) -> Axis:
    """The axis with its goal, in the cases of which that is asked."""
    if not isinstance(axis.values, Span):
        raise error("'search' goes from 'low' to 'high', not through 'values'", "values")
    if axis.values.count is not None:
        raise error("'count' goes with a grid, not with 'search', which ends at its 'tolerance'", "count")
    known = {requirement.id: requirement for requirement in requirements}
    if entry.search not in known:
        have = f" (there are: {', '.join(known)})" if known else " (there is none)"
        raise error(f"'search': there is no requirement '{entry.search}'{nearest(entry.search, known)}{have}", "search")
    if known[entry.search].quantile is not None:
        raise error(f"'search': {entry.search} asks a quantile of the runs; a search asks one at a time", "search")
    if entry.tolerance is None:
        raise error("'search' needs a 'tolerance', the width of the bracket", "search")
    tolerance, unit = _finite("tolerance", entry.tolerance, error)
    if unit != axis.unit:
        raise error(
            f"'tolerance' is {short(entry.tolerance)}, expected it in the unit of 'low' and 'high'", "tolerance"
        )
    span = axis.values
    finest = max(FINEST * (span.high - span.low), 8 * math.ulp(max(abs(span.low), abs(span.high))))
    if not tolerance >= finest:
        raise error(f"'tolerance' is {short(entry.tolerance)}, expected at least {finest:.3g}", "tolerance")
    asked = known[entry.search].cases
    for number, case in enumerate(entry.cases or ()):
        if asked is not None and case not in asked:
            raise error(f"'search': {entry.search} is not asked of the case '{case}'", "cases", number)
    return replace(axis, cases=axis.cases or asked, goal=Goal(entry.search, tolerance))


def _check_together(axes: Axes, cases: Sequence[Case], error: Error) -> None:
    """Whether the newest axis goes along with the others, in the cases that it varies."""
    *others, axis = axes.all
    if not cases:
        raise error("this axis varies no case", "vary")
    for case in cases:
        for other in others:
            both = [varied.name for varied in axis.varied if varied in other.varied and varied.is_in(case)]
            if both and other.applies(case):
                raise error(f"case '{case.name}': '{both[0]}' is varied by the axis '{other.name}', too", "vary")
        searched = " and ".join(f"'{search.axis.name}'" for search in axes.searches(case))
        if len(axes.searches(case)) > 1:
            raise error(f"case '{case.name}': a search goes along one axis, not along {searched}", "search")
        try:
            axes.design.check(axes.of(case))
        except NavfmuError as problem:
            raise error(f"case '{case.name}': {problem}", "values" if axis.goal is None else "search") from None
