"""One saboteur: an FMU that does to values on their way what faults do."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from navfmu.engine.effect import DELAY, RANDOM
from navfmu.engine.library import SOURCE
from navfmu.engine.link import Link
from navfmu.engine.plan import Plan
from navfmu.export.record import ir
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.sabotage.passage import Key, Passage, passages, units
from navfmu.sabotage.tables import tables

UNIT = "saboteur.c"
FILES = (
    Path(__file__).parent / "source" / UNIT,
    *(SOURCE / f"{name}.h" for name in ("master", "expression", "program", "act", "trigger")),
)
BEFORE, TO = "true.", "to."  # names of its inputs, and of outputs for one receiver, begin so


@dataclass(frozen=True)
class Saboteur:
    """An FMU to insert; ``inputs`` and ``outputs`` are names of its variables by (component, variable)."""

    name: str  # of the component
    behind: str  # the component whose outputs it takes; empty: none
    faults: tuple[str, ...]  # ids
    inputs: Mapping[Key, str]  # by the output that each takes
    outputs: Mapping[Key, str]  # by the output, or the input of one receiver, that each stands for
    model: ir.Model


def saboteurs(plan: Plan, links: Iterable[Link], seed: int, direct: bool) -> list[Saboteur]:
    """Those that do what the faults of a plan do.

    ``direct``: their outputs follow inputs that are set at the same communication point.
    """
    taken: set[str] = set()  # names of models
    return [_saboteur(passage, seed, direct, taken) for passage in passages(plan, links)]


def _saboteur(passage: Passage, seed: int, direct: bool, taken: set[str]) -> Saboteur:
    behind = passage.behind
    name = _free(f"{behind}_saboteur" if behind else "saboteur", passage.system)
    inputs = {passage.keys[slot]: f"{BEFORE}{passage.keys[slot][1]}" for slot in passage.entering}
    outputs = {key: key[1] if key[0] == behind else f"{TO}{'.'.join(key)}" for key in passage.leaving}
    variables = _variables(0, "input", {name: passage.variable(key) for key, name in inputs.items()})
    variables += _variables(len(inputs), "output", {name: passage.variable(key) for key, name in outputs.items()})
    place = len(inputs) + len(outputs) if _is_random(passage) else None
    if place is not None:
        variables.append(_seed(place, seed))
    sources = [tuple(map(passage.entering.index, of_one)) for of_one in passage.sources]
    model_name = _free(re.sub(r"\W|^(?=\d)", "_", name, flags=re.ASCII), taken)
    taken.add(model_name)
    header, memory = tables(passage, f"{model_name}_through", -1 if place is None else place)
    files = {file.name: file.read_text(encoding="utf-8") for file in FILES} | {"tables.h": header}
    model = ir.Model(
        model_name,
        f"Faults {', '.join(passage.faults)}" + (f" of what leaves {behind}" if behind else ""),
        tuple(variables),
        (),
        seed=place,
        documentation={"text": _text(passage)},
        through=ir.Through(
            step=passage.plan.clock.step,
            direct=direct,
            dependencies=dict(enumerate(sources, len(inputs))),
            memory=memory,
            unit=UNIT,
            files=files,
        ),
        units=units(passage, [*inputs, *outputs]),
    )
    return Saboteur(name, behind, passage.faults, inputs, outputs, model)


def _free(name: str, taken: Collection[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _is_random(passage: Passage) -> bool:
    """Whether one of the effects draws numbers: a delay does so if it has a jitter."""
    return any(e["kind"] in RANDOM and (e["kind"] != DELAY or e["other"] != 0.0) for e in passage.effects)


def _variables(index: int, causality: str, likes: Mapping[str, Variable]) -> list[ir.Variable]:
    """Variables of the saboteur, from ``index`` on, by name like those of the system; a whole array is one."""
    made: list[ir.Variable] = []
    ends = ((names.array(name), _variable(0, name, causality, like)) for name, like in likes.items())
    for (name, _), group in groupby(ends, lambda end: (end[0], replace(end[1], name="", start=()))):
        single = [variable for _, variable in group]
        start = sum((variable.start for variable in single), ())
        whole = replace(single[0], name=name, start=start, shape=names.subscript(single[-1].name))
        is_whole = whole.size == len(single) and [e.name for e in whole.elements()] == [v.name for v in single]
        for variable in [whole] if is_whole else single:
            made.append(replace(variable, index=index))
            index += variable.size
    return made


def _variable(index: int, name: str, causality: str, like: Variable) -> ir.Variable:
    """A variable of the saboteur that is like one of the system."""
    entering = causality == "input"
    return ir.Variable(
        index=index,
        name=name,
        type=like.type,
        causality=causality,
        variability="continuous" if like.type == "Real" and like.variability == "continuous" else "discrete",
        initial=None if entering else "calculated",
        start=(float(like.start or 0.0),),
        unit=like.unit,
        description=f"{'before' if entering else 'after'} the faults: {like.description or names.array(like.name)}",
        difference=like.relative,
    )


def _seed(index: int, seed: int) -> ir.Variable:
    return ir.Variable(
        index=index,
        name="seed",
        type="Integer",
        causality="parameter",
        variability="fixed",
        initial="exact",
        start=(float(seed),),
        min=(0.0,),
        max=(2.0**31 - 1,),
        description="seed of the random numbers of faults, that of the run; random times are those of the seed with "
        "which the saboteur was written",
    )


def _text(passage: Passage) -> str:
    """The faults, as ``--fault`` takes them."""
    faults = {fault.id: fault for fault in passage.plan.faults if fault}
    lines = ["Does to values on their way what these faults do in the master that the saboteur is from:", ""]
    lines += [f"    {faults[id].inline()}" for id in passage.faults]
    return "\n".join([*lines, "", "Times count from the start of the run."])
