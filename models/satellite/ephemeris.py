"""What a satellite says of its orbit and its clock, as a row of numbers: IS-GPS-200 tables 20-I and 20-III.

An almanac and a nominal slot are the same row with fewer numbers: what they do not say is zero. SI units and radians,
semicircles are converted where files are read; weeks are counted without rollover.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Ephemeris(NamedTuple):
    """Parameters of one satellite, or of many: each then an array of one shape."""

    place: Any
    """Where the row stands in a table: :func:`models.satellite.selection.place` of ``prn`` and ``toe``."""
    prn: Any
    toe_week: Any
    toe: Any
    """t_oe, reference time of the orbit (almanac: t_oa), s of the week ``toe_week``."""
    semi_major_axis: Any
    """A, m; messages have its square root."""
    eccentricity: Any
    inclination: Any
    """i_0 at t_oe, rad."""
    node: Any
    """Omega_0, rad: longitude of the ascending node at the beginning of ``toe_week``, not a right ascension."""
    perigee: Any
    """omega, argument of perigee, rad."""
    mean_anomaly: Any
    """M_0 at t_oe, rad."""
    node_rate: Any = 0.0
    """Rate of right ascension, rad/s."""
    inclination_rate: Any = 0.0
    mean_motion_difference: Any = 0.0
    """Delta n, rad/s."""
    cuc: Any = 0.0
    cus: Any = 0.0
    crc: Any = 0.0
    crs: Any = 0.0
    cic: Any = 0.0
    cis: Any = 0.0
    """Amplitudes of cosine and sine corrections to argument of latitude (rad), radius (m) and inclination (rad)."""
    toc_week: Any = 0.0
    toc: Any = 0.0
    """t_oc, reference time of the clock, s of the week ``toc_week``."""
    clock_bias: Any = 0.0
    clock_drift: Any = 0.0
    clock_drift_rate: Any = 0.0
    """a_f0 (s), a_f1 (s/s), a_f2 (s/s2)."""
    group_delay: Any = 0.0
    """T_GD, s."""
    accuracy: Any = 0.0
    """User range accuracy, m; 0 where nothing is said."""
    health: Any = 0.0
    """0: all signals are good."""
    issue: Any = 0.0
    """Issue of data, ephemeris."""
    sent_week: Any = 0.0
    sent: Any = 0.0
    """When the message was sent, s of the week ``sent_week``: before that no receiver can have it."""
    limit: Any = 0.0
    """How far from t_oe the parameters hold, s."""

    @classmethod
    def of(cls, rows) -> Ephemeris:
        """The parameters in rows (..., columns) of a table, each (...)."""
        return cls(*np.moveaxis(rows, -1, 0))

    def rows(self) -> np.ndarray:
        """Rows of a table (..., columns)."""
        return np.stack(np.broadcast_arrays(*self), -1)

    def of_gps(self):
        """Whether it is an orbit of GPS (26 560 km, 55 degrees) in m and rad: others are in other units, or columns
        have shifted."""
        size = (self.semi_major_axis > 2.5e7) & (self.semi_major_axis < 2.81e7) & (np.abs(self.eccentricity) < 0.1)
        angles = np.stack([self.node, self.perigee, self.mean_anomaly])
        return size & (np.abs(self.inclination - 0.95) < 0.35) & np.all(np.abs(angles) < 6.4, axis=0)


_SECONDS = ("toe", "toc", "clock_bias", "group_delay", "sent", "limit")
_RADIANS = ("inclination", "node", "perigee", "mean_anomaly", "cuc", "cus", "cic", "cis")
_RATES = ("node_rate", "inclination_rate", "mean_motion_difference")
_UNITS = {
    **dict.fromkeys(_SECONDS, "s"),
    **dict.fromkeys(_RADIANS, "rad"),
    **dict.fromkeys(_RATES, "rad/s"),
    **dict.fromkeys(("semi_major_axis", "crc", "crs", "accuracy"), "m"),
    "clock_drift_rate": "1/s",
}
COLUMNS = tuple((name, _UNITS.get(name, "1")) for name in Ephemeris._fields)
"""(name, unit) of the columns of a table of orbits; rows are in the order of ``place``."""
