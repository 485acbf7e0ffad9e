"""One run of a test, and what is told of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from navfmu.report import faults
from navfmu.system.experiment import Experiment
from navfmu.testing.asked import Asked

if TYPE_CHECKING:
    import pandas


@dataclass
class Flown:
    """One run: the experiment, and what there is of its recording."""

    number: int  # in the test, from 1
    experiment: Experiment
    frame: pandas.DataFrame | None
    command: str  # that repeats it
    twins: tuple[str, ...] = ()
    asked: list[Asked] = field(default_factory=list)  # what was required of it
    files: list[tuple[str, str]] = field(default_factory=list)  # what was kept of it: what, and where

    @property
    def title(self) -> str:
        """The system, whichever its variant."""
        return self.experiment.system.place.stem

    @property
    def name(self) -> str:
        """The run in a few words: "scanning variant, seed 7"."""
        system, seed = self.experiment.system, self.experiment.seed
        variant = [] if system.place.suffix == ".fmu" else [f"{system.variant or 'main'} variant"]
        return ", ".join([*variant, "the system's own seeds" if seed is None else f"seed {seed}"])

    def told(self) -> list[tuple[str, str]]:
        """What a failed test says of it: a word, and what it stands for."""
        experiment = self.experiment
        how = f"{experiment.stop:g} s in steps of {experiment.step:g} s, {experiment.algorithm}"
        rows = [("system", f"{self.title}, {self.name}"), ("run", how)]
        rows += [("twin", name) for name in self.twins]
        rows += [("parameter", f"{name} = {value}") for name, value in experiment.parameters.items()]
        rows += [("fault", _fault(fault.describe())) for fault in experiment.faults]
        rows += [("note", note) for note in ([] if self.frame is None else self.frame.attrs["notes"])]
        return [*rows, *self.files, ("repeat", self.command)]


def _fault(description: dict) -> str:
    name, target, kind, when = faults.cells(description)
    return f"{'' if name == target else f'{name}: '}{kind} on {target}, {when}"
