"""An instance of an FMU as the master and faults see it: its variables, its start values, what it can do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from navfmu.fmi.fmu import Fmu


@dataclass(frozen=True)
class Variable:
    """A scalar variable of an FMU, as in its modelDescription.xml. Enumerations count as Integer."""

    name: str
    reference: int
    type: str  # "Real", "Integer", "Boolean", "String"
    causality: str  # "input", "output", "parameter", "calculatedParameter", "local", "independent"
    variability: str = "continuous"  # "constant", "fixed", "tunable", "discrete", "continuous"
    initial: str | None = None  # "exact", "approx", "calculated"
    start: Any = None
    unit: str | None = None
    min: float | None = None
    max: float | None = None


@dataclass(frozen=True)
class Component:
    """An FMU instance of a system: an unpacked FMI 2.0 co-simulation FMU, its variables and its start values."""

    name: str
    directory: Path  # the unpacked FMU; resources are in its folder "resources"
    library: Path  # the binary for this machine
    identifier: str  # modelIdentifier
    guid: str
    variables: Mapping[str, Variable]
    start: Mapping[str, Any] = field(default_factory=dict)  # parameters and inputs, set before initialisation
    interpolates: bool = False  # canInterpolateInputs
    restores: bool = False  # canGetAndSetFMUstate
    single: bool = False  # canBeInstantiatedOnlyOncePerProcess

    @classmethod
    def of_fmu(cls, name: str, fmu: Fmu, start: Mapping[str, Any] | None = None) -> Component:
        """The instance ``name`` of a loaded FMU."""
        about = fmu.description
        return cls(
            name=name,
            directory=fmu.folder,
            library=fmu.library,
            identifier=about.model_identifier,
            guid=about.guid,
            variables={v.name: _counted(v) for v in about.variables},
            start=dict(start or {}),
            interpolates=about.can_interpolate_inputs,
            restores=about.can_get_and_set_state,
            single=about.only_one_instance,
        )

    def elements(self, name: str) -> list[Variable]:
        """The variable of this name, or the elements of the array of this name (``x`` -> ``x[1]``, ``x[2]`` ...)."""
        if name in self.variables:
            return [self.variables[name]]
        return [v for v in self.variables.values() if v.name.startswith(name + "[")]

    def with_causality(self, causality: str) -> list[Variable]:
        """The variables of one causality."""
        return [v for v in self.variables.values() if v.causality == causality]


def _counted(variable: Any) -> Any:
    """A variable of a model description, which has the attributes of ``Variable``; enumerations become Integer."""
    return replace(variable, type="Integer") if variable.type == "Enumeration" else variable
