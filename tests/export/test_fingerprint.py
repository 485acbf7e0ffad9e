"""The key of the cache of FMUs changes with every file of ours that a built FMU depends on."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "navfmu"
COMPONENT = '''
from navfmu.export import Component, Output, Parameter, every


class Small(Component):
    """Nothing but a clock."""

    y = Output("1", description="output")
    sample_period = Parameter("s", start=1.0, min=0.1, description="period")

    @every("sample_period")
    def step(self):
        self.y = self.y + 1
'''
ASK = "from navfmu.export.fingerprint import fingerprint; from small import Small; print(fingerprint(Small))"


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """The package and a component of somebody else, in a folder of their own."""
    folder = tmp_path_factory.mktemp("copied")
    shutil.copytree(PACKAGE, folder / "navfmu", ignore=shutil.ignore_patterns("__pycache__", "native", "shipped"))
    (folder / "small.py").write_text(COMPONENT)
    return folder


def fingerprint(folder):
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, "-c", ASK], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "file",
    [
        "navfmu/export/page/prose.py",
        "navfmu/export/runtime/instance.h",
        "navfmu/export/licenses/license.txt",
        "navfmu/export/page/templates/documentation.html.j2",
        "navfmu/report/template.py",
        "navfmu/files/archive.py",
        "navfmu/errors.py",
        "small.py",
    ],
)
def test_a_change_of_any_file_that_goes_into_an_fmu_builds_it_anew(copied, file):
    before = fingerprint(copied)
    assert fingerprint(copied) == before
    path = copied / file
    text = path.read_text(encoding="utf-8")
    path.write_text(text + "\n", encoding="utf-8")
    assert fingerprint(copied) != before
    path.write_text(text, encoding="utf-8")
    assert fingerprint(copied) == before
