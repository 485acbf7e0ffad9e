"""Standard atmosphere up to 11 km (ISO 2533), with another temperature and pressure at sea level if wished.

Temperature falls linearly with geopotential altitude H, T = T_0 - lambda H, and the hydrostatic equation gives
p = p_0 (T / T_0)^(g / (R lambda)); solved for H this is thesis (2.1), p. 24. R is the *specific* gas constant of air
(the thesis calls it universal). Heights in m, pressures in Pa, temperatures in K.
"""

from __future__ import annotations

import numpy as np

from models.earth.earth import STANDARD_GRAVITY

TEMPERATURE = 288.15
"""T_0, K."""
PRESSURE = 101325.0
"""p_0, Pa."""
LAPSE_RATE = 0.0065
"""lambda, K/m."""
GAS_CONSTANT = 287.05287
"""R of air, J/(kg K)."""
HEAT_RATIO = 1.4
SPEED_OF_SOUND = float(np.sqrt(HEAT_RATIO * GAS_CONSTANT * TEMPERATURE))
"""At sea level, m/s."""
EXPONENT = STANDARD_GRAVITY / (GAS_CONSTANT * LAPSE_RATE)
RADIUS = 6356766.0
"""Radius of the earth in the definition of geopotential altitude, m."""


def geopotential(height):
    """Geopotential altitude from the height above mean sea level."""
    return RADIUS * height / (RADIUS + height)


def temperature(geopotential_altitude, deviation=0.0):
    """Static temperature; ``deviation`` is added at all altitudes."""
    return TEMPERATURE + deviation - LAPSE_RATE * geopotential_altitude


def pressure(geopotential_altitude, deviation=0.0, sea_level_pressure=PRESSURE):
    """Static pressure; a warmer column is less dense, so its pressure falls more slowly."""
    base = TEMPERATURE + deviation
    return sea_level_pressure * (1.0 - LAPSE_RATE * geopotential_altitude / base) ** EXPONENT


def pressure_altitude(static_pressure):
    """Altitude at which the standard atmosphere has this pressure, thesis (2.1)."""
    return TEMPERATURE / LAPSE_RATE * (1.0 - (static_pressure / PRESSURE) ** (1.0 / EXPONENT))


def density(static_pressure, static_temperature):
    """Density of air, kg/m3."""
    return static_pressure / (GAS_CONSTANT * static_temperature)


def speed_of_sound(static_temperature):
    """Speed of sound, m/s."""
    return np.sqrt(HEAT_RATIO * GAS_CONSTANT * static_temperature)
