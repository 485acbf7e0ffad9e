"""Closure: integrating the aircraft's own specific force and body rate returns its trajectory."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from evidence import strapdown
from navfmu.report.figure import COLOURS, figure, png
from navfmu.report.page import Page
from navfmu.system.system import System

PERIOD = 0.01
STOP = 1800.0
EARTH_RADIUS = 6378137.0


def run(out: Path, page: Page) -> None:
    """Thirty minutes of the Livermore flight in a changing wind, integrated in inertial space by another program."""
    system = System.load("backup_navigator")
    flight = system.run(stop=STOP, step=PERIOD, seed=1, record=["aircraft"], record_period=PERIOD)
    position = [flight[f"aircraft.{name}"].to_numpy() for name in ("latitude", "longitude", "altitude")]
    vectors = {
        name: np.column_stack([flight[f"aircraft.{name}[{i}]"].to_numpy() for i in (1, 2, 3)])
        for name in ("velocity_n", "specific_force", "rate")
    }
    euler = [flight[f"aircraft.{name}"].iloc[0] for name in ("roll", "pitch", "heading")]
    start = [values[0] for values in position]
    integrated = strapdown.navigate(
        PERIOD, vectors["specific_force"], vectors["rate"], *start, vectors["velocity_n"][0], euler
    )
    count = len(integrated[0])
    north = (integrated[0] - position[0][:count]) * EARTH_RADIUS
    east = (integrated[1] - position[1][:count]) * EARTH_RADIUS * np.cos(position[0][:count])
    up = integrated[2] - position[2][:count]
    with figure(size=(9.0, 3.6)) as (drawing, axis):
        minutes = np.arange(count) * PERIOD / 60.0
        for colour, name, values in zip(COLOURS, ("north", "east", "up"), (north, east, up), strict=False):
            axis.plot(minutes, values, color=colour, label=name)
        axis.set_title("Integrating force and rate returns the trajectory: drift in 30 minutes")
        axis.set_xlabel("time, min")
        axis.set_ylabel("integrated minus true position, m")
        axis.legend()
        image = png(drawing)
    page.heading("Closure of the truth")
    across, height = np.hypot(north, east), 1e3 * np.abs(up)
    page.text(
        f"After {STOP / 60:.0f} minutes {across[-1]:.3f} m horizontally and {height[-1]:.2g} mm in height; at most "
        f"{np.max(across):.3f} m and {np.max(height):.2g} mm. Samples every {PERIOD:g} s, integrated without the "
        "project's own equations of motion."
    )
    page.picture(image, "Drift of the integrated trajectory")
