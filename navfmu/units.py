"""Units as FMI and SSP describe them: exponents of the eight base units, a factor and an offset.

A value x in a unit is ``factor * x + offset`` in base units (kg, m, s, A, K, mol, cd, rad).
"""

from __future__ import annotations

from dataclasses import dataclass

from navfmu.errors import NavfmuError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True, slots=True)
class Unit:
    """One unit definition; ``exponents`` follow the order of ``BASE``. ``None`` exponents: only the name is known."""

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0


def conversion(source: Unit | None, target: Unit | None, where: str) -> tuple[float, float]:
    """Factor and offset that turn a value in ``source`` into ``target``: ``y = factor * x + offset``.

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
    return source.factor / target.factor, (source.offset - target.offset) / target.factor


def _angles_agree(a: Unit, b: Unit) -> bool:
    return a.exponents[7] == b.exponents[7] or 0 in (a.exponents[7], b.exponents[7])


def dimension(unit: Unit) -> str:
    """The base units of a unit as text: ``m.s-2``; ``1`` when it has none."""
    text = ".".join(
        f"{name}{power if power != 1 else ''}" for name, power in zip(BASE, unit.exponents or (), strict=False) if power
    )
    return text or "1"
