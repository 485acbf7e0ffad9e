"""A recorded GPS receiver as an FMU."""

from __future__ import annotations

import numpy as np

from fmus import replay
from fmus.satellite.gps import Gps
from navfmu.export import Component, Example, Table, every

_FIXES = replay.columns(Gps.fix)
_ATTITUDES = replay.columns(Gps.attitude)
_SPEED = 46.3
_EXAMPLE = replay.made(
    _FIXES,
    1.0,
    60,
    **{
        "latitude": 0.6581,
        "longitude": lambda t: -2.1262 - _SPEED * t / 5.05e6,
        "altitude": 1500.0,
        "velocity_n[2]": -_SPEED,
    },
)


class GpsReplay(replay.face(Gps), Component):
    """Recorded fixes and attitudes of a GPS receiver, in the place of gps.

    The tables resources/fixes.npy and attitudes.npy hold samples: the time at which one comes, the time that its values
    hold for, its number, whether it is valid, and the values. At each tick the last one that has come is published, if
    that was not done before. `sequence` is its number: where two come in one tick it jumps, and who takes the bundle
    counts what was lost. Behind the last sample nothing comes any more. A recording without attitudes has none to tell:
    the bundle stays as it starts, with sequence 0.

    The inputs are those of gps, so that this FMU takes its place in a system; those of the truth do nothing. Jammed,
    it does what gps does: `valid` is false, `sequence` counts on, the values are the last good ones. `delay` makes all
    samples late, and leaves the time that they hold for.

    `navfmu replay gps FILE --out NAME.fmu` writes this FMU with a recording of yours; as built it holds a minute of
    level flight.
    """

    name = "gps_replay"
    example = Example(
        text="The built-in samples: level flight to the west at 90 kn, jammed from 40 s on (dotted), when `valid` "
        "falls to 0 and the values are held.",
        step=0.5,
        mark=40.0,
        inputs=lambda time: {"jammed": time >= 40.0},
        shows=("fix.longitude", "fix.velocity_n", "fix.valid", "fix.sequence"),
    )

    jammed = Gps.jammed
    delay = replay.delay()
    tick_period = replay.tick_period()

    fixes = Table(columns=_FIXES, rows=_EXAMPLE)
    attitudes = Table(columns=_ATTITUDES, rows=replay.silence(_ATTITUDES))

    @every("tick_period")
    def locate(self):
        self._play(self.fix, Gps.fix, "fixes")

    @every("tick_period")
    def orient(self):
        self._play(self.attitude, Gps.attitude, "attitudes")

    def _play(self, told, bundle, table):
        sample = replay.latest(self, table, self.delay)
        free = np.logical_not(self.jammed)
        sample["valid"] = sample["valid"] & free
        values = replay.values(sample, bundle)
        values = {name: np.where(free, value, getattr(told, name)) for name, value in values.items()}
        told.publish(**replay.announcement(sample, told), **values)
