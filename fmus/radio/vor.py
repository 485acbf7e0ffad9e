"""The FMU ``vor``: VOR receiver and the stations on whose radials the aircraft is."""

from __future__ import annotations

import numpy as np

from fmus.radio import stations
from models.processes import gauss_markov
from models.processes.known import known
from models.radio import dme, sight, vor
from navfmu.constants import NAUTICAL_MILE
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start

PLACES = stations.PLACES


class Vor(stations.StationTable, Component):
    """VOR receiver with up to five ground stations: the radials on which the aircraft is.

    The radial of each station is the azimuth of the aircraft at the station, from where its zero radial points
    (station_variation from true north), and

    station    alignment of its courses, drawn once for each: 1 degree
    bends      of its courses along the flight: first-order Gauss-Markov, 1 degree, correlation time bend_distance / V
    receiver   common to all stations, drawn once: 1.4 degrees
    noise      0.2 degrees a reading

    Together 2 degrees, as Brokof and Hurrass (AGARD CP-298) have it; thesis section 7.3: 1 to 5 degrees. How they are
    divided is own choice. So a position by a radial becomes worse with distance, 1.7 nmi at 20 nmi with 5 degrees.

    A station is received within its range, above the radio horizon (4/3 earth, smooth), below its cone
    (highest_elevation) and while it is not switched off. Not modelled: the flag's delay, terrain.
    """

    name = "vor"
    example = Example(
        {"latitude": 0.659, "longitude": -2.117, "altitude": 1500.0, "velocity_n": (46.0, 0.0, 0.0)},
        steps={"longitude": -2.1185},
        text="The aircraft moves 7.6 km to the west at once, which turns it on the radials of both stations. The error "
        "of each is the same before and after but for bends and noise.",
        shows=("bearing.radial", "bearing.received"),
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    velocity_n = Input(
        3, "m/s", display_unit="kn", description="true velocity over ground: north, east, down; for the bends"
    )
    station_off = Input(PLACES, kind="boolean", fault=True, description="fault: this station is off the air")
    course_shift = Input(
        PLACES, "rad", display_unit="deg", fault=True, description="fault: all courses of this station are turned"
    )

    station_variation = Parameter(
        PLACES,
        "rad",
        start=0.0,
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="where the zero radial of each station points, from true north to the east",
    )
    station_range = Parameter(
        PLACES,
        "m",
        start=stations.UNLIMITED * NAUTICAL_MILE,
        min=0.0,
        display_unit="nmi",
        description="service range of each station",
    )
    antenna_height = Parameter(
        "m", start=10.0, min=0.0, max=500.0, description="height of the stations' antennas, for the radio horizon"
    )
    highest_elevation = Parameter(
        "rad",
        start=float(vor.HIGHEST),
        min=0.0,
        max=np.pi / 2,
        display_unit="deg",
        description="largest elevation of the aircraft at a station; above is its cone (ICAO Annex 10: 40 deg)",
    )
    station_sigma = Parameter(
        "rad",
        start=float(vor.STATION_SIGMA),
        min=0.0,
        display_unit="deg",
        description="standard deviation of a station's alignment",
    )
    bend_sigma = Parameter(
        "rad", start=float(vor.BEND_SIGMA), min=0.0, display_unit="deg", description="standard deviation of the bends"
    )
    bend_distance = Parameter(
        "m",
        start=dme.CORRELATION_DISTANCE,
        min=1.0,
        display_unit="nmi",
        description="distance over which bends are correlated; own choice, that of the thesis for DME",
    )
    lowest_speed = Parameter("m/s", start=5.0, min=0.1, description="least ground speed used for the bends")
    receiver_sigma = Parameter(
        "rad",
        start=float(vor.RECEIVER_SIGMA),
        min=0.0,
        display_unit="deg",
        description="standard deviation of the receiver's own error, common to all stations",
    )
    noise_sigma = Parameter(
        "rad",
        start=float(vor.NOISE_SIGMA),
        min=0.0,
        display_unit="deg",
        description="standard deviation of the noise of a reading",
    )
    sample_period = Parameter("s", start=1.0, min=0.01, max=60.0, description="time between readings")
    bend_period = Parameter("s", start=0.5, min=0.01, max=10.0, description="time step of the bends, own clock")

    bearing = Bundle(
        radial=Output(PLACES, "rad", display_unit="deg", description="radial of each station, -pi to pi"),
        received=Output(PLACES, kind="boolean", description="whether this station is received"),
        description="radials from the stations",
    )
    station_error = State(PLACES, "rad", description="alignment of each station's courses")
    receiver_error = State("rad", description="error of the receiver")
    bends = State(PLACES, "rad", description="bends of each station's courses where the aircraft is")

    @start
    def turn_on(self, noise):
        self.station_error = self.station_sigma * noise(PLACES)
        self.receiver_error = self.receiver_sigma * noise(1)[0]
        self.bends = gauss_markov.stationary(self.bend_sigma, noise(PLACES))

    @every("bend_period")
    def bend(self, noise):
        tau = dme.correlation_time(known(self.velocity_n, 0.0), self.lowest_speed, self.bend_distance)
        phi = gauss_markov.decay(self.period, tau)
        driving = gauss_markov.drive(self.bend_sigma, phi)
        self.bends = gauss_markov.advance(self.bends, phi, driving, noise(PLACES))

    @every("sample_period")
    def receive(self, noise):
        places = self.station_latitude, self.station_longitude, self.station_altitude
        line = dme.line_of_sight(self.latitude, self.longitude, self.altitude, *places)
        north, east, up = sight.in_n(self.station_latitude, self.station_longitude, line)
        distance = np.sqrt(np.sum(line * line, axis=0))
        reach = np.minimum(dme.horizon(self.altitude, self.station_altitude, self.antenna_height), self.station_range)
        here = np.arange(PLACES) < self.station_count
        below = np.logical_not(sight.is_above(up, distance, self.highest_elevation))
        received = here & (distance <= reach) & below & np.logical_not(self.station_off)
        shown = vor.radial(
            sight.azimuth(north, east),
            self.station_variation,
            self.station_error + self.course_shift,
            self.bends,
            self.receiver_error,
            self.noise_sigma * noise(PLACES),
        )
        received = received & np.isfinite(shown)
        self.bearing.publish(
            radial=np.where(received, shown, self.bearing.radial), received=received, valid=np.any(received)
        )
