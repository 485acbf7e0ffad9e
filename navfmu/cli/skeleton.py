"""The beginning of a fault file: each type of fault that one target supports, ready to be run and to be changed."""

from __future__ import annotations

import json
from typing import Any

from navfmu.engine.catalogue import Target, others
from navfmu.faults.types import TIMING, TYPES, Parameter


def skeleton(target: Target) -> str:
    """A fault file with one fault for each type that a target supports; what may be left out is a comment."""
    about = ", ".join(filter(None, (target.what, target.unit)))
    lines = [f"# {target.name}: {about}", *([f"# {target.description}"] if target.description else [])]
    lines += ["#", "# Any of these may come and go:"]
    lines += [f"#   {timing.parameter.name}: {timing.parameter.words}" for timing in TIMING]
    for name in target.types:
        kind = TYPES[name]
        lines += [
            "",
            f"# {kind.effect}",
            "[[fault]]",
            f'id = "{_id(target.name)}_{name}"',
            f"target = {json.dumps(target.name)}",
            f'type = "{name}"',
            'start = "10 s"',
            '# duration = "1 min"  # default: to the end',
        ]
        lines += [_line(parameter, target) for parameter in kind.parameters]
    return "\n".join(lines) + "\n"


def _id(name: str) -> str:
    return "".join(sign if sign.isalnum() else "_" for sign in name).strip("_")


def _line(parameter: Parameter, target: Target) -> str:
    value = NAMED.get(parameter.name, EXAMPLES[parameter.sort])(target)
    needed = parameter.required or parameter.sort == "setting" or parameter.name == "low"
    return f"{'' if needed else '# '}{parameter.name} = {value}  # {parameter.words}"


def _quantity(number: str, target: Target, more: str = "") -> str:
    """A number with the unit of the target, where it has one."""
    unit = target.unit
    return json.dumps(f"{number} {unit}{more}", ensure_ascii=False) if unit not in ("", "1") else number


def _setting(target: Target) -> str:
    """A value that differs from the start value and is in the range."""
    variable = target.elements[0].variable
    if variable.type == "Boolean":
        return "false" if variable.start else "true"
    start = variable.start or 0
    low = -1e9 if variable.min is None else variable.min
    high = 1e9 if variable.max is None else variable.max
    candidates = (start + 1, start * 2, start / 2, start - 1, high, low)
    value = next((v for v in candidates if low <= v <= high and v != start), start)
    return _quantity(repr(int(value)), target) if variable.type == "Integer" else _quantity(f"{value:.9g}", target)


def _order(target: Target) -> str:
    places = list(range(1, len(target.elements) + 1))
    return repr([places[1], places[0], *places[2:]])


NAMED: dict[str, Any] = {"high": lambda target: _quantity("2.0", target)}  # as EXAMPLES, by name
EXAMPLES: dict[str, Any] = {  # by the sort of a parameter, a value that can be run
    "value": lambda target: _quantity("1.0" if target.elements[0].variable.type == "Real" else "1", target),
    "setting": _setting,
    "difference": lambda target: _quantity("1.0", target),
    "spread": lambda target: _quantity("1.0", target),
    "resolution": lambda target: _quantity("1.0", target),
    "rate": lambda target: _quantity("0.1", target, "/s"),
    "factor": lambda target: "1.1",
    "time": lambda target: '"1 s"',
    "delay": lambda target: '"1 s"',
    "stream": lambda target: "1",
    "unit": lambda target: json.dumps(others(target.elements)[0]),
    "order": _order,
    "not finite": lambda target: '"nan"',
}
