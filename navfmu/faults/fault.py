"""One fault."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.faults.checks import SORTS
from navfmu.faults.types import COMPONENT, TIMING, TYPES
from navfmu.fmi.seconds import seconds, short

PARAMETERS = {parameter.name: parameter for kind in TYPES.values() for parameter in kind.parameters}
TIMES = {timing.parameter.name: timing.parameter for timing in TIMING}
COMMON = ("id", "fmea", "target", "type", "start", "duration", "description")


@dataclass(frozen=True, init=False)
class Fault:
    """A fault during start <= t < start + duration (s), counted in communication points.

        Fault("gps_lost", "gps.jammed", "input", start=300.0)
        Fault("icing", ["air_data.air.airspeed", "air_data.air.altitude"], "drift", start="5 min", rate=[0.1, 0.5])

    A target is "component.signal", "component.array" (all its elements) or "component.bundle"; several
    targets fail together, of one cause. Times are in s or texts such as "5 min". Parameters of the type (``TYPES``) are
    given by keyword, or as ``parameters``, in the unit of the target or as texts such as "0.5 nmi"; a list gives one
    value for each element of all targets.
    """

    id: str
    target: str | tuple[str, ...]
    type: str
    start: float = 0.0
    duration: float = math.inf
    parameters: dict[str, Any] = field(default_factory=dict)
    fmea: str = ""
    description: str = ""
    where: str = ""  # "faults.toml, line 12", for messages
    file: str = ""  # as the command line takes it, where the fault is from one
    lines: Mapping[str, str] = field(default_factory=dict, compare=False, repr=False)  # by entry, as ``where``

    def __init__(
        self,
        id: str,
        target: str | Sequence[str],
        type: str,
        start: float | str = 0.0,
        duration: float | str = math.inf,
        parameters: Mapping[str, Any] | None = None,
        fmea: str = "",
        description: str = "",
        where: str = "",
        file: str = "",
        lines: Mapping[str, str] | None = None,
        **given: Any,
    ) -> None:
        def keep(**values: Any) -> None:
            for name, value in values.items():
                object.__setattr__(self, name, value)

        keep(id=id, target=target, type=type, fmea=fmea, description=description)
        keep(where=where, file=file, lines=lines or {})
        for name in given:
            if name in (parameters or {}):
                raise self.error(f"'{name}' is given twice", name)
        keep(parameters={**(parameters or {}), **given})
        if not id or not isinstance(id, str):
            raise self.error("'id' must be a text that is not empty", "id")
        if not isinstance(type, str) or type not in TYPES:
            known = ", ".join(TYPES)
            raise self.error(f"unknown type {short(type)}{nearest(str(type), TYPES)} (types: {known})", "type")
        keep(target=self._checked_target(target))
        keep(start=self._time("start", start), duration=self._time("duration", duration))
        if not 0 <= self.start < math.inf:
            raise self.error(f"'start' must be a time in s, 0 or later, not {start!r}", "start")
        if not self.duration > 0:
            raise self.error(f"'duration' must be a positive time in s, not {duration!r}", "duration")
        self._check_parameters()

    def _checked_target(self, target: Any) -> str | tuple[str, ...]:
        whole = TYPES[self.type].places == (COMPONENT,)
        several = not isinstance(target, str) and isinstance(target, Sequence)
        if several and not target:
            raise self.error("'target' is an empty list", "target")
        for number, name in enumerate(target if several else [target]):
            if whole and (not isinstance(name, str) or "." in name):
                raise self.error(f"'target' must be the name of a component, not {short(name)}", "target")
            if not whole and (not isinstance(name, str) or "." not in name):
                raise self.error(f"'target' must be written component.signal, not {short(name)}", "target")
            if several and name in target[:number]:
                raise self.error(f"'target' has '{name}' twice", "target")
        return (tuple(target) if len(target) > 1 else target[0]) if several else target

    def _time(self, name: str, value: Any) -> float:
        return self._checked(lambda name, value: seconds(value, f"'{name}'"), name, value)

    def _check_parameters(self) -> None:
        kind = TYPES[self.type]
        own = {parameter.name: parameter for parameter in kind.parameters}
        for name, value in self.parameters.items():
            if name not in own | TIMES:
                takes = ", ".join(own) or "no parameters"
                hint = "" if name in PARAMETERS else nearest(name, (*own, *TIMES, *COMMON))
                raise self.error(f"type '{self.type}' has no parameter '{name}'{hint} (it takes {takes})", name)
            check = SORTS.get((own | TIMES)[name].sort)
            if check is not None:
                self.parameters[name] = self._checked(check, name, value)
        for name in kind.required:
            if name not in self.parameters:
                raise self.error(f"type '{self.type}' needs the parameter '{name}'", "type")
        for timing in TIMING:
            name = timing.parameter.name
            if name not in self.parameters:
                continue
            if timing.needs and not set(timing.needs) & set(self.parameters):
                needed = " or ".join(f"'{other}'" for other in timing.needs)
                raise self.error(f"'{name}' needs {needed} beside it", name)
            for other in timing.excludes:
                if other in self.parameters:
                    raise self.error(f"'{name}' and '{other}' exclude each other", other)

    def _checked(self, check: Callable[[str, Any], Any], name: str, value: Any) -> Any:
        try:
            return check(name, value)
        except NavfmuError as error:
            raise self.error(str(error), name) from None

    @property
    def targets(self) -> tuple[str, ...]:
        """What it acts on, one or several."""
        return (self.target,) if isinstance(self.target, str) else self.target

    @property
    def condition(self) -> str:
        """The expression for which it waits, or while which it acts; empty: it has none."""
        return self.parameters.get("when") or self.parameters.get("during") or ""

    @property
    def is_random(self) -> bool:
        """Whether it depends on the seed of the run: what it does, or when."""
        return bool({TYPES[self.type].draws, "mttf"} & set(self.parameters))

    def describe(self) -> dict[str, Any]:
        """The fault as plain data; what is not limited (its duration) or empty is left out."""
        target = self.target if isinstance(self.target, str) else list(self.target)
        entries: dict[str, Any] = {"id": self.id, "target": target, "type": self.type, "start": _plain(self.start)}
        if self.duration != math.inf:
            entries["duration"] = _plain(self.duration)
        for name in ("fmea", "description", "file"):
            if getattr(self, name):
                entries[name] = getattr(self, name)
        return entries | {key: _plain(value) for key, value in self.parameters.items()}

    @classmethod
    def of(cls, description: Mapping[str, Any]) -> Fault:
        """The fault of a description."""
        own = {name: description[name] for name in (*COMMON, "file") if name in description}
        return cls(**own, parameters={name: value for name, value in description.items() if name not in own})

    def inline(self) -> str:
        """The fault as the option ``--fault`` takes it: the inside of a TOML table."""
        return ", ".join(f"{key} = {_toml(value)}" for key, value in self.describe().items() if key != "file")

    def error(self, sentence: str, key: str = "") -> FaultError:
        """The sentence with the fault's id and place in its file."""
        where = self.lines.get(key, self.where)
        return FaultError(self.id if isinstance(self.id, str) else "", where, sentence, key)


class FaultError(NavfmuError):
    """A fault that cannot be; remembers the key at which the file went wrong."""

    def __init__(self, fault: str, where: str, sentence: str, key: str) -> None:
        name = f"fault '{fault}'" if fault else "a fault"
        super().__init__(f"{where}: {name}: {sentence}" if where else f"{name}: {sentence}")
        self.fault, self.sentence, self.key = fault, sentence, key


def _plain(value: Any) -> Any:
    """A value without NumPy: lists and numbers of Python."""
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_toml(item) for item in value)}]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f") if isinstance(value, str) else repr(value)
