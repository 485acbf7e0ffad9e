"""One axis of an attitude that a gyro carries on: two states, an angle (rad) and the gyro's bias (rad/s).

In level flight the filters of thesis (4.32) and (4.52) are three of these, side by side. The errors, true minus
estimated, move as d(angle)/dt = -bias, and the bias is a random walk.
"""

from __future__ import annotations

import numpy as np

from models.filters import riccati

ANGLE = np.array([1.0, 0.0])
"""h: what is measured is the angle."""


def transition(time):
    """Phi over ``time`` s, shape (2, 2)."""
    return np.array([[1.0, -time], [0.0, 1.0]])


def noise(angle_density, bias_density, time):
    """C_d over ``time`` s of white noise of the rate, rad^2/s, and of the bias's own, rad^2/s^3; shape (2, 2)."""
    angle = angle_density * time + bias_density * time**3 / 3.0
    both = -0.5 * bias_density * time**2
    return np.array([[angle, both], [both, bias_density * time]])


def carried(covariance, angle_density, bias_density, time):
    """Covariance after ``time`` s without a measurement: (4.46)."""
    phi = transition(time)
    return phi @ covariance @ phi.T + noise(angle_density, bias_density, time)


def scheduled(angle_density, bias_density, sigma, period):
    """Gain of an angle (1; 1/s) and covariance after its update, when both have come to rest: thesis p. 129.

    Parameters
    ----------
    angle_density, bias_density
        As of :func:`noise`.
    sigma, period
        Noise of the angles that are measured, rad, and the time between two, s.
    """
    process = noise(angle_density, bias_density, period)
    before = riccati.steady(transition(period), process, ANGLE, sigma * sigma)
    gain = riccati.gain(before, ANGLE, sigma * sigma)
    return gain, before - np.outer(gain, before[0])


def noises(driven, white, bias_density, time):
    """C_d over ``time`` s of three angles and three biases, shape (6, 6): (4.39) to (4.46).

    Parameters
    ----------
    driven
        What rates do to the angles, f of (4.35) or 1/2 of (4.56), shape (3, 3).
    white
        What the three rates' white noise gathers over ``time``, rad^2, shape (3,).
    bias_density
        As of :func:`noise`.
    """
    angles = (driven * (white + bias_density * time**3 / 3.0)) @ driven.T
    both = -0.5 * bias_density * time**2 * driven
    above = np.concatenate([angles, both], axis=1)
    return np.concatenate([above, np.concatenate([both.T, bias_density * time * np.eye(3)], axis=1)])


def diagonal(angle, bias):
    """Covariance of an angle and a bias that have nothing to do with each other, from their variances."""
    zero = 0.0 * angle
    return np.array([[angle, zero], [zero, bias + zero]])
