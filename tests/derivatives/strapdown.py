"""The error model of strapdown inertial navigation, twice: as a function to be differentiated, and written by hand.

Fifteen states: latitude, longitude (rad), height (m); velocity_n (m/s); misalignment of n (rad), with which
C_nb = (I + [phi x]) times the estimated one; biases of accelerometers (m/s2) and gyros (rad/s), which decay.
A sphere that turns, gravity as the square of distance: so that all derivatives have closed forms (compare Titterton and
Weston, Strapdown Inertial Navigation Technology, 2nd ed., (12.28), with the signs of this misalignment).
"""

from __future__ import annotations

import numpy as np

RADIUS, RATE, GRAVITY = 6371.0e3, 7.292115e-5, 9.80665
TIME_CONSTANT = 1000.0


def cross(v):
    """[v x]."""
    zero = 0.0 * v[0]
    return np.array([[zero, -v[2], v[1]], [v[2], zero, -v[0]], [-v[1], v[0], zero]])


def rates(latitude, height, velocity_n):
    """Rate of the earth and of n over it, in n, rad/s."""
    r = RADIUS + height
    earth = RATE * np.array([np.cos(latitude), 0.0, -np.sin(latitude)])
    return earth, np.array([velocity_n[1] / r, -velocity_n[0] / r, -velocity_n[1] * np.tan(latitude) / r])


def derivatives(x, c_nb, force_b, turning_n):
    """x' of all states; ``turning_n`` is the rate of the estimated n with respect to inertial space."""
    latitude, _, height = x[:3]
    velocity_n, phi, of_force, of_rate = x[3:6], x[6:9], x[9:12], x[12:]
    r = RADIUS + height
    earth, transport = rates(latitude, height, velocity_n)
    turned = np.eye(3) + cross(phi)
    force_n = turned @ c_nb @ (force_b - of_force)
    gravity = np.array([0.0, 0.0, GRAVITY * (RADIUS / r) ** 2])
    change = -turned @ (c_nb @ of_rate) - (earth + transport) + turned @ turning_n
    return np.concatenate(
        [
            [velocity_n[0] / r, velocity_n[1] / (r * np.cos(latitude)), -velocity_n[2]],
            force_n - np.cross(2.0 * earth + transport, velocity_n) + gravity,
            change,
            -x[9:] / TIME_CONSTANT,
        ]
    )


def by_hand(x, c_nb, force_b, turning_n):
    """F, shape (15, 15), of :func:`derivatives` where misalignment and biases are zero."""
    latitude, height, (north, east, _) = x[0], x[2], x[3:6]
    r, zero = RADIUS + height, 0.0 * x[0]
    sine, cosine, tangent = np.sin(latitude), np.cos(latitude), np.tan(latitude)
    secant = 1.0 / cosine
    earth, transport = rates(latitude, height, x[3:6])
    both = 2.0 * earth + transport
    position = np.array(
        [
            [zero, zero, -north / r**2, 1.0 / r, zero, zero],
            [east * tangent * secant / r, zero, -east * secant / r**2, zero, secant / r, zero],
            [zero, zero, zero, zero, zero, -1.0],
        ]
    )
    earth_by_latitude = RATE * np.array([-sine, zero, -cosine])
    transport_by_latitude = np.array([zero, zero, -east * secant**2 / r])
    transport_by_velocity = np.array([[zero, 1.0 / r, zero], [-1.0 / r, zero, zero], [zero, -tangent / r, zero]])
    moving = cross(x[3:6])
    velocity_by_latitude = moving @ (2.0 * earth_by_latitude + transport_by_latitude)
    velocity_by_height = moving @ (-transport / r) + np.array([0.0, 0.0, -2.0 * GRAVITY * RADIUS**2 / r**3])
    velocity_by_velocity = moving @ transport_by_velocity - cross(both)
    none = np.zeros((3, 3))
    upper = np.concatenate([position, np.zeros((3, 9))], 1)
    middle = np.concatenate(
        [
            np.stack([velocity_by_latitude, np.zeros(3), velocity_by_height], 1),
            velocity_by_velocity,
            -cross(c_nb @ force_b),
            -c_nb,
            none,
        ],
        1,
    )
    angles = np.concatenate(
        [
            np.stack([-(earth_by_latitude + transport_by_latitude), np.zeros(3), transport / r], 1),
            -transport_by_velocity,
            -cross(turning_n),
            none,
            -c_nb,
        ],
        1,
    )
    biases = np.concatenate([np.zeros((6, 9)), -np.eye(6) / TIME_CONSTANT], 1)
    return np.concatenate([upper, middle, angles, biases])


def example(seed):
    """Arguments of both functions: a state without misalignment and biases, and what is measured."""
    rng = np.random.default_rng(seed)
    position = [rng.uniform(-1.2, 1.2), rng.uniform(-3.0, 3.0), rng.uniform(0.0, 1e4)]
    x = np.concatenate([position, 80.0 * rng.normal(size=3), np.zeros(9)])
    c_nb = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    c_nb *= np.linalg.det(c_nb)
    earth, transport = rates(x[0], x[2], x[3:6])
    return x, c_nb, rng.normal(size=3) * 5.0 - [0.0, 0.0, 9.8], earth + transport
