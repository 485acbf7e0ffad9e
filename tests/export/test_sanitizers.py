"""The runtime with several models under the address, leak and undefined-behaviour sanitizers."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from navfmu.export.build import prepare
from navfmu.export.tracing.lower import lower
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
    Terrain,
    Ticking,
    TwoRates,
    Wide,
)


def mutations(good: bytes, count: int):
    """A good file, and many with other bytes, most of them in the header, with some missing and some too many."""
    generator = np.random.default_rng(7)
    yield good
    for k in range(count):
        data = bytearray(good)
        for _ in range(generator.integers(1, 4)):
            place = generator.integers(0, 200 if k % 3 else len(data)) % len(data)
            data[place] = generator.choice([*b"0123456789(),' <>fdN{}", 0, 1, 255, generator.integers(256)])
        cut = generator.integers(0, len(data) + 1) if k % 5 == 0 else len(data)
        yield bytes(data[:cut]) + bytes(8 * (k % 7 == 0))


@sanitizers.needs_gcc
@pytest.mark.parametrize("component", [Rows, Terrain])
def test_sanitizers_find_nothing_whatever_a_table_holds(component, tmp_path):
    """A reader that took the sizes from the header before it had the numbers would read and write beyond them."""
    model = lower(component)
    for name, text in prepare(model).files.items():
        (tmp_path / name).write_text(text)
    files = [tmp_path / f"{k}.npy" for k in range(1501)]
    for file, data in zip(files, mutations(model.tables[0].content, 1500), strict=True):
        file.write_bytes(data)
    program = sanitizers.compile([Path(__file__).with_name("load.c")], tmp_path / "load", [tmp_path])
    done = subprocess.run([str(program), str(tmp_path), str(len(files))], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    taken = int(done.stdout)
    assert 1 <= taken < 1000  # some only have other numbers


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
        Wide,
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
