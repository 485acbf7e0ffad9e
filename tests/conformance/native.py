"""Compiles and runs ``driver.c``, a host of a hundred lines in C, on Linux and, through wine, on Windows."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np

from navfmu.export.toolchain import TARGETS
from tests.conformance import hosts

HERE = Path(__file__).parent
HEADERS = HERE.parents[1] / "navfmu" / "export" / "runtime"
FOLDERS = {"x86_64-linux": ("linux64", ".so"), "x86_64-windows": ("win64", ".dll")}


def compile_driver(platform: str, folder: Path) -> Path:
    """The driver for a platform, with the compiler that builds the FMUs."""
    program = folder / f"driver-{platform}{'.exe' if 'windows' in platform else ''}"
    command = [sys.executable, "-m", "ziglang", "cc", "-target", TARGETS[platform], "-O1", f"-I{HEADERS}"]
    subprocess.run([*command, HERE / "driver.c", "-o", program], check=True, capture_output=True)
    return program


def wine() -> Path | None:
    """The wine program, wherever Debian or others put it."""
    found = shutil.which("wine64") or shutil.which("wine") or shutil.which("/usr/lib/wine/wine64")
    return Path(found) if found else None


def run(program: Path, platform: str, fmu: Path, folder: Path, step: float, steps: int, every: int) -> np.ndarray:
    """Real outputs of an unpacked FMU, one row for each ``every`` steps."""
    windows = "windows" in platform
    unpacked = folder / f"{fmu.stem}-{platform}"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(unpacked)
    description = fmpy.read_model_description(str(fmu), validate=False)
    variables = {v.name: v for v in description.modelVariables}
    binaries, suffix = FOLDERS[platform]
    library = unpacked / "binaries" / binaries / f"{description.coSimulation.modelIdentifier}{suffix}"
    resources = (unpacked / "resources").as_uri().replace("file:///", "file:///Z:/" if windows else "file:///")
    arguments = [str(library), description.guid, resources, repr(step), str(steps), str(every)]
    if windows:
        arguments[0] = "Z:" + arguments[0].replace("/", "\\")
    for name, value in hosts.starts(fmu).items():
        letter = {"Real": "i", "Integer": "k", "Boolean": "b"}[variables[name].type]
        arguments += [letter, str(variables[name].valueReference), repr(float(value))]
    for variable in hosts.outputs(fmu):
        if variable.type == "Real":
            arguments += ["o", str(variable.valueReference)]
    command = [str(program), *arguments]
    environment = dict(os.environ)
    if windows:
        command = [str(wine()), *command]
        environment |= {
            "WINEPREFIX": str(program.parent / "wine"),
            "WINEDEBUG": "-all",
            "WINEDLLOVERRIDES": "mscoree,mshtml=",
        }
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return np.array([[float.fromhex(cell) for cell in line.split()] for line in done.stdout.splitlines()])
