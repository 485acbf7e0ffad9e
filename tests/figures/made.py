"""A collection of rows that are made, in a folder of its own; what one of them does a text says."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
HEAD = """
import os, signal, time
from navfmu.errors import NavfmuError
from navfmu.figures import Comparison, Difference, Found, row
from navfmu.report.figure import figure, png

def drawn():
    with figure() as (drawing, axis):
        return png(drawing)

def compared(found, **more):
    return Comparison("a number", "3", found, 2.0, 4.0, "it has no more digits", **more)
"""
GOOD = 'return Found([compared(2.0 + task.seed / 10)], drawn(), "nothing")'
ROWS = {
    "m2": GOOD,
    "m10": 'return Found([compared(6.0, difference=Difference(5.0, 7.0, "the area is another"))], drawn(), "nothing")',
    "m11": 'return Found([compared(8.0, difference=Difference(5.0, 7.0, "the area is another"))], drawn(), "nothing")',
    "m12": "return [][1]",
    "m13": "os.kill(os.getpid(), signal.SIGKILL)",
    "m14": 'raise NavfmuError("there is no such orbit")',
    "m15": "task.fmu('imu')",
}


def collection(folder: Path, rows: dict[str, str] = ROWS, **more: str) -> Path:
    """Write it below ``folder``, which is to be on the path of Python; a row a file."""
    package = folder / "navfmu_figures" / "made"
    package.mkdir(parents=True, exist_ok=True)
    (package / "__init__.py").write_text('"""A book that is made."""\n')
    for name, does in (rows | more).items():
        needs = 'fmus=["imvu"]' if "imvu" in does else ""
        (package / f"{name}.py").write_text(
            f'{HEAD}\n@row("{name} is so", "page 7", {needs})\ndef {name}(task):\n    {does}\n'
        )
    return folder


def command(folder: Path, *words: object) -> list[str]:
    return [sys.executable, "-m", "navfmu", "figures", *map(str, words)]


def environment(folder: Path) -> dict[str, str]:
    return os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(folder)])}


def navfmu(folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """``navfmu figures`` with what is written in ``folder``."""
    return subprocess.run(
        command(folder, *words), cwd=folder, env=environment(folder), capture_output=True, text=True, timeout=120
    )
