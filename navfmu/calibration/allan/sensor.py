"""The two triads of an inertial unit: how their columns and parameters are called, and the units of data sheets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.calibration.allan.terms import FLICKER, GAUSS_MARKOV, QUANTISATION, RAMP, RANDOM_WALK, WHITE, Term
from navfmu.constants import STANDARD_GRAVITY

HOUR = 3600.0
ROOT_HOUR = 60.0


@dataclass(frozen=True, eq=False)  # there are two, and they are keys
class Sensor:
    """``quantity`` names the columns, ``prefix`` the parameters; ``shown`` is the unit of each coefficient in a table
    and how many of it are one in SI; ``plausible`` the range of the size of a resting reading, in ``unit``.
    """

    quantity: str
    prefix: str
    unit: str
    pulse: str
    plausible: tuple[float, float]
    shown: dict[Term, tuple[str, float]]


_DEG = float(np.degrees(1.0))
_MG = 1e3 / STANDARD_GRAVITY
GYRO = Sensor(
    "rate",
    "gyro",
    "rad/s",
    "angle_quantum",
    (0.0, 0.6),
    {
        QUANTISATION: ("arcsec", HOUR * _DEG),
        WHITE: ("deg/sqrt(h)", ROOT_HOUR * _DEG),
        FLICKER: ("deg/h", HOUR * _DEG),
        RANDOM_WALK: ("deg/h/sqrt(h)", HOUR * ROOT_HOUR * _DEG),
        RAMP: ("deg/h/h", HOUR * HOUR * _DEG),
        GAUSS_MARKOV: ("deg/h", HOUR * _DEG),
    },
)
"""Its null shift may be 34 deg/s."""
ACCELEROMETER = Sensor(
    "specific_force",
    "accelerometer",
    "m/s2",
    "velocity_quantum",
    (9.0, 10.6),
    {
        QUANTISATION: ("m/s", 1.0),
        WHITE: ("m/s/sqrt(h)", ROOT_HOUR),
        FLICKER: ("mg", _MG),
        RANDOM_WALK: ("mg/sqrt(h)", ROOT_HOUR * _MG),
        RAMP: ("mg/h", HOUR * _MG),
        GAUSS_MARKOV: ("mg", _MG),
    },
)
SENSORS = (GYRO, ACCELEROMETER)
