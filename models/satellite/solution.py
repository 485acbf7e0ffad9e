"""What a receiver makes of its measurements: corrected ranges, satellites chosen, a position, what is wrong with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from models.earth import earth
from models.satellite import dilution, klobuchar, least_squares, niell, raim, saastamoinen, sight, variance
from navfmu.repetition import repeat

SETTLING = 8
"""Steps of Gauss and Newton from a point below the satellites."""
COSECANT, NIELL = 1, 2
"""Mapping functions of the troposphere."""
LOWEST = float(np.radians(1.0))
"""Delays are those of this elevation for what is lower, rad."""
LOWEST_SINE = float(np.sin(LOWEST))


def ionosphere(geodetic, elevation, azimuth, seconds, alpha, beta):
    """Klobuchar's delay above a place that is known to some km, m; arguments as there."""
    latitude, longitude, _ = geodetic
    return klobuchar.delay(latitude, longitude, np.maximum(elevation, LOWEST), azimuth, seconds, alpha, beta)


def troposphere(geodetic, sine, day, mapping, humidity):
    """The troposphere's delay over that at the zenith; ``mapping`` is COSECANT, NIELL, or another number for none."""
    latitude, _, altitude = geodetic
    seen = np.maximum(sine, LOWEST_SINE)

    def by_niell(_):
        hydrostatic, wet = saastamoinen.zenith(latitude, altitude, humidity)
        of_hydrostatic, of_wet = niell.mapping(day, latitude, altitude, seen)
        return (of_hydrostatic * hydrostatic + of_wet * wet) / (hydrostatic + wet)

    otherwise = np.where(mapping == COSECANT, saastamoinen.slant(1.0, seen), 0.0)
    return repeat(by_niell, otherwise, np.where(mapping == NIELL, 1, 0), 1)


def directions(position_e, geodetic, satellite_e):
    """Unit vectors to satellites in n, rows of three."""
    latitude, longitude, _ = geodetic
    _, unit_e = sight.ranges(position_e, satellite_e)
    return unit_e @ earth.north_east_down(latitude, longitude).T


def approach(position_e, clock, measured, weight, count):
    """Position and clock after ``count`` steps, SETTLING at most."""

    def closer(value):
        return least_squares.step(*value, measured, weight)

    return repeat(closer, (position_e, clock), count, SETTLING)


def choose(h, weight, channels, held=False):
    """Weights of at most so many satellites: those are left out, one by one, without which the dilution grows least.

    ``weight`` is 1 or 0. The last row, the altitude, needs no channel; satellites that are ``held`` keep theirs.
    """

    def without_one(kept):
        growth = dilution.growth(least_squares.covariance(h, kept), h, kept)[:-1]
        # three and an altitude, or four, are kept however they lie: one more cannot be missed
        out = dilution.least(growth, (kept[:-1] > 0.0) & np.logical_not(held))
        return np.concatenate([np.where(out, 0.0, kept[:-1]), kept[-1:]])

    return repeat(without_one, weight, np.sum(weight[:-1]) - channels, weight.shape[0] - 1)


def freedom(weight):
    """Number of rows beyond the four that a solution needs."""
    return np.sum(np.where(weight > 0.0, 1.0, 0.0)) - 4.0


def of_freedom(values, weight):
    """Which of the values for 1, 2, ... degrees of freedom holds for these weights; 0 for none."""
    return np.sum(np.where(np.arange(1, values.shape[0] + 1) == freedom(weight), values, 0.0))


class Solution(NamedTuple):
    """A position with its geometry; rows as in :mod:`least_squares`."""

    h: np.ndarray
    p: np.ndarray
    residual: np.ndarray
    rotation: np.ndarray  #: C_ne
    unit_e: np.ndarray

    def squares(self, weight):
        return raim.squares(self.residual, weight)


def solution(position_e, clock, measured, weight):
    """Position and clock after a last step of Gauss and Newton, and their solution.

    Its geometry is that before the step, and residuals are what the step leaves: if it is 1 km they are 25 mm off, and
    it is some cm where another step was made before.
    """
    h, misfit, rotation, unit_e = least_squares.compare(position_e, clock, measured)
    p = least_squares.covariance(h, weight)
    by = least_squares.estimate(p, h, weight, misfit)
    return *least_squares.moved(position_e, clock, by, rotation), Solution(h, p, misfit - h @ by, rotation, unit_e)


def alarmed(found, weight, thresholds):
    """Whether the residuals are larger than noise makes them; ``thresholds`` of the sum of squares by freedom, from 1.

    With no degree of freedom they are always zero, and there is no alarm.
    """
    return np.logical_and(freedom(weight) > 0.5, found.squares(weight) > of_freedom(thresholds, weight))


def exclude(position_e, clock, found, measured, weight, thresholds, most):
    """Position, clock, solution and weights after rows were left out, one by one, until there is no alarm, or ``most``
    are. It begins at a position where all is ``found``.

    Left out is the row without which the sum of squares is least. With one degree of freedom it is the same for all,
    and none is left out.
    """

    def without_one(value):
        position_e, clock, weight, *found = value
        found = Solution(*found)
        tested = raim.standardised(found.residual, weight, raim.redundancy(found.p, found.h, weight))
        wrong = np.logical_and(alarmed(found, weight, thresholds), freedom(weight) > 1.5)
        weight = np.where(np.logical_and(wrong, dilution.least(-tested, weight > 0.0)), 0.0, weight)
        position_e, clock = least_squares.step(position_e, clock, measured, weight)
        position_e, clock, found = solution(position_e, clock, measured, weight)
        return position_e, clock, weight, *found

    position_e, clock, weight, *found = repeat(without_one, (position_e, clock, weight, *found), most, 4)
    return position_e, clock, Solution(*found), weight


def day_of_year(week, seconds):
    """Day of a year of 365.25 days, as mapping functions take it, from GPS week and seconds."""
    return np.mod(5.0 + 7.0 * week + seconds / 86400.0, 365.25) + 1.0


def weights(seen, sine, ionosphere, accuracy, corrected, correction_sigma, equal_sigma):
    """1 / variance of the satellites that are used, 0 of the others.

    With corrections the receiver's own part and what they leave, ``correction_sigma``; with ``equal_sigma`` above 0
    that for all.
    """
    low = np.maximum(sine, LOWEST_SINE)
    by_model = np.where(
        corrected,
        variance.code(low) + correction_sigma * correction_sigma,
        variance.pseudorange(low, accuracy, ionosphere),
    )
    equal = np.where(equal_sigma > 0.0, equal_sigma, 1.0) ** 2
    return np.where(seen, 1.0 / np.where(equal_sigma > 0.0, equal, by_model), 0.0)
