"""Named grades of inertial sensors, thesis Table 3.2 (= Table 5.2), p. 56: values for the parameters of ``imu``.

The table gives, for gyro and accelerometer, the standard deviation and time constant of the Gauss-Markov drift and the
wide-band noise per sample. It leaves out null shift and scale factor: the thesis estimates the null shift on line and
quotes a scale factor error below 2.6 % over 0 to 60 degC for an uncompensated vibrating gyro (section 3.3.1). Both are
zero in these grades, so that the table can be reproduced; set ``gyro_null_shift_sigma`` and the like to have them.
"""

from __future__ import annotations

import numpy as np

from models.earth import STANDARD_GRAVITY as G

DEG = float(np.radians(1.0))
DEG_PER_HOUR = DEG / 3600.0


def _grade(gyro_drift, gyro_time, gyro_noise, drift, time, noise) -> dict[str, float]:
    return {
        "gyro_drift_sigma": gyro_drift * DEG_PER_HOUR,
        "gyro_drift_time": gyro_time,
        "gyro_noise_sigma": gyro_noise * DEG,
        "accelerometer_drift_sigma": drift * G,
        "accelerometer_drift_time": time,
        "accelerometer_noise_sigma": noise * G,
    }


GRADES: dict[str, dict[str, float]] = {
    #                      deg/h     s   deg/s       g      s      g
    "tactical": _grade(0.35, 100.0, 0.0017, 50e-6, 60.0, 50e-5),
    "automotive": _grade(180.0, 300.0, 0.05, 1.2e-3, 100.0, 1e-3),
    "consumer": _grade(360.0, 300.0, 0.05, 2.4e-3, 100.0, 1e-3),
}
"""Parameter values by grade; a parameter of three axes takes the same value on each."""
