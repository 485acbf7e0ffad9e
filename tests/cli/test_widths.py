"""Every number that a command prints is whole, and no table is wider than the terminal."""

from __future__ import annotations

import re

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.show import show as show_campaign
from navfmu.cli.main import main
from navfmu.cli.summary import summarise
from navfmu.fmi.fmu import describe
from navfmu.recorded.importer import import_track
from tests import built
from tests.components import systems
from tests.recorded.made import flight, recorded

WIDTHS = pytest.mark.parametrize("width", [60, 80, 160])


def output(width: int, *arguments: object) -> str:
    run = CliRunner().invoke(main, [str(a) for a in arguments], env={"COLUMNS": str(width)})
    assert run.exit_code == 0, run.output
    return checked(run.output, width)


def checked(text: str, width: int) -> str:
    """Lines are no wider than the terminal, but for paths, which are to be copied."""
    lines = [line for line in text.splitlines() if not re.search(r"/\w+/", line)]
    assert max(map(len, lines)) <= width and "…" not in text
    return text


@WIDTHS
@pytest.mark.parametrize("name", ["navigator", "dme", "air_data"])
def test_info_of_an_fmu(name, width, tmp_path_factory):
    file = built.fmu(name, tmp_path_factory)
    about, text = describe(file), output(width, "info", file)
    words = set(text.split())
    for v in about.variables:
        if v.causality in ("input", "output", "parameter") and v.type == "Real":
            numbers = [x for x in (v.start, v.min, v.max) if x is not None]
            assert all(f"{x:.6g}" in words for x in numbers), v.name


@WIDTHS
def test_info_of_a_system(width):
    system, text = System.load(systems.tracker()), output(width, "info", systems.tracker())
    table = text.partition(" components\n")[2].partition("connections")[0]
    for name, fmu in system.fmus.items():
        counts = [sum(v.causality == c for v in fmu.description.variables) for c in ("input", "output", "parameter")]
        found = [word for line in table.splitlines() if line.split()[:1] == [name] for word in line.split()]
        assert [int(word) for word in found if word.isdigit()] == [*counts, len(system.values[name])], name


@WIDTHS
def test_summary_of_a_run(width, monkeypatch, capsys):
    system = System.load(systems.tracker())
    frame = system.run(stop=5.0, seed=3, record=["sensor", "estimator", "lag.y", "truth.y"])
    monkeypatch.setenv("COLUMNS", str(width))
    summarise(frame, system, None)
    words = checked(capsys.readouterr().out, width).split()
    for name in frame:
        values = frame[name]
        if values.dtype.kind == "f":
            numbers = [values.iloc[0], values.min(), values.mean(), values.max(), values.iloc[-1]]
            assert all(f"{x:.6g}" in words for x in numbers), name
        elif values.dtype.kind == "i":
            assert str(values.iloc[-1]) in words


@WIDTHS
def test_matrix_of_a_campaign(width, monkeypatch, capsys, tmp_path):
    requirements = "".join(
        f'[[requirement]]\nid = "NAVIGATION-LENGTH-{i}"\nsignal = "estimator.solution.length"\nat_most = {i}.5\n'
        f"percent = 50\n"
        for i in range(1, 7)
    )
    file = tmp_path / "c.toml"
    file.write_text(f'name = "wide"\nsystem = "{systems.tracker()}"\nseeds = "1-2"\nstop = 2.0\n{requirements}')
    outcome = run_campaign(load_campaign(file), tmp_path / "out")
    monkeypatch.setenv("COLUMNS", str(width))
    capsys.readouterr()
    show_campaign(outcome)
    matrix = capsys.readouterr().out.partition("runs that hold / runs")[2].partition("\n  NAV")[0]
    checked(matrix, width)
    assert len(re.findall(r"(?:holds|VIOLATED) [0-2]/2", matrix)) == 6
    assert all(f"NAVIGATION-LENGTH-{i}" in matrix.split() for i in range(1, 7))


@WIDTHS
def test_residuals_of_a_track(width, tmp_path, tmp_path_factory, monkeypatch):
    import navfmu.system.shipped

    player = built.fmu("track", tmp_path_factory)
    monkeypatch.setattr(navfmu.system.shipped, "path", lambda name: player)
    csv = tmp_path / "made.csv"
    recorded(flight(), jitter=0.5).to_csv(csv, index=False)
    text = output(width, "track", csv, "--out", tmp_path / "made.fmu")
    for quantity, unit, count, *numbers in import_track(csv).residual_table():
        row = [*quantity.split(), *unit.split(), str(count), *(f"{x:.2f}" for x in numbers)]
        assert any(line.split() == row for line in text.splitlines()), row
