"""RINEX observation files, versions 2 and 3: what a receiver measured of satellites of GPS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.satellite.calendar import WEEK, first_day, gps_time, leap_seconds
from navfmu.satellite.header import Header, read_header
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import SATELLITES, moment

EXPECTED = "a RINEX observation file of version 2 or 3"
SYSTEMS = ("GPS", "GAL", "QZS", "")
"""Time systems that are GPS time, to some ns. UTC and that of GLONASS are behind it."""
WIDTH = 16
"""Of an observation: a number of 14 places, loss of lock, strength."""
OF_VERSION_2 = {
    "C1": "C1C", "P1": "C1W", "L1": "L1C", "D1": "D1C", "S1": "S1C", "C2": "C2X", "P2": "C2W", "L2": "L2W",
    "D2": "D2W", "S2": "S2W", "C5": "C5X", "L5": "L5X", "D5": "D5X", "S5": "S5X",
}  # fmt: skip
"""Names of version 2 and those of version 3 for the same."""


@dataclass(frozen=True)
class Observations:
    """What a receiver measured.

    Attributes
    ----------
    week, second : (n,), when, by the receiver's clock: GPS week and second of it
    values : name of RINEX 3 ("C1C" m, "L1C" cycles, "D1C" Hz, "S1C" dB-Hz) -> (n, 32), a column for each satellite of
        GPS from 1 on, NaN where nothing was measured
    position_e : (3,) approximate position of the antenna's marker, m, or None
    remarks : what was found, and what was left out
    """

    source: str
    marker: str
    week: np.ndarray
    second: np.ndarray
    values: dict[str, np.ndarray]
    position_e: np.ndarray | None
    remarks: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.week)

    def named(self, name: str) -> np.ndarray:
        """What was measured under a name, (n, 32)."""
        if name not in self.values:
            have = ", ".join(self.values)
            raise NavfmuError(f"{self.source}: has no '{name}'; there are {have}{nearest(name, self.values)}")
        return self.values[name]

    def sentences(self) -> list[str]:
        """What there is to say, for the user."""
        at = self.week * WEEK + self.second
        seen = np.any([np.isfinite(value) for value in self.values.values()], axis=0)
        count = seen.sum(axis=1)
        told = [
            f"{self.marker or 'receiver'}: {len(self)} epochs from {moment(at[0])} to {moment(at[-1])}, "
            f"{count.min()} to {count.max()} satellites of GPS, {', '.join(self.values)}"
        ]
        if len(self) > 1:
            interval = np.diff(at)
            usual = float(np.median(interval))
            told.append(f"an epoch every {usual:g} s")
            if gaps := int(np.count_nonzero(interval > 1.5 * usual)):
                longest = int(np.argmax(interval))
                told.append(f"{gaps} gap(s); the longest lasts {interval[longest]:g} s from {moment(at[longest])}")
        return told + list(self.remarks)


def read_observations(path: str | Path) -> Observations:
    """Read the observations of GPS; those of other systems are left out."""
    lines = Lines(path, EXPECTED)
    header = read_header(lines, "O")
    _check(lines, header)
    epochs = _old(lines, header) if header.version < 3.0 else _new(lines, header)
    week, second, found, others = [], [], [], set()
    names: list[str] = []
    for at, (epoch_week, epoch_second), satellites, others_here in epochs:
        if week and (epoch_week - week[-1]) * WEEK + epoch_second - second[-1] <= 0.0:
            raise lines.wrong(at, "the epoch is not after the one before it")
        week.append(epoch_week)
        second.append(epoch_second)
        found.append(satellites)
        others |= others_here
        names += [name for values in satellites.values() for name in values if name not in names]
    if not any(found):
        raise NavfmuError(f"{path}: has no observation of GPS; expected {EXPECTED}")
    values = {name: np.full((len(week), SATELLITES), np.nan) for name in sorted(names)}
    for row, satellites in enumerate(found):
        for prn, measured in satellites.items():
            for name, value in measured.items():
                values[name][row, prn - 1] = value
    marker = header.one("MARKER NAME")
    remarks = [f"satellites of the systems {', '.join(sorted(others))} are left out"] if others else []
    remarks += _of_leap_seconds(np.array(second), int(week[0]))
    return Observations(
        str(path),
        marker[1].strip() if marker else "",
        np.array(week, float),
        np.array(second),
        values,
        _position(lines, header),
        tuple(remarks),
    )


def _check(lines: Lines, header: Header) -> None:
    """Refuse times that are not those of GPS, and numbers that are scaled."""
    if first := header.one("TIME OF FIRST OBS"):
        at, text = first
        if (system := text[48:51].strip().upper()) not in SYSTEMS:
            day, _ = lines.instant(at, text[:43].split())
            raise lines.wrong(
                at, f"times are of the system {system}; expected GPS, which UTC was {leap_seconds(day)} s behind then"
            )
    if scaled := header.one("SYS / SCALE FACTOR"):
        raise lines.wrong(scaled[0], "observations are scaled; expected them in m, cycles, Hz and dB-Hz")


def _position(lines: Lines, header: Header) -> np.ndarray | None:
    told = header.one("APPROX POSITION XYZ")
    if told is None or not told[1].strip():
        return None
    at, text = told
    position = np.array([lines.number(at, text[14 * k :][:14], "the approximate position") for k in range(3)])
    return position if np.any(position) else None


def _new(lines: Lines, header: Header) -> Iterator[tuple]:
    """Yield epochs of version 3: line, time, measured values of each satellite, other systems."""
    types = _types(lines, header.all("SYS / # / OBS TYPES"), 0, 3, 7)
    if "G" not in types:
        raise NavfmuError(f"{lines.path}: has no types of observations of GPS in its header; expected {EXPECTED}")
    at = header.end + 1
    while at <= len(lines):
        text = lines.line(at, "an epoch")
        if not text.strip():
            at += 1
            continue
        if not text.startswith(">"):
            raise lines.wrong(at, f"begins with '{text[:4]}'; expected an epoch, which begins with '>'")
        flag, count = _flag(lines, at, text, 31, 32)
        satellites, others = {}, set()
        for line in range(at + 1, at + 1 + count):
            text_here = lines.line(line, f"{count} lines after the epoch of line {at}")
            if flag > 1:
                if "OBS TYPES" in text_here[60:]:
                    raise lines.wrong(line, "types of observations change within the file; expected them in its header")
            elif text_here[:1] != "G":
                others.add(text_here[:1])
            else:
                prn = _satellite(lines, line, text_here[1:3], satellites)
                satellites[prn] = dict(_values(lines, line, types["G"], lambda k, t=text_here: t[3 + WIDTH * k :][:14]))
        if flag <= 1:
            yield at, _time(lines, at, text[1:29].split()), satellites, others
        at += 1 + count


def _old(lines: Lines, header: Header) -> Iterator[tuple]:
    """Yield epochs of version 2: satellites in the epoch's line, twelve in each, five observations in a line."""
    types = _types(lines, header.all("# / TYPES OF OBSERV"), None, 0, 6).get("G", [])
    if not types:
        raise NavfmuError(f"{lines.path}: has no types of observations in its header; expected {EXPECTED}")
    names = [OF_VERSION_2.get(name, name) for name in types]
    each = -(-len(types) // 5)
    at = header.end + 1
    while at <= len(lines):
        text = lines.line(at, "an epoch")
        if not text.strip():
            at += 1
            continue
        flag, count = _flag(lines, at, text, 28, 29)
        if 2 <= flag <= 5:
            if any("TYPES OF OBSERV" in lines.line(at + k, "an event")[60:] for k in range(1, count + 1)):
                raise lines.wrong(at, "types of observations change within the file; expected them in its header")
            at += 1 + count
            continue
        begin, listed = at, -(-count // 12)
        heads = [lines.line(at + k, f"{count} satellites of the epoch of line {at}") for k in range(listed)]
        told = [heads[k // 12][32 + 3 * (k % 12) :][:3] for k in range(count)]
        at += max(listed, 1)
        satellites, others = {}, set()
        for name in told:
            rows = [lines.line(at + k, f"{count} satellites of the epoch of line {begin}") for k in range(each)]
            if name[:1] in ("G", " "):
                prn = _satellite(lines, begin, name[1:], satellites)
                satellites[prn] = dict(
                    _values(lines, at, names, lambda k, r=rows: r[k // 5][WIDTH * (k % 5) :][:14])
                )  # fmt: skip
            else:
                others.add(name[:1])
            at += each
        if flag <= 1:
            yield begin, _time(lines, begin, text[:26].split()), satellites, others


def _types(
    lines: Lines, told: list[tuple[int, str]], system: int | None, number: int, begin: int
) -> dict[str, list[str]]:
    """Return the types of observations of each system ("G" where there is one list for all)."""
    types: dict[str, list[str]] = {}
    counts: dict[str, tuple[int, int]] = {}
    now = "G"
    for at, text in told:
        if text[number : number + 3 if system is not None else 6].strip() and text[number:begin].strip():
            now = "G" if system is None else text[system]
            counts[now] = at, lines.whole(at, text[number:begin], "the number of types")
            types[now] = []
        types.setdefault(now, []).extend(text[begin:].split())
    for name, (at, count) in counts.items():
        if len(types[name]) != count:
            raise lines.wrong(at, f"tells of {count} types of observations; there are {len(types[name])}")
    return types


def _flag(lines: Lines, at: int, text: str, flag: int, count: int) -> tuple[int, int]:
    """The flag of an epoch (above 1 it is an event), and the number of satellites or lines."""
    told = lines.whole(at, text[flag : flag + 1], "the flag of the epoch")
    number = lines.whole(at, text[count : count + 3], "the number of satellites")
    if not 0 <= told <= 6 or number < 0:
        raise lines.wrong(at, f"the epoch has flag {told} and {number} satellites; expected a flag of 0 to 6")
    return told, number


def _time(lines: Lines, at: int, fields: list[str]) -> tuple[int, float]:
    if len(fields) < 6:
        raise lines.wrong(at, "the epoch has no time; expected year, month, day, hour, minute, second")
    return gps_time(*lines.instant(at, fields[:6]))


def _satellite(lines: Lines, at: int, text: str, known: dict) -> int:
    prn = lines.whole(at, text, "the satellite")
    if not 1 <= prn <= SATELLITES:
        raise lines.wrong(at, f"there is no satellite {prn} of GPS; expected 1 to {SATELLITES}")
    if prn in known:
        raise lines.wrong(at, f"satellite {prn} comes twice in an epoch")
    return prn


def _values(lines: Lines, at: int, names: list[str], text: Callable[[int], str]) -> Iterator[tuple[str, float]]:
    """Yield the observations of a satellite; what is missing is empty, or 0."""
    for k, name in enumerate(names):
        told = text(k)
        if told.strip() and (value := lines.number(at, told, name)):
            yield name, value


def _of_leap_seconds(second: np.ndarray, week: int) -> Iterator[str]:
    """Tell of epochs that are as far beyond round times as UTC is behind GPS time."""
    if len(second) < 2:
        return
    step = float(np.median(np.diff(second)))
    leap = leap_seconds(first_day(week))
    if step < 5.0 or abs(step - round(step)) > 1e-3 or not leap % step:
        return
    beyond = np.mod(second + 0.5, step) - 0.5
    if np.all(np.abs(np.mod(beyond + leap + 0.5 * step, step) - 0.5 * step) < 0.01):
        yield (
            f"epochs are {float(np.median(beyond)):g} s beyond multiples of {step:g} s, as if they were counted in UTC, "
            f"which is {leap} s behind GPS time"
        )
