"""Error budgets of the sensors in one place: values for ``imu``, ``magnetometer``, ``air_data``, and so for ``ahrs``.

Those of inertial units, and their sources, are in ``fmus.inertial.grades``.
"""

from __future__ import annotations

import numpy as np

from fmus.inertial.grades import DEG, DEG_PER_HOUR, INERTIAL, TABLE_3_2
from models.magnetic.magnetometer import MILLIGAUSS
from navfmu.constants import FOOT, KNOT
from navfmu.constants import STANDARD_GRAVITY as G

GRADES = {grade: INERTIAL[grade].values for grade in TABLE_3_2}
"""Parameters of ``imu`` by grade of thesis Table 3.2 (= Table 5.2), p. 56."""

MAGNETOMETER: dict[str, float] = {
    "hard_iron_sigma": 5.0 * MILLIGAUSS,
    "soft_iron_sigma": 0.005,
    "scale_factor_sigma": 0.005,
    "misalignment_sigma": 0.25 * DEG,
    "noise_sigma": 5.0 * MILLIGAUSS,
}
"""Parameters of ``magnetometer``: a low-cost triad after its calibration.

Thesis Fig 3.27 has 4 to 7 mG left on each axis, Table 3.3 noise of 1 to 5 mG. That residual is of all errors together;
soft iron and scale factors of 0.5 % are 2 to 3 mG each in Earth's field. Mounting as the other sensors'.
"""

AZIMUTH: dict[str, float] = {"drift_sigma": 2.5 * DEG, "drift_time": 120.0, "noise_sigma": 3.5 * DEG}
"""Parameters of ``azimuth_detector``: thesis (3.84), (3.85), Fig 3.29 (at 20 Hz)."""

AIR_DATA: dict[str, float] = {
    "airspeed_error_sigma": 2.6,
    "altitude_error_sigma": 23.0,
    "pitot_coefficient_sigma": 0.02,
    "pressure_offset_sigma": 10.0,
    "temperature_error_sigma": 1.0,
}
"""Parameters of ``air_data``: indicated airspeed within 5 kn and altitude within 75 ft, thesis (3.32), (3.34).

``air_data`` makes the sigma of true airspeed of them, which ``ahrs`` and ``navigator`` take.

The difference of pressures has a calibration of its own: 2 % of it is 1 % of the airspeed, 10 Pa are 0.2 m/s at 46 m/s
(the recording of a small aircraft at hand has 3 % and -20 Pa). The temperature probe is within 1 K (own choice).
"""

TURBULENCE: dict[str, dict[str, float]] = {
    "light": {"turbulence_sigma": 7 * FOOT, "wind_at_20_feet": 15 * KNOT},
    "moderate": {"turbulence_sigma": 10 * FOOT, "wind_at_20_feet": 30 * KNOT},
    "severe": {"turbulence_sigma": 23 * FOOT, "wind_at_20_feet": 45 * KNOT},
}
"""Parameters of ``wind`` by grade of MIL-F-8785C: figure 7 between 2000 and 10000 ft, section 3.7.3 near the ground.

A fixed wing that is to be carried by it takes the intensity as ``gust_sigma`` of ``aircraft`` instead.
"""

CRUSTAL_LENGTH = 10.0e3
"""Distance over which the crustal anomaly is correlated, m.

Waves of more than 300 km, degrees 13 to 133 of the high-resolution model WMMHR2025, are 35, 31 and 45 nT of the 137, 89
and 141 nT that the WMM2025 leaves out on the ground: 9 % of the variance. Of a Gauss-Markov process of length L it is
2 / pi atan(2 pi L / 300 km), so L is 7 km. The shortest waves do not reach an aircraft, so some km more.
"""

FIELD = 480.0 * MILLIGAUSS
"""Strength of Earth's field in middle latitudes, T."""
EARTH_RATE_SEEN = 10.0 * DEG_PER_HOUR
"""What a gyro of an aircraft that turns about sees of Earth's rate, and ``ahrs`` does not know: 15 deg/h, of which one
axis has some two thirds."""
CHART = float(np.hypot(0.34, 0.3)) * DEG
"""Error of a declination that is told for a flight of an hour or two, where the dip is 60 degrees: local anomalies (the
error model of the World Magnetic Model at a horizontal field of 24 uT), and its change along the flight."""


FIELD_SIGMA = {"tactical": 0.05, "automotive": 0.02, "consumer": 0.02}
"""Error of a field sample that ``ahrs`` assumes, by grade of the gyros. Noise is 1 %, soft iron does not average out
while the heading stays: the better the gyros, the longer the filter averages, and the less it may trust a sample."""


def ahrs_parameters(grade: str) -> dict[str, float]:
    """Parameters of ``ahrs`` for an IMU of a grade, and for :data:`MAGNETOMETER`.

    A level that is wrong by a constant tilts the field, which in level flight cannot be told from hard iron: so the
    hard iron that the filter looks for has the errors of the level and of mounting, too. Soft iron turns the needle on
    all headings alike by half the difference of its two horizontal cross elements. Half their sum, and half the
    difference of the two horizontal gains, turn it twice to and fro in a circle, (A cos 2 psi + B sin 2 psi): no state
    has this shape, and on a leg it does not average out.
    """
    imu = GRADES[grade]
    level = np.hypot(imu["accelerometer_null_shift_sigma"], imu["accelerometer_drift_sigma"]) / G
    level = float(np.hypot(level, imu["misalignment_sigma"]))
    soft, mounting = MAGNETOMETER["soft_iron_sigma"], MAGNETOMETER["misalignment_sigma"]
    gain = np.hypot(soft, MAGNETOMETER["scale_factor_sigma"])
    twice = 0.5 * np.hypot(soft, gain)
    iron = np.array([MAGNETOMETER["hard_iron_sigma"] / FIELD, soft, mounting, level])
    return {
        "gyro_noise": imu["gyro_noise_sigma"],
        "gyro_scale_sigma": imu["gyro_scale_factor_sigma"],
        "gyro_null_shift_sigma": imu["gyro_null_shift_sigma"],
        "gyro_drift_sigma": float(np.hypot(imu["gyro_drift_sigma"], EARTH_RATE_SEEN)),
        "gyro_drift_time": imu["gyro_drift_time"],
        "level_sigma": level,
        "declination_sigma": CHART,
        "mounting_sigma": float(np.linalg.norm([mounting, soft / np.sqrt(2.0), twice])),
        "field_sigma": FIELD_SIGMA[grade],
        "hard_iron_sigma": float(np.linalg.norm(iron)),
    }


def inertial_parameters(grade: str) -> dict[str, float]:
    """Parameters of ``navigator_inertial`` for an inertial unit of this grade.

    A gyro whose axis is off by an angle sees so much of the rate about another one, as a scale factor does of its own.
    """
    imu = GRADES[grade]
    return {
        "gyro_noise": imu["gyro_noise_sigma"],
        "gyro_scale_sigma": float(np.hypot(imu["gyro_scale_factor_sigma"], imu["misalignment_sigma"])),
        "gyro_null_shift_sigma": imu["gyro_null_shift_sigma"],
        "gyro_drift_sigma": imu["gyro_drift_sigma"],
        "gyro_drift_time": imu["gyro_drift_time"],
        "accelerometer_noise": imu["accelerometer_noise_sigma"],
        "accelerometer_null_shift_sigma": float(
            np.hypot(imu["accelerometer_null_shift_sigma"], G * imu["accelerometer_scale_factor_sigma"])
        ),
        "accelerometer_drift_sigma": imu["accelerometer_drift_sigma"],
        "accelerometer_drift_time": imu["accelerometer_drift_time"],
        "level_sigma": float(np.hypot(imu["accelerometer_null_shift_sigma"] / G, imu["misalignment_sigma"])),
    }
