"""Satellites when their signals left, by what they say of themselves: what a receiver makes of messages, and a model of
the way that signals take.

Satellites are in e of the time of sending, rows of three; ``sight`` turns them into e of reception.
"""

from __future__ import annotations

from models.satellite import orbit, satellite_clock, sight

USUAL = 0.077
"""s that signals take, within 0.01 s, from satellites above the horizon of a place on the earth."""
PASSES = 3
"""Of the travel time: each leaves 3e-6 of what was off, the speed towards the receiver over that of light."""


def sent(ephemeris, week, second, pseudorange):
    """Position (m), velocity (m/s), clock on L1 (s) and its rate (s/s) of satellites when they sent what was received.

    A receiver took it at ``second`` of its clock with this pseudorange (m).
    """
    return at(ephemeris, week, satellite_clock.sending_time(ephemeris, week, second, pseudorange))


def at(ephemeris, week, second):
    """The same at a GPS time."""
    anomaly = orbit.anomaly(ephemeris, week, second)
    position, velocity = orbit.state_at(ephemeris, anomaly, week, second)
    error, rate = satellite_clock.error_at(ephemeris, anomaly, week, second)
    return position, velocity, satellite_clock.on_l1(ephemeris, error), rate


def travel(ephemeris, week, second, position_e):
    """Time that signals take through empty space to a receiver at ``position_e`` (3,) at a GPS time of reception, s.

    The satellite goes straight on from where it is USUAL before: 0.03 mm, with the horizon below it.
    """
    satellite, velocity = orbit.state(ephemeris, week, second - USUAL)
    time = USUAL + 0.0 * satellite[..., 0]
    for _ in range(PASSES):
        there = satellite + (USUAL - time)[..., None] * velocity
        time = sight.travel_time(position_e, sight.turned(there, time))
    return time
