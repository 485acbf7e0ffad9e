"""Satellites when what arrives at a receiver now left them: one state of each, carried on to that moment."""

from __future__ import annotations

import numpy as np

from models.satellite import broadcast, sight
from models.satellite.orbit import EARTH_RATE, GRAVITATION


def acceleration(position, velocity):
    """Of free fall towards a round earth in e, m/s2; rows of three. Its field's flatness is 1e-3 of it."""
    x, y, vx, vy = position[..., 0], position[..., 1], velocity[..., 0], velocity[..., 1]
    square = np.sum(position * position, axis=-1)
    fall = -(GRAVITATION / (square * np.sqrt(square)))[..., None] * position
    turning = (EARTH_RATE * (2.0 * vy + EARTH_RATE * x), EARTH_RATE * (EARTH_RATE * y - 2.0 * vx), 0.0 * x)
    return fall + np.stack(turning, axis=-1)


def received(ephemeris, week, second, position_e):
    """Travel time (s), position (m), velocity (m/s), clock on L1 (s) and its rate of satellites at sending.

    What they sent arrives at ``position_e`` (3,) at a GPS time. Each is asked where it is USUAL before and carried on
    for what the travel time is more or less, 0.01 s, to 1e-8 m.
    """
    satellite, velocity, clock, rate = broadcast.at(ephemeris, week, second - broadcast.USUAL)
    fall = acceleration(satellite, velocity)
    time, there = broadcast.USUAL + 0.0 * satellite[..., 0], satellite
    for _ in range(broadcast.PASSES):
        on = (broadcast.USUAL - time)[..., None]
        there = satellite + on * (velocity + 0.5 * on * fall)
        time = sight.travel_time(position_e, sight.turned(there, time))
    on = broadcast.USUAL - time
    return time, there, velocity + on[..., None] * fall, clock + on * rate, rate
