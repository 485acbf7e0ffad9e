"""Aircraft truth: a flight plan turned into motion that is consistent with itself.

The plan is a row of segments. In each one the ground speed V, the rate of turn of the ground track omega and the
vertical speed w go from the previous segment's values to its own along the smooth step

    s(x) = 10 x^3 - 15 x^4 + 6 x^5,   x = (t - t_segment) / T,  held at 1 from x = 1 on,                         (1)

whose duration T keeps roll rate and accelerations within limits. Everything else follows *without approximation*:
track and altitude are integrals of (1) in closed form; velocity is V (cos, sin) of the track and -w; attitude is
defined from these by closed formulas (below), so its rates, and from them the angular rate, are exact derivatives too:

    tan(pitch) = w / V                                         the nose is on the flight path                     (2)
    heading    = track + crab                                  crab: towards the air-relative velocity, (5)
    tan(roll)  = (V omega cos(crab) - V' sin(crab)) / (g + w') the coordinated turn                               (3)
    f^b        = C_bn (v'^n + (2 Omega_e + rho) x v^n - g^n)   thesis (A.1)                                       (4)

The ground trajectory follows the plan whatever the wind. The crab angle c follows the angle c_a between the
air-relative velocity and the track through two equal lags, tau^2 c'' + 2 tau c' + c = c_a, so that the yaw rate stays
continuous in a stepping wind; between ticks c_a is taken as linear and (5) is its exact solution.                  (5)

All functions are element by element in time: scalars inside the FMU, arrays in ``flight_plan``.
"""

from __future__ import annotations

import numpy as np

from models import attitude, earth

PEAK = 1.875
"""Largest slope of the smooth step (1)."""
FOREVER = 1.0e12
"""End of the last segment, s."""
SHORTEST_TRANSITION = 1.0
"""Shortest duration T of a transition, s."""


def change(elapsed, before, step, duration):
    """A quantity that goes from ``before`` by ``step`` along (1): value, first and second derivative, integral."""
    x = np.clip(elapsed / duration, 0.0, 1.0)
    rest = 1.0 - x
    x2 = x * x
    slope = step / duration
    value = before + step * x2 * x * (10.0 - 15.0 * x + 6.0 * x2)
    first = 30.0 * slope * x2 * rest * rest
    second = 60.0 * slope / duration * x * rest * (1.0 - 2.0 * x)
    integral = before * elapsed + step * (
        duration * x2 * x2 * (2.5 - 3.0 * x + x2) + np.maximum(elapsed - duration, 0.0)
    )
    return value, first, second, integral


def schedule(duration, turn_rate, vertical_speed, speed, initial, limits, grid):
    """Times and starting values of the segments.

    Parameters
    ----------
    duration, turn_rate, vertical_speed, speed
        The plan: s, rad/s of the ground track, m/s upward, m/s over ground. A duration of 0 ends it.
    initial
        (track rad, altitude m, speed m/s) at t = 0, in level straight flight.
    limits
        (roll rate rad/s, acceleration m/s2, vertical acceleration m/s2) that set the durations T.
    grid
        Segments begin at whole multiples of this time (s), the nearest to the sum of the durations.

    Returns
    -------
    dict of arrays, one element per segment: ``begin``, ``end`` (s), ``track``, ``altitude`` at the begin,
    ``*_before`` and ``*_step`` of turn_rate, vertical_speed, speed, and the durations T ``roll_time``, ``climb_time``,
    ``speed_time`` (s).
    """
    initial_track, initial_altitude, initial_speed = initial
    roll_rate, acceleration, vertical_acceleration = limits
    used = duration > 0.0
    following = np.concatenate([used[1:], np.array([False])])
    total = grid * np.floor(np.cumsum(duration) / grid + 0.5)
    begin = np.where(used, np.concatenate([np.zeros(1), total[:-1]]), FOREVER)
    end = np.where(used & following, total, FOREVER)

    def before(target, first):
        return np.concatenate([np.reshape(first, (1,)), target[:-1]])

    speed_before = before(speed, initial_speed)
    turn_before = before(turn_rate, 0.0)
    climb_before = before(vertical_speed, 0.0)
    speed_step = speed - speed_before
    turn_step = turn_rate - turn_before
    climb_step = vertical_speed - climb_before
    fastest = np.maximum(speed, speed_before)

    def time(step, limit):
        return np.maximum(PEAK * np.abs(step) / limit, SHORTEST_TRANSITION)

    roll_time = time(turn_step * fastest / earth.STANDARD_GRAVITY, roll_rate)
    climb_time = time(climb_step, vertical_acceleration)
    speed_time = time(speed_step, acceleration)
    length = end - begin
    turned = (turn_before * length + turn_step * (length - 0.5 * roll_time))[:-1]
    climbed = (climb_before * length + climb_step * (length - 0.5 * climb_time))[:-1]
    zero = np.zeros(1)
    return {
        "begin": begin,
        "end": end,
        "track": initial_track + np.concatenate([zero, np.cumsum(turned)]),
        "altitude": initial_altitude + np.concatenate([zero, np.cumsum(climbed)]),
        "turn_rate_before": turn_before,
        "turn_rate_step": turn_step,
        "vertical_speed_before": climb_before,
        "vertical_speed_step": climb_step,
        "speed_before": speed_before,
        "speed_step": speed_step,
        "roll_time": roll_time,
        "climb_time": climb_time,
        "speed_time": speed_time,
    }


def fits(duration, turn_rate, vertical_speed, speed, initial, limits, grid):
    """True where every segment but the last is long enough for its transitions."""
    plan = schedule(duration, turn_rate, vertical_speed, speed, initial, limits, grid)
    longest = np.maximum(np.maximum(plan["roll_time"], plan["climb_time"]), plan["speed_time"])
    inside = plan["end"] < 0.5 * FOREVER
    return np.where(inside, plan["end"] - plan["begin"] >= longest, True)


def desired_crab(track_sine, track_cosine, speed, wind_n):
    """Angle from the ground track to the air-relative velocity v_ground - wind, rad, at most 60 degrees."""
    along = wind_n[0] * track_cosine + wind_n[1] * track_sine
    across = wind_n[1] * track_cosine - wind_n[0] * track_sine
    return np.clip(np.arctan2(-across, speed - along), -np.pi / 3.0, np.pi / 3.0)


def weathercock(crab, crab_rate, old_target, new_target, period, time_constant, decay):
    """Crab angle and its rate one period later, the exact solution of (5); decay = exp(-period / tau)."""
    slope = (new_target - old_target) / period
    lag = 2.0 * time_constant * slope
    error = crab - old_target + lag
    error_rate = crab_rate - slope
    inverse = 1.0 / time_constant
    return (
        new_target - lag + decay * (error + period * (error_rate + inverse * error)),
        slope + decay * (error_rate - period * inverse * (error_rate + inverse * error)),
    )


def turned(sine, cosine, angle):
    """Sine and cosine of an angle enlarged by a small one, below 0.1 rad to 1e-12."""
    a2 = angle * angle
    small_sine = angle * (1.0 - a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0)))
    small_cosine = 1.0 - 0.5 * a2 * (1.0 - a2 / 12.0 * (1.0 - a2 / 30.0))
    return sine * small_cosine + cosine * small_sine, cosine * small_cosine - sine * small_sine


def move(latitude, longitude, altitude, velocity_n, middle_velocity_n, next_velocity_n, next_altitude, period):
    """Latitude and longitude one period later: Simpson's rule over the velocity, geometry at the middle."""
    north = (velocity_n[0] + 4.0 * middle_velocity_n[0] + next_velocity_n[0]) / 6.0
    east = (velocity_n[1] + 4.0 * middle_velocity_n[1] + next_velocity_n[1]) / 6.0
    middle_altitude = 0.5 * (altitude + next_altitude)
    north_south, east_west = earth.radii(latitude)
    step = period * north / (north_south + middle_altitude)
    middle_cosine = np.cos(latitude) - 0.5 * step * np.sin(latitude)
    return latitude + step, longitude + period * east / ((east_west + middle_altitude) * middle_cosine)


def kinematics(latitude, altitude, track_sine, track_cosine, speed, turn_rate, climb, crab, crab_rate):
    """Attitude, angular rate and specific force from the motion.

    Parameters
    ----------
    speed, climb
        Ground speed and vertical speed upward with their first and second derivatives, (m/s, m/s2, m/s3).
    turn_rate
        Rate of the ground track and its derivative, (rad/s, rad/s2).

    Returns
    -------
    velocity_n, roll, pitch, specific force in b, rate of b with respect to inertial space in b
    """
    v, v1, v2 = speed
    omega, omega1 = turn_rate
    w, w1, w2 = climb
    velocity_n = np.array([v * track_cosine, v * track_sine, -w])

    crab_sine, crab_cosine = np.sin(crab), np.cos(crab)
    centripetal = v * omega
    forward = v1 * crab_cosine + centripetal * crab_sine
    sideward = centripetal * crab_cosine - v1 * crab_sine
    sideward_rate = (v1 * omega + v * omega1) * crab_cosine - v2 * crab_sine - crab_rate * forward
    weight = earth.STANDARD_GRAVITY + w1
    roll_tangent = sideward / weight
    roll_cosine = 1.0 / np.sqrt(1.0 + roll_tangent * roll_tangent)
    roll_sine = roll_tangent * roll_cosine
    roll_rate = roll_cosine * roll_cosine * (sideward_rate - roll_tangent * w2) / weight

    pitch_tangent = w / v
    pitch_cosine = 1.0 / np.sqrt(1.0 + pitch_tangent * pitch_tangent)
    pitch_sine = pitch_tangent * pitch_cosine
    pitch_rate = pitch_cosine * pitch_cosine * (w1 - pitch_tangent * v1) / v

    heading_sine = track_sine * crab_cosine + track_cosine * crab_sine
    heading_cosine = track_cosine * crab_cosine - track_sine * crab_sine
    c_bn = attitude.dcm_from_sines(roll_sine, roll_cosine, pitch_sine, pitch_cosine, heading_sine, heading_cosine).T

    acceleration = np.array(
        [v1 * track_cosine - centripetal * track_sine, v1 * track_sine + centripetal * track_cosine, -w1]
    )
    earth_rate = earth.earth_rate(latitude)
    transport = earth.transport_rate(latitude, altitude, velocity_n)
    down = earth.gravity(latitude, altitude)
    force_n = acceleration + np.cross(2.0 * earth_rate + transport, velocity_n) - np.array([0.0, 0.0, 1.0]) * down
    rate = c_bn @ (earth_rate + transport) + attitude.body_rate(
        roll_rate, pitch_rate, omega + crab_rate, roll_sine, roll_cosine, pitch_sine, pitch_cosine
    )
    return velocity_n, np.arctan(roll_tangent), np.arctan(pitch_tangent), c_bn @ force_n, rate
