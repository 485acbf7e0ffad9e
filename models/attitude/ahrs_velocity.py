"""Attitude without a singularity: a quaternion, an air velocity that is integrated, and the field as a vector.

The states of the filter are errors, true minus estimated, of

    [turn in n | velocity in n | place in n | gyro biases | hard iron in b | dip | strength | flow in b]           (1)

in rad, m/s, m, rad/s, 1 (over the strength of the field that was found at first), rad, 1 and m/s. The turn is the small
rotation in n that is missing: q = dq(turn) q_estimated. It is multiplicative and of three elements (Lefferts, Markley
and Shuster, *J. Guidance* 5 (1982), p. 417), where thesis (4.52)-(4.60) has the vector of the quaternion's error in b.

What the accelerometers show. The specific force, turned into n by the estimated attitude, is integrated to a velocity
with respect to what carries the sensor, and that velocity is known:

- of an aircraft, with respect to the air: along the nose it is the airspeed V, across it slip and angle of attack
  (*flow*), which are small and last for seconds. The velocity of the air itself is a random walk.
- of a sensor in a hand, with respect to the hand's mean: nothing, on the average, and so is the way that it goes
  (*place*), because it stays where it is.

So an acceleration is no error of the level, in a turn or not, if a velocity follows from it; and a level that is wrong
by an angle lets the velocity grow by g times that angle. Filters that take the specific force itself for the vertical
need a model of acceleration, as (2) of ``models.attitude.ahrs``, or a long time constant.

The field is taken as it is, strength and all: C_bn n(dip, declination) (1 + strength) + iron. Its errors last, so that
samples close together tell no more than one (:func:`lasting`). What it shows beyond a limit is taken with an error as
large as itself, which lasts longer (:func:`disturbance`): a magnet nearby leaves no strength and dip of Earth's field.
Where it changes from one sample to the next as errors that last do not, the hard iron has changed (:func:`jumped`).
"""

from __future__ import annotations

import numpy as np

from models.attitude import attitude, quaternion
from models.attitude.ahrs import field_n
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY
from navfmu.derivatives import value_and_jacobian

STATES = 20
MOVING, DRIVING = 9, 12
"""The first states, turn, velocity and place, are driven by these and by the gyro biases; the others by themselves."""
TURN, VELOCITY, PLACE, BIAS, IRON = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12), slice(12, 15)
DIP, STRENGTH, FLOW = 15, 16, slice(17, 20)
GRAVITY_N = np.array([0.0, 0.0, STANDARD_GRAVITY])


def transition(mean_dcm, force_sum, time, placed):
    """The first rows of Phi over ``time`` s, by the states of :data:`DRIVING`, shape (9, 12).

    With d(turn)/dt = -C_nb d(bias) and d(velocity)/dt = -[f_n x] turn; attitude and specific force are means.

    Parameters
    ----------
    mean_dcm
        Mean C_nb over ``time``.
    force_sum
        Integral of the specific force in n over ``time``, m/s.
    placed
        1 where the place is followed, 0 where it is not and keeps no error.
    """
    one, none = np.eye(3), np.zeros((3, 3))
    force = attitude.skew(force_sum)
    by_bias = force @ mean_dcm * time
    turn = np.concatenate([one, none, none, -mean_dcm * time], axis=1)
    velocity = np.concatenate([-force, one, none, 0.5 * by_bias], axis=1)
    place = np.concatenate([-0.5 * time * force, time * one, one, by_bias * time / 6.0], axis=1)
    return np.concatenate([turn, velocity, placed * place])


def carried(velocity, place, force_sum, time):
    """Velocity and place in n after ``time`` s of the mean specific force, m/s and m."""
    gained = force_sum + GRAVITY_N * time
    return velocity + gained, place + velocity * time + 0.5 * gained * time


def rotated(upper, dcm):
    """Covariance where n itself is turned by ``dcm``, as by a declination that was not known: what is in n turns."""
    axes = np.kron(np.eye(3), dcm)
    turning = np.concatenate([axes, np.zeros((MOVING, STATES - MOVING))], axis=1)
    turning = np.concatenate([turning, np.eye(STATES)[MOVING:]])
    return kalman.pack(turning @ kalman.unpack(upper) @ turning.T)


def flow_seen(error, q, velocity, flow):
    """Velocity in b that an airspeed along the nose tells, with ``flow`` in it, m/s: [V 0 0] is measured."""
    true = quaternion.product(quaternion.of_rotation(error[TURN]), q)
    return quaternion.dcm(true).T @ (velocity + error[VELOCITY]) + flow + error[FLOW]


def field_seen(error, q, iron, dip, strength, declination):
    """Field in b over the strength that was found at first."""
    true = quaternion.product(quaternion.of_rotation(error[TURN]), q)
    earths = quaternion.dcm(true).T @ field_n(dip + error[DIP], declination)
    return (1.0 + strength + error[STRENGTH]) * earths + iron + error[IRON]


def turn_seen(error, q, told):
    """Rotation in n from the attitude to the one that is told, rad, with the sign of an error."""
    true = quaternion.product(quaternion.of_rotation(error[TURN]), q)
    return -quaternion.rotation(quaternion.product(told, quaternion.inverse(true)))


def rows(seen, *arguments):
    """What is expected of ``seen``, and its derivatives H by the states (1), here."""
    return value_and_jacobian(seen, np.zeros(STATES), *arguments)


def initial_covariance(q, velocity, tilt, gyro, dip, iron, flow, air):
    """Covariance, packed, when level and velocity have just been read from specific force and airspeed.

    Of heading nothing is known (1 rad), so the velocity, of which only its components in b are known, turns with it:
    velocity error = turn x velocity - C_nb flow error. The airspeed that it is read from has the noise ``air`` (m/s,
    each component) beside, which the velocity keeps: without it the gyros' biases would have to explain it.
    """
    one, zero = 1.0 + 0.0 * tilt, 0.0 * tilt
    sigmas = [tilt, tilt, one, *[zero] * 6, gyro, gyro, gyro, iron, iron, iron, dip, iron, *flow]
    by_flow = np.concatenate([np.zeros((3, 3)), -quaternion.dcm(q), np.zeros((14, 3))])
    by_turn = np.concatenate([np.eye(3), -attitude.skew(velocity), np.zeros((14, 3))])
    mixing = np.concatenate([by_turn, np.eye(STATES)[:, 3:17], by_flow + np.eye(STATES)[:, FLOW]], axis=1)
    read = np.concatenate([np.zeros(3), air**2 * np.ones(3), np.zeros(14)])
    return kalman.pack((mixing * np.stack(sigmas) ** 2) @ mixing.T) + kalman.of_variances(read)


def process_noise(angle_density, scale, turned, velocity_walk, bias_density, iron_walk, dip_walk, flow_variance, time):
    """Diagonal of C_d over ``time`` s.

    Parameters
    ----------
    angle_density
        White noise of the gyros, rad^2/s.
    scale, turned
        Scale factor error of the gyros (1), and the integral of the squares of the rates in n, rad^2/s, times the time
        for which a rate lasts: rad^2.
    velocity_walk
        Random walk of the velocity of what carries the sensor, m/s/sqrt(s).
    bias_density
        rad^2/s^3.
    iron_walk, dip_walk
        Random walks of hard iron, and of dip (rad) and strength alike, 1/sqrt(s).
    flow_variance
        What the flow's error gains over ``time``, (m/s)^2.
    """
    one = np.ones(3)
    return np.concatenate(
        [
            angle_density * time + scale**2 * turned,
            velocity_walk**2 * time * one,
            0.0 * one,
            bias_density * time * one,
            iron_walk**2 * time * one,
            dip_walk**2 * time * one[:2],
            flow_variance,
        ]
    )


def updates(correction, upper, expected, matrix, measured, variance, use):
    """Take the three components of one measurement, each with the noise ``variance``."""
    for axis in range(3):
        residual = measured[axis] - expected[axis]
        correction, upper, _ = kalman.update(correction, upper, matrix[axis], variance, residual, use)
    return correction, upper


def correlation(time, apart):
    """Of Gauss-Markov errors that last for ``time`` s, ``apart`` s from each other."""
    return np.exp(-apart / np.maximum(time, 1.0e-9))


def lasting(variance, time, apart):
    """Variance of white noise that counts as much as errors of ``variance`` which last for ``time`` s, Gauss-Markov.

    Samples that are ``apart`` s differ by (1 + rho) / (1 - rho), rho = exp(-apart / time): far apart each has an error
    of its own, and close together their number tells nothing, whatever it is: 2 variance time / apart.
    """
    rho = correlation(time, apart)
    return variance * (1.0 + rho) / (1.0 - rho)


def jumped(upper, matrix, change, variance, noise, turned, kept, limit):
    """Covariance where the field's error in b has jumped: what jumps is the hard iron (a current on board, cargo).

    Parameters
    ----------
    change
        Residual of this sample, over the strength, less ``kept`` times what was left of the last one, (3,).
    variance, noise
        Of the error that lasts, and variance of what is each sample's own.
    turned
        What the gyros' errors add to the variances of the turn between two samples, rad^2, (3,).
    kept
        Correlation of the error that lasts, from the last sample to this one.
    limit
        Sigmas of such a change beyond which it is a jump: the variance of the hard iron there is raised by its square,
        and so the iron takes it, not the heading.
    """
    seen = np.sum((matrix @ kalman.unpack(upper)) * matrix, axis=1)
    expected = (1.0 - kept * kept) * (variance + seen) + 2.0 * noise + matrix[:, TURN] ** 2 @ turned
    beyond = change * change > limit * limit * expected
    one = np.eye(STATES)[IRON]
    return upper + kalman.of_variances(np.where(beyond, change * change, 0.0) @ one)


def disturbance(upper, matrix, residual, variance, limit):
    """Variance of each component of the disturbance that is in a field whose ``residual`` may be that of a magnet.

    Within ``limit`` of the sigmas that are expected, in the mean of the three components, there is none: 0.
    """
    expected = np.sum((matrix @ kalman.unpack(upper)) * matrix, axis=1) + variance
    beyond = np.mean(residual * residual / expected) > limit * limit
    return np.where(beyond, np.mean(residual * residual), 0.0)


def euler_sigmas(upper, heading, pitch):
    """Standard deviations of roll, pitch and heading, rad, of the turn in n.

    A turn in n by (x, y, z) changes pitch by -x sin + y cos of the heading, roll by (x cos + y sin) / cos(pitch) and
    heading by z + tan(pitch) (x cos + y sin). At the vertical roll and heading are not to be told apart.
    """
    s, c, upright = np.sin(heading), np.cos(heading), np.maximum(np.cos(pitch), 1.0e-3)
    zero, lean = 0.0 * s, np.sin(pitch) / upright
    matrix = np.stack(
        [
            np.stack([c / upright, s / upright, zero]),
            np.stack([-s, c, zero]),
            np.stack([c * lean, s * lean, 1.0 + zero]),
        ]
    )
    turns = kalman.unpack(upper)[TURN, TURN]
    return np.sqrt(np.maximum(np.sum((matrix @ turns) * matrix, axis=1), 0.0))


def sound(upper):
    """Whether the variances of the turn are those of angles: not negative, no NaN, below (half a turn)^2."""
    variances = kalman.diagonal(upper)[TURN]
    return np.logical_and(np.min(variances) >= 0.0, np.max(variances) < np.pi * np.pi)


def renewed(upper, variance, use):
    """Covariance where the airspeed comes from its instrument anew: its error has nothing to do with the last one's."""
    keep = np.ones(STATES)
    keep[FLOW.start] = 0.0
    fresh = kalman.of_variances(variance * (1.0 - keep))
    return np.where(use, upper * kalman.pack(np.outer(keep, keep)) + fresh, upper)
