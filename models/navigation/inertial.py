"""Inertial navigation in n: mechanisation, and the error model of thesis section 5.4 and appendix A.

The states are (5.38): errors, true minus estimated, of

    [latitude, longitude, altitude | velocity_n | tilt in n | accelerometer biases in b | gyro biases in b]

in rad, rad, m (positive up, where the thesis has h positive down, hence its R - h), m/s, rad, m/s2, rad/s. The tilt is
the small rotation in n that is missing, C_nb = (1 + [tilt x]) C_nb estimated, and the biases are what is to be taken
from the samples: of specific force and rate themselves, which the thesis has in their place, they are the negative.

Misprints, found by differentiating :func:`rates`: the ones in P2P (5.41) are zeros; A2V (5.45) is -[f_n x]; in V2A
(5.47) and P2A (5.46) the radius belongs to the direction of the velocity, R_EW with V_E and R_NS with V_N; S2V (5.48)
is the transpose of (A.6), and its last element has q1^2 + q2^2; Gamma (5.56) turns the noise of biases into n, which is
that in b for equal axes. The change of the radii with latitude is left out, as in the thesis.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude, quaternion
from models.earth import earth

STATES = 15
DRIVEN = 9
"""Position, velocity and tilt; the biases are driven by themselves."""
POSITION, VELOCITY, TILT, FORCE, RATE = (slice(i, i + 3) for i in range(0, STATES, 3))
HALF = 0.5


def rates(position, velocity_n, force_n):
    """Derivatives of position (5.36), (A.14)-(A.16), and velocity (5.37), (A.1), and the rate of n, rad/s.

    Parameters
    ----------
    position
        Latitude, longitude (rad) and altitude (m).
    velocity_n
        m/s.
    force_n
        Specific force in n, m/s2.
    """
    latitude, altitude = position[0], position[2]
    north_south, east_west = earth.radii(latitude)
    by_velocity = np.stack(
        [
            velocity_n[0] / (north_south + altitude),
            velocity_n[1] / ((east_west + altitude) * np.cos(latitude)),
            -velocity_n[2],
        ]
    )
    turning, transport = earth.earth_rate(latitude), earth.transport_rate(latitude, altitude, velocity_n)
    down = np.array([0.0, 0.0, 1.0]) * earth.gravity(latitude, altitude)
    carried = np.cross(2.0 * turning + transport, velocity_n)
    return by_velocity, force_n - carried + down, turning + transport


def strapdown(position, velocity_n, turn, rate, force, step):
    """Position, velocity and quaternion of C_nb after ``step`` s.

    Rate and specific force (b) are means over the step. The attitude is turned exactly for a rate that is constant, the
    specific force by the attitude in the middle; gravity and Coriolis acceleration are those of the middle, too, to
    second order.
    """
    begun, _, turning = rates(position, velocity_n, np.zeros(3))
    half = HALF * step
    in_middle = quaternion.product(turn, quaternion.of_rotation(half * rate))
    force_n = quaternion.dcm(quaternion.product(quaternion.of_rotation(-half * turning), in_middle)) @ force
    _, gained, _ = rates(position, velocity_n, force_n)
    velocity_then = velocity_n + half * gained
    position_then = position + half * begun
    moved, gained, turning = rates(position_then, velocity_then, force_n)
    about_n = quaternion.of_rotation(-step * turning)
    after = quaternion.product(about_n, quaternion.product(turn, quaternion.of_rotation(step * rate)))
    return position + step * moved, velocity_n + step * gained, quaternion.unit(after)


def dynamics(position, velocity_n, force_n, C_nb):
    """The first nine rows of F (5.40), shape (9, 15); those of biases are -1 / tau, (5.52), (5.53)."""
    none = np.zeros((3, 3))
    p2p, v2p = _of_position(position, velocity_n)
    p2v, v2v = _of_velocity(position, velocity_n)
    p2a, v2a = _of_tilt(position, velocity_n)
    a2a = -attitude.skew(earth.earth_rate(position[0]) + earth.transport_rate(position[0], position[2], velocity_n))
    return np.concatenate(
        [
            np.concatenate([p2p, v2p, none, none, none], axis=1),
            np.concatenate([p2v, v2v, -attitude.skew(force_n), -C_nb, none], axis=1),
            np.concatenate([p2a, v2a, a2a, none, -C_nb], axis=1),
        ]
    )


def _of_position(position, velocity_n):
    """P2P (5.41) and V2P (5.42)."""
    latitude, altitude = position[0], position[2]
    cosine, tangent = np.cos(latitude), np.tan(latitude)
    north_south, east_west = (radius + altitude for radius in earth.radii(latitude))
    north, east = velocity_n[0], velocity_n[1]
    zero = 0.0 * latitude
    by_latitude = east * tangent / (east_west * cosine)
    p2p = [
        [zero, zero, -north / (north_south * north_south)],
        [by_latitude, zero, -east / (east_west * east_west * cosine)],
        [zero, zero, zero],
    ]
    v2p = [[1.0 / north_south, zero, zero], [zero, 1.0 / (east_west * cosine), zero], [zero, zero, zero - 1.0]]
    return np.array(p2p), np.array(v2p)


def _of_velocity(position, velocity_n):
    """P2V (5.43) and V2V (5.44)."""
    latitude, altitude = position[0], position[2]
    tangent, secant = np.tan(latitude), 1.0 / np.cos(latitude)
    north_south, east_west = (radius + altitude for radius in earth.radii(latitude))
    north, east, down = velocity_n[0], velocity_n[1], velocity_n[2]
    level, upward = earth.EARTH_RATE * np.cos(latitude), earth.EARTH_RATE * np.sin(latitude)
    around = east * tangent / east_west
    zero = 0.0 * latitude
    free_air = 2.0 * earth.gravity(latitude, zero) / earth.EQUATORIAL_RADIUS
    squares = east * east / (east_west * east_west) + north * north / (north_south * north_south)
    p2v = [
        [
            -2.0 * level * east - east * east * secant * secant / east_west,
            zero,
            east * around / east_west - down * north / (north_south * north_south),
        ],
        [
            2.0 * (level * north - upward * down) + east * north * secant * secant / east_west,
            zero,
            -north * around / east_west - down * east / (east_west * east_west),
        ],
        [2.0 * upward * east, zero, squares - free_air],
    ]
    v2v = [
        [down / north_south, -2.0 * (around + upward), north / north_south],
        [2.0 * upward + around, (north * tangent + down) / east_west, 2.0 * level + east / east_west],
        [-2.0 * north / north_south, -2.0 * (level + east / east_west), zero],
    ]
    return np.array(p2v), np.array(v2v)


def _of_tilt(position, velocity_n):
    """P2A (5.46) and V2A (5.47): what makes the rate of n wrong."""
    latitude, altitude = position[0], position[2]
    tangent, secant = np.tan(latitude), 1.0 / np.cos(latitude)
    north_south, east_west = (radius + altitude for radius in earth.radii(latitude))
    north, east = velocity_n[0], velocity_n[1]
    level, upward = earth.EARTH_RATE * np.cos(latitude), earth.EARTH_RATE * np.sin(latitude)
    zero = 0.0 * latitude
    p2a = [
        [upward, zero, east / (east_west * east_west)],
        [zero, zero, -north / (north_south * north_south)],
        [level + east * secant * secant / east_west, zero, -east * tangent / (east_west * east_west)],
    ]
    v2a = [
        [zero, -1.0 / east_west, zero],
        [1.0 / north_south, zero, zero],
        [zero, tangent / east_west, zero],
    ]
    return np.array(p2a), np.array(v2a)


def transition(matrix, time):
    """The first nine rows of Phi over ``time`` s, 1 + F T + F F T^2 / 2, shape (9, 15); biases stay in it."""
    square = matrix[:, :DRIVEN] @ matrix
    one = np.concatenate([np.eye(DRIVEN), np.zeros((DRIVEN, STATES - DRIVEN))], axis=1)
    return one + time * matrix + HALF * time * time * square


def metres(latitude, altitude):
    """Metres north and east of an error of latitude and longitude of one rad, and one for the altitude, shape (3,)."""
    north_south, east_west = earth.radii(latitude)
    across = (east_west + altitude) * np.cos(latitude)
    return np.stack([north_south + altitude, across, 1.0 + 0.0 * across])


def slow(constant, drift, time):
    """Sigma and correlation time (s) of one process for a null shift that is ``constant`` and a ``drift`` about it with
    the correlation ``time``: it has the variance of both and gains in short what the drift does, 2 sigma^2 / tau."""
    variance = constant * constant + drift * drift
    return np.sqrt(variance), time * variance / np.maximum(drift * drift, 1.0e-30)
