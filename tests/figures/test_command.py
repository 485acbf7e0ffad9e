"""``navfmu figures`` with rows that are made: verdicts, failures, what is kept, Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time

import pytest

from navfmu.figures import Task
from navfmu.figures.comparison import AGREES
from navfmu.figures.row import Row
from tests import built
from tests.figures.made import GOOD, ROOT, collection, command, environment, navfmu


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """All rows, done with one and with three jobs."""
    folder = collection(tmp_path_factory.mktemp("figures"), m16="return Found([], b'', '')  # imvu")
    return folder, [navfmu(folder, "made", "--jobs", jobs, "--out", f"out {jobs}") for jobs in (1, 3)]


def answers(folder):
    return {row["row"]: row for row in json.loads((folder / "figures.json").read_text())["rows"]}


def test_each_row_has_its_verdict_and_none_ends_another(done):
    """In the order of their numbers. Wrong: M10 before M2; a process that dies and takes the others along."""
    folder, (one, _) = done
    found = answers(folder / "out 1")
    verdicts = {name: row["verdict"] for name, row in found.items()}
    assert list(verdicts) == ["M2", "M10", "M11", "M12", "M13", "M14", "M15", "M16"]
    assert list(verdicts.values()) == ["agrees", "differs, explained", "DIFFERS", *["FAILED"] * 5]
    assert one.returncode == 1, one.stderr
    said = " ".join(one.stdout.split())
    assert "1 of 3 figures agree; 1 differs for a reason that is known; 1 DIFFERS, nobody knows why" in said
    assert "M12, M13, M14, M15, M16 FAILED (seed 1)" in said


def test_a_row_that_failed_says_why(done):
    found = answers(done[0] / "out 1")
    line = 1 + (done[0] / "navfmu_figures" / "made" / "m12.py").read_text().split("\n").index("    return [][1]")
    assert found["M12"]["error"] == f"m12.py, line {line}: IndexError: list index out of range"
    assert found["M13"]["error"] == "the process of the row crashed (SIGKILL)"
    assert found["M14"]["error"] == "there is no such orbit"
    assert "uses 'imu' and does not declare it (declared: nothing)" in found["M15"]["error"]
    assert "'imvu.fmu' is not shipped with navfmu" in found["M16"]["error"]
    assert "Traceback" not in done[1][0].stdout + done[1][0].stderr


def test_same_seed_same_table_for_any_number_of_jobs(done):
    folder, _ = done
    for name in ("figures.json", "report.html", "rows/M2.json", "rows/M10.png"):
        assert (folder / "out 1" / name).read_bytes() == (folder / "out 3" / name).read_bytes(), name


def test_the_report_has_claim_reason_and_picture(done):
    page = (done[0] / "out 1" / "report.html").read_text(encoding="utf-8")
    assert "A book that is made." in page and page.count("data:image/png") == 3
    assert "Agrees if 2 to 4: it has no more digits" in page
    assert "the area is another (explained: 5 to 7)" in page
    assert "FAILED: there is no such orbit" in page


def test_what_is_kept_is_of_this_seed_and_these_sources(tmp_path):
    """Wrong: a key without the seed, or without the row's own file, or an answer whose picture is another."""
    folder = collection(tmp_path, {"m2": GOOD, "m3": GOOD})
    assert navfmu(folder, "made").returncode == 0
    out = folder / "results" / "figures-made"
    again = navfmu(folder, "made")
    assert "2 of 2 rows were there before" in again.stdout
    (out / "rows" / "M3.png").write_bytes(b"another")
    assert "1 of 2 rows were there before" in navfmu(folder, "made").stdout
    (out / "rows" / "M3.json").write_text("{")
    assert "1 of 2 rows were there before" in navfmu(folder, "made").stdout
    other = navfmu(folder, "made", "--seed", 7)
    assert "before" not in other.stdout and answers(out)["M2"]["comparisons"][0]["found"] == 2.7
    collection(folder, {"m2": GOOD, "m3": GOOD.replace("2.0", "3.0")})
    assert "before" not in navfmu(folder, "made", "--seed", 7).stdout
    assert answers(out)["M3"]["comparisons"][0]["found"] == 3.7


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_what_was_finished_before_ctrl_c_is_there_afterwards(tmp_path):
    """And the process of a row has ended with it: it would make a file."""
    wait = "open('begun', 'w').close(); time.sleep(4); open('late', 'w').close()"
    folder = collection(tmp_path, {"m2": GOOD, "m3": wait})
    words = command(folder, "made", "--jobs", 1)
    running = subprocess.Popen(words, cwd=folder, env=environment(folder), stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 60
    while not (folder / "begun").exists() and time.monotonic() < end:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    assert running.wait(30) == 130 and running.stderr.read() == "navfmu: interrupted\n"
    time.sleep(4.5)
    assert not (folder / "late").exists()
    assert (folder / "results" / "figures-made" / "rows" / "M2.json").is_file()


def test_a_list_needs_nothing_but_the_rows(tmp_path):
    out = navfmu(collection(tmp_path), "made", "--list")
    assert out.returncode == 0 and "m13 is so" in out.stdout and "page 7" in out.stdout
    assert not (tmp_path / "results").exists()
    assert "T13" in navfmu(tmp_path, "--list").stdout


WRONG = {
    "nothing": ([], "which collection of figures? (there are made, thesis"),
    "collection": (["mad"], "there is no collection of figures 'mad'; did you mean 'made'? (there are made, thesis)"),
    "row": (["made", "--only", "M2,M20"], "'made' has no row 'M20'; did you mean 'M2'? (it has: M2, M10,"),
    "small letters": (["made", "--only", "m13"], "'made' has no row 'm13'; did you mean 'M13'?"),
    "no names": (["made", "--only", ","], "'made' has no row '' (it has: M2,"),
    "a row to list": (["made", "--list", "--only", "M20"], "'made' has no row 'M20'; did you mean 'M2'?"),
    "a file": (["made", "--out", "file"], "file: cannot be written"),
    "another's folder": (["made", "--out", "swept"], "holds the results of a sweep, where the results of figures"),
    "in the way": (["made", "--out", "full"], "report.html: is a folder, where a file is to be written"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_a_sentence_before_anything_is_done(name, tmp_path):
    words, sentence = WRONG[name]
    (tmp_path / "file").write_text("")
    (tmp_path / "swept").mkdir()
    (tmp_path / "swept" / "sweep.json").write_text("{}")
    (tmp_path / "full" / "report.html").mkdir(parents=True)
    said = navfmu(collection(tmp_path), *words)
    assert said.returncode == 2 and said.stdout == ""
    assert sentence in said.stderr and said.stderr.count("\n") == 1


EMPTY = 'from navfmu.figures import row\n@row("a", "b")\n'
BROKEN = {
    "cannot be imported": (
        "import nothing_of_this_name\n",
        "navfmu_figures.made.m2: cannot be imported: ModuleNotFound",
    ),
    "two of one name": ('from navfmu.figures import row\n@row("a", "b")\ndef m3(task): ...\n', "has two rows 'M3'"),
    "no name of a row": (
        'from navfmu.figures import row\n@row("a", "b")\ndef _3(task): ...\n',
        "'_3' is no name of a row",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_collection_that_is_broken_is_a_sentence(name, tmp_path):
    text, sentence = BROKEN[name]
    folder = collection(tmp_path, {"m3": GOOD})
    (folder / "navfmu_figures" / "made" / "m2.py").write_text(text)
    said = navfmu(folder, "made")
    assert said.returncode == 2 and sentence in said.stderr and "Traceback" not in said.stderr


def test_a_row_of_no_comparison_has_found_nothing(tmp_path):
    folder = collection(tmp_path, {"m2": 'return Found([], drawn(), "nothing")'})
    assert navfmu(folder, "made").returncode == 1
    assert "nothing to compare" in answers(folder / "results" / "figures-made")["M2"]["error"]


def test_rows_of_another_file_are_not_taken_twice(tmp_path):
    """Wrong: whatever is a row in a module, also one that it has imported."""
    folder = collection(tmp_path, {"m2": GOOD})
    (folder / "navfmu_figures" / "made" / "both.py").write_text("from navfmu_figures.made.m2 import m2\n")
    assert navfmu(folder, "made").returncode == 0
    assert list(answers(folder / "results" / "figures-made")) == ["M2"]


def test_the_row_of_the_page_agrees(tmp_path, tmp_path_factory):
    """To the letter, with the built FMU. Wrong: a name that is defined nowhere, a tolerance that chance misses."""
    page = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
    names = {"__name__": "navfmu_figures.book.f3"}
    exec(page.partition("```python\n")[2].partition("```")[0], names)
    (row,) = (one for one in names.values() if isinstance(one, Row))
    for seed in (1, 2):
        found = row.find(Task(seed, tmp_path, {name: built.fmu(name, tmp_path_factory) for name in row.fmus}))
        assert [one.verdict for one in found.comparisons] == [AGREES]
