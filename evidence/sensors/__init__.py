"""What each sensor shows against closed forms, other people's software and recordings: a module and a picture each.

``docs/sensors/`` has a page for each, with the picture that ``python -m evidence sensors`` writes to ``OUT/sensors/``.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path

from evidence.section import Section
from navfmu.report.page import Page

SENSORS = (
    "air_data",
    "alternative_aids",
    "at_rest",
    "attitude",
    "azimuth_detector",
    "dme",
    "flown_attitude",
    "gps",
    "gps_options",
    "gps_signals",
    "gps_solver",
    "imu",
    "imu_calibration",
    "hand_held",
    "increments",
    "magnetometer",
    "magnetometer_calibration",
    "navaids",
    "observations",
    "replay",
    "ring_laser",
    "satellites",
    "wind",
)
"""The modules, each with a function ``run(out) -> Section`` that writes ``out/sensors/NAME.png``."""


def run(out: Path) -> Section:
    """All of them, one after the other."""
    (out / "sensors").mkdir(parents=True, exist_ok=True)
    return together({name: importlib.import_module(f"evidence.sensors.{name}").run(out) for name in SENSORS})


def together(sections: Mapping[str, Section]) -> Section:
    """One section of several; what was left out of one is said, and the others count."""

    def write(page: Page) -> None:
        page.heading("Sensors")
        for section in sections.values():
            section.write(page)

    left_out = [f"{name}, because {section.left_out}" for name, section in sections.items() if section.left_out]
    return Section([claim for section in sections.values() for claim in section.claims], write, "; ".join(left_out))
