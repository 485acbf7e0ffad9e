"""Dead reckoning with airspeed, heading and wind, and the equations of its errors, thesis section 5.3.

The states are the perturbations (5.11), truth less estimate:

    [dp_n, dp_e, dh, dV_NS, dV_EW, dpsi, dV]

position north and east and altitude (m, positive up: the thesis has h positive down, hence its R - h), wind north and
east (m/s), heading (rad), airspeed (m/s). ``errors`` are all but position, in this order; what is behind them is of no
concern here. Position and velocities are those of :mod:`models.navigation.navigator`.

Misprints: the last row of F_DR (5.13) has tau_V, printed tau_psi, and so has (5.30); the wind east has tau_EW, printed
tau_NS. (5.23) has V_E dh / ((R_EW - h)^2 cos), not
cos^2; (5.24), (5.25) have cos(psi) and sin(psi) for cos(L) and sin(L) beside dh, and + V cos(psi) dpsi in (5.25).
(5.26), (5.27) leave h out of R - h. The wide-band noise of heading, n_psi (5.28), moves the position as heading does,
V n_psi across the nose: in the row of dpsi, where the text beside (5.32) seems to put it, it would be a heading that
wanders to 6 degrees.
"""

from __future__ import annotations

import numpy as np

from models.filters import kalman
from models.navigation import navigator
from navfmu.derivatives import jacobian

STATES = 7
DRIVING = 5
"""States behind position, of which the first drive it: altitude (which does not), wind, heading, airspeed."""
HEIGHT, WIND, HEADING, AIRSPEED = 0, slice(1, 3), 3, 4
"""Where they are among ``errors``."""


def velocity(errors, airspeed, heading, wind):
    """North and east velocity over ground, m/s, (5.18), (5.19), of measured airspeed and heading, a forecast of the
    wind, and what is to be added to each."""
    air = navigator.air_velocity(airspeed + errors[AIRSPEED], heading + errors[HEADING])
    return air + wind + errors[WIND]


def velocity_rows(errors, airspeed, heading, wind):
    """Derivatives of :func:`velocity` by altitude, wind, heading and airspeed, shape (2, 5): the first two rows of
    F_DR (5.13) beyond position, (5.20), (5.21)."""
    return jacobian(velocity, errors[:DRIVING], airspeed, heading, wind)


def wide_band(upper, airspeed, heading, density, step):
    """Add to the covariance what the wide-band noise of heading, of the spectral density ``density`` (rad2 s), does to
    position in ``step`` s: it moves across the nose by V n_psi, (5.28), (5.30)."""
    across = np.concatenate([np.stack([-np.sin(heading), np.cos(heading)]), np.zeros(kalman.order(upper) - 2)])
    return upper + airspeed * airspeed * density * step * kalman.pack(across[:, None] * across[None, :])


def fix_rows(states, rows):
    """H of a fix: position, velocity (north, east) and altitude, shape (5, ``states``); ``rows`` as of
    :func:`velocity_rows`."""
    of_velocity = np.concatenate([np.zeros((2, 2)), rows, np.zeros((2, states - 2 - np.shape(rows)[-1]))], -1)
    return np.concatenate([np.eye(states)[:2], of_velocity, np.eye(states)[2 + HEIGHT : 3 + HEIGHT]])
