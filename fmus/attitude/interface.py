"""What all attitude references have in common, so that one stands for another in a system: bundles and parameters."""

from __future__ import annotations

import copy

from fmus.attitude.ahrs import Ahrs

PARAMETERS = (
    "sample_period", "aiding_period", "declination", "declination_sigma", "chart_period", "date", "mounting_sigma",
    "level_sigma", "gyro_noise", "alpha", "gyro_scale_sigma", "gyro_null_shift_sigma", "gyro_drift_sigma",
    "gyro_drift_time", "airspeed", "airspeed_time", "blind_airspeed_sigma", "air_timeout", "field_sigma",
    "hard_iron_sigma", "dip_sigma", "dip_walk", "gps_sigma", "gps_timeout", "initial_sigma",
)  # fmt: skip
"""Parameters of ``ahrs`` that mean the same in others."""
OUTPUTS = ("gyro_bias", "hard_iron", "dip", "local_declination")

Reference = type(
    "Reference",
    (),
    {
        **Ahrs.layout.bundles,
        **{name: copy.copy(getattr(Ahrs, name)) for name in (*PARAMETERS, *OUTPUTS)},
    },
)
"""Base of an attitude reference, with the bundles, parameters and outputs of ``ahrs``."""
