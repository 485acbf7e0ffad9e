"""Attitude and heading from gyros, aided by accelerometers, airspeed and magnetometers.

Thesis section 4.11.1 (Euler angle filter, (4.32)-(4.51)), 4.12 (aiding), 4.8 (levelling). The states of the filter are
errors, true minus estimated, of

    [roll, pitch, heading | b_p, b_q, b_r | dip | m_x, m_y, m_z | v]                                             (1)

gyro biases (rad/s), dip of Earth's field (rad), hard iron over the strength of the field (1), airspeed (m/s).

What the accelerometers show. An aircraft whose air velocity lies along its nose, (V, 0, 0) in b, in air that moves
steadily, accelerates by V' (1, 0, 0) + w x (V, 0, 0) (Goldstein, *Classical Mechanics*, (4.86)), so the specific force
a - g is

    f_x = V' + g sin(pitch)
    f_y = V r - g sin(roll) cos(pitch)                                                                           (2)
    f_z = -V q - g cos(roll) cos(pitch)

and in a coordinated turn, f_y = 0, it shows no roll without V r. What (2) leaves out is the change of the wind, dW/dt,
and slip and angle of attack: white noise of the tilt to first order (a Gauss-Markov wind has a white derivative, of
density 2 sigma^2 / tau), but of an unknown, changing level. So its level is learned from the innovations
(:func:`learned`).

What differs from the thesis, and why:

- (4.35), (4.45) print -cos(roll) for -sin(roll) in row 2, column 3; compare (4.4). The correct form is used.
- F (4.34) has zeros for the effect of attitude errors on the Euler rates. In a turn at omega they are not small: a roll
  error becomes a pitch error at the rate omega. The full Jacobian is used (:func:`dynamics`).
- The magnetometer is used as a vector, three scalar measurements of the direction of the field (:func:`field_rows`),
  instead of as a levelled heading. In level flight that is the same.
- Gates ((4.67), the 1.05 g of p. 150) are gone: (2) holds in turns, too, and the accelerations of real flights are
  below any such gate.
- Gains are computed and not scheduled: at the slow rate of the aiding they cost next to nothing.
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY

STATES = 11
MOVING = 3
"""The first states, the angles, are driven by all; the others hold their values."""
PITCH, DIP, IRON, AIRSPEED = 1, 6, slice(7, 10), 10
TURN_TIME = 60.0
"""Time for which a turn lasts, s: as long a scale factor error of a gyro acts in one direction (own choice)."""
ENOUGH = 1.0 / 3.0
"""Share of a window from which on a sum of innovations tells of noise that lasts (own choice)."""


def level(specific_force, acceleration):
    """Roll and pitch, rad, thesis (4.8), (4.9), for any attitude; both arguments in b, m/s2."""
    x, y, z = specific_force - acceleration
    return np.arctan2(-y, -z), np.arctan2(x, np.sqrt(y * y + z * z))


def turning_acceleration(airspeed, rate):
    """w x (V, 0, 0) in b, m/s2, of (2)."""
    return np.array([0.0 * airspeed, airspeed * rate[2], -airspeed * rate[1]])


def tilt_residuals(specific_force, airspeed, rate, roll, pitch):
    """Lateral and longitudinal specific force of (2) over g, measured minus expected (without V'), in rad of tilt."""
    turning = airspeed * rate[2] / STANDARD_GRAVITY
    return np.array(
        [
            specific_force[1] / STANDARD_GRAVITY - turning + np.sin(roll) * np.cos(pitch),
            specific_force[0] / STANDARD_GRAVITY - np.sin(pitch),
        ]
    )


def tilt_rows(airspeed, yaw_rate, roll, pitch):
    """Derivatives of (2) over g by the states (1): lateral, longitudinal. The rate r and V have errors, too."""
    sr, cr, sp, cp = np.sin(roll), np.cos(roll), np.sin(pitch), np.cos(pitch)
    zero = 0.0 * roll
    by_bias, by_airspeed = -airspeed / STANDARD_GRAVITY, -yaw_rate / STANDARD_GRAVITY
    return np.array(
        [
            [-cr * cp, sr * sp, zero, zero, zero, by_bias, zero, zero, zero, zero, by_airspeed],
            [zero, cp, zero, zero, zero, zero, zero, zero, zero, zero, zero],
        ]
    )


def tilt_updates(upper, rows, residuals, sigma, uses, learning, least, limit):
    """Take the two tilt residuals, lateral and longitudinal, at the noise level that is learned.

    Parameters
    ----------
    rows, residuals, uses
        Of each: H, the residual in rad, whether there is one.
    sigma
        Noise of level 1, rad.
    learning
        Noise levels (variances over ``sigma`` squared), sums and numbers of innovations in this window, shape (3, 2).
    least, limit
        Of :func:`raised`.

    Returns
    -------
    Correction of the states (1), packed covariance, and ``learning`` with these two.
    """
    correction = np.zeros(STATES)
    after = []
    for axis, use in enumerate(uses):
        level_, total, count = learning[:, axis]
        innovation = (residuals[axis] - np.sum(rows[axis] * correction)) / sigma
        total = total + np.where(use, innovation, 0.0)
        count = count + np.where(use, 1.0, 0.0)
        level_ = raised(level_, total, count, least, limit)
        correction, upper, _ = kalman.update(
            correction, upper, rows[axis], level_ * sigma * sigma, residuals[axis], use
        )
        after.append(np.stack([level_, total, count]))
    return correction, upper, np.stack(after, axis=1)


def field_updates(correction, upper, rows, residuals, variance, use, misfit, limit):
    """Take the three residuals of the direction of the field.

    Innovations whose sum is beyond ``limit`` sigma are evidence that the hard iron has changed (a current on board,
    cargo), because nothing else jumps: its variance is raised by the square of that sum over their number, and so the
    iron takes the jump, not the heading.

    Parameters
    ----------
    misfit
        Sums of the innovations over their sigma in this window, and their number: 4 elements.

    Returns
    -------
    Correction, packed covariance, and ``misfit`` with these three, or anew after a jump.
    """
    iron = np.zeros(STATES)
    iron[IRON] = 1.0
    count = misfit[3] + np.where(use, 1.0, 0.0)
    totals, changed = [], False
    for axis in range(3):
        innovation = residuals[axis] - np.sum(rows[axis] * correction)
        spread = np.sum(rows[axis] * (kalman.unpack(upper) @ rows[axis])) + variance
        total = misfit[axis] + np.where(use, innovation / np.sqrt(spread), 0.0)
        square = total * total / np.maximum(count, 1.0)
        jumped = np.logical_and(use, square > limit * limit)
        upper = upper + kalman.of_variances(iron * np.where(jumped, square * spread, 0.0))
        correction, upper, _ = kalman.update(correction, upper, rows[axis], variance, residuals[axis], use)
        totals.append(total)
        changed = np.logical_or(changed, jumped)
    return correction, upper, np.where(changed, 0.0, np.stack([*totals, count]))


def angle_updates(correction, upper, residuals, variance, use):
    """Take the three angles as three antennas of GPS measure them: H = [I 0], thesis (4.47)-(4.51)."""
    for angle in range(MOVING):
        correction, upper, _ = kalman.update(correction, upper, np.eye(STATES)[angle], variance, residuals[angle], use)
    return correction, upper


def raised(level_, total, count, least, limit):
    """Noise level at which the sum of ``count`` white innovations of unit level is at most ``limit`` sigma.

    What does not fit is evidence against the noise level, not against the measurement: the opposite of a gate. Fewer
    innovations than ``least`` are taken for as many: what comes and goes at once, as a gust along does, which the
    airspeed shows and the force does not, is no evidence of noise that lasts.
    """
    return np.maximum(level_, total * total / (np.maximum(count, least) * limit * limit))


def learned(learning, gain, floor):
    """Noise levels after a window of innovations, matched to their covariance (Mehra, *IEEE Trans. Autom. Control*
    AC-17, 1972, p. 693); ``learning`` as in :func:`tilt_updates`.

    The square of their *sum* over their number is the variance of the white noise with the same density at low
    frequencies, however coloured it is within the window; that is what the slow states of the filter feel.
    """
    level_, total, count = learning
    seen = total * total / np.maximum(count, 1.0)
    return np.where(count > 0.5, np.maximum(level_ + gain * (seen - level_), floor), level_)


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


def dynamics(roll, pitch, rate, time):
    """Rows of Phi of the three angles over ``time`` s by the angles and the gyro biases, rates and attitude constant.

    Derivatives of (4.4) with respect to roll and pitch, and (4.35) for the gyro biases. All other states hold their
    values: a null shift does, and the part that drifts is taken as a random walk (the thesis's -1/tau would pull the
    null shift to zero).
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
        ]
    )


def initial_covariance(tilt, gyro, dip, iron, airspeed):
    """Covariance, packed, when the angles have just been read from force and field; the sigmas of the states (1).

    Nothing is known of heading (1 rad): the field, taken next, ties its error to those of tilt, dip and hard iron.
    """
    one = 1.0 + 0.0 * tilt
    return kalman.of_variances(np.stack([tilt, tilt, one, gyro, gyro, gyro, dip, iron, iron, iron, airspeed]) ** 2)


def process_noise(angle_density, scale, rate, drift, drift_time, dip_walk, airspeed_variance, time):
    """Diagonal of C_d over ``time`` s: (4.39)-(4.44).

    Parameters
    ----------
    angle_density
        White noise of the gyros, rad^2/s. Roll, pitch and heading are driven alike: the mapping f(pitch, roll) of
        (4.39) is near a rotation below 20 degrees of pitch.
    scale, rate
        Scale factor error of the gyros (1) and the rate in b (rad/s): an error that lasts for :data:`TURN_TIME`.
    drift, drift_time
        Sigma (rad/s) and time constant (s) of the gyro drift, (3.5): 2 sigma^2 / tau in rad^2/s^3.
    dip_walk
        Random walk of the dip over the ground that is flown, rad/sqrt(s).
    airspeed_variance
        What the airspeed's error gains over ``time``, (m/s)^2.
    """
    zero = 0.0 * time
    angles = angle_density * time + (scale * rate) ** 2 * TURN_TIME * time
    bias = 2.0 * drift * drift / drift_time * time
    return np.stack([*angles, bias, bias, bias, dip_walk * dip_walk * time, zero, zero, zero, airspeed_variance + zero])


def field_rows(roll, pitch, heading, dip, declination, iron):
    """Direction of the measured field in b, and its derivatives by roll, pitch, heading, dip and hard iron.

    The field in b is v = C_bn n(dip) + m, with the hard iron m over the strength of the field; measured is v / |v|,
    whose change is that of v across v. Turning the aircraft about a unit vector u by a small angle turns a fixed
    vector, seen in b, by the opposite: dv = -u x v. u is the forward axis for roll, (0, cos roll, -sin roll) for pitch
    and down for heading. Returns v / |v| and the rows of H by all states (1).
    """
    c_bn = attitude.dcm(roll, pitch, heading).T
    direction = field_n(dip, declination)
    earths = c_bn @ direction
    zero = 0.0 * roll
    sr, cr = np.sin(roll), np.cos(roll)
    by_roll = np.array([zero, earths[2], -earths[1]])
    by_pitch = np.array([-cr * earths[2] - sr * earths[1], sr * earths[0], cr * earths[0]])
    by_heading = c_bn @ np.array([direction[1], -direction[0], zero])
    by_dip = c_bn @ field_n(dip + 0.5 * np.pi, declination)
    v = earths + iron
    strength = length(v)
    unit = v / strength
    across = (np.eye(3) - unit[:, None] * unit[None, :]) / strength
    angles = across @ np.stack([by_roll, by_pitch, by_heading], axis=1)
    none = zero * np.ones((3, 3))
    dips = np.reshape(across @ by_dip, (3, 1))
    return unit, np.concatenate([angles, none, dips, across, none[:, :1]], axis=1)


def upright(roll, pitch, heading, dip):
    """The same angles with pitch and dip within a quarter turn, and whether either of the two was beyond.

    A pitch beyond the vertical is the attitude with the other three quarters turned round; a dip beyond the vertical is
    the same field seen the other way round.
    """
    over = np.abs(pitch) > 0.5 * np.pi
    under = np.abs(dip) > 0.5 * np.pi
    return (
        np.where(over, roll + np.pi, roll),
        np.where(over, np.sign(pitch) * np.pi - pitch, pitch),
        heading + np.where(over, np.pi, 0.0) + np.where(under, np.pi, 0.0),
        np.where(under, np.sign(dip) * np.pi - dip, dip),
        over,
        under,
    )


def mirrored(upper, over, state):
    """Covariance when the error of ``state`` counts the other way: :data:`PITCH` or :data:`DIP` have changed sides."""
    signs = np.ones(STATES)
    signs[state] = -1.0
    return np.where(over, upper * kalman.pack(np.outer(signs, signs)), upper)


def lost(learning, sigma, turn_rate, tilt_limit, turn_limit):
    """Whether the attitude is not that of the aircraft: in a window of straight flight the level is off by far.

    In a turn a wrong airspeed makes the same misfit. ``learning`` and ``sigma`` as in :func:`tilt_updates`;
    ``turn_rate`` (rad/s) is the mean size of the yaw rate; the limits are those of the mean innovation (rad) and of it.
    """
    mean = sigma * np.abs(learning[1]) / np.maximum(learning[2], 1.0)
    return np.logical_and(np.max(mean) > tilt_limit, turn_rate < turn_limit)


def sound(upper):
    """Whether the variances of the angles are those of angles: not negative, no NaN, below (half a turn)^2."""
    variances = kalman.diagonal(upper)[:MOVING]
    return np.logical_and(np.min(variances) >= 0.0, np.max(variances) < np.pi * np.pi)


def unseen(level, mounting, declination):
    """Sigmas of roll, pitch and heading by what stands still in the aircraft or in the chart, so that nothing shows it.

    ``declination`` is the sigma of the declination in use.
    """
    return np.array([level, level, np.sqrt(mounting * mounting + declination * declination)])


def declination_at(sigma, dip):
    """Sigma of the declination at a dip, from the one at a dip of 60 degrees.

    A change of the horizontal field turns it by an angle that goes with one over the field's horizontal part.
    """
    return sigma * 0.5 / np.maximum(np.cos(dip), 0.05)


def renewed(upper, variance, use):
    """Covariance where the airspeed comes from its instrument anew: its error has nothing to do with the last one's."""
    keep = np.ones(STATES)
    keep[AIRSPEED] = 0.0
    fresh = kalman.of_variances(variance * (1.0 - keep))
    return np.where(use, upper * kalman.pack(np.outer(keep, keep)) + fresh, upper)
