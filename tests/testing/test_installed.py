"""The plugin as pytest finds it: by the entry point, without a word of the user."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib

import pytest

from tests.testing.inner import ROOT

TEST = """
def test_it(system):
    with system("tracker.ssp") as s:
        assert len(s.run(1)) == 11
"""


@pytest.fixture
def installed(folder):
    """A folder beside which the entry points of pyproject.toml are installed; returns what runs pytest there."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    about = folder.path.parent / "site" / "navfmu-0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: navfmu\nVersion: 0\n")
    lines = [f"{name} = {value}" for name, value in project["entry-points"]["pytest11"].items()]
    (about / "entry_points.txt").write_text("[pytest11]\n" + "\n".join(lines) + "\n")
    (folder.path / "test_it.py").write_text(TEST)
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")}
    environment["PYTHONPATH"] = os.pathsep.join([str(about.parent), str(ROOT)])

    def call(*options):
        return subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *options],
            cwd=folder.path,
            env=environment,
            capture_output=True,
            text=True,
        )

    return call


def test_it_is_there(installed):
    done = installed()
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr


def test_it_can_be_left_out(installed):
    done = installed("-p", "no:navfmu")
    assert done.returncode == 1 and "fixture 'system' not found" in done.stdout, done.stdout + done.stderr
