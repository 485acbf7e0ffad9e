"""Inertial sensors, thesis section 3.2, p. 38: one error model for gyros and accelerometers.

    s_m = (1 + s_f) s_t + b(t),   b(t) = b_0 + b_1(t) + b_w(t)                                           (3.2), (3.3)

b_0 is the null shift (constant after turn-on), b_1 the drift (Gauss-Markov, (3.4), (3.5)), b_w wide-band noise. What
the thesis leaves to "a more complete error model" (p. 40) enters where it does in a sensor, and in this order:

    s_b = N C_m s_t                     mounting and axes that are not at right angles         (axes)
    s_g = s_b + G f_b                   gyros: sensitivity to specific force
    s_k = (1 + s_f + s_T dT) s_g + s_a |s_g|    scale factor, its warming, its asymmetry       (:func:`scaled`)
    s_l                                 s_k behind the sensor's own lag                        (bandwidth)
    s_n = s_l + b_0 + b_1 + b_2 + b_T dT                                                       (:func:`sense`)
    s_m = s_n + b_w                     in whole steps within the range, some samples late     (quantiser, latency)

b_2 is what wanders without a time constant of its own: flicker and rate random walk (flicker, random_walk); dT is the
temperature of the sensors above that of their calibration (heating).
"""

from __future__ import annotations

import numpy as np


def scaled(true, scale_factor, asymmetry):
    """(1 + s_f) s + s_a |s|: the gain is 1 + s_f + s_a for what is positive and 1 + s_f - s_a for what is negative."""
    return (1.0 + scale_factor) * true + asymmetry * np.abs(true)


def sense(seen, null_shift, drift, wander, warmth):
    """What is sensed, s_n = s_l + b_0 + b_1(t) + b_2(t) + b_T dT, thesis (3.3) and the module's first lines."""
    return seen + null_shift + drift + wander + warmth
