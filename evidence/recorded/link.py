"""Which satellites a receiver follows on a flight past a jammer, by the link budget alone.

Friis's free space both ways, an antenna pattern over elevation above the wings, 1 / (C/N0) of both is 1 / (C/N0) and
J / (S R_c): a satellite is followed until C/N0 is below LEAST, and again when it has been above ENOUGH for NEEDED. Of
the project's models only the orbits of the 24 slots are used, which are held against others elsewhere, and the antenna.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pymap3d
from scipy.spatial.transform import Rotation

from models.satellite import antenna, orbit, slots
from models.satellite.ephemeris import Ephemeris

WAVELENGTH, CHIP_RATE = 0.190293673, 1.023e6
"""Of L1, m, and of the C/A code, 1/s."""
NOISE = 10.0**-20.15
"""W/Hz."""
GUARANTEED, FARTHEST = -158.5 - 3.0 + 2.0, 25.24e6
"""Power of a satellite at an isotropic antenna at its farthest, dBW: least of IS-GPS-200 and 2 dB; m."""
LEAST, ENOUGH, NEEDED = 25.0, 33.0, 20
"""dB-Hz at which signals are lost and found, and for how many seconds they must be strong to be found."""
NOMINAL = 42.5
TRACKED, USED = np.radians(5.0), np.radians(10.0)
"""Least elevations of receiver and solver."""


@dataclass(frozen=True)
class Jammer:
    """On the ground: latitude, longitude (rad), height above the ellipsoid (m), and power (W)."""

    latitude: float
    longitude: float
    altitude: float
    power: float


@dataclass(frozen=True)
class Link:
    """Of each second, (seconds, 24) by satellite but for the ``distance`` of the jammer, m."""

    distance: np.ndarray
    elevation: np.ndarray
    strength: np.ndarray
    """C/N0, dB-Hz."""
    tracked: np.ndarray
    dilution: np.ndarray
    """Of the position, of those that are used, (seconds,); infinite with fewer than four."""

    @classmethod
    def of(cls, truth: dict[str, np.ndarray], week: int, second: float, jammer: Jammer) -> Link:
        """With ``truth`` at each second of a flight that begins at a GPS time: places and angles, rad and m."""
        place = truth["latitude"], truth["longitude"], truth["altitude"]
        angles = np.stack([truth["heading"], truth["pitch"], truth["roll"]], axis=1)
        to_body = Rotation.from_euler("ZYX", angles).inv()
        far, towards = _line(*place, jammer.latitude, jammer.longitude, jammer.altitude)
        reach = sum(np.sqrt(2.0 * 4.0 / 3.0 * 6371e3 * np.maximum(h, 0.0)) for h in (place[2], jammer.altitude))
        received = jammer.power * (WAVELENGTH / (4.0 * np.pi * far)) ** 2 * 10.0 ** (_gain(to_body, towards) / 10.0)
        noise = NOISE + np.where(far <= reach, received, 0.0) / CHIP_RATE

        one = NOMINAL + 10.0 * np.log10(NOISE / noise)[:, None]
        positions = _followed(one, np.ones(one.shape, bool))[:, 0]

        satellites = Ephemeris.of(slots.constellation())
        where = np.array([orbit.state(satellites, week, second + k)[0] for k in range(len(far))])
        strength, elevation = np.zeros((2, len(far), len(satellites.prn)))
        units = np.zeros((len(far), len(satellites.prn), 3))
        for i in range(len(satellites.prn)):
            line = np.stack(pymap3d.ecef2enu(*where[:, i].T, *place, deg=False), axis=1)[:, [1, 0, 2]] * [1, 1, -1]
            distance = np.linalg.norm(line, axis=1)
            units[:, i] = line / distance[:, None]
            elevation[:, i] = np.arcsin(-units[:, i, 2])
            power = GUARANTEED - 20.0 * np.log10(distance / FARTHEST) + _gain(to_body, units[:, i])
            strength[:, i] = power - 10.0 * np.log10(noise)
        tracked = _followed(strength, elevation >= TRACKED)
        return cls(far, elevation, strength, tracked, _dilution(units, tracked & (elevation >= USED)), positions)

    positions: np.ndarray
    """Whether a signal of NOMINAL strength is followed, which stands for all where GPS is modelled as positions."""

    @property
    def fix(self) -> np.ndarray:
        """Whether a position can be solved."""
        return self.dilution <= 20.0


def _line(latitude, longitude, altitude, *of):
    """Distance, and unit vector in n, of a place from others."""
    north, east, down = pymap3d.geodetic2ned(*of, latitude, longitude, altitude, deg=False)
    line = np.stack([north, east, down], axis=1)
    distance = np.linalg.norm(line, axis=1)
    return distance, line / distance[:, None]


def _gain(to_body: Rotation, units_n: np.ndarray) -> np.ndarray:
    """dBi in these directions."""
    above = np.arcsin(np.clip(-to_body.apply(units_n)[:, 2], -1.0, 1.0))
    return np.interp(above, antenna.ELEVATIONS, antenna.PATCH[0])


def _followed(strength: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Loss and finding, second by second; at the beginning what is strong is followed."""
    tracked = np.zeros(strength.shape, bool)
    strong = up & (strength >= ENOUGH)
    now, run = strong[0], np.where(strong[0], NEEDED, 0)
    for k in range(len(strength)):
        run = np.where(strong[k], run + 1, 0)
        now = np.where(now, up[k] & (strength[k] >= LEAST), run >= NEEDED)
        tracked[k] = now
    return tracked


def _dilution(units: np.ndarray, used: np.ndarray) -> np.ndarray:
    found = np.full(len(units), np.inf)
    for k in np.flatnonzero(used.sum(axis=1) >= 4):
        h = np.column_stack([units[k][used[k]], np.ones(used[k].sum())])
        found[k] = np.sqrt(np.trace(np.linalg.pinv(h.T @ h)[:3, :3]))
    return found
