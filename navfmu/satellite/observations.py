"""RINEX observation files, versions 2 to 4: what a receiver measured of satellites of GPS."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.satellite.calendar import WEEK, first_day, leap_seconds
from navfmu.satellite.epochs import Epoch, epochs
from navfmu.satellite.header import Header, read_header
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import SATELLITES, moment

EXPECTED = "a RINEX observation file of version 2, 3 or 4"
SYSTEMS = ("GPS", "GAL", "QZS", "")
"""Time systems that are GPS time, to some ns. UTC and that of GLONASS are behind it."""


@dataclass(frozen=True)
class Observations:
    """What a receiver measured.

    Attributes
    ----------
    week, second : (n,), when, by the receiver's clock: GPS week and second of it
    values : name of RINEX 3 ("C1C" m, "L1C" cycles, "D1C" Hz, "S1C" dB-Hz) -> (n, 32), a column for each satellite of
        GPS from 1 on, NaN where nothing was measured
    lost : name of a phase -> (n, 32), whether the carrier had been lost since the epoch before
    position_e : (3,) approximate position of the antenna's marker, m, or None
    remarks : what was found, and what was left out
    doubts : what is not plausible
    """

    source: str
    marker: str
    week: np.ndarray
    second: np.ndarray
    values: dict[str, np.ndarray]
    lost: dict[str, np.ndarray]
    position_e: np.ndarray | None
    remarks: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

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
        return [*told, *self.remarks, *self.doubts]


def read_observations(path: str | Path) -> Observations:
    """Read the observations of GPS; those of other systems are left out."""
    lines = Lines(path, EXPECTED)
    header = read_header(lines, "O")
    _check(lines, header)
    found: list[Epoch] = []
    for epoch in epochs(lines, header):
        if found and (epoch.week - found[-1].week) * WEEK + epoch.second - found[-1].second <= 0.0:
            raise lines.wrong(epoch.line, f"the epoch is not after that of line {found[-1].line}")
        found.append(epoch)
    names = {name for epoch in found for values in epoch.satellites.values() for name in values}
    if not names:
        raise NavfmuError(f"{path}: has no observation of GPS; expected {EXPECTED}")
    values = {name: np.full((len(found), SATELLITES), np.nan) for name in sorted(names)}
    lost = {name: np.zeros((len(found), SATELLITES), bool) for name in values if name.startswith("L")}
    for row, epoch in enumerate(found):
        for prn, name in epoch.lost:
            lost[name][row, prn - 1] = True
        for prn, measured in epoch.satellites.items():
            for name, value in measured.items():
                values[name][row, prn - 1] = value
    marker = header.one("MARKER NAME")
    others = sorted(set().union(*(epoch.others for epoch in found)))
    remarks = list(lines.remarks)
    if others:
        remarks.append(f"satellites of the systems {', '.join(others)} are left out")
    week, second = np.array([(epoch.week, epoch.second) for epoch in found]).T
    return Observations(
        str(path),
        marker[1].strip() if marker else "",
        week,
        second,
        values,
        lost,
        _position(lines, header),
        tuple(remarks),
        tuple(_of_leap_seconds(second, int(week[0]))),
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


def _of_leap_seconds(second: np.ndarray, week: int) -> Iterator[str]:
    """Tell of epochs that are as far from round times as UTC is from GPS time."""
    if len(second) < 2:
        return
    step = float(np.median(np.diff(second)))
    leap = leap_seconds(first_day(week))
    if step < 5.0 or abs(step - round(step)) > 1e-3 or not leap % step:
        return
    beyond = np.mod(second + 0.5, step) - 0.5
    for sign, words in ((1, f"counted in UTC, which is {leap} s behind GPS time"), (-1, f"{leap} s ahead of GPS time")):
        if np.all(np.abs(np.mod(beyond + sign * leap + 0.5 * step, step) - 0.5 * step) < 0.01):
            yield f"epochs are {float(np.median(beyond)):g} s beyond multiples of {step:g} s, as if they were {words}"
            return
