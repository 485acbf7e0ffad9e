"""Pseudoranges and range rates of a made sky, by light time in an inertial frame: independent of the models.

Satellites run on circles that do not turn with the earth; a signal leaves where its satellite was when it left, and
arrives where the receiver is when it arrives, both in an inertial frame that is e at time 0. Rates are differences of
ranges. Positions are pymap3d's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pymap3d

from fmus.satellite.signals import PLACES

LIGHT, EARTH_RATE = 299792458.0, 7.2921151467e-5
RADIUS, MOTION = 26.56e6, 1.4585e-4


def turn(angle: float) -> np.ndarray:
    """From the inertial frame into e after the earth has turned."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def satellites(count: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors that span the plane of each orbit, over all directions, (count, 3) each."""
    rng = np.random.default_rng(seed)
    a, b = rng.standard_normal((2, count, 3))
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    b -= np.sum(a * b, axis=1, keepdims=True) * a
    return a, b / np.linalg.norm(b, axis=1, keepdims=True)


def orbit(plane: tuple[np.ndarray, np.ndarray], time: Any) -> np.ndarray:
    angle = np.asarray(MOTION * time)[..., None]
    return RADIUS * (np.cos(angle) * plane[0] + np.sin(angle) * plane[1])


@dataclass
class Place:
    """Latitude, longitude (rad), altitude (m), velocity in n (m/s) at time 0; it moves straight in e."""

    latitude: float = 0.66
    longitude: float = -2.1
    altitude: float = 1500.0
    velocity_n: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def position_e(self) -> np.ndarray:
        return np.array(pymap3d.geodetic2ecef(self.latitude, self.longitude, self.altitude, deg=False))

    @property
    def velocity_e(self) -> np.ndarray:
        north, east, down = self.velocity_n
        return np.array(pymap3d.enu2uvw(east, north, -down, self.latitude, self.longitude, deg=False))

    def inertial(self, time: float) -> np.ndarray:
        return turn(EARTH_RATE * time).T @ (self.position_e + self.velocity_e * time)


def travel(plane: tuple[np.ndarray, np.ndarray], place: Place, time: float) -> np.ndarray:
    """Light time to each satellite, s, by iteration."""
    at, found = place.inertial(time), np.full(len(plane[0]), 0.07)
    for _ in range(8):
        found = np.linalg.norm(orbit(plane, time - found) - at, axis=1) / LIGHT
    return found


def signals(
    place: Place,
    count: int,
    clock: float = 0.0,
    drift: float = 0.0,
    lowest: float = 12.0,
    seed: int = 3,
    **changes: Any,
) -> dict[str, Any]:
    """Return the inputs of a solver: ``count`` satellites above ``lowest`` degrees, no atmosphere.

    ``clock`` (s) and ``drift`` (s/s) are the receiver's.
    """
    plane = satellites(400, seed)
    sight = orbit(plane, 0.0) - place.position_e
    up = pymap3d.ecef2enuv(*sight.T, place.latitude, place.longitude, deg=False)[2]
    seen = np.flatnonzero(up / np.linalg.norm(sight, axis=1) > np.sin(np.radians(lowest)))[:count]
    plane = plane[0][seen], plane[1][seen]
    tau = travel(plane, place, 0.0)
    rate = LIGHT * (travel(plane, place, 0.5) - travel(plane, place, -0.5))
    leave = [turn(-EARTH_RATE * t) for t in tau]
    position = np.array([r @ x for r, x in zip(leave, orbit(plane, -tau), strict=True)])
    before, after = (
        np.array([turn(EARTH_RATE * (dt - t)) @ x for t, x in zip(tau, orbit(plane, dt - tau), strict=True)])
        for dt in (-0.5, 0.5)
    )
    rng = np.random.default_rng(1)
    satellite_clock, satellite_drift = 1e-4 * rng.standard_normal(count), 1e-11 * rng.standard_normal(count)
    made = {
        "pseudorange": LIGHT * (tau + clock - satellite_clock),
        "range_rate": rate + LIGHT * (drift - satellite_drift),
        "signal_to_noise": np.full(count, 45.0),
        "satellite_e": position,
        "satellite_velocity_e": after - before,
        "satellite_clock": satellite_clock,
        "satellite_clock_rate": satellite_drift,
        "number": np.arange(1, count + 1),
        "tracked": np.ones(count),
    } | changes
    found = {"signals.week": 2111, "signals.seconds": 345600.0, "signals.valid": True, "signals.time_of_validity": 0.25}
    for name, values in made.items():
        whole = np.zeros((PLACES, *np.shape(values)[1:]))
        whole[:count] = values
        found[f"signals.{name}"] = whole
    return found
