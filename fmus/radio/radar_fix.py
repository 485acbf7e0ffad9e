"""The FMU ``radar_fix``: positions that a ground radar measured, received through a data link."""

from __future__ import annotations

import numpy as np

from models.processes.known import known
from models.radio import dme, radar, sight
from models.satellite import gps
from navfmu.constants import NAUTICAL_MILE
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, require, start


class RadarFix(Component):
    """Position of the aircraft as a secondary surveillance radar sees it, sent up to it (thesis section 8.2.1).

    The radar looks at the aircraft every scan_period, at its own moment of the turn (scan_phase), and measures distance
    and azimuth, each with an error of the radar (drawn once: registration) and a random one. The position of that
    moment comes up scan_phase + latency later in the turn: the bundle's time_of_validity is the moment of the
    measurement where the message tells it (stamped), else that of its arrival, and then a fix is behind the aircraft by
    latency times speed.

    The radar sees the aircraft within radar_range, above the radio horizon (4/3 earth, smooth) and below
    highest_elevation. Where it does not, while it is off or the link is lost, the receiver says at the time of arrival
    that there is no fix: valid is false, sequence counts on, the values are the last ones. Not modelled: garbled
    replies, the tracker of the ground, terrain. The figures of a terminal radar with monopulse are own choice; the
    thesis says more often than every 30 s.
    """

    name = "radar_fix"
    example = Example(
        {"latitude": 0.659, "longitude": -2.117, "altitude": 1500.0},
        steps={"longitude": -2.1165},
        text="The aircraft jumps to the east; the next turn of the radar sees it, and it is told two seconds later.",
        shows=("fix.longitude", "fix.sequence", "fix.valid"),
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    radar_off = Input(kind="boolean", fault=True, description="fault: the radar does not see the aircraft")
    link_lost = Input(kind="boolean", fault=True, description="fault: messages do not arrive")
    azimuth_shift = Input("rad", display_unit="deg", fault=True, description="fault: the radar's north is turned")

    radar_latitude = Parameter(
        "rad",
        start=float(np.radians(37.72)),
        min=-np.pi / 2,
        max=np.pi / 2,
        display_unit="deg",
        description="geodetic latitude of the radar; Oakland's airport",
    )
    radar_longitude = Parameter(
        "rad",
        start=float(np.radians(-122.22)),
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="longitude of the radar",
    )
    radar_altitude = Parameter(
        "m", start=20.0, min=-1000.0, max=10000.0, display_unit="ft", description="height of the radar's antenna"
    )
    radar_range = Parameter(
        "m", start=60.0 * NAUTICAL_MILE, min=0.0, display_unit="nmi", description="range of the radar"
    )
    highest_elevation = Parameter(
        "rad",
        start=float(np.radians(45.0)),
        min=0.0,
        max=np.pi / 2,
        display_unit="deg",
        description="elevation above which the radar is blind",
    )
    range_offset_sigma = Parameter(
        "m", start=30.0, min=0.0, description="standard deviation of the radar's own error of distance"
    )
    azimuth_offset_sigma = Parameter(
        "rad",
        start=float(np.radians(0.1)),
        min=0.0,
        display_unit="deg",
        description="standard deviation of the radar's own error of azimuth",
    )
    range_sigma = Parameter("m", start=15.0, min=0.0, description="standard deviation of a distance")
    azimuth_sigma = Parameter(
        "rad",
        start=float(np.radians(0.08)),
        min=0.0,
        display_unit="deg",
        description="standard deviation of an azimuth (monopulse)",
    )
    scan_period = Parameter(
        "s", start=4.8, min=0.1, max=60.0, description="time of a turn: terminal 4.8, en route 12 s"
    )
    scan_phase = Parameter("s", start=1.0, min=0.0, max=60.0, description="when in a turn the radar looks here")
    arrival_phase = Parameter(
        "s", start=3.0, min=0.0, max=60.0, description="when in a turn a message arrives: scan_phase and the latency"
    )
    stamped = Parameter(kind="boolean", start=True, description="a message tells when the radar looked")

    fix = Bundle(
        latitude=Output("rad", display_unit="deg", description="measured geodetic latitude"),
        longitude=Output("rad", display_unit="deg", description="measured longitude"),
        description="position by radar",
    )
    offset = State(2, "1", description="the radar's own errors of distance and azimuth, over their sigmas")
    seen = State(kind="boolean", description="the radar has seen the aircraft in this turn")
    seen_at = State("s", description="when")
    seen_latitude = State("rad", description="where")
    seen_longitude = State("rad", description="where")

    @require(
        "a message arrives at {arrival_phase} s and the radar looks at {scan_phase} s of a turn of {scan_period} s; "
        "expected it to arrive after that and less than a turn later"
    )
    def arrives_within_a_turn(self):
        latency = self.arrival_phase - self.scan_phase
        return (latency >= 0.0) & (latency < self.scan_period)

    @start
    def register(self, noise):
        self.offset = noise(2)

    @every("scan_period", offset="scan_phase")
    def look(self, noise):
        errors = noise(2)
        radar_place = (np.reshape(x, (1,)) for x in (self.radar_latitude, self.radar_longitude, self.radar_altitude))
        line = dme.line_of_sight(self.latitude, self.longitude, self.altitude, *radar_place)[:, 0]
        _, _, up = sight.in_n(self.radar_latitude, self.radar_longitude, line)
        reach = np.minimum(dme.horizon(self.altitude, self.radar_altitude, 0.0), self.radar_range)
        distance = np.sqrt(np.sum(line * line))
        below = np.logical_not(sight.is_above(up, distance, self.highest_elevation))
        self.seen = (distance <= reach) & below & np.logical_not(self.radar_off)
        off = radar.displacement(
            *sight.in_n(self.latitude, self.longitude, line),
            self.range_offset_sigma * self.offset[0] + self.range_sigma * errors[0],
            self.azimuth_offset_sigma * self.offset[1] + self.azimuth_shift + self.azimuth_sigma * errors[1],
        )
        latitude, longitude = gps.displaced(self.latitude, self.longitude, self.altitude, *off)
        self.seen = self.seen & np.isfinite(latitude + longitude)
        self.seen_latitude = known(latitude, self.seen_latitude)
        self.seen_longitude = known(longitude, self.seen_longitude)
        self.seen_at = self.time

    @every("scan_period", offset="arrival_phase")
    def arrive(self):
        told = self.seen & np.logical_not(self.link_lost)
        self.fix.publish(
            latitude=np.where(told, self.seen_latitude, self.fix.latitude),
            longitude=np.where(told, self.seen_longitude, self.fix.longitude),
            valid=told,
            time_of_validity=np.where(told & self.stamped, self.seen_at, self.time),
        )
