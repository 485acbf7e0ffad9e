"""Equal first-order lags in a row, tau y_i' + y_i = y_(i-1), y_0 the input: exact for one that is held, or linear.

With theta = period / tau the response of level i to level j <= i is exp(-theta) theta^(i-j) / (i-j)!. All functions
work element by element on the axes.
"""

from __future__ import annotations

import numpy as np


def advance(levels, held, ratio, decay):
    """The levels one period later.

    Parameters
    ----------
    levels
        Shape (lags, axes), the last lag's output at the end.
    held
        The input u, constant over the period, one for each axis.
    ratio, decay
        theta = period / tau and exp(-theta).
    """
    weights = [decay]
    for i in range(1, len(levels)):
        weights.append(weights[-1] * ratio / i)
    later = []
    for i in range(len(levels)):
        kept = sum(weights[i - j] * levels[j] for j in range(i + 1))
        later.append(kept + (1.0 - sum(weights[: i + 1])) * held)
    return np.stack(later)


def follow(value, rate, old_input, new_input, period, time_constant, decay):
    """Output of two equal lags and its rate one period later; the input is linear in between, decay = exp(-theta)."""
    slope = (new_input - old_input) / period
    lag = 2.0 * time_constant * slope
    error = value - old_input + lag
    error_rate = rate - slope
    inverse = 1.0 / time_constant
    return (
        new_input - lag + decay * (error + period * (error_rate + inverse * error)),
        slope + decay * (error_rate - period * inverse * (error_rate + inverse * error)),
    )


def held_drive(time_constant, period):
    """Standard deviation of the input, held for ``period``, that gives the first level a variance of 1.

    To (period / tau)^2 / 12: white noise of the spectral density 2 tau.
    """
    return np.sqrt(2.0 * time_constant / period)
