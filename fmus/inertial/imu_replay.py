"""A recorded inertial measurement unit as an FMU."""

from __future__ import annotations

import numpy as np

from fmus import replay
from fmus.inertial.imu import Imu
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Component, Example, Table, every

_READINGS = replay.columns(Imu.reading)
_INCREMENTS = replay.columns(Imu.increment)
_EXAMPLE = replay.made(
    _READINGS,
    0.1,
    **{
        "rate[1]": lambda t: 0.2 * np.cos(t),
        "specific_force[2]": lambda t: -0.3 * np.sin(t),
        "specific_force[3]": -STANDARD_GRAVITY,
    },
)


class ImuReplay(replay.face(Imu), Component):
    """Recorded samples of an inertial measurement unit, in the place of imu.

    The tables resources/readings.npy and increments.npy hold samples: the time at which one comes, the time that its
    values hold for, its number, whether it is valid, and the values. At each tick the last one that has come is
    published, if that was not done before. `sequence` is its number: where two come in one tick it jumps, and who takes
    the bundle counts what was lost. Behind the last sample nothing comes any more. What was not recorded, mostly the
    increments, stays as it starts, with sequence 0.

    The inputs are those of imu, so that this FMU takes its place in a system; they do nothing. `delay` makes all
    samples late, and leaves the time that they hold for.

    `navfmu replay imu FILE --out NAME.fmu` writes this FMU with a recording of yours; as built it holds a minute of
    rolling.
    """

    name = "imu_replay"
    example = Example(
        steps={},
        text="The built-in samples: an aircraft that rolls to and fro, read ten times a second.",
        shows=("reading.rate", "reading.specific_force", "reading.valid", "reading.sequence"),
    )

    delay = replay.delay()
    tick_period = replay.tick_period()

    readings = Table(columns=_READINGS, rows=_EXAMPLE)
    increments = Table(columns=_INCREMENTS, rows=replay.silence(_INCREMENTS))

    @every("tick_period")
    def read(self):
        sample = replay.latest(self, "readings", self.delay)
        self.reading.publish(**replay.announcement(sample, self.reading), **replay.values(sample, Imu.reading))

    @every("tick_period")
    def integrate(self):
        sample = replay.latest(self, "increments", self.delay)
        self.increment.publish(**replay.announcement(sample, self.increment), **replay.values(sample, Imu.increment))
