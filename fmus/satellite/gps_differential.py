"""The FMU ``gps_differential``: a reference station, its radio link, and corrected signals of another receiver."""

from __future__ import annotations

import numpy as np

from fmus.satellite import examples
from fmus.satellite.gps_signals import SATELLITES
from fmus.satellite.gps_solver import FARTHEST
from fmus.satellite.signals import PLACES
from fmus.satellite.signals import signals as told
from models.earth import earth
from models.satellite import differential, gps_time
from navfmu.constants import SPEED_OF_LIGHT
from navfmu.export import Component, Example, Input, Output, Parameter, State, on_new, require

NEVER = -1e9
"""s."""
OF_EACH = (
    "pseudorange", "range_rate", "signal_to_noise", "satellite_clock", "satellite_clock_rate", "accuracy", "correction",
    "correction_sigma",
)  # fmt: skip
VECTORS = ("satellite_e", "satellite_velocity_e")
"""What is passed on of each satellite; where one of its numbers is none, it is not tracked."""


class GpsDifferential(Component):
    """Differential GPS: what a receiver at a known place finds wrong with satellites is corrected in another one.

    Takes `signals` of the other receiver and `reference`, those of a receiver at `reference_latitude`,
    `reference_longitude` and `reference_altitude`, and gives `differential`, for the input `signals` of gps_solver. A
    message is sent each `message_period`, and counts for what is measured `latency` later or more: for each PRN the
    correction of the pseudorange and that of the range rate, by which the first is carried on (`carried`) by its age,
    the difference of the two time tags. Corrections older than `timeout` are not used. AGARD CP-298 (1981), Peterson:
    below 3 m in each axis.

    Corrected are satellites that both receivers follow, whatever places they have. Corrections have what is left of
    the station's clock, so the others are then not passed on; where fewer than `least_satellites` are corrected, all
    are passed on as they came.

    What is left: errors of both receivers, and the air where it is not the same, first of all at another height. An
    antenna that does not stand where the parameters say moves all positions by as much. Orbits and clocks must be the
    same for both. What corrections leave is not told (`correction_sigma` 0): gps_solver has `differential_sigma`.
    """

    name = "gps_differential"
    example = Example(
        {"timeout": 15.0, "reference_latitude": examples.STATION[0], "reference_longitude": examples.STATION[1],
         "reference_altitude": examples.STATION[2]},
        text="Eight satellites over level flight to the west, and a station where it begins. The link is lost from "
        "40 s on (dotted), corrections hold for another 15 s.",
        step=1.0,
        mark=examples.FAULT,
        inputs=examples.differential_inputs,
        shows=("satellites", "age", "differential.correction[1]", "differential.correction[2]"),
    )  # fmt: skip

    reference = told(Input)
    signals = told(Input)
    link_lost = Input(kind="boolean", fault=True, description="fault: no message of the station is received any more")

    reference_latitude = Parameter(
        "rad", start=float(np.radians(37.7)), display_unit="deg", description="of the station's antenna"
    )
    reference_longitude = Parameter(
        "rad", start=float(np.radians(-122.0)), display_unit="deg", description="of the station's antenna"
    )
    reference_altitude = Parameter("m", start=30.0, description="of it, above the ellipsoid, positive up")
    tick_period = Parameter("s", start=0.1, min=1e-3, max=60.0, description="how often new measurements are looked for")
    message_period = Parameter("s", start=1.0, min=0.0, max=3600.0, description="from one message to the next")
    latency = Parameter(
        "s", start=1.0, min=0.0, max=3600.0, description="from the station's measurement to its first use"
    )
    timeout = Parameter("s", start=60.0, min=0.0, description="older corrections are not used (own choice)")
    carried = Parameter(
        kind="boolean", start=True, description="whether corrections go on by their rates, or are held as they came"
    )
    least_satellites = Parameter(
        kind="integer", start=4, min=1, max=PLACES, description="with fewer that are corrected none is"
    )

    differential = told(Output)
    satellites = Output(kind="integer", description="number of satellites corrected")
    age = Output("s", description="of the corrections that are used, 0 where none are")

    sent = State((3, SATELLITES), "1", description="last message, by PRN: correction, m, its rate, m/s, and 1")
    sent_tag = State(2, "s", description="GPS week and seconds of the week of what it is of, by the station's clock")
    sent_at = State("s", start=NEVER, description="time of validity of these")
    received = State((3, SATELLITES), "1", description="message before it, as this is")
    received_tag = State(2, "s", description="as that of the last one")

    tick = "tick_period"

    @require("a message has come before the next one is sent: expected latency not above message_period")
    def one_message_under_way(self):
        return self.latency <= self.message_period

    @on_new("reference")
    def send(self):
        r = self.reference
        due = (r.time_of_validity - self.sent_at >= self.message_period - 1e-9) & r.valid & np.isfinite(r.seconds)
        due = due & np.logical_not(self.link_lost)
        pseudorange = r.pseudorange + SPEED_OF_LIGHT * r.satellite_clock
        range_rate = r.range_rate + SPEED_OF_LIGHT * r.satellite_clock_rate
        vectors = np.sum(np.abs(r.satellite_e) + np.abs(r.satellite_velocity_e), axis=1)
        used = r.tracked & (np.abs(pseudorange) + np.abs(range_rate) + vectors < FARTHEST)
        place = earth.to_ecef(self.reference_latitude, self.reference_longitude, self.reference_altitude)
        correction, rate = differential.corrections(
            place,
            np.where(used[:, None], r.satellite_e, np.array([4.0 * earth.EQUATORIAL_RADIUS, 0.0, 0.0])),
            np.where(used[:, None], r.satellite_velocity_e, 0.0),
            np.where(used, pseudorange, 0.0),
            np.where(used, range_rate, 0.0),
            used,
        )
        message = np.stack([correction, rate, np.where(used, 1.0, 0.0)])
        message = message @ np.where(_of(r.number), 1.0, 0.0)
        self.received = np.where(due, self.sent, self.received)
        self.received_tag = np.where(due, self.sent_tag, self.received_tag)
        self.sent = np.where(due, message, self.sent)
        self.sent_tag = np.where(due, np.stack([1.0 * r.week, r.seconds]), self.sent_tag)
        self.sent_at = np.where(due, r.time_of_validity, self.sent_at)

    @on_new("signals")
    def correct(self):
        s = self.signals
        come = s.time_of_validity - self.sent_at >= self.latency - 1e-9
        message = np.where(come, self.sent, self.received)
        tag = np.where(come, self.sent_tag, self.received_tag)
        age = gps_time.elapsed(s.week, s.seconds, tag[0], tag[1])
        correction, rate, there = message @ np.where(_of(s.number), 1.0, 0.0).T
        vectors = np.sum(s.satellite_e + s.satellite_velocity_e, axis=1)
        whole = np.isfinite(sum(getattr(s, name) for name in OF_EACH) + vectors)
        tracked = s.tracked & whole
        corrected = tracked & (there > 0.5) & (np.abs(age) <= self.timeout)
        count = np.sum(np.where(corrected, 1, 0))
        enough = count >= self.least_satellites
        correction = correction + np.where(self.carried, rate * age, 0.0)
        passed = {name: np.where(whole, getattr(s, name), 0.0) for name in OF_EACH}
        passed |= {name: np.where(whole[:, None], getattr(s, name), 0.0) for name in VECTORS}
        passed["correction"] = np.where(enough, np.where(corrected, correction, 0.0), passed["correction"])
        passed["correction_sigma"] = np.where(enough, 0.0, passed["correction_sigma"])
        self.satellites = np.where(enough, count, 0)
        self.age = np.where(enough, age, 0.0)
        self.differential.publish(
            **passed,
            week=s.week,
            seconds=s.seconds,
            number=s.number,
            tracked=np.where(enough, corrected, tracked),
            corrected=np.where(enough, corrected, s.corrected),
            valid=s.valid & np.isfinite(s.seconds),
            time_of_validity=s.time_of_validity,
        )


def _of(number):
    """Whether a place, a row, has the satellite of a PRN, a column."""
    return number[:, None] == np.arange(1, SATELLITES + 1)
