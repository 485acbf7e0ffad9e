"""The FMU ``gps_attitude``: attitude from the carrier of the satellites that a receiver tracks, at three antennas."""

from __future__ import annotations

import numpy as np

from fmus.satellite import examples
from fmus.satellite.gps import Gps
from fmus.satellite.signals import PLACES, signals
from models.attitude import attitude
from models.earth import earth
from models.satellite import baselines, sight, signal_power, tracking
from navfmu.export import Component, Example, Input, Output, Parameter, every


class GpsAttitude(Component):
    """Attitude from three antennas, lost and found with the signals of a receiver.

    Takes the bundle `signals` of gps_signals, or of recorded observations, and gives the bundle `attitude` of gps. The
    errors are those of least squares of phase differences (thesis section 4.6): small angles about north, east and
    down, with the covariance P = (sum over baselines and satellites of (b x s) (b x s)' / sigma^2)^-1, drawn afresh
    each `attitude_period`. So they grow with short baselines, few satellites and a sky that lies badly. sigma of a
    phase at one antenna is that of the carrier loop at the C/N0 of the satellite, and `phase_multipath`, as chosen so
    that the antennas of the thesis (Fig 4.9: 36 cm between the rear ones, 50 cm to the one in front) have 0.25 degrees
    (section 3.10) over a day of the 24 slots.

    `valid` is false with fewer than `least_satellites`, where an angle would be worse than `sigma_limit`, and where the
    last signals are older than `oldest`; then the last good values stand.

    Not modelled: how the number of whole waves is found, flexing of the airframe, multipath that stays.
    """

    example = Example(
        text="Eight satellites over level flight to the west, of which three are left from 40 s on (dotted): "
        "`valid` falls to 0 and the values are held.",
        step=0.5,
        mark=examples.FAULT,
        inputs=examples.attitude_inputs,
        shows=("attitude.roll", "attitude.pitch", "attitude.heading", "attitude.valid", "heading_sigma"),
    )

    latitude = Gps.latitude
    longitude = Gps.longitude
    altitude = Gps.altitude
    roll = Gps.roll
    pitch = Gps.pitch
    heading = Gps.heading
    signals = signals(Input)

    attitude_period = Gps.attitude_period
    antennas = Parameter(
        (3, 3), "m", start=baselines.ANTENNAS, description="places of the antennas in b, a row each (thesis Fig 4.9)"
    )
    phase_multipath = Parameter(
        "m", start=0.0022, min=0.0, description="standard deviation of reflections in a phase at one antenna (chosen)"
    )
    phase_bandwidth = Parameter("Hz", start=10.0, min=0.1, max=100.0, description="of the carrier loop")
    detection_bandwidth = Parameter("Hz", start=50.0, min=1.0, max=1e3, description="before detection: 1 / time")
    least_satellites = Parameter(
        kind="integer", start=4, min=2, max=PLACES, description="no attitude with fewer (4: there is no position)"
    )
    sigma_limit = Parameter(
        "rad",
        start=float(np.radians(5.0)),
        min=1e-6,
        max=1.0,
        display_unit="deg",
        description="no attitude where the standard deviation of an angle is larger (own choice)",
    )
    oldest = Parameter("s", start=2.0, min=0.0, description="signals that hold for longer ago give no attitude")

    attitude = Gps.attitude
    roll_sigma = Output("rad", display_unit="deg", description="standard deviation about the axis forward")
    pitch_sigma = Output("rad", display_unit="deg", description="standard deviation about the level axis to the right")
    heading_sigma = Output("rad", display_unit="deg", description="standard deviation about the vertical")

    @every("attitude_period")
    def orient(self, noise):
        s = self.signals
        place = self.latitude, self.longitude, self.altitude
        finite = np.isfinite(sum(place) + self.roll + self.pitch + self.heading)
        latitude, longitude, altitude, roll, pitch, heading = (
            np.where(finite, x, 0.0) for x in (*place, self.roll, self.pitch, self.heading)
        )
        c_nb = attitude.dcm(roll, pitch, heading)
        used = s.tracked & np.isfinite(np.sum(s.satellite_e, axis=1) + s.signal_to_noise)
        far = np.where(used[:, None], s.satellite_e, np.array([4.0 * earth.EQUATORIAL_RADIUS, 0.0, 0.0]))
        _, unit_e = sight.ranges(earth.to_ecef(latitude, longitude, altitude), far)
        unit_n = unit_e @ earth.north_east_down(latitude, longitude).T

        ratio = signal_power.ratio(np.where(used, s.signal_to_noise, 0.0))
        loop = tracking.WAVELENGTH / (2.0 * np.pi) * tracking.phase_sigma(
            ratio, self.phase_bandwidth, self.detection_bandwidth
        )  # fmt: skip
        weight = np.where(used, 1.0 / (self.phase_multipath**2 + loop**2), 0.0)
        p, solvable = baselines.covariance(baselines.information(unit_n, weight, self.antennas @ c_nb.T))
        good = solvable & (np.max(np.diagonal(p)) <= self.sigma_limit**2)
        p = np.where(good, p, np.eye(3))
        forward = np.array([np.cos(heading), np.sin(heading), 0.0])
        level = np.array([-np.sin(heading), np.cos(heading), 0.0])
        told = np.sqrt(np.stack([forward @ p @ forward, level @ p @ level, p[2, 2]]))
        self.roll_sigma, self.pitch_sigma, self.heading_sigma = np.where(good, told, np.pi)

        fresh = s.valid & (self.time - s.time_of_validity <= self.oldest)
        enough = np.sum(np.where(used, 1, 0)) >= self.least_satellites
        valid = good & finite & fresh & enough
        measured = attitude.euler(baselines.turned(c_nb, np.linalg.cholesky(p) @ noise(3)))
        angles = {"roll": measured[0], "pitch": measured[1], "heading": attitude.wrap(measured[2])}
        self.attitude.publish(
            **{name: np.where(valid, angle, getattr(self.attitude, name)) for name, angle in angles.items()},
            valid=valid,
        )
