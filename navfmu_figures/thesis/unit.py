"""An inertial unit that stands still and has no error but those it is given."""

from __future__ import annotations

from typing import Any

import numpy as np

from navfmu import System

NONE = {"misalignment_sigma": 0.0} | {
    f"{sensor}_{error}_sigma": 0.0
    for sensor in ("gyro", "accelerometer")
    for error in ("null_shift", "scale_factor", "drift", "noise")
}


def at_rest(
    system: System, stop: float, period: float, seed: int, errors: dict[str, Any], shown: str = "reading.rate"
) -> np.ndarray:
    """What the FMU ``imu`` shows every ``period`` s, in deg or deg/s, (samples, 3); ``errors`` are its parameters."""
    frame = system.run(
        stop=stop,
        step=period,
        record_period=period,
        seed=seed,
        parameters={f"imu.{name}": value for name, value in (NONE | errors).items()},
        record=f"imu.{shown}",
    )
    return np.degrees(frame.to_numpy()[1:])
