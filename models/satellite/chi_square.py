"""Chi square for whole numbers of degrees of freedom: tails, their thresholds, non-centralities.

Abramowitz and Stegun 26.4.4, 26.4.5, 26.4.25. Arrays are over degrees of freedom; what is said of accuracy holds for 1
to 40 of them and probabilities from 1e-12 to 0.5.
"""

from __future__ import annotations

import math

import numpy as np

from navfmu.repetition import repeat

TERMS = 400
"""Of Poisson's distribution in the non-central one at most, which is enough for a non-centrality of 400."""


def tail(x, freedom):
    """P(chi square > x), to 1e-14 of itself; ``freedom`` are numbers, known when a model is built."""
    freedom = np.asarray(freedom)
    half = 0.5 * x
    odd = freedom % 2 == 1
    term = np.exp(-half) * np.where(odd, 2.0 * np.sqrt(half / np.pi), 1.0)
    total = np.where(odd, complement(np.sqrt(half)), 0.0)
    for j in range(int(np.max(freedom)) // 2 + 1):
        total = total + np.where(2 * j + np.where(odd, 1, 0) < freedom, term, 0.0)
        term = term * half / np.where(odd, j + 1.5, j + 1.0)
    return total


def complement(z):
    """erfc(z) for z > 0: trapezoids of width 1/2, and what they leave out (Matta and Reichel 1971)."""
    h = 0.5
    square = z * z
    total = 1.0 / square
    for n in range(1, 13):
        total = total + 2.0 * np.exp(-n * n * h * h) / (n * n * h * h + square)
    pole = 2.0 / (np.exp(np.minimum(2.0 * np.pi * z / h, 700.0)) - 1.0)
    return np.exp(-square) * h * z / np.pi * total - np.where(z < np.pi / h, pole, 0.0)


def density(x, freedom):
    """Density of chi square at x > 0."""
    freedom = np.asarray(freedom, float)
    logs = np.array([math.lgamma(0.5 * k) for k in np.ravel(freedom)]).reshape(freedom.shape)
    return np.exp((0.5 * freedom - 1.0) * np.log(0.5 * x) - 0.5 * x - logs) / 2.0


def threshold(probability, freedom):
    """The x that chi square exceeds with a probability: T^2 of a test with that rate of false alarms, to 1e-13.

    Newton's method on the logarithm of the tail, from the value of Wilson and Hilferty for a normal quantile that is
    near enough.
    """
    freedom = np.asarray(freedom, float)
    normal = np.sqrt(np.maximum(-2.0 * np.log(2.0 * probability), 0.0))
    share = 2.0 / (9.0 * freedom)
    x = freedom * np.maximum(1.0 - share + normal * np.sqrt(share), 0.1) ** 3
    for _ in range(8):
        over = tail(x, freedom)
        x = np.maximum(x + over / density(x, freedom) * np.log(over / probability), 0.1 * x)
    return x


def normal_threshold(probability):
    """The number of sigmas that a normal number exceeds with a probability below 1/2, to one side."""
    return np.sqrt(threshold(2.0 * probability, np.array([1.0]))[0])


def below(x, freedom, non_centrality):
    """P(non-central chi square <= x) and the same of two more degrees of freedom.

    Poisson's mixture of central ones, 26.4.25: the tail of each next one is larger by twice its density.
    """
    half = 0.5 * non_centrality

    def add(value):
        j, weight, inside, step, total, further = value
        less = inside - step
        return (
            j + 1.0,
            weight * half / (j + 1.0),
            less,
            step * 0.5 * x / (0.5 * freedom + j + 1.0),
            total + weight * inside,
            further + weight * less,
        )

    freedom = np.asarray(freedom, float)
    zero = 0.0 * (x + non_centrality)
    inside, step = 1.0 - tail(x, freedom), 2.0 * density(x, freedom + 2.0)
    value = (zero, np.exp(-half), inside + zero, step + zero, zero, zero)
    mean = np.max(half)
    _, _, _, _, total, further = repeat(add, value, np.ceil(mean + 10.0 * np.sqrt(mean) + 20.0), TERMS)
    return total, further


def non_centrality(probability, x, freedom):
    """The lambda whose non-central chi square stays at or below x with a probability, to 1e-9.

    It is the square of the bias, in sigmas, that a test with the threshold x misses so often.
    """
    start = np.sqrt(x) + normal_threshold(probability)

    def closer(root):
        total, further = below(x, freedom, root * root)
        # d/d lambda = (further - total) / 2, and lambda = root^2
        return root - total * np.log(total / probability) / (root * (further - total))

    return repeat(closer, start, 12, 12) ** 2
