"""One saboteur: the signals of one component on which faults act, or the inputs that nothing else drives."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.engine.effect import DELAY, RANDOM
from navfmu.engine.library import SOURCE
from navfmu.engine.link import Link
from navfmu.engine.plan import Plan
from navfmu.export import ir
from navfmu.export.graph import c_number
from navfmu.fmi import names
from navfmu.fmi.description import Description, Variable
from navfmu.fmi.units import Unit
from navfmu.sabotage import tables

HERE = Path(__file__).parent / "source"
UNIT = "saboteur.c"
HEADERS = ("master.h", "expression.h", "program.h", "act.h", "trigger.h")  # of the compiled master
BEFORE, TO = "true.", "to."  # names of its inputs, and of outputs for one receiver, begin so

Key = tuple[str, str]  # component, variable


@dataclass(frozen=True)
class Saboteur:
    """An FMU to insert; ``inputs`` and ``outputs`` are names of its variables by (component, variable)."""

    name: str  # of the component
    behind: str  # the component whose outputs it takes; empty: none
    faults: tuple[str, ...]  # ids
    inputs: Mapping[Key, str]  # by the output that each takes
    outputs: Mapping[Key, str]  # by the output, or the input of one receiver, that each stands for
    model: ir.Model


def saboteurs(plan: Plan, links: Sequence[Link], seed: int, direct: bool) -> list[Saboteur]:
    """Those that do what the faults of a plan do.

    ``direct``: their outputs follow inputs that are set at the same communication point.
    A bundle with a member on which a fault acts passes through as a whole: its members stay together.
    """
    system = {part.component.name: part.component.description for part in plan.parts}
    found = []
    for part in plan.parts:
        rows = range(part.first_effect, part.first_effect + part.effects)
        found += [_saboteur(plan, system, links, part.component.name, rows, seed, direct)] if rows else []
    driven = range(plan.first_driven_effect, len(plan.effects))
    return [*found, _saboteur(plan, system, (), "", driven, seed, direct)] if driven else found


def _saboteur(
    plan: Plan,
    system: Mapping[str, Description],
    links: Iterable[Link],
    behind: str,
    rows: Iterable[int],
    seed: int,
    direct: bool,
) -> Saboteur:
    effects = plan.effects[list(rows)]
    pairs = [plan.reached(effect["first_pair"], 2 * effect["pairs"]) for effect in effects]
    # What each effect changes, and what else it takes.
    changed = [own[: len(own) // 2] or [int(effect["slot"])] for own, effect in zip(pairs, effects, strict=True)]
    known = {names.split(signal): slot for slot, signal in enumerate(plan.signals)}
    keys = {slot: key for key, slot in known.items()}
    leaving = {keys[slot]: slot for slot in sorted({slot for of_one in changed for slot in of_one})}
    leaving |= _companions(leaving, known, system, links, behind)
    slots = sorted({*leaving.values(), *(slot for own in pairs for slot in own)})
    entering = [slot for slot in slots if slot < plan.first_driven and keys[slot][0] == behind]

    random = any(effect["kind"] in RANDOM and _draws(effect) for effect in effects)
    ids = tuple(dict.fromkeys(fault.id for row in rows if (fault := plan.faults[row])))
    name = _free(f"{behind}_saboteur" if behind else "saboteur", system)
    inputs = {keys[slot]: f"{BEFORE}{keys[slot][1]}" for slot in entering}
    outputs = {key: key[1] if key[0] == behind else f"{TO}{'.'.join(key)}" for key in leaving}
    variables = [_variable(i, name, "input", _of(key, system)) for i, (key, name) in enumerate(inputs.items())]
    variables += [
        _variable(i, name, "output", _of(key, system)) for i, (key, name) in enumerate(outputs.items(), len(inputs))
    ]
    if random:
        variables.append(_seed(len(variables), seed))
    places = {slot: place for place, slot in enumerate(slots)}
    entry = {slot: variable for variable, slot in enumerate(entering)}
    reached = {slot: (slot,) for slot in slots}
    for effect, of_one in zip(effects, changed, strict=True):
        reached |= dict.fromkeys(of_one, plan.reached(effect["first_reach"], effect["reaches"]))
    depends = {
        i: tuple(sorted({entry[other] for other in reached[slot] if other in entry}))
        for i, slot in enumerate(leaving.values(), len(inputs))
    }

    model_name = re.sub(r"\W", "_", name, flags=re.ASCII)
    memory, own = _own(plan, effects, pairs, places)
    constants = {
        "THROUGH": f"{model_name}_through",
        "SEED": len(variables) - 1 if random else -1,
        "SIGNALS": len(slots),
        "EFFECTS": len(effects),
        "TRIGGERS": len(own["Trigger", "triggers"]),
        "OUTPUTS": len(leaving),
        "NUMERATOR": c_number(plan.clock.numerator),
        "DENOMINATOR": c_number(plan.clock.denominator),
    }
    base = {slot: plan.driven[slot - plan.first_driven] for slot in slots if slot >= plan.first_driven}
    arrays = own | {
        ("int32_t", "entry"): [str(entry.get(slot, -1)) for slot in slots],
        ("double", "otherwise"): [c_number(float(base.get(slot, 0.0))) for slot in slots],
        ("struct { int32_t reference, signal; }", "leaves"): [
            f"{{{variable}, {places[slot]}}}" for variable, slot in enumerate(leaving.values(), len(inputs))
        ],
    }
    files = {header: (SOURCE / header).read_text(encoding="utf-8") for header in HEADERS}
    files |= {UNIT: (HERE / UNIT).read_text(encoding="utf-8"), "tables.h": tables.header(constants, arrays)}
    model = ir.Model(
        model_name,
        f"Faults {', '.join(ids)}" + (f" of what leaves {behind}" if behind else ""),
        tuple(variables),
        (),
        seed=len(variables) - 1 if random else None,
        documentation={"text": _text(plan, ids)},
        through=ir.Through(plan.clock.step, direct, depends, tuple(memory), UNIT, files),
        units=_units([*inputs, *outputs], system),
    )
    return Saboteur(name, behind, ids, inputs, outputs, model)


def _companions(
    leaving: Iterable[Key],
    known: Mapping[Key, int],
    system: Mapping[str, Description],
    links: Iterable[Link],
    behind: str,
) -> dict[Key, int]:
    """Further members of the bundles of which some leave, with the signals that they are."""
    found: dict[Key, int] = {}
    bundles = {(component, bundle) for component, name in leaving if (bundle := names.bundle(name))}
    bundles = {(c, b) for c, b in bundles if {f"{b}.sequence", f"{b}.valid"} <= system[c].by_name.keys()}
    for key, slot in known.items():
        if key[0] == behind and (behind, names.bundle(key[1])) in bundles and _of(key, system).causality == "output":
            found[key] = slot
    for link in links:
        source, target = names.split(link.source), names.split(link.target)
        if source[0] == behind and (target[0], names.bundle(target[1])) in bundles and not link.scaled:
            found[target] = known[source]
    return {key: slot for key, slot in found.items() if key not in leaving}


def _own(plan: Plan, effects: np.ndarray, pairs: list[list[int]], places: Mapping[int, int]) -> tuple[list, dict]:
    """The rows of a plan for these effects alone: what they remember before the run, and tables by type and name."""
    effects = effects.copy()
    memory: list[float] = []
    reach: list[int] = []
    triggers: list[np.void] = []
    windows: list[np.void] = []
    numbers: dict[int, int] = {}
    for effect, own in zip(effects, pairs, strict=True):
        number = int(effect["trigger"])
        if number not in numbers:
            numbers[number] = len(triggers)
            trigger = plan.triggers[number].copy()
            there = plan.windows[trigger["window"] : trigger["last"]]
            trigger["window"], trigger["last"] = len(windows), len(windows) + len(there)
            trigger["first_span"], trigger["room"] = len(triggers), 1  # when it acted is not kept
            triggers.append(trigger)
            windows += list(there)
        place = int(effect["memory"])
        remembered = plan.memory[place : place + effect["size"]].tolist()
        effect["slot"], effect["trigger"] = places[int(effect["slot"])], numbers[number]
        effect["memory"], effect["first_pair"] = len(memory), len(reach)
        for name in LOOKING:
            effect[name] = 0
        memory += remembered
        reach += [places[slot] for slot in own]
    return memory, {
        ("Effect", "effects"): [tables.row(effect) for effect in effects],
        ("Trigger", "triggers"): [tables.row(trigger) for trigger in triggers],
        ("Window", "windows"): [tables.row(window) for window in windows] or ["{0}"],
        ("int32_t", "reach"): list(map(str, reach)) or ["0"],
    }


#: What the master needs to find out whether anybody sees an effect.
LOOKING = ("first_reach", "reaches", "foreseen", "before", "first_echo", "echoes", "followed", "seen")


def _draws(effect: np.void) -> bool:
    return effect["kind"] != DELAY or effect["other"] != 0.0


def _of(key: Key, system: Mapping[str, Description]) -> Variable:
    return system[key[0]].by_name[key[1]]


def _free(name: str, taken: Iterable[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _variable(index: int, name: str, causality: str, like: Variable) -> ir.Variable:
    """A variable of the saboteur that is like one of the system."""
    entering = causality == "input"
    return ir.Variable(
        index=index,
        name=name,
        type=like.type,
        causality=causality,
        variability=like.variability if like.type == "Real" and like.variability == "continuous" else "discrete",
        initial=None if entering else "calculated",
        start=float(like.start or 0.0),
        unit=like.unit if like.type == "Real" else None,
        description=f"{'before' if entering else 'after'} the faults: {like.description or like.name}",
        difference=like.relative,
    )


def _seed(index: int, seed: int) -> ir.Variable:
    return ir.Variable(
        index,
        "seed",
        "Integer",
        "parameter",
        "fixed",
        "exact",
        float(seed),
        min=0.0,
        max=2.0**31 - 1,
        description="seed of the random numbers of faults, that of the run; random times are those of the seed with "
        "which the saboteur was written",
    )


def _units(keys: Iterable[Key], system: Mapping[str, Description]) -> dict[str, Unit]:
    found: dict[str, Unit] = {}
    for component, variable in keys:
        unit = system[component].by_name[variable].unit
        if unit:
            found.setdefault(unit, system[component].units.get(unit) or Unit(unit))
    return found


def _text(plan: Plan, ids: Iterable[str]) -> str:
    faults = {fault.id: fault for fault in plan.faults if fault}
    lines = [f"    {faults[id].inline()}" for id in ids]
    return "\n".join(
        [
            "Does to values on their way what these faults do in the master that the saboteur is from:",
            "",
            *lines,
            "",
            "Times count from the start of the run.",
        ]
    )
