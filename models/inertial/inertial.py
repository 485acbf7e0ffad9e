"""Inertial sensors, thesis section 3.2, p. 38: one error model for gyros and accelerometers."""

from __future__ import annotations


def sense(true, scale_factor, null_shift, drift):
    """What is sensed, (1 + s_f) s_t + b_0 + b_1(t); the output s_m of thesis (3.2), (3.3) has wide-band noise b_w, too.

    b_0 is the null shift (constant after turn-on), b_1 the drift (Gauss-Markov, (3.4), (3.5)).
    """
    return (1.0 + scale_factor) * true + null_shift + drift
