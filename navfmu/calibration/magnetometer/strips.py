"""The simulations of thesis Table 3.3: two estimators on strips of the sphere, of 10 and 20 degrees, many times.

A strip lies around the plane of x and y, Fig 3.19. What the thesis does not say is chosen: 4000 samples, 200 s of
20 Hz, at random; the strength of the field, 0.5 G, is that of its Fig 3.17. A run's numbers follow from the seed, the
case and the run alone, so the table is the same in whatever order and by however many processes it is made.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np

from navfmu.calibration.magnetometer.batch import iterate
from navfmu.calibration.magnetometer.two_step import first_step, second_step

GAUSS = 1e-4
"""T."""
FIELD = 0.5 * GAUSS
CENTRE = np.array([1.0, 2.0, -3.0]) * GAUSS
SCALE = np.array([4.0, 3.0, 2.0])
"""1 + s."""
START = 0.5
"""Standard deviation of the first guess: gauss of the centre, 1 of the scale factors."""
SAMPLES = 4000
RUNS = 1000


@dataclass(frozen=True)
class Case:
    """A row of Table 3.3: ``strip`` in degrees, ``noise`` in mG."""

    name: str
    strip: float
    noise: float


CASES = (Case("I", 10.0, 1.0), Case("II", 20.0, 1.0), Case("III", 10.0, 5.0), Case("IV", 20.0, 5.0))


@dataclass(frozen=True)
class Runs:
    """Errors of both estimators, (runs, 6): centre in T and 1 + s, NaN where one diverged."""

    case: Case
    two_step: np.ndarray
    batch: np.ndarray

    @property
    def diverged(self) -> tuple[float, float]:
        """Share of the runs in which the two steps, and the batch, diverged."""
        return tuple(float(np.mean(np.isnan(errors[:, 0]))) for errors in (self.two_step, self.batch))

    def largest(self) -> np.ndarray:
        """Largest errors of the two steps' centre, (3,), T."""
        return np.max(np.abs(self.two_step[:, :3]), axis=0)


def table(runs: int = RUNS, seed: int = 0, jobs: int = 1, start: float = START) -> Sequence[Runs]:
    """The four cases, each flown ``runs`` times, by ``jobs`` processes; ``start`` scatters the batch's first guess."""
    asked = [(case, run) for case in range(len(CASES)) for run in range(runs)]
    once = partial(errors, seed=seed, start=start)
    if jobs == 1:
        found = list(map(once, *zip(*asked, strict=True)))
    else:
        with ProcessPoolExecutor(jobs) as pool:
            found = list(pool.map(once, *zip(*asked, strict=True), chunksize=max(1, runs // (4 * jobs))))
    both = np.array(found).reshape(len(CASES), runs, 2, 6)
    return [Runs(case, *one.transpose(1, 0, 2)) for case, one in zip(CASES, both, strict=True)]


def errors(case: int, run: int, seed: int = 0, start: float = START) -> np.ndarray:
    """Errors (2, 6) of the two steps and of the batch in one run of a case, counted from 0."""
    rng = np.random.default_rng([seed, case, run])
    scaled = measured(CASES[case], rng) / FIELD
    truth = np.concatenate([CENTRE / FIELD, SCALE])
    guess = truth + start * np.concatenate([np.full(3, GAUSS / FIELD), np.ones(3)]) * rng.standard_normal(6)
    with np.errstate(invalid="ignore", divide="ignore"):
        steps = second_step(first_step(scaled)[0], 1.0)
    end = iterate(scaled, guess)
    ends = np.full(6, np.nan) if end is None else np.concatenate([end[:3], np.abs(end[3:])])
    scale = np.concatenate([np.full(3, FIELD), np.ones(3)])
    return scale * (np.stack([steps if np.all(np.isfinite(steps)) else np.full(6, np.nan), ends]) - truth)


def measured(case: Case, rng: np.random.Generator) -> np.ndarray:
    """Fields (SAMPLES, 3), T: (3.65) with noise."""
    latitude = np.radians(case.strip) * (rng.random(SAMPLES) - 0.5)
    turn = 2.0 * np.pi * rng.random(SAMPLES)
    level = np.cos(latitude)
    direction = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(latitude)], axis=1)
    return CENTRE + SCALE * FIELD * direction + 1e-3 * GAUSS * case.noise * rng.standard_normal((SAMPLES, 3))
