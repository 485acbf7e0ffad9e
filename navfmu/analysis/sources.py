"""Sources of errors made greater, smaller and silent: as parameters and faults of an experiment.

What an estimator is told of its sensors comes from the sensors in part, and a sensor that makes no errors says so: its
estimator would be another one. So that all runs have the same one, the inputs among ``claims`` stay, in all runs, what
they are in the mean of a run as it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from navfmu.analysis.ensemble import Window, table_of
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from navfmu.fmi.description import Variable
from navfmu.system.analysed import Source, knobs
from navfmu.system.experiment import Experiment

ERRORS, CLAIMS = KINDS = ("errors", "claims")


@dataclass(frozen=True)
class Sources:
    """The sources of an experiment's system that make errors in it, and what its estimator is told in the mean."""

    experiment: Experiment
    entries: tuple[Source, ...]
    told: Mapping[str, float]  # connected inputs among the claims, by name
    remarks: tuple[str, ...] = ()

    @classmethod
    def of(cls, experiment: Experiment, kind: str, window: Window) -> Sources:
        """The sources of a ``kind``, "errors" or "claims", after one run that shows what the estimator is told."""
        table = table_of(experiment.system)
        known = cls(experiment, tuple(table.source), {})
        loud, remarks = [], []
        for entry in table.source:
            if known._moved(entry, kind):
                loud.append(entry)
            else:
                what = "knows nothing of it" if kind == CLAIMS else "has no such errors"
                remarks.append(f"{entry.name} is left out: this variant {what}, or all its parameters are 0")
        if not loud:
            raise NavfmuError(
                f"{experiment.system.place}: its table [analysis] names no source of {kind} that this variant has; it "
                f"needs tables [[analysis.source]] with a 'name' and a list '{kind}' of parameters that are not 0"
            )
        return cls(experiment, tuple(loud), known._told(window), tuple(remarks))

    @property
    def names(self) -> list[str]:
        """What they are called."""
        return [entry.name for entry in self.entries]

    def factors(self, kind: str, factor: float, *names: str) -> dict[str, float]:
        """This factor for each parameter and input of a kind, of the sources with these names."""
        chosen = [entry for entry in self.entries if entry.name in names]
        return {name: factor for entry in chosen for name in self._moved(entry, kind)}

    def moved(self, factors: Mapping[str, float]) -> Experiment:
        """The experiment with parameters and inputs multiplied, or at the least that they can be."""
        parameters = {
            name: max(factor * value, -np.inf if variable.min is None else variable.min)
            for name, factor in factors.items()
            if name not in self.told
            for value, variable in [self._variables[name]]
        }
        faults = [
            Fault(f"told {name}", name, "stuck", value=factors.get(name, 1.0) * value)
            for name, value in self.told.items()
        ]
        own = self.experiment
        return replace(own, parameters={**own.parameters, **parameters}, faults=[*own.faults, *faults])

    def singles(self) -> dict[str, dict[str, tuple[float, Variable]]]:
        """Each parameter of errors by itself: its elements with value and variable."""
        fmus = self.experiment.system.fmus
        found: dict[str, dict[str, tuple[float, Variable]]] = {}
        for entry in self.entries:
            for pattern in entry.errors:
                for array, variables in knobs(pattern, fmus).items():
                    names = [f"{array.partition('.')[0]}.{variable.name}" for variable in variables]
                    loud = {name: self._variables[name] for name in names if self._variables[name][0] != 0.0}
                    if loud:
                        found[array] = loud
        return found

    @cached_property
    def _variables(self) -> dict[str, tuple[float, Variable]]:
        """Every Real parameter and input with the value at which it begins."""
        start = self.experiment.start_values()
        return {
            f"{component}.{variable.name}": (start[component].get(variable.name, variable.start or 0.0), variable)
            for component, fmu in self.experiment.system.fmus.items()
            for variable in fmu.description.variables
            if variable.type == "Real" and variable.causality in ("parameter", "input")
        }

    def _moved(self, entry: Source, kind: str) -> list[str]:
        """The elements that a source has here and that are not 0: they can be multiplied."""
        fed = {link.target for link in self.experiment.system.links}
        names = [
            f"{array.partition('.')[0]}.{variable.name}"
            for name in getattr(entry, kind)
            for array, variables in knobs(name, self.experiment.system.fmus).items()
            for variable in variables
        ]
        return [name for name in dict.fromkeys(names) if name in fed or self._variables[name][0] != 0.0]

    def _told(self, window: Window) -> dict[str, float]:
        """What connected inputs among the claims are in the mean over the window, in the run as it is."""
        fed = {link.target for link in self.experiment.system.links}
        inputs = [name for entry in self.entries for name in self._moved(entry, CLAIMS) if name in fed]
        if not inputs:
            return {}
        frame = replace(self.experiment, record=inputs).run()
        inside = frame[(frame.index >= window.start) & (frame.index <= window.end)]
        if not len(inside):
            raise NavfmuError(
                f"no point lies from {window.start:g} s to {window.end:g} s: the run ends at {self.experiment.stop:g} s"
            )
        return {name: float(inside[name].mean()) for name in inputs}
