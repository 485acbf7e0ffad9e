"""Aircraft truth: a flight plan turned into motion that is consistent with itself.

The plan is a row of segments. In each one the ground speed V, the rate of turn of the ground track omega and the
vertical speed w go from the previous segment's values to its own along the smooth step

    s(x) = 10 x^3 - 15 x^4 + 6 x^5,   x = (t - t_segment) / T,  held at 1 from x = 1 on,                         (1)

whose duration T keeps roll rate and accelerations within limits. Track and altitude are integrals of (1) in closed
form.

Two things are added to the planned motion, in n: what the pilot lets the aircraft wander (``models.motion.wander``),
which is flown like the plan itself, and how gusts carry it away (``models.air.turbulence``), which the attitude does
not follow.
*Steered* is the motion without the gusts, with the climb and the bank by which the pilot flies back to the path.

The attitude is defined from the steered motion by closed formulas, so its rates are exact derivatives. With the
velocity v - W relative to the air that the pilot has got used to (W: the wind through two equal lags):

    heading and climb of the wind axes: those of v - W                                                            (2)
    tan(bank) = (acceleration across v - W) / (g + vertical acceleration)     the coordinated turn                (3)
    alpha = alpha_0 + 2 (G/S) n / (rho |v - W|^2 C_L_alpha)      nose up, for the load factor n of (3)           (4)
    f^b = C_bn (v'^n + (2 Omega_e + rho) x v^n - g^n)            thesis (A.1), all of the motion                  (5)

The ground trajectory does not depend on the wind. All functions are element by element in time: scalars inside the FMU,
arrays in ``flight_plan``.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude
from models.earth import earth
from navfmu.constants import STANDARD_GRAVITY

PEAK = 1.875
"""Largest slope of the smooth step (1)."""
FOREVER = 1.0e12
"""End of the last segment, s."""
STALL = 0.3
"""No wing has more incidence to its direction without lift, rad; (4) is led smoothly below it, 0.03 % away at 0.14."""
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

    roll_time = time(turn_step * fastest / STANDARD_GRAVITY, roll_rate)
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


def planned(track_sine, track_cosine, speed, turn, climb):
    """Velocity, acceleration and jerk of the plan, n.

    Parameters
    ----------
    speed, climb
        Ground speed and vertical speed upward with their first and second derivatives, (m/s, m/s2, m/s3).
    turn
        Rate of the ground track and its derivative, (rad/s, rad/s2).
    """
    v, v1, v2 = speed
    omega, omega1 = turn

    def north_east_down(along, across, up):
        return np.array([along * track_cosine - across * track_sine, along * track_sine + across * track_cosine, -up])

    return (
        north_east_down(v, 0.0 * v, climb[0]),
        north_east_down(v1, v * omega, climb[1]),
        north_east_down(v2 - v * omega * omega, 2.0 * v1 * omega + v * omega1, climb[2]),
    )


def lift_length(wing_loading, density, lift_slope):
    """2 (G/S) / (rho g C_L_alpha), m: alpha - alpha_0 = this times the lift per mass over the squared airspeed."""
    return 2.0 * wing_loading / (density * STANDARD_GRAVITY * lift_slope)


def trimmed(velocity, turning, air, lift):
    """Attitude and its rate from the steered motion, (2)-(4).

    Parameters
    ----------
    velocity
        Steered velocity and its derivative in n, (m/s, m/s2).
    turning
        Acceleration for which the aircraft banks, and its derivative in n, (m/s2, m/s3).
    air
        W, velocity of the air over ground, and its derivative in n, (m/s, m/s2).
    lift
        alpha_0 and ``lift_length``, (rad, m).

    Returns
    -------
    C_nb, and the rate of b with respect to n in b, rad/s
    """
    u, u1 = velocity[0] - air[0], velocity[1] - air[1]
    across2 = np.maximum(u[0] * u[0] + u[1] * u[1], 1.0)
    across = np.sqrt(across2)
    across_rate = (u[0] * u1[0] + u[1] * u1[1]) / across
    course_sine, course_cosine = u[1] / across, u[0] / across
    course_rate = (u[0] * u1[1] - u[1] * u1[0]) / across2
    climb_tangent = -u[2] / across
    climb_cosine = 1.0 / np.sqrt(1.0 + climb_tangent * climb_tangent)
    climb_sine = climb_tangent * climb_cosine
    climb_rate = climb_cosine * climb_cosine * (-u1[2] - climb_tangent * across_rate) / across

    acceleration, jerk = turning
    forward = acceleration[0] * course_cosine + acceleration[1] * course_sine
    sideward = acceleration[1] * course_cosine - acceleration[0] * course_sine
    sideward_rate = jerk[1] * course_cosine - jerk[0] * course_sine - course_rate * forward
    weight = STANDARD_GRAVITY - acceleration[2]
    bank_tangent = sideward / weight
    bank_cosine = 1.0 / np.sqrt(1.0 + bank_tangent * bank_tangent)
    bank_sine = bank_tangent * bank_cosine
    bank_rate = bank_cosine * bank_cosine * (sideward_rate + bank_tangent * jerk[2]) / weight

    zero_lift_angle, lift_length = lift
    airspeed2 = across2 + u[2] * u[2]
    lifting = weight / bank_cosine
    lifting_rate = (sideward * sideward_rate - weight * jerk[2]) / lifting
    needed = lift_length * lifting / airspeed2
    needed_rate = (lift_length * lifting_rate - 2.0 * needed * (across * across_rate + u[2] * u1[2])) / airspeed2
    square = needed * needed / (STALL * STALL)
    excess = 1.0 + square * square * square * square
    root = np.sqrt(np.sqrt(np.sqrt(excess)))
    alpha = zero_lift_angle + needed / root
    alpha_rate = needed_rate / (root * excess)
    sine, cosine = np.sin(alpha), np.cos(alpha)
    c_wb = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    c_nw = attitude.dcm_from_sines(bank_sine, bank_cosine, climb_sine, climb_cosine, course_sine, course_cosine)
    rate_w = attitude.body_rate(bank_rate, climb_rate, course_rate, bank_sine, bank_cosine, climb_sine, climb_cosine)
    return c_nw @ c_wb, c_wb.T @ rate_w + alpha_rate * np.array([0.0, 1.0, 0.0])


def inertial(latitude, altitude, velocity_n, acceleration_n, c_nb, rate_nb):
    """Specific force and rate of b with respect to inertial space, both in b: (5) and its counterpart for the rate."""
    earth_rate = earth.earth_rate(latitude)
    transport = earth.transport_rate(latitude, altitude, velocity_n)
    down = earth.gravity(latitude, altitude)
    force_n = acceleration_n + np.cross(2.0 * earth_rate + transport, velocity_n) - np.array([0.0, 0.0, 1.0]) * down
    return c_nb.T @ force_n, c_nb.T @ (earth_rate + transport) + rate_nb


def euler(c_nb, track, track_sine, track_cosine):
    """Roll, pitch, and the heading that is within pi of the track (so it is continuous where the track is), rad."""
    roll, pitch, _ = attitude.euler(c_nb)
    north, east = c_nb[0, 0], c_nb[1, 0]
    crab = np.arctan2(east * track_cosine - north * track_sine, north * track_cosine + east * track_sine)
    return roll, pitch, track + crab


def flow(c_nb, relative_n):
    """True airspeed (m/s), angle of attack and sideslip (rad) of the velocity relative to the air, n.

    alpha = atan(w / u), beta = asin(v / V) of its components u, v, w in b.
    """
    forward, right, down = c_nb.T @ relative_n
    airspeed = np.sqrt(forward * forward + right * right + down * down)
    return airspeed, np.arctan2(down, forward), np.arcsin(np.clip(right / np.maximum(airspeed, 1e-3), -1.0, 1.0))
