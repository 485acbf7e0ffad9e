"""Coning: the angle that a turning axis of rotation adds to the sum of the angle increments.

Mark and Tazartes, "Application of Coning Algorithms to Frequency Shaped Gyro Data", in RTO MP-43 (1999). An axis goes
round on a cone of half-angle eps at w rad/s, (A-1), (A-6): two gyros see eps w cos(w t) and -eps w sin(w t), the third
eps^2 w / 2. Their increments over the sampling interval T are, with a = w T, (A-21)

    (eps a F(a) sinc(a/2)) (cos n a, -sin n a),   eps^2 a / 2                                                     (1)

where F(a) is how the gyro, or the integration of its samples, passes the oscillation (:data:`SHAPES`); F(0) = 1. The
product of increments p samples apart, the angle that m samples together have turned by, and so the sum of products that
makes up the difference are, relative to the coning angle eps^2 a / 2 of a sample, (A-30), (A-46),

    C_p = -2 p a^2 F^2 sinc^2(a/2) sinc(p a)                                                                      (2)
    sum_p x_p C_p = m (F^2 sinc(m a) - 1)                                                                         (3)

Equating the powers a^2 ... a^(2m-2) gives x_1 ... x_(m-1), (A-54), and leaves an error of order 2m. They are solved for
in fractions: two of the numbers printed in Table 2 are misprints (an error of 126456, not 124456, for m = 4; 29761, not
29762, for m = 5). The tables print what is left with the sign of what is missing; here errors are found minus true.

Samples need not end with the interval: with those of before,

    dphi = sum_l { dtheta_l + [1/2 (dtheta_1 + ... + dtheta_(l-1)) + sum_p c_p dtheta_(l-p)] x dtheta_l }         (4)

holds for any number of samples (:func:`step`). The first product is how finite rotations add up, to second order in
the angles; the others do for the one sample l what (3) does for m = 1, so that

    sum_p c_p C_p = F^2 sinc(a) - 1                                                                               (5)

with n of them leaves an error of order 2n + 2, the same as that of (3) with m = n + 1. For F = 1 and n = 1 that is
c_1 = 1/12, the 1/6 of Savage, "Strapdown Inertial Navigation Integration Algorithm Design Part 1", Journal of Guidance,
Control, and Dynamics 21 (1998).
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from models.inertial import series

HALF = Fraction(1, 2)
_ROUND = series.sinc(HALF)
SHAPES: dict[str, series.Series] = {
    "flat": series.sinc(0),
    "trapezoid": series.quotient(series.cosine(HALF), _ROUND),
    "resolution_enhanced": _ROUND,
}
"""F(a) of (1).

flat                 the increments are integrals, as of a ring laser
trapezoid            T (w_(k-1) + w_k) / 2 of sampled rates passes (a/2) cot(a/2)
resolution_enhanced  sinc(a/2), (A-31): the digital filter of a ring laser's pulses
"""


def coefficients(samples: int, shape: str = "flat") -> list[Fraction]:
    """Return x_1 ... x_(m-1) of (3), m = ``samples``."""
    return series.solve(*_equations(samples - 1, samples, shape))


def before(count: int, shape: str = "flat") -> list[Fraction]:
    """Return c_1 ... c_n of (5), n = ``count``."""
    return series.solve(*_equations(count, 1, shape))


def error(samples: int, shape: str = "flat") -> Fraction:
    """Return the error of (3), and of (4) with n = ``samples`` - 1, as a rate over the coning rate.

    It is what is returned times a^(2 samples), and that by higher powers.
    """
    return _left(coefficients(samples, shape), samples, shape)


def error_of(found: list[Fraction], shape: str = "flat") -> Fraction:
    """Return the same of (4) with given c_1 ... c_n, which cancel all lower powers."""
    return _left(found, 1, shape)


def fitted(count: int, squared):
    """Return c_1 ... c_n of (5), shape (n,), where F is known only when the gyro is.

    Parameters
    ----------
    count
        n.
    squared
        F(a)^2 as coefficients of the powers 0, 2 ... 2n of a.
    """
    products = [[float(x) for x in _product(p, "flat")[:count]] for p in range(1, count + 1)]
    whole = [float(x) for x in series.sinc(1)]
    shaped = np.stack([np.stack(series.product(product, squared)) for product in products], axis=1)
    wanted = np.stack(series.product(whole, squared)[1 : count + 1])
    return np.linalg.solve(shaped, -0.5 * wanted)


def correction(angles, x):
    """Return dphi minus the sum of the increments of one interval, rad; products with the last increment alone.

    Parameters
    ----------
    angles
        Increments of the m samples, rad, shape (m, 3).
    x
        Coefficients (3), shape (m - 1,).
    """
    return np.cross(np.sum(np.asarray(x)[::-1, None] * angles[:-1], axis=0), angles[-1])


def step(total, past, angle, c):
    """Return what one more sample adds to the coning angle, rad: the bracket of (4).

    Parameters
    ----------
    total
        Sum of the increments since the interval began, rad, shape (3,).
    past
        Increments before this one, the latest first, also from before the interval, rad, shape (n, 3).
    angle
        This increment, rad, shape (3,).
    c
        Coefficients (5), shape (n,).
    """
    return np.cross(0.5 * total + np.sum(c[:, None] * past, axis=0), angle)


def _product(p: int, shape: str) -> series.Series:
    """(2) over -2 a^2."""
    passed = series.product(SHAPES[shape], _ROUND)
    return series.product(series.product(passed, passed), tuple(p * term for term in series.sinc(p)))


def _wanted(samples: int, shape: str) -> series.Series:
    """The right side of (3) over -2."""
    squared = series.product(SHAPES[shape], SHAPES[shape])
    left = series.product(squared, series.sinc(samples))
    return tuple(HALF * samples * ((n == 0) - term) for n, term in enumerate(left))


def _equations(count: int, samples: int, shape: str) -> tuple[list[list[Fraction]], list[Fraction]]:
    products = [_product(p, shape) for p in range(1, count + 1)]
    wanted = _wanted(samples, shape)
    return [[term[k] for term in products] for k in range(count)], [wanted[k + 1] for k in range(count)]


def _left(found: list[Fraction], samples: int, shape: str) -> Fraction:
    power = len(found)
    applied = sum((x * _product(p, shape)[power] for p, x in enumerate(found, 1)), Fraction(0))
    return 2 * (_wanted(samples, shape)[power + 1] - applied) / samples
