"""The examples run as they stand."""

import os
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from system_ssp.backup_navigator.system import FMUS, source
from tests import built

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A folder with the examples and, as in a checkout, the built FMUs and the system in dist/."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    fmus = built.folder(tmp_path_factory)
    source(fmus).pack(fmus / "backup_navigator.ssp")
    (folder / "dist").symlink_to(fmus)
    (folder / "examples").symlink_to(ROOT / "examples")
    return folder


def call(folder, *arguments, **variables):
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
    return subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def test_a_single_fmu_runs_in_another_host(checkout):
    done = call(checkout, "examples/single_fmu.py")
    assert done.returncode == 0, done.stderr
    rows = [
        tuple(map(float, re.findall(r"\d+\.\d+", line))) for line in done.stdout.splitlines() if line.startswith("t =")
    ]
    assert [time for time, *_ in rows] == [15.0 * k for k in range(1, 9)]  # Fig 2.10: one range every 15 s
    for (_, first, second), (_, *after) in pairwise(rows):
        assert (first == after[0]) != (second == after[1])  # the stations take turns


def test_the_integration_test_passes(checkout):
    text = (ROOT / "examples" / "test_outage.py").read_text()
    local = text.replace('"backup_navigator"', repr(str(checkout / "dist" / "backup_navigator.ssp")))
    (checkout / "test_outage.py").write_text(local)
    plugins = "-p", "navfmu.testing.plugin", "-p", "no:cacheprovider"
    done = call(checkout, "-m", "pytest", "-q", *plugins, "test_outage.py", PYTEST_DISABLE_PLUGIN_AUTOLOAD="1")
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout


def test_the_campaign_gives_verdicts(checkout):
    text = (ROOT / "examples" / "campaign.toml").read_text()
    local = text.replace('"backup_navigator"', f'"{checkout / "dist" / "backup_navigator.ssp"}"')
    (checkout / "campaign.toml").write_text(local.replace('seeds = "1-2"', 'seeds = "1"'))
    done = call(checkout, "-m", "navfmu", "campaign", "campaign.toml", "--out", "results")
    assert done.returncode == 0, done.stderr
    assert (checkout / "results" / "report.html").is_file() and "NAV-1" in done.stdout
