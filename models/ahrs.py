"""Attitude and heading from gyros, aided by accelerometers and magnetometers.

Thesis section 4.11.1 (Euler angle filter, (4.32)-(4.51)), 4.12 (aiding, gates, Table 4.4), 4.8 (levelling). States of
the filter are errors, true minus estimated, of [roll, pitch, heading, b_p, b_q, b_r].

What differs from the thesis, and why:

- (4.35), (4.45) print -cos(roll) for -sin(roll) in row 2, column 3; compare (4.4). The correct form is used.
- F (4.34) has zeros for the effect of attitude errors on the Euler rates. In a turn at omega they are not small: a roll
  error becomes a pitch error at the rate omega. The full Jacobian is used (:func:`dynamics`).
- The magnetometer is used as a vector, three scalar measurements of the direction of the field (:func:`field_rows`),
  instead of as a levelled heading. In level flight that is the same. In a turn, when the accelerometers are cut off, it
  keeps roll and pitch observable as the field comes from ever other directions, and a gyro of 0.05 deg/s does not run
  away in a series of 360-degree turns.
- Gains are computed and not scheduled: at the slow rate of the aiding they cost next to nothing.
"""

from __future__ import annotations

import numpy as np

from models import attitude, kalman


def level(specific_force):
    """Roll and pitch, rad, of an aircraft that does not accelerate, thesis (4.8), (4.9) for any attitude."""
    x, y, z = specific_force[0], specific_force[1], specific_force[2]
    return np.arctan2(-y, -z), np.arctan2(x, np.sqrt(y * y + z * z))


def levelled_heading(field_b, roll, pitch):
    """Magnetic heading, rad, of the field levelled by roll and pitch, thesis (2.3), and the field's downward part."""
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    turned = sr * field_b[1] + cr * field_b[2]
    forward = cp * field_b[0] + sp * turned
    right = cr * field_b[1] - sr * field_b[2]
    down = -sp * field_b[0] + cp * turned
    return np.arctan2(-right, forward), down


def field_n(dip, declination):
    """Direction of the earth's field in n."""
    return np.array([np.cos(dip) * np.cos(declination), np.cos(dip) * np.sin(declination), np.sin(dip)])


def length(vector):
    return np.sqrt(np.sum(vector * vector))


def gates(heading_change, roll_change, time, specific_force, gravity, rate_limit, force_limit):
    """Whether the aircraft flies straight, and whether it is unaccelerated too: thesis (4.67) and the 1.05 g gate.

    ``heading_change`` (rad) over ``time`` (s) is the computed yaw rate. The same limit is applied to the computed roll
    rate (own addition): while an aircraft rolls into a turn its yaw rate is small still, and the accelerometers, which
    feel no roll in a coordinated turn, are wrong already. ``force_limit`` is the allowed departure of the specific
    force from 1 g, to both sides (the thesis tests the upper one).
    """
    straight = np.maximum(np.abs(heading_change), np.abs(roll_change)) <= rate_limit * time
    quiet = np.abs(length(specific_force) - gravity) <= force_limit * gravity
    return straight, np.logical_and(straight, quiet)


def dynamics(roll, pitch, rate, time):
    """Phi of the six error states over ``time`` s, rates and attitude taken as constant.

    Derivatives of (4.4) with respect to roll and pitch, and (4.35) for the gyro biases. The biases hold their values: a
    null shift does, and the part that drifts is taken as a random walk (the thesis's -1/tau would pull the null shift
    to zero).
    """
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    tp = sp / cp
    turning = rate[1] * sr + rate[2] * cr
    nodding = rate[1] * cr - rate[2] * sr
    t = time
    return np.array(
        [
            [1.0 + t * nodding * tp, t * turning / (cp * cp), 0.0, -t, -t * sr * tp, -t * cr * tp],
            [-t * turning, 1.0, 0.0, 0.0, -t * cr, t * sr],
            [t * nodding / cp, t * turning * tp / cp, 1.0, 0.0, -t * sr / cp, -t * cr / cp],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ]
    )


def process_noise(angle_density, drift_sigma, drift_time, time):
    """C_d over ``time`` s, packed: (4.39)-(4.44). ``angle_density`` in rad^2/s, drift (3.5) 2 sigma^2 / tau in
    rad^2/s^3.

    Roll, pitch and heading are driven alike: the mapping f(pitch, roll) of (4.39) is near a rotation below 20 degrees
    of pitch.
    """
    drift = 2.0 * drift_sigma * drift_sigma / drift_time
    a, b = angle_density * time, drift * time
    return kalman.of_variances(np.array([a, a, a, b, b, b]))


def field_rows(roll, pitch, heading, direction_n):
    """Direction of the field in b at the estimated attitude, and its derivatives by roll, pitch and heading.

    Turning the aircraft about a unit vector u by a small angle turns a fixed vector, seen in b, by the opposite:
    dv = -u x v. u is the forward axis for roll, (0, cos roll, -sin roll) for pitch and down for heading.
    Returns v and a 3 x 3 matrix, row i the derivatives of v[i].
    """
    c_nb = attitude.dcm(roll, pitch, heading)
    v = c_nb.T @ direction_n
    zero = 0.0 * roll
    by_roll = np.array([zero, v[2], -v[1]])
    sr, cr = np.sin(roll), np.cos(roll)
    by_pitch = np.array([-cr * v[2] - sr * v[1], sr * v[0], cr * v[0]])
    by_heading = c_nb.T @ np.array([direction_n[1], -direction_n[0], zero])
    return v, np.stack([by_roll, by_pitch, by_heading], axis=1)
