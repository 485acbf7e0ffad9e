"""Standard atmosphere up to 20 km (ISO 2533), with another temperature and pressure at sea level if wished.

Temperature falls linearly with geopotential altitude H, T = T_0 - lambda H, and the hydrostatic equation gives
p = p_0 (T / T_0)^(g / (R lambda)); solved for H this is thesis (2.1), p. 24. R is the *specific* gas constant of air
(the thesis calls it universal). From the tropopause at 11 km to 20 km the temperature T_s stays, and p falls as
exp(-g (H - 11 km) / (R T_s)). Heights in m, pressures in Pa, temperatures in K.
"""

from __future__ import annotations

import numpy as np

from navfmu.constants import STANDARD_GRAVITY

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
TROPOPAUSE = 11000.0
"""Geopotential altitude where the temperature stops falling, m."""
KNOWN = (-5000.0, 20000.0)
"""Geopotential altitudes between which the equations here are those of the standard, m."""
SUTHERLAND = 110.4
"""Temperature of Sutherland's law, K; ISO 2533, 2.13."""


def geopotential(height):
    """Geopotential altitude from the height above mean sea level."""
    return RADIUS * height / (RADIUS + height)


def temperature(geopotential_altitude, deviation=0.0):
    """Static temperature; ``deviation`` is added at all altitudes."""
    return TEMPERATURE + deviation - LAPSE_RATE * np.minimum(geopotential_altitude, TROPOPAUSE)


def pressure(geopotential_altitude, deviation=0.0, sea_level_pressure=PRESSURE):
    """Static pressure; a warmer column is less dense, so its pressure falls more slowly."""
    base = TEMPERATURE + deviation
    below = np.minimum(geopotential_altitude, TROPOPAUSE)
    above = np.maximum(geopotential_altitude - TROPOPAUSE, 0.0)
    scale = GAS_CONSTANT * (base - LAPSE_RATE * TROPOPAUSE) / STANDARD_GRAVITY
    return sea_level_pressure * (1.0 - LAPSE_RATE * below / base) ** EXPONENT * np.exp(-above / scale)


TROPOPAUSE_PRESSURE = float(pressure(TROPOPAUSE))
STRATOSPHERE_SCALE = GAS_CONSTANT * (TEMPERATURE - LAPSE_RATE * TROPOPAUSE) / STANDARD_GRAVITY
"""Height over which the pressure falls to 1/e above the tropopause, m."""


def pressure_altitude(static_pressure):
    """Altitude at which the standard atmosphere has this pressure, thesis (2.1)."""
    below = np.maximum(static_pressure, TROPOPAUSE_PRESSURE)
    above = np.minimum(static_pressure, TROPOPAUSE_PRESSURE)
    return TEMPERATURE / LAPSE_RATE * (1.0 - (below / PRESSURE) ** (1.0 / EXPONENT)) + STRATOSPHERE_SCALE * np.log(
        TROPOPAUSE_PRESSURE / above
    )


def is_known(geopotential_altitude):
    """Whether the equations hold at this altitude."""
    return (geopotential_altitude >= KNOWN[0]) & (geopotential_altitude <= KNOWN[1])


def density(static_pressure, static_temperature):
    """Density of air, kg/m3."""
    return static_pressure / (GAS_CONSTANT * static_temperature)


def speed_of_sound(static_temperature):
    """Speed of sound, m/s."""
    return np.sqrt(HEAT_RATIO * GAS_CONSTANT * static_temperature)


def viscosity_ratio(static_temperature):
    """Dynamic viscosity of air by that at sea level in the standard atmosphere, Sutherland's law of ISO 2533."""
    warmth = static_temperature / TEMPERATURE
    return warmth * np.sqrt(warmth) * (TEMPERATURE + SUTHERLAND) / (static_temperature + SUTHERLAND)
