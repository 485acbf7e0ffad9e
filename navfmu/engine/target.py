"""What the target of a fault stands for in a system, and whether it supports the fault."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from navfmu.engine.component import Component
from navfmu.errors import nearest
from navfmu.faults.fault import Fault
from navfmu.faults.types import CONNECTED, INPUT, OUTPUT, PARAMETER, TYPES, FaultType
from navfmu.fmi import names
from navfmu.fmi.description import Variable

Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Element:
    """One variable on which a fault acts."""

    component: Component
    variable: Variable

    @property
    def key(self) -> Key:
        """Names of component and variable."""
        return self.component.name, self.variable.name


def place(component: Component, variable: Variable, connected: Collection[Key]) -> str:
    """What a variable is in the system, as ``types`` calls it: "connected input"."""
    if variable.causality == "output":
        return OUTPUT
    if variable.causality == "input":
        return CONNECTED if (component.name, variable.name) in connected else INPUT
    if variable.causality == "parameter":
        return PARAMETER if variable.variability == "tunable" else f"{variable.variability} parameter"
    return f"{variable.causality} variable"


def elements(fault: Fault, components: Mapping[str, Component], connected: Collection[Key]) -> list[Element]:
    """The variables that the targets of a fault stand for, which all support it."""
    found = [element for target in fault.targets for element in _elements(fault, target, components, connected)]
    keys = [element.key for element in found]
    for key in keys:
        if keys.count(key) > 1:
            raise fault.error(f"'target' names '{'.'.join(key)}' twice", "target")
    return found


def component_of(fault: Fault, target: str, components: Mapping[str, Component]) -> Component:
    """The component of a target."""
    name, _ = names.split(target)
    if name not in components:
        hint = nearest(name, components)
        raise fault.error(f"target '{target}': there is no component '{name}'{hint}", "target")
    return components[name]


def supporting(kind: FaultType, component: Component, connected: Collection[Key]) -> list[Variable]:
    """The variables of a component on which a type of fault acts."""
    variables = component.description.variables
    return [v for v in variables if kind.supports(place(component, v, connected), v.type)]


def bundles(component: Component, connected: Collection[Key]) -> list[str]:
    """The bundles that leave or arrive: those with "valid" and "sequence" that are outputs or connected inputs."""
    signals = {v.name for v in supporting(TYPES["dropout"], component, connected)}
    found = [names.bundle(name) for name in signals if name.endswith(".valid")]
    return sorted(bundle for bundle in found if f"{bundle}.sequence" in signals)


def of_bundle(component: Component, bundle: str, variables: Iterable[Variable]) -> list[Variable]:
    """Those that arrive or leave with a bundle, or with those of an array: an output in which its receiver counts what
    it has lost does not.
    """
    known = component.description.by_name

    def arrives_or_leaves(variable: Variable) -> bool:
        valid = known.get(f"{bundle}.valid") or known.get(f"{names.bundle(variable.name)}.valid")
        return valid is None or variable.causality == valid.causality

    return list(filter(arrives_or_leaves, variables))


def _elements(
    fault: Fault, target: str, components: Mapping[str, Component], connected: Collection[Key]
) -> list[Element]:
    component, (_, signal), kind = component_of(fault, target, components), names.split(target), TYPES[fault.type]
    able = supporting(kind, component, connected)
    if kind.bundles == "only" and not names.meant(known := bundles(component, connected), signal):
        have = ", ".join(f"'{name}'" for name in known) or "none"
        raise fault.error(
            f"target '{target}' is not a bundle of outputs or connected inputs (values with 'valid' and 'sequence')"
            f"{names.hint(signal, known)}; bundles of '{component.name}': {have}",
            "target",
        )
    variables = names.elements(component.description, signal)
    members = [] if variables else list(names.group(component.description.by_name, signal).values())
    if not variables and not members:
        hint = names.hint(signal, names.short(variable.name for variable in able))
        raise fault.error(f"target '{target}': component '{component.name}' has no variable '{signal}'{hint}", "target")
    if members and not kind.bundles:
        which = ", ".join(members[:4]) + (" ..." if len(members) > 4 else "")
        raise fault.error(f"'{target}' is a bundle, type '{fault.type}' acts on members of it: {which}", "target")
    if members:
        variables = of_bundle(component, signal, (variable for variable in able if variable.name in members))
        if not variables:
            raise fault.error(f"type '{fault.type}' acts on {kind.targets}, but '{target}' has none of them", "target")
    for variable in variables:
        if variable not in able:
            raise fault.error(_unsupported(fault, component, variable, connected), "target")
    return [Element(component, variable) for variable in variables]


def _unsupported(fault: Fault, component: Component, variable: Variable, connected: Collection[Key]) -> str:
    """The sentence that says why a variable does not support a fault."""
    kind, where = TYPES[fault.type], place(component, variable, connected)
    what = where if where not in kind.places else f"{variable.type} {where}"
    others = [name for name, other in TYPES.items() if other.bundles != "only" and other.supports(where, variable.type)]
    use = f"types for it: {', '.join(others)}" if others else "no type of fault acts on it"
    article, name = "an" if what[0] in "aeiouI" else "a", f"{component.name}.{variable.name}"
    return f"type '{fault.type}' acts on {kind.targets}, but '{name}' is {article} {what} ({use})"
