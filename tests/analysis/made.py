"""The drifter as a system with a table of analyses, packed once per test session."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from navfmu.export.build import build
from navfmu.ssp.writer import SystemSource
from tests.analysis.components import ALL

TABLE = """
[analysis]
errors = ["drifter.x_error", "drifter.y_error"]
covariance = "drifter.covariance"
valid = "drifter.running"
period = 1

[[analysis.source]]
name = "slope"
errors = ["drifter.slope_sigma"]
claims = ["drifter.told_slope"]

[[analysis.source]]
name = "offsets"
errors = ["drifter.offset*"]
claims = ["drifter.told_offset"]

[[analysis.source]]
name = "nothing"
errors = ["drifter.idle_sigma"]
"""
_kept: list[TemporaryDirectory] = []  # removed when the process ends


@cache
def fmus() -> Path:
    """A folder with the FMUs."""
    _kept.append(TemporaryDirectory(prefix="navfmu-tests-"))
    folder = Path(_kept[0].name)
    build(ALL, folder)
    return folder


@cache
def drifter(table: str = TABLE, name: str = "drifter") -> Path:
    """The system; its variant ``bent`` is not linear."""
    source = SystemSource(name, fmus=fmus(), stop_time=40.0, step=0.5, description="errors with a closed form")
    source.component("drifter", "drifter.fmu").component("teller", "teller.fmu")
    source.connect("teller.offset", "drifter.told_offset")
    source.variant("bent", parameters={"drifter": {"bend": 0.05}})
    file = fmus() / f"{name}.toml"
    file.write_text(table)
    source.attach("report.toml", file)
    return source.pack(fmus() / f"{name}.ssp")
