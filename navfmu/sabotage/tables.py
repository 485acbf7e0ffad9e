"""Rows of a plan as C: what the compiled master would read, a saboteur has inside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from navfmu.export.printing.printer import c_number
from navfmu.sabotage.passage import Passage

#: What the master needs to find out whether anybody sees an effect.
LOOKING = ("first_reach", "reaches", "foreseen", "before", "first_echo", "echoes", "followed", "seen")


def tables(passage: Passage, through: str, seed: int) -> tuple[str, tuple[float, ...]]:
    """``tables.h``, and what is remembered before the run.

    ``through`` is the name of the function that calculates what leaves, ``seed`` the place of the seed among the
    variables, or -1.
    """
    plan, place = passage.plan, {slot: number for number, slot in enumerate(passage.slots)}
    memory: list[float] = []
    reach: list[int] = []
    triggers: list[np.void] = []
    windows: list[np.void] = []
    number_of: dict[int, int] = {}  # triggers, by their number in the plan
    effects = passage.effects.copy()
    for effect, own in zip(effects, passage.pairs, strict=True):
        number = int(effect["trigger"])
        if number not in number_of:
            number_of[number] = len(triggers)
            triggers.append(_trigger(plan.triggers[number], len(triggers), len(windows)))
            windows += list(plan.windows[plan.triggers[number]["window"] : plan.triggers[number]["last"]])
        first = int(effect["memory"])
        remembered = plan.memory[first : first + effect["size"]].tolist()
        effect["slot"], effect["trigger"] = place[int(effect["slot"])], number_of[number]
        effect["memory"], effect["first_pair"] = len(memory), len(reach)
        for name in LOOKING:
            effect[name] = 0
        memory += remembered
        reach += [place[slot] for slot in own]
    entry = {slot: variable for variable, slot in enumerate(passage.entering)}
    leaves = enumerate(passage.leaving.values(), len(passage.entering))
    constants = {
        "THROUGH": through,
        "SEED": seed,
        "SIGNALS": len(passage.slots),
        "EFFECTS": len(effects),
        "TRIGGERS": len(triggers),
        "OUTPUTS": len(passage.leaving),
        "NUMERATOR": c_number(plan.clock.numerator),
        "DENOMINATOR": c_number(plan.clock.denominator),
    }
    arrays = {
        "Effect effects": map(_row, effects),
        "Trigger triggers": map(_row, triggers),
        "Window windows": map(_row, windows),
        "int32_t reach": map(str, reach),
        "int32_t entry": (str(entry.get(slot, -1)) for slot in passage.slots),  # where in v each signal comes from
        "double otherwise": (c_number(passage.undisturbed.get(slot, 0.0)) for slot in passage.slots),  # if nowhere
        "struct { int32_t reference, signal; } leaves": (f"{{{v}, {place[slot]}}}" for v, slot in leaves),
    }
    return _header(constants, arrays), tuple(memory)


def _trigger(row: np.void, number: int, window: int) -> np.void:
    """A trigger that does not keep when it acted."""
    trigger = row.copy()
    trigger["window"], trigger["last"] = window, window + row["last"] - row["window"]
    trigger["first_span"], trigger["room"] = number, 1
    return trigger


def _header(constants: Mapping[str, object], arrays: Mapping[str, Iterable[str]]) -> str:
    lines = ["/* What this saboteur does: rows of the plan of the compiled master. */"]
    lines += [f"#define {name} {value}" for name, value in constants.items()]
    for name, items in arrays.items():
        rows = [f"    {item}," for item in items] or ["    0,"]  # C has no array of length 0
        lines += ["", f"static const {name}[] = {{", *rows, "};"]
    return "\n".join(lines) + "\n"


def _row(values: np.void) -> str:
    """A row as a C initialiser; what is 0 is left out, the fields have their names in C."""
    fields = [f".{name} = {_number(values[name])}" for name in values.dtype.names if _is_there(values[name])]
    return f"{{{', '.join(fields) or '0'}}}"


def _is_there(value: np.generic) -> bool:
    return any(map(_is_there, value)) if isinstance(value, np.void) else value.tobytes() != bytes(value.nbytes)


def _number(value: np.generic) -> str:
    if isinstance(value, np.void):
        return _row(value)
    if isinstance(value, np.floating):
        return c_number(float(value))
    return f"{'U' if value.dtype.kind == 'u' else ''}INT64_C({int(value)})"
