"""A recorded inertial measurement unit at rest: its quiet stretches, their Allan deviation, and a model made of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import allantools
import numpy as np
import pandas as pd
from scipy import optimize

from navfmu import System
from navfmu.calibration.allan.chart import chart
from navfmu.calibration.allan.identification import Identification, identify
from navfmu.calibration.allan.sensor import ACCELEROMETER, GYRO, Sensor
from navfmu.calibration.allan.stretches import quiet
from navfmu.calibration.allan.terms import gauss_markov
from navfmu.system import shipped

GYROS, ACCELEROMETERS = (tuple(f"{name}_{axis}" for axis in "xyz") for name in ("rate", "specific_force"))
COLUMNS = (*GYROS, *ACCELEROMETERS)

CLUSTERS = 5
"""Least number of averages that a stretch must hold at the longest averaging time."""


def deviation(stretches: Sequence[np.ndarray], period: float, times: np.ndarray) -> np.ndarray:
    """Overlapping Allan deviations at averaging ``times`` that are multiples of ``period``, over all stretches.

    ``stretches`` are samples of shape (n, axes); the result is of shape (times, axes). Each stretch counts as often as
    it has pairs of averages.
    """
    total, pairs = np.zeros((len(times), stretches[0].shape[1])), np.zeros((len(times), 1))
    for samples in stretches:
        long = times <= len(samples) * period / CLUSTERS
        for axis, values in enumerate(samples.T):
            _, found, _, counts = allantools.oadev(values, 1.0 / period, "freq", times[long])
            total[long, axis] += counts * found**2
        pairs[long, 0] += counts
    return np.sqrt(total / pairs)


@dataclass(frozen=True)
class Rest:
    """What a unit gave at rest: the quiet stretches, (n, 6) each, rad/s and m/s2.

    Averages over less than ``shortest`` s tell of something else than the unit.
    """

    name: str
    period: float
    stretches: tuple[np.ndarray, ...]
    shortest: float = 0.0

    @cached_property
    def times(self) -> np.ndarray:
        """Averaging times, s: a third of a decade apart, as far as half of the stretches carry."""
        longest = int(np.median([len(stretch) for stretch in self.stretches])) // CLUSTERS
        return np.unique(np.round(np.geomspace(1, longest, 1 + int(3 * np.log10(longest)))).astype(int)) * self.period

    @cached_property
    def deviation(self) -> np.ndarray:
        """Allan deviations, (times, 6)."""
        return deviation(self.stretches, self.period, self.times)

    @property
    def told(self) -> np.ndarray:
        """Which averaging times tell of the unit."""
        return self.times >= self.shortest

    @property
    def seconds(self) -> float:
        """Length of all stretches together."""
        return sum(map(len, self.stretches)) * self.period

    @cached_property
    def parameters(self) -> dict[str, np.ndarray | float]:
        """Parameters of ``imu`` with the same Allan deviation: white noise, and a drift where there is more than that.

        Per triad and for every correlation time of a grid, variances of noise and drift (not negative) are fitted to
        the Allan variances, whose relative errors go with the root of the averaging time; the time with the least
        misfit is taken. A unit that lies still does not tell null shifts from the level of the ground: they are left
        out.
        """
        found: dict[str, np.ndarray | float] = {
            "sample_period": self.period,
            "drift_period": self.period,
            "misalignment_sigma": np.zeros(3),
        }
        for name, axes in (("gyro", slice(0, 3)), ("accelerometer", slice(3, 6))):
            time, noise, drift = _fit(self.times[self.told], self.deviation[self.told, axes] ** 2, self.period)
            found |= {
                f"{name}_noise_sigma": noise,
                f"{name}_drift_sigma": drift,
                f"{name}_drift_time": time,
                f"{name}_null_shift_sigma": np.zeros(3),
                f"{name}_scale_factor_sigma": np.zeros(3),
            }
        return found

    @cached_property
    def identified(self) -> dict[Sensor, Identification]:
        """The error terms of gyros and accelerometers, as ``navfmu allan`` tells them."""
        return {
            sensor: identify(chart([part[:, axes] for part in self.stretches], self.period).beyond(self.shortest))
            for sensor, axes in ((GYRO, slice(0, 3)), (ACCELEROMETER, slice(3, 6)))
        }

    @property
    def halves(self) -> tuple[Rest, Rest]:
        """The first, third ... stretches, and the second, fourth ..."""
        first, second = (Rest(self.name, self.period, self.stretches[i::2], self.shortest) for i in (0, 1))
        return first, second

    def modelled(self, seed: int, parameters: Mapping[str, np.ndarray | float]) -> Rest:
        """The same stretches of an ``imu`` with the ``parameters`` that lies still, all from one run."""
        ends = np.cumsum([len(stretch) for stretch in self.stretches])
        run = System.load(shipped.path("imu.fmu")).run(
            stop=float(ends[-1]) * self.period,
            step=self.period,
            seed=seed,
            parameters={f"imu.{name}": value for name, value in parameters.items()},
            record=["imu.reading.rate", "imu.reading.specific_force"],
            record_period=self.period,
        )
        samples = run.to_numpy()[1:]  # the first row stands before the first sample
        return Rest(self.name, self.period, tuple(np.split(samples, ends[:-1])), self.shortest)

    @classmethod
    def of(cls, name: str, recordings: Sequence[pd.DataFrame], shortest: float = 0.0) -> Rest:
        """The quiet stretches of recordings of one kind of unit, at its median period to a hundredth of a percent."""
        period = float(np.format_float_positional(np.median(np.diff(recordings[0]["time"])), 4, fractional=False))
        stretches = [
            samples[rows]
            for samples in (recording[list(COLUMNS)].to_numpy() for recording in recordings)
            for rows in quiet(samples, period)
        ]
        return cls(name, period, tuple(stretches), shortest)


def _fit(times: np.ndarray, variance: np.ndarray, period: float) -> tuple[float, np.ndarray, np.ndarray]:
    best = (np.inf, 1.0, np.zeros(3), np.zeros(3))
    for time in np.geomspace(1.0, max(2.0, times[-1]), 20):
        parts = np.stack([period / times, gauss_markov(times, time)], axis=1)
        weight = 1.0 / np.sqrt(times)
        solved = [optimize.nnls(parts * (weight / v)[:, None], weight) for v in variance.T]
        misfit = sum(residual**2 for _, residual in solved)
        if misfit < best[0]:
            noise, drift = np.sqrt(np.array([x for x, _ in solved]).T)
            best = (misfit, float(time), noise, drift)
    return best[1:]
