"""Faults that change nothing in a run, and why: what can be said before it, and what is seen by running."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import reduce
from itertools import takewhile
from operator import or_

from navfmu.engine.clock import Clock
from navfmu.engine.effect import (
    ADD,
    AFFINE,
    DELAY,
    HOLD,
    NOISE,
    NOW,
    OBSERVED,
    RAMP,
    RECORDED,
    SCALE,
    SET,
    SLOW,
    SPIKE,
    Effect,
    Key,
    clusters,
)
from navfmu.engine.trigger import Windows, begin
from navfmu.faults.fault import Fault

MEMORIES = (HOLD, DELAY, SLOW)  # kinds by which a value is there after the fault that made it
NOTHING = {  # by kind, the amount and the other number that change nothing
    ADD: ((0.0, 0.0), "adds 0"),
    RAMP: ((0.0, 0.0), "adds 0"),
    NOISE: ((0.0, 0.0), "adds 0"),
    SPIKE: ((0.0, 0.0), "adds 0"),
    SCALE: ((1.0, 0.0), "multiplies by 1"),
    AFFINE: ((1.0, 0.0), "sends the number in its own unit"),
}


def idle(
    effects: Sequence[Effect],
    lists: Sequence[Windows],
    readers: Mapping[Key, int],
    clock: Clock,
    every: int,
    undisturbed: Mapping[Key, float],
) -> dict[str, str]:
    """Faults that cannot change anything in a run, by id, with the reason: "starts at 300 s, the run ends at 60 s".

    What depends on values is seen only by running (``unseen``). ``lists`` has the windows of each trigger, ``readers``
    who sees each variable; ``every`` are the steps between recorded points; ``undisturbed`` has the value of each
    driven variable without faults.
    """
    together = clusters(effects)
    on: dict[tuple[Key, ...], list[Effect]] = {}
    for effect in effects:
        if effect.fault is not None:
            on.setdefault(together[effect.key], []).append(effect)
    reasons: dict[str, list[str]] = {}
    for keys, found in on.items():
        own = undisturbed.get(keys[0]) if len(found) == 1 else None
        looking = reduce(or_, (readers.get(key, 0) for key in keys))
        for place, effect in enumerate(found):
            if _by_chance(effect.fault, lists[effect.trigger], clock.steps):
                continue
            later = found[place + 1 :]
            reason = _idle(effect, later, lists, looking, clock, every, own, alone=len(keys) == 1)
            reasons.setdefault(effect.fault.id, []).append(reason)
    return {fault: found[0] for fault, found in reasons.items() if all(found)}


def _by_chance(fault: Fault, windows: Windows, last: int) -> bool:
    """Whether a fault that fails at random does not do so up to a communication point: nothing is wrong with that."""
    return "mttf" in fault.parameters and begin(windows) > last


def spared(faults: Sequence[Fault], lists: Sequence[Windows], clock: Clock) -> list[str]:
    """A sentence for each fault that fails at random and does not do so in the run."""
    return [
        f"fault '{fault.id}' does not occur: it fails at random, and not before the end of the run"
        for fault, windows in zip(faults, lists, strict=False)
        if _by_chance(fault, windows, clock.steps)
    ]


def _idle(
    effect: Effect,
    later: Sequence[Effect],
    lists: Sequence[Windows],
    readers: int,
    clock: Clock,
    every: int,
    own: float | None,
    alone: bool,
) -> str:
    """Why an effect changes nothing, or an empty text; ``own`` is the value that a driven variable has anyway.

    ``alone``: no other variable gets its value.
    """
    windows = [window for window in lists[effect.trigger] if window.first <= clock.steps]
    name, starts = f"{effect.component}.{effect.variable}", f"starts at {lists[effect.trigger][0].start:.9g} s"
    if not windows:
        return f"{starts}, the run ends at {clock.time(clock.steps):.9g} s"
    if not readers:
        return f"acts on '{name}', which goes nowhere: it is neither connected nor recorded nor asked for"
    first = windows[0].first
    if readers == RECORDED and not any(_recorded(a, b, every, clock) for a, b in _traces(effect, later, lists)):
        return f"acts on '{name}', which is not connected, and at no point at which it is recorded"
    still = effect.kind == RAMP and clock.time(clock.steps) <= windows[0].start
    looking = NOW | OBSERVED | (RECORDED if first % every == 0 else 0)
    if first == clock.steps and (still or not readers & looking):
        return f"{starts}, the last communication point"
    numbers, nothing = NOTHING.get(effect.kind, (None, ""))
    if numbers == (effect.amount, effect.other):
        return nothing
    if effect.pairs and all(to == source for to, source in effect.pairs):
        return "leaves every element in its place"
    if effect.driven and effect.amount == own:
        return f"sets '{name}' to {effect.amount:.9g}, which it is anyway"
    before = takewhile(lambda other: other.kind not in MEMORIES, later)  # which would remember it
    setting = [lists[other.trigger] for other in before if other.kind == SET and not _waits(other)]
    if alone and any(
        all(_inside(window.first, min(window.end, clock.steps + 1), other) for window in windows) for other in setting
    ):
        return f"is hidden: all the time another fault sets '{name}'"
    return ""


def _waits(effect: Effect) -> bool:
    """Whether nobody knows before the run when an effect acts."""
    return effect.fault is not None and bool(effect.fault.condition)


def _traces(effect: Effect, later: Sequence[Effect], lists: Sequence[Windows]) -> list[tuple[int, int]]:
    """From where to where there may be something of an effect: in its windows, and as long as others remember it."""
    windows = lists[effect.trigger]
    remembered = [window.end for other in later if other.kind in MEMORIES for window in lists[other.trigger][-1:]]
    lasts = max([windows[-1].end, *(other for other in remembered if other > windows[0].first)])
    spans = [(window.first, window.end) for window in windows]
    return [(windows[0].first, lasts)] if lasts > windows[-1].end else spans


def _recorded(first: int, end: int, every: int, clock: Clock) -> bool:
    """Whether one of the points first <= k < end is recorded."""
    return -(-first // every) * every < min(end, clock.steps + 1)


def _inside(first: int, end: int, windows: Windows) -> bool:
    """Whether one of the windows holds all of another."""
    return any(window.first <= first and end <= window.end for window in windows)


def unseen(
    faults: Sequence[Fault | None],
    begins: Sequence[int],
    seen: Sequence[bool],
    never: Collection[str],
    clock: Clock,
    k: int,
) -> dict[str, str]:
    """Faults that have changed nothing in a run that came to point ``k``, by id, with the reason.

    ``faults``, the communication point at which each begins, and whether something was seen of it, are by effect.
    ``never`` are the ids of those that acted at no point.
    """
    acted = {fault.id for fault, was_seen in zip(faults, seen, strict=True) if fault and was_seen}
    nothing = (
        "changed nothing: without it every value that was recorded, or went to a component, would have been the same"
    )

    def reason(fault: Fault, first: int) -> str:
        if first > k:
            return f"starts at {fault.start:.9g} s, but the run ended at {clock.time(k):.9g} s"
        if fault.condition and fault.id in never:
            return f"never acted: {_unmet(fault)}"
        return nothing

    return {
        fault.id: reason(fault, first)
        for fault, first in zip(faults, begins, strict=True)
        if fault and fault.id not in acted and not ("mttf" in fault.parameters and (first > k or fault.id in never))
    }


def spared_by_its_condition(
    faults: Sequence[Fault | None], begins: Sequence[int], never: Collection[str], k: int
) -> list[str]:
    """A sentence for each fault that failed at random up to point ``k``, but never while its condition was met."""
    once = {fault.id: (fault, first) for fault, first in zip(faults, begins, strict=True) if fault}
    return [
        f"fault '{fault.id}' does not occur: it fails at random, and {_unmet(fault)}"
        for fault, first in once.values()
        if "mttf" in fault.parameters and fault.id in never and first <= k
    ]


def _unmet(fault: Fault) -> str:
    """In words, that the condition of a fault was not met before a point at which it could act."""
    held = f" for {fault.parameters['hold']:.9g} s" if fault.parameters.get("hold") else ""
    return f"'{fault.condition}' did not hold{held} just before any point at which it could act"
