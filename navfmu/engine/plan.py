"""A plan: everything a run needs, as plain arrays. Both engines execute the same plan and return the same bits.

Every value that leaves an output is a *signal*: one double, whatever its FMI type, in one vector for all components.
The signals of a component lie together (Real, Integer, Boolean); after those of all components come the *driven*
signals, which no FMU computes: the values of unconnected inputs and tunable parameters that a fault changes.

What happens at the communication points t_k (``Clock.time``):

* t = 0: start values are set, all components enter initialisation; then the ``initial`` moves are made, with the
  faults active at t = 0 (``navfmu/engine/initial.py``).
* **Jacobi**: all components get their inputs as of t_k, then all make the step to t_{k+1}.
* **Gauss-Seidel**: one after the other, in ``order``, each gets its inputs and makes the step. From a component that
  has already made it (every connection, except those that were cut), a discrete input (bundle, Integer, Boolean) is the
  newest value, that of t_{k+1}: its time of validity tells the receiver from when it holds. A *smooth* input
  (continuous Real, from a continuous output, at an FMU that can interpolate) starts at the value of t_k with the slope
  (u(t_{k+1}) - u(t_k)) / h. At an FMU that cannot interpolate it is u(t_{k+1}) over the whole step, which is exact for
  components that sample at the end of a step. Over a cut connection everything is held at t_k, as in Jacobi.
* **Faults** change a value as it leaves at t_k, first <= k < end. Over the step after t_k the fault of t_k stays in
  force: u(t_{k+1}) of a continuous input, with a slope or without, is the true value at t_{k+1} with the fault active
  at t_k still acting on it (bias kept, drift continued, noise held), so that a fault begins and ends at a communication
  point as a step, not one step earlier and not as a ramp. Driven signals are held from t_k to t_{k+1}.
* An input on which a fault acts is a signal of its own among those of its source, which is read a second time for it:
  no other receiver gets it.
* Each value set, doStep and value read returns a status: OK and Warning go on, everything else ends the run.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from types import MappingProxyType
from typing import Any

import numpy as np

from navfmu.engine import loss
from navfmu.engine.clock import Clock
from navfmu.engine.component import Component
from navfmu.engine.effect import NEXT, OBSERVED, RECORDED, TAKE, Effect, tables
from navfmu.engine.idle import idle, spared
from navfmu.engine.initial import initial_moves
from navfmu.engine.inputs import Inputs, inputs_of, readers_of
from navfmu.engine.link import TYPES, Link, Wire
from navfmu.engine.making import effects_of
from navfmu.engine.monitor import Monitor
from navfmu.engine.monitor import table as monitor_table
from navfmu.engine.operations import Operations
from navfmu.engine.order import sort
from navfmu.engine.trigger import ALWAYS, begin, condition, lists
from navfmu.engine.trigger import table as trigger_table
from navfmu.errors import NavfmuError, nearest
from navfmu.expressions.program import Source
from navfmu.faults.fault import Fault
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.names import Signal
from navfmu.fmi.values import expand

ALGORITHMS = ("jacobi", "gauss_seidel")
Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Settings:
    """Values of one type that are set before initialisation."""

    names: tuple[str, ...]
    references: np.ndarray  # uint32
    values: tuple[Any, ...]


@dataclass(frozen=True)
class Part:
    """One component in the plan."""

    component: Component
    settings: Mapping[str, Settings]  # by type: "Real", "Integer", "Boolean", "String"
    smooth: Inputs  # Real, set with a slope
    real: Inputs  # held
    integer: Inputs
    boolean: Inputs
    first_signal: int
    outputs: Mapping[str, np.ndarray]  # by type, value references read after each step, in the order of the signals
    first_effect: int  # rows of the fault table
    effects: int
    first_loss: int  # rows of the table of losses
    losses: int

    @property
    def counters(self) -> list[Variable]:
        """Outputs that count lost samples; they are read once, at the end of a run."""
        return names.counters(self.component.description)

    @property
    def signals(self) -> int:
        """How many signals it has."""
        return sum(len(references) for references in self.outputs.values())


@dataclass(frozen=True)
class Recorded:
    """A column of the recording: ``factor * signal[slot] + offset``."""

    name: str
    slot: int
    true: bool = False  # the value before faults
    factor: float = 1.0
    offset: float = 0.0
    type: str = "Real"
    unit: str | None = None


@dataclass(frozen=True)
class Plan:
    """Everything a run needs."""

    parts: tuple[Part, ...]  # in the order of the system description
    order: tuple[int, ...]  # in which parts step, in Gauss-Seidel
    initial: np.ndarray  # MOVE: how the values of t = 0 come about
    algorithm: str
    clock: Clock
    signals: tuple[str, ...]  # names, "component.variable"
    driven: np.ndarray  # float64, undisturbed values of the driven signals, which are the last ones
    effects: np.ndarray  # EFFECT: those of part 0, part 1 ..., then those of driven signals
    echoes: np.ndarray  # ECHO
    reach: np.ndarray  # int32: signals, as effects name them
    memory: np.ndarray  # float64: what effects and echoes remember before the run
    readers: np.ndarray  # int32: who sees each signal
    triggers: np.ndarray  # TRIGGER: one for each fault, in their order
    fault_ids: tuple[str, ...]
    windows: np.ndarray  # WINDOW
    spans: np.ndarray  # SPAN: room for when triggers act
    losses: np.ndarray  # LOSS: by component
    begins: tuple[int, ...]  # communication point at which each effect begins, then each loss
    faults: tuple[Fault | None, ...]  # of each effect, then each loss; what an input takes is none
    recorded: tuple[Recorded, ...]
    questions: tuple[Monitor, ...]
    monitors: np.ndarray  # MONITOR: a row for each question
    operations: np.ndarray  # OPERATION: of all their programs
    record_every: int  # steps
    cut: tuple[str, ...]  # connections that were cut, "a.y -> b.u"
    idle: Mapping[str, str]  # faults that cannot change anything, by id, and why
    notes: tuple[str, ...]  # sentences for the user

    @property
    def rows(self) -> int:
        """Rows of the recording, the one at t = 0 included."""
        return self.clock.steps // self.record_every + 1

    def reached(self, first: int, count: int) -> list[int]:
        """Signals that an effect names."""
        return self.reach[first : first + count].tolist()

    def exposed(self, part: Part) -> np.ndarray:
        """The signals of a component that effects change or look at, int32."""
        rows = self.effects[part.first_effect : part.first_effect + part.effects]
        reached = [self.reach[row["first_reach"] : row["first_reach"] + row["reaches"]] for row in rows]
        return np.unique(np.concatenate([np.zeros(0, np.int32), *reached]))

    @property
    def first_driven(self) -> int:
        """The first driven signal."""
        return len(self.signals) - len(self.driven)

    @property
    def first_driven_effect(self) -> int:
        """The first row of the fault table that acts on a driven signal."""
        return sum(part.effects for part in self.parts)


def make_plan(
    components: Sequence[Component],
    links: Sequence[Link],
    *,
    step: float,
    stop: float,
    algorithm: str = "gauss_seidel",
    record: Sequence[str] | None = None,
    record_period: float | None = None,
    faults: Sequence[Fault] = (),
    monitors: Sequence[Monitor] = (),
    phases: Mapping[str, str] = MappingProxyType({}),
    seed: int = 1,
) -> Plan:
    """The plan of a run from 0 to ``stop`` (s) in steps of ``step`` (s).

    ``record`` names variables ("imu.reading.rate[1]"), arrays and bundles ("imu.reading.rate", "imu.reading") or
    patterns ("imu.*"), each with or without "@true"; by default all outputs are recorded. ``monitors`` are asked at
    every communication point; ``phases`` are conditions by name, which they and faults may use. ``seed`` keys the noise
    of faults. Whatever does not fit together is a ``NavfmuError``.
    """
    if algorithm not in ALGORITHMS:
        hint = nearest(algorithm, ALGORITHMS)
        raise NavfmuError(f"unknown algorithm '{algorithm}'{hint} (there are {' and '.join(ALGORITHMS)})")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or not 0 <= seed < 2**31:
        raise NavfmuError(f"the seed must be a whole number from 0 to 2147483647, not {seed!r}")
    clock = Clock.of(step, stop)
    every = 1 if record_period is None else clock.multiple(record_period, "recording period")
    by_name = _by_name(components)
    system = {name: component.description for name, component in by_name.items()}
    starts = {name: expand(system[name], c.start, f"component '{name}'") for name, c in by_name.items()}
    wires = [_wire(link, system) for link in links]
    connected = _connected(wires)
    effects = effects_of(faults, by_name, connected)
    failing = {key for effect in effects for key in effect.keys}
    taps = {wire[1].key: wire for wire in wires if wire[1].key in failing}
    _check_swaps(effects, taps)
    into = [effect for effect in effects if effect.key in taps]
    effects = [
        *(effect for effect in effects if effect.key not in taps),
        *_takes(taps, len(faults)),
        *into,
    ]  # as it goes from end to end
    columns = _columns(record, system)
    ids = tuple(fault.id for fault in faults)
    programs = [(monitor.program(system, phases), monitor.condition(system, phases)) for monitor in monitors]
    conditions = [condition(fault, system, phases, ids) for fault in faults]
    asked = [program for program in (*chain.from_iterable(programs), *conditions) if program]
    sources = [source for program in asked for source in program.sources]

    index = {component.name: i for i, component in enumerate(components)}
    order, cut_edges = sort(len(components), ((index[s.component], index[t.component]) for s, t, _ in wires))
    cut_names = {(components[a].name, components[b].name) for a, b in cut_edges}
    cut = [(s, t) for s, t, _ in wires if (s.component, t.component) in cut_names]

    read = {s.key for s, _, _ in wires} | {key for e in effects if not e.driven for key in e.keys} - taps.keys()
    driven = {e.key: None for e in effects if e.driven}  # a set that keeps its order
    for end in (*(end for end, _ in columns), *(source.signal for source in sources)):
        if end.key not in connected and end.key not in driven:
            read.add(end.key)
    outputs = {c.name: {t: _outputs(c, t, read, taps.values()) for t in TYPES} for c in components}
    signals = [key for c in components for t in TYPES for key in outputs[c.name][t]] + list(driven)
    slots = {key: slot for slot, key in enumerate(signals)}

    blocks = [None if e.driven else _block(e.key, taps) for e in effects]  # the component with whose signals each is
    ordered = [e for c in (*by_name, None) for e, block in zip(effects, blocks, strict=True) if block == c]
    readers = readers_of(wires, components, algorithm, set(cut), taps)
    for end, true in columns:
        key = _source(end.key, connected, taps)
        readers[key] = readers.get(key, 0) | (0 if true else RECORDED)
    for source in sources:
        key = _source(source.signal.key, connected, taps)
        readers[key] = readers.get(key, 0) | (0 if source.true else OBSERVED)
    for key in driven:
        readers[key] = readers.get(key, 0) | NEXT
    windows = [*lists(faults, clock, seed), *([ALWAYS] if taps else [])]
    effect_tables = tables(ordered, slots, readers, clock, seed)

    undisturbed = {(c, v): _undisturbed(by_name[c], starts[c], v) for c, v in driven}
    losses = loss.losses_of(faults, by_name)
    useless = idle(ordered, windows, readers, clock, every, undisturbed) | loss.idle(losses, windows, clock)

    faulted = {key for effect in ordered for key in effect.keys}

    def place(source: Source) -> tuple[int, float, float]:
        column = _recorded(source.signal, source.true, slots, connected)
        on_its_own = column.true and signals[column.slot] in faulted
        return column.slot + (len(signals) if on_its_own else 0), column.factor, column.offset

    operations = Operations(place, ids)
    questions = monitor_table(monitors, programs, operations, clock, ids)
    when = trigger_table(faults, windows, conditions, operations, clock)
    initial, loops = initial_moves(components, wires, driven, slots)
    parts, first_effect, first_loss = [], 0, 0
    for component in components:
        groups = inputs_of(component, wires, driven, slots, algorithm, set(cut))
        count, lost = blocks.count(component.name), sum(one.component == component.name for one in losses)
        own = outputs[component.name]
        references = {t: np.array(list(own[t].values()), np.uint32) for t in TYPES}
        first_signal = next((slots[key] for t in TYPES for key in own[t]), 0)
        settings = _settings(component, starts[component.name])
        rows = first_effect, count, first_loss, lost
        parts.append(Part(component, settings, *groups, first_signal, references, *rows))
        first_effect, first_loss = first_effect + count, first_loss + lost
    return Plan(
        parts=tuple(parts),
        order=tuple(order),
        initial=initial,
        algorithm=algorithm,
        clock=clock,
        signals=tuple(f"{c}.{v}" for c, v in signals),
        driven=np.array(list(undisturbed.values()), np.float64),
        effects=effect_tables.effects,
        echoes=effect_tables.echoes,
        reach=effect_tables.reach,
        memory=effect_tables.memory,
        readers=np.array([readers.get(key, 0) for key in signals], np.int32),
        triggers=when.triggers,
        fault_ids=ids,
        windows=when.windows,
        spans=when.spans,
        losses=loss.table(losses, list(by_name)),
        begins=tuple(begin(windows[one.trigger]) for one in (*ordered, *losses)),
        faults=tuple(one.fault for one in (*ordered, *losses)),
        recorded=tuple(_recorded(end, true, slots, connected) for end, true in columns),
        questions=tuple(monitors),
        monitors=questions,
        operations=operations.table,
        record_every=every,
        cut=tuple(f"{s} -> {t}" for s, t in cut),
        idle=useless,
        notes=(*loops, *_notes(cut, algorithm, useless), *spared(faults, windows, clock), *_unrecordable(system)),
    )


def _by_name(components: Sequence[Component]) -> dict[str, Component]:
    by_name: dict[str, Component] = {}
    for component in components:
        if component.name in by_name:
            raise NavfmuError(f"two components have the name '{component.name}'")
        by_name[component.name] = component
        library, about = component.fmu.library, component.description
        if about.only_one_instance and sum(other.fmu.library == library for other in by_name.values()) > 1:
            raise NavfmuError(
                f"component '{component.name}': the FMU '{about.model_identifier}' allows one instance in a process "
                "only"
            )
    if not by_name:
        raise NavfmuError("the system has no components")
    return by_name


def _wire(link: Link, system: Mapping[str, Description]) -> Wire:
    where = f"connection {link.source} -> {link.target}"
    source, target = names.find(system, link.source, where), names.find(system, link.target, where)
    link.check(source.variable, target.variable, where)
    return source, target, link


def _connected(wires: Sequence[Wire]) -> dict[tuple[str, str], tuple[Signal, Link]]:
    """For each connected input its source."""
    connected: dict[tuple[str, str], tuple[Signal, Link]] = {}
    for source, target, link in wires:
        if target.key in connected:
            raise NavfmuError(f"input '{target}' has two sources: '{connected[target.key][0]}' and '{source}'")
        connected[target.key] = source, link
    return connected


def _takes(taps: Mapping[Key, Wire], trigger: int) -> list[Effect]:
    """What connections do to inputs on which faults act, as effects of their own."""
    return [
        Effect(None, *key, TAKE, link.factor, link.offset, trigger=trigger, pairs=((key, source.key),))
        for key, (source, _, link) in taps.items()
    ]


def _check_swaps(effects: Iterable[Effect], taps: Mapping[Key, Wire]) -> None:
    for effect in effects:
        places = dict.fromkeys(_block(key, taps) for key, _ in effect.pairs)
        if len(places) > 1:
            come = ", ".join(f"'{name}'" for name in places)
            raise effect.fault.error(f"the elements of a swap must come from one component, not from {come}", "target")


def _block(key: Key, taps: Mapping[Key, Wire]) -> str:
    """The component that computes a signal."""
    return taps[key][0].component if key in taps else key[0]


def _source(key: Key, connected: Mapping[Key, tuple[Signal, Link]], taps: Mapping[Key, Wire]) -> Key:
    """The signal that a variable is: its own, or that of the output to which it is connected."""
    return connected[key][0].key if key in connected and key not in taps else key


def _outputs(component: Component, kind: str, read: Collection[Key], taps: Iterable[Wire]) -> dict[Key, int]:
    """The signals of one type that a component computes, with their value references.

    An input on which a fault acts is a signal of its own, for which its source is read a second time.
    """
    of_kind = {(component.name, v.name): v.reference for v in component.description.variables if v.type == kind}
    own = {key: reference for key, reference in of_kind.items() if key in read}
    tapped = {t.key: s.variable.reference for s, t, _ in taps if s.key in of_kind}
    return own | tapped


def _settings(component: Component, start: Mapping[str, Any]) -> dict[str, Settings]:
    """Start values by type."""
    known = component.description.by_name
    settings = {}
    for kind in (*TYPES, "String"):
        of_kind = [known[name] for name in start if known[name].type == kind]
        settings[kind] = Settings(
            tuple(v.name for v in of_kind),
            np.array([v.reference for v in of_kind], np.uint32),
            tuple(start[v.name] for v in of_kind),
        )
    return settings


def _undisturbed(component: Component, start: Mapping[str, Any], name: str) -> float:
    """The value of a driven variable while no fault acts on it."""
    value = start.get(name, component.description.by_name[name].start)
    if value is None:
        raise NavfmuError(f"'{component.name}.{name}' has no start value to return to after a fault")
    return float(value)


def _columns(record: Sequence[str] | None, system: Mapping[str, Description]) -> list[tuple[Signal, bool]]:
    """The variables to record, each with whether its true value is wanted."""
    if record is None:
        return [(end, False) for end in names.outputs(system)]
    columns: dict[tuple[tuple[str, str], bool], Signal] = {}
    for name in [record] if isinstance(record, str) else record:
        where = f"recorded signal '{name}'"
        signal, true = _without_true(name, system, where)
        for end in names.signals(system, signal, where):
            if true and end.variable.causality != "output":
                raise NavfmuError(f"{where}: only outputs have a true value beside the faulted one")
            columns[end.key, true] = end
    return [(end, true) for (_, true), end in columns.items()]


def _without_true(name: str, system: Mapping[str, Description], where: str) -> tuple[str, bool]:
    """A name to record without "@true", and whether it had it; the own name of a variable may have other @ in it."""
    component, variable = names.split(name)
    own = names.group(system[component].by_name, variable) if component in system and variable else {}
    signal, at, suffix = name.rpartition("@")
    if own or not at:
        return name, False
    if suffix != "true":
        raise NavfmuError(f"{where}: after @ only 'true' is known")
    return signal, True


def _recorded(
    end: Signal,
    true: bool,
    slots: Mapping[tuple[str, str], int],
    connected: Mapping[tuple[str, str], tuple[Signal, Link]],
) -> Recorded:
    name = f"{end}{names.TRUE}" if true else str(end)
    variable = end.variable
    if end.key in connected and end.key not in slots:
        source, link = connected[end.key]
        return Recorded(name, slots[source.key], true, link.factor, link.offset, variable.type, variable.unit)
    return Recorded(name, slots[end.key], true, type=variable.type, unit=variable.unit)


def _unrecordable(system: Mapping[str, Description]) -> Iterable[str]:
    for component, description in system.items():
        for variable in description.with_causality("output"):
            if variable.name.endswith(names.TRUE):
                yield f"'{component}.{variable.name}' is not recorded: so ends the name of a value without faults"


def _whole(signal: Signal) -> str:
    """Name of a signal, or of the bundle of which it is a member."""
    component, variable = signal.key
    return f"{component}.{names.bundle(variable) or variable}"


def _dated(signal: Signal, among: Sequence[tuple[Signal, Signal]]) -> bool:
    """Whether a signal belongs to a bundle whose time of validity goes the same way: it says itself how old it is."""
    component, variable = signal.key
    bundle = names.bundle(variable)
    return bool(bundle) and any(s.key == (component, f"{bundle}.time_of_validity") for s, _ in among)


def _notes(cut: Sequence[tuple[Signal, Signal]], algorithm: str, useless: Mapping[str, str]) -> Iterable[str]:
    late = dict.fromkeys(f"{_whole(s)} -> {_whole(t)}" for s, t in cut if not _dated(s, cut))
    if late and algorithm == "gauss_seidel":
        yield f"the system has cycles; one communication step late: {', '.join(late)}"
    for fault, why in useless.items():
        yield f"fault '{fault}' {why}: it cannot act"
