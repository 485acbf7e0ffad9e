"""What a name stands for.

In an FMU: a variable ("tau"), all elements of an array ("x" for "x[1]", "x[2]" ...), all members of a bundle ("reading"
for "reading.rate[1]", "reading.valid" ...). Of an array of bundles "station" stands for all, "station[1]" for one, and
"station.range" for a member of all ("station[1].range", "station[2].range" ...). In a system the component's name comes
first ("imu.reading"), alone it stands for all outputs of the component, and a pattern ("imu.*", "*.lost") for the
outputs whose names match.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.description import Description, Variable


@dataclass(frozen=True, slots=True)
class Signal:
    """A variable of a component of a system."""

    component: str
    variable: Variable

    @property
    def key(self) -> tuple[str, str]:
        """Names of component and variable."""
        return self.component, self.variable.name

    def __str__(self) -> str:
        return f"{self.component}.{self.variable.name}"


TRUE = "@true"  # at the end of an output's name: its value without faults


def split(name: str) -> tuple[str, str]:
    """Component and variable of "imu.reading.rate[1]": ("imu", "reading.rate[1]")."""
    component, _, variable = name.partition(".")
    return component, variable


_SUBSCRIPT = r"\[\d+(?:, ?\d+)*\]"  # the one place that knows how FMI 2.0 writes indices


def array(name: str) -> str:
    """The array of an element: "reading.rate" of "reading.rate[1]"; other names stay as they are."""
    return re.sub(f"({_SUBSCRIPT})+$", "", name)


def subscript(name: str) -> tuple[int, ...]:
    """The indices of an element, from 1: (1, 2) of "map[1,2]"; none of other names."""
    return tuple(map(int, re.findall(r"\d+", name[len(array(name)) :])))


def folded(names: Iterable[str]) -> list[str]:
    """Names for people: one for all elements of an array, and one for a member of all bundles of an array."""
    groups: dict[str, dict[tuple[int, ...], str]] = {}
    for name in map(array, names):
        pattern = re.sub(_SUBSCRIPT, lambda at: re.sub(r"\d+", "", at[0]), name)
        groups.setdefault(pattern, {})[_numbers(name)] = name
    return [text for group in groups.values() for text in _ranges(group)]


def _numbers(name: str) -> tuple[int, ...]:
    """All indices in a name: (2, 1) of "station[2].bias[1]"."""
    return tuple(int(number) for part in re.findall(_SUBSCRIPT, name) for number in re.findall(r"\d+", part))


def _ranges(group: Mapping[tuple[int, ...], str]) -> list[str]:
    """Names that differ in indices: from the first to the last where all between are there, else runs of them."""
    ends = [(min(numbers), max(numbers)) for numbers in zip(*group, strict=True)]
    if math.prod(last - first + 1 for first, last in ends) == len(group):
        return [_between(group[tuple(first for first, _ in ends)], group[tuple(last for _, last in ends)])]
    runs: list[list[tuple[int, ...]]] = []
    for numbers in sorted(group):
        if runs and runs[-1][-1] == (*numbers[:-1], numbers[-1] - 1):
            runs[-1].append(numbers)
        else:
            runs.append([numbers])
    return [_between(group[run[0]], group[run[-1]]) for run in runs]


def _between(first: str, last: str) -> str:
    """From the first to the last name of those that differ in indices: "station[1…5].range"."""
    ends = iter(re.findall(_SUBSCRIPT, last))
    return re.sub(_SUBSCRIPT, lambda at: at[0] if (end := next(ends)) == at[0] else f"{at[0][:-1]}…{end[1:]}", first)


def bundle(name: str) -> str:
    """The bundle of a member: "reading" of "reading.rate[1]"; empty if there is none."""
    return name.rpartition(".")[0]


def hint(name: str, known: Iterable[str]) -> str:
    """What to write instead of a name that is not known: from where to where indices go, or the nearest name."""
    known = list(known)
    wanted = re.sub(_SUBSCRIPT, "[]", name)
    ranges = [other for other in known if "[" in wanted and re.sub(_SUBSCRIPT, "[]", other) == wanted]
    if not ranges:
        return nearest(name, known)
    first, last = (end(ranges, key=_numbers) for end in (min, max))
    return f"; indices go from '{first}' to '{last}'"


# ---- in an FMU -------------------------------------------------------------------------------------------------------


def group(names: Collection[str], name: str) -> dict[str, str]:
    """Which of ``names`` a name stands for, by suffix: itself (""), elements ("[1]") or members (".valid").

    "station.range" stands for a member of all bundles of an array, "station[1].range" by the suffix "[1]".
    """
    if name in names:
        return {"": name}
    found = [candidate for candidate in names if candidate.startswith((f"{name}[", f"{name}."))]
    if found or "." not in name:
        return {member[len(name) :]: member for member in found}
    of_all = {_indices_last(candidate): candidate for candidate in names if "]." in candidate}
    return {way[len(name) :]: full for way, full in of_all.items() if way.startswith((f"{name}[", f"{name}."))}


def _indices_last(name: str) -> str:
    """A member of an array of bundles as an element of an array: "station.bias[2][1]" for "station[2].bias[1]"."""
    *bundles, member = re.split(r"(?<=\])\.", name)
    indices = "".join(bundle[len(array(bundle)) :] for bundle in bundles)
    plain = ".".join([*map(array, bundles), array(member)])
    return plain + indices + member[len(array(member)) :]


def is_element(suffix: str) -> bool:
    """Whether a suffix is that of an element ("[1]") or none, and not that of a member of a bundle (".valid")."""
    return re.fullmatch(f"({_SUBSCRIPT})*", suffix) is not None


def elements(description: Description, name: str) -> list[Variable]:
    """The variable or the elements of the array of this name; empty if there is none."""
    found = group(description.by_name, name)
    return [description.by_name[full] for suffix, full in found.items() if is_element(suffix)]


def members(description: Description, name: str, causalities: set[str], where: str) -> dict[str, Variable]:
    """The variables that ``name`` stands for and that have one of the causalities, by suffix."""
    chosen = {suffix: description.by_name[full] for suffix, full in group(description.by_name, name).items()}
    if not chosen:
        close = hint(name, short(v.name for v in description.with_causality(*causalities)))
        raise NavfmuError(f"{where}: {description.model_name} has no variable '{name}'{close}")
    right = {suffix: variable for suffix, variable in chosen.items() if variable.causality in causalities}
    if not right:
        is_ = next(iter(chosen.values())).causality
        raise NavfmuError(
            f"{where}: '{name}' of {description.model_name} is {is_}, expected {' or '.join(sorted(causalities))}"
        )
    return right


def bundles(description: Description) -> list[str]:
    """The output bundles: those with "valid" and "sequence"."""
    outputs = {variable.name for variable in description.with_causality("output")}
    return sorted(bundle(name) for name in outputs if f"{bundle(name)}.sequence" in outputs and name.endswith(".valid"))


def meant(bundles: Iterable[str], name: str) -> list[str]:
    """Which of these bundles a name stands for: that bundle, or all of an array of bundles."""
    return [bundle for bundle in bundles if name in (bundle, array(bundle))]


def counters(description: Description) -> list[Variable]:
    """The outputs in which a component counts the samples of a bundle that it has missed: "imu.lost"."""
    outputs = description.with_causality("output")
    return [variable for variable in outputs if variable.type == "Integer" and variable.name.endswith(".lost")]


def short(names: Iterable[str]) -> list[str]:
    """Everything that can be written to mean some of these variables, for "did you mean"."""
    known: dict[str, None] = {}
    for name in names:
        ends = [place for place, sign in enumerate(name) if sign in "[."]
        known |= dict.fromkeys([name, *(name[:end] for end in reversed(ends))])
    return list(known)


# ---- in a system -----------------------------------------------------------------------------------------------------


def find(system: Mapping[str, Description], name: str, where: str) -> Signal:
    """The one variable of that name in a system, or a sentence with the nearest one."""
    component, variable = split(name)
    if component not in system:
        raise NavfmuError(f"{where}: there is no component '{component}'{nearest(component, system)}")
    known = system[component].by_name
    if variable not in known:
        raise NavfmuError(f"{where}: component '{component}' has no variable '{variable}'{hint(variable, known)}")
    return Signal(component, known[variable])


def recordable(variable: Variable) -> bool:
    """Whether a variable can be recorded: no text, and none whose own name ends like that of a value without faults."""
    return variable.type != "String" and not variable.name.endswith(TRUE)


def outputs(system: Mapping[str, Description]) -> list[Signal]:
    """All outputs that can be recorded."""
    return [
        Signal(component, variable)
        for component, description in system.items()
        for variable in description.variables
        if variable.causality == "output" and recordable(variable)
    ]


def signals(system: Mapping[str, Description], name: str, where: str) -> list[Signal]:
    """The recordable variables that a name or pattern stands for; at least one."""
    component, variable = split(name)
    known = system[component].by_name if component in system and variable else {}
    if is_pattern(name) and variable not in known:
        found = [output for output in outputs(system) if stands_for(name, str(output))]
        if not found:
            raise NavfmuError(f"{where}: no output matches the pattern")
        return found
    if name in system:
        return outputs({name: system[name]})
    chosen = [Signal(component, known[full]) for full in group(known, variable).values()]
    chosen = chosen or [find(system, name, where)]
    found = [signal for signal in chosen if recordable(signal.variable)]
    if not found:
        why = "a String" if chosen[0].variable.type == "String" else f"a variable whose own name ends in '{TRUE}'"
        raise NavfmuError(f"{where}: {why} cannot be recorded")
    return found


# ---- in a recording --------------------------------------------------------------------------------------------------


def is_pattern(name: str) -> bool:
    """Whether a name has one of the signs * and ?."""
    return any(sign in name for sign in "*?")


def stands_for(name: str, signal: str) -> bool:
    """Whether a name means a signal: "imu", "imu.reading.rate" and "*.rate[1]" all mean "imu.reading.rate[1]"."""
    if is_pattern(name):
        return fnmatchcase(signal, name.replace("[", "[[]"))
    return bool(group([signal], name))


def chosen(signals: Sequence[str], names: Iterable[str], where: str) -> list[str]:
    """The signals that are meant by names, in the order of the names; a name that means none is an error."""
    found: dict[str, None] = {}
    for name in names:
        meant = [name] if name in signals else [signal for signal in signals if stands_for(name, signal)]
        if not meant:
            raise NavfmuError(f"{where}: there is no signal '{name}'{hint(name, short(signals))}")
        found |= dict.fromkeys(meant)
    return list(found)
