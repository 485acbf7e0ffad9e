"""The runtime with several models under the address, leak and undefined-behaviour sanitizers."""

import os
import subprocess
from pathlib import Path

import pytest

from navfmu.export.build import prepare
from navfmu.export.lower import lower
from tests import sanitizers

from .arrays import Cube, Receiver
from .components import (
    Iterating,
    Listener,
    Mixed,
    Modes,
    Named,
    Planned,
    Rows,
    Searcher,
    Sensor,
    Source,
    Ticking,
    TwoRates,
)


@sanitizers.needs_gcc
@pytest.mark.parametrize(
    "component",
    [
        Sensor,
        Listener,
        Source,
        Rows,
        Searcher,
        Planned,
        TwoRates,
        Mixed,
        Modes,
        Named,
        Ticking,
        Iterating,
        Cube,
        Receiver,
    ],
)
def test_sanitizers_find_nothing_whatever_a_host_calls(component, tmp_path):
    model = lower(component)
    for name, text in prepare(model).files.items():
        (tmp_path / name).write_text(text)
    for table in model.tables:
        (tmp_path / table.file).write_bytes(table.content)
    sources = [Path(__file__).with_name("drive.c")]
    program = sanitizers.compile(sources, tmp_path / "drive", [tmp_path])
    environment = {k: v for k, v in os.environ.items() if k != "LD_PRELOAD"}
    done = subprocess.run(
        [str(program), tmp_path.as_uri()], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout == "clean 1\n"
