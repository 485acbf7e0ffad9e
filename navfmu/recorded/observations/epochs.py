"""Epochs of observations as rows of a table: each satellite in a place of its own while it is measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from navfmu.constants import WAVELENGTH
from navfmu.errors import NavfmuError
from navfmu.recorded.observations import phases
from navfmu.satellite.calendar import WEEK
from navfmu.satellite.observations import Observations
from navfmu.satellite.orbits import Orbits, moment

USUAL = {"pseudorange": "C1C", "range_rate": "D1C", "signal_to_noise": "S1C"}
"""Quantities, and the names of observations that they are taken from."""
RATE, PHASE = "range_rate", "L1"
"""What may be taken of the phases of a carrier, and what their names begin with."""
SIGNAL = "signal_to_noise"
"""What a file may do without: old receivers do not write it, and it is 0 then."""
KINDS = {"pseudorange": "C", "range_rate": "D", "signal_to_noise": "S"}
"""What their names begin with; the 1 of L1 follows."""


@dataclass(frozen=True)
class Epochs:
    """What was measured on L1, complete measurements only.

    Attributes
    ----------
    time : (n,) s, from t = 0 on
    week, second : (n,) time tags, GPS week and second of it
    number : (n, places) PRN, 0 where none is
    pseudorange, range_rate, signal_to_noise : (n, places) m, m/s, dB-Hz
    before : epochs before t = 0, which are left out
    lacking : pseudoranges without a Doppler (or phases that make one), which are left out
    untold : whether there is no C/N0, which is 0 then
    """

    time: np.ndarray
    week: np.ndarray
    second: np.ndarray
    number: np.ndarray
    pseudorange: np.ndarray
    range_rate: np.ndarray
    signal_to_noise: np.ndarray
    before: int
    lacking: int
    untold: bool = False

    def __len__(self) -> int:
        return len(self.time)

    def moment(self, row: int) -> str:
        """When an epoch was, for people."""
        return moment(self.week[row] * WEEK + self.second[row])

    def table(self) -> list[np.ndarray]:
        """Columns of the player's table, each (n,)."""
        one = np.ones(len(self))
        times = [self.time, self.time, np.arange(1.0, len(self) + 1.0), one, self.week, self.second]
        measured = (self.number, self.pseudorange, self.range_rate, self.signal_to_noise)
        return [*times, *(column for values in measured for column in values.T)]


def take(found: Observations, places: int, names: Mapping[str, str], start: float | None = None) -> Epochs:
    """Return the epochs of observations.

    Parameters
    ----------
    places : how many satellites there may be at once
    names : names of observations for some of USUAL
    start : second of the first epoch's week that is t = 0; without it the first epoch is
    """
    untold = SIGNAL not in names and USUAL[SIGNAL] not in found.values
    kinds = [what for what in USUAL if what != SIGNAL or not untold]
    code, doppler, *strengths = (_taken(found, what, names.get(what, USUAL[what])) for what in kinds)
    strength = np.zeros_like(code) if untold else strengths[0]
    begin = float(found.second[0]) if start is None else start
    if abs(found.second[0] - begin) > WEEK:
        raise NavfmuError(
            f"--start is {begin:g}, more than a week from the first epoch of {found.source}, which is second "
            f"{found.second[0]:g} of its week; expected a second of that week"
        )
    time = np.round((found.week - found.week[0]) * WEEK + (found.second - begin), 7)
    rows = np.flatnonzero(time >= 0.0)
    if not len(rows):
        raise NavfmuError(
            f"{found.source}: all epochs are before --start {begin:g}; expected a second of the week of its first "
            f"epoch, which is {found.second[0]:g}"
        )
    code, doppler, strength = code[rows], doppler[rows], strength[rows]
    complete = np.isfinite(code) & np.isfinite(doppler)
    number = _placed(complete, places, found, rows)
    column = np.maximum(number.astype(int) - 1, 0)

    def at_places(values: np.ndarray) -> np.ndarray:
        return np.where(number > 0.0, np.nan_to_num(np.take_along_axis(values, column, axis=1)), 0.0)

    return Epochs(
        time[rows],
        found.week[rows],
        found.second[rows],
        number,
        at_places(code),
        at_places(-WAVELENGTH * doppler),
        at_places(strength),
        int(rows[0]),
        int(np.count_nonzero(np.isfinite(code) & ~complete)),
        untold,
    )


def held(epochs: Epochs, orbits: Orbits, unhealthy: bool = False) -> np.ndarray:
    """Return for which measurements, (n, places), there is an orbit that holds then, of a healthy satellite (or of an
    ``unhealthy`` one, too): the nearest by its t_oe, as the player takes it."""
    names = ("prn", "toe_week", "toe", "limit", "health")
    prn, week, second, limit, health = (orbits.column(name) for name in names)
    good = np.zeros(epochs.number.shape, bool)
    for satellite in np.unique(epochs.number[epochs.number > 0.0]):
        own = np.flatnonzero(prn == satellite)
        if len(own):
            row, place = np.nonzero(epochs.number == satellite)
            away = np.abs((epochs.week[row, None] - week[own]) * WEEK + epochs.second[row, None] - second[own])
            near = np.argmin(away, axis=1)
            well = unhealthy | (health[own][near] == 0.0)
            good[row, place] = (away[np.arange(len(row)), near] <= limit[own][near]) & well
    return good


def _taken(found: Observations, what: str, name: str) -> np.ndarray:
    if what == RATE and name[:2] == PHASE and name in found.values:
        time = (found.week - found.week[0]) * WEEK + found.second
        return phases.doppler(time, found.values[name], found.lost[name])
    kind = f"{KINDS[what]}1"
    if name[:2] == kind and name in found.values:
        return found.values[name]
    others = [other for other in found.values if other[:2] == kind or (what == RATE and other[:2] == PHASE)]
    have = f"it has {', '.join(others)}, which --column {what}={others[0]} takes" if others else "it has none"
    raise NavfmuError(
        f"{found.source}: has no '{name}' of which {what} could be taken; expected an observation on L1, whose name "
        f"begins with {kind}{f', or a phase, {PHASE}' if what == RATE else ''}: {have}"
    )


def _placed(complete: np.ndarray, places: int, found: Observations, rows: np.ndarray) -> np.ndarray:
    """Numbers of satellites (n, places): one keeps its place while it is measured, a new one has the first free."""
    now = np.zeros(places)
    numbers = np.zeros((len(complete), places))
    for k, seen in enumerate(complete):
        there = np.flatnonzero(seen) + 1.0
        if len(there) > places:
            at = moment(found.week[rows[k]] * WEEK + found.second[rows[k]])
            raise NavfmuError(f"{found.source}: {len(there)} satellites of GPS at {at}; expected at most {places}")
        now = np.where(np.isin(now, there), now, 0.0)
        new = np.setdiff1d(there, now)
        now[np.flatnonzero(now == 0.0)[: len(new)]] = new
        numbers[k] = now
    return numbers
