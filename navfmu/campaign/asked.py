"""A requirement of a campaign file, checked against the systems that it is asked of."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence

from navfmu.campaign.question import QUESTIONS
from navfmu.campaign.requirement import Requirement
from navfmu.campaign.schema import RequirementEntry
from navfmu.errors import NavfmuError, nearest
from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.program import Program
from navfmu.fmi.seconds import seconds
from navfmu.fmi.values import quantity
from navfmu.system.system import System

Error = Callable[..., NavfmuError]  # of a sentence and the place of an entry in the requirement's table


def requirement_of(
    entry: RequirementEntry,
    systems: Mapping[str, System],
    cases: Sequence[str],
    stop: float,
    error: Error,
    faults: Collection[str] | None = None,
) -> Requirement:
    """The requirement of an entry. ``systems`` are by variant; ``stop`` (s) is the end of the runs.

    ``faults`` are the ids of those that it may name; None: any.
    """
    for key, known in (("variants", list(systems)), ("cases", cases)):
        for number, name in enumerate(getattr(entry, key) or ()):
            if name not in known:
                raise error(f"'{key}': there is no '{name}' in this campaign{nearest(name, known)}", key, number)
    kinds = [kind for kind in QUESTIONS if getattr(entry, kind) is not None]
    if len(kinds) != 1:
        every = ", ".join(f"'{kind}'" for kind in QUESTIONS)
        raise error(f"expected one of {every}" + (", and no more" if kinds else ""), kinds[1] if kinds else "id")
    (kind,) = kinds
    of_faults = QUESTIONS[kind].of_faults
    _check_entries(entry, kind, of_faults, error)
    asked = {name: systems[name] for name in entry.variants or systems}
    program = _program(entry, kind, asked, error, faults)
    bounds = _bounds(entry, kind, program, next(iter(asked.values())), error)
    if not program.boolean and bounds == {"at_most": None, "at_least": None}:
        raise error("this requirement has neither 'at_most' nor 'at_least'", "id")
    if None not in bounds.values() and bounds["at_least"] > bounds["at_most"]:
        raise error("'at_least' is above 'at_most': nothing can hold this requirement", "at_least")
    if entry.percent is not None and entry.quantile is not None:
        raise error("'percent' and 'quantile' exclude each other", "quantile")
    if entry.quantile is not None and "runs" in entry.model_fields_set:
        raise error("'runs' goes with 'percent', not with 'quantile', which is a share of the runs itself", "runs")
    if entry.quantile is not None and entry.expect == "violated":
        raise error("'expect' = 'violated' goes with 'percent', not with 'quantile'", "expect")
    if entry.quantile is not None and (entry.when or entry.tolerance or kind != "signal"):
        key = "when" if entry.when else "tolerance" if entry.tolerance else kind
        raise error(f"'{key}' is asked within a run, and 'quantile' of all runs together", key)
    if entry.when:
        _compiled(entry.when, asked, True, "when", error, faults)
    tolerance = _seconds(entry.tolerance, "tolerance", error)
    if not 0 <= tolerance < math.inf:
        raise error(f"'tolerance' is {entry.tolerance!r}, expected a time in s, 0 or more", "tolerance")
    begin, end = _window(entry, stop, error)
    return Requirement(
        id=entry.id,
        signal=getattr(entry, kind),
        most=bounds["at_most"],
        least=bounds["at_least"],
        unit="s" if of_faults else "" if program.boolean or program.unit is None else program.unit.name,
        percent=None if entry.quantile is not None else 100.0 if entry.percent is None else entry.percent,
        quantile=entry.quantile,
        runs=entry.runs,
        start=begin,
        end=end,
        program=program,
        when=entry.when,
        tolerance=tolerance,
        kind=kind,
        fault=entry.fault or "",
        expect_violated=entry.expect == "violated",
        severity=entry.severity,
        description=entry.description,
        variants=None if entry.variants is None else tuple(entry.variants),
        cases=None if entry.cases is None else tuple(entry.cases),
    )


def _check_entries(entry: RequirementEntry, kind: str, of_faults: bool, error: Error) -> None:
    """Entries that belong to faults, and those that do not."""
    own = ("fault", "within")
    for key in own if not of_faults else ():
        if getattr(entry, key) is not None:
            raise error(f"'{key}' goes with 'detects' or 'recovers', not with '{kind}'", key)
    if not of_faults:
        return
    for key in ("at_most", "at_least", "when", "tolerance", "percent", "quantile", "begin", "end"):
        if key in entry.model_fields_set:
            name = RequirementEntry.model_fields[key].alias or key
            raise error(f"'{name}' does not go with '{kind}', of which 'within' says how long it may take", name)
    if entry.within is None:
        raise error(f"'{kind}' needs 'within' beside it: how long it may take", kind)


def _program(
    entry: RequirementEntry, kind: str, systems: Mapping[str, System], error: Error, faults: Collection[str] | None
) -> Program:
    """The program of what is asked: the same unit in every variant."""
    if entry.fault is not None and faults is not None and entry.fault not in faults:
        have = f" (faults: {', '.join(sorted(faults))})" if faults else ""
        raise error(f"there is no fault '{entry.fault}'{nearest(entry.fault, faults)}{have}", "fault")
    if kind != "signal":
        return next(iter(_compiled(getattr(entry, kind), systems, True, kind, error, faults).values()))
    found = _compiled(str(entry.signal), systems, None, "signal", error, faults)
    first, *others = found
    for other in others:
        a, b = (found[name].unit.name if found[name].unit else "no unit" for name in (first, other))
        if a != b:
            raise error(
                f"'{entry.signal}' has {b} in variant '{other}' and {a} in '{first}': one bound cannot hold both",
                "signal",
            )
    return found[first]


def _compiled(
    text: str,
    systems: Mapping[str, System],
    boolean: bool | None,
    key: str,
    error: Error,
    faults: Collection[str] | None,
) -> dict[str, Program]:
    """The program of an expression in each variant."""
    found = {}
    for variant, system in systems.items():
        try:
            about = {name: fmu.description for name, fmu in system.fmus.items()}
            found[variant] = compile_expression(text, about, faults, system.phases, boolean=boolean)
        except NavfmuError as problem:
            raise error(f"variant '{variant}': {problem}", key) from None
    return found


def _bounds(
    entry: RequirementEntry, kind: str, program: Program, system: System, error: Error
) -> dict[str, float | None]:
    """The bounds, in the unit of the program."""
    if entry.within is not None:
        within = _seconds(entry.within, "within", error)
        if not 0 <= within < math.inf:
            raise error(f"'within' is {entry.within!r}, expected a time in s, 0 or more", "within")
        return {"at_most": within, "at_least": None}
    if kind == "events":
        if entry.at_least is not None:
            raise error("of events there is an 'at_most' only", "at_least")
        count = 0 if entry.at_most is None else entry.at_most
        if isinstance(count, str) or count != int(count) or count < 0:
            raise error(f"'at_most' is {count!r}, expected a number of events: 0, 1, 2 ...", "at_most")
        return {"at_most": float(count), "at_least": None}
    bounds: dict[str, float | None] = {}
    for key in ("at_most", "at_least"):
        value = getattr(entry, key)
        try:
            number = None if value is None else bound(program, system, value, f"'{key}' = {value}")
        except NavfmuError as problem:
            raise error(str(problem), key) from None
        if number is not None and not math.isfinite(number):
            raise error(f"'{key}' is {value}, expected a finite number", key)
        bounds[key] = number
    return bounds


def bound(program: Program, system: System, value: float | str, what: str) -> float:
    """A bound on the value of a program, in its unit: a number, or a text such as "0.5 nmi"."""
    (source, *more) = program.sources or (None,)
    if not more and source is not None and str(source) == program.text.strip().strip("'"):  # nothing but a signal
        description = system.fmus[source.signal.component].description
        return float(quantity(description, source.signal.variable, value, what))
    if not isinstance(value, str):
        return float(value)
    constant = compile_expression(value, {n: f.description for n, f in system.fmus.items()}, boolean=False)
    if constant.sources:
        raise NavfmuError(f"{what}: expected a number, with a unit or without")
    if None not in (program.unit, constant.unit) and not constant.unit.agrees(program.unit):  # type: ignore[union-attr]
        kind = "a truth value" if program.boolean else f"in {program.unit.name}"  # type: ignore[union-attr]
        raise NavfmuError(f"{what}: '{program.text}' is {kind}")
    return float(constant.value([]))


def _seconds(value: float | str, key: str, error: Error) -> float:
    try:
        return seconds(value, f"'{key}'")
    except NavfmuError as problem:
        raise error(str(problem), key) from None


def _window(entry: RequirementEntry, stop: float, error: Error) -> tuple[float, float]:
    """From when and to when it is asked (s); what is left of it in a run is not empty."""
    begin = _seconds(entry.begin, "from", error)
    end = math.inf if entry.end is None else _seconds(entry.end, "to", error)
    if not 0 <= begin < min(end, stop):
        raise error(f"'from' is {begin} s, expected a time from 0 to before {min(end, stop):g} s", "from")
    return begin, end
