"""Campaigns that can neither lie nor die: FMUs that crash, exit, hang or give no numbers, damaged files, kills."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas
import pytest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.crew import Crew
from navfmu.campaign.flight import fail
from navfmu.campaign.runs import Answer, runs_of
from navfmu.engine import compiled
from navfmu.errors import NavfmuError
from navfmu.system.result import read
from tests.campaign.test_campaign import contents
from tests.campaign.wreck import ABORT, CLOSE, ERROR, EXIT, FATAL, FORK, HANG, READ, SEGFAULT, wreck
from tests.components import systems

WAYS = {"crash": SEGFAULT, "exit": EXIT, "abort": ABORT, "hang": HANG, "refuse": ERROR}
HEAD = """
system = "probe.fmu"
stop = 2.0
step = 0.1

[[requirement]]
id = "R-1"
signal = "probe.y"
at_most = 2.0
"""


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "navfmu", "campaign", *map(str, arguments)]


@pytest.fixture(scope="module")
def wrecked(tmp_path_factory) -> tuple[Path, subprocess.CompletedProcess]:
    """The folder of a campaign with every kind of wreck, and what its command said."""
    folder = tmp_path_factory.mktemp("wrecks")
    wreck(folder)
    text = HEAD + '\n[parameters]\n"probe.start" = 1.0\n'
    text += '\n[[case]]\nname = "good"\n\n[[case]]\nname = "nan"\nparameters = { "probe.tau" = 0.0 }\n'
    for name, way in WAYS.items():
        parameters = f'{{ "probe.fail_status" = {way}, "probe.fail_at" = 0.75 }}'
        text += f'\n[[case]]\nname = "{name}"\nparameters = {parameters}\n'
    (folder / "wrecks.toml").write_text(text)
    done = subprocess.run(
        command("wrecks.toml", "--timeout", 5, "--strict", "--out", "out"), cwd=folder, capture_output=True, text=True
    )
    return folder, done


def test_every_wreck_is_a_row_and_the_campaign_ends_with_a_report(wrecked):
    folder, done = wrecked
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
    rows = pandas.read_csv(folder / "out" / "runs.csv", keep_default_na=False).set_index("case")
    assert sorted(rows.index) == sorted(["good", "nan", *WAYS])
    assert rows.error["good"] == "" and rows.not_finite["good"] == "" and rows.held["good"] == "True"
    assert rows.not_finite["nan"] == "probe.y" and rows.held["nan"] == "False"
    assert rows.notes["nan"] == ""  # said once
    assert "SIGSEGV" in rows.error["crash"] and "SIGABRT" in rows.error["abort"]
    assert "exit code 0" in rows.error["exit"] and "timeout of 5 s" in rows.error["hang"]
    for name in WAYS:
        assert "component 'probe'" in rows.error[name] and "fmi2DoStep" in rows.error[name]
        assert "at t = 0.7 s" in rows.error[name] or "at t = 0.8 s" in rows.error[name], rows.error[name]
    assert (folder / "out" / "report.html").is_file() and "SIGSEGV" in (folder / "out" / "report.html").read_text()


def test_what_was_recorded_before_the_wreck_is_kept(wrecked):
    folder, _ = wrecked
    rows = pandas.read_csv(folder / "out" / "runs.csv").set_index("case")
    good = read(folder / "out" / rows.recording["good"])
    assert 0.0 < good["probe.y"].iloc[-1] < good["probe.y"].iloc[0]
    partial = {read(file).attrs["provenance"]["error"]: read(file) for file in (folder / "out").rglob("*.partial.*")}
    assert len(partial) == len(WAYS)
    for error, frame in partial.items():
        assert len(frame) in (8, 9), error  # t = 0 ... 0.7 or 0.8 s
        assert frame["probe.y"].equals(good["probe.y"].iloc[: len(frame)])


def test_what_failed_stays_so_until_it_is_tried_again(wrecked, tmp_path):
    folder = Path(shutil.copytree(wrecked[0], tmp_path / "copy"))
    campaign = load_campaign(folder / "wrecks.toml")
    before = {file.name: file.stat().st_mtime_ns for file in (folder / "out" / "runs").glob("[!.]*")}
    run_campaign(campaign, folder / "out", timeout=5)
    assert {file.name: file.stat().st_mtime_ns for file in (folder / "out" / "runs").glob("[!.]*")} == before
    run_campaign(campaign, folder / "out", timeout=5, retry_failed=True)
    after = {file.name: file.stat().st_mtime_ns for file in (folder / "out" / "runs").glob("[!.]*")}
    assert after.keys() == before.keys() and sum(after[name] != before[name] for name in after) == 2 * len(WAYS)


def test_a_process_in_which_an_fmu_failed_for_good_flies_no_other_run(tmp_path):
    wreck(tmp_path)
    text = HEAD
    for name, status in (("good", 0), ("error", ERROR), ("fatal", FATAL), ("after", 0)):
        text += (
            f'\n[[case]]\nname = "{name}"\nparameters = {{ "probe.fail_status" = {status}, "probe.fail_at" = 0.75 }}\n'
        )
    (tmp_path / "campaign.toml").write_text(text)
    left = {}
    with Crew() as crew:
        for run in runs_of(load_campaign(tmp_path / "campaign.toml")):
            crew.fly(run, tmp_path, lambda *_: None)
            left[run.case.name] = crew._idle.qsize()
            assert run.answer(tmp_path).is_file()
    assert left == {"good": 1, "error": 1, "fatal": 0, "after": 1}


def test_processes_and_threads_write_the_same_bytes(tmp_path):
    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nseeds = "1-2"\nstop = 5.0\n')
    for workers in ("process", "thread"):
        run_campaign(load_campaign(file), tmp_path / workers, workers=workers)
    assert contents(tmp_path / "process") == contents(tmp_path / "thread")


def damage_empty(file: Path, _: Path) -> None:
    file.write_bytes(b"")


def damage_truncated(file: Path, _: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def damage_flipped(file: Path, _: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 0x10
    file.write_bytes(bytes(content))


def damage_fewer_rows(file: Path, _: Path) -> None:
    from pyarrow import parquet

    parquet.write_table(parquet.read_table(file).slice(0, 20), file)


def damage_another_run(file: Path, other: Path) -> None:
    shutil.copy(other, file)


@pytest.mark.parametrize(
    "damage", [damage_empty, damage_truncated, damage_flipped, damage_fewer_rows, damage_another_run]
)
def test_a_damaged_recording_is_recognised_told_and_flown_again(damage, tmp_path):
    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nseeds = "1-3"\nstop = 5.0\nrecord = ["estimator"]\n')
    campaign = load_campaign(file)
    whole = contents(run_campaign(campaign, tmp_path / "out", workers="thread").folder)
    first, second, _ = (run.recording(tmp_path / "out") for run in runs_of(campaign))
    damage(first, second)
    outcome = run_campaign(campaign, tmp_path / "out", workers="thread")
    (said,) = outcome.mended
    assert first.name in said
    assert contents(tmp_path / "out") == whole


@pytest.mark.parametrize("kind", ["recording", "answer"])
def test_no_single_flipped_bit_is_taken_for_a_result(kind, tmp_path):
    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nstop = 1.0\nrecord = ["estimator", "sensor"]\n')
    campaign = load_campaign(file)
    run_campaign(campaign, tmp_path / "out", workers="thread")
    (run,) = runs_of(campaign)
    kept = getattr(run, kind)(tmp_path / "out")
    content = kept.read_bytes()
    assert Answer.read(run, tmp_path / "out").error is None
    for place in random.Random(1).sample(range(8 * len(content)), 300):
        changed = bytearray(content)
        changed[place // 8] ^= 1 << place % 8
        kept.write_bytes(bytes(changed))
        with pytest.raises(NavfmuError, match="is damaged"):
            Answer.read(run, tmp_path / "out")


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_thirty_kills_at_random_moments_leave_the_same_results(tmp_path):
    text = f'system = "{systems.tracker()}"\nvariants = ["main", "slow"]\nseeds = "1-12"\nstep = 0.001\nstop = 100.0\n'
    text += '[[requirement]]\nid = "R"\nsignal = "estimator.solution.length"\nat_most = 8.0\n'
    (tmp_path / "campaign.toml").write_text(text)
    moments = random.Random(7)
    kills = 0
    for _ in range(30):
        process = subprocess.Popen(
            command("campaign.toml", "--out", "killed"), cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(moments.uniform(0.3, 3.0))
        kills += process.poll() is None
        process.kill()
        process.communicate()
    assert kills > 10
    for folder in ("killed", "undisturbed"):
        subprocess.run(command("campaign.toml", "--out", folder), cwd=tmp_path, check=True, capture_output=True)
    assert contents(tmp_path / "killed") == contents(tmp_path / "undisturbed")
    assert [file.name for file in (tmp_path / "killed").rglob(".*")] == [".lock"]


def test_two_campaigns_do_not_write_into_one_folder(tmp_path):
    from filelock import FileLock

    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nstop = 1.0\n')
    (tmp_path / "out").mkdir()
    with FileLock(tmp_path / "out" / ".lock"), pytest.raises(NavfmuError, match="another campaign is writing into it"):
        run_campaign(load_campaign(file), tmp_path / "out")


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("workers", ["process", "thread"])
def test_ctrl_c_is_one_sentence_code_130_and_what_is_finished_is_kept(workers, tmp_path):
    text = f'system = "{systems.tracker()}"\nseeds = "1-400"\nstep = 0.001\nstop = 20.0\nrecord = ["lag"]\n'
    (tmp_path / "campaign.toml").write_text(text)
    process = subprocess.Popen(
        command("campaign.toml", "--out", "out", "--workers", workers, "--jobs", 1),
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    for _ in range(300):
        time.sleep(0.1)
        if len(list(tmp_path.glob("out/runs/*.json"))) >= 2:
            break
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=30)
    assert process.returncode == 130 and out == ""
    (sentence,) = [line for line in errors.splitlines() if not line.startswith("campaign: ")]
    assert sentence.startswith("navfmu: interrupted: ") and "the same command continues" in sentence
    # a run is finished when its answer is there; a recording alone is of one that was interrupted
    kept = len(list(tmp_path.glob("out/runs/*.json")))
    assert kept >= 2 and f"interrupted: {kept} of 400" in sentence


def test_a_hanging_fmu_can_be_interrupted(tmp_path):
    wreck(tmp_path)
    parameters = '[parameters]\n"probe.fail_status" = 13\n"probe.fail_at" = 0.5\n'
    (tmp_path / "hang.toml").write_text(HEAD.replace("[[requirement]]", parameters + "\n[[requirement]]"))
    for words in (command("hang.toml", "--out", "out"),
                  [sys.executable, "-m", "navfmu", "run", "probe.fmu", "--stop", "2", "--step", "0.1",
                   "--set", "probe.fail_status=13", "--set", "probe.fail_at=0.5"]):  # fmt: skip
        process = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(4.0)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
        assert process.returncode == 130 and "Traceback" not in errors
        assert "interrupted" in errors.splitlines()[-1]


def test_a_worker_goes_when_its_campaign_is_gone(tmp_path):
    import psutil

    wreck(tmp_path)
    parameters = '[parameters]\n"probe.fail_status" = 13\n"probe.fail_at" = 0.5\n'
    (tmp_path / "hang.toml").write_text(HEAD.replace("[[requirement]]", parameters + "\n[[requirement]]"))
    process = subprocess.Popen(command("hang.toml", "--out", "out"), cwd=tmp_path, stderr=subprocess.DEVNULL)
    for _ in range(100):
        time.sleep(0.1)
        workers = psutil.Process(process.pid).children(recursive=True)
        if workers:
            break
    process.kill()
    process.wait()
    assert workers and not psutil.wait_procs(workers, timeout=10)[1]


def test_failures_are_told_as_data(wrecked):
    about = [json.loads(file.read_text()) for file in (wrecked[0] / "out" / "runs").glob("*.json")]
    failed = {a["case"]: a["place"] for a in about if a["error"] is not None}
    assert failed.keys() == set(WAYS)
    for place in failed.values():
        assert (place["component"], place["call"]) == ("probe", "fmi2DoStep") and 0.7 <= place["time"] <= 0.8


def test_the_last_words_of_a_run_are_its_own(tmp_path):
    """A worker that flies several runs keeps one log; a crash once quoted what an earlier run had printed."""
    from navfmu.campaign.crew import Worker

    worker = Worker(tmp_path)
    try:
        with open(tmp_path / "log", "ab") as log:
            log.write(b"of an earlier run\n")
        worker._said = (tmp_path / "log").stat().st_size
        assert worker._last_words() == ""
        with open(tmp_path / "log", "ab") as log:
            log.write(b"assertion failed\n")
        assert worker._last_words() == "assertion failed"
    finally:
        worker.end()


def test_a_case_that_differs_by_parameters_says_so_in_the_report(wrecked):
    text = (wrecked[0] / "out" / "report.html").read_text()
    assert "parameters: probe.tau = 0.0" in text


@pytest.mark.skipif(os.name == "nt", reason="processes")
def test_an_fmu_that_meddles_with_its_process_meddles_with_its_own_run_only(tmp_path):
    """Reads what is not its own, cuts the line to the campaign, leaves a process behind that holds it."""
    import psutil

    wreck(tmp_path)
    text = HEAD.replace("probe.fmu", "probe.fmu") + '[[case]]\nname = "good"\n'
    for name, way in (("read", READ), ("close", CLOSE), ("fork", FORK)):
        parameters = f'{{ "probe.fail_status" = {way}, "probe.fail_at" = 0.75 }}'
        text += f'\n[[case]]\nname = "{name}"\nparameters = {parameters}\n'
    (tmp_path / "meddlers.toml").write_text(text)
    began = time.monotonic()
    outcome = run_campaign(load_campaign(tmp_path / "meddlers.toml"), tmp_path / "out", jobs=1)
    assert time.monotonic() - began < 60.0
    errors = {judged.run.case.name: judged.error for judged in outcome.runs}
    assert errors["good"] is None and errors["read"] is None
    assert "cut the line to its campaign" in errors["close"] and "SIGSEGV" in errors["fork"]
    left = [p for p in psutil.process_iter(["cmdline"]) if "navfmu.campaign.worker" in (p.info["cmdline"] or [])]
    assert not [p for p in left if p.parent() is None or (p.parent().pid == 1 and time.time() - p.create_time() < 60)]


def test_what_an_earlier_try_has_left_goes_when_a_later_one_has_ended(tmp_path):
    """KEY.partial.parquet once stayed beside KEY.parquet."""
    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nseeds = "1"\nstop = 1.0\n')
    campaign = load_campaign(file)
    (run,) = runs_of(campaign)
    fail(run, tmp_path / "out", "the run took too long", {}, compiled.run(run.experiment.plan()))
    there = tmp_path / "out" / "runs"
    assert {path.name for path in there.iterdir()} == {f"{run.key}.json", f"{run.key}.partial.parquet"}
    run_campaign(campaign, tmp_path / "out", retry_failed=True, workers="thread")
    assert {path.name for path in there.iterdir()} == {f"{run.key}.json", f"{run.key}.parquet"}
    fail(run, tmp_path / "out", "the run could not begin", {}, None)
    assert {path.name for path in there.iterdir()} == {f"{run.key}.json"}


SLOW = """
import time
from navfmu.campaign import flight
from navfmu.system.experiment import Experiment

def slowly(function):
    def call(*arguments, **options):
        time.sleep(1.5)
        return function(*arguments, **options)
    return call

flight.write = slowly(flight.write)
Experiment.plan = slowly(Experiment.plan)
"""


def test_a_timeout_is_that_of_the_fmus_and_not_of_loading_and_writing(tmp_path, monkeypatch):
    """A run that was complete once "took longer than the timeout, in no component, at its stop time"."""
    wreck(tmp_path)
    (tmp_path / "slow").mkdir()
    (tmp_path / "slow" / "sitecustomize.py").write_text(SLOW)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "slow"))  # of the worker
    cases = '[[case]]\nname = "good"\n\n[[case]]\nname = "hang"\n'
    cases += f'parameters = {{ "probe.fail_status" = {HANG}, "probe.fail_at" = 0.75 }}\n'
    (tmp_path / "c.toml").write_text(HEAD + cases)
    outcome = run_campaign(load_campaign(tmp_path / "c.toml"), tmp_path / "out", jobs=1, timeout=1.0)
    good, hang = (judged.error for judged in outcome.runs)
    assert good is None
    assert hang.startswith("component 'probe' in fmi2DoStep at t = 0.") and "longer than the timeout of 1 s" in hang


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="a file is made with a hole")
def test_a_full_folder_for_temporary_files_is_a_sentence(tmp_path, monkeypatch):
    file = tmp_path / "campaign.toml"
    file.write_text(f'system = "{systems.tracker()}"\nseeds = "1"\nstop = 1.0\n')

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    for name in ("mkdtemp", "TemporaryDirectory"):
        monkeypatch.setattr(f"navfmu.campaign.crew.tempfile.{name}", full)
        with pytest.raises(NavfmuError, match=r"cannot be written: No space left on device; set TMPDIR to a folder"):
            run_campaign(load_campaign(file), tmp_path / "out")
