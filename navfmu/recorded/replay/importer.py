"""From a file of recorded samples to an FMU: what the player wants, found in the file, checked, told and written."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from navfmu.errors import NavfmuError, visible
from navfmu.files.archive import zipped
from navfmu.files.writing import write_file
from navfmu.fmi import tables
from navfmu.fmi.fmu import describe
from navfmu.recorded.archive import DESCRIPTION, described
from navfmu.recorded.page import recorded
from navfmu.recorded.replay import account
from navfmu.recorded.replay.asked import TIME_UNITS, Asked
from navfmu.recorded.replay.doubts import doubts
from navfmu.recorded.replay.file import File
from navfmu.recorded.replay.samples import Samples, seconds, share, silence, take
from navfmu.recorded.replay.wanted import Wanted, wanted

SUFFIX = "_replay"
"""Of the names of players: ``imu_replay.fmu`` takes the place of ``imu.fmu``."""


@dataclass(frozen=True)
class Imported:
    """Samples of each table of a player; None of one for which the file has nothing. ``tick`` s is the player's."""

    source: str
    player: str
    wanted: tuple[Wanted, ...]
    samples: dict[str, Samples | None]
    tick: float
    unused: tuple[str, ...]
    told: tuple[str, ...] = ()  # of the file as a whole

    @property
    def streams(self) -> list[Samples]:
        """The samples of tables that have some."""
        return [samples for samples in self.samples.values() if samples is not None]

    @property
    def duration(self) -> float:
        """When the last sample comes, s."""
        return max(float(samples.time[-1]) for samples in self.streams)

    def sentences(self) -> list[str]:
        """What there is to say, for the user."""
        found = list(self.told)
        for samples in self.streams:
            named = f"{samples.wanted.table}: " if len(self.streams) > 1 else ""
            found += [named + sentence for sentence in account.sentences(samples, self.tick)]
        silent = [table for table, samples in self.samples.items() if samples is None]
        found += [f"{table}: not in the file, so the FMU is silent there" for table in silent]
        return found + ([f"columns not used: {', '.join(self.unused)}"] if self.unused else [])

    def ranges(self) -> list[tuple[str, str, float, float, float]]:
        """Rows (quantity, unit, least, middle, largest value)."""
        return [row for samples in self.streams for row in account.ranges(samples)]

    def write(self, out: str | Path, name: str | None = None) -> Path:
        """Write the FMU."""
        files = tables.contents(self.player)
        for one in self.wanted:
            samples = self.samples[one.table]
            rows = silence(one) if samples is None else samples.table()
            files = tables.replaced(files, one.table, rows, self.player)
        file = visible(Path(self.source).name)
        name = visible(name or Path(self.source).stem)
        sensor = Path(self.player).stem.removesuffix(SUFFIX).replace("_", " ")
        count = " and ".join(f"{len(samples)} samples" for samples in self.streams)
        text = f"Recorded {sensor} {file}: {count} in {self.duration:.1f} s"
        files[DESCRIPTION] = described(files[DESCRIPTION], name, text, self.duration)
        return write_file(out, zipped(recorded(files, name, text, self._account(name, file))))

    def _account(self, name: str, file: str) -> str:
        lines = [f"{name}, samples of {file}", "", *self.sentences(), ""]
        lines.append(f"{'quantity':24} {'unit':7} {'least':>13} {'middle':>13} {'largest':>13}")
        lines += [f"{what:24} {unit:7} {a:13.6g} {b:13.6g} {c:13.6g}" for what, unit, a, b, c in self.ranges()]
        return "\n".join(lines) + "\n"


def import_samples(file: File, player: str | Path, asked: Asked | None = None) -> Imported:
    """Find, convert and check the samples that the player of a sensor wants.

    Parameters
    ----------
    file : columns of the recording
    player : the FMU that this package ships for the sensor, ``imu_replay.fmu``
    asked : what the user says of the file; without it columns are found by their usual names, in the player's units
    """
    asked, player = asked or Asked(), str(player)
    files = tables.contents(player)
    found = [wanted(name, tables.read(files, name, player), player) for name in tables.known(files)]
    quantities = [quantity for one in found for quantity in one.quantities]
    asked.check([q.name for q in quantities], [q.name for q in quantities if q.vector])
    shares = {one.table: share(file, one, asked) for one in found}
    most = max(shares.values())
    if most == 0.0:
        _nothing(file, found)
    samples = {one.table: take(file, one, asked) if shares[one.table] == most else None for one in found}
    _check_used(file, asked, [one for one in samples.values() if one])
    for one in samples.values():
        for sentence in doubts(one) if one else ():
            if not asked.unchecked:
                raise NavfmuError(f"{file.path}: {sentence}. If all is as it should be, --unchecked takes it")
            one.remarks.append(f"not plausible, and taken: {sentence}")
    for one in samples.values():
        if one and asked.start is None:
            _check_begin(file, one)
    used = {c for one in samples.values() if one for source in one.sources.values() for c in source.columns}
    used |= {asked.columns.get(name, (name,))[0] for name in ("time", "time_of_validity", "valid")}
    tick = float(describe(player).variable("tick_period", player).start)
    unused = tuple(name for name in file.names if name not in used)
    return Imported(file.path, player, tuple(found), samples, tick, unused, file.told)


def _check_used(file: File, asked: Asked, taken: list[Samples]) -> None:
    """Refuse what is said of something that the file does not hold: it would do nothing."""
    recorded = {name: one for one in taken for name, source in one.sources.items() if source.columns}
    times = {name for name in TIME_UNITS if asked.columns.get(name, (name,))[0] in file.names}
    known = {"--unit": recorded.keys() | times, "--axes": recorded.keys(), "--add": recorded.keys()}
    for option, given in (("--unit", asked.units), ("--axes", asked.axes), ("--add", asked.add)):
        for name in given:
            if name and name not in known[option]:
                have = ", ".join(sorted(known[option]))
                raise NavfmuError(f"{option} {name}: {file.path} has no {name}; what is taken of it: {have}")
    turned = [
        q.name for one in taken for q in one.wanted.quantities if q.vector and q.frame == "b" and q.name in recorded
    ]
    if "" in asked.axes and not turned:
        raise NavfmuError(f"--axes {','.join(asked.axes[''])}: there is no vector in body axes; say --axes NAME=...")


def _check_begin(file: File, samples: Samples) -> None:
    """Refuse times of another beginning, such as 1970."""
    first, last = samples.time[[0, -1]]
    if first > 60.0 and first > last - first:
        start = seconds(math.floor(1e3 * first) / 1e3)
        raise NavfmuError(
            f"{file.path}: the first time is {seconds(first)} s, so for longer than it lasts nothing would come; pass "
            f"--start {start} to begin with it, the same for all sensors of a recording (or --start 0)"
        )


def _nothing(file: File, found: list[Wanted]) -> None:
    wants = "; ".join(", ".join(quantity.name for quantity in one.quantities) for one in found)
    raise NavfmuError(
        f"{file.path}: has no column for any of {wants}. Its columns are {', '.join(file.names)}: name some with "
        "--column, as in --column rate=gyro_x,gyro_y,gyro_z"
    )
