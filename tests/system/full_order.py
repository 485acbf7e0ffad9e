"""An independent full-order filter on the same measurements: what can be known, and how well.

It is written from the thesis's error models, not from the navigator: heading is an angle and gusts are states, matrices
are whole, the update is Joseph's, noise is sampled once a second. It is given the truth to linearise about, so it is
the bound of what an extended filter can reach. Many flights go through it at once, along the first axis.
"""

from __future__ import annotations

import numpy as np
import pymap3d

SIGNALS = [
    "aircraft.latitude",
    "aircraft.longitude",
    "aircraft.altitude",
    "ahrs.attitude.heading",
    "ahrs.attitude.heading_sigma",
    "air_data.air.true_airspeed",
    "air_data.air.true_airspeed_sigma",
    "gps.fix.latitude",
    "gps.fix.longitude",
    "gps.fix.velocity_n[1]",
    "gps.fix.velocity_n[2]",
    "gps.fix.valid",
    "dme.ranging.slant_range",
    "dme.ranging.measured",
    "dme.ranging.sequence",
]
WIND, MEAN, AIRSPEED_TIME = (5.0, 400.0), 8.0, 400.0
HEADING_TIME = 120.0
GUST, GUST_LENGTH = 1.5, 533.4
BIAS, BIAS_LENGTH, RANGE_NOISE = 314.84, 926.0, 7.408
FIX, FIX_VELOCITY = 2.0, 0.1


def run(flights, latitudes, longitudes, altitudes):
    """Errors (flight, second, axis) and covariances (flight, second, 2, 2) of position on flights recorded every second
    (a mapping of SIGNALS to arrays of the shape (flight, second); arrays of stations have a last axis). The stations'
    coordinates are in rad and m."""
    n, stations = len(flights["aircraft.latitude"]), len(latitudes)
    heading = np.unwrap(flights["ahrs.attitude.heading"], axis=1)
    speed = flights["air_data.air.true_airspeed"]
    air = speed[..., None] * np.stack([np.cos(heading), np.sin(heading)], -1)
    way = np.cumsum(0.5 * (air[:, 1:] + air[:, :-1]), axis=1)
    way = np.concatenate([np.zeros((n, 1, 2)), way], 1)  # by instruments
    truth = _metres(flights, "aircraft", flights)
    fix = _metres(flights, "gps.fix", flights)
    ground = np.linalg.norm(np.gradient(truth, axis=1), axis=-1)
    # states: truth minus what the instruments say; p n e, wind n e, heading, airspeed, gust n e, mean wind n e, biases
    first = truth[:, :1] - way[:, :1]
    order = 10 + stations
    x, p = np.zeros((n, order)), np.zeros((n, order, order))
    p[:, range(order), range(order)] = (
        [FIX**2] * 2 + [WIND[0] ** 2] * 2 + [0, 0] + [GUST**2] * 2 + [MEAN**2] * 2 + [BIAS**2] * stations
    )
    instruments = ("ahrs.attitude.heading_sigma", "air_data.air.true_airspeed_sigma")
    for state, name in enumerate(instruments, 4):
        p[:, state, state] = flights[name][:, 1] ** 2
    errors, covariances = np.zeros((*truth.shape[:2], 2)), np.zeros((*truth.shape[:2], 2, 2))
    sigma = p[:, range(2, order), range(2, order)] ** 0.5
    for k in range(1, truth.shape[1]):
        now = sigma.copy()
        now[:, 2:4] = np.stack([flights[name][:, k] for name in instruments], -1)
        times = np.empty((n, order - 2))
        times[:, :4] = WIND[1], WIND[1], HEADING_TIME, AIRSPEED_TIME
        times[:, 4:6] = (GUST_LENGTH / np.maximum(speed[:, k], 1.0))[:, None]
        times[:, 6:8] = 1e12
        times[:, 8:] = (BIAS_LENGTH / ground[:, k])[:, None]
        decay = np.exp(-1.0 / times) * np.minimum(1.0, now / np.maximum(sigma, 1e-12))
        nose = 0.5 * (heading[:, k] + heading[:, k - 1])
        b = _by_velocity(nose, speed[:, k], order)
        phi = np.zeros((n, order, order))
        phi[:, [0, 1], [0, 1]] = 1.0
        phi[:, range(2, order), range(2, order)] = decay
        phi[:, :2] += b
        x = (phi @ x[..., None])[..., 0]
        p = phi @ p @ np.swapaxes(phi, 1, 2)
        p[:, range(2, order), range(2, order)] += now**2 - (decay * sigma) ** 2
        sigma = now
        here = truth[:, k] - way[:, k] - first[:, 0]  # what x[:2] should be
        if np.all(flights["gps.fix.valid"][:, k]):
            velocity = np.stack([flights[f"gps.fix.velocity_n[{i}]"][:, k] for i in (1, 2)], -1) - air[:, k]
            h = np.zeros((n, 4, order))
            h[:, [0, 1], [0, 1]] = 1.0
            h[:, 2:] = _by_velocity(heading[:, k], speed[:, k], order)
            z = np.concatenate([fix[:, k] - way[:, k] - first[:, 0], velocity], -1)
            x, p = _update(x, p, z, h, np.diag([FIX**2] * 2 + [FIX_VELOCITY**2] * 2))
        elif np.any(flights["dme.ranging.sequence"][:, k] != flights["dme.ranging.sequence"][:, k - 1]):
            e, north, u = pymap3d.geodetic2enu(
                *(flights[f"aircraft.{name}"][:, k, None] for name in ("latitude", "longitude", "altitude")),
                latitudes, longitudes, altitudes, deg=False,
            )  # fmt: skip
            length = np.sqrt(e * e + north * north + u * u)
            h = np.zeros((n, stations, order))
            h[:, :, 0], h[:, :, 1], h[:, :, 10:] = north / length, e / length, np.eye(stations)
            z = flights["dme.ranging.slant_range"][:, k, :stations] - length + (h[..., :2] @ here[..., None])[..., 0]
            measured = flights["dme.ranging.measured"][:, k, :stations] > 0.5
            h = h * measured[..., None]
            x, p = _update(x, p, np.where(measured, z, 0.0), h, np.eye(stations) * RANGE_NOISE**2)
        errors[:, k], covariances[:, k] = x[:, :2] - here, p[:, :2, :2]
    return errors, covariances


def _metres(flights, of, about):
    """North and east from where the truth starts, on a plane that is the same for all signals of a flight."""
    latitude, longitude = about["aircraft.latitude"][:, :1], about["aircraft.longitude"][:, :1]
    mid = np.mean(about["aircraft.latitude"], axis=1, keepdims=True)
    meridian, transverse = pymap3d.rcurve.meridian(mid, deg=False), pymap3d.rcurve.transverse(mid, deg=False)
    height = np.mean(about["aircraft.altitude"], axis=1, keepdims=True)
    return np.stack(
        [
            (flights[f"{of}.latitude"] - latitude) * (meridian + height),
            (flights[f"{of}.longitude"] - longitude) * (transverse + height) * np.cos(mid),
        ],
        -1,
    )


def _by_velocity(heading, speed, order):
    """Derivatives of north and east velocity by the states."""
    b = np.zeros((len(heading), 2, order))
    b[:, [0, 1], [2, 3]] = b[:, [0, 1], [6, 7]] = b[:, [0, 1], [8, 9]] = 1.0
    b[:, 0, 4], b[:, 1, 4] = -speed * np.sin(heading), speed * np.cos(heading)
    b[:, 0, 5], b[:, 1, 5] = np.cos(heading), np.sin(heading)
    return b


def _update(x, p, z, h, r):
    turned = np.swapaxes(h, 1, 2)
    gain = p @ turned @ np.linalg.inv(h @ p @ turned + r)
    x = x + (gain @ (z - (h @ x[..., None])[..., 0])[..., None])[..., 0]
    left = np.eye(x.shape[-1]) - gain @ h
    return x, left @ p @ np.swapaxes(left, 1, 2) + gain @ r @ np.swapaxes(gain, 1, 2)
