"""Which error terms make an Allan chart, and how large they are.

The differences of neighbouring averages over n, 2n, 4n ... samples (a Haar decomposition) are nearly independent, for
white noise exactly, and normal with twice the Allan variance v(T) of the terms together. So the chart s(T) has the
log-likelihood

    L = -1/2 sum_T pairs(T) (log v(T) + s(T) / v(T)),   v(T) = sum of c_i^2 a_i(T), c_i >= 0.

Overlapping averages are the mean over all places at which the decomposition can begin: they scatter less, so what is
said of chance is on the safe side. But those of a random walk go together from octave to octave, by 0.5 to 0.9: where
nothing else is seen at any averaging time, 7 of 310 charts had another term or another process. A term belongs to the
sensor if L rises by more than it would rise by chance, with a probability of CHANCE, without it; the set of terms
with the largest L less these rises is taken, of all sets. The axes
of a sensor have the same terms, with coefficients of their own, and one correlation time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from operator import itemgetter

import numpy as np
from scipy import optimize, stats

from navfmu.calibration.allan.chart import Chart
from navfmu.calibration.allan.scatter import covariance, frequencies
from navfmu.calibration.allan.terms import GAUSS_MARKOV, RAMP, TERMS, Term

CHANCE = 1e-3
"""Probability of a term that is not there, at most."""
CONFIDENCE = 0.95
"""Of the intervals."""
YOUNGEST = 5.0
"""Shortest correlation time that is looked for, in samples: a shorter one is white noise."""
_GRID = 24
_ROUNDS = 25


@dataclass(frozen=True)
class Identification:
    """The terms of a sensor: ``coefficients``, ``low`` and ``high`` (terms, axes), ends of the intervals of confidence.

    Units are those of the samples times powers of seconds. The last two are NaN where a coefficient is 0.
    ``correlation_time`` (value, low, high) is that of a Gauss-Markov process, or None.
    """

    chart: Chart
    terms: tuple[Term, ...]
    coefficients: np.ndarray
    low: np.ndarray
    high: np.ndarray
    correlation_time: tuple[float, float, float] | None

    def of(self, term: Term) -> np.ndarray:
        """Coefficients (axes,) of a term, 0 where it was not found."""
        if term in self.terms:
            return self.coefficients[self.terms.index(term)]
        return np.zeros(self.chart.variance.shape[1])

    @property
    def variance(self) -> np.ndarray:
        """Allan variance of the terms together, (levels, axes)."""
        return self.shares(self.chart.time).sum(axis=0)

    def shares(self, time: np.ndarray) -> np.ndarray:
        """Allan variances of the terms at averaging times, s, (terms, times, axes)."""
        shapes = _shapes(
            self.terms, time, self.chart.period, self.correlation_time[0] if self.correlation_time else 1.0
        )
        return shapes.T[:, :, None] * self.coefficients[:, None, :] ** 2

    @property
    def chance(self) -> float:
        """Probability of a chart that is as far from its terms, or farther, if nothing but them is there."""
        ratio = self.chart.variance / self.variance
        deviance = np.sum(self.chart.pairs[:, None] * (ratio - 1.0 - np.log(ratio)))
        free = ratio.size - np.count_nonzero(self.coefficients) - (self.correlation_time is not None)
        return float(stats.chi2.sf(deviance, max(1, free)))

    @property
    def farthest(self) -> tuple[float, float]:
        """Averaging time, s, at which the chart is farthest from its terms by its scatter, and by which factor."""
        off = np.log(self.chart.deviation / np.sqrt(self.variance))
        level, axis = np.unravel_index(np.argmax(np.abs(off) / self.chart.spread[:, None]), off.shape)
        return float(self.chart.time[level]), float(np.exp(off[level, axis]))


def identify(chart: Chart) -> Identification:
    """The set of terms that explains a chart best."""
    taus = np.geomspace(YOUNGEST * chart.period, max(chart.time[-1], 2.0 * YOUNGEST * chart.period), _GRID)
    best, most = (-np.inf, TERMS[:1], 1.0), _log_density(chart, chart.variance)  # no model is nearer than the chart
    for size in range(1, min(len(TERMS), len(chart.time) - 1) + 1):
        for terms in combinations(TERMS, size):
            price = _price(chart, terms)
            if most - price > best[0]:
                for tau in taus if GAUSS_MARKOV in terms else taus[:1]:
                    best = max(best, (_likelihood(chart, terms, tau) - price, terms, tau), key=itemgetter(0))
    _, terms, tau = best
    if GAUSS_MARKOV in terms:
        step = np.log(taus[1] / taus[0])
        found = optimize.minimize_scalar(
            lambda log_tau: -_likelihood(chart, terms, np.exp(log_tau)),
            bounds=(max(np.log(tau) - step, np.log(taus[0])), np.log(tau) + step),
            method="bounded",
        )
        tau = float(np.exp(found.x))
    return _with_intervals(chart, terms, tau)


def _price(chart: Chart, terms: Sequence[Term]) -> float:
    """What the likelihood rises by chance at most when these terms are admitted.

    Each correlation time has a price of its own: a random walk is a Gauss-Markov process whose time has no end.
    """
    coefficients, time = (0.5 * float(stats.chi2.isf(CHANCE, n)) for n in (chart.variance.shape[1], 1))
    return len(terms) * coefficients + sum(term.timed for term in terms) * time


def _shapes(terms: Sequence[Term], time: np.ndarray, period: float, tau: float) -> np.ndarray:
    return np.stack([term.variance(time, period, tau) for term in terms], axis=1)


def _likelihood(chart: Chart, terms: Sequence[Term], tau: float) -> float:
    shapes = _shapes(terms, chart.time, chart.period, tau)
    return _log_density(chart, shapes @ _squares(chart, shapes))


def _log_density(chart: Chart, model: np.ndarray) -> float:
    """L of the module's docstring, all axes together."""
    return -0.5 * float(np.sum(chart.pairs[:, None] * (np.log(model) + chart.variance / model)))


def _squares(chart: Chart, shapes: np.ndarray) -> np.ndarray:
    """Squares of the coefficients (terms, axes) of the largest likelihood: Fisher's scoring, none below zero."""
    return np.stack([_scored(chart.pairs, shapes, variance) for variance in chart.variance.T], axis=1)


def _scored(pairs: np.ndarray, shapes: np.ndarray, variance: np.ndarray) -> np.ndarray:
    model, squares = variance, np.zeros(shapes.shape[1])
    for _ in range(_ROUNDS):
        weight = np.sqrt(pairs) / model
        weighted = shapes * weight[:, None]
        size = np.linalg.norm(weighted, axis=0)
        before, squares = squares, optimize.nnls(weighted / size, variance * weight)[0] / size
        model = shapes @ squares
        if np.allclose(squares, before, rtol=1e-5, atol=0.0):
            break
    return squares


def _with_intervals(chart: Chart, terms: tuple[Term, ...], tau: float) -> Identification:
    """Intervals of the logarithms of all coefficients and the correlation time together.

    By the information I of L and the covariance J of its slope, I^-1 J I^-1: L takes averaging times for independent
    and averages for such as do not overlap, J has them as they are.
    """
    shapes, timed = _shapes(terms, chart.time, chart.period, tau), GAUSS_MARKOV in terms
    squares = _squares(chart, shapes)
    model = shapes @ squares
    there = [(i, axis) for axis in range(squares.shape[1]) for i in range(len(terms)) if squares[i, axis] > 0.0]
    slopes = np.zeros((*model.shape, len(there) + timed))  # of log v by the logarithm of each
    for column, (i, axis) in enumerate(there):
        slopes[:, axis, column] = 2.0 * shapes[:, i] * squares[i, axis] / model[:, axis]
    if timed:
        step = 1e-4
        by_tau = (_gauss_markov(chart, tau, step) - _gauss_markov(chart, tau, -step)) / (2.0 * step)
        slopes[:, :, -1] = by_tau[:, None] * squares[terms.index(GAUSS_MARKOV)] / model
    information = 0.5 * np.einsum("tai,t,taj->ij", slopes, chart.pairs, slopes)
    frequency, _ = frequencies(chart)
    spectra = np.stack([term.spectrum(frequency, chart.period, tau) for term in terms], axis=1) @ squares
    still = shapes * [term is RAMP for term in terms] @ squares
    scores, inverse = np.zeros_like(information), np.linalg.pinv(information)
    for axis in range(squares.shape[1]):
        pull = 0.5 * chart.pairs[:, None] * slopes[:, axis]
        scores += pull.T @ covariance(chart, spectra[:, axis], model[:, axis], still[:, axis]) @ pull
    sigma = np.sqrt(np.diag(inverse @ scores @ inverse))
    factor = np.exp(np.minimum(stats.norm.isf(0.5 * (1.0 - CONFIDENCE)) * sigma, np.log(1e6)))
    coefficients, factors = np.sqrt(squares), np.full(squares.shape, np.nan)
    for (i, axis), one in zip(there, factor, strict=False):
        factors[i, axis] = one
    time = (tau, tau / float(factor[-1]), tau * float(factor[-1])) if timed else None
    return Identification(chart, terms, coefficients, coefficients / factors, coefficients * factors, time)


def _gauss_markov(chart: Chart, tau: float, step: float) -> np.ndarray:
    """Allan variance of a Gauss-Markov process whose correlation time is longer by the factor exp(step)."""
    return GAUSS_MARKOV.variance(chart.time, chart.period, tau * float(np.exp(step)))
