"""What a satellite's clock is off, from what it says of it: IS-GPS-200 section 20.3.3.3.3.

Errors are those of the satellite's time, t_sv = t + error; in metres, times the speed of light, a pseudorange is too
short by that much.
"""

from __future__ import annotations

import numpy as np

from models.satellite import orbit
from models.satellite.gps_time import elapsed
from navfmu.constants import SPEED_OF_LIGHT

RELATIVITY = -4.442807633e-10
"""F = -2 sqrt(mu) / c^2, s/sqrt(m)."""


def polynomial(ephemeris, week, second):
    """a_f0 + a_f1 (t - t_oc) + a_f2 (t - t_oc)^2 in s, and its rate in s/s. It is all that an almanac has."""
    o, t = ephemeris, elapsed(week, second, ephemeris.toc_week, ephemeris.toc)
    error = o.clock_bias + t * (o.clock_drift + t * o.clock_drift_rate)
    return error, o.clock_drift + 2.0 * t * o.clock_drift_rate


def relativity(ephemeris, anomaly):
    """F e sqrt(A) sin(E) in s, and its rate in s/s; ``anomaly`` is that of :func:`models.satellite.orbit.anomaly`."""
    ((sine, cosine), rate), scale = anomaly, RELATIVITY * ephemeris.eccentricity * np.sqrt(ephemeris.semi_major_axis)
    return scale * sine, scale * cosine * rate


def error(ephemeris, week, second):
    """Error of the clock with relativity (s), and its rate (s/s); for both frequencies, without group delay."""
    return error_at(ephemeris, orbit.anomaly(ephemeris, week, second), week, second)


def error_at(ephemeris, anomaly, week, second):
    """The same where the anomaly is known."""
    told, drift = polynomial(ephemeris, week, second)
    relative, rate = relativity(ephemeris, anomaly)
    return told + relative, drift + rate


def on_l1(ephemeris, error):
    """The error that holds for the code on L1 alone, s: less the group delay, section 20.3.3.3.3.2."""
    return error - ephemeris.group_delay


def sending_time(ephemeris, week, second, pseudorange):
    """When the signal left the satellite, s of ``week`` in GPS time, of a pseudorange (m) received at ``second``.

    The satellite's clock showed ``second`` - pseudorange / c then, whatever the receiver's clock is off. Its polynomial
    is asked at that time, not yet corrected: with a drift of 1e-11 that is 1e-14 s.
    """
    shown = second - pseudorange / SPEED_OF_LIGHT
    told, _ = error(ephemeris, week, shown)
    return shown - told
