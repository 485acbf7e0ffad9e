"""A system with saboteurs in the connections in which faults act, as a package that any master runs."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from navfmu.engine.plan import Plan
from navfmu.engine.trigger import LISTED
from navfmu.errors import NavfmuError
from navfmu.export.build import Progress, build
from navfmu.files.reading import what_is
from navfmu.fmi import names
from navfmu.sabotage.saboteur import Saboteur, saboteurs
from navfmu.ssp.writer import SystemSource
from navfmu.system.assembly import Assembly
from navfmu.system.experiment import Experiment

FAULTS = "saboteurs.toml"  # in the package: which faults were built in


@dataclass(frozen=True)
class Sabotaged:
    """A package that was written."""

    file: Path
    saboteurs: tuple[Saboteur, ...]
    notes: tuple[str, ...]  # sentences for the user


def sabotage(
    experiment: Experiment,
    file: str | Path,
    platforms: Iterable[str] | str = ("host",),
    direct: bool = False,
    progress: Progress | None = None,
) -> Sabotaged:
    """Write the system of an experiment with its faults built in, for the step size and the seed of the experiment.

    Its parameters are built in, too. The rest of an experiment is what the master does that will run the package.
    ``direct``: outputs of saboteurs follow inputs that are set at the same communication point, for masters that set
    these first; others see what they do one communication step late, be it direct or not.
    """
    if not experiment.faults:
        raise NavfmuError("there is no fault to build in: give a fault file, or --fault")
    plan = experiment.plan()
    _refuse(plan)
    seed = 1 if experiment.seed is None else experiment.seed
    found = saboteurs(plan, experiment.system.links, seed, direct)
    with tempfile.TemporaryDirectory(prefix="navfmu-") as folder:
        fmus = build([one.model for one in found], folder, platforms, progress=progress, pictures=False)
        source = _source(experiment, found, dict(zip((one.name for one in found), fmus, strict=True)))
        source.attach(FAULTS, _faults_file(experiment, Path(folder)))
        source.pack(file)
    return Sabotaged(Path(file), tuple(found), (*experiment.notes, *plan.notes))


def _refuse(plan: Plan) -> None:
    """Refuse what cannot be done on the way from an output to an input."""
    effects = len(plan.effects)
    for fault in plan.faults[effects:]:
        raise fault.error("a step of a component is lost by its master; a saboteur sees values only", "type")
    for effect, fault in zip(plan.effects, plan.faults, strict=False):
        slot = int(effect["slot"])
        key = names.split(plan.signals[slot])
        part = next(part for part in plan.parts if part.component.name == key[0])
        if part.component.description.by_name[key[1]].causality == "parameter":
            raise fault.error(f"'{plan.signals[slot]}' is a parameter, which no connection leads to", "target")
        if fault and plan.triggers[effect["trigger"]]["kind"] != LISTED:
            sentence = "it waits for a condition, and a saboteur does not see the signals that are asked for"
            raise fault.error(sentence, "when" if "when" in fault.parameters else "during")


def _source(experiment: Experiment, found: Sequence[Saboteur], fmus: dict[str, Path]) -> SystemSource:
    system, values = experiment.system, experiment.start_values()
    ids = dict.fromkeys(id for one in found for id in one.faults)
    text = system.structure.description
    source = SystemSource(
        system.name,
        description=f"{text}{' ' if text else ''}Saboteurs do what these faults do: {', '.join(ids)}.",
        stop_time=experiment.stop,
        step=experiment.step,
    )
    enters = {output: f"{one.name}.{name}" for one in found for output, name in one.inputs.items()}
    leaves = {key: f"{one.name}.{name}" for one in found for key, name in one.outputs.items()}
    driven = {key for one in found if not one.behind for key in one.outputs}
    for name, fmu in system.fmus.items():
        source.component(name, fmu.path.absolute())
        for one in found:
            if one.behind == name:
                source.component(one.name, fmus[one.name])
    for one in found:
        if not one.behind:
            source.component(one.name, fmus[one.name])
    for name, own in values.items():
        source.parameters(name, {key: value for key, value in own.items() if (name, key) not in driven})
    for output, input_ in enters.items():
        source.connect(".".join(output), input_)
    for link in system.links:
        ends = names.split(link.target), names.split(link.source)
        if link.scaled and ends[0] not in leaves:
            raise NavfmuError(
                f"connection {link.source} -> {link.target}: converts what it carries, which not every master can; "
                "a sabotaged system is written without conversions"
            )
        source.connect(leaves.get(ends[0]) or leaves.get(ends[1]) or link.source, link.target)
    for key in driven:
        source.connect(leaves[key], ".".join(key))
    _attach_report(source, system)
    return source


def _attach_report(source: SystemSource, system: Assembly) -> None:
    for name in ("extra/report.toml", "report.toml"):
        file = system.structure.file.parent / name
        if what_is(file) == "a file" and system.structure.file.suffix.lower() == ".ssd":
            source.attach("report.toml", file)
            return


def _faults_file(experiment: Experiment, folder: Path) -> Path:
    """The faults as a fault file, with the experiment that they were drawn for."""
    given = f"step {experiment.step!r} s, seed {1 if experiment.seed is None else experiment.seed}"
    lines = [f"# Built into the saboteurs of this package, for {given}.", "fault = ["]
    lines += [f"    {{ {fault.inline()} }}," for fault in experiment.faults]
    file = folder / FAULTS
    file.write_text("\n".join([*lines, "]", ""]), encoding="utf-8", newline="\n")
    return file
