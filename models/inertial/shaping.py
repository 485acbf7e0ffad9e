"""How a sensor's lag passes an oscillation, as the rules for coning want it: F^2 of ``models.inertial.coning``.

Of an input that is linear between samples the lag of ``models.inertial.bandwidth`` makes, with v = exp(-i a) for one
sample of delay, d and 1/w in samples, e = 1 - v and Phi for one sample,

    (1 - v Phi) x = (1 - d e, e/w) - Phi (v - d e, e/w)                                                            (1)

of which y is the first element: a ratio of two polynomials of v, of degree 2. The square of the modulus of one is

    |n_0 + n_1 v + n_2 v^2|^2 = n_0^2 + n_1^2 + n_2^2 + 2 (n_0 n_1 + n_1 n_2) cos a + 2 n_0 n_2 cos 2a               (2)
"""

from __future__ import annotations

from models.inertial import series

POWERS = 4
"""Powers 0, 2, 4 and 6 of a: enough for order 8."""
_ONCE, _TWICE = ([float(x) for x in series.cosine(k)[:POWERS]] for k in (1, 2))


def squared(transition, times, period):
    """Coefficients of the powers 0, 2, 4, 6 of a in the square of what the lag passes.

    ``transition`` and ``times`` (s) as of ``models.inertial.bandwidth``, for samples that are ``period`` (s) apart.
    """
    delay, inverse = times[0] / period, times[1] / period
    (p11, p12), (p21, p22) = transition
    y = (1.0 - delay + p11 * delay - p12 * inverse, delay - p11 * (1.0 + delay) + p12 * inverse)
    slope = (inverse + p21 * delay - p22 * inverse, -inverse - p21 * (1.0 + delay) + p22 * inverse)
    above = (y[0], y[1] - p22 * y[0] + p12 * slope[0], p12 * slope[1] - p22 * y[1])
    below = (1.0, -p11 - p22, p11 * p22 - p12 * p21)
    return series.quotient(_modulus(above), _modulus(below))


def _modulus(n) -> tuple:
    """(2), by powers of a."""
    same, next_, after = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], n[0] * n[1] + n[1] * n[2], n[0] * n[2]
    return tuple(
        (same if power == 0 else 0.0) + 2.0 * next_ * once + 2.0 * after * twice
        for power, (once, twice) in enumerate(zip(_ONCE, _TWICE, strict=True))
    )
