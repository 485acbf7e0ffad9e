"""Inertial units by name: parameters of ``imu`` for each, with its source.

What a data sheet calls random walk, N per root hour, is here the noise of a sample, N / sqrt(T), thesis (B.10).
Stability of the bias over hours is taken for the floor of the Allan deviation, 0.664 B. What is told as a limit, or as
better than a value, is taken as one sigma.

What the thesis leaves out, because an estimator finds it, is constant after turn-on. For its grades it is drawn from

tactical    null shift 1 deg/h and 1 mg, 1 sigma (data sheet of the Honeywell HG1700); scale factors 150 and 300 ppm, as
            usual in this class
automotive  gyros: scale factor within 2.6 % over 0 to 60 degC (thesis section 3.3.1; evenly spread that is 0.75 %),
            null shift within 0.1 deg/s over temperature (data sheet of the Memsic AHRS380SA, a calibrated unit of this
            class). Accelerometers: 5 mg and 0.5 % (own choice, between the neighbours)
consumer    twice the automotive errors, as in the thesis; so its scale factor is within 3 % at 2 sigma, which is the
            initial tolerance in the data sheet of the InvenSense MPU-6050. That part's initial null shifts of 20 deg/s
            and 50 mg are taken out before the flight

Mounting is own choice: some 0.25 degrees in a light aircraft, of tactical units 0.05, of those that navigate 0.003 (10
arcsec, as of a unit that was calibrated in its place). Set a sigma to 0 to have none.
"""

from __future__ import annotations

import numpy as np

from models.inertial.flicker import FLOOR
from navfmu.constants import STANDARD_GRAVITY as G
from navfmu.export import ParameterSet

DEG = float(np.radians(1.0))
DEG_PER_HOUR = DEG / 3600.0
ARC_SECOND = DEG / 3600.0
MICRO_G = 1e-6 * G
HUNDREDTH = 0.01
"""Sample period of those units whose data sheet has a random walk, s."""


def walk(deg_per_root_hour: float, period: float = HUNDREDTH) -> float:
    """Noise of a sample, rad/s, that makes this random walk of the angle."""
    return deg_per_root_hour * DEG / 60.0 / float(np.sqrt(period))


def _drift(gyro_drift, gyro_time, gyro_noise, drift, time, noise) -> dict[str, float]:
    return {
        "gyro_drift_sigma": gyro_drift * DEG_PER_HOUR,
        "gyro_drift_time": gyro_time,
        "gyro_noise_sigma": gyro_noise * DEG,
        "accelerometer_drift_sigma": drift * G,
        "accelerometer_drift_time": time,
        "accelerometer_noise_sigma": noise * G,
    }


def _turn_on(gyro_null_shift, gyro_scale_factor, null_shift, scale_factor, misalignment) -> dict[str, float]:
    return {
        "gyro_null_shift_sigma": gyro_null_shift * DEG_PER_HOUR,
        "gyro_scale_factor_sigma": gyro_scale_factor,
        "accelerometer_null_shift_sigma": null_shift * G,
        "accelerometer_scale_factor_sigma": scale_factor,
        "misalignment_sigma": misalignment * DEG,
    }


AUTOMOTIVE = {**_drift(180.0, 300.0, 0.05, 1.2e-3, 100.0, 1e-3), **_turn_on(360.0, 0.0075, 5e-3, 0.005, 0.25)}
NO_DRIFT = _drift(0.0, 100.0, 0.0, 0.0, 100.0, 0.0)
QA_2000 = {
    "accelerometer_null_shift_sigma": 60.0 * MICRO_G,
    "accelerometer_scale_factor_sigma": 100e-6,
    "accelerometer_nonorthogonality_sigma": 40e-6,
    "accelerometer_noise_sigma": 50.0 * MICRO_G,
}
"""Sundstrand QA-2000, RTO MP-43 (1999), paper 17; noise is not printed, 5 micro-g per root Hz at 100 Hz is chosen."""
_QA_2000 = (
    "Accelerometers: QA-2000, paper 17 (60 micro-g, 100 ppm, 40 microrad); their noise is not printed and 5 micro-g "
    "per "
    "root Hz"
)

INERTIAL: dict[str, ParameterSet] = {
    "navigation": ParameterSet(
        "Unit of an aircraft's inertial navigator. Gyros: ring lasers of 0.01 deg/h as in the LTN-90-100 (RTO MP-43, "
        "paper 17), random walk 0.003 deg/sqrt(h) as the GL-1 (paper 1, Table 2), 5 ppm as most of Tables 2 and 4. "
        f"{_QA_2000}.",
        {
            **NO_DRIFT,
            **_turn_on(0.01, 5e-6, 0.0, 0.0, 0.003),
            **QA_2000,
            "gyro_flicker": 0.01 * DEG_PER_HOUR / FLOOR,
            "gyro_noise_sigma": walk(0.003),
            "sample_period": HUNDREDTH,
        },
    ),
    "tactical": ParameterSet(
        "Thesis Table 3.2, p. 56, with turn-on errors of the Honeywell HG1700. The accelerometers' noise is 50 x "
        "10^-5 g of a sample, as printed, "
        "ten times their drift of 50 x 10^-6 g: 50 micro-g per root Hz at 100 Hz.",
        {**_drift(0.35, 100.0, 0.0017, 50e-6, 60.0, 50e-5), **_turn_on(1.0, 150e-6, 1e-3, 300e-6, 0.05)},
    ),
    "automotive": ParameterSet(
        "Thesis Table 3.2, p. 56: the Crossbow DMU-6X. Turn-on errors of units of this class.", AUTOMOTIVE
    ),
    "consumer": ParameterSet(
        "Thesis Table 3.2, p. 56: twice the automotive drift, its noise. Turn-on errors twice the automotive.",
        {**_drift(360.0, 300.0, 0.05, 2.4e-3, 100.0, 1e-3), **_turn_on(720.0, 0.015, 10e-3, 0.01, 0.5)},
    ),
    "horizon": ParameterSet(
        "Systron Donner Horizon, thesis Table 3.1, p. 54, (3.6)-(3.11): 0.05 deg/s, 1000 s, noise 0.05 deg/s. The "
        "drift "
        "covers that of temperature. Accelerometers and turn-on errors as automotive.",
        {**AUTOMOTIVE, "gyro_drift_time": 1000.0},
    ),
    "horizon_warming": ParameterSet(
        "Systron Donner Horizon with the stochastic 0.01 deg/s of thesis p. 46 and Fig C.4, and with the transient of "
        "Fig 3.5, which dies out with 1 h (about 3 h to the end, p. 45). Its size is not printed, but that the sensor "
        "settles 0.02 deg/s below the mean of the five hours shown: so it begins 0.1 deg/s above, for the mean of "
        "exp(-t/1 h) over 5 h is 0.2.",
        {
            **AUTOMOTIVE,
            "gyro_drift_sigma": 0.01 * DEG,
            "gyro_drift_time": 1000.0,
            "gyro_null_shift_temperature": -0.010 * DEG,
            "self_heating": 10.0,
            "thermal_time": 3600.0,
            "calibration_temperature": 303.15,
        },
    ),
    "dmu_6x": ParameterSet(
        "Crossbow DMU-6X, thesis Table 3.1, p. 54, (3.12)-(3.17) and (3.21)-(3.26). Turn-on errors as automotive.",
        AUTOMOTIVE,
    ),
    "fog": ParameterSet(
        "KVH Autogyro and Crossbow FOG, thesis Table 3.1, p. 54, (3.19)-(3.20): noise 0.2 deg/s, no drift. It is "
        "that of a "
        "sample here as in the thesis; read from Fig 3.8 at 1 s (p. 52) it would be 2 deg/s at 100 Hz. "
        "Accelerometers and "
        "turn-on errors as automotive.",
        {**AUTOMOTIVE, "gyro_drift_sigma": 0.0, "gyro_noise_sigma": 0.2 * DEG},
    ),
    "gl_1": ParameterSet(
        "Ring laser GL-1 of Electrooptica, RTO MP-43 (1999), paper 1, Table 2: 0.007 deg/h over 1 to 10 h, 0.01 "
        "deg/h from "
        "start to start, 0.003 deg/sqrt(h), 1.30 arcsec a pulse, 10 ppm, 0.003 deg/h/K, 360 deg/s. "
        f"{_QA_2000}.",
        {
            **NO_DRIFT,
            **_turn_on(0.01, 10e-6, 0.0, 0.0, 0.003),
            **QA_2000,
            "gyro_flicker": 0.007 * DEG_PER_HOUR / FLOOR,
            "gyro_noise_sigma": walk(0.003),
            "gyro_null_shift_temperature_sigma": 0.003 * DEG_PER_HOUR,
            "gyro_range": 360.0 * DEG,
            "angle_quantum": 1.30 * ARC_SECOND,
            "sample_period": HUNDREDTH,
        },
    ),
    "rlgn": ParameterSet(
        "RLGN with ring lasers Honeywell GG 1342, AGARD CP-298 (1981), paper 12, Tables 2 and 3: 0.007 deg/h (the "
        "specified value), 0.0011, 0.0013, 0.0050 deg/sqrt(h) and 3.1, 2.5, 1.1 ppm of the three axes (printed as "
        "linearity, "
        "here a constant error, as of the accelerometers' scale factors), 2 arcsec a pulse; "
        "accelerometers 3, 16, 17 micro-g. Day to day 0.01 deg/h, 0.002 deg/h/K and 800 deg/s: RTO MP-43 (1999), "
        "paper 1, "
        "Table 4. Noise of the accelerometers, not printed, is 5 micro-g per root Hz.",
        {
            **NO_DRIFT,
            **_turn_on(0.01, 0.0, 0.0, 0.0, 0.003),
            "gyro_flicker": 0.007 * DEG_PER_HOUR / FLOOR,
            "gyro_noise_sigma": np.array([walk(0.0011), walk(0.0013), walk(0.0050)]),
            "gyro_scale_factor_sigma": np.array([3.1e-6, 2.5e-6, 1.1e-6]),
            "gyro_null_shift_temperature_sigma": 0.002 * DEG_PER_HOUR,
            "gyro_range": 800.0 * DEG,
            "angle_quantum": 2.0 * ARC_SECOND,
            "accelerometer_flicker": np.array([3.0, 16.0, 17.0]) * MICRO_G / FLOOR,
            "accelerometer_scale_factor_sigma": np.array([12e-6, 14e-6, 9e-6]),
            "accelerometer_noise_sigma": 50.0 * MICRO_G,
            "sample_period": HUNDREDTH,
        },
    ),
    "ln_200": ParameterSet(
        "Fibre-optic Litton LN-200, RTO MP-43 (1999), paper 17: 3 deg/h, 300 ppm, 0.15 deg/sqrt(h), 0.01 deg/h/g; "
        "accelerometers 1500 micro-g, 1000 ppm, 300 microrad. The drift is not printed and that of Table 3.2, "
        "tactical; "
        "noise of the accelerometers 50 micro-g per root Hz (own choice).",
        {
            **_drift(0.35, 100.0, 0.0, 50e-6, 60.0, 500e-6),
            **_turn_on(3.0, 300e-6, 1500e-6, 1000e-6, 0.05),
            "gyro_noise_sigma": walk(0.15),
            "gyro_g_sensitivity_sigma": 0.01 * DEG_PER_HOUR / G,
            "accelerometer_nonorthogonality_sigma": 300e-6,
            "sample_period": HUNDREDTH,
        },
    ),
    "micropak": ParameterSet(
        "Tuned rotor gyros CSG-2 behind 16 bits, RTO MP-43 (1999), paper 17: 0.007 deg/h, 30 ppm, 0.008 deg/h/g, "
        "but steps of "
        "9.0 deg/h at 64 Hz; random drift 0.003 deg/h, taken as the floor. Accelerometers QA-2000 in steps of "
        "15.26, 15.26 "
        "and 61.0 micro-g. All is filtered to 10 Hz; 32768 steps to both sides are 82 deg/s and 0.5, 0.5 and 2 g. "
        "Noise of neither is printed: 0.003 deg/sqrt(h), 5 micro-g per root Hz (own choice).",
        {
            **NO_DRIFT,
            **_turn_on(0.007, 30e-6, 0.0, 0.0, 0.003),
            **QA_2000,
            "gyro_flicker": 0.003 * DEG_PER_HOUR / FLOOR,
            "gyro_noise_sigma": walk(0.003, 1.0 / 64.0),
            "gyro_g_sensitivity_sigma": 0.008 * DEG_PER_HOUR / G,
            "gyro_bandwidth": 10.0,
            "gyro_resolution": 9.0 * DEG_PER_HOUR,
            "gyro_range": 2.0**15 * 9.0 * DEG_PER_HOUR,
            "accelerometer_noise_sigma": 40.0 * MICRO_G,
            "accelerometer_bandwidth": 10.0,
            "accelerometer_resolution": np.array([15.26, 15.26, 61.0]) * MICRO_G,
            "accelerometer_range": 2.0**15 * np.array([15.26, 15.26, 61.0]) * MICRO_G,
            "sample_period": 1.0 / 64.0,
        },
    ),
}
"""Parameters of ``imu`` by name of the unit; where one number stands for three axes, each has it."""
TABLE_3_2 = ("tactical", "automotive", "consumer")
"""The thesis's own grades."""
