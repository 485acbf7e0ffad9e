"""Delay of the troposphere at the zenith: Saastamoinen (1972), standard atmosphere, a humidity that is given.

Davis et al. (1985) for the hydrostatic part: 0.0022768 p / (1 - 0.00266 cos 2 phi - 0.00028 h) with p in hPa and h in
km; Saastamoinen for the wet one: 0.002277 (1255 / T + 0.05) e, T in K and e in hPa. 15 degC are 288.16 K, as in RTKLIB.
"""

from __future__ import annotations

import numpy as np

HUMIDITY = 0.7
"""Relative humidity at the receiver; usual where none is measured."""


def zenith(latitude, altitude, humidity=HUMIDITY):
    """Hydrostatic and wet delay at the zenith, m; ``latitude`` rad, ``altitude`` m, from 0 on.

    Pressure falls as in the lower 11 km of the standard atmosphere also above, where it is less than 0.1 m of delay.
    """
    height = np.maximum(altitude, 0.0)
    pressure = 1013.25 * np.maximum(1.0 - 2.2557e-5 * height, 0.0) ** 5.2568
    temperature = np.maximum(288.16 - 6.5e-3 * height, 216.65)
    vapour = 6.108 * humidity * np.exp((17.15 * temperature - 4684.0) / (temperature - 38.45))
    hydrostatic = 0.0022768 * pressure / (1.0 - 0.00266 * np.cos(2.0 * latitude) - 0.00028e-3 * height)
    return hydrostatic, 0.002277 * (1255.0 / temperature + 0.05) * vapour


def slant(zenith_delay, sine):
    """Delay along a line of sight by the cosecant of its elevation, that of the flat earth; its ``sine`` is given."""
    return zenith_delay / sine
