"""Truth against estimate: position errors in metres and whether they are what the filter says."""

from __future__ import annotations

import numpy as np

from models.earth import earth
from navfmu.constants import NAUTICAL_MILE

HALF_NAUTICAL_MILE = 0.5 * NAUTICAL_MILE
"""Required accuracy of the backup navigator, m: 0.5 nmi after 30 minutes, thesis section 1.4 and 7.3."""


def position_error(latitude, longitude, altitude, estimated_latitude, estimated_longitude):
    """Estimate minus truth, north and east, m, thesis (5.26), (5.27) with the radii at the aircraft's altitude."""
    north_south, east_west = earth.radii(latitude)
    turn = 2.0 * np.pi
    east_angle = estimated_longitude - longitude
    east_angle = east_angle - turn * np.floor(east_angle / turn + 0.5)
    return (
        (estimated_latitude - latitude) * (north_south + altitude),
        east_angle * (east_west + altitude) * np.cos(latitude),
    )


def consistent(north_error, east_error, north_sigma, east_sigma, multiple=3.0):
    """Whether both errors lie within ``multiple`` standard deviations of the filter's own covariance."""
    return np.logical_and(np.abs(north_error) <= multiple * north_sigma, np.abs(east_error) <= multiple * east_sigma)


def normalised_square(north_error, east_error, north_sigma, east_sigma):
    """Sum of the squares of both errors over their variances; 0 where there is no variance yet."""
    known = np.logical_and(north_sigma > 0.0, east_sigma > 0.0)
    north = north_error / np.where(known, north_sigma, 1.0)
    east = east_error / np.where(known, east_sigma, 1.0)
    return np.where(known, north * north + east * east, 0.0)
