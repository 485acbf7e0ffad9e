"""The FMU ``gps``: GPS/WAAS receiver with three-antenna attitude."""

from __future__ import annotations

import numpy as np

from fmus import examples
from models.satellite import gps
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, every


class Gps(Component):
    """GPS/WAAS receiver: position and velocity fixes and three-antenna attitude with white errors.

    Thesis section 3.10 (p. 72): at the accuracy of this system the errors of GPS with WAAS are taken as wide-band
    noise, 2 m in each horizontal axis, 5 m in altitude and 0.25 degrees in roll, pitch and heading. The noise of
    velocity (0.1 m/s) is not in the thesis. Fixes come at 1 Hz, attitude at 2 Hz (section 4.11.1).

    Jammed, the receiver goes on reporting at its rates, and says that it has no fix: `valid` is false, `sequence`
    counts on, `time_of_validity` is that of the report and the values are the last good ones. A receiver that falls
    silent (a dropout) must be noticed by its consumers from the age of the last fix.
    """

    example = Example(
        text="Level flight to the west at 90 kn, jammed from 40 s on (dotted): `valid` falls to 0, the values are "
        "held. Before that a fix comes each second, with errors that are independent from one to the next.",
        step=0.5,
        mark=examples.JAMMED,
        inputs=examples.gps_inputs,
        shows=("fix.longitude", "fix.velocity_n", "fix.valid", "fix.sequence"),
        panels=examples.gps_panels,
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground: north, east, down")
    roll = Input("rad", display_unit="deg", description="true roll")
    pitch = Input("rad", display_unit="deg", description="true pitch")
    heading = Input("rad", display_unit="deg", description="true heading, may be unwrapped")
    jammed = Input(kind="boolean", fault=True, description="fault: interference, the receiver has no fix")

    fix_period = Parameter("s", start=1.0, min=0.01, max=60.0, description="period of fixes (thesis section 2.5.1)")
    attitude_period = Parameter("s", start=0.5, min=0.01, max=60.0, description="period of attitude (thesis Fig 4.7)")
    horizontal_sigma = Parameter(
        "m",
        start=gps.HORIZONTAL_SIGMA,
        min=0.0,
        description="standard deviation of north and of east position (thesis section 3.10)",
    )
    vertical_sigma = Parameter(
        "m", start=gps.VERTICAL_SIGMA, min=0.0, description="standard deviation of altitude (thesis section 3.10)"
    )
    velocity_sigma = Parameter(
        "m/s",
        start=gps.VELOCITY_SIGMA,
        min=0.0,
        description="standard deviation of each component of velocity; not in the thesis, usual for Doppler velocity",
    )
    attitude_sigma = Parameter(
        "rad",
        start=gps.ATTITUDE_SIGMA,
        min=0.0,
        display_unit="deg",
        description="standard deviation of roll, pitch and heading (thesis section 3.10, Table 4.2)",
    )

    fix = Bundle(
        latitude=Output("rad", display_unit="deg", description="measured geodetic latitude"),
        longitude=Output("rad", display_unit="deg", description="measured longitude"),
        altitude=Output("m", display_unit="ft", description="measured height above the ellipsoid, positive up"),
        velocity_n=Output(3, "m/s", display_unit="kn", description="measured velocity over ground: north, east, down"),
        description="GPS fix",
    )
    attitude = Bundle(
        roll=Output("rad", display_unit="deg", description="measured roll"),
        pitch=Output("rad", display_unit="deg", description="measured pitch"),
        heading=Output("rad", display_unit="deg", description="measured heading in [-pi, pi)"),
        description="GPS attitude",
    )

    @every("fix_period")
    def locate(self, noise):
        sigmas = (self.horizontal_sigma, self.vertical_sigma, self.velocity_sigma)
        latitude, longitude, altitude, velocity_n = gps.fix(
            self.latitude, self.longitude, self.altitude, self.velocity_n, sigmas, noise(6)
        )
        free = np.logical_not(self.jammed)
        self.fix.publish(
            latitude=np.where(free, latitude, self.fix.latitude),
            longitude=np.where(free, longitude, self.fix.longitude),
            altitude=np.where(free, altitude, self.fix.altitude),
            velocity_n=np.where(free, velocity_n, self.fix.velocity_n),
            valid=free & np.isfinite(latitude + longitude + altitude + np.sum(velocity_n)),
        )

    @every("attitude_period")
    def orient(self, noise):
        roll, pitch, heading = gps.angles(self.roll, self.pitch, self.heading, self.attitude_sigma, noise(3))
        free = np.logical_not(self.jammed)
        self.attitude.publish(
            roll=np.where(free, roll, self.attitude.roll),
            pitch=np.where(free, pitch, self.attitude.pitch),
            heading=np.where(free, heading, self.attitude.heading),
            valid=free & np.isfinite(roll + pitch + heading),
        )
