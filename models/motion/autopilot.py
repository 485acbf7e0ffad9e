"""An autopilot that flies a light aircraft along a plan: course, altitude and airspeed.

Each channel is a cascade whose outer loop asks the inner one for a bank, a climb, a rate (chi course over ground, h
altitude, V airspeed, V_g ground speed, index p the plan, index c what is asked for):

    bank      phi_c   = atan(V_g (chi'_p + k_chi wrap(chi_p - chi)) / g)       the coordinated turn              (1)
    climb     h'_c    = h'_p + k_h (h_p - h)                                                                     (2)
    pitch     theta_c = k_w e / V + I_w,   I_w' = (k_w / T_w) e / V,   e = h'_c - h'                             (3)
    aileron   = a_0 + k_p (k_phi (phi_c - phi) - p) + I_phi                                                      (4)
    elevator  = e_0 - k_q (k_theta (theta_c - theta) + q_turn - q),   q_turn = g tan(phi) sin(phi) / V           (5)
    throttle  = k_V (V_p - V) + I_V                                                                              (6)
    rudder    = r_0 - k_beta beta + k_r (r - r_turn),   r_turn = g sin(phi) / V                                  (7)

Integrals stand still while what they drive is at its limit. Controls are -1 to 1 (throttle 0 to 1); a positive aileron
rolls to the right, a positive elevator lowers the nose, a positive rudder turns it to the left. The gains were chosen
for a Cessna 172 at 30 to 60 m/s by its answer to steps of each control.
"""

from __future__ import annotations

import numpy as np

from models.attitude.attitude import wrap
from navfmu.constants import STANDARD_GRAVITY

COURSE_RATE = 0.1
"""k_chi, 1/s."""
STEEPEST_BANK = np.radians(35.0)
ALTITUDE_RATE = 0.1
"""k_h, 1/s."""
FASTEST_CLIMB = 4.0
"""Largest difference between h'_c and h'_p, m/s."""
CLIMB_GAIN, CLIMB_TIME = 0.8, 4.0
"""k_w, and T_w in s."""
STEEPEST_PITCH = np.radians(15.0)
ROLL_RATE, ROLL_GAIN, ROLL_TIME = 1.5, 2.0, 8.0
"""k_phi in 1/s, k_p in s, time of its integral in s."""
PITCH_RATE, PITCH_GAIN = 3.0, 3.0
"""k_theta in 1/s, k_q in s."""
SPEED_GAIN, SPEED_TIME = 0.08, 10.0
"""k_V in s/m, time of its integral in s."""
SIDESLIP_GAIN, YAW_GAIN = 1.0, 0.5
"""k_beta, and k_r in s."""


def asked_bank(course, ground_speed, planned_course, planned_turn_rate):
    """phi_c (1), rad."""
    turn_rate = planned_turn_rate + COURSE_RATE * wrap(planned_course - course)
    return np.clip(np.arctan(ground_speed * turn_rate / STANDARD_GRAVITY), -STEEPEST_BANK, STEEPEST_BANK)


def asked_climb(altitude, planned_altitude, planned_climb):
    """h'_c (2), m/s upward."""
    return planned_climb + np.clip(ALTITUDE_RATE * (planned_altitude - altitude), -FASTEST_CLIMB, FASTEST_CLIMB)


def roll(bank, bank_asked, roll_rate, integral, trim, period):
    """Aileron (4) and I_phi."""
    error = bank_asked - bank
    moved = integral + period * ROLL_GAIN * ROLL_RATE / ROLL_TIME * error
    aileron = trim + ROLL_GAIN * (ROLL_RATE * error - roll_rate)
    return _driven(aileron, integral, moved, -1.0, 1.0)


def pitch(climb, climb_asked, airspeed, integral, period):
    """theta_c (3) and I_w, rad."""
    error = (climb_asked - climb) / airspeed
    moved = integral + period * CLIMB_GAIN / CLIMB_TIME * error
    return _driven(CLIMB_GAIN * error, integral, moved, -STEEPEST_PITCH, STEEPEST_PITCH)


def elevator(pitch, pitch_asked, pitch_rate, bank, airspeed, trim):
    """Elevator (5)."""
    turning = STANDARD_GRAVITY * np.tan(bank) * np.sin(bank) / airspeed
    return np.clip(trim - PITCH_GAIN * (PITCH_RATE * (pitch_asked - pitch) + turning - pitch_rate), -1.0, 1.0)


def throttle(airspeed, planned_airspeed, integral, period):
    """Throttle (6) and I_V."""
    error = planned_airspeed - airspeed
    return _driven(SPEED_GAIN * error, integral, integral + period * SPEED_GAIN / SPEED_TIME * error, 0.0, 1.0)


def rudder(sideslip, yaw_rate, bank, airspeed, trim):
    """Rudder (7)."""
    turning = STANDARD_GRAVITY * np.sin(bank) / airspeed
    return np.clip(trim - SIDESLIP_GAIN * sideslip + YAW_GAIN * (yaw_rate - turning), -1.0, 1.0)


def _driven(proportional, integral, moved, low, high):
    """The sum within its limits, and the integral, which stands still where the sum is beyond them."""
    total = proportional + moved
    inside = np.logical_and(total > low, total < high)
    return np.clip(total, low, high), np.where(inside, moved, integral)
