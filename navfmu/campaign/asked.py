"""A requirement of a campaign file, checked against the systems that it is asked of."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from navfmu.campaign.requirement import Requirement
from navfmu.campaign.schema import RequirementEntry
from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.names import split
from navfmu.fmi.seconds import seconds
from navfmu.fmi.values import quantity
from navfmu.system.system import System

Error = Callable[..., NavfmuError]  # of a sentence and the place of an entry in the requirement's table


def requirement_of(
    entry: RequirementEntry, systems: Mapping[str, System], cases: Sequence[str], stop: float, error: Error
) -> Requirement:
    """The requirement of an entry. ``systems`` are by variant; ``stop`` (s) is the end of the runs."""
    for key, known in (("variants", list(systems)), ("cases", cases)):
        for number, name in enumerate(getattr(entry, key) or ()):
            if name not in known:
                raise error(f"'{key}': there is no '{name}' in this campaign{nearest(name, known)}", key, number)
    unit, bounds = _bounds(entry, {name: systems[name] for name in entry.variants or systems}, error)
    if bounds == {"at_most": None, "at_least": None}:
        raise error("this requirement has neither 'at_most' nor 'at_least'", "id")
    if None not in bounds.values() and bounds["at_least"] > bounds["at_most"]:
        raise error("'at_least' is above 'at_most': nothing can hold this requirement", "at_least")
    if entry.percent is not None and entry.quantile is not None:
        raise error("'percent' and 'quantile' exclude each other", "quantile")
    if entry.quantile is not None and "runs" in entry.model_fields_set:
        raise error("'runs' goes with 'percent', not with 'quantile', which is a share of the runs itself", "runs")
    if entry.quantile is not None and entry.expect == "violated":
        raise error("'expect' = 'violated' goes with 'percent', not with 'quantile'", "expect")
    begin, end = _window(entry, stop, error)
    return Requirement(
        id=entry.id,
        signal=entry.signal,
        most=bounds["at_most"],
        least=bounds["at_least"],
        unit=unit,
        percent=None if entry.quantile is not None else 100.0 if entry.percent is None else entry.percent,
        quantile=entry.quantile,
        runs=entry.runs,
        start=begin,
        end=end,
        expect_violated=entry.expect == "violated",
        severity=entry.severity,
        description=entry.description,
        variants=None if entry.variants is None else tuple(entry.variants),
        cases=None if entry.cases is None else tuple(entry.cases),
    )


def _bounds(
    entry: RequirementEntry, systems: Mapping[str, System], error: Error
) -> tuple[str, dict[str, float | None]]:
    """The signal's unit, and the bounds in it: the same in every variant."""
    found: dict[str, str] = {}
    for variant, system in systems.items():
        try:
            variable = system.variable(entry.signal.removesuffix("@true"))
        except NavfmuError as problem:
            raise error(f"variant '{variant}': {problem}", "signal") from None
        if variable.causality != "output" or variable.type == "String":
            kind = f"{variable.causality} of type {variable.type}"
            raise error(f"variant '{variant}': '{entry.signal}' is {kind}, expected an output", "signal")
        found[variant] = variable.unit or ""
    first, *others = found
    for other in others:
        if found[other] != found[first]:
            units = f"{found[other] or 'no unit'} in variant '{other}' and {found[first] or 'no unit'} in '{first}'"
            raise error(f"'{entry.signal}' has {units}: one bound cannot hold both", "signal")
    description = system.fmus[split(entry.signal)[0]].description
    bounds: dict[str, float | None] = {}
    for key in ("at_most", "at_least"):
        value = getattr(entry, key)
        try:
            number = None if value is None else float(quantity(description, variable, value, f"'{key}' = {value}"))
        except NavfmuError as problem:
            raise error(str(problem), key) from None
        if number is not None and not math.isfinite(number):
            raise error(f"'{key}' is {value}, expected a finite number", key)
        bounds[key] = number
    return found[first], bounds


def _window(entry: RequirementEntry, stop: float, error: Error) -> tuple[float, float]:
    """From when and to when it is asked (s); what is left of it in a run is not empty."""
    times = {}
    for key, value in (("from", entry.begin), ("to", math.inf if entry.end is None else entry.end)):
        try:
            times[key] = seconds(value, f"'{key}'")
        except NavfmuError as problem:
            raise error(str(problem), key) from None
    begin, end = times["from"], times["to"]
    if not 0 <= begin < min(end, stop):
        raise error(f"'from' is {begin} s, expected a time from 0 to before {min(end, stop):g} s", "from")
    return begin, end
