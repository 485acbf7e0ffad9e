"""Values for variables of an FMU: one for each element of an array, texts with units, types and ranges."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from numbers import Real
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.files.characters import illegal, shown
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.names import group, hint, is_element, short
from navfmu.fmi.seconds import UNITS, is_finite
from navfmu.fmi.units import COMMON, Unit, alike, conversion, per_second

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf|nan)\s*(.*?)\s*$", re.IGNORECASE)
_TRUE, _FALSE = {"true", "1", "yes", "on"}, {"false", "0", "no", "off"}


def expand(description: Description, values: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Checked values by scalar variable: ``{"x": [1, 2]}`` becomes ``{"x[1]": 1.0, "x[2]": 2.0}``.

    A single value for an array sets all its elements. Texts may carry a unit: ``"0.5 deg/h"``.
    """
    flat: dict[str, Any] = {}
    for name, value in values.items():
        found = group(description.by_name, name)
        if not found:
            close = hint(name, short(v.name for v in description.variables if v.settable))
            raise NavfmuError(f"{where}: {description.model_name} has no parameter '{name}'{close}")
        if not all(map(is_element, found)):
            members_ = ", ".join(found.values())
            raise NavfmuError(f"{where}: '{name}' is a bundle; name one of its members: {members_}")
        own = description.by_name.get(name)
        is_text = own is not None and own.type == "String" and isinstance(value, str)  # "[a]" is no list
        values_ = [value] if is_text else spread(value, len(found), f"{where}: '{name}'")
        for variable_name, element in zip(found.values(), values_, strict=True):
            variable = description.by_name[variable_name]
            flat[variable_name] = checked(description, variable, element, where)
    return flat


def checked(description: Description, variable: Variable, value: Any, where: str) -> float | int | bool | str:
    """One value in the variable's own type and unit, or a sentence why it cannot be."""
    if not variable.settable:
        raise NavfmuError(
            f"{where}: '{variable.name}' cannot be set: it is {variable.causality}, {variable.variability}; "
            "expected a parameter or an input"
        )
    number = typed(description, variable, value, f"{where}: '{variable.name}' = {value}")
    if variable.type in ("Real", "Integer"):
        check_range(description, variable, number, where)
    return number


def typed(description: Description, variable: Variable, value: Any, what: str) -> float | int | bool | str:
    """A value in the variable's own type and unit, whatever its range; ``what`` begins the sentence if it is none."""
    if variable.type == "String":
        if not isinstance(value, str):
            raise NavfmuError(f"{what}: expected a text")
        if wrong := illegal(value):
            raise NavfmuError(f"{shown(what)}: the text has the character {wrong}; expected no control characters")
        return value
    if variable.type == "Boolean":
        return _boolean(value, what)
    items = description.items(variable)
    if isinstance(value, str) and items:
        for name in (value, value.strip()):
            if name in items:
                return items[name]
        if not is_number(value):
            raise NavfmuError(f"{what}: expected one of {', '.join(items)}{nearest(value, items)}")
    number = quantity(description, variable, value, what)
    if variable.type == "Integer":
        if not math.isfinite(number) or number != math.floor(number) or not -(2**31) <= number < 2**31:
            raise NavfmuError(f"{what}: expected an integer from -2147483648 to 2147483647")
        return int(number)
    return float(number)


def number_and_unit(text: str) -> tuple[float, str] | None:
    """The number and the unit of a text such as "0.5 nmi"; the unit may be empty. None where it is no number."""
    found = _NUMBER.match(text)
    return None if found is None else (float(found[1]), found[2])


def is_number(text: str) -> bool:
    """Whether a text is a number, with a unit or without."""
    return _NUMBER.match(text) is not None


def check_range(description: Description, variable: Variable, value: float, where: str) -> None:
    """Refuse a value outside the range that the model description gives, or that no item of an enumeration has."""
    items = description.items(variable)
    if items and value not in items.values():
        known = ", ".join(f"{name} = {number}" for name, number in items.items())
        raise NavfmuError(
            f"{where}: '{variable.name}' = {value} is no value of its enumeration: expected one of {known}"
        )
    unit = f" {variable.unit}" if variable.unit and variable.unit != "1" else ""
    low, high = variable.min, variable.max
    if (low is None or value >= low) and (high is None or value <= high) and math.isfinite(value):
        return
    if not math.isfinite(value):
        raise NavfmuError(f"{where}: '{variable.name}' = {value:g}{unit} is out of range: expected a finite number")
    if low is not None and high is not None:
        allowed = f"expected {low:.12g} to {high:.12g}{unit}"
    elif low is not None:
        allowed = f"expected at least {low:.12g}{unit}"
    else:
        allowed = f"expected at most {high:.12g}{unit}"
    raise NavfmuError(f"{where}: '{variable.name}' = {value:.12g}{unit} is out of range: {allowed}")


def spread(value: Any, count: int, what: str) -> list[Any]:
    """A value for each of ``count`` elements: those of a list or "[1, 2]", or the same for all."""
    if isinstance(value, str):
        text = value.strip()
        if text.startswith("[") and text.endswith("]"):
            parts = text[1:-1].replace("[", "").replace("]", "").split(",")
            value = [part.strip() for part in parts if part.strip()]
        else:
            return [value] * count
    elif hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if not isinstance(value, (list, tuple)):
        return [value] * count
    flat = list(_flatten(value))
    if len(flat) != count:
        raise NavfmuError(f"{what}: {len(flat)} values given, expected {count}")
    return flat


def _flatten(values: Iterable[Any]) -> Iterable[Any]:
    for value in values:
        if isinstance(value, (list, tuple)):
            yield from _flatten(value)
        elif hasattr(value, "tolist") and getattr(value, "ndim", 0):
            yield from _flatten(value.tolist())
        else:
            yield value


def _boolean(value: Any, what: str) -> bool:
    text = str(value).strip().lower()
    if text in _TRUE or value is True:
        return True
    if text in _FALSE or value is False:
        return False
    raise NavfmuError(f"{what}: expected true or false")


def quantity(description: Description, variable: Variable, value: Any, what: str, *, difference: bool = False) -> float:
    """A number, or a text such as "0.5 nmi", in the variable's own unit; ``what`` begins the sentence if it is none.

    A ``difference`` between two values has no origin: 1 degC is then 1 K. Values of a ``relative`` variable are such.
    """
    if isinstance(value, str):
        match = _NUMBER.match(value)
        if match is None:
            raise NavfmuError(f"{what}: expected a number{_with_unit(variable)}")
        number, unit = float(match[1]), match[2]
        return _in_own_unit(description, variable, number, unit, what, difference) if unit else number
    if isinstance(value, bool) or not isinstance(value, Real) or (isinstance(value, int) and not is_finite(value)):
        raise NavfmuError(f"{what}: expected a number{_with_unit(variable)}")
    return value if isinstance(value, int) else float(value)


def rate(description: Description, variable: Variable, value: Any, what: str) -> float:
    """A change of the variable in its own unit per s: a number, or a text such as "3 ft/min", "1 kn" or "1 deg/h/s"."""
    match = _NUMBER.match(value) if isinstance(value, str) else None
    if match is None or not match[2]:
        return quantity(description, variable, value, what, difference=True)
    unit, _, time = (part.strip() for part in match[2].rpartition("/"))
    if time in UNITS:
        return quantity(description, variable, f"{match[1]} {unit}", what, difference=True) / UNITS[time]
    own = description.units.get(variable.unit or "")
    change = None if own is None else per_second(own)
    return _converted(description, float(match[1]), match[2], change, [change.name] if change else [], what, True)


def _with_unit(variable: Variable) -> str:
    return (
        f", for example '1.5 {variable.display_unit or variable.unit}'" if variable.unit not in (None, "", "1") else ""
    )


def _in_own_unit(
    description: Description, variable: Variable, number: float, unit: str, what: str, difference: bool
) -> float:
    if unit == variable.unit:
        return number
    difference = difference or variable.relative
    display = description.display_units.get(variable.unit or "", {})
    if unit in display:
        factor, offset = display[unit]
        return (number if difference else number - offset) / factor
    known = [name for name in (variable.unit, *display) if name]
    return _converted(description, number, unit, description.units.get(variable.unit or ""), known, what, difference)


def _converted(
    description: Description, number: float, unit: str, own: Unit | None, known: list[str], what: str, difference: bool
) -> float:
    """A number in the unit ``own``; the sentence why it cannot be ends with the units that would do."""
    if own is None:
        raise NavfmuError(f"{what}: expected a number without a unit, as the variable has none")
    given = description.units.get(unit) or COMMON.get(unit)
    fitting = list(dict.fromkeys([*known, *(alike(own) if own.exponents is not None else ())]))
    expected = f"expected {' or '.join(filter(None, (', '.join(fitting[:-1]), *fitting[-1:])))}"
    if given is None:
        raise NavfmuError(f"{what}: unit '{unit}' is not known here; {expected}{nearest(unit, fitting)}")
    try:
        factor, offset = conversion(given, own, what, difference=difference)
    except NavfmuError as problem:
        raise NavfmuError(f"{problem}; {expected}") from None
    return factor * number + offset
