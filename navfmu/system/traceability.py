"""A run as a simulation task of SSP Traceability."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from navfmu.faults import Fault
from navfmu.files.checkout import commit_of
from navfmu.files.writing import write_file
from navfmu.ssp.traceability import Particle, Resource, Step, document, numbered
from navfmu.system.assembly import Assembly
from navfmu.system.experiment import Experiment, number
from navfmu.system.provenance import environment

if TYPE_CHECKING:
    import pandas


def write_task(frame: pandas.DataFrame, experiment: Experiment, results: Iterable[Path], file: Path) -> Path:
    """Write what was run, and which files came of it."""
    system = experiment.system
    inputs = [of_system(system), *of_faults(experiment.faults)]
    about = {
        "experiment": {
            "stop (s)": number(experiment.stop),
            "step (s)": number(experiment.step),
            "algorithm": experiment.algorithm,
            "engine": experiment.engine,
            "seed": "of the system" if experiment.seed is None else str(experiment.seed),
            "record_period (s)": number(experiment.record_period),
            "key": experiment.key,
        },
        "parameters": {name: str(value) for name, value in experiment.parameters.items()},
        "versions": environment(),
        "notes": numbered("note", frame.attrs["notes"]),
    }
    command = Resource("configuration", text=experiment.command(), type="text/x-shellscript")
    step = Step(Particle(tuple(inputs)), Particle((command,), about), Particle(tuple(map(of_result, results))))
    text = document(system.name, system.structure.description, {"ExecuteSimulation": step}, file.parent)
    return write_file(file, text)


def of_system(system: Assembly) -> Resource:
    """A system: its file, and in words what is in it."""
    origin = system.place if system.place.is_file() else system.structure.file.absolute()
    about = {"variant": system.variant or "", "digest": system.digest, "commit": commit_of(origin)}
    return Resource(
        "system",
        origin,
        about={"system": {name: value for name, value in about.items() if value}, "fmus.sha256": system.hashes()},
    )


def of_faults(faults: Sequence[Fault]) -> list[Resource]:
    """The faults as a fault file."""
    text = "\n".join(["fault = [", *(f"    {{ {fault.inline()} }}," for fault in faults), "]"])
    return [Resource("testcase", text=text, type="application/toml")] if faults else []


def of_result(file: Path) -> Resource:
    """A file that was written."""
    return Resource("report" if file.suffix == ".html" else "result", file.absolute())
