"""What is imported of RINEX files: epochs and orbits for a player, what there is to say of them, and the FMU."""

from __future__ import annotations

from collections.abc import Iterator
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
from navfmu.recorded.observations.epochs import SIGNAL, USUAL, Epochs
from navfmu.recorded.page import recorded
from navfmu.recorded.replay.account import lost
from navfmu.satellite.calendar import WEEK
from navfmu.satellite.observations import Observations
from navfmu.satellite.orbits import Orbits, moment
from navfmu.ssp.writer import values_document

OBSERVATIONS, ORBITS = "observations", "orbits"
FEWEST = 4
"""Satellites of which a position can be made."""
FAINT = 25.0
"""dB-Hz below which loops lose a carrier: what is measured may be anything; with four satellites nothing shows it."""


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
        if epochs.untold:
            yield f"there is no {USUAL[SIGNAL]}: C/N0 is told as 0 dB-Hz"
        elif faint := int(np.count_nonzero(seen & (epochs.signal_to_noise < FAINT))):
            yield (
                f"{faint} of {np.count_nonzero(seen)} measurements are weaker than {FAINT:g} dB-Hz, where receivers "
                f"follow noise: with signal_mask={FAINT:g} gps_solver leaves them out"
            )
        gone = seen & ~self.good
        if gone.any():
            which = np.unique(epochs.number[gone]).astype(int)
            yield (
                f"{np.count_nonzero(gone)} of {np.count_nonzero(seen)} measurements have no orbit that holds, or their "
                f"satellite calls itself unhealthy, and are not `tracked`: satellites {listed(which)}"
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


def listed(satellites: np.ndarray) -> str:
    """Numbers of satellites for people."""
    return ", ".join(map(str, satellites))
