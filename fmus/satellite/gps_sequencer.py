"""The FMU ``gps_sequencer``: a receiver that follows satellites in turn, between what is there and what solves."""

from __future__ import annotations

import numpy as np

from fmus.satellite import examples
from fmus.satellite.signals import PLACES
from fmus.satellite.signals import signals as told
from models.satellite import sequence
from navfmu.export import Component, Example, Input, Output, Parameter, State, on_new


class GpsSequencer(Component):
    """Sequential receiver: its channels stay on satellites for a time each, and go on to the next ones.

    Takes the bundle `signals` of gps_signals, as from a channel for each satellite, and passes on what `channels` of
    them have measured, one `dwell` after the other: the single-channel set of AGARD CP-298 (1981), Peterson, with four
    satellites has a position each 8 s. A measurement is made at the end of a dwell. When all satellites that are
    tracked have had their turn the bundle `sequenced` is published: pseudoranges carried on by their rates to now, so
    that a position is off by half of the acceleration along the lines of sight times the square of the age.

    Which satellites: those that gps_signals tracks; with its `channels` at 4 those that lie best.
    """

    example = Example(
        text="Eight satellites over level flight to the west, one channel, 2 s each: measurements come each 16 s.",
        step=1.0,
        inputs=examples.signals_inputs,
        shows=("turn", "sequenced.sequence"),
    )

    signals = told(Input)

    tick_period = Parameter("s", start=0.1, min=1e-3, max=60.0, description="how often new measurements are looked for")
    channels = Parameter(kind="integer", start=1, min=1, max=PLACES, description="satellites followed at a time")
    dwell = Parameter(
        "s", start=2.0, min=0.0, max=3600.0, description="on each: four in 8 s (AGARD CP-298, Peterson: about 8 s)"
    )

    sequenced = told(Output)
    turn = Output(PLACES, kind="boolean", description="satellites that are followed now")

    last = State(kind="integer", start=PLACES - 1, description="place of the last one of those, from 0")
    since = State("s", start=-1.0, description="time of validity at which their turn began; below 0: none did")
    done = State(PLACES, kind="boolean", description="satellites that have had their turn")
    held = State((5, PLACES), "1", description="PRN, time (s), pseudorange (m), rate (m/s) and C/N0 when they had it")

    tick = "tick_period"

    @on_new("signals")
    def follow(self):
        s = self.signals
        now = s.time_of_validity
        tracked = s.tracked & s.valid
        idle = (self.since < 0.0) | np.logical_not(np.any(self.turn & tracked))
        over = idle | (now - self.since >= self.dwell - 1e-9)
        measured = self.turn & tracked & over
        fresh = np.stack([1.0 * s.number, now + 0.0 * s.pseudorange, s.pseudorange, s.range_rate, s.signal_to_noise])
        held = np.where(measured, fresh, self.held)
        done = (self.done | measured) & tracked & (held[0] == s.number)

        complete = over & np.all(done | np.logical_not(tracked))
        age = np.where(done, now - held[1], 0.0)
        pseudorange = sequence.carried(held[2], held[3], age)
        same = {name: getattr(s, name) for name in ("week", "seconds", "number", "accuracy", "correction")}
        more = ("satellite_e", "satellite_velocity_e", "satellite_clock", "satellite_clock_rate", "correction_sigma")
        self.sequenced.publish(
            **same,
            **{name: getattr(s, name) for name in more},
            tracked=done,
            corrected=s.corrected & done,
            pseudorange=np.where(done, pseudorange, 0.0),
            range_rate=np.where(done, held[3], 0.0),
            signal_to_noise=np.where(done, held[4], 0.0),
            valid=s.valid,
            time_of_validity=now,
            when=complete,
        )
        turn, last = sequence.following(tracked, self.last, self.channels)
        self.turn = np.where(over, turn, self.turn)
        self.last = np.where(over, last, self.last)
        self.since = np.where(over, now, self.since)
        self.done = done & np.logical_not(complete)
        self.held = held
