"""A recording of an inertial unit at rest, from a file: columns by name, checked, cut to where nothing moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from navfmu.calibration.allan.sensor import SENSORS, Sensor
from navfmu.calibration.allan.stretches import SHORTEST, quiet
from navfmu.calibration.columns import Columns, opened
from navfmu.calibration.times import GAP, TIME, usual
from navfmu.errors import NavfmuError
from navfmu.recorded.replay.file import File

STEPS = 5
"""Values that a column has at rest, at least: noise of half a step of the resolution or more has so many."""
SCATTER = 1e-12
"""Standard deviation at rest, rad/s and m/s2, at least: a thousandth of what the best gyros have."""
IRREGULAR = 0.1
"""Share of the usual interval by which intervals may differ without a word."""
CUT = 0.05
"""Share of samples at the largest or the smallest value from which on, if it has more than the value beside it, what is
beyond was cut off."""


@dataclass(frozen=True)
class Recording:
    """Quiet ``stretches`` of samples (n, 3) of each sensor, SI, taken every ``period`` s; ``seconds`` is the file's
    length."""

    source: str
    period: float
    seconds: float
    stretches: Mapping[Sensor, list[np.ndarray]]
    sentences: tuple[str, ...]


def recording(path: str | Path, columns: Mapping[str, tuple[str, ...]], units: Mapping[str, str]) -> Recording:
    """Read a table, or a log of PX4; ``columns`` and ``units`` say those of time, rate and specific_force that are not
    usual."""
    file = opened(path, "rate_x")
    found = Columns(file, {TIME: (1, "s"), **{sensor.quantity: (3, sensor.unit) for sensor in SENSORS}}, columns, units)
    time = found.values(TIME)
    samples = {sensor: found.values(sensor.quantity) for sensor in SENSORS if found.has(sensor.quantity)}
    if not samples:
        raise NavfmuError(
            f"{file.path}: has no sensor's columns; expected rate_x, rate_y, rate_z or specific_force_x, _y, _z, or "
            "others by --column, as in --column rate=gx,gy,gz"
        )
    period = usual(file, time)
    interval = np.diff(time)
    parts = _pieces(np.hstack(list(samples.values())), interval, period)
    if not parts:
        raise NavfmuError(
            f"{file.path}: nothing is at rest for {SHORTEST} s without a gap in these {time[-1] - time[0]:.0f} s; "
            "expected a unit that lies still, for hours if slow errors are to be seen"
        )
    stretches = {sensor: [values[part] for part in parts] for sensor, values in samples.items()}
    for sensor, taken in stretches.items():
        _check_plausible(file, sensor, taken)
    return Recording(
        file.path, period, float(time[-1] - time[0]), stretches, tuple(_sentences(file, time, period, parts, stretches))
    )


def _pieces(samples: np.ndarray, interval: np.ndarray, period: float) -> list[slice]:
    edges = [0, *(np.flatnonzero(interval > GAP * np.median(interval)) + 1).tolist(), len(samples)]
    return [
        slice(first + part.start, first + part.stop)
        for first, last in pairwise(edges)
        for part in quiet(samples[first:last], period)
    ]


def _check_plausible(file: File, sensor: Sensor, stretches: list[np.ndarray]) -> None:
    low, high = sensor.plausible
    size = float(np.linalg.norm(np.mean(np.vstack(stretches), axis=0)))
    if not low <= size <= high:
        raise NavfmuError(
            f"{file.path}: {sensor.quantity} at rest is {size:.4g} {sensor.unit}; expected {low:g} to {high:g}; name "
            f"the unit of the file, as in --unit {sensor.quantity}={'deg/s' if sensor.unit == 'rad/s' else 'g'}"
        )
    for axis, values in zip("xyz", np.vstack(stretches).T, strict=True):
        if not np.std(values) > SCATTER:
            raise NavfmuError(
                f"{file.path}: {sensor.quantity} {axis} scatters by {np.std(values):.3g} {sensor.unit} at rest; "
                f"expected the noise of a sensor, {SCATTER:g} at least"
            )
        levels, counts = np.unique(values, return_counts=True)
        if len(levels) < STEPS:
            raise NavfmuError(
                f"{file.path}: {sensor.quantity} {axis} has {len(levels)} values only at rest; expected noise of "
                f"{STEPS} at least: the chart would show the steps of the resolution"
            )
        for end, beside in ((0, 1), (-1, -2)):
            if counts[end] > max(CUT * len(values), counts[beside]):
                raise NavfmuError(
                    f"{file.path}: {sensor.quantity} {axis} is {levels[end]:.6g} {sensor.unit} in "
                    f"{100.0 * counts[end] / len(values):.0f} % of the samples at rest and never beyond; expected "
                    "noise that the range of the sensor does not cut off"
                )


def _sentences(file: File, time: np.ndarray, period: float, parts: list[slice], stretches) -> list[str]:
    rest = [(part.stop - part.start) * period for part in parts]
    many = f"in {len(rest)} stretches of {min(rest):.0f} to {max(rest):.0f} s" if len(rest) > 1 else "in one stretch"
    found = [*file.told, f"{sum(rest):.0f} s at rest of {time[-1] - time[0]:.0f} s, {many}, at {1.0 / period:.6g} Hz"]
    interval = np.diff(time)
    near = interval[interval <= GAP * np.median(interval)]
    off = float(np.mean(np.abs(near / period - 1.0) > IRREGULAR))
    if off > 0.01:
        found.append(f"{100.0 * off:.0f} % of the intervals differ by more than a tenth; they are taken for equal ones")
    missing = [sensor.quantity for sensor in SENSORS if sensor not in stretches]
    return found + [f"{name}: not in the file" for name in missing]
