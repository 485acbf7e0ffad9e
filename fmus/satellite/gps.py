"""The FMU ``gps``: GPS/WAAS receiver with three-antenna attitude."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.satellite.jamming import Jamming
from models.attitude import attitude
from models.earth import earth
from models.processes.known import known
from models.satellite import antenna, gps, signal_power
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every


class Gps(Jamming, Component):
    """GPS/WAAS receiver: position and velocity fixes and three-antenna attitude with white errors.

    Thesis section 3.10 (p. 72): at the accuracy of this system the errors of GPS with WAAS are taken as wide-band
    noise, 2 m in each horizontal axis, 5 m in altitude and 0.25 degrees in roll, pitch and heading. The noise of
    velocity (0.1 m/s) is not in the thesis. Fixes come at 1 Hz, attitude at 2 Hz (section 4.11.1).

    Jammed, the receiver goes on reporting at its rates, and says that it has no fix: `valid` is false, `sequence`
    counts on, `time_of_validity` is that of the report and the values are the last good ones. A receiver that falls
    silent (a dropout) must be noticed by its consumers from the age of the last fix.

    Jammers are those of gps_signals (free space to the radio horizon, behind an antenna on the roof), and all
    satellites one of `signal_strength`: lost below `carrier_threshold`, found again when it has been above
    `acquisition_threshold` for `acquisition_time`. Where single satellites matter (their failures, few of them, clocks)
    gps_signals and gps_solver take the place of this one.
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
    accuracy_lie = Input("1", fault=True, description="fault: errors of fixes are larger by this times their sigma")

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
    signal_strength = Parameter("1", start=42.5, description="C/N0 without jammers, dB-Hz: of the fourth satellite")
    carrier_threshold = Parameter("1", start=25.0, description="least C/N0 that is followed, dB-Hz")
    acquisition_threshold = Parameter("1", start=33.0, description="least C/N0 to find it again, dB-Hz")
    acquisition_time = Parameter("s", start=0.0, min=0.0, max=1e4, description="to find it (RTO MP-43: 20 s)")

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

    followed = State(kind="boolean", start=True, description="signals are followed")
    weak_time = State("s", start=-1e9, description="when they were last too weak to be found")

    @every("fix_period")
    def locate(self, noise):
        self._carry_off(self.fix_period)
        offset_n, rate_n = self._spoofed()
        share = 1.0 + known(self.accuracy_lie, 0.0)
        sigmas = (share * self.horizontal_sigma, share * self.vertical_sigma, share * self.velocity_sigma)
        latitude, longitude, altitude, velocity_n = gps.fix(
            self.latitude, self.longitude, self.altitude, self.velocity_n, sigmas, noise(6), offset_n, rate_n
        )
        free = self._follow()
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
        free = self._follow()
        self.attitude.publish(
            roll=np.where(free, roll, self.attitude.roll),
            pitch=np.where(free, pitch, self.attitude.pitch),
            heading=np.where(free, heading, self.attitude.heading),
            valid=free & np.isfinite(roll + pitch + heading),
        )

    def _follow(self):
        """Whether signals are followed now."""
        c_nb = attitude.dcm(known(self.roll, 0.0), known(self.pitch, 0.0), known(self.heading, 0.0))
        interference = self._interference(
            earth.north_east_down(self.latitude, self.longitude),
            lambda unit_n: antenna.gain(antenna.direction(unit_n, c_nb)[1]),
        )
        alone = signal_power.ratio(self.signal_strength + signal_power.NOISE_DENSITY)
        strength = signal_power.carrier_to_noise(alone, interference, signal_power.NOISE_DENSITY, self.jammer_spread)
        heard = np.logical_not(self.jammed | self._within_region())
        strong = heard & (strength >= signal_power.ratio(self.acquisition_threshold))
        holding = heard & (strength >= signal_power.ratio(self.carrier_threshold))
        self.weak_time = np.where(strong, self.weak_time, self.time)
        found = strong & (self.time - self.weak_time > self.acquisition_time - 0.5 * self.fix_period)
        self.followed = np.where(self.followed, holding, found)
        return self.followed
