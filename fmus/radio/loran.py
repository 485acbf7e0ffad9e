"""The FMU ``loran``: LORAN-C receiver."""

from __future__ import annotations

import numpy as np

from models.processes import gauss_markov
from models.processes.known import known
from models.radio import dme, loran
from models.satellite import gps
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start


class Loran(Component):
    """LORAN-C receiver: horizontal fixes within 0.25 nmi (thesis section 7.3; 2 drms).

    Nearly all of the error is that of the place: what the ground does to the wave. North and east have each a
    first-order Gauss-Markov process over the distance flown (place_distance, own choice: 20 nmi), which starts in its
    stationary distribution, and little noise, 200 ft of 2 drms (Hollister, Natarajan and Littlefield, Navigation 28,
    1981). So fixes are smooth, and wrong in the same way when an aircraft comes back soon.

    While precipitation_static is on, as in rain and near lightning (thesis section 1.2.3), there is no fix: valid is
    false, the values are the last ones. A wrong cycle of the carrier, 10 us, displaces all that follows (cycle_slip).
    Not modelled: chains, geometry and coverage, the time of acquisition.
    """

    name = "loran"
    example = Example(
        {"latitude": 0.659, "longitude": -2.117, "altitude": 1500.0, "velocity_n": (46.0, 0.0, 0.0)},
        steps={"cycle_slip": (1500.0, 0.0)},
        text="A wrong cycle displaces the fixes by 1.5 km to the north; before, they are off by what the ground does.",
        shows=("fix.latitude", "fix.longitude"),
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground: north, east, down")
    precipitation_static = Input(
        kind="boolean", fault=True, description="fault: discharges drown the signal, the receiver has no fix"
    )
    cycle_slip = Input(
        2, "m", fault=True, description="fault: north and east displacement by a wrong cycle, 1.5 km on a base line"
    )

    place_sigma = Parameter(
        "m",
        start=float(loran.PLACE_SIGMA),
        min=0.0,
        display_unit="nmi",
        description="standard deviation of north and of east error of the place",
    )
    place_distance = Parameter(
        "m",
        start=loran.CORRELATION_DISTANCE,
        min=1.0,
        display_unit="nmi",
        description="distance over which the error of the place is correlated",
    )
    lowest_speed = Parameter("m/s", start=5.0, min=0.1, description="least ground speed used for it")
    noise_sigma = Parameter(
        "m", start=float(loran.NOISE_SIGMA), min=0.0, description="standard deviation of the noise, north and east"
    )
    fix_period = Parameter("s", start=1.0, min=0.01, max=60.0, description="time between fixes")
    place_period = Parameter("s", start=1.0, min=0.01, max=60.0, description="time step of the place, own clock")

    fix = Bundle(
        latitude=Output("rad", display_unit="deg", description="measured geodetic latitude"),
        longitude=Output("rad", display_unit="deg", description="measured longitude"),
        description="LORAN fix",
    )
    place = State(2, "m", description="north and east error of the place")

    @start
    def turn_on(self, noise):
        self.place = gauss_markov.stationary(self.place_sigma, noise(2))

    @every("place_period")
    def move(self, noise):
        tau = dme.correlation_time(known(self.velocity_n, 0.0), self.lowest_speed, self.place_distance)
        phi = gauss_markov.decay(self.period, tau)
        self.place = gauss_markov.advance(self.place, phi, gauss_markov.drive(self.place_sigma, phi), noise(2))

    @every("fix_period")
    def locate(self, noise):
        off = self.place + self.cycle_slip + self.noise_sigma * noise(2)
        latitude, longitude = gps.displaced(self.latitude, self.longitude, self.altitude, off[0], off[1])
        fixed = np.logical_not(self.precipitation_static) & np.isfinite(latitude + longitude)
        self.fix.publish(
            latitude=np.where(fixed, latitude, self.fix.latitude),
            longitude=np.where(fixed, longitude, self.fix.longitude),
            valid=fixed,
        )
