"""The second system, packed."""

from __future__ import annotations

from pathlib import Path

from navfmu.export.build import build
from navfmu.ssp.writer import SystemSource
from tests.second_system.components import ALL

REPORT = Path(__file__).parent / "report.toml"
FAULT = (
    '[[fault]]\nid = "shifted"\ntarget = "finder.offset"\ntype = "input"\nvalue = 1e-5\nstart = 30.0\nduration = 10.0\n'
)


def pack(folder: Path, report: Path | None = REPORT) -> Path:
    """Build the FMUs into a folder and pack the system there; its variant ``shy`` has another finder."""
    if not (folder / "rover.fmu").is_file():
        build(ALL, folder)
        (folder / "shifted.toml").write_text(FAULT)
    source = SystemSource("rover", fmus=folder, stop_time=60.0, step=0.5, description="a rover at the date line")
    for name in ("rover", "finder", "judge"):
        source.component(name, f"{name}.fmu")
    for name in ("finder", "judge"):
        source.connect("rover.latitude", f"{name}.latitude").connect("rover.longitude", f"{name}.longitude")
    source.connect("finder.place", "judge.place")
    source.parameters("finder", {"beacon_latitude": [1.2001, 1.1999, 0.0], "beacon_longitude": [3.1414, -3.1414, 0.0]})
    source.variant("shy", components={"finder": "shy_finder.fmu"})
    source.attach("faults/shifted.toml", folder / "shifted.toml")
    if report is not None:
        source.attach("report.toml", report)
    return source.pack(folder / f"{'rover' if report else 'plain'}.ssp")
