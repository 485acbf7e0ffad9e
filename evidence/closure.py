"""Closure: integrating the aircraft's own specific force and body rate returns its trajectory."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from evidence import strapdown
from evidence.section import Section
from models.earth.earth import EQUATORIAL_RADIUS
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png
from navfmu.report.page import Page
from navfmu.system.system import System

PERIOD = 0.0025
"""Instants at which a derivative bends are even samples then; Simpson's rule across a bend is wrong itself."""
STOP = 1800.0
ACROSS, HEIGHT = 0.01, 2.0
"""How far the integrated position may drift: m horizontally, mm in height."""


def run(out: Path) -> Section:
    """Thirty minutes of the Livermore flight in wind and gusts, integrated in inertial space by another program."""
    system = System.load("backup_navigator")
    flight = system.run(
        stop=STOP, step=PERIOD, seed=1, record=["aircraft"], record_period=PERIOD,
        parameters={"aircraft.update_period": PERIOD},
    )  # fmt: skip
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
    north = (integrated[0] - position[0][:count]) * EQUATORIAL_RADIUS
    east = (integrated[1] - position[1][:count]) * EQUATORIAL_RADIUS * np.cos(position[0][:count])
    return section(north, east, integrated[2] - position[2][:count])


def section(north: np.ndarray, east: np.ndarray, up: np.ndarray) -> Section:
    """What integrated minus true position (m, at every ``PERIOD``) shows."""
    across, height = np.hypot(north, east), 1e3 * np.abs(up)
    minutes = f"{(len(across) - 1) * PERIOD / 60:.0f} minutes"
    returns = Claim(
        f"Integrating force and rate returns the trajectory: within {ACROSS:g} m over ground in {minutes}",
        float(np.max(across)), ACROSS, at_least=False, unit="m",
        opposite=f"Integrating force and rate does not return the trajectory within {ACROSS:g} m in {minutes}",
    )  # fmt: skip
    text = f"The integrated height stays within {HEIGHT:g} mm of the trajectory's in {minutes}"
    rises = Claim(text, float(np.max(height)), HEIGHT, at_least=False, unit="mm")

    def write(page: Page) -> None:
        page.heading("Closure of the truth")
        page.text(
            f"After {minutes} {1e3 * across[-1]:.2g} mm horizontally and {height[-1]:.2g} mm in height; at most "
            f"{1e3 * np.max(across):.2g} mm and {np.max(height):.2g} mm. Samples every {PERIOD:g} s, integrated "
            "without the project's own equations of motion."
        )
        page.picture(picture(north, east, up, returns.sentence), f"Drift of the integrated trajectory in {minutes}")

    return Section([returns, rises], write)


def picture(north: np.ndarray, east: np.ndarray, up: np.ndarray, title: str) -> bytes:
    """Integrated minus true position against time."""
    with figure(size=(9.0, 3.6)) as (drawing, axis):
        minutes = np.arange(len(north)) * PERIOD / 60.0
        for colour, name, values in zip(COLOURS, ("north", "east", "up"), (north, east, up), strict=False):
            axis.plot(minutes, values, color=colour, label=name)
        axis.set_title(title)
        axis.set_xlabel("time, min")
        axis.set_ylabel("integrated minus true position, m")
        axis.legend()
        return png(drawing)
