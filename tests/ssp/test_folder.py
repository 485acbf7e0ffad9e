"""A system of FMUs of one's own, written into a folder, runs there: from anywhere, with all it brings along."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pandas
import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.ssp.writer import SystemSource
from tests.components import systems

ROOT = Path(__file__).parents[2]
STUCK = '[[fault]]\nid = "F1"\ntarget = "lag.y"\ntype = "stuck"\nvalue = 3.0\nstart = 0.5\n'


@pytest.fixture
def source(tmp_path) -> SystemSource:
    own = tmp_path / "own"
    own.mkdir()
    for name in ("source.fmu", "lag.fmu"):
        shutil.copy(systems.fmus() / name, own / f"my_{name}")
    (own / "stuck.toml").write_text(STUCK)
    system = SystemSource("pair", fmus=own, stop_time=1.0, step=0.1)
    system.component("truth", "my_source.fmu").component("lag", "my_lag.fmu")
    system.connect("truth.y", "lag.u").variant("far", parameters={"lag": {"y0": 9.0}})
    return system.attach("faults/stuck.toml", own / "stuck.toml")


def test_the_folder_runs_from_another_folder_with_its_faults_and_variants(source, tmp_path):
    paths = source.write(tmp_path / "pair")
    assert sorted(path.relative_to(tmp_path / "pair").as_posix() for path in paths) == [
        "SystemStructure.ssd",
        "extra/faults/stuck.toml",
        "far.ssd",
        "resources/lag_far.ssv",
        "resources/my_lag.fmu",
        "resources/my_source.fmu",
    ]
    shutil.rmtree(tmp_path / "own")
    (tmp_path / "elsewhere").mkdir()
    command = [sys.executable, "-m", "navfmu", "run", "../pair", "--variant", "far", "--faults", "stuck"]
    done = subprocess.run(
        [*command, "--record", "lag", "--out", "run.csv"],
        cwd=tmp_path / "elsewhere",
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    rows = pandas.read_csv(tmp_path / "elsewhere" / "run.csv", comment="#")
    values = rows[next(column for column in rows if column.startswith("lag.y"))]
    assert values.iloc[0] == 9.0 and values.iloc[-1] == 3.0


def test_folder_and_package_are_the_same_system(source, tmp_path):
    source.write(tmp_path / "pair")
    source.pack(tmp_path / "pair.ssp")
    assert System.load(tmp_path / "pair").digest == System.load(tmp_path / "pair.ssp").digest


def test_documents_alone_are_written_without_fmus(source, tmp_path):
    source.write(tmp_path / "documents", fmus=False)
    assert not [*(tmp_path / "documents").rglob("*.fmu"), *(tmp_path / "documents").rglob("*.toml")]
    with pytest.raises(NavfmuError, match=r"its FMU 'resources/my_source.fmu' is missing"):
        System.load(tmp_path / "documents")


def test_two_fmus_of_one_name_are_refused_and_nothing_is_written(source, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    shutil.copy(systems.fmus() / "lag.fmu", other / "my_source.fmu")
    source.component("second", other / "my_source.fmu")
    with pytest.raises(NavfmuError, match=r"two different FMUs are named my_source.fmu"):
        source.write(tmp_path / "pair")
    assert not (tmp_path / "pair").exists()


@pytest.mark.parametrize("name", ["../stuck.toml", "/stuck.toml", "faults/../../stuck.toml", "", "a\\b.toml"])
def test_an_attachment_stays_inside_the_package(source, name):
    with pytest.raises(NavfmuError, match=r"expected a name such as faults/gps_lost\.toml"):
        source.attach(name, __file__)


def test_an_attachment_that_is_not_there_is_told(source, tmp_path):
    with pytest.raises(
        NavfmuError, match=r"pair: attachment 'faults/x.toml': .*none.toml: no such file; expected a file"
    ):
        source.attach("faults/x.toml", tmp_path / "none.toml")
