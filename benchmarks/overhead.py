"""24 satellites of GPS that are above one place for a while: what a receiver has to do at most."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.everything_on import EVERYTHING
from fmus.satellite.signals import PLACES
from models.earth import earth
from models.satellite import orbit, selection, sight, slots
from models.satellite.ephemeris import Ephemeris
from navfmu.files.archive import zipped
from navfmu.files.writing import write_file
from navfmu.fmi import tables
from navfmu.ssp import SystemSource
from navfmu.system import shipped

PERIOD = 0.01
"""Of measurements, s: satellites do not set meanwhile."""
LOWEST = np.radians(25.0)
STAY = 2000.0
"""s that they are higher."""
MOTION = {
    f"gps_signals.{name}": EVERYTHING["gps_signals"][name]
    for name in ("latitude", "longitude", "altitude", "velocity_n", "roll", "pitch", "heading")
}


def orbits() -> np.ndarray:
    """Rows of a table of orbits (24, columns): of drawn ones the first that are above the place as long as wanted."""
    rng = np.random.default_rng(24)
    week, second = slots.EPOCH
    node, anomaly = rng.uniform(-np.pi, np.pi, (2, 5000))
    drawn = Ephemeris.of(slots.constellation()[0])._replace(
        node=node, mean_anomaly=anomaly, eccentricity=0.01, clock_bias=1e-4, clock_drift=1e-11, accuracy=2.4
    )
    here = [*MOTION.values()][:3]
    position_e, c_ne = earth.to_ecef(*here), earth.north_east_down(*here[:2])
    high = np.ones(len(node), bool)
    for late in (0.0, STAY):
        _, unit_e = sight.ranges(position_e, orbit.state(drawn, week, second + late)[0])
        high &= sight.sky(unit_e @ c_ne.T)[0] > np.sin(LOWEST)
    prn = np.arange(1.0, PLACES + 1)
    return Ephemeris.of(drawn.rows()[high][:PLACES])._replace(prn=prn, place=selection.place(prn, week, second)).rows()


def system(folder: Path, solved: bool) -> Path:
    """A system of ``gps_signals`` with these orbits, and ``gps_solver`` if it is ``solved``.

    Each step measures and solves, and each tenth looks for new satellites, as with the periods that are built in.
    """
    name = "both" if solved else "alone"
    receiver = shipped.path("gps_signals.fmu")
    content = tables.contents(receiver)
    columns = dict(zip(tables.read(content, "orbits", str(receiver)), orbits().T, strict=True))
    write_file(folder / receiver.name, zipped(tables.replaced(content, "orbits", columns, str(receiver))))
    made = SystemSource(name, fmus=receiver.parent, stop_time=STAY, step=PERIOD)
    made.component("gps_signals", folder / receiver.name)
    made.parameters("gps_signals", {"measurement_period": PERIOD, "search_period": 10.0 * PERIOD})
    if solved:
        made.component("gps_solver", "gps_solver.fmu")
        made.parameters("gps_solver", {"tick_period": PERIOD})
        made.connect("gps_signals.signals", "gps_solver.signals")
    return made.pack(folder / f"{name}.ssp")
