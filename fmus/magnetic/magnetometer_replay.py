"""A recorded magnetometer triad as an FMU."""

from __future__ import annotations

import numpy as np

from fmus import replay
from fmus.magnetic.magnetometer import Magnetometer
from navfmu.export import Component, Example, Table, every

_COLUMNS = replay.columns(Magnetometer.field)
_EXAMPLE = replay.made(
    _COLUMNS,
    0.1,
    **{
        "field_b[1]": lambda t: 22e-6 * np.cos(0.05 * t),
        "field_b[2]": lambda t: -22e-6 * np.sin(0.05 * t),
        "field_b[3]": 42e-6,
    },
)


class MagnetometerReplay(replay.face(Magnetometer), Component):
    """Recorded samples of a magnetometer triad, in the place of magnetometer.

    The table resources/samples.npy holds samples: the time at which one comes, the time that its values hold for, its
    number, whether it is valid, and the field in body axes. At each tick the last sample that has come is published, if
    that was not done before. `sequence` is its number: where two come in one tick it jumps, and who takes the bundle
    counts what was lost. Behind the last sample nothing comes any more.

    The inputs are those of magnetometer, so that this FMU takes its place in a system; those of the truth do nothing.
    The fault `hard_iron_change` is a field that is added to the recorded one. `delay` makes all samples late, and
    leaves the time that they hold for.

    `navfmu replay magnetometer FILE --out NAME.fmu` writes this FMU with a recording of yours; as built it holds a
    minute of a slow turn.
    """

    name = "magnetometer_replay"
    example = Example(
        steps={"hard_iron_change": (0.0, 5e-6, 0.0)},
        text="The built-in samples: an aircraft that turns to the right by 3 degrees a second. Then something in it "
        "becomes magnetic: 50 mG to the right are added to what was recorded.",
    )

    hard_iron_change = Magnetometer.hard_iron_change
    delay = replay.delay()
    tick_period = replay.tick_period()

    samples = Table(columns=_COLUMNS, rows=_EXAMPLE)

    @every("tick_period")
    def play(self):
        sample = replay.latest(self, "samples", self.delay)
        values = replay.values(sample, Magnetometer.field)
        values["field_b"] = values["field_b"] + self.hard_iron_change
        told = replay.announcement(sample, self.field)
        told["valid"] = told["valid"] & np.isfinite(np.sum(values["field_b"]))
        self.field.publish(**told, **values)
