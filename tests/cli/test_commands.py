"""What the commands print and write."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time

import numpy as np
import pandas
import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.export import Bundle, Component, Input, Output, Parameter, every
from navfmu.export.build import build
from navfmu.ssp import SystemSource
from navfmu.system import result
from tests import built
from tests.components import systems


def navfmu(*arguments: object) -> str:
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 0, result.output
    return result.output


def test_help_answers_at_once():
    """Less than 0.3 s of processor time: a busy machine makes the wall clock say nothing."""
    command = [sys.executable, "-m", "navfmu", "run", "--help"]
    durations = []
    for _ in range(5):
        before = os.times()
        out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        after = os.times()
        durations.append(after.children_user + after.children_system - before.children_user - before.children_system)
    assert "--record-period" in out
    assert min(durations) < 0.3


def test_help_lists_all_commands_without_importing_their_modules():
    script = (
        "import sys; from click.testing import CliRunner; from navfmu.cli.main import main;"
        "print(CliRunner().invoke(main, ['--help']).output);"
        "print([m for m in ('numpy', 'pandas', 'rich', 'lxml', 'navfmu.cli.track') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    for command in ("info", "run", "sweep", "campaign", "track"):
        assert f"\n  {command} " in out
    assert out.rstrip().endswith("[]")


def test_info_describes_an_fmu():
    out = navfmu("info", systems.fmus() / "sensor.fmu")
    assert "reading.time_of_validity" in out and "sample_period" in out and "0.0001 .. 10" in out
    assert "saves and restores its state" in out


class Fallible(Component):
    """Can fail."""

    u = Input("m", description="input")
    blinded = Input(kind="boolean", fault=True, description="nothing is seen")
    reading = Bundle(y=Output("m", description="output"), description="reading")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="period")

    @every("sample_period")
    def step(self):
        self.reading.publish(y=self.u, when=np.logical_not(self.blinded))


def test_info_tells_elements_of_an_array_that_are_alike_once(tmp_path_factory):
    """A vector parameter was told three times: 392 lines for imu."""
    out = navfmu("info", built.fmu("imu_replay", tmp_path_factory))
    assert "reading.rate[1..3] " in out and "reading.rate[2]" not in out
    assert "reading.specific_force[1..2] " in out and "reading.specific_force[3] " in out  # which starts at -g
    assert "20 outputs" in out
    out = navfmu("info", built.fmu("gps_solver", tmp_path_factory))  # 144 lines for two matrices
    assert "signals.satellite_e[1..24,1..3] " in out and "signals.satellite_e[1,1]" not in out


def test_info_tells_what_can_be_failed(tmp_path):
    (file,) = build([Fallible], tmp_path)
    out = navfmu("info", file)
    ordinary, _, faults = out.partition("1 fault inputs")
    assert "bundles     reading " in ordinary and "1 inputs" in ordinary and "blinded" not in ordinary
    assert "blinded" in faults.partition("outputs")[0]
    source = SystemSource("fallible", fmus=tmp_path, stop_time=1.0, step=0.1).component("eye", "fallible.fmu")
    out = navfmu("info", source.pack(tmp_path / "fallible.ssp"))
    _, _, free = out.partition("fault inputs")
    assert "eye.blinded  " in free.partition("other unconnected inputs")[0]
    assert "eye.u" in free.partition("other unconnected inputs")[2]


def test_info_describes_a_system():
    out = navfmu("info", systems.tracker())
    assert "variants    slow" in out and "faults      stuck" in out
    assert "lag.bias" in out and "reading.length, reading.valid" in out


def test_run_writes_what_python_returns(tmp_path):
    out = tmp_path / "a.parquet"
    text = navfmu("run", systems.tracker(), "--seed", 3, "--set", "sensor.sigma=0.1",
                  "--stop", 5, "--record", "sensor,estimator.sigma", "--record", "lag.y", "--record-period", 0.5,
                  "--faults", "stuck", "--out", out)  # fmt: skip
    assert "wrote 11 rows" in text
    frame = result.read(out)
    expected = System.load(systems.tracker()).run(
        stop=5.0, seed=3, parameters={"sensor.sigma": 0.1}, record=["sensor", "estimator.sigma", "lag.y"],
        record_period=0.5, faults="stuck",
    )  # fmt: skip
    pandas.testing.assert_frame_equal(frame, expected, check_exact=True)
    assert frame.attrs["units"]["lag.y"] == "m"
    about = frame.attrs["provenance"]
    assert about["seed"] == 3 and about["parameters"] == {"sensor.sigma": "0.1"} and about["faults"][0]["id"] == "F1"
    assert len(about["fmus"]["sensor"]) == 64 and "numpy" in about["versions"] and about["command"]


def test_a_csv_file_holds_the_same_bits_and_its_provenance_beside_it(tmp_path):
    arguments = ("run", systems.tracker(), "--stop", 2, "--seed", 1)
    navfmu(*arguments, "--out", tmp_path / "a.csv")
    navfmu(*arguments, "--out", tmp_path / "a.parquet")
    a, b = result.read(tmp_path / "a.csv"), result.read(tmp_path / "a.parquet")
    pandas.testing.assert_frame_equal(a, b, check_exact=True)
    assert json.loads((tmp_path / "a.csv.json").read_text())["seed"] == 1


def test_the_same_run_writes_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        navfmu("run", systems.tracker(), "--stop", 2, "--out", tmp_path / folder / "x.csv")
    assert (tmp_path / "a" / "x.csv").read_bytes() == (tmp_path / "b" / "x.csv").read_bytes()


def test_commas_inside_brackets_do_not_separate_signals():
    from navfmu.cli.options import names

    assert names(["a.C[1,2],b.x", " c "]) == ["a.C[1,2]", "b.x", "c"]
    assert names(["a.f(x,y),a.'p,q', a.it's"]) == ["a.f(x,y)", "a.'p,q'", "a.it's"]  # of other makers


def test_a_text_may_be_empty():
    from navfmu.cli.options import assigned

    assert assigned(["a.label=", "a.b = x=y "]) == {"a.label": "", "a.b": "x=y"}


def test_sweep_writes_table_picture_and_report(tmp_path):
    out = navfmu("sweep", systems.tracker(), "--steps", "0.05,0.1,0.5", "--signals", "lag,estimator", "--stop", 10,
                 "--out", tmp_path)  # fmt: skip
    assert "Use gauss_seidel with steps up to 0.1 s" in out and "estimator.reading.lost" in out
    for name in ("sweep.csv", "sweep.json", "sweep.png", "report.html"):
        assert (tmp_path / name).stat().st_size > 500
    rows = pandas.read_csv(tmp_path / "sweep.csv")
    assert set(rows.algorithm) == {"gauss_seidel", "jacobi"} and set(rows.step) == {0.05, 0.1, 0.5}
    assert "data:image/png;base64" in (tmp_path / "report.html").read_text()


@pytest.mark.skipif(os.name == "nt", reason="pipes")
def test_a_report_is_there_whatever_becomes_of_the_table(tmp_path):
    """Whoever reads the table may close the pipe at its first line, as ``head`` does."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "navfmu", "run", str(systems.tracker()), "--stop", "10", "--report", "r"]
    try:
        subprocess.run(command, cwd=tmp_path, stdout=writing, stderr=subprocess.DEVNULL)
    finally:
        os.close(writing)
    assert (tmp_path / "r" / "report.html").stat().st_size > 500


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_interrupting_a_run_is_quiet_and_leaves_no_file(tmp_path):
    import signal

    command = [sys.executable, "-m", "navfmu", "run", str(systems.tracker()), "--stop", "1e7", "--record-period", "1e4",
               "--out", str(tmp_path / "x.parquet")]  # fmt: skip
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    time.sleep(2.5)
    process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=20)[1]
    assert process.returncode not in (0, -signal.SIGINT) and "Traceback" not in errors
    assert list(tmp_path.iterdir()) == []
