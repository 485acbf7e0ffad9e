"""The inputs of a component in groups, each of which is set by one call, and what each gets from its source."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from navfmu.engine.component import Component
from navfmu.engine.effect import AHEAD, NEXT, NOW
from navfmu.engine.link import TYPES, Wire
from navfmu.fmi.description import Variable
from navfmu.fmi.names import Signal


@dataclass(frozen=True)
class Inputs:
    """Inputs of one group: input i is ``factor[i] * signal[source[i]] + offset[i]``.

    Where ``ahead`` the signal is the one at the end of the step under the fault of its beginning, and not the one that
    left last.
    """

    names: tuple[str, ...]
    references: np.ndarray  # uint32
    source: np.ndarray  # int32, signals
    factor: np.ndarray  # float64
    offset: np.ndarray  # float64
    ahead: np.ndarray  # bool
    scaled: bool  # whether any of them is not a plain copy


class _Input(NamedTuple):
    variable: Variable
    source: int
    factor: float = 1.0
    offset: float = 0.0
    ahead: bool = False


def inputs_of(
    component: Component,
    wires: Sequence[Wire],
    driven: Mapping[tuple[str, str], None],
    slots: Mapping[tuple[str, str], int],
    algorithm: str,
    cut: set[tuple[Signal, Signal]],
) -> tuple[Inputs, Inputs, Inputs, Inputs]:
    """The inputs of a component: smooth, held Real, Integer, Boolean."""
    groups: dict[str, list[_Input]] = {"smooth": [], **{t: [] for t in TYPES}}
    for source, target, link in wires:
        if target.component != component.name:
            continue
        line = algorithm == "gauss_seidel" and (source, target) not in cut and _continuous(source, target)
        smooth = line and component.description.can_interpolate_inputs
        entry = _Input(target.variable, *taken((source, target, link), slots), line and not smooth)
        groups["smooth" if smooth else target.variable.type].append(entry)
    for name, variable in driven:
        if name == component.name:
            target_variable = component.description.by_name[variable]
            groups[target_variable.type].append(_Input(target_variable, slots[name, variable]))
    return tuple(_inputs(rows) for rows in groups.values())  # type: ignore[return-value]


def taken(wire: Wire, slots: Mapping[tuple[str, str], int]) -> tuple[int, float, float]:
    """The signal that an input takes, factor and offset: its own one, if there is one, as it is."""
    source, target, link = wire
    return (slots[target.key], 1.0, 0.0) if target.key in slots else (slots[source.key], link.factor, link.offset)


def readers_of(
    wires: Sequence[Wire],
    components: Sequence[Component],
    algorithm: str,
    cut: set[tuple[Signal, Signal]],
    taps: Collection[tuple[str, str]],
) -> dict[tuple[str, str], int]:
    """Who takes each connected output, (component, variable): a sum of ``NOW``, ``NEXT`` and ``AHEAD``.

    ``taps`` are the inputs that take a signal of their own.
    """
    smooth = {component.name for component in components if component.description.can_interpolate_inputs}
    readers: dict[tuple[str, str], int] = {}
    for source, target, _ in wires:
        if algorithm != "gauss_seidel" or (source, target) in cut:
            reader = NEXT
        elif _continuous(source, target):
            reader = AHEAD | NEXT if target.component in smooth else AHEAD
        else:
            reader = NOW
        key = target.key if target.key in taps else source.key
        readers[key] = readers.get(key, 0) | reader
    return readers


def _continuous(*ends: Signal) -> bool:
    """Whether the value between two communication points means something, at both ends."""
    return all(end.variable.type == "Real" and end.variable.variability == "continuous" for end in ends)


def _inputs(rows: list[_Input]) -> Inputs:
    return Inputs(
        tuple(row.variable.name for row in rows),
        np.array([row.variable.reference for row in rows], np.uint32),
        np.array([row.source for row in rows], np.int32),
        np.array([row.factor for row in rows], np.float64),
        np.array([row.offset for row in rows], np.float64),
        np.array([row.ahead for row in rows], bool),
        any((row.factor, row.offset) != (1.0, 0.0) for row in rows),
    )
