"""Everything in a system that can fail, and which types of fault each supports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from navfmu.engine.component import Component
from navfmu.engine.target import Element, Key, bundles, of_bundle, place
from navfmu.faults.types import COMPONENT, TYPES, FaultType
from navfmu.fmi import names
from navfmu.fmi.units import alike

FAULT_INPUT = "fault input"  # an unconnected input that its model declares as a way to fail


@dataclass(frozen=True)
class Target:
    """A name that can stand as target of a fault."""

    name: str
    what: str  # "Real output", "bundle output", "component"
    elements: tuple[Element, ...]
    types: tuple[str, ...]
    source: str = ""  # of a connected input

    @property
    def unit(self) -> str:
        """The unit of its elements, where they have one."""
        units = {element.variable.unit or "" for element in self.elements}
        return units.pop() if len(units) == 1 else ""

    @property
    def description(self) -> str:
        """What it is, in words; of a connected input what it comes from."""
        if self.source:
            return f"from {self.source}"
        if self.what.startswith("bundle"):
            members = [names.array(e.variable.name).rpartition(".")[2] for e in self.elements]
            return ", ".join(dict.fromkeys(members))
        return self.elements[0].variable.description.removeprefix("fault: ") if self.elements else ""


def catalogue(components: Iterable[Component], sources: Mapping[Key, str]) -> list[Target]:
    """All targets; ``sources`` has the output to which each connected input is connected."""
    found: list[Target] = []
    for component in components:
        found += [*_whole(component), *_bundles(component, sources), *_variables(component, sources)]
    return found


def _whole(component: Component) -> list[Target]:
    able = component.description.can_handle_variable_step
    types = tuple(name for name, kind in TYPES.items() if kind.places == (COMPONENT,))
    return [Target(component.name, COMPONENT, (), types)] if able else []


def _bundles(component: Component, sources: Mapping[Key, str]) -> list[Target]:
    found = []
    for bundle in bundles(component, sources):
        members = names.group(component.description.by_name, bundle).values()
        variables = of_bundle(component, bundle, (component.description.by_name[name] for name in members))
        elements = [Element(component, variable) for variable in variables]
        signals = [e for e in elements if TYPES["dropout"].supports(_place(e, sources), e.variable.type)]
        types = [n for n, kind in TYPES.items() if kind.bundles and any(_supports(kind, [e], sources) for e in signals)]
        source = names.bundle(sources.get((component.name, f"{bundle}.valid"), ""))
        what = f"bundle {_place(signals[0], sources)}"
        found.append(Target(f"{component.name}.{bundle}", what, tuple(signals), tuple(types), source))
    return found


def _variables(component: Component, sources: Mapping[Key, str]) -> list[Target]:
    groups: dict[str, list[Element]] = {}
    for variable in component.description.variables:
        groups.setdefault(names.array(variable.name), []).append(Element(component, variable))
    found = []
    for name, elements in groups.items():
        alike_ = len({(_place(e, sources), e.variable.type) for e in elements}) == 1
        for target, own in [(name, elements)] if alike_ else [(e.variable.name, [e]) for e in elements]:
            types = tuple(n for n, kind in TYPES.items() if kind.bundles != "only" and _supports(kind, own, sources))
            if types:
                where = FAULT_INPUT if own[0].variable.fault and types == ("input",) else _place(own[0], sources)
                source = names.array(sources.get(own[0].key, ""))
                what = f"{own[0].variable.type} {where}"
                found.append(Target(f"{component.name}.{target}", what, tuple(own), types, source))
    return found


def _place(element: Element, sources: Mapping[Key, str]) -> str:
    return place(element.component, element.variable, sources)


def _supports(kind: FaultType, elements: list[Element], sources: Mapping[Key, str]) -> bool:
    sorts = {parameter.sort for parameter in kind.parameters}
    able = all(kind.supports(_place(e, sources), e.variable.type) for e in elements)
    able = able and ("order" not in sorts or _swappable(elements, sources))
    return able and ("unit" not in sorts or bool(others(elements)))


def _swappable(elements: list[Element], sources: Mapping[Key, str]) -> bool:
    """Whether there are several, and all come from one component."""
    return len(elements) > 1 and len({names.split(sources.get(e.key, e.key[0]))[0] for e in elements}) == 1


def others(elements: Iterable[Element]) -> list[str]:
    """Other units in which all of them could be sent by mistake."""
    units = {element.variable.unit or "": element.component.description.units for element in elements}
    unit, known = next(iter(units.items()))
    own = known.get(unit) if len(units) == 1 else None
    if own is None or own.exponents is None:
        return []
    return [name for name in alike(own) if name != unit]
