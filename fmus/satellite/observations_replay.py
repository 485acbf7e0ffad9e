"""Recorded observations of satellites as an FMU."""

from __future__ import annotations

import numpy as np

from fmus import replay
from fmus.satellite.gps_signals import SATELLITES, GpsSignals
from fmus.satellite.signals import PLACES
from models.processes.known import known
from models.satellite import broadcast, gps_time, selection, slots
from models.satellite.ephemeris import COLUMNS, Ephemeris
from navfmu.constants import SPEED_OF_LIGHT
from navfmu.export import Component, Example, Parameter, Table, every

MEASURED = (("number", "1"), ("pseudorange", "m"), ("range_rate", "m/s"), ("signal_to_noise", "1"))
_OBSERVATIONS = (
    *replay.TIMES,
    ("week", "1"),
    ("second", "s"),
    *((f"{name}[{i + 1}]", unit) for name, unit in MEASURED for i in range(PLACES)),
)
_SEEN = 8
_EXAMPLE = replay.made(
    _OBSERVATIONS,
    1.0,
    60,
    **{"week": 704.0, "second": lambda t: 345600.0 + t},
    **{f"number[{i}]": float(i) for i in range(1, _SEEN + 1)},
    **{f"pseudorange[{i}]": lambda t, i=i: 2.1e7 + 3e5 * i + 100.0 * (i - 4) * t for i in range(1, _SEEN + 1)},
    **{f"range_rate[{i}]": 100.0 * (i - 4) for i in range(1, _SEEN + 1)},
    **{f"signal_to_noise[{i}]": 50.0 - i for i in range(1, _SEEN + 1)},
)


class ObservationsReplay(replay.face(GpsSignals), Component):
    """Recorded pseudoranges and range rates of satellites of GPS, in the place of gps_signals.

    The table resources/observations.npy holds epochs: the time at which one comes, the time that it holds for, its
    number, whether it is valid, week and second of its time tag, and what was measured of the satellite in each place,
    0 where none is; resources/orbits.npy holds what satellites say of their orbits and clocks. At each tick the last
    epoch that has come is published, if that was not done before, and with it where the satellites were when their
    signals left, and their clocks (IS-GPS-200, table 20-IV and 20.3.3.3.3), by the orbit whose t_oe is the nearest.
    A satellite without an orbit that holds, or one that calls itself unhealthy, is not `tracked`.

    `sequence` is the number of the epoch: where two come in one tick it jumps, and who takes the bundle counts what was
    lost. Behind the last epoch nothing comes any more.

    The inputs are those of gps_signals, so that this FMU takes its place in a system; those of the truth do nothing.
    Jammed, no satellite is tracked; one that is off is not, and one with a range step is too far by it. `clock_jump`
    adds to the time tag and to all pseudoranges. `delay` makes all epochs late, and leaves the time that they hold for.

    `navfmu replay observations FILE --nav FILE --out NAME.fmu` writes this FMU with a RINEX file of yours; as built it
    holds a minute of made ranges to eight nominal satellites, of which no place can be made.
    """

    name = "observations_replay"
    example = Example(
        text="The built-in epochs: eight satellites, one epoch a second, jammed from 40 s on (dotted).",
        step=1.0,
        mark=40.0,
        inputs=lambda time: {"jammed": time >= 40.0},
        shows=("signals.pseudorange", "satellites", "signals.sequence"),
    )

    jammed = GpsSignals.jammed
    satellite_off = GpsSignals.satellite_off
    range_step = GpsSignals.range_step
    clock_jump = GpsSignals.clock_jump
    satellites = GpsSignals.satellites

    delay = replay.delay()
    tick_period = Parameter(
        "s",
        start=0.1,
        min=1e-3,
        max=60.0,
        description="period at which is looked for an epoch: it comes at the first tick that is not before its time",
    )
    future = Parameter(
        kind="boolean",
        start=True,
        description="whether an orbit counts before it was sent: files hold what a receiver had not heard yet",
    )

    observations = Table(columns=_OBSERVATIONS, rows=_EXAMPLE)
    orbits = Table(columns=COLUMNS, rows=slots.constellation())

    @every("tick_period")
    def measure(self):
        epoch = replay.latest(self, "observations", self.delay)
        prn, week, second = epoch["number"], epoch["week"], epoch["second"]
        around = selection.around(self._find, prn, week, second)
        ephemeris = selection.nearest(around, prn, week, second, self.future)
        usable = selection.usable(ephemeris, prn, week, second, self.future)
        position, velocity, clock, rate = broadcast.sent(ephemeris, week, second, epoch["pseudorange"])
        here = prn[:, None] == np.arange(1, SATELLITES + 1)
        silent = np.any(here & self.satellite_off, axis=1) | self.jammed
        tracked = usable & np.logical_not(silent)
        jump = known(self.clock_jump, 0.0)
        wrong = np.sum(np.where(here, known(self.range_step, 0.0), 0.0), axis=1) + SPEED_OF_LIGHT * jump
        tag_week, tag_second = gps_time.normal(week, second + jump)
        new = replay.announcement(epoch, self.signals)
        self.satellites = np.where(new["when"], np.sum(np.where(tracked, 1, 0)), self.satellites)
        self.signals.publish(
            **new,
            week=tag_week,
            seconds=tag_second,
            tracked=tracked,
            number=prn,
            pseudorange=np.where(prn > 0.0, epoch["pseudorange"] + wrong, 0.0),
            range_rate=epoch["range_rate"],
            signal_to_noise=epoch["signal_to_noise"],
            satellite_e=np.where(usable[:, None], position, 0.0),
            satellite_velocity_e=np.where(usable[:, None], velocity, 0.0),
            satellite_clock=np.where(usable, clock, 0.0),
            satellite_clock_rate=np.where(usable, rate, 0.0),
            accuracy=ephemeris.accuracy,
        )

    def _find(self, place):
        """The orbit at or before a place in the table, and the next one."""
        found = self.orbits.around(place=place)
        return Ephemeris.of(found.row), Ephemeris.of(found.next_row)
