"""The engine and a test FMU under the address and undefined-behaviour sanitizers."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from navfmu.engine.library import RUNTIME, SOURCE, UNITS

GCC = shutil.which("gcc")
FLAGS = ("-std=c11", "-g", "-O1", "-fPIC", "-shared", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
SANITIZE = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")


@pytest.mark.skipif(GCC is None or not sys.platform.startswith("linux"), reason="needs gcc on Linux")
def test_address_and_undefined_behaviour_sanitizers_find_nothing(tmp_path):
    here = Path(__file__).parent
    engine, probe = tmp_path / "engine.so", tmp_path / "probe.so"
    include = (f"-I{SOURCE}", f"-I{RUNTIME}")
    for sources, output, extra in ((UNITS, engine, ()), ((here / "probe.c",), probe, ("-Wno-unused-parameter",))):
        subprocess.run(
            [GCC, *FLAGS, *extra, *SANITIZE, *include, *map(str, sources), "-o", str(output), "-lm"], check=True
        )
    preload = [
        subprocess.run([GCC, f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    environment = os.environ | {
        "LD_PRELOAD": " ".join(preload),
        "ASAN_OPTIONS": "detect_leaks=0:halt_on_error=1",  # Python itself keeps memory until the end
        "PYTHONMALLOC": "malloc",
        "PYTHONPATH": str(here.parents[1]),
    }
    command = [sys.executable, "-m", "tests.engine.sanitized_run", str(engine), str(probe)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=here.parents[1])
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.strip() == "clean"
    assert "runtime error" not in done.stderr
    assert "AddressSanitizer" not in done.stderr
