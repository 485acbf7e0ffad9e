"""Every error of every sensor at once: parameters and inputs by the name of the FMU.

Most errors are off at first. What is claimed of a sensor, its time, its random numbers, its saved states, is claimed
with these as well.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from models.earth import earth

_NORTH = {"velocity_n": (46.3, 5.0, -1.0)}
_HERE = {"latitude": 0.6589, "longitude": -2.1223, "altitude": 1500.0}
_LEVEL = {"roll": 0.1, "pitch": 0.05, "heading": 1.0}
_TRIADS: dict[str, Any] = {}
for _sensor, _unit in (("gyro", 0.01), ("accelerometer", 0.1)):
    _TRIADS |= {
        f"{_sensor}_{_name}": _value
        for _name, _value in {
            "null_shift": (_unit, -2.0 * _unit, 3.0 * _unit),
            "null_shift_sigma": _unit,
            "scale_factor": (0.01, 0.02, -0.03),
            "scale_factor_sigma": 0.005,
            "scale_factor_asymmetry": (0.003, -0.004, 0.005),
            "scale_factor_asymmetry_sigma": 1e-3,
            "scale_factor_temperature": (1e-4, 2e-4, -1e-4),
            "scale_factor_temperature_sigma": 1e-4,
            "null_shift_temperature": (0.01 * _unit, 0.02 * _unit, -0.01 * _unit),
            "null_shift_temperature_sigma": 0.01 * _unit,
            "nonorthogonality": (0.01, 0.02, -0.03),
            "nonorthogonality_sigma": 0.002,
            "drift_sigma": (0.1 * _unit, 0.2 * _unit, 0.3 * _unit),
            "drift_time": 5.0,
            "noise_sigma": (0.1 * _unit, 0.05 * _unit, 0.2 * _unit),
            "flicker": 0.1 * _unit,
            "walk_sigma": 3.0 * _unit,
            "bandwidth": 20.0,
            "damping": 0.6,
            "range": 1000.0 * _unit,
            "resolution": (0.01 * _unit, 0.02 * _unit, 0.0),
            "scale_factor_change": (0.01, 0.0, -0.02),
        }.items()
    }

_AZIMUTH, _ELEVATION = np.radians([(15, 70), (75, 30), (130, 55), (180, 20), (265, 15), (300, 65)]).T
_AWAY = np.stack([np.cos(_ELEVATION) * np.cos(_AZIMUTH), np.cos(_ELEVATION) * np.sin(_AZIMUTH), -np.sin(_ELEVATION)], 1)
_SATELLITES = np.zeros((24, 3))
_SATELLITES[:6] = earth.to_ecef(*_HERE.values()) + 2.2e7 * _AWAY @ earth.north_east_down(*[*_HERE.values()][:2])
SKY: dict[str, Any] = {
    "signals.satellite_e": _SATELLITES,
    "signals.tracked": [True] * 6 + [False] * 18,
    "signals.signal_to_noise": 45.0,
    "signals.valid": True,
}
"""Six satellites above a place, as a receiver tells them."""

EVERYTHING: dict[str, dict[str, Any]] = {
    "air_data": {
        **_HERE,
        **_NORTH,
        **_LEVEL,
        "wind_n": (3.0, -4.0, 0.5),
        "temperature_deviation": 5.0,
        "sea_level_pressure": 100500.0,
        "pitot_ice": 0.3,
        "static_leak": 0.01,
        "pitot_leak": 0.01,
        "static_water": 5.0,
        "pitot_water": 5.0,
        "airspeed_noise_sigma": 0.5,
        "pitot_coefficient": 0.01,
        "pressure_offset": 10.0,
        "temperature_error": 0.5,
        "altitude_field_sigma": 10.0,
        "altitude_noise_sigma": 2.0,
        "altitude_noise_slope": 0.003,
        "static_coefficient": 0.02,
        "static_coefficient_attack": 0.1,
        "static_coefficient_sideslip": 0.1,
        "static_lag_time": 0.3,
        "total_lag_time": 0.2,
        "recovery_factor": 0.9,
        "temperature_lag_time": 5.0,
        "geoid_by_position": True,
    },
    "aircraft": {"wind_n": (3.0, -4.0, 0.5)},
    "azimuth_detector": {
        **_HERE,
        **_LEVEL,
        "specific_force": (0.3, -1.0, -9.7),
        "deviation": (0.01, 0.02, -0.01, 0.005, 0.003),
        "deviation_change": (0.01, 0.0, 0.0, 0.0, 0.0),
    },
    "dme": {
        **_HERE,
        **_NORTH,
        "mode": 1,
        "station_count": 5,
        "station_latitude": 0.6612,
        "station_longitude": -2.1278,
        "interval": 2.0,
        "lock_in": 1.0,
        "traffic": 60.0,
        "replies_lost": 0.1,
        "echo": 100.0,
        "delay_change": 1e-7,
        "delay_drift": 1e-9,
        "memory_time": 10.0,
        "reply_efficiency": 0.9,
        "precise": True,
        "receiver_share": 0.7,
        "receiver_offset": 200.0,
        "station_offset_sigma": 150.0,
        "nearest": 100.0,
        "highest_elevation": 1.4,
    },
    "doppler_radar": {
        **_NORTH,
        **_LEVEL,
        "altitude": 1500.0,
        "over_water": True,
        "wind_n": (3.0, -4.0, 0.5),
        "scale_factor": 0.01,
        "misalignment": (1e-3, -2e-3, 3e-3),
        "bias": (0.1, 0.2, -0.1),
    },
    "gps": {**_HERE, **_NORTH, **_LEVEL},
    "gps_attitude": {**_HERE, **_LEVEL, **SKY, "oldest": 1e9},
    "gps_errors": {"upload_age": 86400.0, "accuracy_lie": 1.0},
    "gps_signals": {
        **_HERE,
        **_NORTH,
        **_LEVEL,
        "specific_force": (1.0, 2.0, -9.0),
        "jammer_power": 0.01,
        "range_step": 30.0,
        "range_error": 2.0,
        "ionosphere_error": -0.1,
        "zenith_error": 0.05,
        "upload_age": 86400.0,
        "clock_drift_start": 2e-7,
        "ionosphere_scale": 1.5,
        "waas": True,
        "slips": True,
    },
    "imu": {
        **_TRIADS,
        "rate": (0.1, -0.2, 0.3),
        "specific_force": (1.0, 2.0, -9.0),
        "temperature": 303.15,
        "vibrating": True,
        "accelerometer_rectification": 1e-4,
        "misalignment": (1e-3, -2e-3, 3e-3),
        "misalignment_sigma": 4e-3,
        "misalignment_change": (0.01, 0.0, 0.02),
        "gyro_lag_order": 1,
        "gyro_g_sensitivity": ((0.0, 1e-5, 2e-5), (3e-5, 4e-5, 5e-5), (6e-5, 7e-5, 8e-5)),
        "gyro_g_sensitivity_sigma": 1e-5,
        "gyro_g_sensitivity_change": 1e-4,
        "lever_arm": (2.0, -0.5, 0.3),
        "self_heating": 10.0,
        "thermal_time": 60.0,
        "calibration_temperature": 300.0,
        "wander_period": 0.5,
        "flicker_time": 2.0,
        "latency": 3,
        "increment_samples": 5,
        "coning_fits_lag": True,
        "angle_quantum": 1e-5,
        "velocity_quantum": 1e-4,
    },
    "loran": {**_HERE, **_NORTH, "cycle_slip": (1500.0, -300.0)},
    "magnetometer": {
        **_HERE,
        **_LEVEL,
        "hard_iron": (1e-6, -2e-6, 3e-6),
        "hard_iron_change": (1e-6, 0.0, 0.0),
        "soft_iron": ((0.01, 0.02, 0.03), (0.0, -0.01, 0.01), (0.02, 0.01, 0.0)),
        "soft_iron_change": 0.001,
        "scale_factor": (0.01, -0.01, 0.02),
        "misalignment": (0.01, -0.01, 0.02),
        "wire_current": 10.0,
        "anomaly_n": (1e-7, 2e-7, 0.0),
        "crust_decays": True,
        "resolution": 1e-8,
    },
    "radar_fix": {**_HERE, "azimuth_shift": 0.01, "scan_period": 0.8, "scan_phase": 0.1, "arrival_phase": 0.4},
    "ring_laser": {"rate": (7e-5, -0.2, 1.0), "pulse": 1e-6},
    "vor": {
        **_HERE,
        **_NORTH,
        "course_shift": 0.01,
        "station_count": 5,
        "station_latitude": 0.6612,
        "station_longitude": -2.1278,
        "station_variation": 0.2,
    },
    "weather": {
        **_NORTH,
        "temperature_mean": 5.0,
        "temperature_gradient": 1e-5,
        "pressure_mean": 100500.0,
        "pressure_gradient": 1e-3,
    },
    "wind": {
        **_NORTH,
        "altitude": 300.0,
        "shear": True,
        "gust": True,
        "mean_n": (5.0, -3.0, 0.0),
        "sigma": (5.0, 5.0, 1.0),
        "profile_exponent": 0.143,
        "layer_count": 2,
        "layer_altitude": (0.0, 1000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        "layer_wind_n": 3.0,
        "shear_time": 10.0,
        "turbulence_sigma": (2.0, 2.0, 1.0),
        "wind_at_20_feet": 15.0,
    },
}
