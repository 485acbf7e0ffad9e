"""An FMU that makes another folder the current one: results land where they were asked for."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from tests.campaign.wreck import LEAVE, wreck

pytestmark = pytest.mark.skipif(os.name == "nt", reason="chdir")
LEAVES = [f"probe.fail_status={LEAVE}", "probe.fail_at=0.75"]
FAULT = '[[fault]]\nid = "F"\ntarget = "probe.y"\ntype = "bias"\nvalue = 1.0\n'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "faults.toml").write_text(FAULT)
    (tmp_path / "seen").mkdir()
    return wreck(tmp_path).parent


def navfmu(folder, *words):
    command = [sys.executable, "-m", "navfmu", *words]
    cache = {"NAVFMU_CACHE": "cache"}  # a relative one, too
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | cache, timeout=120)
    assert done.returncode == 0, done.stderr


def settings(*options):
    return [word for text in LEAVES for word in ("--set", text)] + list(options)


def test_a_run(folder):
    once = ["run", "probe.fmu", "--stop", "2", "--step", "0.1", "--faults", "faults.toml"]
    navfmu(folder, *once, *settings("--out", "out/a.csv", "--report", "report"))
    assert {file.name for file in (folder / "out").iterdir()} == {"a.csv", "a.csv.json"}
    assert {file.name for file in (folder / "report").iterdir()} == {"recording.parquet", "report.html"}
    assert f"--faults {folder}/faults.toml" in json.loads((folder / "out" / "a.csv.json").read_text())["command"]


def test_a_sweep(folder):
    navfmu(folder, "sweep", "probe.fmu", "--stop", "2", "--steps", "0.1,0.2", *settings("--out", "out"))
    assert (folder / "out" / "report.html").is_file()


@pytest.mark.parametrize("workers", ["thread", "process"])
def test_a_campaign(workers, folder):
    text = 'system = "probe.fmu"\nstop = 2\nstep = 0.1\nseeds = "1-4"\n[parameters]\n' + "\n".join(
        f'"{name}" = {value}' for name, value in (text.split("=") for text in LEAVES)
    )
    (folder / "campaign.toml").write_text(text)
    navfmu(folder, "campaign", "campaign.toml", "--jobs", "1", "--workers", workers, "--out", "out", "--strict")
    navfmu(folder, "campaign", "campaign.toml", "--jobs", "1", "--workers", workers)
    for out in ("out", "results/campaign"):
        assert len(list((folder / out / "runs").glob("*.parquet"))) == 4
        assert (folder / out / "report.html").is_file()
