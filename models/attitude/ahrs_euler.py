"""The filter of Euler angles of thesis section 4.11.1, (4.32)-(4.51), with level and needle of 4.12.

The states of the filter are errors, true minus estimated, of

    [heading, pitch, roll | b_p, b_q, b_r]                                                                     (4.32)

in rad and rad/s. What is kept is (heading, pitch, roll), here an ``attitude``.

What differs from the thesis, and why:

- (4.35), (4.45) print -cos(roll) for -sin(roll) in row 2, column 3; compare (4.4).
- (4.34) has F_gyro, -1/tau, below the zeros, where it would drive biases by angles; its place is at the right. It is
  left out: a bias is a null shift and what drifts, and -1/tau would pull the null shift to zero. The text below (4.44)
  does not carry biases on either.
- (4.35) takes a bias that is added to the rates, here it is what the rates are wrong by: f has the other sign.
- (4.34) has zeros for what errors of pitch and roll do to the Euler rates. Computed gains have them (by
  differentiation), because in a turn a roll error becomes a pitch error; scheduled ones have not.
- (4.50) prints (H' P H + R_v), which is (H P H' + R_v).
- (4.8), (4.9) are of what gravity shows, the opposite of the specific force, and (4.9) leaves out cos(pitch).
  ``ahrs.level`` is right for any attitude.
"""

from __future__ import annotations

import numpy as np

from models.attitude import ahrs, attitude
from navfmu.derivatives import jacobian

UPRIGHT = 1.0e-3
"""The least cosine of pitch: beyond it (4.35) has no meaning."""


def of_angles(roll, pitch, heading):
    return np.stack([heading, pitch, roll])


def angles(estimated):
    """Roll, pitch and heading in [-pi, pi), rad."""
    return estimated[2], estimated[1], attitude.wrap(estimated[0])


def dcm(estimated):
    """C_nb."""
    return attitude.dcm(*angles(estimated))


def headed(estimated, by):
    """The attitude with another heading, more by so many rad."""
    return estimated + by * np.array([1.0, 0.0, 0.0])


def by_gyros(estimated):
    """f of (4.35): rates of heading, pitch and roll by p, q, r; shape (3, 3)."""
    _, pitch, roll = estimated
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    cp = np.where(np.abs(cp) < UPRIGHT, np.copysign(UPRIGHT, cp), cp)
    zero = 0.0 * roll
    return np.array([[zero, sr / cp, cr / cp], [zero, cr, -sr], [1.0 + zero, sr * sp / cp, cr * sp / cp]])


def turned(estimated, rotation):
    """The attitude after a small rotation in b, rad: (4.45) by the midpoint rule."""
    middle = estimated + 0.5 * by_gyros(estimated) @ rotation
    return upright(*(estimated + by_gyros(middle) @ rotation))


def transition(estimated, rotation, time):
    """The first rows of Phi over ``time`` s, shape (3, 6): ``rotation`` in b, rad, has gone before."""

    def moved(error):
        return turned(estimated + error[:3], rotation - time * error[3:])

    return jacobian(moved, np.zeros(6))


def driven(estimated):
    """What the rates' noise does to the first three states: f in (4.39)."""
    return by_gyros(estimated)


def begun(estimated, squares):
    """Covariance of the first three states from variances of heading, pitch and roll, rad^2."""
    return np.diag(squares)


def by_angles(estimated, told, sigmas):
    """Innovations (4.63), H (4.49) and R_v (4.51), diagonal, of angles that are told.

    ``told`` is the attitude of these angles, ``sigmas`` are those of heading, pitch and roll, rad.
    """
    return attitude.wrap(told - estimated), np.eye(3), sigmas * sigmas


def by_vectors(estimated, field_b, minus_g, dip, declination, sigmas):
    """The same of level and needle, (4.8), (4.9), (2.3); arguments as in ``ahrs_quaternion``."""
    roll, pitch = ahrs.level(minus_g, np.zeros(3))
    magnetic, _ = ahrs.levelled_heading(field_b, roll, pitch)
    return by_angles(estimated, of_angles(roll, pitch, magnetic + declination), sigmas)


def corrected(estimated, correction):
    return upright(*(estimated + correction))


def upright(heading, pitch, roll):
    """The same attitude with pitch within a quarter turn of the level, and the others within half a turn."""
    over = np.abs(pitch) > 0.5 * np.pi
    return np.stack(
        [
            attitude.wrap(np.where(over, heading + np.pi, heading)),
            np.where(over, np.copysign(np.pi, pitch) - pitch, pitch),
            attitude.wrap(np.where(over, roll + np.pi, roll)),
        ]
    )


def scheduled(estimated, gains):
    """L (4.64) as a function of attitude, shape (6, 3), Fig 4.16.

    An angle's innovation corrects that angle alone, and of the gyros those that turn it: the share of each is the
    inverse of f, which is its transpose at pitch 0. So at pitch 0 this is the gain at rest for any roll, not only for
    those of a table.

    ``gains``, shape (3, 2), are of heading, pitch and roll what ``gyro_axis.scheduled`` gives.
    """
    _, pitch, roll = estimated
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    zero = 0.0 * roll
    to_gyros = np.array([[-sp, zero, 1.0 + zero], [sr * cp, cr, zero], [cr * cp, -sr, zero]])
    return np.concatenate([np.diag(gains[:, 0]), to_gyros * gains[:, 1]])


def variances(estimated, covariance):
    """Variances of roll, pitch and heading, rad^2, of the covariance of the first three states."""
    return np.diag(covariance)[::-1]
