"""The delay at which velocities agree best with what the inertial unit carried, by least squares.

Velocities of a stretch of 20 s are v0 + g t + R (u + M b - S a) at t - delay (:mod:`.carried`): each stretch has a
velocity v0 and an attitude R of its own, so gyros need to hold an attitude for 20 s only; the biases a and b are of
all. Horizontal and vertical delays are two, since receivers make these velocities by different filters. The interval
is that of the scatter of stretches (the sandwich of White with a stretch as cluster), because jitter of stamps and
errors of gyros go on for longer than from one velocity to the next.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy import stats

from navfmu.calibration.delay.carried import Carried, carry, rotation, skew
from navfmu.constants import STANDARD_GRAVITY
from navfmu.errors import NavfmuError

LENGTH = 20.0
"""Of a stretch, s."""
FEWEST = 8
"""Velocities of a stretch, and stretches less 4."""
RANGE = (-0.5, 1.5)
"""Delays that are looked at, s."""
COARSE, FINE = 0.1, 0.05
MOVED = 2.0
"""Root mean square change of velocity, m/s, across that which is largest, with gravity, from which a stretch tells."""
PRIOR = np.array([0.1, 0.1, 0.1, 1.0, 1.0, 1.0])
"""Of the biases, rad/s and m/s2."""
SLOPE = 0.02
"""s before and after: the difference is the specific force."""
LEAST = 1e-3
"""Root mean square that is left, m/s, at least: of velocities without errors."""
SINGULAR = 1e-6
"""Of what a stretch has of its own, over the largest: less is not told by it."""
HALVED = 8
"""Times that a step is halved, at most."""
AXES = ("horizontal", "vertical")
LEVEL = 0.95


@dataclass
class Stretch:
    """Times (rows,), s, and ``velocity`` (rows, axes) of a part of a recording; ``attitude`` (3, 3) and ``start`` (3,),
    m/s, are found."""

    time: np.ndarray
    velocity: np.ndarray
    attitude: np.ndarray = field(default_factory=lambda: np.eye(3))
    start: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def fallen(self) -> np.ndarray:
        """Velocity less what gravity adds, (rows, 3), m/s; that down is taken for constant where it is not told."""
        down = np.zeros(len(self.time)) if self.velocity.shape[1] == 2 else self.velocity[:, 2]
        return np.column_stack([self.velocity[:, :2], down - STANDARD_GRAVITY * (self.time - self.time[0])])


@dataclass(frozen=True)
class Found:
    """``delay`` (axes,), s, of "horizontal" and, where it was told, "vertical", ``half`` its 95 % interval; ``left``
    (axes,) root mean squares, m/s, and those ``undelayed``; ``grid`` (points,), s, with ``misfit`` (points, axes)."""

    source: str
    stretches: int
    velocities: int
    delay: np.ndarray
    half: np.ndarray
    left: np.ndarray
    undelayed: np.ndarray
    grid: np.ndarray
    misfit: np.ndarray
    bias: np.ndarray
    sentences: tuple[str, ...] = ()

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of what has a delay."""
        return AXES[: len(self.delay)]


def determine(taken) -> Found:
    """The delay of a :class:`.recording.Recording`."""
    stretches, still = _stretches(taken)
    fit = _Fit(taken, stretches)
    grid = np.arange(RANGE[0], RANGE[1] + 0.5 * COARSE, COARSE)
    fit.solve(np.zeros(fit.axes), moving=False, times=6)
    fit.integrate()
    misfit = [fit.at(delay) for delay in grid]
    best = np.argmin(misfit, axis=0)
    if np.any(best == 0) or np.any(best == len(grid) - 1):
        raise NavfmuError(
            f"{taken.source}: velocities agree best with it at an end of {RANGE[0]:g} to {RANGE[1]:g} s; "
            "expected a delay within, files that count time from the same moment, and --axes of forward, right, down"
        )
    fit.align(grid[best])
    for _ in range(3):
        fit.solve(fit.delay, moving=True, times=5)
        fit.integrate()
        fit.sigma = np.maximum(fit.left(), LEAST)
    fit.solve(fit.delay, moving=True, times=3)
    half = fit.half()
    delay, left = fit.delay.copy(), fit.left()
    fine = np.arange(RANGE[0], RANGE[1] + 0.5 * FINE, FINE)
    chart = np.array([fit.at(value) for value in fine])
    told = (f"{still} of {still + len(stretches)} stretches of {LENGTH:g} s tell nothing: velocity hardly changes",)
    rows = sum(len(one.time) for one in stretches)
    return Found(
        taken.source, len(stretches), rows, delay, half, left, fit.at(0.0), fine, chart, fit.bias,
        (*taken.sentences, *(told if still else ())),
    )  # fmt: skip


def _stretches(taken) -> tuple[list[Stretch], int]:
    """Those that tell a delay, and how many do not."""
    first, last = taken.inertial[0] + RANGE[1], taken.inertial[-1] + RANGE[0]
    within = (taken.time >= first) & (taken.time <= last)
    if not np.any(within):
        raise NavfmuError(
            f"{taken.source}: no velocity is from {first:.1f} to {last:.1f} s, where there is the inertial unit; "
            "expected files that count time from the same moment"
        )
    time, velocity = taken.time[within], taken.velocity[within]
    number = np.floor((time - time[0]) / LENGTH).astype(int)
    all_ = [Stretch(time[number == n], velocity[number == n]) for n in np.unique(number)]
    whole = [one for one in all_ if len(one.time) >= FEWEST and one.time[-1] - one.time[0] > 0.5 * LENGTH]
    moved = [one for one in whole if _moves(one)]
    if len(whole) < FEWEST - 4:
        raise NavfmuError(
            f"{taken.source}: {time[-1] - time[0]:.0f} s with {len(time)} velocities are too short; expected "
            f"{FEWEST - 4} stretches of {LENGTH:g} s at least, with {FEWEST} velocities in each"
        )
    if len(moved) < FEWEST - 4:
        raise NavfmuError(
            f"{taken.source}: no motion tells a delay: velocity changes by {MOVED:g} m/s or more in {len(moved)} "
            f"stretches of {LENGTH:g} s; expected {FEWEST - 4} at least, with turns"
        )
    return moved, len(all_) - len(moved)


def _moves(one: Stretch) -> bool:
    spread = one.velocity[:, :2] - np.mean(one.velocity[:, :2], axis=0)
    return bool(np.linalg.norm(spread) / np.sqrt(len(spread)) >= MOVED)


class _Fit:
    def __init__(self, taken, stretches: list[Stretch]) -> None:
        self.taken, self.stretches = taken, stretches
        self.bias = np.zeros(6)
        self.columns = taken.velocity.shape[1]
        self.axes = min(self.columns - 1, 2)
        self.delay = np.zeros(self.axes)
        self.sigma = np.ones(self.axes)
        self.pieces: list[tuple[np.ndarray, np.ndarray]] = []
        self.integrate()
        self.align(self.delay)

    def align(self, delay: np.ndarray) -> None:
        """Begin anew at a ``delay`` (axes,), s, with attitudes in closed form."""
        self.delay = np.array(delay, dtype=float)
        for one in self.stretches:
            u, bent, turned = self.carried.at(one.time - self.delay[0], one.time[0])
            u = u + np.concatenate([bent, -turned], axis=-1) @ (self.bias - self.taken_off)
            one.attitude = _turn(u, one.fallen)
            one.start = np.mean(one.fallen - u @ one.attitude.T, axis=0)

    def at(self, delay: float) -> np.ndarray:
        """What is left (axes,), m/s, at a ``delay``, s, of all axes, with the biases that are known."""
        self.align(np.full(self.axes, delay))
        self.solve(self.delay, moving=False, times=5)
        return self.left()

    def integrate(self) -> None:
        """Anew with the biases that were found, of which only what is left is then of first order."""
        bias, taken = self.bias, self.taken
        self.carried: Carried = carry(taken.inertial, taken.rate - bias[:3], taken.specific_force - bias[3:])
        self.taken_off = bias.copy()

    def solve(self, delay: np.ndarray, moving: bool, times: int) -> None:
        """Gauss and Newton from ``delay`` on, which is held unless it is ``moving``; steps that lead up are halved."""
        self.delay = np.array(delay, dtype=float)
        free = np.arange(6 + self.axes) < (6 + self.axes if moving else 6)
        for _ in range(times):
            pieces = [self._piece(one) for one in self.stretches]
            normal, right = np.diag(np.concatenate([PRIOR**-2, np.zeros(self.axes)])), np.zeros(6 + self.axes)
            right[:6] = -self.bias / PRIOR**2
            self.reduced = []
            for residual, own, common in pieces:
                basis, size, _ = np.linalg.svd(own, full_matrices=False)
                basis = basis[:, size > SINGULAR * size[0]]
                common = common - basis @ (basis.T @ common)
                self.reduced.append((common, residual - basis @ (basis.T @ residual)))
                normal += common.T @ common
                right += common.T @ residual
            self.normal = normal
            change = np.zeros(6 + self.axes)
            change[free] = np.linalg.solve(normal[np.ix_(free, free)], right[free])
            own_changes = [
                np.linalg.lstsq(own, residual - common @ change, rcond=SINGULAR)[0] for residual, own, common in pieces
            ]
            self._step(change, own_changes)

    def _step(self, change: np.ndarray, own_changes: list[np.ndarray]) -> None:
        """Take as much of a step as leads down."""
        before = self.bias, self.delay, [(one.start, one.attitude) for one in self.stretches]
        cost = self._cost()
        for part in 0.5 ** np.arange(HALVED):
            self.bias = before[0] + part * change[:6]
            self.delay = np.clip(before[1] + part * change[6:], *RANGE)
            for one, (start, attitude), mine in zip(self.stretches, before[2], own_changes, strict=True):
                one.start, one.attitude = start + part * mine[:3], rotation(part * mine[3:]) @ attitude
            if self._cost() <= cost:
                return
        self.bias, self.delay = before[:2]
        for one, (start, attitude) in zip(self.stretches, before[2], strict=True):
            one.start, one.attitude = start, attitude

    def _cost(self) -> float:
        of_data = sum(np.sum((self._residual(one) / self._sigmas()) ** 2) for one in self.stretches)
        return float(of_data + np.sum((self.bias / PRIOR) ** 2))

    def _predicted(self, one: Stretch, shift: float = 0.0):
        """Velocity (rows, 3), what of it turns with the attitude, and its derivatives by the biases (rows, 3, 6)."""
        parts = []
        for delay in self.delay:
            u, bent, turned = self.carried.at(one.time - delay + shift, one.time[0])
            by_bias = np.concatenate([bent, -turned], axis=-1)
            u = u + by_bias @ (self.bias - self.taken_off)
            parts.append((u @ one.attitude.T, one.attitude @ by_bias))
        horizontal, vertical = parts[0], parts[-1]
        return [np.concatenate([h[:, :2], v[:, 2:]], axis=1) for h, v in zip(horizontal, vertical, strict=True)]

    def _residual(self, one: Stretch) -> np.ndarray:
        turned, _ = self._predicted(one)
        return (one.fallen - one.start - turned)[:, : self.columns]

    def _piece(self, one: Stretch):
        """Residuals, derivatives by what is the stretch's own, and by what is common; over their sigma, in rows."""
        turned, by_bias = self._predicted(one)
        later, earlier = self._predicted(one, -SLOPE)[0], self._predicted(one, SLOPE)[0]
        by_delay = (later - earlier) / (2.0 * SLOPE)
        rows = len(one.time)
        of_axis = np.zeros((rows, 3, self.axes))
        of_axis[:, :2, 0] = by_delay[:, :2]
        of_axis[:, 2, -1] = by_delay[:, 2]
        own = np.concatenate([np.broadcast_to(np.eye(3), (rows, 3, 3)), -skew(turned)], axis=-1)
        sigma = self._sigmas()
        common = np.concatenate([by_bias, of_axis], axis=-1)
        return (
            (self._residual(one) / sigma).ravel(),
            (own[:, : self.columns] / sigma[:, None]).reshape(-1, 6),
            (common[:, : self.columns] / sigma[:, None]).reshape(-1, 6 + self.axes),
        )

    def _sigmas(self) -> np.ndarray:
        return np.array([self.sigma[0], self.sigma[0], self.sigma[-1]])[: self.columns]

    def left(self) -> np.ndarray:
        """Root mean square residual of each kind of axis, m/s."""
        residual = np.concatenate([self._residual(one) for one in self.stretches])
        parts = (residual[:, :2], residual[:, 2:])[: self.axes]
        return np.array([np.sqrt(np.mean(part * part)) for part in parts])

    def half(self) -> np.ndarray:
        """Half of the interval of each delay, s."""
        scores = np.array([common.T @ residual for common, residual in self.reduced])
        inverse = np.linalg.inv(self.normal)
        count = len(scores)
        rows = sum(len(residual) for _, residual in self.reduced)
        more = count / (count - 1.0) * rows / max(rows - 6.0 * count - 6.0 - self.axes, 1.0)
        sandwich = more * inverse @ (scores.T @ scores) @ inverse
        return stats.t.isf(0.5 * (1.0 - LEVEL), count - 1) * np.sqrt(np.diag(sandwich)[6:])


def _turn(inertial: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """The rotation (3, 3) that turns the first vectors (rows, 3) best into the second, less their means: Kabsch."""
    product = (velocity - velocity.mean(axis=0)).T @ (inertial - inertial.mean(axis=0))
    left, _, right = np.linalg.svd(product)
    return left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
