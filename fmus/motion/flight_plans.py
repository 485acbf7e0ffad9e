"""Named flight plans: the thesis's flights as values for the aircraft's parameters.

``FLIGHT_PLANS["livermore"].parameters()`` gives names and values.
"""

from __future__ import annotations

import numpy as np

from models.motion.flight_plan import FlightPlan, straight, turn
from navfmu.constants import FOOT, KNOT, NAUTICAL_MILE

APPROACH_SPEED = 90.0 * KNOT
"""Thesis section 5.5.2: a typical approach speed, 46.3 m/s."""
LIVERMORE_25L = (np.radians(37.6925), np.radians(-121.8158))
"""Threshold of runway 25L of Livermore Municipal, to about 100 m."""
LIVERMORE_25L_COURSE = np.radians(267.0)
"""True direction of landing."""
LIVERMORE_ALTITUDE = 400.0 * FOOT
"""Elevation of the airport; mean sea level and the ellipsoid are taken as one."""


def livermore() -> FlightPlan:
    """35 minutes in the manner of thesis section 7.3 (p. 215): 360-degree turns, then straight in to Livermore 25L.

    The turns are flown around a point 16 nmi east and 6 nmi north of the airport between 6000 and 4500 ft, the
    first 5 minutes are meant for the calibration with GPS. Then south-west to the extended centre line and down.
    """
    v = APPROACH_SPEED
    slow, rate_one = np.radians(1.5), np.radians(3.0)
    circle = 2.0 * np.pi
    course = LIVERMORE_25L_COURSE
    join = np.radians(36.0)
    segments = [
        straight(40.0, v),
        turn(circle, slow, v),
        straight(40.0, v),
        turn(-circle, slow, v),
        straight(30.0, v, -1.5),
        turn(np.pi, slow, v, -1.5),
        straight(60.0, v),
        turn(circle, rate_one, v),
        straight(30.0, v),
        turn(-circle, slow, v),
        straight(30.0, v),
        turn(np.pi - join, slow, v),
        straight(280.0, v),
        turn(join, slow, v),
    ]
    start_altitude = 6000.0 * FOOT
    threshold_height = 15.0
    spent = sum(s.duration for s in segments)
    level = 30.0
    descending = straight(2100.0 - spent - level, v)
    # level off over the last half minute, 15 m above the threshold
    lost = 1.5 * (segments[4].duration + segments[5].duration)
    sink = (start_altitude - lost - LIVERMORE_ALTITUDE - threshold_height) / descending.duration
    segments += [straight(descending.duration, v, -sink), straight(level, v)]
    initial_track = course - join - (np.pi - join) - np.pi + join + join
    plan = FlightPlan(*LIVERMORE_25L, start_altitude, float(initial_track), v, tuple(segments))
    final_track = plan.sample()["track"][-1]
    plan = FlightPlan(*LIVERMORE_25L, start_altitude, float(plan.track + course - final_track), v, tuple(segments))
    return plan.ending_at(*LIVERMORE_25L)


def straight_in() -> FlightPlan:
    """Thesis section 7.2 (p. 204): 50 nmi out at 6000 ft, down to 800 ft at 2 nmi, then level to the airport."""
    v = APPROACH_SPEED
    descent = 48.0 * NAUTICAL_MILE / v
    sink = 5200.0 * FOOT / descent
    segments = (straight(descent, v, -sink), straight(2.0 * NAUTICAL_MILE / v, v))
    course = LIVERMORE_25L_COURSE
    return FlightPlan(*LIVERMORE_25L, 6000.0 * FOOT, float(course), v, segments).ending_at(*LIVERMORE_25L)


def cruise_north() -> FlightPlan:
    """Thesis section 5.5.2 (p. 173): north at 90 kn and 2000 ft, wings level, for half an hour."""
    v = APPROACH_SPEED
    return FlightPlan(np.radians(37.0), np.radians(-121.8), 2000.0 * FOOT, 0.0, v, (straight(1800.0, v),))


FLIGHT_PLANS = {"livermore": livermore(), "straight_in": straight_in(), "cruise_north": cruise_north()}
