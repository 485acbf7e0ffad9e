"""The runtime with several models under the address, leak and undefined-behaviour sanitizers."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from navfmu.export.build import prepare
from navfmu.export.codegen import table_text
from navfmu.export.lower import lower

from .components import Listener, Sensor, Source, TwoRates

GCC = shutil.which("gcc")
FLAGS = ("-std=c11", "-g", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter")
SANITIZE = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer")


@pytest.mark.skipif(GCC is None or not sys.platform.startswith("linux"), reason="needs gcc on Linux")
@pytest.mark.parametrize("component", [Sensor, Listener, Source, TwoRates])
def test_sanitizers_find_nothing_whatever_a_host_calls(component, tmp_path):
    model = lower(component)
    for name, text in prepare(model).files.items():
        (tmp_path / name).write_text(text)
    for table in model.tables:
        (tmp_path / f"{table.name}.csv").write_text(table_text(table))
    program = tmp_path / "drive"
    driver = Path(__file__).parent / "drive.c"
    sources = [str(tmp_path / "fmu.c"), str(driver)]
    subprocess.run([GCC, *FLAGS, *SANITIZE, f"-I{tmp_path}", *sources, "-o", str(program), "-lm"], check=True)
    environment = {k: v for k, v in os.environ.items() if k != "LD_PRELOAD"}
    done = subprocess.run(
        [str(program), tmp_path.as_uri()], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout == "clean 1\n"
