"""Attitude by matching vectors that are known in n and measured in b: thesis section 4.9, (4.10)-(4.31).

Two vectors, the field of the Earth and gravity, tell the attitude: C_nb takes what is measured in b to what is known in
n. This is Wahba's problem, *SIAM Review* 7 (1965), p. 409, solved by iterated least squares.

What differs from the thesis, and why:

- (4.15) prints r3 s + s3 r in the product of quaternions, which is r0 s + s0 r.
- (4.26) and (4.28) leave out C_nb: from (4.25) follows u_n - û_n = -2 C_nb [u_b x] q_e, with q_e in b, as (4.17) has
  it; and that is -2 [û_n x] (C_nb q_e). So H of (4.31), which has vectors in n, takes q_e in n, and step 6 must be
  q = q_e q^, not q = q^ q_e. As printed, four attitudes of ten are not found.
- Vectors are of unit length, with weights: one over the square of the error of their direction. In gauss and g with
  noise of 1 mG and 1 mg, as in the thesis, that is the same.

H has u_n and not û_n, as (4.31) is printed: it is the same in all iterations, and so is its pseudo-inverse. Where the
iteration stands still, the sum of w û x u is zero, which is so at the minimum of Wahba's sum, too: the attitude is the
optimal one, not an approximation to it.

Where it cannot work: vectors along one line (:func:`apart`), and a start that is wrong by half a turn,
where û x u is zero, too. Close to it, by 0.1 degrees or so with the 100 iterations and the gain 0.1 of the thesis, the
start is left, but too slowly.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude, quaternion
from navfmu.repetition import repeat

ALONG = 5.0e-3
"""Sine of the angle, 0.3 degrees, below which two vectors are along one line (own choice)."""


def rows(reference_n):
    """H of (4.31) for one vector in n, shape (3, 3): the derivative of u_n - û_n by the vector part of q_e in n."""
    return -2.0 * attitude.skew(reference_n)


def apart(pair):
    """Whether two unit vectors, shape (2, 3), are not along one line."""
    return _across(*pair) > ALONG


def spread(references_n, weights):
    """H' W H / 4, the information (rad^-2) on the rotation vector in n, shape (3, 3).

    Parameters
    ----------
    references_n
        Unit vectors, shape (2, 3). Where they are along one line, the identity is returned.
    weights
        One over the square of the error of each direction, rad^-2, shape (2,).
    """
    observed = [rows(vector) for vector in references_n]
    total = sum(0.25 * w * h.T @ h for w, h in zip(weights, observed, strict=True))
    return np.where(apart(references_n), total, np.eye(3))


def matched(references_n, measured_b, weights, start, gain, iterations, most):
    """Quaternion of C_nb that matches the vectors: steps 1 to 7 of the thesis, p. 117.

    Parameters
    ----------
    references_n, measured_b, weights
        Unit vectors in n and in b, shape (2, 3), and weights as in :func:`spread`.
    start
        Quaternion to begin with; (1, 0, 0, 0) in the thesis.
    gain
        alpha, the share of a correction that is taken.
    iterations, most
        How often, and the largest number of that, as in :func:`navfmu.repetition.repeat`.
    """
    h = np.concatenate([rows(vector) for vector in references_n])
    weighted = h.T * np.repeat(weights, 3)
    pseudo_inverse = np.linalg.inv(4.0 * spread(references_n, weights)) @ weighted

    def closer(q):
        found_n = measured_b @ quaternion.dcm(q).T
        correction = gain * pseudo_inverse @ np.ravel(references_n - found_n)
        return quaternion.unit(quaternion.product(np.concatenate([np.ones(1), correction]), q))

    return repeat(closer, start, iterations, most)


def variances(information, c_nb, roll, pitch):
    """Variances of roll, pitch and heading, rad^2, where vectors have the errors of their weights.

    The inverse of the information is the covariance of the rotation vector in n; (4.4) takes a small rotation to
    changes of the angles.
    """
    turning = attitude.euler_rates(c_nb.T, roll, pitch)
    return np.diag(turning @ np.linalg.inv(information) @ turning.T)


def misfit(references_n, measured_b):
    """Angle between the two vectors as they are measured less the known one, rad: no attitude makes it smaller.

    ``references_n``, ``measured_b``: unit vectors, shape (2, 3).
    """
    return _between(*measured_b) - _between(*references_n)


def residual(references_n, measured_b, c_nb):
    """Largest angle, rad, that an attitude leaves between a measured vector and the known one."""
    found_n = measured_b @ c_nb.T
    return np.max(np.stack([_between(u, v) for u, v in zip(references_n, found_n, strict=True)]))


def _between(u, v):
    return np.arctan2(_across(u, v), np.sum(u * v))


def _across(u, v):
    across = np.cross(u, v)
    return np.sqrt(np.sum(across * across))
