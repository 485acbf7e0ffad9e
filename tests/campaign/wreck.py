"""An FMU that ends the process in which it runs, or hangs, as its parameters say: the probe of the engine's tests."""

from __future__ import annotations

from pathlib import Path

from navfmu.fmi.fmu import library_suffix, platforms
from tests.engine.probe import library
from tests.ssp import fmus

SEGFAULT, ABORT, EXIT, HANG, READ, CLOSE, FORK, LEAVE, SHOUT = range(10, 19)
ERROR, FATAL = 3, 4


def wreck(folder: Path) -> Path:
    """``probe.fmu``: at ``fail_at`` (s) its fmi2DoStep does what ``fail_status`` says."""
    variables = [
        fmus.variable("y", "output", reference=1, unit="m"),
        fmus.variable("tau", "parameter", reference=2, unit="s", start="1"),
        fmus.variable("start", "parameter", reference=4, unit="m", start="1"),
        fmus.variable("fail_at", "parameter", reference=5, unit="s", start="1e9"),
        fmus.variable("fail_status", "parameter", "Integer", 2),
        fmus.variable("fail_call", "parameter", "Integer", 3),
    ]
    entry = f"binaries/{platforms()[0]}/probe{library_suffix()}"
    description = fmus.describe("probe", variables, guid="{probe}")
    return fmus.write(folder / "probe.fmu", description, **{entry: library().read_bytes()})
