"""What a run returns."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from navfmu.engine.component import Component
from navfmu.engine.idle import spared_by_its_condition, unseen
from navfmu.engine.monitor import Observed
from navfmu.engine.plan import Plan
from navfmu.engine.structures import Log
from navfmu.errors import NavfmuError
from navfmu.fmi.names import bundle


def room(plan: Plan) -> np.ndarray:
    """Room for every recorded point of a plan, shape (rows, columns), filled with NaN."""
    shape = plan.rows, len(plan.recorded)
    try:
        return np.full(shape, np.nan)
    except (MemoryError, ValueError):  # more than there is, more than an array can count
        raise too_large(plan) from None


def too_large(plan: Plan) -> NavfmuError:
    """The sentence for a recording that there is no room for."""
    rows, columns = plan.rows, len(plan.recorded)
    return NavfmuError(
        f"the recording of {columns} signals at {rows} points in time would take {rows * columns * 8 / 1e9:.0f} GB of "
        "memory; record fewer signals or take a longer recording period"
    )


Spans = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Recording:
    """Recorded signals: ``values[row, column]`` at ``time[row]`` (s). Booleans are 0 and 1."""

    names: tuple[str, ...]
    units: tuple[str | None, ...]
    types: tuple[str, ...]
    time: np.ndarray
    values: np.ndarray
    notes: tuple[str, ...] = ()  # sentences: what FMUs warned of, samples lost, values that are no numbers
    lost: Mapping[str, int] = field(default_factory=dict)  # samples that were missed, by counter: "ahrs.imu.lost"
    idle: Mapping[str, str] = field(default_factory=dict)  # faults that changed nothing, by id, and why
    observed: Mapping[str, Observed] = field(default_factory=dict)  # what monitors saw, by id
    acted: Mapping[str, Spans] = field(default_factory=dict)  # from when to when each fault acted (s), by id

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by name."""
        return self.values[:, self.names.index(name)]

    @cached_property
    def not_finite(self) -> dict[str, tuple[int, float]]:
        """Signals that are NaN or infinite: at how many points, and when first (s)."""
        wrong = ~np.isfinite(self.values)
        return {
            self.names[column]: (int(wrong[:, column].sum()), float(self.time[wrong[:, column].argmax()]))
            for column in np.flatnonzero(wrong.any(axis=0))
        }


class RunError(NavfmuError):
    """An FMU refused a call. ``recording`` holds what was recorded before; ``place``: component, call, time (s)."""

    def __init__(self, sentence: str, recording: Recording | None = None, **place: str | float) -> None:
        super().__init__(sentence)
        self.recording, self.place = recording, place


STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")


def refusal(component: str, call: str, status: int, time: float, message: str) -> str:
    """The sentence for a call that an FMU did not answer with OK."""
    name = STATUS[status] if 0 <= status < len(STATUS) else f"status {status}"
    said = message.strip() or "it gave no reason"
    if name == "Pending":
        said = "asynchronous steps are not supported"
    return f"component '{component}': {said} ({call} returned {name} at t = {time:.9g} s)"


def dead(component: Component) -> str:
    """The sentence for a component whose FMU has returned Fatal in another run."""
    return (
        f"component '{component.name}': its FMU '{component.description.model_identifier}' returned Fatal in another "
        "run of this process, after which none of its instances can be used"
    )


def got_to(last: float) -> str:
    """How far a step got that was discarded, as the FMU says (s; NaN: it does not say)."""
    return "" if math.isnan(last) else f"; it got as far as t = {last:.9g} s"


def ended(plan: Plan, logs: Sequence[Log], component: int, k: int, last: float) -> list[str]:
    """The sentence for a component that wanted no more after communication point ``k``; -1: there is none."""
    if component < 0 or k == plan.clock.steps:
        return []
    when = plan.clock.time(k) if math.isnan(last) else last
    stop = plan.clock.time(plan.clock.steps)
    name = plan.parts[component].component.name
    said = logs[component].refused()
    why = f": {said}" if said else ""
    return [f"component '{name}' ended the run at t = {when:.9g} s, before the stop time {stop:.9g} s{why}"]


def unmoved(
    plan: Plan, seen: Sequence[int], k: int, over: bool, turn: int, acted: Sequence[Sequence[tuple[int, int]]]
) -> dict[str, str]:
    """Faults that changed nothing up to communication point ``k``, by id, and why; none unless the run is ``over``.

    ``seen`` is by effect, then by loss, as in ``EFFECT`` and ``LOSS``. ``turn`` is the component at which the step
    after ``k`` was left without being complete, -1: there is none. ``acted`` has the communication points at which each
    trigger acted. Those that could not change anything are not told again.
    """
    if not over:
        return {}
    before, at_its_end = _taken(plan, turn)
    was = [
        0 <= at <= 3 * k or (at == 3 * k + 1 and slot in before) or (at == 3 * k + 2 and slot in at_its_end)
        for at, slot in zip(seen, plan.effects["slot"].tolist(), strict=False)
    ]
    was += [at >= 0 for at in seen[len(was) :]]
    found = unseen(plan.faults, plan.begins, was, _never(plan, acted), plan.clock, k)
    return {fault: why for fault, why in found.items() if fault not in plan.idle}


def _never(plan: Plan, acted: Sequence[Sequence[tuple[int, int]]]) -> list[str]:
    """The faults that acted at no point."""
    return [fault for fault, spans in zip(plan.fault_ids, acted, strict=False) if not spans]


def observed(plan: Plan, rows: Sequence[np.void] | np.ndarray, k: int) -> dict[str, Observed]:
    """What the plan's monitors saw up to communication point ``k``, by id."""
    return {question.id: Observed.of(row, plan.clock, k) for question, row in zip(plan.questions, rows, strict=True)}


def _taken(plan: Plan, turn: int) -> tuple[set[int], set[int]]:
    """Signals that components took in a step that was left at component ``turn``: as they leave before, at its end."""
    before: set[int] = set()
    at_its_end: set[int] = set()
    made: set[int] = set()  # the signals of components that have made the step, when others get their inputs
    one_by_one = plan.algorithm == "gauss_seidel"
    order = plan.order if one_by_one else range(len(plan.parts))
    came = () if turn < 0 else order[: order.index(turn) + 1] if one_by_one else order
    for part in (plan.parts[number] for number in came):
        before |= set(part.smooth.source.tolist())
        for group in (part.real, part.integer, part.boolean):
            for slot, ahead in zip(group.source.tolist(), group.ahead.tolist(), strict=True):
                (at_its_end if slot in made and not ahead else before).add(slot)
        if one_by_one:
            made |= {*range(part.first_signal, part.first_signal + part.signals)}
    return before, at_its_end


def recording(
    plan: Plan,
    rows: np.ndarray,
    warnings: Iterable[str] = (),
    lost: Mapping[str, int] | None = None,
    idle: Mapping[str, str] | None = None,
    seen: Mapping[str, Observed] | None = None,
    acted: Sequence[Sequence[tuple[int, int]]] = (),
    k: int = 0,
    over: bool = False,
) -> Recording:
    """A recording of the plan's columns from the rows of raw signals; scales what is scaled."""
    for number, column in enumerate(plan.recorded):
        if (column.factor, column.offset) != (1.0, 0.0):
            rows[:, number] = column.factor * rows[:, number] + column.offset
    made = Recording(
        names=tuple(column.name for column in plan.recorded),
        units=tuple(column.unit for column in plan.recorded),
        types=tuple(column.type for column in plan.recorded),
        time=np.array([plan.clock.time(row * plan.record_every) for row in range(len(rows))]),
        values=rows,
        lost=dict(lost or {}),
        idle=dict(idle or {}),
        observed=dict(seen or {}),
        acted={fault: _times(plan, spans, k) for fault, spans in zip(plan.fault_ids, acted, strict=False)},
    )
    unfelt = [f"fault '{fault}' {why}" for fault, why in made.idle.items()]
    by_chance = spared_by_its_condition(plan.faults, plan.begins, _never(plan, acted), k) if over else []
    return replace(made, notes=(*warnings, *unfelt, *by_chance, *missed(made.lost, plan), *not_finite(made)))


def _times(plan: Plan, spans: Sequence[tuple[int, int]], k: int) -> Spans:
    """When a fault acted (s), in a run that came to communication point ``k``, which is as far as is known."""
    return tuple((plan.clock.time(first), plan.clock.time(min(end, k))) for first, end in spans if first <= k)


# ---- notes -----------------------------------------------------------------------------------------------------------


def warned(plan: Plan, logs: Sequence[Log], counts: Sequence[int]) -> list[str]:
    """What components warned of; ``counts`` are their calls that returned Warning, with or without a message."""
    sentences = []
    for part, log, returned in zip(plan.parts, logs, counts, strict=True):
        count, said = max(returned, log.warnings), log.warned() or "it gave no reason"
        if count:
            times = "once" if count == 1 else f"{count} times, at last"
            sentences.append(f"component '{part.component.name}' warned {times}: {said}")
    return sentences


def complained(plan: Plan, logs: Sequence[Log], without: Collection[int]) -> list[str]:
    """Errors that components logged and that ended no run; ``without`` those whose errors are told elsewhere."""
    return [
        f"component '{part.component.name}' reported an error, and the run went on: {log.refused()}"
        for number, (part, log) in enumerate(zip(plan.parts, logs, strict=True))
        if log.errors and number not in without
    ]


def missed(lost: Mapping[str, int], plan: Plan) -> list[str]:
    """Which samples were lost."""
    why = "more than one came in a communication step, or in a tick of what sends them"
    if len(plan.effects):
        why += ", or a fault held them back"
    sentences = []
    for name, count in lost.items():
        if count:
            many, were = ("sample", "was") if count == 1 else ("samples", "were")
            sentences.append(f"{count} {many} of '{bundle(name)}' {were} lost ({why})")
    return sentences


def not_finite(recording: Recording) -> list[str]:
    """Which signals are not finite."""
    return [
        f"'{name}' is not finite at {count} of {len(recording.time)} recorded points, first at t = {first:.9g} s"
        for name, (count, first) in recording.not_finite.items()
    ]
