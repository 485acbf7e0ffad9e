"""What navigators are told of an unmanned aircraft of some kg near the ground."""

from __future__ import annotations

import numpy as np

from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import ParameterSet

SMALL_AIRCRAFT = ParameterSet(
    "An unmanned aircraft of some kg at 15 to 25 m/s near the ground. Gusts: light turbulence of MIL-F-8785C at 75 m, "
    "1.13 m/s along the nose for 240 m. GPS: 2.5 m in half of the fixes (data sheet of u-blox 8), 2.1 m on each axis; "
    "velocity 0.3 m/s, what PX4 takes for its receivers, which lag in turns. Airspeed: zero and scale of a pressure "
    "sensor stay for a flight of an hour (own choice). Wind as everywhere.",
    {
        "fix_sigma": 2.1,
        "velocity_sigma": 0.3,
        "gust_sigma": 1.13,
        "gust_length": 240.0,
        "airspeed_time": 3600.0,
    },
)

SETS = {"small_aircraft": SMALL_AIRCRAFT}

INERTIAL = ParameterSet(
    "An unmanned aircraft of some kg with a micromechanical unit that is not nulled before the flight: zero-rate "
    "offset of 1 deg/s, accelerometers 20 mg (data sheet of the BMI088), as `ahrs_velocity` has it; the rest is the "
    "automotive unit of thesis Table 5.2. GPS: 2.1 m on each axis (data sheet of u-blox 8), 0.3 m/s (PX4).",
    {
        "fix_sigma": 2.1,
        "velocity_sigma": 0.3,
        "gyro_null_shift_sigma": np.radians(1.0),
        "accelerometer_null_shift_sigma": 0.02 * STANDARD_GRAVITY,
        "level_sigma": 0.02,
    },
)
