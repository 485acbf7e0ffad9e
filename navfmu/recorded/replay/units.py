"""Units of recordings: those that people write elsewhere, too, and some that only loggers write."""

from __future__ import annotations

from navfmu.fmi.units import COMMON, Unit

UNITS = COMMON | {
    "ns": Unit("ns", COMMON["s"].exponents, 1e-9),
    "us": Unit("us", COMMON["s"].exponents, 1e-6),
    "G": Unit("G", COMMON["T"].exponents, 1e-4),
}


def alike(unit: str) -> list[str]:
    """Return the names of units of the same dimension."""
    return [name for name, other in UNITS.items() if other.exponents == UNITS[unit].exponents]
