"""The tutorial does what it says: every file and every command of it, in order, in a folder that has nothing else."""

import csv
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pandas
import pytest
from fmpy.validation import validate_fmu

from navfmu import __version__
from navfmu.export.declaration.bundle import TAKEN
from navfmu.export.declaration.layout import RESERVED
from navfmu.export.tracing import functions
from navfmu.export.tracing.rules import RULES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "tutorial_component.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", TEXT, re.S | re.M)
PYTEST = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "navfmu.testing.plugin"]
PROGRAMS = {"python": [], "navfmu": ["-m", "navfmu"], "pytest": PYTEST}
INSTALL = [line for kind, text in BLOCKS if not kind for line in text.splitlines() if line.startswith("pip ")]


class Told:
    """The folder after the last command, and what each command printed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.outputs: dict[str, str] = {}
        self.environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}

    def run(self, line: str) -> str:
        program, *arguments = shlex.split(line)
        command = [sys.executable, *PROGRAMS[program], *arguments]
        done = subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True)
        assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
        return done.stdout


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """Do all that the tutorial says, from top to bottom."""
    told = Told(tmp_path_factory.mktemp("tutorial"))
    for kind, text in BLOCKS:
        if kind:
            name, _, content = text.removeprefix("# ").partition("\n")
            (told.folder / name).write_text(content, encoding="utf-8")
        else:
            told.outputs |= {line: told.run(line) for line in text.splitlines() if line not in INSTALL}
    return told


def test_every_block_is_a_file_or_commands():
    assert len(BLOCKS) > 15
    for kind, text in BLOCKS:
        if kind:
            assert kind in ("python", "toml") and re.match(rf"# \w+\.{kind[:2]}", text), text
        else:
            assert all(line.split()[0] in (*PROGRAMS, "pip") for line in text.splitlines()), text


def test_every_file_is_run_or_used_by_one_that_is():
    files = [text.removeprefix("# ").partition("\n")[0] for kind, text in BLOCKS if kind]
    assert len(set(files)) == len(files)
    everything = "\n".join(text.partition("\n")[2] if kind else text for kind, text in BLOCKS)
    unused = [
        name for name in files if not re.search(rf"\b{re.escape(name)}\b|(from|import) {Path(name).stem}\b", everything)
    ]
    assert unused == ["ground.py"]  # an aside, traced below


def test_navfmu_is_installed_with_an_extra_that_exists():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert [shlex.split(line)[2:] for line in INSTALL] == [
        ["-e", ".[build]"],
        [f"dist/navfmu-{__version__}-py3-none-any.whl[build]"],  # installed in tests/wheel
    ]
    assert "build" in project["optional-dependencies"] and project["name"] == "navfmu"


def test_a_component_to_start_from_is_written_and_runs(told):
    assert told.outputs["python my_sensor.py"].startswith("sample 10: ")
    assert (told.folder / "dist" / "my_sensor.fmu").is_file()


def test_the_component_runs_with_floats(told):
    output = told.outputs["python try_it.py"]
    assert re.fullmatch(r"20[0-9]\.\d{3} m, number 20, measured at 0\.80 s\n", output), output


def test_it_builds_and_flies(told):
    paths = told.outputs["python build.py"].split()
    assert paths == ["dist/radio_altimeter.fmu", "dist/python/radio_altimeter.fmu"]
    for path in paths:
        assert validate_fmu(str(told.folder / path)) == []
    height, count = re.search(r"([\d.]+) m after (\d+) measurements\n", told.outputs["python fly.py"]).groups()
    assert int(count) == 100
    assert 175 < float(height) < 190
    assert "lag_time" in told.outputs["navfmu info dist/radio_altimeter.fmu"]


def test_the_system_runs_from_its_folder_alone(told):
    info = told.outputs["navfmu info approach"]
    assert "3 components" in info and "blinded" in info and "direct" in info
    flight = pandas.read_csv(told.folder / "blinded.csv", comment="#")
    shown = flight[next(name for name in flight if name.startswith("display.shown"))].astype(str).str.lower()
    assert shown.isin(["true", "1"])[len(flight) // 8]
    assert not shown.isin(["true", "1"])[(12 * len(flight)) // 40]
    (told.folder / "moved").mkdir()
    (told.folder / "approach").rename(told.folder / "moved" / "approach")
    (told.folder / "dist").rename(told.folder / "moved" / "built")
    try:
        told.run("navfmu run moved/approach --faults blinded --stop 1")
    finally:
        (told.folder / "moved" / "approach").rename(told.folder / "approach")
        (told.folder / "moved" / "built").rename(told.folder / "dist")


def test_the_campaign_finds_what_the_tutorial_says(told):
    with open(told.folder / "results" / "verdicts.csv", encoding="utf-8", newline="") as file:
        rows = {(row["requirement"], row["variant"], row["case"]): row for row in csv.DictReader(file)}
    assert {key for key, row in rows.items() if row["verdict"] != "holds"} == {("ALT-1", "main", "blinded")}
    assert "first violated at t = 15.04 s" in rows["ALT-1", "main", "blinded"]["seen"] and "at 15.04 s" in TEXT
    assert ("ALT-2", "main", "nominal") in rows and ("ALT-2", "main", "blinded") not in rows
    assert (told.folder / "results" / "report.html").is_file()


def test_its_test_passes(told):
    assert "3 passed" in told.outputs["pytest test_approach.py"]


def test_the_filter_follows_the_boat(told):
    error, sigma = map(
        float, re.search(r"([-\d.]+) m off, with a sigma of ([\d.]+) m", told.outputs["python watch.py"]).groups()
    )
    assert 1.0 < sigma < 10.0  # 50 m at first
    assert abs(error) < 4.0 * sigma


GROUND = """
import ground, numpy
from navfmu.export.interpreter import Interpreter
from navfmu.export.tracing.lower import lower
assert len(lower(ground.Ground).tables) == 2
run = Interpreter(ground.Ground)
run.set("place", [500.0, 0.0])
run.setup()
print(run.get("clearance"))
run.do_step(0.0, 30.0)
print(run.get("clearance"))
"""


def test_the_ground_lies_where_its_tables_say(told):
    """Half of the way between all four corners, at the start of the plan and half of the way to its second row."""
    (told.folder / "look.py").write_text(GROUND)
    ground = (120.0 + 310.0 + 95.0 + 150.0) / 4.0
    said = [float(line) for line in told.run("python look.py").split()]
    assert said == pytest.approx([520.0 - ground, 715.0 - ground], abs=1e-9)


def test_every_function_that_the_tutorial_lists_is_traced():
    listed = re.search(r"and\n\n((?:> .*\n)+)", TEXT)[1].replace("> ", " ").split()
    assert len(listed) > 90
    for name in listed:
        function = np
        for part in name.split("."):
            function = getattr(function, part)
        known = function in RULES or function in functions.STRUCTURAL or function in functions.FUNCTIONS
        assert known or name in ("array", "full"), name


def test_the_tutorial_names_all_names_that_are_taken():
    line = " ".join(TEXT.split()).partition("These names are taken in every component: ")[2]
    component, _, bundle = line.partition(". In a task")[0].partition("; in every bundle: ")
    assert component.replace("`", "").split(", ") == sorted(RESERVED)
    assert bundle.replace("`", "").split(", ") == sorted(TAKEN)
