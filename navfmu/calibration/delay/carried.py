"""What an inertial unit tells of velocity without an attitude: integrals in the frame it had at the first sample.

With C from the body to that frame, by the gyros alone, velocity in n is v0 + g t + R u, u the integral of C f, and R
the attitude of that frame, which is not known. Biases of gyros b and accelerometers a change u to first order by M b
- S a:

    S = integral of C,    M = integral of [C f]x S
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Carried:
    """At the ``time`` (samples,) of an inertial unit, s: ``sums`` (samples, 21), u, m/s, and the rows of S and M."""

    time: np.ndarray
    sums: np.ndarray

    def at(self, moments: np.ndarray, start: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """u, M and S since ``start`` at ``moments`` (rows,), s; in shapes (rows, 3) and (rows, 3, 3)."""
        both = np.concatenate([[start], moments])
        at = np.clip(np.searchsorted(self.time, both) - 1, 0, len(self.time) - 2)
        part = (both - self.time[at]) / (self.time[at + 1] - self.time[at])
        found = self.sums[at] + part[:, None] * (self.sums[at + 1] - self.sums[at])
        gone = found[1:] - found[0]
        u, s, m = gone[:, :3], gone[:, 3:12].reshape(-1, 3, 3), gone[:, 12:].reshape(-1, 3, 3)
        return u, m - skew(u) @ found[0, 3:12].reshape(3, 3), s


def skew(vectors: np.ndarray) -> np.ndarray:
    """Matrices [v]x (..., 3, 3) of vectors (..., 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    none = np.zeros_like(x)
    rows = [np.stack(row, axis=-1) for row in ((none, -z, y), (z, none, -x), (-y, x, none))]
    return np.stack(rows, axis=-2)


def rotation(vectors: np.ndarray) -> np.ndarray:
    """Matrices (..., 3, 3) that turn by rotation vectors (..., 3), rad: Rodrigues."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    turned = skew(vectors)
    return np.eye(3) + np.sinc(angle / np.pi) * turned + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * (turned @ turned)


def carry(time: np.ndarray, rate: np.ndarray, specific_force: np.ndarray) -> Carried:
    """Integrate ``rate`` (samples, 3), rad/s, and ``specific_force``, m/s2, by the trapezoidal rule."""
    interval = np.diff(time)
    steps = rotation(0.5 * (rate[1:] + rate[:-1]) * interval[:, None])
    attitude = np.empty((len(time), 3, 3))
    attitude[0] = np.eye(3)
    for i, step in enumerate(steps):
        attitude[i + 1] = attitude[i] @ step
    force = (attitude @ specific_force[..., None])[..., 0]
    turned = _summed(interval, attitude)
    parts = _summed(interval, force), turned, _summed(interval, skew(force) @ turned)
    return Carried(time, np.concatenate([part.reshape(len(time), -1) for part in parts], axis=1))


def _summed(interval: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Integral of ``values`` (samples, ...) from the first sample to each."""
    mean = 0.5 * (values[1:] + values[:-1])
    parts = interval.reshape(-1, *(1 for _ in values.shape[1:])) * mean
    return np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(parts, axis=0)])
