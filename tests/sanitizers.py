"""The address and undefined-behaviour sanitizers of gcc: how C code is compiled with them, and Python run with them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

GCC = shutil.which("gcc")
FLAGS = ("-std=c11", "-g", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter")
SANITIZE = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")
ROOT = Path(__file__).parents[1]

needs_gcc = pytest.mark.skipif(GCC is None or not sys.platform.startswith("linux"), reason="needs gcc on Linux")


def compile(sources: Iterable[Path], output: Path, include: Iterable[Path], *flags: str) -> Path:
    """A program from C sources, or with the flags of ``SHARED`` a library."""
    folders = [f"-I{folder}" for folder in include]
    command = [GCC, *FLAGS, *SANITIZE, *flags, *folders, *map(str, sources), "-o", str(output), "-lm"]
    subprocess.run(command, check=True)
    return output


def use(engine: str | Path) -> None:
    """Have this process load a sanitized engine in the place of its own."""
    from navfmu.engine import loading

    loading.binary = lambda: Path(engine)
    assert Path(loading.engine_library()._name) == Path(engine), "another engine has been loaded"


SHARED = ("-fPIC", "-shared", "-fvisibility=hidden")


def run_python(module: str, *arguments: object) -> None:
    """Run a module that loads sanitized libraries; it must print "clean", and the sanitizers nothing."""
    preload = [
        subprocess.run([GCC, f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    environment = os.environ | {
        "LD_PRELOAD": " ".join(preload),
        "ASAN_OPTIONS": "detect_leaks=0:halt_on_error=1",  # Python itself keeps memory until the end
        "PYTHONMALLOC": "malloc",
        "PYTHONPATH": str(ROOT),
    }
    command = [sys.executable, "-m", module, *map(str, arguments)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.strip() == "clean"
    assert "runtime error" not in done.stderr
    assert "AddressSanitizer" not in done.stderr
