"""The tutorial does what it says, in a folder that has nothing but its files."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu

from navfmu.export import trace

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "tutorial_component.md").read_text()
FILES = {m[1]: m[2] for m in re.finditer(r"```python\n# (\w+\.py)\n(.*?)```", TEXT, re.S)}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Write the tutorial's files into a new folder; return a function that runs Python there."""
    folder = tmp_path_factory.mktemp("tutorial")
    for name, text in FILES.items():
        (folder / name).write_text(text)

    def python(*arguments):
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return folder, done.stdout

    return python


def test_the_component_runs_with_floats(run):
    _, output = run("try_it.py")
    assert re.fullmatch(r"20[0-9]\.\d{3} m, number 20, measured at 0\.80 s\n", output), output


def test_it_builds_and_flies_from_another_folder(run):
    folder, output = run("build.py")
    assert output.split() == ["dist/radio_altimeter.fmu", "dist/python/radio_altimeter.fmu"]
    for path in output.split():
        assert validate_fmu(str(folder / path)) == []
    _, output = run("fly.py")
    height, count = re.search(r"([\d.]+) m after (\d+) measurements\n", output).groups()
    assert int(count) == 100
    assert 175 < float(height) < 190


def test_the_table_traces(run):
    _, output = run(
        "-c", "import ground; from navfmu.export.lower import lower; print(len(lower(ground.Ground).tables))"
    )
    assert output == "1\n"


def test_every_function_that_the_tutorial_lists_is_traced():
    listed = re.search(r"and\n\n((?:> .*\n)+)", TEXT)[1].replace("> ", " ").split()
    assert len(listed) > 90
    for name in listed:
        function = np
        for part in name.split("."):
            function = getattr(function, part)
        known = function in trace.RULES or function in trace.STRUCTURAL or function in trace.FUNCTIONS
        assert known or name in ("array", "full"), name
