"""The quaternion filter of thesis section 4.11.2, (4.52)-(4.60).

The states of the filter are

    [q_e | b_p, b_q, b_r]                                                                                      (4.52)

the vector of the quaternion's error in b, q = q^ q_e (4.17), half a rotation, and errors of the gyro biases, rad/s.
What is kept is the quaternion q^, here an ``attitude``.

What differs from the thesis, and why:

- (4.2), (4.3) print cos(Phi) and Phi e, which are cos(Phi / 2) and sin(Phi / 2) e.
- (4.54) has F_gyro below -[omega x], where it would drive biases by angles; it is left out as in ``ahrs_euler``. The
  bias is what the rates are wrong by, so it drives q_e by -1/2 and not 1/2.
- (4.58) leaves out x^(-), and with it all that has been learned of the biases. q_e is 0 before each update, because it
  is put into q^ after each.
- (4.59) prints q_GPS q^, which is q^* q_GPS: from (4.17).
- (4.60) has vectors in n and q_e in b. In b it is H = 2 [u^_b x], with u^_b = C_bn u_n (``models.attitude.vectors`` has
  the derivation in n).
- R_v of (4.59) is that of half angles.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude, quaternion
from models.attitude.ahrs import field_n
from navfmu.derivatives import jacobian, value_and_jacobian

UPRIGHT = 1.0e-3
"""The least cosine of pitch for the sigmas of roll and heading."""


def of_angles(roll, pitch, heading):
    return quaternion.of_euler(roll, pitch, heading)


def angles(estimated):
    """Roll, pitch and heading in [-pi, pi), rad."""
    roll, pitch, heading = attitude.euler(quaternion.dcm(estimated))
    return roll, pitch, attitude.wrap(heading)


def dcm(estimated):
    """C_nb."""
    return quaternion.dcm(estimated)


def headed(estimated, by):
    """The attitude with another heading, more by so many rad."""
    return quaternion.product(quaternion.of_rotation(by * np.array([0.0, 0.0, 1.0])), estimated)


def turned(estimated, rotation):
    """The attitude after a rotation in b, rad: (4.5), exactly for one about an axis that stays."""
    return quaternion.unit(quaternion.product(estimated, quaternion.of_rotation(rotation)))


def corrected(estimated, error):
    """q = q^ q_e, (4.17), for an error that may be large."""
    return turned(estimated, 2.0 * error)


def transition(estimated, rotation, time):
    """The first rows of Phi over ``time`` s, shape (3, 6), of (4.54): ``rotation`` in b, rad, has gone before."""
    back = quaternion.inverse(quaternion.of_rotation(rotation))

    def moved(error):
        ahead = quaternion.of_rotation(2.0 * error[:3])
        return quaternion.product(back, quaternion.product(ahead, quaternion.of_rotation(rotation - time * error[3:])))[
            1:
        ]

    return jacobian(moved, np.zeros(6))


def driven(estimated):
    """What the rates' noise does to the first three states, (4.56); its sign is that of a bias."""
    return 0.5 * np.eye(3) + 0.0 * estimated[0]


def begun(estimated, squares):
    """Covariance of q_e from variances of heading and level, rad^2; those of pitch and roll are alike."""
    about, level = _vertical(estimated)
    return 0.25 * (squares[0] * about + squares[1] * level)


def by_angles(estimated, told, sigmas):
    """Innovations (4.59), (4.65), H and R_v, diagonal, of an attitude that is told.

    ``told`` is a quaternion, ``sigmas`` are those of rotations about the axes of b, rad: those of roll, pitch and
    heading, which are the same.
    """
    y = quaternion.product(quaternion.inverse(estimated), told)
    y = y * np.where(y[0] < 0.0, -1.0, 1.0)
    return y[1:], np.eye(3), 0.25 * sigmas * sigmas


def by_vectors(estimated, field_b, minus_g, dip, declination, sigmas):
    """The same of two vectors, (4.30), (4.60): six innovations, H of shape (6, 3), six variances.

    Parameters
    ----------
    field_b, minus_g
        Field and specific force less acceleration in b, in any unit.
    dip, declination
        Of the field, rad.
    sigmas
        Of heading, pitch and roll as field and level tell them, rad. The direction of the field has the error of the
        heading times cos(dip), the one of gravity that of the pitch.
    """
    known = field_n(dip, declination), np.array([0.0, 0.0, -1.0])
    across = np.stack([sigmas[0] * np.cos(dip), sigmas[1]])

    def seen(error):
        c_bn = quaternion.dcm(quaternion.product(estimated, quaternion.of_rotation(2.0 * error))).T
        return np.concatenate([c_bn @ vector for vector in known])

    expected, matrix = value_and_jacobian(seen, np.zeros(3))
    measured = np.concatenate([vector / np.sqrt(np.sum(vector * vector)) for vector in (field_b, minus_g)])
    return measured - expected, matrix, np.repeat(across * across, 3)


def scheduled(estimated, gains):
    """L (4.66), shape (6, 3), for an innovation of q_e: Fig 4.17.

    ``gains``, shape (3, 2), are of heading, pitch and roll what ``gyro_axis.scheduled`` gives. Those of pitch and roll
    are alike. Where all are, as by GPS, L does not depend on attitude; else it does as the vertical does in b.
    """
    about, level = _vertical(estimated)
    parts = ((0, 1.0), (1, 2.0))  # of q_e, half a rotation, and of a bias, a whole one in a second
    return np.concatenate([factor * (gains[0, i] * about + gains[1, i] * level) for i, factor in parts])


def _vertical(estimated):
    """What takes of a vector in b its part along the vertical, and the rest; shape (3, 3) each."""
    down_b = quaternion.dcm(estimated)[2]
    about = np.outer(down_b, down_b)
    return about, np.eye(3) - about


def variances(estimated, covariance):
    """Variances of roll, pitch and heading, rad^2, of the covariance of q_e; at the vertical those of two are large."""
    roll, pitch, _ = angles(estimated)
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.maximum(np.cos(pitch), UPRIGHT)
    zero, one = 0.0 * roll, 1.0 + 0.0 * roll
    by_rotation = 2.0 * np.array([[one, sr * sp / cp, cr * sp / cp], [zero, cr, -sr], [zero, sr / cp, cr / cp]])
    return np.sum((by_rotation @ covariance) * by_rotation, axis=1)
