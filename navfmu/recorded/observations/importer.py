"""From RINEX files of observations and of orbits to an FMU: read, checked, told and written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError, visible
from navfmu.files.archive import zipped
from navfmu.files.writing import write_file
from navfmu.fmi import tables
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.recorded.archive import DESCRIPTION, described
from navfmu.recorded.observations.doubts import doubts
from navfmu.recorded.observations.epochs import Epochs, held, take
from navfmu.recorded.page import recorded
from navfmu.recorded.replay.account import lost
from navfmu.satellite import navigation
from navfmu.satellite.calendar import ROLLOVER, WEEK
from navfmu.satellite.file import read_orbits
from navfmu.satellite.observations import Observations, read_observations
from navfmu.satellite.orbits import Orbits, joined, moment
from navfmu.ssp.writer import values_document

OBSERVATIONS, ORBITS = "observations", "orbits"
FEWEST = 4
"""Satellites of which a position can be made."""


@dataclass(frozen=True)
class Imported:
    """Epochs and orbits for a player; ``tick`` s is the player's. ``good`` (n, places) says which measurements have an
    orbit that holds."""

    source: str
    player: str
    found: Observations
    orbits: Orbits
    epochs: Epochs
    good: np.ndarray
    tick: float
    remarks: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """When the last epoch comes, s."""
        return float(self.epochs.time[-1])

    def sentences(self) -> list[str]:
        """What there is to say, for the user."""
        return [*self.found.sentences(), *self.orbits.sentences(), *self._of_both(), *self.remarks]

    def _of_both(self) -> Iterator[str]:
        epochs, seen = self.epochs, self.epochs.number > 0.0
        yield f"t = 0 is {moment(epochs.week[0] * WEEK + epochs.second[0] - epochs.time[0])}"
        if epochs.before:
            yield f"{epochs.before} epoch(s) before t = 0 are left out"
        if epochs.lacking:
            yield f"{epochs.lacking} pseudorange(s) without a Doppler are left out"
        gone = seen & ~self.good
        if gone.any():
            which = np.unique(epochs.number[gone]).astype(int)
            yield (
                f"{np.count_nonzero(gone)} of {np.count_nonzero(seen)} measurements have no orbit that holds, or their "
                f"satellite calls itself unhealthy, and are not `tracked`: satellites {_list(which)}"
            )
        few = np.flatnonzero(self.good.sum(axis=1) < FEWEST)
        if len(few):
            yield f"{len(few)} epoch(s) have fewer than {FEWEST} satellites; the first is {epochs.moment(few[0])}"
        if late := lost(epochs, self.tick):
            yield f"with ticks of {self.tick:g} s {late} of {len(epochs)} epochs are lost: a later one comes in it"
        if self.orbits.ionosphere is not None:
            for name, values in zip(("alpha", "beta"), self.orbits.ionosphere, strict=True):
                yield f"ionosphere_{name} for gps_solver: {', '.join(f'{value:.4e}' for value in values)}"

    def ranges(self) -> list[tuple[str, str, float, float, float]]:
        """Rows (quantity, unit, least, middle, largest value)."""
        seen, e = self.epochs.number > 0.0, self.epochs
        quantities = (
            ("pseudorange", "m", e.pseudorange[seen]),
            ("range_rate", "m/s", e.range_rate[seen]),
            ("signal_to_noise", "dB-Hz", e.signal_to_noise[seen]),
            ("satellites", "1", self.good.sum(axis=1)),
        )
        return [(n, unit, *(float(f(v)) for f in (np.min, np.median, np.max))) for n, unit, v in quantities]

    def write(self, out: str | Path, name: str | None = None) -> Path:
        """Write the FMU."""
        files = tables.contents(self.player)
        labels = list(tables.read(files, OBSERVATIONS, self.player))
        rows = dict(zip(labels, self.epochs.table(), strict=True))
        files = tables.replaced(files, OBSERVATIONS, rows, self.player)
        files = tables.replaced(files, ORBITS, self.orbits.table(), self.player)
        file = visible(Path(self.source).name)
        name = visible(name or Path(self.source).stem)
        text = f"Recorded observations {file}: {len(self.epochs)} epochs in {self.duration:.1f} s"
        files[DESCRIPTION] = described(files[DESCRIPTION], name, text, self.duration)
        return write_file(out, zipped(recorded(files, name, text, self._account(name, file))))

    def ionosphere(self, solver: str | Path) -> bytes:
        """Return the parameter set (.ssv) of the FMU ``solver`` with the ionosphere that the satellites sent."""
        if self.orbits.ionosphere is None:
            raise NavfmuError(f"{self.orbits.source}: has no coefficients of the ionosphere in its header")
        description = describe(solver)
        names = ("ionosphere_alpha", "ionosphere_beta")
        values = {name: sent.tolist() for name, sent in zip(names, self.orbits.ionosphere, strict=True)}
        text = f"Ionosphere of {visible(Path(self.orbits.source).name)}"
        return values_document(description, expand(description, values, str(solver)), text)

    def _account(self, name: str, file: str) -> str:
        lines = [f"{name}, observations of {file}", "", *self.sentences(), ""]
        lines.append(f"{'quantity':24} {'unit':7} {'least':>13} {'middle':>13} {'largest':>13}")
        lines += [f"{what:24} {unit:7} {a:13.6g} {b:13.6g} {c:13.6g}" for what, unit, a, b, c in self.ranges()]
        return "\n".join(lines) + "\n"


def import_observations(
    file: str | Path,
    nav: Sequence[str | Path],
    player: str | Path,
    names: Mapping[str, str] | None = None,
    start: float | None = None,
    unchecked: bool = False,
) -> Imported:
    """Read and check what a receiver measured, and what the satellites said.

    Parameters
    ----------
    file, nav : RINEX observations, and RINEX navigation files of their time
    player : the FMU that this package ships for observations
    names : names of observations where others than C1C, D1C and S1C are wanted, by quantity
    start : second of the week, of the first epoch's, that is t = 0; without it the first epoch is
    unchecked : take what is not plausible, and say it
    """
    player, found = str(player), read_observations(file)
    orbits = joined([_orbits(path) for path in nav])
    places = sum(label.startswith("number[") for label in tables.read(tables.contents(player), OBSERVATIONS, player))
    epochs = take(found, places, names or {}, start)
    good = held(epochs, orbits)
    if np.max(good.sum(axis=1)) < FEWEST:
        raise NavfmuError(f"{orbits.source}: {_why_none_holds(found, epochs, orbits)}")
    remarks = []
    for sentence in (*doubts(epochs), *found.doubts):
        if not unchecked:
            raise NavfmuError(f"{found.source}: {sentence}. If all is as it should be, --unchecked takes it")
        remarks.append(f"not plausible, and taken: {sentence}")
    tick = float(describe(player).variable("tick_period", player).start)
    return Imported(str(file), player, found, orbits, epochs, good, tick, tuple(remarks))


def _orbits(path: str | Path) -> Orbits:
    found = read_orbits(path, None)
    if found.kind != navigation.KIND:
        raise NavfmuError(
            f"{path}: is a {found.kind}, whose satellites are off by a kilometre; expected a RINEX navigation file"
        )
    return found


def _why_none_holds(found: Observations, epochs: Epochs, orbits: Orbits) -> str:
    """Tell why orbits are of no use for observations: other satellites, unhealthy ones, or how far off in time."""
    sent, seen = (np.unique(of).astype(int) for of in (orbits.column("prn"), epochs.number[epochs.number > 0.0]))
    if len(np.intersect1d(sent, seen)) < FEWEST:
        return (
            f"has orbits of the satellites {_list(sent)}, and {found.source} has measured {_list(seen)}; expected "
            f"{FEWEST} of these at least"
        )
    if np.max(held(epochs, orbits, unhealthy=True).sum(axis=1)) >= FEWEST:
        return f"at no epoch of {found.source} {FEWEST} of the satellites call themselves healthy; expected so many"
    toe = orbits.column("toe_week") * WEEK + orbits.column("toe")
    at = epochs.week * WEEK + epochs.second
    apart = (np.median(at) - np.median(toe)) / WEEK
    turns = round(apart / ROLLOVER)
    rolled = turns and abs(apart - turns * ROLLOVER) < 1.0
    why = f"; they are {abs(turns) * ROLLOVER} weeks apart, by which weeks are told modulo {ROLLOVER}" if rolled else ""
    return (
        f"at no epoch there are orbits for {FEWEST} of the satellites: they are of {moment(toe.min())} to "
        f"{moment(toe.max())}, and {found.source} is of {epochs.moment(0)} to {epochs.moment(-1)}{why}; expected "
        f"orbits within {orbits.column('limit').max() / 3600.0:g} h"
    )


def _list(satellites: np.ndarray) -> str:
    return ", ".join(map(str, satellites))
