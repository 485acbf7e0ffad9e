"""A made sky as RINEX files: satellites on circles, seen from the ground, by light time in an inertial frame.

Independent of the models: positions are products of rotation matrices, that of the ground is pymap3d's, and rates are
differences of ranges. There is no atmosphere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime, timedelta

import numpy as np
import pymap3d

from tests.satellite.made import line

LIGHT, EARTH_RATE, GRAVITATION = 299792458.0, 7.2921151467e-5, 3.986005e14
START = datetime(2020, 6, 25)
WEEK, SECOND = 2111, 345600.0
"""Of START."""
SQRT_A = 5153.7
TOE = 7200.0
"""s after START, t_oe and t_oc."""


def about_z(angle: float) -> np.ndarray:
    """Rotation of vectors about the z axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_x(angle: float) -> np.ndarray:
    """Rotation of vectors about the x axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


@dataclass
class Sky:
    """32 satellites over a receiver that stands; ``clock`` (s) and ``drift`` are the receiver's, at START."""

    latitude: float = 0.9685
    longitude: float = 0.1476
    altitude: float = 60.0
    clock: float = 1e-4
    drift: float = 1e-9
    node: np.ndarray = field(default_factory=lambda: np.linspace(-3.0, 3.0, 32))
    anomaly: np.ndarray = field(default_factory=lambda: np.mod(np.arange(32) * 2.4, 6.2) - 3.1)
    bias: np.ndarray = field(default_factory=lambda: np.linspace(-5e-4, 5e-4, 32))
    rate: np.ndarray = field(default_factory=lambda: np.linspace(-1e-11, 1e-11, 32))
    delay: np.ndarray = field(default_factory=lambda: np.linspace(-1e-8, 1e-8, 32))

    @property
    def position_e(self) -> np.ndarray:
        return np.array(pymap3d.geodetic2ecef(self.latitude, self.longitude, self.altitude, deg=False))

    def satellite(self, k: int, time: float) -> np.ndarray:
        """Inertial position at ``time`` s after START; e is inertial at the beginning of the week."""
        argument = self.anomaly[k] + np.sqrt(GRAVITATION) / SQRT_A**3 * (time - TOE)
        return about_z(self.node[k]) @ about_x(0.96) @ about_z(argument) @ np.array([SQRT_A**2, 0.0, 0.0])

    def travel(self, k: int, time: float) -> float:
        """Light time of a signal that arrives at ``time``, s."""
        here, found = about_z(EARTH_RATE * (SECOND + time)) @ self.position_e, 0.07
        for _ in range(8):
            found = float(np.linalg.norm(self.satellite(k, time - found) - here)) / LIGHT
        return found

    def high(self, k: int, time: float) -> bool:
        """Whether a satellite is 12 degrees above the horizon."""
        place = about_z(-EARTH_RATE * (SECOND + time)) @ self.satellite(k, time)
        return pymap3d.ecef2aer(*place, self.latitude, self.longitude, self.altitude, deg=False)[1] > np.radians(12.0)

    def measured(self, k: int, shown: float) -> tuple[float, float]:
        """Pseudorange (m) and Doppler (Hz) at ``shown`` s after START by the receiver's clock."""

        def pseudorange(shown: float) -> float:
            time = shown - self.clock - self.drift * shown
            tau = self.travel(k, time)
            own = self.bias[k] + self.rate[k] * (time - tau - TOE) - self.delay[k]
            return LIGHT * (shown - (time - tau + own))

        return pseudorange(shown), -(pseudorange(shown + 0.5) - pseudorange(shown - 0.5)) * 1575.42e6 / LIGHT

    def observations(self, times, doppler: float = 1.0, tags: float = 0.0, left_out=lambda k, time: False) -> str:
        """A file of version 3; ``tags`` s are added to the time tags, ``doppler`` is a factor."""
        text = (
            line("     3.05           OBSERVATION DATA    G: GPS", "RINEX VERSION / TYPE")
            + line("MADE", "MARKER NAME")
            + line("G    3 C1C D1C S1C", "SYS / # / OBS TYPES")
            + line("  2020     6    25     0     0    0.0000000     GPS", "TIME OF FIRST OBS")
            + line("", "END OF HEADER")
        )
        for time in times:
            seen = [k for k in range(32) if self.high(k, time) and not left_out(k, time)]
            at = START + timedelta(seconds=time + tags)
            text += f"> {at:%Y %m %d %H %M} {at.second:2d}.{at.microsecond:06d}0  0{len(seen):3d}\n"
            for k in seen:
                code, shift = self.measured(k, time)
                text += f"G{k + 1:02d}{code:14.3f}  {doppler * shift:14.3f}  {45.0:14.3f}\n"
        return text

    def navigation(self, toe: float = TOE, of=range(32), health: float = 0.0, weeks: int = 0, sent: float = 0.0) -> str:
        """The orbits, version 3, of ``toe`` and sent at ``sent`` s after START, ``weeks`` later."""
        text = (
            line("     3.04           N: GNSS NAV DATA    G: GPS", "RINEX VERSION / TYPE")
            + line("GPSA   4.6566e-09  1.4901e-08 -5.9605e-08 -1.1921e-07", "IONOSPHERIC CORR")
            + line("GPSB   8.1920e+04  9.8304e+04 -6.5536e+04 -5.2429e+05", "IONOSPHERIC CORR")
            + line("", "END OF HEADER")
        )
        at = START + timedelta(seconds=toe, weeks=weeks)
        later = toe - TOE
        for k in of:
            anomaly = self.anomaly[k] + np.sqrt(GRAVITATION) / SQRT_A**3 * later
            anomaly = np.mod(anomaly + np.pi, 2.0 * np.pi) - np.pi
            numbers = [
                (1.0, 0.0, 0.0, anomaly),
                (0.0, 0.0, 0.0, SQRT_A),
                (SECOND + toe, 0.0, self.node[k], 0.0),
                (0.96, 0.0, 0.0, 0.0),
                (0.0, 0.0, WEEK + weeks, 0.0),
                (2.0, health, self.delay[k], 1.0),
                (SECOND + sent, 4.0, 0.0, 0.0),
            ]
            first = self.bias[k] + self.rate[k] * later, self.rate[k], 0.0
            text += f"G{k + 1:02d} {at:%Y %m %d %H %M %S}" + "".join(f"{x:19.12e}" for x in first) + "\n"
            text += "".join("    " + "".join(f"{x:19.12e}" for x in row) + "\n" for row in numbers)
        return text
