"""The wheel alone, in an empty environment: no repository, no exporter's tools, no compiler."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tools.wheel import PACKAGED

ROOT = Path(__file__).parents[2]
FLY = """
import sys
from importlib.util import find_spec
assert find_spec("ziglang") is None and find_spec("models") is None
import navfmu
assert "site-packages" in navfmu.__file__, navfmu.__file__
from navfmu import System
from navfmu.faults import Fault
lost = Fault("gps", "gps.jammed", "input", start=300.0)
run = System.load("backup_navigator", variant="scanning").run(stop=2100.0, step=0.01, seed=7, faults=[lost],
                                                              record=["evaluation.horizontal_error", "navigator.mode"])
assert run["navigator.mode"].iloc[-1] == 2
print("worst", run["evaluation.horizontal_error"].max())
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    out = tmp_path_factory.mktemp("wheel")
    subprocess.run([sys.executable, "-m", "tools.wheel", "--out", str(out)], check=True, cwd=ROOT, capture_output=True)
    (path,) = out.glob("navfmu-*.whl")
    return path


@pytest.fixture(scope="module")
def python(wheel, tmp_path_factory):
    """The interpreter of an environment with the wheel and its dependencies."""
    folder = tmp_path_factory.mktemp("empty")
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    python = folder / "bin" / "python"
    install(python, wheel)
    return python


def install(python, what):
    """Beside no path of packages that the tests are run with, which pip would take for installed."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    subprocess.run([str(python), "-m", "pip", "install", "--quiet", str(what)], check=True, env=environment)


def call(program, folder, *arguments):
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "NAVFMU_CACHE": str(folder / "cache")}
    return subprocess.run([str(program), *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def test_every_file_of_the_package_goes_into_the_wheel():
    tracked = subprocess.run(["git", "ls-files", "navfmu"], cwd=ROOT, capture_output=True, text=True)
    files = tracked.stdout.split() or [str(path) for path in (ROOT / "navfmu").rglob("*") if path.is_file()]
    endings = {Path(file).suffix.lstrip(".") for file in files} - {"pyc"}
    assert {"c", "j2"} <= endings <= {"py", *PACKAGED}


def test_one_wheel_serves_every_platform(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")
    names = zipfile.ZipFile(wheel).namelist()
    engines = [name for name in names if name.startswith("navfmu/engine/native/")]
    assert len(engines) == 5, engines
    with zipfile.ZipFile(wheel).open("navfmu/shipped/imu.fmu") as fmu:
        binaries = [name for name in zipfile.ZipFile(fmu).namelist() if name.startswith("binaries/")]
    assert {name.split("/")[1] for name in binaries} >= {"linux64", "win64", "darwin64", "aarch64-linux"}
    assert not any(name.startswith(("models", "fmus", "tests")) for name in names)


def test_the_wheel_is_installed_as_the_tutorial_says(wheel, python, tmp_path):
    (command,) = re.findall(r'^pip install "(dist/.*)"$', (ROOT / "docs" / "tutorial_component.md").read_text(), re.M)
    (tmp_path / "dist").symlink_to(wheel.parent)
    done = call(python, tmp_path, "-m", "pip", "install", "--dry-run", "--no-deps", command)
    assert done.returncode == 0 and "does not provide the extra" not in done.stderr, done.stderr


def test_the_flight_is_flown_from_the_wheel_alone(python, tmp_path):
    done = call(python, tmp_path, "-c", FLY)
    assert done.returncode == 0, done.stderr
    assert 50.0 < float(done.stdout.split()[1]) < 3000.0


def test_a_test_of_a_system_runs_from_the_wheel_alone(python, tmp_path):
    install(python, "pytest>=8")
    folder = tmp_path / "an empty folder"
    folder.mkdir()
    (folder / "test_outage.py").write_text(
        (ROOT / "examples" / "test_outage.py").read_text() + "    assert not HALF_MILE"
    )
    done = call(python, folder, "-m", "pytest", "-q", "test_outage.py", "--navfmu-artifacts", "kept")
    assert "1 failed" in done.stdout and "gps.jammed, from 300 s" in done.stdout, done.stdout + done.stderr
    (recording,) = (folder / "kept").rglob("recording.parquet")
    assert recording.with_name("plot.png").is_file()


def test_figures_are_found_again_from_the_wheel_alone(python, tmp_path):
    """A row that needs a built FMU, and the rows that are listed. Wrong: rows that stand in the checkout alone."""
    rows = sorted(path.stem.upper() for path in (ROOT / "navfmu_figures" / "thesis").glob("t[0-9]*.py"))
    listed = call(python.parent / "navfmu", tmp_path, "figures", "--list")
    assert set(rows) <= set(listed.stdout.split()), listed.stderr
    found = call(python.parent / "navfmu", tmp_path, "figures", "thesis", "--only", "T30", "--out", "figures")
    assert found.returncode == 0 and "3 of 3 figures agree" in found.stdout, found.stdout + found.stderr


def test_the_command_and_a_recorded_track_work_from_the_wheel_alone(python, tmp_path):
    listed = call(python.parent / "navfmu", tmp_path, "info", "backup_navigator")
    assert listed.returncode == 0 and "navigator" in listed.stdout, listed.stderr
    rows = [f"{t},{48 + 1.0e-4 * t * 5:.6f},11.0,{3000 + t}" for t in range(0, 600, 5)]
    (tmp_path / "flight.csv").write_text("\n".join(["time_s,latitude_deg,longitude_deg,altitude_ft", *rows]))
    made = call(python, tmp_path, "-m", "navfmu", "track", "flight.csv", "--out", "flight.fmu")
    assert made.returncode == 0 and (tmp_path / "flight.fmu").is_file(), made.stderr
    flown = call(python, tmp_path, "-m", "navfmu", "run", "flight.fmu", "--step", "0.1", "--out", "flight.parquet")
    assert flown.returncode == 0, flown.stderr
