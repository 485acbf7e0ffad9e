"""An FMU that integrates y' = u as solvers of other makers do: see ``solver.c``."""

from __future__ import annotations

import hashlib
import tempfile
from functools import cache
from pathlib import Path

from navfmu.engine.library import RUNTIME
from navfmu.export import toolchain
from navfmu.fmi.fmu import library_suffix, platforms
from tests.ssp import fmus


@cache
def library() -> Path:
    """Its compiled binary; kept between test runs."""
    source = Path(__file__).parent / "solver.c"
    name = hashlib.sha256(source.read_bytes()).hexdigest()[:12]
    path = Path(tempfile.gettempdir()) / f"navfmu-solver-{name}" / f"solver{toolchain.suffix('host')}"
    return path if path.exists() else toolchain.compile_shared([source], path, include=[RUNTIME])


def solver(folder: Path, tolerance: float | None = None) -> Path:
    """``solver.fmu``; its default experiment has the tolerance that is given. It can save and restore its state."""
    variables = [
        fmus.variable("u", "input", reference=0, unit="m", start="1"),
        fmus.variable("y", "output", reference=1, unit="m", initial="calculated"),
    ]
    text = fmus.describe("solver", variables)
    text = text.replace('modelIdentifier="solver"', 'modelIdentifier="solver" canGetAndSetFMUstate="true"')
    if tolerance is not None:
        text = text.replace("<ModelVariables>", f'<DefaultExperiment tolerance="{tolerance}"/><ModelVariables>')
    entry = f"binaries/{platforms()[0]}/solver{library_suffix()}"
    return fmus.write(folder / "solver.fmu", text, **{entry: library().read_bytes()})
