"""What is left at a height of the magnetic field of rocks and of things on the ground."""

from __future__ import annotations

import numpy as np


def dipole_share(height, depth):
    """Of the field of a dipole ``depth`` (m) below the ground, what is left at a height (m) above it, of that on it.

    Straight above the dipole, where it falls with the third power of the distance.
    """
    share = depth / (depth + height)
    return share * share * share


def _waves(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Wave numbers over 1/L, and the parts of the variance that they have: nodes of a quadrature, see wave_share.

    In q with 1 - q^2 = 1 / sqrt(1 + u^2) the part of the variance below u is q^2 (2 - q^2), or 2 q dq of each, and
    the wave number is a smooth function of it.
    """
    node, weight = np.polynomial.legendre.leggauss(count)
    q = 0.5 * (node + 1.0)
    return q * np.sqrt(2.0 - q * q) / (1.0 - q * q), q * weight


_WAVES, _PARTS = _waves(12)


def wave_share(height, length):
    """Of the standard deviation of a random field, what is left at a height (m), of that on the ground.

    Over the ground the field is alike in all directions, with a correlation exp(-d / L) over the distance d, L
    ``length`` (m): so along any straight flight it is a first-order Gauss-Markov process. Its waves of wave number
    u / L have u (1 + u^2)^(-3/2) du of the variance, and each falls with the height as exp(-u h / L), because the field
    has a potential above the ground. What is left of the variance,

        integral of u (1 + u^2)^(-3/2) exp(-2 u h / L) du = 1 - pi x / 2 (H_0(x) - Y_0(x)),  x = 2 h / L,

    is a sum over 12 waves here; its root is within 0.002.
    """
    return np.sqrt(np.sum(_PARTS * np.exp(-2.0 * height / length * _WAVES)))
