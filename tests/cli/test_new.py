"""``navfmu new``: a component that builds and runs as written, and never over something else."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from click.testing import CliRunner
from fmpy.validation import validate_fmu

from navfmu.cli.main import main
from navfmu.cli.new import new
from navfmu.errors import NavfmuError

ROOT = Path(__file__).parents[2]


def python(folder, *arguments):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def test_it_builds_and_runs_as_written(tmp_path):
    made = python(tmp_path, "-m", "navfmu", "new", "radio_altimeter")
    assert made.returncode == 0 and "python radio_altimeter.py" in made.stdout, made.stderr
    tried = python(tmp_path, "radio_altimeter.py")
    assert tried.returncode == 0, tried.stderr
    first, path = tried.stdout.splitlines()
    assert first.startswith("sample 10: ") and path == str(Path("dist") / "radio_altimeter.fmu")
    fmu = str(tmp_path / path)
    assert validate_fmu(fmu) == []
    exact = {"noise_sigma": 0.0, "scale_factor_error": 0.5, "value": 100.0}
    outputs = ["measurement.value", "measurement.sequence"]
    values = {"stop_time": 1.0, "output_interval": 0.1, "output": outputs}
    assert fmpy.simulate_fmu(fmu, start_values=exact, **values)[-1].item()[1:] == (150.0, 10)
    assert fmpy.simulate_fmu(fmu, start_values={**exact, "blinded": True}, **values)[-1].item()[1:] == (0.0, 0)
    noisy = [fmpy.simulate_fmu(fmu, start_values={"seed": seed}, **values)[-1][1] for seed in (1, 2)]
    assert noisy[0] != noisy[1]
    flown = python(tmp_path, "-m", "navfmu", "run", path, "--stop", "1", "--step", "0.1")
    assert flown.returncode == 0, flown.stderr


def test_its_text_is_clean(tmp_path):
    new("gps_2", tmp_path)
    for check in (
        ["check", "--select", "E,F,B,UP", "--line-length", "120"],
        ["format", "--check", "--line-length", "120"],
    ):
        done = subprocess.run([sys.executable, "-m", "ruff", *check, "--isolated", str(tmp_path)], capture_output=True)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["radio_altimeter", "gps", "gps_2", "x", "a_b_c", "imu3"])
def test_the_fmu_has_the_name_that_was_asked_for(name, tmp_path):
    text = f"import importlib; from navfmu.export.discovery import components; print(*components({str(tmp_path)!r}))"
    new(name, tmp_path)
    assert python(tmp_path.parent, "-c", text).stdout.split() == [name]


def test_components_are_found_in_packages_of_the_folder_too(tmp_path):
    text = f"from navfmu.export.discovery import components; print(*components({str(tmp_path / 'kit')!r}))"
    new("radio_altimeter", tmp_path)
    new("gps", tmp_path)
    for folder in ("kit/radio", "kit/satellite/receivers", "kit/_drafts"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "__init__.py").write_text("")
    for folder in ("kit", "kit/satellite"):
        (tmp_path / folder / "__init__.py").write_text("")
    for draft in ("kit/_drafts", "kit/radio"):
        (tmp_path / draft / "radio_altimeter.py").write_text((tmp_path / "radio_altimeter.py").read_text())
    (tmp_path / "kit/satellite/receivers/gps.py").write_text((tmp_path / "gps.py").read_text())
    assert python(tmp_path.parent, "-c", text).stdout.split() == ["gps", "radio_altimeter"]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("RadioAltimeter", "did you mean 'radio_altimeter'?"),
        ("radio altimeter", "did you mean 'radio_altimeter'?"),
        ("2x", "first a letter"),
        ("x__y", "did you mean 'x_y'?"),
        ("../x", "cannot name a component"),
        ("", "'' cannot name a component"),
        ("class", "'class' means something else in Python"),
        ("match", "'match' means something else in Python"),
        ("queue", "'queue' means something else in Python"),
        ("numpy", "'numpy' is the name of a Python module, which the file would hide"),
    ],
)
def test_a_bad_name_is_answered_by_a_sentence_and_nothing_is_written(name, sentence, tmp_path):
    done = CliRunner().invoke(main, ["new", "--folder", str(tmp_path), "--", name])
    assert done.exit_code == 2 and sentence in done.output
    assert not any(tmp_path.iterdir())


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "lag.py").write_text("mine")
    with pytest.raises(NavfmuError, match=r"lag\.py exists already"):
        new("lag", tmp_path)
    assert (tmp_path / "lag.py").read_text() == "mine"


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(NavfmuError, match="cannot be written"):
        new("lag", tmp_path / "taken")
