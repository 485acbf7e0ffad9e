"""DME-aided dead reckoning: navigation equations, the filter's error model, and when its state is not to be believed.

Thesis section 5.3 (dead reckoning) and 6.4 (filter). The filter's states are the perturbations of (6.24) without
altitude, with the mean of the wind, and one range bias for each station:

    [dp_n, dp_e, dV_NS, dV_EW, dM_NS, dM_EW, dV, V dpsi, dR_1 .. dR_m]

position (m) north and east; the wind's deviation from its mean over the flight, and that mean, which is constant (m/s);
what is to be added to the measured air velocity along and across the nose
(m/s): airspeed, and heading times airspeed; range biases (m). The truth is the estimate plus the perturbation. All but
position and the mean are first-order Gauss-Markov.

Across the nose a velocity stands in place of the angle of (6.26), so that the equations are linear at every error of
heading, however large.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude
from models.earth import earth
from models.filters import kalman

VELOCITIES = 6
"""Wind, its mean, and air velocity errors, which position integrates; they follow position in the state vector."""


def air_velocity(true_airspeed, heading):
    """North and east velocity relative to the air, m/s, thesis (5.5), (5.6). The flight path is taken as level: at 3
    degrees of climb the horizontal part is 0.14 % less."""
    return np.array([true_airspeed * np.cos(heading), true_airspeed * np.sin(heading)])


def velocity_rows(heading):
    """Derivatives of north and east velocity by the wind's deviation and its mean (north, east) and by air velocity
    error (along, across the nose), shape (2, 6); rows 1 and 2, columns 4 to 7 of F (6.26), those of wind twice, the one
    of heading divided by V."""
    sine, cosine = np.sin(heading), np.cos(heading)
    return np.array([[1.0, 0.0, 1.0, 0.0, cosine, -sine], [0.0, 1.0, 0.0, 1.0, sine, cosine]])


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
            attitude.wrap(other_longitude - longitude) * (east_west + altitude) * np.cos(latitude),
        ]
    )


def follow(before, now, decay, scale=1.0):
    """How Gauss-Markov errors go on whose standard deviations change from ``before`` to ``now`` while they decay by
    ``decay``.

    A smaller sigma scales the errors; a larger one adds noise that is independent of them. Either way an error that
    nothing measures has the sigma that is claimed for it at every step; with a constant sigma it is (3.4), (3.5).

    ``scale`` is what the errors themselves are multiplied by: that of heading, as a velocity, goes with the airspeed.
    It is the same error at another speed; if each gust that comes added noise and each that goes took of the error, it
    would be forgotten the sooner, the more often it is looked at.

    Returns
    -------
    Factor of the errors (the diagonal of Phi), and variance of what is added (the diagonal of C_d).
    """
    factor = scale * decay * np.minimum(1.0, now / np.maximum(scale * before, 1.0e-9))
    return factor, now * now - factor * factor * before * before


def propagate(upper, step, rows, factor, added, walk):
    """P[k+1] = Phi P Phi' + C_d, (6.31), over ``step`` s, packed.

    Parameters
    ----------
    upper
        Packed covariance of n states; leading axes are free, here and in all that follows.
    rows
        Derivatives of velocity, shape (2, 6), of :func:`velocity_rows`.
    factor, added
        Of the other n - 2 states, from :func:`follow`.
    walk
        Variance of the random walk of position on each axis, m^2.
    """
    itself = np.broadcast_to(np.eye(2), (*np.shape(rows)[:-2], 2, 2))
    noise = np.concatenate([np.ones((*np.shape(added)[:-1], 2)) * walk, added], -1)
    return kalman.propagate(upper, np.concatenate([itself, step * rows], -1), factor, noise)


def fix_updates(correction, upper, position, velocity, rows, variances, use):
    """Take the north and east residuals of a GPS fix: position (m), then velocity (m/s).

    Parameters
    ----------
    position, velocity
        Measured minus predicted, north and east.
    rows
        Derivatives of velocity, of :func:`velocity_rows`.
    variances
        Of position and of velocity, on each axis.
    use
        Whether there is a position, and whether there is a velocity.
    """
    row = _rows_of(upper)
    for axis, unit in enumerate(np.eye(2)):
        at = row(unit, np.zeros(VELOCITIES))
        correction, upper, _ = kalman.update(correction, upper, at, variances[0], position[..., axis], use[0])
    for axis in range(2):
        at = row(np.zeros(2), rows[..., axis, :])
        correction, upper, _ = kalman.update(correction, upper, at, variances[1], velocity[..., axis], use[1])
    return correction, upper


def _rows_of(upper):
    """Makes rows of H from their parts for position, velocities and range biases (none if left out)."""
    leading, biases = np.shape(upper)[:-1], kalman.order(upper) - 2 - VELOCITIES

    def row(position, velocities, own=None):
        parts = (position, velocities, np.zeros(biases) if own is None else own)
        return np.concatenate([np.broadcast_to(part, (*leading, np.shape(part)[-1])) for part in parts], -1)

    return row


def curvature(upper, north, east, distance):
    """Variance that the curvature of ranges to stations at ``distance`` m adds to them, m^2.

    The second derivative of a range is 1 / distance across the line of sight. Where the position is uncertain by
    kilometres the linear rows of H would claim more than is known; half the square of (variance across / distance) is
    the variance of the second-order term of a normal error (Gelb, Applied Optimal Estimation, 1974, section 6.1). It is
    no noise: it stays while the position stays wrong.
    """
    return 0.5 * (variance_along(upper, -east, north) / np.maximum(distance, 1.0)) ** 2


def variance_along(upper, north, east):
    """Variance of position along horizontal directions with these cosines, m^2."""
    covariance = kalman.unpack(upper)
    nn, ne, ee = (covariance[..., i, j, None] for i, j in ((0, 0), (0, 1), (1, 1)))
    return north * north * nn + 2.0 * north * east * ne + east * east * ee


def range_updates(correction, upper, north, east, residual, variance, measured, gate):
    """Take the residuals (m) of the slant ranges, one scalar update after the other, (6.39)-(6.42).

    ``north``, ``east``: direction cosines of the lines of sight, which are the rows of H; (6.36) has them for projected
    ranges. Each range has its own bias. Returns correction, upper, which ranges were taken (not those that the gate
    refuses), and of each range the innovation (m) and its variance (m^2).
    """
    row = _rows_of(upper)
    rows = [
        row(np.stack([north[..., station], east[..., station]], -1), np.zeros(VELOCITIES), own)
        for station, own in enumerate(np.eye(np.shape(residual)[-1]))
    ]
    return kalman.updates(correction, upper, np.stack(rows, -2), variance, residual, measured, gate)


def evidence(innovations, spreads, lasting, gate):
    """How much each range speaks for the second of two filters: logarithm of the ratio of its likelihoods.

    The sum over ranges is the logarithm of the odds (Magill, Optimal adaptive estimation, IEEE Trans. Automatic Control
    AC-10, 1965, p. 434). A range beyond the first one's gate is as likely for either as it is at that gate: it may be
    wild, and nothing is learned from what both refuse.

    Parameters
    ----------
    innovations, spreads
        Of each range by each filter, m and m^2, shape (2, ranges).
    lasting
        What of that variance is there only because the same error comes again with the next range, m^2. What is left
        of it is how independent the range is, and how much it counts.
    """
    independent = np.min(1.0 - lasting / spreads, axis=0)
    spreads = spreads - lasting
    squares = innovations * innovations / spreads
    logarithms = -0.5 * (squares + np.log(spreads))
    wild = -0.5 * (gate * gate + np.log(spreads[0]))
    bounded = np.where(gate > 0.0, np.maximum(logarithms, wild), logarithms)
    return independent * (bounded[1] - bounded[0])


def lasting(curvature, unused, time_constant):
    """Variance that makes a range ``unused`` s after the last one which was used as much news of the ``curvature`` (m2)
    as its correlation ``time_constant`` (s) allows."""
    return curvature / news(unused, time_constant) - curvature


def improbable(estimates, sigmas, limit):
    """Whether any of the estimates of Gauss-Markov states is beyond ``limit`` of the sigmas that its model allows it:
    the estimate of a state scatters less than the state itself, so a filter whose model is right never has one."""
    return np.any(np.abs(estimates) > limit * np.maximum(sigmas, 1.0e-9), axis=-1)


def news(since, time_constant):
    """How much of a measurement made ``since`` s after the last one is news, where its error has the correlation
    ``time_constant`` s: 1 - exp(-since / tau). Its variance over this is that of as many independent ones."""
    return 1.0 - np.exp(-since / time_constant)


def outvoted(against, believed, dilution, limit):
    """Whether the stations that contradict the state are contradicted in turn: there are more of those that it agrees
    with, and these fix the position by themselves, with a dilution of precision of at most ``limit``."""
    return (np.sum(np.where(believed, 1.0, 0.0)) > np.sum(np.where(against, 1.0, 0.0))) & (dilution <= limit)


def anew(upper, variance):
    """Position with ``variance`` (m^2) on each axis and independent of the other states, which stay as they are."""
    others = np.concatenate([np.zeros(2), np.ones(kalman.order(upper) - 2)])
    return upper * kalman.pack(np.outer(others, others)) + kalman.of_variances(1.0 - others) * variance


def widen(upper, variance):
    """Add ``variance`` (m^2) to north and to east position."""
    states = kalman.order(upper)
    both = kalman.of_variances(np.concatenate([np.ones(2), np.zeros(states - 2)]))
    return upper + np.asanyarray(variance)[..., None] * both


def direction_cosines(latitude, longitude, sight):
    """North and east components of the unit vectors along ``sight`` (vectors in e, m, shape (3, stations)), and
    lengths."""
    length = np.sqrt(np.sum(sight * sight, axis=0))
    unit = sight / np.maximum(length, 1.0)
    sin_lat, cos_lat, sin_lon, cos_lon = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    north = -sin_lat * cos_lon * unit[0] - sin_lat * sin_lon * unit[1] + cos_lat * unit[2]
    east = -sin_lon * unit[0] + cos_lon * unit[1]
    return north, east, length


def vertical_cosine(latitude, longitude, sight):
    """Upward components of the unit vectors of :func:`direction_cosines`."""
    unit = sight / np.maximum(np.sqrt(np.sum(sight * sight, axis=0)), 1.0)
    level = np.cos(longitude) * unit[0] + np.sin(longitude) * unit[1]
    return np.cos(latitude) * level + np.sin(latitude) * unit[2]
