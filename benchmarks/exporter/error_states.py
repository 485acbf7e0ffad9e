"""The 15 error states of an inertial navigator in blocks of three: position, velocity and tilt in n, null shifts of
gyros and accelerometers in b. What is zero in the matrix is not written, so nothing is multiplied by it.
"""

from __future__ import annotations

import numpy as np

from models.filters import kalman


def moved(matrix, period, force_n, C_nb, factor_gyro, factor_accelerometer):
    """Phi times a matrix of 15 rows, Phi = 1 + F T.

    dr' = dv, dv' = f_n x psi + C_nb da, psi' = -C_nb dw; the null shifts are Gauss-Markov processes with a factor each.
    """
    position, velocity, tilt, gyro, accelerometer = (matrix[i : i + 3] for i in range(0, 15, 3))
    x, y, z = force_n
    turned = np.stack([y * tilt[2] - z * tilt[1], z * tilt[0] - x * tilt[2], x * tilt[1] - y * tilt[0]])
    return np.concatenate(
        [
            position + period * velocity,
            velocity + period * (turned + C_nb @ accelerometer),
            tilt - period * (C_nb @ gyro),
            factor_gyro * gyro,
            factor_accelerometer * accelerometer,
        ]
    )


def predict(upper, noise, *motion):
    """P[k+1] = Phi P Phi' + C_d, packed; ``noise`` is the diagonal of C_d."""
    phi_p = moved(kalman.unpack(upper), *motion)
    return kalman.pack(moved(phi_p.T, *motion) + np.diag(noise))


def step(correction, upper, noise, row, variance, residual, *motion):
    """A prediction and a scalar measurement."""
    return kalman.update(correction, predict(upper, noise, *motion), row, variance, residual)[:2]


def bank(corrections, uppers, noises, row, variances, residual, *motion):
    """The same for filters that differ in what they take the noise for, one after the other."""
    filters = zip(corrections, uppers, noises, variances, strict=True)
    after = [step(x, p, noise, row, variance, residual, *motion) for x, p, noise, variance in filters]
    return np.stack([x for x, _ in after]), np.stack([p for _, p in after])
