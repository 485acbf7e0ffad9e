"""What a failed test tells: numbers against the kept recording, its command against the run, its plot."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest
from matplotlib.image import imread

from navfmu.system import result
from tests.testing.inner import ROOT, Folder

TESTS = """
import pytest

@pytest.mark.parametrize("percent", [80])
@pytest.mark.seeds("7")
def test_required(system, percent):
    with system("tracker.ssp", variant="slow") as s:
        s.parameters["truth.amplitude"] = "20 ft"
        s.fault("sensor.reading", at=3, duration="2 s")
        s.require("estimator.solution.length", at_most=1.5, percent=percent, from_=2, id="T-1")
        s.require("estimator.solution.length", at_least=-100.0)
        s.run(10)

def test_required_later(system):
    with system("tracker.ssp") as s:
        s.run(10, seed=1)
        s.require("lag.y", at_least=-100.0)
        s.require("lag.y", at_most="1 ft")

def test_asserted(system):
    with system("tracker.ssp") as s:
        first = s.run(5, seed=1)
        s.fault("lag.bias", at=1, value=2.0)
        second = s.run(5, seed=1)
    assert second["lag.y"].max() < 3.0

def test_held(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=1e6, id="T-2")
        s.run(5)
        s.require("estimator.sigma", at_most=0.9, percent=90)
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=-100.0, expect="violated")
        s.run(5)
"""


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    folder = Folder(tmp_path_factory.mktemp("failures") / "a folder")
    return folder.pytest(TESTS, "--navfmu-artifacts", "kept here")


def kept(ended, test) -> pandas.DataFrame:
    return result.read(ended.row(test, "recording"))


def test_three_of_four_fail(ended):
    assert ended.code == 1 and ended.counts == {"failed": 3, "passed": 1}, ended.out


def test_a_violated_requirement_says_when_and_by_how_much(ended):
    told = " ".join(ended.of("test_required[seed7-80]").split())
    frame = kept(ended, "test_required[seed7-80]")
    value = frame["estimator.solution.length"][frame.index >= 2.0 - 1e-9]
    outside = value[value > 1.5]
    share = np.floor(1000 * (1 - len(outside) / len(value))) / 10
    assert 0 < share < 80
    expected = (
        "AssertionError: requirement T-1 (estimator.solution.length <= 1.5 m for 80 % of the time from 2 s) violated: "
        f"inside for {share} % of the time, first violated at t = {outside.index[0]:g} s, "
        f"worst {value.max():.4g} m at t = {value.idxmax():g} s ({value.max() - 1.5:.4g} m beyond the bound), "
        "slow variant, seed 7; plot in "
    )
    assert expected in told
    assert "truth.amplitude = 20 ft" == ended.row("test_required[seed7-80]", "parameter")
    assert "dropout on sensor.reading, 3 to 5 s" == ended.row("test_required[seed7-80]", "fault")


def test_only_what_is_violated_is_told(ended):
    told = ended.of("test_required[seed7-80]")
    assert "-100 m" not in told


def test_a_requirement_after_a_run_is_asked_of_that_run(ended):
    told = ended.of("test_required_later")
    assert re.search(r'^> +s\.require\("lag.y", at_most="1 ft"\)', told, re.M)
    assert "requirement (lag.y <= 0.3048 m always) violated" in told
    frame = kept(ended, "test_required_later")
    assert f"worst {frame['lag.y'].max():.4g} m at t = {frame['lag.y'].idxmax():g} s" in told


def test_the_test_is_shown_and_not_the_inside_of_the_package(ended):
    told = ended.of("test_required[seed7-80]")
    assert re.search(r"^> +s\.run\(10\)", told, re.M)
    for inside in ("bench.py", "hidden.py", "asked.py", "raise "):
        assert inside not in told


def test_a_plain_assertion_has_system_seed_faults_plot_and_command_of_every_run(ended):
    told = ended.of("test_asserted")
    assert re.search(r"^E +(assert|AssertionError)", told, re.M)
    section = told.split(" navfmu -")[1]
    runs = section.strip().split("\n\n")
    assert len(runs) == 2 and all("tracker, main variant, seed 1" in run for run in runs)
    assert "fault" not in runs[0].split("repeat")[0] and "input (value = 2.0) on lag.bias, from 1 s" in runs[1]
    for word, number in (("plot", ""), ("plot", "-2"), ("recording", ""), ("recording", "-2")):
        (path,) = re.findall(rf"^{word} +(.*{word}{number}\.\w+)$", section, re.M)
        assert Path(path).is_file()


def test_the_command_repeats_the_run_bit_for_bit(ended, tmp_path):
    words = shlex.split(ended.row("test_required[seed7-80]", "repeat"))
    done = subprocess.run(
        [sys.executable, "-m", *words, "--out", str(tmp_path / "again.parquet")],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT), "PATH": ""},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    again, frame = result.read(tmp_path / "again.parquet"), kept(ended, "test_required[seed7-80]")
    pandas.testing.assert_frame_equal(again, frame, check_exact=True)


def test_plot_and_recording_are_in_the_folder_that_was_named(ended):
    plot = Path(ended.row("test_required[seed7-80]", "plot"))
    assert plot.parts[-4:] == ("kept here", "test_it.py", "test_required-seed7-80", "plot.png")
    assert str(plot) in " ".join(ended.of("test_required[seed7-80]").split())
    pixels = imread(plot)
    assert pixels.shape[0] > 300 and pixels.shape[1] > 600 and pixels[:, :, :3].std() > 0.05


def test_what_a_test_looks_at_is_drawn_first(tmp_path):
    """Neither the system nor a requirement names it: it stands in the code of the test."""
    from navfmu import System
    from navfmu.testing import plot
    from navfmu.testing.flown import Flown
    from tests.components import systems

    experiment = System.load(systems.tracker()).experiment(stop=1.0)
    run = Flown(1, experiment, experiment.run(), "")
    columns = {name: run.frame[name].to_numpy() for name in run.frame}
    (first, *rest) = plot._pictures(["lag.y", "sensor.reading.valid"], [], columns)
    assert first.kind == "percentiles" and first.signal == "lag.y"
    assert [picture.needs() for picture in rest] == [["sensor.reading.valid"]]
    (everything,) = plot._pictures([], [], columns)
    assert everything.needs() == list(columns)


EXPRESSIONS = """
def test_truth(system):
    with system("tracker.ssp") as s:
        s.require("abs(lag.y - truth.y) <= 1 m", id="E", percent=90, when="truth.y > 0 m")
        s.run(20, seed=1)

def test_events(system):
    with system("tracker.ssp") as s:
        s.require(events="sensor.reading.length > 5 m", at_most=2, id="N")
        s.run(20, seed=1)

def test_between(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=9.8)
        s.run(20, seed=1, record_period=5)

def test_between_later(system):
    with system("tracker.ssp") as s:
        s.run(20, seed=1, record=["estimator.sigma"], record_period=5)
        s.require("lag.y", at_most=9.8)
"""


def test_requirements_on_expressions_events_and_times_that_are_not_recorded(folder):
    """All of them against the recording at every step that one of them leaves behind."""
    ended = folder.pytest(EXPRESSIONS)
    frame = kept(ended, "test_events")
    other = kept(ended, "test_truth")
    asked = other[other["truth.y"] > 0]
    inside = (asked["lag.y"] - asked["truth.y"]).abs() <= 1
    told = ended.of("test_truth")
    assert f"violated: inside for {np.floor(1000 * inside.mean()) / 10} % of the time, first violated at t = " in told
    assert f"at t = {inside.idxmin():g} s, main variant" in told and "worst" not in told
    above = frame["sensor.reading.length"] > 5
    rises = above & ~above.shift(fill_value=False)
    sentence = f"violated: {rises.sum()} times, first at t = {rises.idxmax():g} s, main variant"
    assert rises.sum() > 2 and sentence in ended.of("test_events")
    value = other["lag.y"]
    assert value[::50].max() < 9.8 < value.max()
    sentence = (
        f"first violated at t = {(value > 9.8).idxmax():g} s, worst {value.max():.4g} m at t = {value.idxmax():g} s"
    )
    for test in ("test_between", "test_between_later"):
        assert sentence in ended.of(test)


def test_nothing_is_kept_of_tests_that_pass_or_are_expected_to_fail(folder):
    ended = folder.pytest(
        """
        import pytest

        def test_good(system):
            with system("tracker.ssp") as s:
                assert len(s.run(1)) == 11

        @pytest.mark.xfail
        def test_expected(system):
            with system("tracker.ssp") as s:
                r = s.run(1)
            assert r["lag.y"].max() > 1000
        """,
        "--navfmu-artifacts=kept",
    )
    assert ended.code == 0 and not (folder.path / "kept").exists()


def test_by_default_it_is_in_the_temporary_folder_of_pytest(folder):
    ended = folder.pytest(
        """
        def test_bad(system):
            with system("tracker.ssp") as s:
                s.run(1, seed=2)
            assert False
        """
    )
    plot = Path(ended.row("test_bad", "plot"))
    assert plot == folder.path / "temporary" / "navfmu" / "test_it.py" / "test_bad" / "plot.png" and plot.is_file()


def test_a_folder_that_cannot_be_written_hides_nothing(folder):
    (folder.path / "kept" / "test_it.py").mkdir(parents=True)
    (folder.path / "kept" / "test_it.py" / "test_bad").write_text("a file where a folder should be")
    ended = folder.pytest(
        """
        def test_bad(system):
            with system("tracker.ssp") as s:
                s.require("lag.y", at_most=0.5)
                s.run(5, seed=2)
        """,
        "--navfmu-artifacts=kept",
    )
    assert ended.counts == {"failed": 1} and "INTERNALERROR" not in ended.out
    assert "requirement (lag.y <= 0.5 m always) violated" in ended.of("test_bad")
    assert "cannot be written" in ended.row("test_bad", "not kept")


def test_a_file_in_place_of_the_folder_is_a_sentence(folder):
    (folder.path / "taken").write_text("")
    ended = folder.pytest("def test_nothing():\n    pass\n", "--navfmu-artifacts", "taken")
    assert ended.code == 4 and "--navfmu-artifacts 'taken': expected a folder" in ended.out


def test_junit_has_the_sentence_and_the_command(folder):
    folder.pytest(
        """
        def test_bad(system):
            with system("tracker.ssp") as s:
                s.require("lag.y", at_most=0.5, id="T-9")
                s.run(5, seed=2)
        """,
        "--junitxml=it.xml",
    )
    text = (folder.path / "it.xml").read_text()
    assert "requirement T-9 (lag.y &lt;= 0.5 m always) violated" in text and "repeat     navfmu run" in text


def test_many_runs_of_one_test_do_not_fill_the_memory(folder):
    ended = folder.pytest(
        """
        def test_bad(system):
            for seed in range(1, 8):
                with system("tracker.ssp") as s:
                    s.run(1, seed=seed)
            assert False
        """
    )
    section = ended.of("test_bad").split(" navfmu -")[1]
    assert "The last 3 of 7 runs:" in section
    assert [int(seed) for seed in re.findall(r"variant, seed (\d)", section)] == [5, 6, 7]


def test_workers_of_xdist_tell_the_same(folder):
    text = """
        import pytest

        @pytest.mark.seeds("1-6")
        def test_bad(system):
            with system("tracker.ssp") as s:
                s.require("lag.y", at_most=0.5, id="T-9")
                s.run(5)
        """
    plain = folder.pytest(text, "--navfmu-artifacts=alone")
    ended = folder.pytest(text, "--navfmu-artifacts=together", "-p", "xdist", "-n", "2")
    assert ended.counts["failed"] == plain.counts["failed"] == 6
    plots = set()
    for seed in range(1, 7):
        test = f"test_bad[seed{seed}]"
        assert ended.row(test, "repeat") == plain.row(test, "repeat")
        told = ended.of(test).replace("together", "alone")
        assert re.findall(r"^E .*", told, re.M) == re.findall(r"^E .*", plain.of(test), re.M)
        plots.add(ended.row(test, "plot"))
        pandas.testing.assert_frame_equal(kept(ended, test), kept(plain, test), check_exact=True)
    assert len(plots) == 6 and all(Path(plot).is_file() for plot in plots)


def test_an_fmu_that_crashes_loses_one_test_with_workers(folder):
    ended = folder.pytest(
        """
        import pytest

        @pytest.mark.parametrize("status", [0, 10, 0, 0])
        def test_it(system, status):
            with system("probe.fmu", step=0.1, parameters={"probe.fail_status": status, "probe.fail_at": 0.5}) as s:
                s.run(1)
        """,
        *("-p", "xdist", "-n", "2"),
    )
    assert ended.counts == {"failed": 1, "passed": 3}, ended.out
