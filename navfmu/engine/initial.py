"""How a system gets its initial values: moves that are made one after the other, in initialisation mode and out of it.

Components that need nothing of each other leave initialisation one after the other, each with its inputs set before
and its outputs read after: many FMUs compute their outputs only then.

Components in a cycle stay in initialisation mode until their values have gone round, variable by variable: an output
is read once the inputs on which it depends are set, an input is set once its source is read. Then they leave, each
with all its inputs set again: first those whose outputs are known only now and needed by others. A cycle of
*variables* is an algebraic loop. It is opened at its first output in the system description, which is read before
the inputs on which it depends are set.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from navfmu.engine.component import Component
from navfmu.engine.inputs import taken
from navfmu.engine.link import TYPES, Wire
from navfmu.engine.order import cycles, groups, sort

READ, GIVE, LEAVE = range(3)
SHOWN = 5  # algebraic loops that are named

# One move, laid out as struct Move in source/master.h. LEAVE sets all inputs, leaves initialisation, reads all outputs.
MOVE = np.dtype(
    [
        ("kind", np.int32),
        ("component", np.int32),
        ("type", np.int32),  # READ, GIVE: place in TYPES
        ("reference", np.uint32),  # of the output that is read, of the input that is given
        ("slot", np.int32),  # READ: the signal of the output; GIVE: input = factor * signal[slot] + offset
        ("factor", np.float64),
        ("offset", np.float64),
    ],
    align=True,
)
Key = tuple[str, str]  # component, variable


def initial_moves(
    components: Sequence[Component],
    wires: Sequence[Wire],
    driven: Collection[Key],
    slots: Mapping[Key, int],
) -> tuple[np.ndarray, list[str]]:
    """The moves, rows of ``MOVE``, and sentences about algebraic loops."""
    number = {component.name: place for place, component in enumerate(components)}
    edges = {(number[source.component], number[target.component]) for source, target, _ in wires}
    moves: list[tuple[int | float, ...]] = []
    loops: list[str] = []
    for group in groups(len(components), edges):
        order = range(len(group))
        if len(group) > 1 or (group[0], group[0]) in edges:
            members = {components[place].name: components[place] for place in group}
            wires_in = [wire for wire in wires if wire[1].component in members]
            circle = _Circle(members, [wire for wire in wires_in if wire[0].component in members])
            moves += [_give(wire, number, slots) for wire in wires_in if wire[0].component not in members]
            moves += [_give_driven(members[c], name, number, slots) for c, name in driven if c in members]
            moves += circle.moves(number, slots)
            loops += circle.loops()
            order = circle.leaving()
        moves += [(LEAVE, group[place], 0, 0, 0, 1.0, 0.0) for place in order]
    return np.array(moves, MOVE), [*loops[:SHOWN], *_more(len(loops) - SHOWN)]


def _more(count: int) -> list[str]:
    return [f"and {count} more algebraic loop{'s' if count > 1 else ''}"] if count > 0 else []


def _give(wire: Wire, number: Mapping[str, int], slots: Mapping[Key, int]) -> tuple[int | float, ...]:
    _, target, _ = wire
    kind = TYPES.index(target.variable.type)
    return GIVE, number[target.component], kind, target.variable.reference, *taken(wire, slots)


def _give_driven(
    component: Component, name: str, number: Mapping[str, int], slots: Mapping[Key, int]
) -> tuple[int | float, ...]:
    variable = component.description.by_name[name]
    place = number[component.name], TYPES.index(variable.type), variable.reference
    return GIVE, *place, slots[component.name, name], 1.0, 0.0


class _Circle:
    """Components that need each other, and the wires between them.

    Its variables are numbered: outputs before inputs, so that a cycle of them is opened at an output.
    """

    def __init__(self, members: Mapping[str, Component], wires: Sequence[Wire]) -> None:
        self._members, self._wires = members, wires
        described = [(name, variable.name) for name, c in members.items() for variable in c.description.variables]
        ends = [{wire[end].key for wire in wires} for end in (0, 1)]
        self._variables = [key for keys in ends for key in described if key in keys]
        number = {key: n for n, key in enumerate(self._variables)}
        self._wire_of = {number[t.key]: (s, t, link) for s, t, link in wires}
        self._needs = {key: self._inputs_of(key, number) for key in self._variables[: len(ends[0])]}
        self._edges = [(number[s.key], number[t.key]) for s, t, _ in wires]
        self._edges += [(need, number[key]) for key, needs in self._needs.items() for need in needs]
        self._order, self._cut = sort(len(self._variables), self._edges)

    def _inputs_of(self, key: Key, number: Mapping[Key, int]) -> list[int]:
        about = self._members[key[0]].description
        fed = ((key[0], name) for name in about.initial_inputs(about.by_name[key[1]]))
        return [number[end] for end in fed if end in number]

    def moves(self, number: Mapping[str, int], slots: Mapping[Key, int]) -> Iterator[tuple[int | float, ...]]:
        """Every output read and every input given, in the order in which they depend on each other."""
        for variable in self._order:
            if variable in self._wire_of:
                yield _give(self._wire_of[variable], number, slots)
            else:
                name, output = key = self._variables[variable]
                about = self._members[name].description.by_name[output]
                place = READ, number[name], TYPES.index(about.type), about.reference
                taps = [t.key for s, t, _ in self._wire_of.values() if s.key == key and t.key in slots]
                for signal in (key, *taps):
                    yield *place, slots[signal], 1.0, 0.0

    def leaving(self) -> list[int]:
        """The order in which the members leave initialisation.

        Others wait for outputs that depend on inputs of the circle. They wait for outputs that are calculated without
        them, and for those that are known before, only where that is no contradiction.
        """
        place = {name: number for number, name in enumerate(self._members)}
        strength: dict[tuple[int, int], int] = {}
        for source, target, _ in self._wires:
            edge = place[source.component], place[target.component]
            calculated = source.variable.initial != "exact" and source.variable.variability != "constant"
            needed = 2 if self._needs[source.key] else int(calculated)
            strength[edge] = max(needed, strength.get(edge, 0))
        for weak in (0, 1):
            for group in cycles(len(place), strength):
                strength = {
                    (source, target): needed
                    for (source, target), needed in strength.items()
                    if needed > weak or source not in group or target not in group
                }
        return sort(len(place), strength)[0]

    def loops(self) -> Iterator[str]:
        """A sentence for each algebraic loop that was opened."""
        opened = {output: {source for source, target in self._cut if target == output} for _, output in self._cut}
        for output, last in opened.items():
            ends = [self._variables[variable] for variable in self._round(output, last)]
            text = " -> ".join(".".join(end) for end in ends)
            said = {name: member.description.dependencies for name, member in self._members.items()}
            silent = [".".join(end) for end in ends[::2] if end[1] not in said[end[0]]]
            why = f" (no dependencies are declared for {', '.join(silent)})" if silent else ""
            yield f"algebraic loop: {text}{why}; the start value of '{'.'.join(ends[0])}' is used"

    def _round(self, first: int, last: Collection[int]) -> list[int]:
        """The shortest way from a variable to one of the last, which lead back to it."""
        targets: dict[int, list[int]] = {}
        for source, target in sorted(self._edges):
            targets.setdefault(source, []).append(target)
        before, left = {first: first}, deque([first])
        while left:
            variable = left.popleft()
            if variable in last:
                way = [variable]
                while way[-1] != first:
                    way.append(before[way[-1]])
                return way[::-1]
            for target in targets.get(variable, ()):
                if target not in before:
                    before[target] = variable
                    left.append(target)
        return [first]
