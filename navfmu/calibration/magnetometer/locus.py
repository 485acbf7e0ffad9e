"""The surface on which measured fields lie while a triad is turned in a field of constant strength.

Errorless fields lie on a sphere, in the plane on a circle, thesis (3.56), (3.65). A triad makes of it an ellipsoid,

    m = c + P^-1 B,   |B| = F,                                                            (3.28), without noise

with the centre c, its hard iron as measured, and a symmetric matrix P, its gains, of as many unknowns as a family of
loci has. A rotation between the triad and the body leaves the locus as it is: it is not told by the field alone.

What is made least is the distance of the samples from the surface, in the units in which they were measured,

    d = (|P (m - c)| - F - b) / |P u|,   u = P (m - c) / |P (m - c)|,   b = sigma^2 (tr P^2 - |P u|^2) / (2 F).

The thesis's cost, the same without the denominator, is least for gains that make all fields short: from a strip of the
sphere that are an ellipsoid without end, which fits better than the true one. b is what noise across adds to a length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

STEPS = 100
"""Of Gauss and Newton, at most: where gains are left out of a surface they become shorter slowly."""
SMALL = 1e-8
"""Change of the parameters, in field strengths, at which a fit has come to its end."""
SETTLED = 1e-6
"""So is one whose next step changes nothing by more than this, a thousandth of a sigma, squared."""
UNTOLD = 0.01
"""Standard deviation of gains and soft iron for which it is said what they do where they are not told."""
FEW = 1000
"""Samples among which a fit finds its way, before all are taken."""


@dataclass(frozen=True)
class Family:
    """Loci of one kind; ``gains(axes)`` are the matrices (unknowns, axes, axes) whose sum P is, beside ``fixed`` I."""

    name: str
    text: str
    gains: Callable[[int], np.ndarray]
    fixed: float = 0.0

    def matrix(self, theta: np.ndarray, axes: int) -> np.ndarray:
        """P, (axes, axes), of its unknowns (unknowns,)."""
        bases = self.gains(axes)
        return sum((t * base for t, base in zip(theta, bases, strict=True)), self.fixed * np.eye(axes))

    def unknowns(self, matrix: np.ndarray) -> np.ndarray:
        """The unknowns of the matrix of this family that is next to ``matrix``."""
        bases = self.gains(len(matrix))
        size = np.sum(bases**2, axis=(1, 2))
        return np.sum(bases * (matrix - self.fixed * np.eye(len(matrix))), axis=(1, 2)) / size


def _single(axes: int) -> np.ndarray:
    return np.eye(axes)[None]


def _diagonal(axes: int) -> np.ndarray:
    return np.stack([np.diag(row) for row in np.eye(axes)])


def _symmetric(axes: int) -> np.ndarray:
    pairs = [(i, j) for i in range(axes) for j in range(i + 1, axes)]
    across = np.zeros((len(pairs), axes, axes))
    for number, (i, j) in enumerate(pairs):
        across[number, i, j] = across[number, j, i] = 1.0
    return np.concatenate([_diagonal(axes), across])


HARD_IRON = Family("hard-iron", "hard iron, with gains of 1", lambda axes: np.zeros((0, axes, axes)), 1.0)
SPHERE = Family("sphere", "hard iron and one gain", _single)
AXES = Family("axes", "hard iron and a gain for each axis, (3.65)", _diagonal)
ELLIPSOID = Family("ellipsoid", "hard iron, gains and soft iron", _symmetric)
FAMILIES = (ELLIPSOID, AXES, SPHERE, HARD_IRON)
"""From the most unknowns to the fewest."""


@dataclass(frozen=True)
class Locus:
    """A fitted surface.

    ``centre`` (axes,) c, T, and ``matrix`` (axes, axes) P, 1; ``field`` F, T; ``distance`` (samples,) d, T;
    ``covariance`` of c and of the unknowns of P, in that order; ``correlation``: so many samples are as good as one,
    by how the distances go together.
    """

    family: Family
    field: float
    centre: np.ndarray
    matrix: np.ndarray
    distance: np.ndarray
    covariance: np.ndarray
    correlation: float

    @property
    def sigma(self) -> float:
        """Root mean square of the distances, of as many as are free, T."""
        return float(np.sqrt(np.sum(self.distance**2) / max(1, len(self.distance) - len(self.covariance))))

    def of_mean_gain(self) -> Locus:
        """The same surface with a strength of the field such that the gains are 1 in the mean: det P = 1."""
        axes, bases = len(self.centre), self.family.gains(len(self.centre))
        gain = float(np.linalg.det(self.matrix)) ** (1.0 / axes)
        slope = np.einsum("ij,kji->k", np.linalg.inv(self.matrix), bases) / axes  # of log gain
        to_mean = np.eye(len(self.covariance))
        to_mean[axes:, axes:] -= np.outer(self.family.unknowns(self.matrix), slope)
        to_mean[axes:] /= gain
        covariance = to_mean @ self.covariance @ to_mean.T
        return replace(self, field=self.field / gain, matrix=self.matrix / gain, covariance=covariance)

    def corrected(self, measured: np.ndarray) -> np.ndarray:
        """Fields (samples, axes), T, of measured ones."""
        return (measured - self.centre) @ self.matrix

    def errors(self, directions: np.ndarray) -> np.ndarray:
        """Largest standard deviation of a corrected field along any axis, T, for true ``directions`` (n, axes).

        dB = dP P^-1 B - P dc.
        """
        axes = len(self.centre)
        measured = self.field * np.linalg.solve(self.matrix, directions.T)
        turned = [(base @ measured).T for base in self.family.gains(axes)]
        slopes = np.stack([*np.broadcast_to(-self.matrix[:, None], (axes, len(directions), axes)), *turned], axis=-1)
        covariance = slopes @ self.covariance @ slopes.transpose(0, 2, 1)
        return np.sqrt(np.linalg.eigvalsh(covariance)[:, -1])


def fit(family: Family, measured: np.ndarray, field: float) -> Locus | None:
    """The surface of a family next to measured fields (samples, axes), T, or None where none is found.

    Starts are the sphere by linear least squares, about |m|^2 = 2 c' m + k, and the ellipsoid by (3.70).
    """
    scaled = measured / field
    some = scaled[:: 1 + len(scaled) // FEW]
    found = [_descend(family, some, start, 0.0) for start in _starts(family, scaled)]
    found = [one for one in found if one is not None]
    if not found:
        return None
    x = min(found, key=lambda one: float(np.sum(distances(one, family, some, 0.0) ** 2)))
    return _nearest(family, x, measured, field)


def from_start(locus: Locus, centre: np.ndarray, measured: np.ndarray) -> Locus | None:
    """The surface that lies next to the fields around another ``centre`` (axes,), T, or None where none is found."""
    x = np.concatenate([centre / locus.field, locus.family.unknowns(locus.matrix)])
    some = measured[:: 1 + len(measured) // FEW] / locus.field
    x = _descend(locus.family, some, x, 0.0)
    return None if x is None else _nearest(locus.family, x, measured, locus.field)


def _nearest(family: Family, x: np.ndarray, measured: np.ndarray, field: float) -> Locus | None:
    """The surface from where a fit to some of the samples has ended."""
    scaled = measured / field
    sigma = float(np.sqrt(np.mean(distances(x, family, scaled[:: 1 + len(scaled) // FEW], 0.0) ** 2)))
    x = _descend(family, scaled, x, sigma)
    if x is None:
        return None
    axes = measured.shape[1]
    positive = family.unknowns(_positive(family.matrix(x[axes:], axes)))
    return _there(family, np.concatenate([x[:axes], positive]), measured, field, sigma)


def _positive(matrix: np.ndarray) -> np.ndarray:
    """Of all symmetric P of one surface, |P v|^2 = v' P^2 v, the one that mirrors nothing."""
    gains, axes = np.linalg.eigh(matrix)
    return axes @ np.diag(np.abs(gains)) @ axes.T


def member(family: Family, other: Locus, measured: np.ndarray) -> Locus:
    """A surface of a smaller family as one of a larger: what errors that one would have if it were the truth."""
    x = np.concatenate([other.centre / other.field, family.unknowns(other.matrix)])
    return _there(family, x, measured, other.field, other.sigma / other.field)


def with_untold(locus: Locus, measured: np.ndarray) -> Locus:
    """The surface as an ellipsoid whose covariance is what gains and soft iron do that its family leaves out, each of
    them wrong by UNTOLD and independent of the others: they go into what is found, and stay in what is corrected."""
    axes, bases = len(locus.centre), locus.family.gains(len(locus.centre))
    x = np.concatenate([locus.centre / locus.field, ELLIPSOID.unknowns(locus.matrix)])
    _, slopes = distances_and_slopes(x, ELLIPSOID, measured / locus.field, 0.0)
    found = np.zeros((len(x), axes + len(bases)))  # what the family finds, as unknowns of the ellipsoid
    found[:axes, :axes] = np.eye(axes)
    found[axes:, axes:] = np.reshape([ELLIPSOID.unknowns(base) for base in bases], (len(bases), len(x) - axes)).T
    wrong = (found @ np.linalg.pinv(slopes @ found) @ slopes - np.eye(len(x)))[:, axes:] * UNTOLD
    wrong[:axes] *= locus.field
    return replace(locus, family=ELLIPSOID, covariance=wrong @ wrong.T)


def _there(family: Family, x: np.ndarray, measured: np.ndarray, field: float, sigma: float) -> Locus:
    distance, slopes = distances_and_slopes(x, family, measured / field, sigma)
    spread = np.sum(distance**2) / max(1, len(distance) - len(x)) * np.linalg.pinv(slopes.T @ slopes, hermitian=True)
    return of_unknowns(family, x, spread, measured, field)


def of_unknowns(family: Family, x: np.ndarray, spread: np.ndarray, measured: np.ndarray, field: float) -> Locus:
    """The surface whose centre over the field strength, and whose gains, are ``x``.

    ``spread`` is the covariance that they had if the samples were independent of each other.
    """
    axes = measured.shape[1]
    distance = distances(x, family, measured / field, 0.0)
    together = as_one(distance)
    scale = np.concatenate([np.full(axes, field), np.ones(len(x) - axes)])
    covariance = spread * together * np.outer(scale, scale)
    return Locus(family, field, field * x[:axes], family.matrix(x[axes:], axes), field * distance, covariance, together)


def distances(x: np.ndarray, family: Family, scaled: np.ndarray, sigma: float) -> np.ndarray:
    """d (samples,) of the docstring above, all over the field strength; x is c and the unknowns of P."""
    axes = scaled.shape[1]
    matrix = family.matrix(x[axes:], axes)
    field = (scaled - x[:axes]) @ matrix
    length = np.sqrt(np.sum(field**2, axis=1))
    along = np.sum((field @ matrix) ** 2, axis=1) / length**2
    bias = 0.5 * sigma**2 * (np.sum(matrix**2) - along)
    return (length - 1.0 - bias) / np.sqrt(along)


def distances_and_slopes(x: np.ndarray, family: Family, scaled: np.ndarray, sigma: float):
    """:func:`distances` and their derivatives (samples, unknowns), for thousands of samples at once."""
    axes = scaled.shape[1]
    bases, matrix = family.gains(axes), family.matrix(x[axes:], axes)
    turned = np.concatenate([np.zeros((axes, axes, axes)), bases])  # dP by each unknown
    from_centre = scaled - x[:axes]
    field = from_centre @ matrix
    by_field = np.einsum("ni,kij->nkj", from_centre, turned)
    by_field[:, :axes] -= matrix
    length = np.sqrt(np.sum(field**2, axis=1))
    by_length = np.einsum("nj,nkj->nk", field, by_field) / length[:, None]
    across = field @ matrix
    by_across = np.einsum("ni,kij->nkj", field, turned) + by_field @ matrix
    along = np.sum(across**2, axis=1) / length**2
    by_along = 2.0 * np.einsum("nj,nkj->nk", across, by_across) / length[:, None] ** 2
    by_along -= 2.0 * (along / length)[:, None] * by_length
    bias = 0.5 * sigma**2 * (np.sum(matrix**2) - along)
    by_bias = 0.5 * sigma**2 * (2.0 * np.einsum("ij,kij->k", matrix, turned) - by_along)
    found = (length - 1.0 - bias) / np.sqrt(along)
    return found, (by_length - by_bias) / np.sqrt(along)[:, None] - (0.5 * found / along)[:, None] * by_along


def _starts(family: Family, scaled: np.ndarray) -> list[np.ndarray]:
    axes = scaled.shape[1]
    design = np.hstack([2.0 * scaled, np.ones((len(scaled), 1))])
    solution = np.linalg.lstsq(design, np.sum(scaled**2, axis=1), rcond=None)[0]
    radius = np.sqrt(max(solution[axes] + np.sum(solution[:axes] ** 2), 1e-6))
    starts = [(solution[:axes], np.eye(axes) / radius)]
    others = np.hstack([-2.0 * scaled[:, :1], *(np.stack([m**2, -2.0 * m], axis=1) for m in scaled.T[1:])])
    others = np.hstack([others, np.ones((len(scaled), 1))])
    first = np.linalg.lstsq(others, -(scaled[:, 0] ** 2), rcond=None)[0]
    ratio = np.concatenate([[1.0], first[1:-1:2]])
    if np.all(ratio > 0.0):
        centre = np.concatenate([first[:1], first[2:-1:2] / ratio[1:]])
        k1 = np.sum(ratio * centre**2) - first[-1]
        if k1 > 0.0:
            starts.append((centre, np.diag(np.sqrt(ratio / k1))))
    return [np.concatenate([centre, family.unknowns(matrix)]) for centre, matrix in starts]


def _descend(family: Family, scaled: np.ndarray, x: np.ndarray, sigma: float) -> np.ndarray | None:
    """Steps of Gauss and Newton, halved where they would lead uphill."""
    distance, slopes = distances_and_slopes(x, family, scaled, sigma)
    for _ in range(STEPS):
        if not np.all(np.isfinite(slopes)):
            return None
        step = -np.linalg.lstsq(slopes, distance, rcond=None)[0]
        share, cost = 1.0, float(distance @ distance)
        if float(np.sum((slopes @ step) ** 2)) < SETTLED * cost / len(distance):
            return x
        while not float(np.sum(distances(x + share * step, family, scaled, sigma) ** 2)) <= cost:
            share *= 0.5
            if share * float(np.max(np.abs(step))) < SMALL:
                return x
        x = x + share * step
        if share * float(np.max(np.abs(step))) < SMALL:
            return x
        distance, slopes = distances_and_slopes(x, family, scaled, sigma)
    return None


def as_one(distance: np.ndarray) -> float:
    """How many of these (samples,) are as good as one, 1 for white noise: the sum of the autocorrelation over all lags
    until pairs of it are none (Geyer, 1992)."""
    n = len(distance)
    spectrum = np.abs(np.fft.rfft(distance - np.mean(distance), 2 * n)) ** 2
    shares = np.fft.irfft(spectrum)[:n]
    if not shares[0] > 0.0:
        return 1.0
    pairs = shares[1 : 2 * ((n - 1) // 2) + 1].reshape(-1, 2).sum(axis=1) / shares[0]
    none = np.flatnonzero(pairs < 3.0 / np.sqrt(n))
    return float(1.0 + 2.0 * np.sum(pairs[: none[0] if len(none) else len(pairs)]))
