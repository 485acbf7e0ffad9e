"""Where a satellite is and how it moves, from what it says of its orbit: IS-GPS-200 table 20-IV.

Frame e is earth-centred, earth-fixed at the time asked for: who receives a signal later must turn it by the angle that
the earth has turned meanwhile. The position is that of the antenna's phase centre. All functions take parameters of one
satellite or arrays of them.
"""

from __future__ import annotations

import numpy as np

from models.satellite import sines
from models.satellite.gps_time import elapsed
from models.satellite.kepler import eccentric_anomaly

GRAVITATION = 3.986005e14
"""mu, m3/s2: the value of WGS-84 that the parameters are fitted with, not the newest one."""
EARTH_RATE = 7.2921151467e-5
"""Rate of e with respect to inertial space, rad/s: the value that IS-GPS-200 demands, WGS-84 itself has 7.292115e-5."""


def mean_motion(ephemeris):
    """n = n_0 + Delta n, rad/s, n_0 = sqrt(mu / A^3)."""
    a = ephemeris.semi_major_axis
    return np.sqrt(GRAVITATION / (a * a * a)) + ephemeris.mean_motion_difference


def anomaly(ephemeris, week, second):
    """Eccentric anomaly E_k, its sine and cosine, and its rate (rad/s)."""
    n = mean_motion(ephemeris)
    mean = ephemeris.mean_anomaly + n * elapsed(week, second, ephemeris.toe_week, ephemeris.toe)
    eccentric = eccentric_anomaly(mean, ephemeris.eccentricity)
    return eccentric, n / (1.0 - ephemeris.eccentricity * eccentric[1])


def state(ephemeris, week, second):
    """Position (m) and velocity (m/s) in e, each (..., 3): table 20-IV, parts 1 to 3.

    Velocity is the derivative of the position with respect to time in the turning frame e.
    """
    return state_at(ephemeris, anomaly(ephemeris, week, second), week, second)


def state_at(ephemeris, anomaly, week, second):
    """The same where ``anomaly`` = ((sine, cosine) of E_k, its rate) is known.

    The correction of the argument of latitude is below 2e-4, and two terms of its series are enough.
    """
    o, ((sine, cosine), eccentric_rate) = ephemeris, anomaly
    t = elapsed(week, second, o.toe_week, o.toe)
    a, e = o.semi_major_axis, o.eccentricity
    flat = np.sqrt(1.0 - e * e)
    share = 1.0 - e * cosine
    true_anomaly = flat * sine / share, (cosine - e) / share
    phi = sines.both(true_anomaly, sines.of(o.perigee))
    phi_rate = flat * eccentric_rate / share
    s2, c2 = sines.both(phi, phi)
    # argument of latitude, radius, inclination: second harmonic corrections
    du = o.cus * s2 + o.cuc * c2
    r = a * share + o.crs * s2 + o.crc * c2
    i = o.inclination + o.inclination_rate * t + o.cis * s2 + o.cic * c2
    u_rate = phi_rate * (1.0 + 2.0 * (o.cus * c2 - o.cuc * s2))
    r_rate = a * e * sine * eccentric_rate + 2.0 * phi_rate * (o.crs * c2 - o.crc * s2)
    i_rate = o.inclination_rate + 2.0 * phi_rate * (o.cis * c2 - o.cic * s2)
    # in the plane of the orbit
    su, cu = sines.both(phi, (du - du * du * du / 6.0, 1.0 - 0.5 * du * du))
    x, y = r * cu, r * su
    x_rate, y_rate = r_rate * cu - y * u_rate, r_rate * su + x * u_rate
    # into e
    node_rate = o.node_rate - EARTH_RATE
    node = o.node + node_rate * t - EARTH_RATE * o.toe
    (so, co), (si, ci) = sines.of(node), sines.of(i)
    across, across_rate = y * ci, y_rate * ci - y * si * i_rate
    x_e, y_e, z_e = x * co - across * so, x * so + across * co, y * si
    velocity = (
        x_rate * co - across_rate * so - y_e * node_rate,
        x_rate * so + across_rate * co + x_e * node_rate,
        y_rate * si + y * ci * i_rate,
    )
    return np.stack([x_e, y_e, z_e], axis=-1), np.stack(velocity, axis=-1)
