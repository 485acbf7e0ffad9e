"""Samples of an inertial unit and velocities of a receiver, from two files that count time from the same moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.calibration.columns import Columns, opened
from navfmu.calibration.times import usual
from navfmu.errors import NavfmuError, nearest
from navfmu.recorded.replay.asked import check_turn, turn

INERTIAL = {"time": (1, "s"), "rate": (3, "rad/s"), "specific_force": (3, "m/s2")}
RECEIVER = {
    "time": (1, "s"),
    **{f"velocity_{axis}": (1, "m/s") for axis in ("north", "east", "down")},
}
PLAUSIBLE = {"specific_force": (8.0, 14.0, "m/s2"), "rate": (0.0, 5.0, "rad/s")}
"""Sizes in the middle of a recording."""


@dataclass(frozen=True)
class Recording:
    """``inertial`` (samples,), s, with ``rate`` (samples, 3), rad/s, and ``specific_force``, m/s2, forward, right,
    down; ``time`` (rows,), s, with ``velocity`` (rows, 3), north, east, down, or (rows, 2), m/s."""

    source: str
    inertial: np.ndarray
    rate: np.ndarray
    specific_force: np.ndarray
    time: np.ndarray
    velocity: np.ndarray
    sentences: tuple[str, ...] = ()


def recording(
    inertial: str | Path,
    receiver: str | Path,
    columns: Mapping[str, tuple[str, ...]],
    units: Mapping[str, str],
    axes: tuple[str, ...] = ("x", "y", "z"),
    begin: float | None = None,
    end: float | None = None,
) -> Recording:
    """Read two tables, or a log of PX4 twice, with velocities from ``begin`` to ``end``, s."""
    check_turn(axes, "--axes")
    for option, given in (("--column", columns), ("--unit", units)):
        for name in given:
            if name not in INERTIAL | RECEIVER:
                known = list(INERTIAL | RECEIVER)
                raise NavfmuError(
                    f"{option} {name}: there is no such quantity; expected {', '.join(known)}{nearest(name, known)}"
                )
    unit = _asked(opened(inertial, "rate_x"), INERTIAL, columns, units)
    fixes = _asked(opened(receiver, "velocity_north"), RECEIVER, columns, units)
    time = unit.values("time")
    usual(unit.file, time)
    turned = turn(axes, "--axes")
    rate, force = unit.values("rate") @ turned.T, unit.values("specific_force") @ turned.T
    for name, values in (("specific_force", force), ("rate", rate)):
        low, high, of = PLAUSIBLE[name]
        size = float(np.median(np.linalg.norm(values, axis=1)))
        if not low <= size <= high:
            raise NavfmuError(
                f"{unit.file.path}: {name} is {size:.3g} {of} in the middle; expected {low:g} to {high:g}; name the "
                f"unit of the file, as in --unit {name}=deg/s"
            )
    names = [name for name in RECEIVER if name != "time" and (name != "velocity_down" or fixes.has(name))]
    told = () if len(names) == 3 else (f"{fixes.file.path} tells no velocity down: the delay is the horizontal one",)
    moments, velocity = fixes.values("time"), np.column_stack([fixes.values(name) for name in names])
    if not np.all(np.diff(moments) > 0.0):
        at = int(np.argmax(np.diff(moments) <= 0.0)) + 1
        raise NavfmuError(
            f"{fixes.file.path}, {fixes.file.row(at)}: time does not increase; expected velocities one after the other"
        )
    first, last = moments[0] if begin is None else begin, moments[-1] if end is None else end
    within = (moments >= first) & (moments <= last)
    if not np.any(within):
        raise NavfmuError(
            f"{fixes.file.path}: no velocity is from {first:g} to {last:g} s; expected --begin and --end in its time, "
            f"{moments[0]:g} to {moments[-1]:g} s"
        )
    source = f"{unit.file.path}, {fixes.file.path}"
    return Recording(source, time, rate, force, moments[within], velocity[within], told)


def _asked(file, quantities, columns, units) -> Columns:
    return Columns(
        file, quantities, *({n: v for n, v in given.items() if n in quantities} for given in (columns, units))
    )
