"""The unit in which a variable is shown to people: the FMU's display unit, where it has one."""

from __future__ import annotations

from dataclasses import dataclass

from navfmu.fmi.description import Description, Variable

ANGLE = (0, 0, 0, 0, 0, 0, 0, 1)  # exponents of a unit that measures an angle and nothing else


@dataclass(frozen=True)
class Display:
    """A value x in the variable's own unit is shown as ``factor * x + offset``."""

    unit: str
    factor: float = 1.0
    offset: float = 0.0
    angle: bool = False

    @classmethod
    def of(cls, variable: Variable, about: Description) -> Display:
        """How a variable of an FMU is shown."""
        unit = variable.unit or ""
        definition = about.units.get(unit)
        angle = unit == "rad" or (definition is not None and definition.exponents == ANGLE)
        shown = about.display_units.get(unit, {}).get(variable.display_unit or "")
        if shown is None or variable.display_unit == unit:
            return cls(unit, angle=angle)
        factor, offset = shown
        return cls(variable.display_unit, factor, 0.0 if variable.relative else offset, angle)

    def text(self, value: float) -> str:
        """A number with six digits; an angle with six decimals, which is 0.1 m of latitude in degrees."""
        shown = self.factor * value + self.offset
        return f"{round(shown, 6):.9g}" if self.angle and abs(shown) >= 1.0 else f"{shown:.6g}"
