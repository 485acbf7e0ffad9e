"""A quick model of the backup navigator for many seeds at once, on a plane, with the filter's own functions.

Sensors are what the thesis's error models say and nothing else (no AHRS, no pitot tube): heading a Gauss-Markov
process of 2.5 degrees and 120 s (3.84), airspeed 2.6 m/s and 400 s, wind 5 m/s and 400 s about a mean of 0 that is
known, DME 315 m and 0.5 nmi with 7.4 m.
"""

from __future__ import annotations

import numpy as np

from models.filters import kalman
from models.navigation import navigator
from models.radio import dme

SPEED = 46.3
LOSS = 300.0
STOP = 2100.0
STATIONS = np.array([[20.8e3, -8.3e3], [34.0e3, 38.8e3]])
"""North and east of the runway: the pair thesis_like of fmus.radio.stations."""
SIGMAS = ((5.0, 400.0), (np.radians(2.5), 120.0), (2.6, 400.0))
"""Wind, heading, airspeed: sigma and tau."""


def flight(step):
    """Time, position and velocity: 360-degree turns 16 miles east, 6 miles north of the runway, then straight in."""
    start = 1609.34 * np.array([6.0, 16.0])
    course = np.arctan2(-start[1], -start[0])
    time = np.arange(round(STOP / step) + 1) * step
    to_go = STOP - np.hypot(*start) / SPEED - time
    in_lap = to_go - 150.0 * np.floor(to_go / 150.0)
    heading = course - np.where(to_go > 0.0, np.radians(3.0) * np.clip(in_lap - 30.0, 0.0, None), 0.0)
    velocity = SPEED * np.stack([np.cos(heading), np.sin(heading)], -1)
    position = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * step * (velocity[1:] + velocity[:-1]), axis=0)])
    return time, position - position[-1], velocity


def gauss_markov(rng, value, sigma, tau, step):
    phi = np.exp(-step / tau)
    return phi * value + sigma * np.sqrt(1.0 - phi * phi) * rng.standard_normal(np.shape(value))


def run(seeds, mode=3, aided=True, as_printed=False, step=1.0):
    """Errors (time, seed, axis) and covariances (time, seed, 2, 2) of position, and time."""
    rng = np.random.default_rng(1000 + mode)
    time, position, velocity = flight(step)
    wind_model, heading_model, air_model = SIGMAS
    wind = wind_model[0] * rng.standard_normal((seeds, 2))
    heading_error = heading_model[0] * rng.standard_normal(seeds)
    air_error = air_model[0] * rng.standard_normal(seeds)
    bias = dme.BIAS_SIGMA * rng.standard_normal((seeds, 2))
    sigma = 0.0 if as_printed else dme.BIAS_SIGMA
    # the air's own speed varies by some 10 %, and with it what an angle of heading makes across the nose
    sigmas = np.array([wind_model[0]] * 2 + [0.0] * 2 + [air_model[0], SPEED * heading_model[0]] + [sigma] * 2)
    times = np.array([wind_model[1]] * 2 + [1e12] * 2 + [air_model[1], heading_model[1]] + [926.0 / SPEED] * 2)
    factor, added = navigator.follow(sigmas, sigmas, np.exp(-step / times))
    upper = np.tile(kalman.of_variances(np.array([4.0, 4.0, *sigmas**2])), (seeds, 1))
    place, estimate = position[0] + np.zeros((seeds, 2)), np.zeros((seeds, 8))
    before = None
    errors, covariances = np.empty((len(time), seeds, 2)), np.empty((len(time), seeds, 2, 2))
    for k, now in enumerate(time):
        air = velocity[k] - wind
        shown = np.arctan2(air[:, 1], air[:, 0]) + heading_error
        speed = np.hypot(air[:, 0], air[:, 1]) + air_error
        rows = np.array([navigator.velocity_rows(angle) for angle in shown])
        if before is not None:
            estimate = estimate * factor
            upper = navigator.propagate(upper, step, rows, factor, added, 0.0)
        ground = speed[:, None] * rows[:, :, 4] + np.einsum("sij,sj->si", rows, estimate[:, :6])
        place = place + (0.0 if before is None else 0.5 * step * (before + ground))
        correction = np.zeros((seeds, 10))
        if now <= LOSS:
            seen = position[k] + 2.0 * rng.standard_normal((seeds, 2)) - place
            felt = velocity[k] + 0.1 * rng.standard_normal((seeds, 2)) - ground
            correction, upper = navigator.fix_updates(correction, upper, seen, felt, rows, (4.0, 0.01), (True, True))
        elif aided:
            slot = round(now) // 15
            due = {1: [slot % 2], 2: [0, 1], 3: [0, 1]}[mode] if mode == 3 or round(now) % 15 == 0 else []
            sight = place[:, None] - STATIONS
            distance = np.hypot(sight[..., 0], sight[..., 1])
            true = np.hypot(*(position[k] - STATIONS).T)
            reading = dme.measure(true, bias, dme.NOISE_SIGMA, rng.standard_normal((seeds, 2)))
            correction, upper, *_ = navigator.range_updates(
                correction,
                upper,
                sight[..., 0] / distance,
                sight[..., 1] / distance,
                reading - distance - estimate[:, 6:],
                np.full(2, dme.NOISE_SIGMA**2),
                np.isin([0, 1], due),
                0.0,
            )
        place, estimate = place + correction[:, :2], estimate + correction[:, 2:]
        before = speed[:, None] * rows[:, :, 4] + np.einsum("sij,sj->si", rows, estimate[:, :6])
        errors[k] = place - position[k]
        covariances[k] = kalman.unpack(upper)[:, :2, :2]
        wind = gauss_markov(rng, wind, *wind_model, step)
        heading_error = gauss_markov(rng, heading_error, *heading_model, step)
        air_error = gauss_markov(rng, air_error, *air_model, step)
        bias = gauss_markov(rng, bias, dme.BIAS_SIGMA, 926.0 / SPEED, step)
    return time, errors, covariances
