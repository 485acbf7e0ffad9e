"""Units as FMI and SSP describe them: exponents of the eight base units, a factor and an offset.

A value x in a unit is ``factor * x + offset`` in base units (kg, m, s, A, K, mol, cd, rad); a difference between two
values is ``factor * x``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from navfmu.constants import FOOT, KNOT, NAUTICAL_MILE, STANDARD_GRAVITY
from navfmu.errors import NavfmuError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True, slots=True)
class Unit:
    """One unit definition; ``exponents`` follow the order of ``BASE``. ``None`` exponents: only the name is known."""

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether values can be converted from it and to it, as far as numbers go."""
        return math.isfinite(self.factor) and self.factor != 0.0 and math.isfinite(self.offset)

    def agrees(self, other: Unit) -> bool:
        """Whether values in both mean the same, as far as both are defined; definitions are rounded."""
        if self.exponents is None or other.exponents is None:
            return True
        close = math.isclose(self.factor, other.factor, rel_tol=1e-6)
        close = close and math.isclose(self.offset, other.offset, rel_tol=1e-6, abs_tol=1e-9)
        return close and self.exponents[:7] == other.exponents[:7] and _angles_agree(self, other)

    @property
    def plain(self) -> bool:
        """Whether a value in it is a plain number."""
        return self.name == "1" or (self.exponents is not None and not any(self.exponents) and self.factor == 1.0)


def _unit(name: str, factor: float = 1.0, offset: float = 0.0, **powers: int) -> Unit:
    return Unit(name, tuple(powers.get(base, 0) for base in BASE), factor, offset)


_DEGREE = 0.017453292519943295  # rad
COMMON = {  # units that people write in parameters and limits, whether or not the FMU defines them
    unit.name: unit
    for unit in (
        _unit("s", s=1),
        _unit("m", m=1),
        _unit("m/s", m=1, s=-1),
        _unit("m/s2", m=1, s=-2),
        _unit("rad", rad=1),
        _unit("rad/s", rad=1, s=-1),
        _unit("rad/s2", rad=1, s=-2),
        _unit("K", K=1),
        _unit("Pa", kg=1, m=-1, s=-2),
        _unit("T", kg=1, s=-2, A=-1),
        _unit("%", 0.01),
        _unit("ppm", 1e-6),
        _unit("ms", 1e-3, s=1),
        _unit("min", 60.0, s=1),
        _unit("h", 3600.0, s=1),
        _unit("mm", 1e-3, m=1),
        _unit("km", 1e3, m=1),
        _unit("ft", FOOT, m=1),
        _unit("nmi", NAUTICAL_MILE, m=1),
        _unit("kn", KNOT, m=1, s=-1),
        _unit("km/h", 1.0 / 3.6, m=1, s=-1),
        _unit("ft/min", FOOT / 60.0, m=1, s=-1),
        _unit("g", STANDARD_GRAVITY, m=1, s=-2),
        _unit("mg", 1e-3 * STANDARD_GRAVITY, m=1, s=-2),
        _unit("deg", _DEGREE, rad=1),
        _unit("deg/s", _DEGREE, rad=1, s=-1),
        _unit("deg/h", _DEGREE / 3600.0, rad=1, s=-1),
        _unit("hPa", 100.0, kg=1, m=-1, s=-2),
        _unit("uT", 1e-6, kg=1, s=-2, A=-1),
        _unit("nT", 1e-9, kg=1, s=-2, A=-1),
        _unit("mG", 1e-7, kg=1, s=-2, A=-1),
        _unit("degC", 1.0, 273.15, K=1),
    )
}


def conversion(
    source: Unit | None, target: Unit | None, where: str, *, difference: bool = False
) -> tuple[float, float]:
    """Factor and offset that turn a value in ``source`` into ``target``: ``y = factor * x + offset``.

    A ``difference`` between two values has no origin: its offset is 0.

    No conversion where a unit is not given or both have the same name. Radians count as a dimension only when both
    units do so: rad/s and 1/s convert.
    """
    if source is None or target is None or source.name == target.name:
        return 1.0, 0.0
    for unit in (source, target):
        if unit.exponents is None:
            raise NavfmuError(
                f"{where}: '{source.name}' cannot be converted to '{target.name}': "
                f"unit '{unit.name}' has no definition by base units"
            )
    if source.exponents[:7] != target.exponents[:7] or not _angles_agree(source, target):
        raise NavfmuError(
            f"{where}: '{source.name}' cannot be converted to '{target.name}': "
            f"the first is {dimension(source)}, the second {dimension(target)}"
        )
    offset = 0.0 if difference else (source.offset - target.offset) / target.factor
    return source.factor / target.factor, offset


def per_second(unit: Unit) -> Unit:
    """The unit of a change of 1 of this unit in 1 s."""
    second = BASE.index("s")
    exponents = unit.exponents and tuple(power - (place == second) for place, power in enumerate(unit.exponents))
    return Unit(f"{unit.name}/s", exponents, unit.factor)


def alike(unit: Unit) -> list[str]:
    """Names of the common units of the same dimension."""
    return [name for name, common in COMMON.items() if common.exponents == unit.exponents]


def _angles_agree(a: Unit, b: Unit) -> bool:
    return a.exponents[7] == b.exponents[7] or 0 in (a.exponents[7], b.exponents[7])


def dimension(unit: Unit) -> str:
    """The base units of a unit as text: ``m.s-2``; ``1`` when it has none."""
    text = ".".join(
        f"{name}{power if power != 1 else ''}" for name, power in zip(BASE, unit.exponents or (), strict=False) if power
    )
    return text or "1"
