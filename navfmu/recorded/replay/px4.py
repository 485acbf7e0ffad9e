"""Logs of PX4 (ULog): which topics hold the samples of a sensor, and in which units.

Fields as the message definitions of PX4 have them; of fields that were renamed the newer name comes first. Times count
from the start of the log, the same for all sensors.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from navfmu.errors import NavfmuError, quoted
from navfmu.files.reading import regular
from navfmu.recorded.replay.file import File

Fields = dict[str, tuple[tuple[str, str], ...]]  # column -> (field, unit) of the topic, newer names first
AXES = ("x", "y", "z")


def _vector(column: str, field: str, unit: str, names: tuple[str, ...]) -> Fields:
    return {f"{column}_{axis}": ((field.format(i, axis), unit),) for i, axis in enumerate(names)}


@dataclass(frozen=True)
class Topic:
    """A message that is logged, and what is taken of it."""

    name: str
    fields: Fields


_PRESSURE = Topic("vehicle_air_data", {"static_pressure": (("baro_pressure_pa", "Pa"),)})
_FIX: Fields = {
    "latitude": (("latitude_deg", "deg"), ("lat", "1e-7 deg")),
    "longitude": (("longitude_deg", "deg"), ("lon", "1e-7 deg")),
    "altitude": (("altitude_ellipsoid_m", "m"), ("alt_ellipsoid", "mm")),
    "velocity_north": (("vel_n_m_s", "m/s"),),
    "velocity_east": (("vel_e_m_s", "m/s"),),
    "velocity_down": (("vel_d_m_s", "m/s"),),
    "fix_type": (("fix_type", "1"),),
}
_AIRSPEED: Fields = {
    "calibrated_airspeed": (("calibrated_airspeed_m_s", "m/s"), ("indicated_airspeed_m_s", "m/s")),
    "true_airspeed": (("true_airspeed_m_s", "m/s"),),
    "temperature": (("air_temperature_celsius", "degC"),),
}
TOPICS: dict[str, tuple[tuple[Topic, ...], ...]] = {
    "imu": (
        (
            Topic(
                "sensor_combined",
                _vector("rate", "gyro_rad[{0}]", "rad/s", AXES)
                | _vector("specific_force", "accelerometer_m_s2[{0}]", "m/s2", AXES),
            ),
        ),
    ),
    "magnetometer": (
        (Topic("vehicle_magnetometer", _vector("field", "magnetometer_ga[{0}]", "G", AXES)),),
        (Topic("sensor_mag", _vector("field", "{1}", "G", AXES)),),
    ),
    "gps": ((Topic("vehicle_gps_position", _FIX),), (Topic("sensor_gps", _FIX),)),
    "air_data": ((Topic("airspeed", _AIRSPEED), _PRESSURE), (Topic("airspeed_validated", _AIRSPEED), _PRESSURE)),
}
"""By sensor the topics that will do, better ones first; a second one gives its last values when the first comes."""
FIX = 3
"""Least ``fix_type`` of a position in three dimensions."""
NO_TEMPERATURE = -300.0
"""degC: less than this is told where none was measured."""


def read(path: str | Path, sensor: str) -> File:
    """Return the samples of a sensor in a log as a file with the usual columns."""
    path = regular(path, "a log of PX4")
    if sensor not in TOPICS:
        raise NavfmuError(f"{path}: what a log of PX4 tells of '{sensor}' is not known; expected {', '.join(TOPICS)}")
    try:
        from pyulog import ULog
    except ImportError:
        remedy = "pip install 'navfmu[px4]'"
        raise NavfmuError(f"{path}: logs of PX4 are read with pyulog, which is not installed: {remedy}") from None
    names = [topic.name for choice in TOPICS[sensor] for topic in choice]
    try:
        with contextlib.redirect_stdout(None):  # pyulog prints what it thinks of the file
            log = ULog(str(path), names)
    except Exception as problem:  # of a file that is none, pyulog raises what comes
        raise NavfmuError(f"{path}: this is no log of PX4 ({quoted(' '.join(str(problem).split()))})") from None
    for choice in TOPICS[sensor]:
        found = [_frame(log, topic) for topic in choice]
        if found[0] is not None:
            return _file(path, found, tuple(_damage(log)))
    first = dict.fromkeys(choice[0].name for choice in TOPICS[sensor])
    raise NavfmuError(f"{path}: the log has no {' and no '.join(first)}, so nothing of '{sensor}'")


def _damage(log: Any) -> Iterator[str]:
    """Say what the log lacks."""
    if log.file_corruption:
        yield "the log is damaged; what could not be read is missing"
    if log.dropouts:
        times = [dropout.duration for dropout in log.dropouts]
        yield f"the logger lost data {len(times)} time(s), for up to {max(times)} ms and {sum(times)} ms in all"


def _frame(log: Any, topic: Topic) -> tuple[pd.DataFrame, dict[str, str]] | None:
    """Return the rows of the first instance of a topic, and the units of their columns; None if there are none."""
    rows = next((data.data for data in log.data_list if (data.name, data.multi_id) == (topic.name, 0)), None)
    if rows is None or len(rows.get("timestamp", ())) == 0:
        return None
    since = rows["timestamp"].astype(np.int64) - int(log.start_timestamp)
    columns, units = {"time": since * 1e-6}, {}
    for column, names in topic.fields.items():
        field = next(((name, unit) for name, unit in names if name in rows), None)
        if field:
            columns[column], units[column] = rows[field[0]], field[1]
    return pd.DataFrame(columns), units


def _file(path: Path, found: list[tuple[pd.DataFrame, dict[str, str]] | None], told: tuple[str, ...]) -> File:
    frame, units = found[0]
    for other in filter(None, found[1:]):
        frame = pd.merge_asof(frame, other[0].sort_values("time"), on="time")
        units = units | other[1]
    if "static_pressure" in frame:  # the first airspeeds may be older than the first pressure
        frame = frame.dropna(subset="static_pressure").reset_index(drop=True)
    if "temperature" in frame:
        frame["temperature"] = frame["temperature"].where(frame["temperature"] > NO_TEMPERATURE)
    if "fix_type" in frame:
        frame["valid"] = frame.pop("fix_type") >= FIX
    return File(str(path), frame, None, units, told)
