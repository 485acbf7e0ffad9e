"""The header of a RINEX file, versions 2 to 4: lines with a label from column 61 on."""

from __future__ import annotations

from dataclasses import dataclass, field

from navfmu.errors import NavfmuError
from navfmu.satellite.lines import Lines

FIRST, LAST = "RINEX VERSION / TYPE", "END OF HEADER"
VERSIONS = (2.0, 5.0)


@dataclass(frozen=True)
class Header:
    """Version, type (N navigation, O observation), system of satellites, and the lines by their labels."""

    version: float
    type: str
    system: str
    end: int  #: number of its last line
    lines: dict[str, list[tuple[int, str]]] = field(default_factory=dict)

    def all(self, label: str) -> list[tuple[int, str]]:
        """The lines of a label, (number, text before the label)."""
        return self.lines.get(label, [])

    def one(self, label: str) -> tuple[int, str] | None:
        """The last line of a label."""
        return self.all(label)[-1] if self.all(label) else None


def is_rinex(lines: Lines) -> bool:
    """Whether a file calls itself RINEX."""
    return bool(lines.text) and FIRST in lines.text[0]


def read_header(lines: Lines, type: str) -> Header:
    """Read the header of a file of a type."""
    first = lines.line(1, "a header of RINEX")
    if first[60:].strip() != FIRST:
        raise lines.wrong(1, f"does not end with '{FIRST}'; expected {lines.expected}")
    version = lines.number(1, first[:9], "the version")
    low, high = VERSIONS
    if not low <= version < high:
        raise lines.wrong(1, f"is of version {version:g}; expected 2, 3 or 4")
    if (found := first[20:21].upper()) != type:
        raise lines.wrong(1, f"the file is of type '{first[20:40].strip()}'; expected {lines.expected}")
    known: dict[str, list[tuple[int, str]]] = {}
    for at in range(2, len(lines) + 1):
        text = lines.line(at, "a header")
        label = text[60:].strip()
        if label == LAST:
            return Header(version, found, first[40:41].upper().strip(), at, known)
        known.setdefault(label, []).append((at, text[:60]))
    raise NavfmuError(f"{lines.path}: has no line '{LAST}'; expected {lines.expected}, the file is cut off")
