"""A quick model of the backup navigator for many seeds at once, on a plane, with the filter's own functions.

Sensors are what the thesis's error models say and nothing else (no AHRS, no pitot tube): heading a Gauss-Markov
process of 2.5 degrees and 120 s (3.84), airspeed 2.6 m/s and 400 s, wind 5 m/s and 400 s, DME 315 m and 0.5 nmi with
7.4 m.
"""

from __future__ import annotations

import numpy as np

from models import dme, kalman, navigator

SPEED = 46.3
LOSS = 300.0
STOP = 2100.0
STATIONS = np.array([[20.8e3, -8.3e3], [34.0e3, 38.8e3]])
"""North and east of the runway: the pair thesis_like of fmus.stations."""
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


def run(seeds, mode=3, aided=True, as_printed=False, step=1.0, walk=5.0):
    """Errors (time, seed, axis) and sigmas of the filter, and time."""
    rng = np.random.default_rng(1000 + mode)
    time, position, velocity = flight(step)
    wind_model, heading_model, air_model = SIGMAS
    wind = wind_model[0] * rng.standard_normal((seeds, 2))
    heading_error = heading_model[0] * rng.standard_normal(seeds)
    air_error = air_model[0] * rng.standard_normal(seeds)
    bias = dme.BIAS_SIGMA * rng.standard_normal((seeds, 2))
    lumped = float(navigator.lumped_variance(np.array([SPEED, 0.0]), heading_model[0], air_model[0]))
    estimate = np.concatenate([position[0] + np.zeros((seeds, 2)), np.zeros((seeds, 2))], axis=1)
    upper = np.tile(kalman.of_variances(np.array([4.0, 4.0, 25.0 + lumped, 25.0 + lumped])), (seeds, 1))
    decay = np.exp(-step / wind_model[1])
    phi = navigator.transition(step, decay)
    noise = navigator.noise(step, navigator.wind_noise(SPEED, *SIGMAS), walk**2)
    last, before = np.full(2, -1e9), None
    errors, sigmas = np.empty((len(time), seeds, 2)), np.empty((len(time), seeds, 2))
    for k, now in enumerate(time):
        air = velocity[k] - wind
        shown = np.arctan2(air[:, 1], air[:, 0]) + heading_error
        measured_air = (np.hypot(air[:, 0], air[:, 1]) + air_error) * np.stack([np.cos(shown), np.sin(shown)])
        measured_air = measured_air.T
        if before is not None:
            estimate[:, :2] += step * (0.5 * (before + measured_air) + estimate[:, 2:])
            estimate[:, 2:] *= decay
            upper = kalman.propagate(upper, phi, noise)
        before = measured_air
        correction = np.zeros((seeds, 4))
        if now <= LOSS:
            for axis, row in enumerate(np.eye(4)):
                rows = np.tile(row, (seeds, 1))
                if axis < 2:
                    residual = position[k, axis] + 2.0 * rng.standard_normal(seeds) - estimate[:, axis]
                else:
                    seen = velocity[k, axis - 2] + 0.1 * rng.standard_normal(seeds)
                    residual = seen - measured_air[:, axis - 2] - estimate[:, axis]
                variance = 4.0 if axis < 2 else lumped + 0.01
                correction, upper, _ = kalman.update(correction, upper, rows, variance, residual)
        elif aided:
            slot = round(now) // 15
            due = {1: [slot % 2], 2: [0, 1], 3: [0, 1]}[mode] if mode == 3 or round(now) % 15 == 0 else []
            for station in due:
                true = np.hypot(*(position[k] - STATIONS[station]))
                reading = dme.measure(true, bias[:, station], dme.NOISE_SIGMA, rng.standard_normal(seeds))
                sight = estimate[:, :2] - STATIONS[station]
                distance = np.hypot(sight[:, 0], sight[:, 1])
                rows = np.concatenate([sight / distance[:, None], np.zeros((seeds, 2))], axis=1)
                colored = dme.white_equivalent(dme.BIAS_SIGMA**2, now - last[station], 926.0 / SPEED)
                variance = dme.NOISE_SIGMA**2 + (0.0 if as_printed else colored)
                correction, upper, _ = kalman.update(correction, upper, rows, variance, reading - distance)
                last[station] = now
        estimate = estimate + correction
        errors[k] = estimate[:, :2] - position[k]
        sigmas[k] = np.sqrt(kalman.diagonal(upper)[:, :2])
        wind = gauss_markov(rng, wind, *wind_model, step)
        heading_error = gauss_markov(rng, heading_error, *heading_model, step)
        air_error = gauss_markov(rng, air_error, *air_model, step)
        bias = gauss_markov(rng, bias, dme.BIAS_SIGMA, 926.0 / SPEED, step)
    return time, errors, sigmas
