"""Epochs of RINEX observation files: when, and what was measured of which satellite of GPS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from navfmu.errors import NavfmuError
from navfmu.satellite.calendar import gps_time
from navfmu.satellite.header import Header
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import SATELLITES

WIDTH, PLACES, POINT = 16, 14, 10
"""Of an observation: a number, loss of lock, strength; of the number; and where its point is. A number that is cut off
has it elsewhere, or fewer digits behind it."""
LOST = tuple("1357")
"""Behind the phase of a carrier that was lost since the epoch before: bit 0."""
MEASURED = 1
"""The flag of an epoch up to which it holds observations; above it is an event, or a list of cycle slips."""
SLIPS = 6
NAMES_2, NAMES_3 = "# / TYPES OF OBSERV", "SYS / # / OBS TYPES"
OF_VERSION_2 = {
    "C1": "C1C", "P1": "C1W", "L1": "L1C", "D1": "D1C", "S1": "S1C", "C2": "C2X", "P2": "C2W", "L2": "L2W",
    "D2": "D2W", "S2": "S2W", "C5": "C5X", "L5": "L5X", "D5": "D5X", "S5": "S5X",
}  # fmt: skip
"""Names of version 2 and those of version 3, and 4, for the same."""


@dataclass
class Epoch:
    """What was measured at a time: satellite of GPS -> name -> value, which carriers (satellite, name) were lost
    since the epoch before, and which other systems there are."""

    line: int
    week: int
    second: float
    satellites: dict[int, dict[str, float]] = field(default_factory=dict)
    lost: set[tuple[int, str]] = field(default_factory=set)
    others: set[str] = field(default_factory=set)


def epochs(lines: Lines, header: Header) -> Iterator[Epoch]:
    """Yield the epochs of a file; events are passed over."""
    read, names = (_version_2, _types_2) if header.version < 3.0 else (_version_3, _types_3)
    types = names(lines, header)
    at = header.end + 1
    while at <= len(lines):
        if lines.line(at, "an epoch").strip():
            epoch, behind = read(lines, at, types)
            if epoch is None:
                _check_event(lines, header, at, behind)
            else:
                yield epoch
            at = behind
        else:
            at += 1


def _version_3(lines: Lines, at: int, types: list[str]) -> tuple[Epoch | None, int]:
    """The epoch that begins in a line (satellites in lines of their own), and the line behind it."""
    text = lines.line(at, "an epoch")
    if not text.startswith(">"):
        raise lines.wrong(at, f"begins with '{text[:4]}'; expected an epoch, which begins with '>'")
    flag, count = _flag(lines, at, text[31:32], text[32:35])
    behind = at + 1 + count
    if flag > MEASURED:
        return None, behind
    epoch = Epoch(at, *_time(lines, at, text[1:29]))
    for line in range(at + 1, behind):
        told = lines.line(line, f"{count} satellites of the epoch of line {at}")
        if told.startswith("G"):
            prn = _satellite(lines, line, told[1:3], epoch)
            _measured(lines, line, epoch, prn, types, lambda k, told=told: told[3 + WIDTH * k :])
        elif told[:1].isalpha():
            epoch.others.add(told[:1])
        else:
            raise lines.wrong(
                line, f"begins with '{told[:4]}'; expected one of the {count} satellites of the epoch of line {at}"
            )
    return epoch, behind


def _version_2(lines: Lines, at: int, types: list[str]) -> tuple[Epoch | None, int]:
    """The same; twelve satellites stand in each line of the epoch, five observations in each of a satellite."""
    text = lines.line(at, "an epoch")
    flag, count = _flag(lines, at, text[28:29], text[29:32])
    if MEASURED < flag < SLIPS:
        return None, at + 1 + count
    told = f"{count} satellites of the epoch of line {at}"
    heads, each = max(-(-count // 12), 1), -(-len(types) // 5)
    names = [lines.line(at + k // 12, told)[32 + 3 * (k % 12) :][:3] for k in range(count)]
    behind = at + heads + each * count
    if flag == SLIPS:
        return None, behind
    epoch = Epoch(at, *_time(lines, at, text[:26]))
    for line, name in zip(range(at + heads, behind, each), names, strict=True):
        rows = [lines.line(line + k, told) for k in range(each)]
        if name[:1] in ("G", " "):
            prn = _satellite(lines, at, name[1:], epoch)
            _measured(lines, line, epoch, prn, types, lambda k, rows=rows: rows[k // 5][WIDTH * (k % 5) :])
        elif name[:1].isalpha():
            epoch.others.add(name[:1])
        else:
            raise lines.wrong(at, f"of the {count} satellites one is '{name}'; expected one as in 'G05'")
    return epoch, behind


def _types_3(lines: Lines, header: Header) -> list[str]:
    """Names of the observations of GPS: the system and how many in the first line, thirteen in each."""
    told, mine = [], False
    for at, text in header.all(NAMES_3):
        if text[:1].strip():
            mine = text[0] == "G"
        if mine:
            told.append((at, text[3:6], text[6:]))
    return _names(lines, told)


def _types_2(lines: Lines, header: Header) -> list[str]:
    """Names of the observations of all systems, as in version 3."""
    told = [(at, text[:6], text[6:]) for at, text in header.all(NAMES_2)]
    return [OF_VERSION_2.get(name, name) for name in _names(lines, told)]


def _names(lines: Lines, told: list[tuple[int, str, str]]) -> list[str]:
    """The names in lines (number, how many there are, names)."""
    if not told:
        raise NavfmuError(f"{lines.path}: has no types of observations of GPS in its header; expected {lines.expected}")
    at, number, _ = told[0]
    count = lines.whole(at, number, "the number of types of observations")
    names = [name for _, _, text in told for name in text.split()]
    if len(names) != count:
        raise lines.wrong(at, f"tells of {count} types of observations; there are {len(names)}")
    return names


def _check_event(lines: Lines, header: Header, at: int, behind: int) -> None:
    """Refuse an event after which the columns are others."""
    known = lines.text[: header.end]
    for line in range(at + 1, behind):
        text = lines.line(line, f"{behind - at - 1} lines of the event of line {at}")
        if text[60:].strip() in (NAMES_2, NAMES_3) and text not in known:
            raise lines.wrong(line, "the types of observations change within the file; expected those of its header")


def _flag(lines: Lines, at: int, flag: str, count: str) -> tuple[int, int]:
    """The flag of an epoch, and the number of satellites, or of lines of an event."""
    told = lines.whole(at, flag.strip() or "0", "the flag of the epoch")
    number = lines.whole(at, count, "the number of satellites")
    if not 0 <= told <= SLIPS or number < 0:
        raise lines.wrong(at, f"the epoch has flag {told} and {number} satellites; expected a flag of 0 to {SLIPS}")
    return told, number


def _time(lines: Lines, at: int, text: str) -> tuple[int, float]:
    fields = text.split()
    if len(fields) != 6:
        raise lines.wrong(at, f"the time is '{text.strip()}'; expected year, month, day, hour, minute, second")
    return gps_time(*lines.instant(at, fields))


def _satellite(lines: Lines, at: int, text: str, epoch: Epoch) -> int:
    prn = lines.whole(at, text, "the satellite")
    if not 1 <= prn <= SATELLITES:
        raise lines.wrong(at, f"there is no satellite {prn} of GPS; expected 1 to {SATELLITES}")
    if prn in epoch.satellites:
        raise lines.wrong(at, f"satellite {prn} comes twice in an epoch")
    return prn


def _measured(lines: Lines, at: int, epoch: Epoch, prn: int, names: list[str], text: Callable[[int], str]) -> None:
    """Enter the observations of a satellite; what is missing is empty, or 0."""
    found = epoch.satellites[prn] = {}
    for k, name in enumerate(names):
        told = text(k)
        number = told[:PLACES]
        if not number.strip():
            continue
        if number[POINT : POINT + 1] != "." or len(number.rstrip()) < PLACES:
            raise lines.wrong(
                at, f"{name} is '{number.strip()}' in {PLACES} columns; expected three digits behind a point at the end"
            )
        if value := lines.number(at, number, name):
            found[name] = value
            if told[PLACES : PLACES + 1] in LOST and name.startswith("L"):
                epoch.lost.add((prn, name))
