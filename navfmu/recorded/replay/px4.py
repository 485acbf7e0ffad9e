"""Logs of PX4 (ULog): which topics hold the samples of a sensor, and in which units.

That is in ``px4.toml``. Times count from the start of the log, the same for all sensors.
"""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from navfmu.errors import NavfmuError, quoted
from navfmu.files.reading import regular
from navfmu.recorded.replay.file import File

Fields = dict[str, list[tuple[str, str]]]  # column -> (field, unit) of the topic, newer names first


@dataclass(frozen=True)
class Topic:
    """A message that is logged, and what is taken of it."""

    name: str
    fields: Fields


@cache
def topics() -> dict[str, list[list[Topic]]]:
    """Return by sensor the topics that will do, better ones first, as ``px4.toml`` has them."""
    told = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    known = {name: Topic(name, told["fields"][fields]) for name, fields in told["topics"].items()}
    return {sensor: [[known[name] for name in choice] for choice in them] for sensor, them in told["sensors"].items()}


FIX = 3
"""Least ``fix_type`` of a position in three dimensions."""
NO_TEMPERATURE = -300.0
"""degC: less than this is told where none was measured."""


def read(path: str | Path, sensor: str) -> File:
    """Return the samples of a sensor in a log as a file with the usual columns."""
    path = regular(path, "a log of PX4")
    known = topics()
    if sensor not in known:
        raise NavfmuError(f"{path}: what a log of PX4 tells of '{sensor}' is not known; expected {', '.join(known)}")
    try:
        from pyulog import ULog
    except ImportError:
        remedy = "pip install 'navfmu[px4]'"
        raise NavfmuError(f"{path}: logs of PX4 are read with pyulog, which is not installed: {remedy}") from None
    names = [topic.name for choice in known[sensor] for topic in choice]
    try:
        with contextlib.redirect_stdout(None):  # pyulog prints what it thinks of the file
            log = ULog(str(path), names)
    except Exception as problem:  # of a file that is none, pyulog raises what comes
        raise NavfmuError(f"{path}: this is no log of PX4 ({quoted(' '.join(str(problem).split()))})") from None
    for choice in known[sensor]:
        found = [_frame(log, topic) for topic in choice]
        if found[0] is not None:
            return _file(path, found, tuple(_damage(log)))
    first = dict.fromkeys(choice[0].name for choice in known[sensor])
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
