"""What passes through one saboteur: signals of a plan on which its effects act, and those that must stay with them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from navfmu.engine.link import Link
from navfmu.engine.plan import Plan
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import Unit

Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Passage:
    """The signals of one component, or those that nothing else drives, with the rows of the effects on them."""

    plan: Plan
    links: tuple[Link, ...]
    behind: str  # the component; empty: none
    rows: range  # in the plan's table of effects

    @cached_property
    def system(self) -> dict[str, Description]:
        """The descriptions of the components."""
        return {part.component.name: part.component.description for part in self.plan.parts}

    @cached_property
    def effects(self) -> np.ndarray:
        """The effects, as they act one after the other."""
        return self.plan.effects[self.rows.start : self.rows.stop]

    @cached_property
    def pairs(self) -> list[list[int]]:
        """For each effect that moves values about: the signals that it changes, and behind them where it takes them."""
        return [self.plan.reached(effect["first_pair"], 2 * effect["pairs"]) for effect in self.effects]

    @cached_property
    def changed(self) -> list[list[int]]:
        """The signals that each effect changes."""
        zipped = zip(self.pairs, self.effects, strict=True)
        return [own[: len(own) // 2] or [int(effect["slot"])] for own, effect in zipped]

    @cached_property
    def keys(self) -> dict[int, Key]:
        """What each signal of the plan is."""
        return dict(enumerate(map(names.split, self.plan.signals)))

    @cached_property
    def leaving(self) -> dict[Key, int]:
        """The output, or the input of one receiver, for which each output stands, and its signal."""
        changed = {self.keys[slot]: slot for slot in sorted({slot for of_one in self.changed for slot in of_one})}
        return changed | {key: slot for key, slot in self._companions(changed).items() if key not in changed}

    @cached_property
    def slots(self) -> list[int]:
        """All its signals, by their numbers in the plan."""
        return sorted({*self.leaving.values(), *(slot for own in self.pairs for slot in own)})

    @cached_property
    def entering(self) -> list[int]:
        """The signals that come from the component."""
        own = (slot for slot in self.slots if slot < self.plan.first_driven and self.keys[slot][0] == self.behind)
        return [slot for slot in own if self.variable(self.keys[slot]).causality == "output"]  # not its inputs

    @cached_property
    def undisturbed(self) -> dict[int, float]:
        """The values of signals that nothing else drives."""
        first = self.plan.first_driven
        return {slot: float(self.plan.driven[slot - first]) for slot in self.slots if slot >= first}

    @cached_property
    def sources(self) -> list[list[int]]:
        """For each that leaves, those that enter on which it depends."""
        reached: dict[int, list[int]] = {slot: [slot] for slot in self.slots}
        for effect, of_one in zip(self.effects, self.changed, strict=True):
            reached |= dict.fromkeys(of_one, self.plan.reached(effect["first_reach"], effect["reaches"]))
        return [[slot for slot in self.entering if slot in reached[leaving]] for leaving in self.leaving.values()]

    @property
    def faults(self) -> tuple[str, ...]:
        """The ids of the faults."""
        return tuple(dict.fromkeys(fault.id for row in self.rows if (fault := self.plan.faults[row])))

    def variable(self, key: Key) -> Variable:
        """A variable of the system."""
        return self.system[key[0]].by_name[key[1]]

    def _companions(self, leaving: Iterable[Key]) -> dict[Key, int]:
        """The members of bundles of which some leave: a new number must not announce an old value."""
        found: dict[Key, int] = {}
        bundles = {(component, bundle) for component, name in leaving if (bundle := names.bundle(name))}
        bundles = {(c, b) for c, b in bundles if {f"{b}.sequence", f"{b}.valid"} <= self.system[c].by_name.keys()}
        known = {key: slot for slot, key in self.keys.items()}
        for key, slot in known.items():
            inside = key[0] == self.behind and (self.behind, names.bundle(key[1])) in bundles
            if inside and self.variable(key).causality == "output":
                found[key] = slot
        for link in self.links:
            source, target = names.split(link.source), names.split(link.target)
            inside = source[0] == self.behind and (target[0], names.bundle(target[1])) in bundles
            if inside and not link.scaled:
                found[target] = known[source]
        return found


def passages(plan: Plan, links: Iterable[Link]) -> list[Passage]:
    """Those of all components on whose outputs faults act, and that of what nothing else drives."""
    links = tuple(links)
    found = [
        Passage(plan, links, part.component.name, range(part.first_effect, part.first_effect + part.effects))
        for part in plan.parts
    ]
    found.append(Passage(plan, (), "", range(plan.first_driven_effect, len(plan.effects))))
    return [passage for passage in found if passage.rows]


def units(passage: Passage, keys: Iterable[Key]) -> Mapping[str, Unit]:
    """The units of variables, as their FMUs define them."""
    found: dict[str, Unit] = {}
    for key in keys:
        unit = passage.variable(key).unit
        if unit:
            found.setdefault(unit, passage.system[key[0]].units.get(unit) or Unit(unit))
    return found
