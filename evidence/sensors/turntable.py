"""An inertial unit on a table of three axes: the truth, and what ``imu`` shows of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from fmpy import simulate_fmu
from scipy.spatial.transform import Rotation

from models.earth import earth
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand

LATITUDE, ALTITUDE = np.radians(47.75), 420.0
"""Of the table."""
EARTH = 7.292115e-5
"""rad/s."""
QUARTER, EIGHTH = 90.0, 45.0


def eight_by_three() -> np.ndarray:
    """Roll, pitch, heading (24, 3), rad, of AGARD CP-298, paper 10, Fig. 7: eight attitudes about each of the axes in
    its turn, 45 degrees apart."""
    about_x = [(EIGHTH * k, 0.0, 0.0) for k in range(8)]
    about_y = [(0.0, EIGHTH * k, QUARTER) for k in range(8)]
    about_z = [(QUARTER, EIGHTH * k, QUARTER) for k in range(8)]
    return np.radians(np.array(about_x + about_y + about_z))


def faces() -> np.ndarray:
    """Roll, pitch, heading (6, 3), rad: each axis up and down."""
    return np.radians([[0, 0, 0], [180, 0, 0], [90, 0, 0], [-90, 0, 0], [0, 90, 0], [0, -90, 0]]).astype(float)


def turns(rates: Sequence[float] = (1.0, 3.0, 10.0)) -> np.ndarray:
    """Roll, pitch, heading, table rate (n, 4), rad and rad/s: each axis down, turned both ways at ``rates``, deg/s."""
    down = np.radians([[0.0, 0.0, 0.0], [90.0, 0.0, 0.0], [0.0, -90.0, 0.0]])
    return np.array([[*face, side * np.radians(rate)] for face in down for rate in rates for side in (1.0, -1.0)])


def truth(stands: np.ndarray, hold: float, move: float, period: float) -> pd.DataFrame:
    """What a table does that takes each of ``stands`` (n, 3 or 4) for ``hold`` s and ``move`` s to the next one.

    Columns: time, roll, pitch, heading, table_rate, and what acts on the unit, true_rate_* and true_force_*, in b.
    """
    stands = np.column_stack([stands, np.zeros((len(stands), 4 - stands.shape[1]))])
    still, under_way = round(hold / period), round(move / period)
    rows = []
    for k, (*angles, rate) in enumerate(stands):
        heading = angles[2] + rate * period * np.arange(still)
        rows.append(np.column_stack([np.tile(angles[:2], (still, 1)), heading, np.full(still, rate)]))
        if k + 1 < len(stands):
            share = (np.arange(under_way) + 1.0)[:, None] / (under_way + 1.0)
            way = rows[-1][-1, :3] + share * (stands[k + 1, :3] - rows[-1][-1, :3])
            rows.append(np.column_stack([way, np.zeros(under_way)]))
    table = np.vstack(rows)
    to_n = Rotation.from_euler("ZYX", table[:, [2, 1, 0]])
    step = (to_n[:-1].inv() * to_n[1:]).as_rotvec() / period
    slow = np.vstack([step[:1], step]) if len(step) else np.zeros((len(table), 3))
    turning = table[:, 3] != 0.0
    slow[turning] = to_n[turning].inv().apply([0.0, 0.0, 1.0]) * table[turning, 3:]
    resting = np.all(np.diff(table, axis=0, prepend=table[:1]) == 0.0, axis=1) & ~turning
    resting[0] = True
    slow[resting] = 0.0
    spin = to_n.inv().apply(EARTH * np.array([np.cos(LATITUDE), 0.0, -np.sin(LATITUDE)]))
    force = to_n.inv().apply([0.0, 0.0, -earth.gravity(LATITUDE, ALTITUDE)])
    frame = pd.DataFrame(table, columns=["roll", "pitch", "heading", "table_rate"])
    frame.insert(0, "time", period * np.arange(1, len(table) + 1))
    for name, values in (("true_rate", slow + spin), ("true_force", force)):
        frame[[f"{name}_{axis}" for axis in "xyz"]] = values
    return frame


def shown(fmu: str | Path, motion: pd.DataFrame, parameters: Mapping[str, Any], seed: int) -> pd.DataFrame:
    """The readings of an ``imu`` with these ``parameters`` beside what the table did: the columns of ``navfmu calibrate
    imu``."""
    period = float(motion["time"].iloc[0])
    names = {**{f"rate[{i}]": f"true_rate_{a}" for i, a in zip((1, 2, 3), "xyz", strict=True)},
             **{f"specific_force[{i}]": f"true_force_{a}" for i, a in zip((1, 2, 3), "xyz", strict=True)}}  # fmt: skip
    given = np.zeros(len(motion) + 1, dtype=[("time", float), *((name, float) for name in names)])
    given["time"] = np.concatenate([motion["time"] - period, motion["time"].iloc[-1:]])
    for name, column in names.items():
        given[name] = np.append(motion[column], motion[column].iloc[-1])
    values = expand(describe(fmu), {**parameters, "seed": seed, "sample_period": period}, "imu")
    outputs = [f"reading.{name}[{i}]" for name in ("rate", "specific_force") for i in (1, 2, 3)]
    with redirect_stdout(StringIO()):  # a line for each input that keeps its start value
        run = simulate_fmu(
            str(fmu), stop_time=float(motion["time"].iloc[-1]), step_size=period, output_interval=period,
            start_values=values, input=given, output=outputs,
        )  # fmt: skip
    frame = motion[["time", "roll", "pitch", "heading", "table_rate"]].copy()
    for output in outputs:
        name, number = output.removeprefix("reading.").rstrip("]").split("[")
        frame[f"{name}_{'xyz'[int(number) - 1]}"] = np.asarray(run[output])[1 : len(frame) + 1]
    return frame
