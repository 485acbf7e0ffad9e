"""A trial: some epochs are flown through the player and ``gps_solver``, to see whether orbits and time tags fit.

That tags are a second off nothing in a file shows; satellites that are 4 km from where they were do.
"""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.recorded.observations.imported import Imported
from navfmu.ssp.writer import SystemSource
from navfmu.system.system import System

if TYPE_CHECKING:
    import pandas as pd

MOST = 50
"""Epochs that are solved, evenly spread."""
ENOUGH = 6
"""Satellites with which an epoch is solved: its sum of squares has degrees of freedom."""
FAR = 100.0
"""m, of residuals: beyond it is no noise, no multipath and no atmosphere. Tags that are 1 s off make some 800."""


def trial(imported: Imported, solver: str | Path) -> tuple[str, bool]:
    """Solve some epochs with the FMU ``solver``.

    Returns
    -------
    what is to be said ("" where nothing can be solved), and whether it speaks against the files
    """
    rows = np.flatnonzero(imported.good.sum(axis=1) >= ENOUGH)
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), MOST)).astype(int))]
    if not len(rows):
        return "", False
    try:
        result = _solved(_of(imported, rows), solver)
    except NavfmuError:  # no binary for this machine, no folder for the cache: the FMU can be made all the same
        return "no epoch could be solved on this machine to see whether orbits and time tags fit", False
    tested = result[result["solver.threshold"] > 0.0]
    residuals = tested[[name for name in tested.columns if ".residual[" in name]].abs().max(axis=1)
    if len(tested) and tested["solver.alarm"].all() and residuals.median() > FAR:
        return (
            f"none of {len(tested)} epochs that were solved agrees with itself: in the middle a pseudorange is "
            f"{residuals.median():.0f} m off; expected orbits and time tags of one time (1 s between them makes 800 m)",
            True,
        )
    return f"of {len(result)} epochs that were solved {int(result['solver.fix.valid'].sum())} give a fix", False


def _of(imported: Imported, rows: np.ndarray) -> Imported:
    """These epochs alone, one a second."""
    epochs = imported.epochs
    each = ("week", "second", "number", "pseudorange", "range_rate", "signal_to_noise")
    times = np.arange(1.0, len(rows) + 1.0)
    few = dataclasses.replace(epochs, time=times, **{name: getattr(epochs, name)[rows] for name in each})
    return dataclasses.replace(imported, epochs=few, good=imported.good[rows])


def _solved(imported: Imported, solver: str | Path) -> pd.DataFrame:
    """What the solver gives out, a row for each epoch."""
    with tempfile.TemporaryDirectory(prefix="navfmu-") as folder:
        imported.write(Path(folder) / "observations.fmu")
        (Path(folder) / "solver.fmu").write_bytes(Path(solver).read_bytes())
        system = SystemSource("trial", fmus=folder, stop_time=imported.duration, step=1.0)
        for component in ("observations", "solver"):
            system.component(component, f"{component}.fmu").parameters(component, {"tick_period": 1.0})
        system.connect("observations.signals", "solver.signals")
        system.write(Path(folder) / "system")
        record = ["solver.threshold", "solver.alarm", "solver.residual", "solver.fix.valid"]
        return System.load(Path(folder) / "system").run(record=record, record_period=1.0).iloc[1:]
