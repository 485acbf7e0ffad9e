"""Lines of a pitot-static system: volumes of air that are joined to the outside by narrow tubes.

Through a tube of length L and diameter d air flows in layers; the volume C of the instruments behind it fills with the
time constant (Hagen and Poiseuille; for pitot-static tubing in Gracey, NASA RP-1046, 1980)

    tau = 128 mu L C / (pi d^4 p),    tau = tau_0 (p_0 / p) (mu / mu_0),                                          (1)

0.02 s with 5 m of 4.7 mm and 0.3 l at sea level, and 3.6 times as much at 11 km. A line has several openings: a port,
a drain hole, a leak. With g_i the flow through one of them, relative to that through the clear tube, and p_i the
pressure before it,

    tau p' = sum g_i (p_i - p),    it settles at  sum g_i p_i / sum g_i  with  tau / sum g_i.                     (2)

Where all openings are shut the pressure is trapped.

Water stands in the lowest place of a line as in a U-tube: pressure gets past it, as bubbles, only as far as it differs
by more than the water's height,

    |p_instrument - p| <= rho_w g h.                                                                              (3)

So the instrument sticks, then follows late: a play. Pressures in Pa.
"""

from __future__ import annotations

import numpy as np

from models.air import atmosphere
from navfmu.constants import STANDARD_GRAVITY

WATER = 1000.0 * STANDARD_GRAVITY
"""rho_w g, Pa/m."""
VISCOSITY = 1.7894e-5
"""mu_0 of air at sea level in the standard atmosphere, Pa s; ISO 2533."""
SMALLEST = 1e-9
"""Stands for an opening that is shut, where one divides by openings."""


def fill_time(length, diameter, volume):
    """tau_0 of (1), s, at sea level in the standard atmosphere, of a tube (m, m) and the volume behind it (m3)."""
    return 128.0 * VISCOSITY * length * volume / (np.pi * diameter**4 * atmosphere.PRESSURE)


def lag_time(sea_level_time, pressure, temperature):
    """tau of (1), s, in air of this pressure and temperature."""
    return sea_level_time * atmosphere.PRESSURE / pressure * atmosphere.viscosity_ratio(temperature)


def settled(reference, differences, openings):
    """Pressure at which a line settles by (2), and the sum of its openings.

    Parameters
    ----------
    reference
        Any pressure, for example that before the port.
    differences
        One for each opening: the pressure before it, less the reference.
    openings
        g_i, of each; nothing flows through one of less than 0.
    """
    openings = [np.fmax(opening, 0.0) for opening in openings]
    total = sum(openings)
    flow = sum(opening * difference for opening, difference in zip(openings, differences, strict=True))
    return reference + flow / np.maximum(total, SMALLEST), total


def behind(value, before, now, ratio):
    """Output of a first-order lag one period later: exact for an input that goes evenly from ``before`` to ``now``.

    ``ratio`` is the time constant by the period; 0 is no lag at all. What is no number is forgotten: the lag begins
    anew.
    """
    decay = np.exp(-1.0 / np.maximum(ratio, 1e-3))
    later = now + decay * (value - before) - (now - before) * ratio * (1.0 - decay)
    return np.where(np.isfinite(value + before), later, now)


def filled(line, before, now, opening, ratio):
    """Pressure in a line one period later, by (2).

    Parameters
    ----------
    line
        What it was.
    before, now
        Where it would have settled then and settles now.
    opening
        Sum of the openings now; with none the pressure is trapped.
    ratio
        Time constant of the clear tube, by the period.
    """
    trapped = (opening <= 0.0) & np.isfinite(line)
    return np.where(trapped, line, behind(line, before, now, ratio / np.maximum(opening, SMALLEST)))


def past_water(shown, line, height):
    """Pressure at the instrument, (3): what it was, as near to the line's as the water (m) holds it off."""
    held_off = WATER * np.fmax(height, 0.0)
    return np.clip(np.where(np.isfinite(shown), shown, line), line - held_off, line + held_off)


def grown(ice, target, period, freezing_time, melting_time):
    """Share of an opening that ice closes, a period later: evenly towards the target, in these times from 0 to 1, s."""
    target = np.fmin(np.fmax(target, 0.0), 1.0)  # 0 for what is no number
    return np.clip(target, ice - period / melting_time, ice + period / freezing_time)
