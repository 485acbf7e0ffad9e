"""Distance measuring equipment: slant range, coverage and errors.

Thesis section 2.5.5 (how DME works), 3.9 (errors, (3.38)), 6.4.3 (range equations). Stations are arrays over their
number; latitude and longitude in rad, altitude above the ellipsoid in m.
"""

from __future__ import annotations

import numpy as np

from models.earth import earth
from navfmu.constants import NAUTICAL_MILE, RADIO_EARTH_RADIUS

BIAS_SIGMA = 0.17 * NAUTICAL_MILE
"""Standard deviation of the time-varying bias, m, thesis (3.38), p. 72."""
CORRELATION_DISTANCE = 0.5 * NAUTICAL_MILE
"""Distance over which the bias is correlated, m; tau_r = 0.5 nmi / V (Table 6.1 misprints 5 miles)."""
NOISE_SIGMA = 0.004 * NAUTICAL_MILE
"""Standard deviation of the wide-band noise, m, thesis Fig 3.13 and (3.38)."""
LOCK_IN = 4.0
"""Time of tracking before a receiver has locked in, s, thesis Fig 2.10."""
RANGING = 1.0
"""Time of ranging after lock-in, s, thesis Fig 2.10."""


def line_of_sight(latitude, longitude, altitude, station_latitude, station_longitude, station_altitude):
    """Vectors from each station to the aircraft in e, m, shape (3, stations)."""
    aircraft = earth.to_ecef(latitude, longitude, altitude)
    return aircraft[:, None] - earth.to_ecef(station_latitude, station_longitude, station_altitude)


def slant_range(latitude, longitude, altitude, station_latitude, station_longitude, station_altitude):
    """Straight distance from the aircraft to each station, m.

    The thesis (6.32) works with ranges projected on a local level plane; the straight line between two points of the
    ellipsoid needs no plane and is right at every distance.
    """
    sight = line_of_sight(latitude, longitude, altitude, station_latitude, station_longitude, station_altitude)
    return np.sqrt(np.sum(sight * sight, axis=0))


def horizon(altitude, station_altitude, antenna_height):
    """Distance in m at which the aircraft sinks below the radio horizon of a station on a smooth earth of 4/3 radius.

    Heights below the ellipsoid count as 0, terrain is not modelled.
    """
    return horizon_from(altitude) + horizon_from(np.maximum(station_altitude, 0.0) + antenna_height)


def horizon_from(height):
    """Distance in m of the radio horizon that is seen from a ``height`` in m over a smooth earth of 4/3 radius."""
    return np.sqrt(2.0 * RADIO_EARTH_RADIUS * np.maximum(height, 0.0))


def correlation_time(velocity_n, lowest_speed, distance=CORRELATION_DISTANCE):
    """tau_r = 0.5 nmi / V in s, thesis (3.38); V is the ground speed, at least ``lowest_speed`` (m/s)."""
    speed = np.sqrt(velocity_n[0] * velocity_n[0] + velocity_n[1] * velocity_n[1])
    return distance / np.maximum(speed, lowest_speed)


def shared(station, receiver, share):
    """Bias of each station, of which the ``share`` of the variance is the receiver's and common to all of them.

    Thesis p. 72: a station checks itself, so the oscillator of the receiver is the likelier cause.
    """
    return np.sqrt(1.0 - share) * station + np.sqrt(share) * receiver


def measure(true_range, bias, noise_sigma, normal):
    """Range shown by the receiver: R + dR_b + dR_w, thesis (3.38). (The thesis defines the error as R minus the
    reading; both errors are symmetric.) The constant part dR_0 is calibrated to 0 there."""
    return true_range + bias + noise_sigma * normal


def dilution(north, east, used):
    """Horizontal dilution of precision, sqrt(trace (H' H)^-1) (thesis section 7.1), 99 where two lines do not cross.

    ``north``, ``east`` are the direction cosines of the lines of sight (rows of H), ``used`` which of them count.
    """
    weight = np.where(used, 1.0, 0.0)
    nn = np.sum(weight * north * north)
    ee = np.sum(weight * east * east)
    ne = np.sum(weight * north * east)
    determinant = nn * ee - ne * ne
    crossing = determinant > 2.0e-4
    return np.where(crossing, np.minimum(np.sqrt((nn + ee) / np.where(crossing, determinant, 1.0)), 99.0), 99.0)
