"""From RINEX files of observations and of orbits to an FMU: read, checked, told and written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.fmi import tables
from navfmu.fmi.fmu import describe
from navfmu.recorded.observations.doubts import doubts
from navfmu.recorded.observations.epochs import Epochs, held, take
from navfmu.recorded.observations.imported import FEWEST, OBSERVATIONS, Imported, listed
from navfmu.recorded.observations.trial import trial
from navfmu.satellite.calendar import ROLLOVER, WEEK
from navfmu.satellite.file import read_broadcast
from navfmu.satellite.observations import Observations, read_observations
from navfmu.satellite.orbits import Orbits, joined, moment


def import_observations(
    file: str | Path,
    nav: Sequence[str | Path],
    player: str | Path,
    names: Mapping[str, str] | None = None,
    start: float | None = None,
    unchecked: bool = False,
    solver: str | Path | None = None,
) -> Imported:
    """Read and check what a receiver measured, and what the satellites said.

    Parameters
    ----------
    file, nav : RINEX observations, and RINEX navigation files of their time
    player : the FMU that this package ships for observations
    names : names of observations where others than C1C, D1C and S1C are wanted, by quantity
    start : second of the week, of the first epoch's, that is t = 0; without it the first epoch is
    unchecked : take what is not plausible, and say it
    solver : the FMU ``gps_solver``, which solves some epochs to see whether all fits; without it nobody looks
    """
    player, found = str(player), read_observations(file)
    orbits = joined([read_broadcast(path) for path in nav])
    places = sum(label.startswith("number[") for label in tables.read(tables.contents(player), OBSERVATIONS, player))
    epochs = take(found, places, names or {}, start)
    good = held(epochs, orbits)
    if np.max(good.sum(axis=1)) < FEWEST:
        raise NavfmuError(f"{orbits.source}: {_why_none_holds(found, epochs, orbits)}")
    tick = float(describe(player).variable("tick_period", player).start)
    made = Imported(str(file), player, found, orbits, epochs, good, tick)
    remark, against = trial(made, solver) if solver else ("", False)
    remarks = [remark] if remark and not against else []
    for sentence in (*doubts(epochs), *found.doubts, *([remark] if against else [])):
        if not unchecked:
            raise NavfmuError(f"{found.source}: {sentence}. If all is as it should be, --unchecked takes it")
        remarks.append(f"not plausible, and taken: {sentence}")
    return replace(made, remarks=tuple(remarks))


def _why_none_holds(found: Observations, epochs: Epochs, orbits: Orbits) -> str:
    """Tell why orbits are of no use for observations: other satellites, unhealthy ones, or how far off in time."""
    sent, seen = (np.unique(of).astype(int) for of in (orbits.column("prn"), epochs.number[epochs.number > 0.0]))
    if len(np.intersect1d(sent, seen)) < FEWEST:
        return (
            f"has orbits of the satellites {listed(sent)}, and {found.source} has measured {listed(seen)}; expected "
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
