"""DME-aided dead reckoning: navigation equations and the matrices of the reduced-order filter.

Thesis section 5.3 (dead reckoning), 6.4 (filter), 6.5 (reduced order: (6.54)). The filter's states are the errors

    [dp_n, dp_e, dV_NS, dV_EW]:  north and east position (m), north and east wind (m/s),

carried in the covariance; the estimates themselves are latitude, longitude and the wind. Heading and airspeed errors
are not states. What they do is put into the process noise (:func:`noise`), and as far as they persist they are
estimated as wind, because no measurement here can tell them apart on one heading.
"""

from __future__ import annotations

import numpy as np

from models import earth, kalman


def air_velocity(true_airspeed, heading):
    """North and east velocity relative to the air, m/s, thesis (5.5), (5.6). The flight path is taken as level: at 3
    degrees of climb the horizontal part is 0.14 % less."""
    return np.array([true_airspeed * np.cos(heading), true_airspeed * np.sin(heading)])


def advance(latitude, longitude, altitude, velocity, time):
    """Latitude and longitude after ``time`` s at the north and east ``velocity`` m/s, thesis (6.22), (6.23).

    (The thesis writes R - h because its h is positive down.)
    """
    north_south, east_west = earth.radii(latitude)
    return (
        latitude + velocity[0] * time / (north_south + altitude),
        longitude + velocity[1] * time / ((east_west + altitude) * np.cos(latitude)),
    )


def offset(latitude, longitude, altitude, other_latitude, other_longitude):
    """Metres north and east from a point to another one nearby, thesis (5.26), (5.27)."""
    north_south, east_west = earth.radii(latitude)
    return np.array(
        [
            (other_latitude - latitude) * (north_south + altitude),
            (other_longitude - longitude) * (east_west + altitude) * np.cos(latitude),
        ]
    )


def transition(time, wind_decay):
    """Phi over ``time`` s: positions integrate the wind error, which decays by ``wind_decay``; (6.26), rows of
    (6.54)."""
    return np.array(
        [
            [1.0, 0.0, time, 0.0],
            [0.0, 1.0, 0.0, time],
            [0.0, 0.0, wind_decay, 0.0],
            [0.0, 0.0, 0.0, wind_decay],
        ]
    )


def wind_noise(airspeed, wind, heading, airspeed_error):
    """Power spectral density that drives the wind states, (m/s)^2/s.

    Each argument after ``airspeed`` (m/s) is a pair (sigma, tau) of a Gauss-Markov process: wind (m/s), heading (rad)
    and airspeed (m/s). 2 sigma^2 / tau of the wind, thesis (3.36), (5.30), plus that of the deleted states of (5.13),
    turned into velocity by V: they are lumped into the wind, on both axes because the heading takes every direction.
    """
    lumped = airspeed * airspeed * heading[0] * heading[0] / heading[1] + airspeed_error[0] ** 2 / airspeed_error[1]
    return 2.0 * (wind[0] * wind[0] / wind[1] + lumped)


def blind_noise(airspeed, time):
    """What drives the wind states in addition while heading or airspeed are unknown, (m/s)^2/s: an error of velocity as
    large as the airspeed (m/s) that lives for ``time`` (s).
    """
    return 2.0 * airspeed * airspeed / time


def lumped_variance(air_velocity, heading_sigma, airspeed_sigma):
    """Variance of the velocity error that heading and airspeed make on one axis, (m/s)^2: (5.16), (5.17), both on any
    axis."""
    return np.sum(air_velocity * air_velocity) * heading_sigma * heading_sigma + airspeed_sigma * airspeed_sigma


def noise(time, wind_density, position_density):
    """C_d over ``time`` s, packed: the integrals of white noise on the wind states and on the position states.

    ``position_density`` (m^2/s) stands for what the lumping of :func:`wind_noise` misses: in a turn the deleted errors
    turn with the aircraft, faster than a wind does.
    """
    along = wind_density * time * time * time / 3.0 + position_density * time
    across = wind_density * time * time / 2.0
    wind = wind_density * time
    zero = 0.0 * time
    return np.array([along, zero, across, zero, along, zero, across, wind, zero, wind])


def position_updates(correction, upper, residual, variance, use):
    """Take the north and east residuals (m) of a position fix: two scalar updates."""
    for axis, row in enumerate(np.eye(4)[:2]):
        correction, upper, _ = kalman.update(correction, upper, row, variance, residual[axis], use)
    return correction, upper


def wind_updates(correction, upper, residual, variance, use):
    """Take the north and east residuals (m/s) of the wind: GPS velocity minus air velocity minus the wind state."""
    for axis, row in enumerate(np.eye(4)[2:]):
        correction, upper, _ = kalman.update(correction, upper, row, variance, residual[axis], use)
    return correction, upper


def range_updates(correction, upper, north, east, residual, variance, measured, gate):
    """Take the residuals (m) of the slant ranges, one scalar update after the other, (6.39)-(6.42).

    ``north``, ``east``: direction cosines of the lines of sight, the rows of H; (6.36) has them for projected ranges.
    Returns correction, upper and how many ranges were rejected by the gate.
    """
    rejected = 0.0
    for station in range(len(residual)):
        row = np.array([north[station], east[station], 0.0, 0.0])
        correction, upper, taken = kalman.update(
            correction, upper, row, variance[station], residual[station], measured[station], gate
        )
        rejected = rejected + np.where(np.logical_and(measured[station], np.logical_not(taken)), 1.0, 0.0)
    return correction, upper, rejected


def direction_cosines(latitude, longitude, sight):
    """North and east components of the unit vectors along ``sight`` (vectors in e, m, shape (3, stations)), and
    lengths."""
    length = np.sqrt(np.sum(sight * sight, axis=0))
    unit = sight / np.maximum(length, 1.0)
    sin_lat, cos_lat, sin_lon, cos_lon = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    north = -sin_lat * cos_lon * unit[0] - sin_lat * sin_lon * unit[1] + cos_lat * unit[2]
    east = -sin_lon * unit[0] + cos_lon * unit[1]
    return north, east, length
