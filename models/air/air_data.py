"""The pitot-static chain: from the air around the aircraft to airspeed and pressure altitude.

Thesis section 2.5.3, p. 24. The thesis's (2.2), V_c = sqrt(2 dP / rho), is the incompressible limit; here the
isentropic formula that airspeed indicators are built to is used: with M the Mach number and q_c the difference of total
and static pressure,

    q_c = p ((1 + M^2 / 5)^(7/2) - 1),    M = sqrt(5 ((q_c / p + 1)^(2/7) - 1)).                                 (1)

At 50 m/s the two differ by 0.5 %. How the pressures come through the lines to the instruments, or do not, is in
``models.air.pneumatics``.

The flow around the aircraft changes the static pressure at the port (thesis (3.31), the part that it says depends on
angle of attack and sideslip) by the part C_p of q_c, the position error. The probe is warmed by a part r of what the
air is warmed by where it stops, its recovery factor: T_probe = T (1 + r M^2 / 5).

What errors of the instrument are in true airspeed follows from (1) by its derivative,

    d(q_c / p)/dM = 7/5 M (1 + M^2 / 5)^(5/2).                                                                       (2)

An error of indicated airspeed grows with height: at low Mach numbers as one over the root of the relative density.
Where the probe is warmed by the flow the temperature has a part in it: V^2 is proportional to M^2 / (1 + r M^2 / 5), so

    dV/V = dM/M / (1 + r M^2 / 5).                                                                                   (3)
"""

from __future__ import annotations

import numpy as np

from models.air import atmosphere

LEAST_DIFFERENCE = 1.0
"""Pa: the airspeed of 1.3 m/s, below which no airspeed indicator shows any."""


def impact_ratio(mach):
    """q_c / p of (1)."""
    x = 1.0 + 0.2 * mach * mach
    return x * x * x * np.sqrt(x) - 1.0


def impact_slope(mach):
    """Derivative of q_c / p by M, (2)."""
    x = 1.0 + 0.2 * mach * mach
    return 1.4 * mach * x * x * np.sqrt(x)


def mach(impact_ratio):
    """M of (1) from q_c / p; zero where the difference of pressures is negative."""
    return np.sqrt(5.0 * np.maximum((1.0 + np.maximum(impact_ratio, 0.0)) ** (2.0 / 7.0) - 1.0, 0.0))


def is_known(mach):
    """Whether (1) holds: below the speed of sound. Above it a shock stands before the tube."""
    return mach < 1.0


def pressures(true_airspeed, geopotential_altitude, deviation, sea_level_pressure):
    """Static pressure, total pressure (Pa) and static temperature (K) of the air at the ports."""
    temperature = atmosphere.temperature(geopotential_altitude, deviation)
    static = atmosphere.pressure(geopotential_altitude, deviation, sea_level_pressure)
    return static, static * (1.0 + impact_ratio(true_airspeed / atmosphere.speed_of_sound(temperature))), temperature


def flow_angles(air_velocity_b):
    """Angle of attack and sideslip, rad, of the velocity through the air (3,), m/s, in body axes; 0 at rest."""
    u, v, w = air_velocity_b
    return np.arctan2(w, u), np.arctan2(v, np.hypot(u, w))


def position_coefficient(constant, attack_slope, sideslip_square, attack, sideslip):
    """C_p of the static port: pressure there less that of the undisturbed air, by q_c."""
    return constant + attack_slope * attack + sideslip_square * sideslip * sideslip


def stagnation_ratio(mach, recovery):
    """T_probe / T."""
    return 1.0 + 0.2 * recovery * mach * mach


def sensed(difference, gain_error, offset):
    """Difference of pressures as the transducer shows it, Pa."""
    return (1.0 + gain_error) * difference + offset


def calibrated_airspeed(difference):
    """Airspeed that gives this q_c (Pa) at sea level in the standard atmosphere, m/s."""
    return atmosphere.SPEED_OF_SOUND * mach(difference / atmosphere.PRESSURE)


def impact_pressure(calibrated):
    """Difference of pressures (Pa) of which :func:`calibrated_airspeed` makes this airspeed (m/s)."""
    return atmosphere.PRESSURE * impact_ratio(calibrated / atmosphere.SPEED_OF_SOUND)


def true_mach(calibrated, static):
    """Mach number from calibrated airspeed with the measured static pressure."""
    return mach(impact_pressure(calibrated) / static)


def true_airspeed(calibrated, static, temperature):
    """True airspeed from calibrated airspeed with the measured static pressure and temperature, m/s."""
    return atmosphere.speed_of_sound(temperature) * true_mach(calibrated, static)


def true_airspeed_sigma(calibrated, static, temperature, airspeed, gain, offset, probe, recovery=0.0):
    """Standard deviation of :func:`true_airspeed` by independent errors of the instrument, m/s.

    To first order, by (2), (3) and by V = a(T) M. Where the difference of pressures is less than its own error the root
    has no derivative of use, and that of as large a difference stands for it.

    Parameters
    ----------
    calibrated, static, temperature
        As :func:`true_airspeed` takes them, m/s, Pa, K.
    airspeed
        Sigma of the calibrated airspeed, m/s.
    gain, offset
        Sigmas of the difference of pressures, of :func:`sensed`: relative, and in Pa.
    probe
        Sigma of the temperature, K.
    recovery
        r of the probe.
    """
    least = calibrated_airspeed(np.hypot(offset, LEAST_DIFFERENCE))
    low = np.maximum(calibrated, least) / atmosphere.SPEED_OF_SOUND
    difference = atmosphere.PRESSURE * impact_ratio(low)
    high, sound = mach(difference / static), atmosphere.speed_of_sound(temperature)
    by_airspeed = atmosphere.PRESSURE * impact_slope(low) / atmosphere.SPEED_OF_SOUND
    pressure = np.sqrt((by_airspeed * airspeed) ** 2 + (gain * difference) ** 2 + offset**2)
    by_pressure = pressure / (static * impact_slope(high)) / stagnation_ratio(high, recovery)
    return sound * np.hypot(by_pressure, 0.5 * high * probe / temperature)
