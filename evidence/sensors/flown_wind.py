"""What the FMU ``wind`` does alone, and what its shear does to dead reckoning, with the closed forms for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fmus.grades import TURBULENCE
from navfmu import System
from navfmu.faults import Fault
from navfmu.system import shipped

SPEED, LENGTH = 50.0, 533.4
"""Airspeed, m/s, and scale of turbulence above 2000 ft, m."""
PERIOD, LINES, STRETCHES = 0.1, 1024, 400
"""Of the samples whose spectra are taken: s, samples of a stretch, stretches."""
FREQUENCY = np.arange(2, LINES // 2, 2) / (LINES * PERIOD)
"""Hz; every other line of a Hann window, which are as good as independent."""
FLIGHTS = {"at rest": (0.0, 0.0, 0.0), "north": (50.0, 0.0, 0.0), "north-east, climbing": (40.0, 30.0, -5.0)}
"""Velocities by what they are called."""
RATIOS = (1.0, np.sqrt(2.0), 2.0)
"""Their travelling time per time, thesis (3.35)."""
STEP, SECONDS = 10.0, 200e3
"""Between samples of the wander, and of each flight."""
LAGS = np.arange(1, 121)
"""Samples between which it is correlated."""
HEIGHTS = np.array([0.0, 3.0, 10.0, 30.0, 60.0, 100.0, 150.0, 200.0, 274.0, 300.0, 400.0])
"""Above the ground, of the profile, m."""
DISTANCE = np.arange(501.0) - 100.0
"""Behind the front of a gust, m."""
GUSTS = {"CS-25.341, H = 107 m": (107.0, 0.0), "MIL-F-8785C, d = 200 m": (200.0, 1e7), "wake": (1.0, 38.0)}
"""Gradient and plateau of gusts of 10 m/s upward, m."""
LEVELS = np.array([10.0, 50.0, 150.0, 300.0, 400.0, 500.0, 650.0, 900.0])
"""Above the ground, of the turbulence, m."""
SAMPLES = 3000
"""Of it at each level, one a second."""
SHEAR, ONSET = -10.0, 900.0
"""Change of the wind from the north, m/s, and when, s."""


@dataclass(frozen=True)
class Flown:
    """What was measured."""

    power: np.ndarray  # of turbulence along and down at FREQUENCY, (m/s)2/Hz, (lines, 2)
    correlations: np.ndarray  # of wander over LAGS, mean of north and east, (flights, lags)
    profile: np.ndarray  # mean wind of 10 m/s over open country, at HEIGHTS
    gusts: Mapping[str, np.ndarray]  # upward wind at DISTANCE, m/s, by GUSTS
    intensities: Mapping[str, np.ndarray]  # rms of turbulence along and down at LEVELS, (levels, 2), by grade
    time: np.ndarray  # since the shear, s
    error: np.ndarray  # by how much more the dead-reckoned position is to the north with it, m


def measure() -> Flown:
    """Fly all of it."""
    return Flown(_power(), _correlations(), _profile(), _gusts(), _intensities(), *_error())


def spectrum(frequency: np.ndarray, folded: bool = True) -> np.ndarray:
    """MIL-F-8785C along and down for 1 m/s rms, per Hz; that of samples is folded: (lines, 2)."""
    total = np.zeros((len(frequency), 2))
    for k in range(-200, 201) if folded else (0,):
        reduced = LENGTH * 2.0 * np.pi * np.abs(frequency + k / PERIOD) / SPEED
        one = 1.0 + reduced**2
        total += 4.0 * LENGTH / SPEED * np.stack([1.0 / one, 0.5 * (1.0 + 3.0 * reduced**2) / one**2], axis=1)
    return total


def exponential(lags: np.ndarray) -> np.ndarray:
    """exp(-t_r / 400 s) over lags of whole samples, (flights, lags)."""
    return np.exp(-np.outer(RATIOS, lags) * STEP / 400.0)


def spread() -> np.ndarray:
    """Standard deviations of the correlations of the wander by Bartlett's formula, (flights, lags)."""
    reach = np.arange(-2000, 2001)
    terms = [
        np.sum(exponential(2 * np.abs(reach)) + exponential(np.abs(reach + k) + np.abs(reach - k)), axis=1)
        for k in LAGS
    ]
    return np.sqrt(np.stack(terms, axis=1) / (2 * SECONDS / STEP))


def power_law(heights: np.ndarray) -> np.ndarray:
    """ASCE 7-05 over open country, 10 m/s from 274 m on."""
    return 10.0 * (np.clip(heights, 1.0, 274.0) / 274.0) ** (1.0 / 6.5)


def certified(distance: np.ndarray) -> np.ndarray:
    """Gust of CS-25.341 (a)(2) with H = 107 m, m/s."""
    inside = (distance >= 0.0) & (distance <= 214.0)
    return np.where(inside, 5.0 * (1.0 - np.cos(np.pi * distance / 107.0)), 0.0)


def specified(heights: np.ndarray, grade: str) -> tuple[np.ndarray, np.ndarray]:
    """Intensities, m/s, and lengths, m, of MIL-F-8785C along and down, (heights, 2) each."""
    h = np.clip(heights, 3.048, 304.8)
    factor = 0.177 + 0.000823 * h / 0.3048
    down = 0.1 * TURBULENCE[grade]["wind_at_20_feet"]
    low = np.stack([down / factor**0.4, 0.0 * h + down], axis=1), np.stack([h / factor**1.2, h], axis=1)
    above = np.clip(heights / 304.8 - 1.0, 0.0, 1.0)[:, None]
    high = TURBULENCE[grade]["turbulence_sigma"], LENGTH
    return tuple((1.0 - above) * one + above * other for one, other in zip(low, high, strict=True))


def scatter(grade: str) -> np.ndarray:
    """Standard deviations of the mean squares at LEVELS, relative, along and down: (levels, 2)."""
    _, length = specified(LEVELS, grade)
    x = np.arange(1, 1000)[:, None, None] * SPEED / length
    rho = np.exp(-x) * np.stack([np.ones(x.shape[:2]), 1.0 - 0.5 * x[..., 1]], axis=-1)
    return np.sqrt(2.0 * (1.0 + 2.0 * np.sum(rho**2, axis=0)) / SAMPLES)


def _fly(stop: float, step: float, faults: Sequence[Fault] = (), **parameters: object) -> np.ndarray:
    """Winds in n, (samples, 3), from t = 0 on; without wander unless it is given."""
    flown = System.load(shipped.path("wind.fmu")).run(
        stop=stop,
        step=step,
        seed=1,
        faults=faults,
        parameters={f"wind.{name}": value for name, value in ({"sigma": [0.0] * 3} | parameters).items()},
        record=["wind.wind_n"],
        record_period=step,
    )
    return flown.to_numpy()


def _power() -> np.ndarray:
    samples = _fly(
        STRETCHES * LINES * PERIOD,
        PERIOD,
        turbulence_sigma=[1.0] * 3,
        turbulence_length=LENGTH,
        true_airspeed=SPEED,
    )
    window = np.hanning(LINES + 1)[:-1, None]
    stretches = np.fft.rfft(window * samples[1:].reshape(STRETCHES, LINES, 3)[..., [0, 2]], axis=1)
    lines = np.rint(FREQUENCY * LINES * PERIOD).astype(int)
    return 2.0 * PERIOD * np.mean(np.abs(stretches) ** 2, axis=0)[lines] / np.sum(window**2)


def _correlations() -> np.ndarray:
    found = []
    for velocity in FLIGHTS.values():
        samples = _fly(SECONDS, STEP, sigma=[5.0, 5.0, 0.0], velocity_n=velocity, sample_period=STEP)[:, :2]
        found.append([np.mean(samples[:-k] * samples[k:]) / 25.0 for k in LAGS])
    return np.array(found)


def _profile() -> np.ndarray:
    parameters = {"mean_n": [0.0, 10.0, 0.0], "profile_exponent": 1.0 / 6.5}
    return np.array([_fly(0.1, 0.1, altitude=h, **parameters)[-1, 1] for h in HEIGHTS])


def _gusts() -> dict[str, np.ndarray]:
    metre = 1.0 / SPEED
    front = Fault("gust", "wind.gust", "input", start=99 * metre, parameters={"value": True})
    parameters = {"gust_n": [0.0, 0.0, -10.0], "true_airspeed": SPEED, "sample_period": metre}
    return {
        name: -_fly(10.0, metre, [front], gust_gradient=gradient, gust_plateau=plateau, **parameters)[:, 2]
        for name, (gradient, plateau) in GUSTS.items()
    }


def _intensities() -> dict[str, np.ndarray]:
    found = {}
    for name, grade in TURBULENCE.items():
        parameters = {**grade, "turbulence_sigma": [grade["turbulence_sigma"]] * 3}
        flown = [
            _fly(SAMPLES, 1.0, altitude=height, sample_period=1.0, true_airspeed=SPEED, **parameters)
            for height in LEVELS
        ]
        found[name] = np.array([np.sqrt(np.mean(samples[1:, [0, 2]] ** 2, axis=0)) for samples in flown])
    return found


def _error() -> tuple[np.ndarray, np.ndarray]:
    system = System.load("backup_navigator", variant="open_loop")
    shear = Fault("shear", "wind.shear", "input", start=ONSET, parameters={"value": True})
    calm, sheared = (
        system.run(
            stop=ONSET + 600.0,
            seed=3,
            faults=["gps_lost", *faults],
            record=["evaluation.north_error"],
            record_period=1.0,
            parameters={"wind.shear_n": [SHEAR, 0.0, 0.0]},
        )["evaluation.north_error"]
        for faults in ([], [shear])
    )
    after = calm.index >= ONSET
    return calm.index[after].to_numpy() - ONSET, (sheared - calm)[after].to_numpy()
