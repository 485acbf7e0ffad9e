"""What an FMU says about itself in modelDescription.xml: its variables, their units, what it can do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.units import Unit


@dataclass(frozen=True, slots=True)
class Variable:
    """A scalar variable of a model description; ``start``, ``min``, ``max`` and ``nominal`` are numbers in ``unit``.

    An enumeration is an Integer for everybody who sets, connects or records it; ``enumeration`` names its type.
    """

    name: str
    reference: int
    type: str  # Real, Integer, Boolean, String
    causality: str  # input, output, parameter, calculatedParameter, local, independent
    variability: str = "continuous"  # constant, fixed, tunable, discrete, continuous
    initial: str | None = None  # exact, approx, calculated
    start: float | int | bool | str | None = None
    unit: str | None = None
    display_unit: str | None = None
    min: float | None = None
    max: float | None = None
    nominal: float | None = None
    description: str = ""
    enumeration: str | None = None
    relative: bool = False  # a difference between two values, which has no origin: 10 degC is 10 K
    fault: bool = False  # an input that the model declares as a way to fail

    @property
    def settable(self) -> bool:
        """Whether it can be given a start value: a parameter, an input, or what starts at a value of one's choice."""
        if self.variability == "constant" or self.causality == "independent":
            return False
        return self.causality in ("parameter", "input") or self.initial in ("exact", "approx")


@dataclass(frozen=True)
class Description:
    """The part of modelDescription.xml that a master needs."""

    model_name: str
    guid: str
    model_identifier: str
    variables: tuple[Variable, ...] = field(repr=False)
    fmi_version: str = "2.0"
    description: str = ""
    version: str = ""
    generation_tool: str = ""
    needs_execution_tool: bool = False
    only_one_instance: bool = False
    can_get_and_set_state: bool = False
    can_serialize_state: bool = False
    can_interpolate_inputs: bool = False
    can_handle_variable_step: bool = False
    max_output_derivative_order: int = 0
    stop_time: float | None = None
    step_size: float | None = None
    tolerance: float | None = None  # of an integrator inside, if it has one
    units: Mapping[str, Unit] = field(default_factory=dict, repr=False)
    display_units: Mapping[str, Mapping[str, tuple[float, float]]] = field(  # unit, display unit: factor, offset
        default_factory=dict, repr=False
    )
    enumerations: Mapping[str, Mapping[str, int]] = field(default_factory=dict, repr=False)  # type: item: value
    #: Inputs on which an output depends while initialising; outputs that are not there depend on all of them.
    dependencies: Mapping[str, tuple[str, ...]] = field(default_factory=dict, repr=False)
    lenient: tuple[str, ...] = field(default=(), repr=False)  # what is not as FMI has it, and was read all the same

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> Description:
        """A description from plain data, as ``navfmu.fmi.reading`` reads it and the cache keeps it."""
        values = dict(content)
        values["variables"] = tuple(Variable(*row) for row in content["variables"])
        values["units"] = {
            name: Unit(name, None if exponents is None else tuple(exponents), factor, offset)
            for name, (exponents, factor, offset) in content["units"].items()
        }
        values["display_units"] = {
            unit: {name: (factor, offset) for name, (factor, offset) in entries.items()}
            for unit, entries in content["display_units"].items()
        }
        values["dependencies"] = {name: tuple(inputs) for name, inputs in content["dependencies"].items()}
        values["lenient"] = tuple(content["lenient"])
        return cls(**values)

    @cached_property
    def by_name(self) -> dict[str, Variable]:
        """Variables by name."""
        return {variable.name: variable for variable in self.variables}

    def variable(self, name: str, where: str) -> Variable:
        """The variable of that name, or a sentence with the nearest one."""
        found = self.by_name.get(name)
        if found is None:
            raise NavfmuError(f"{where}: {self.model_name} has no variable '{name}'{nearest(name, self.by_name)}")
        return found

    def items(self, variable: Variable) -> Mapping[str, int]:
        """The values of an enumeration by their names; empty for other variables."""
        return self.enumerations.get(variable.enumeration or "", {})

    def initial_inputs(self, output: Variable) -> tuple[str, ...]:
        """The inputs on which an output depends while initialising: all of them where the FMU does not say."""
        if output.initial == "exact" or output.variability == "constant":
            return ()
        return self.dependencies.get(output.name, tuple(v.name for v in self.with_causality("input")))

    def with_causality(self, *causalities: str) -> list[Variable]:
        """The variables of these causalities."""
        return [variable for variable in self.variables if variable.causality in causalities]


def refuse_lenient(what: str, lines: Sequence[str]) -> None:
    """Refuse what was read leniently."""
    if lines:
        more = f" (and {len(lines) - 1} more)" if len(lines) > 1 else ""
        raise NavfmuError(f"{what}: is read leniently, which --strict refuses: {lines[0]}{more}")
