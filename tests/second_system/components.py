"""A rover that crosses the date line, a finder that says where it is and how sure it is, a judge."""

from __future__ import annotations

import numpy as np

from navfmu.export import Bundle, Component, Input, Output, Parameter, every, start

RADIUS = 6_371_000.0  # m


class Rover(Component):
    """Goes east along a parallel."""

    latitude = Output("rad", display_unit="deg", description="true latitude")
    longitude = Output("rad", display_unit="deg", description="true longitude, -pi to pi")
    latitude0 = Parameter("rad", start=1.2, description="latitude")
    longitude0 = Parameter("rad", start=3.1413, description="longitude at t = 0")
    speed = Parameter("m/s", start=20.0, min=0.0, description="speed over ground")
    sample_period = Parameter("s", start=0.5, min=1e-3, description="time between values")

    @start
    def begin(self):
        self.latitude = self.latitude0
        self.longitude = self.longitude0

    @every("sample_period")
    def step(self):
        far = self.longitude0 + self.speed * self.time / (RADIUS * np.cos(self.latitude0))
        self.latitude = self.latitude0
        self.longitude = np.arctan2(np.sin(far), np.cos(far))


class Finder(Component):
    """Finds the rover from two beacons, so to speak: truth and white noise."""

    latitude = Input("rad", display_unit="deg", description="true latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    place = Bundle(
        latitude=Output("rad", display_unit="deg", description="found latitude"),
        longitude=Output("rad", display_unit="deg", description="found longitude"),
        description="where it seems to be",
    )
    offset = Input("rad", fault=True, description="added to the latitude")
    north_sigma = Output("m", start=1.0, description="claimed standard deviation to the north")
    east_sigma = Output("m", start=1.0, description="claimed standard deviation to the east")
    beacon_latitude = Parameter(3, "rad", start=1.2, description="latitudes of beacons")
    beacon_longitude = Parameter(3, "rad", start=3.1414, description="longitudes of beacons")
    beacon_count = Parameter(kind="integer", start=2, min=0, max=3, description="beacons that there are")
    spread = Parameter("m", start=10.0, min=0.0, description="standard deviation of the noise")
    claim = Parameter("m", start=10.0, min=0.0, description="standard deviation that is claimed")
    sample_period = Parameter("s", start=1.0, min=1e-3, description="time between fixes")

    @every("sample_period")
    def sample(self, noise):
        z = noise(2)
        self.place.publish(
            latitude=self.latitude + self.offset + self.spread * z[0] / RADIUS,
            longitude=self.longitude + self.spread * z[1] / (RADIUS * np.cos(self.latitude)),
            valid=True,
        )
        self.north_sigma = self.claim
        self.east_sigma = self.claim


class ShyFinder(Component):
    """Finds the rover and claims nothing: it takes the place of the finder in a variant."""

    latitude = Input("rad", display_unit="deg", description="true latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    place = Bundle(
        latitude=Output("rad", display_unit="deg", description="found latitude"),
        longitude=Output("rad", display_unit="deg", description="found longitude"),
        description="where it seems to be",
    )
    offset = Input("rad", fault=True, description="added to the latitude")
    sample_period = Parameter("s", start=1.0, min=1e-3, description="time between fixes")

    @every("sample_period")
    def sample(self, noise):
        self.place.publish(
            latitude=self.latitude + self.offset + 1e-6 * noise(1)[0], longitude=self.longitude, valid=True
        )


class Judge(Component):
    """Compares what was found with the truth."""

    latitude = Input("rad", display_unit="deg", description="true latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    place = Bundle(
        latitude=Input("rad", display_unit="deg", description="found latitude"),
        longitude=Input("rad", display_unit="deg", description="found longitude"),
        description="where it seems to be",
    )
    north_error = Output("m", description="found minus true")
    east_error = Output("m", description="found minus true")
    distance = Output("m", description="between found and true")
    sample_period = Parameter("s", start=1.0, min=1e-3, description="time between comparisons")

    @every("sample_period")
    def compare(self):
        turn = self.place.longitude - self.longitude
        east = RADIUS * np.cos(self.latitude) * np.arctan2(np.sin(turn), np.cos(turn))
        self.north_error = np.where(self.place.valid, RADIUS * (self.place.latitude - self.latitude), 0.0)
        self.east_error = np.where(self.place.valid, east, 0.0)
        self.distance = np.sqrt(self.north_error**2 + self.east_error**2)


ALL = (Rover, Finder, ShyFinder, Judge)
