"""``navfmu table``: tables of an FMU shown, written and replaced."""

from __future__ import annotations

import zipfile

import fmpy
import numpy as np
import pytest
from click.testing import CliRunner

from navfmu.cli.main import main
from navfmu.export import Component, Grid, Output, Parameter, Table, every
from navfmu.export.build import build
from navfmu.system import shipped


class Hill(Component):
    """A hill."""

    update_period = Parameter("s", start=1.0, description="period")
    profile = Table(columns=(("time", "s"), ("height", "m")), rows=[[0.0, 1.0], [10.0, 2.0]])
    air = Table(columns=(("time", "s"), ("temperature", "K")), rows=[[0.0, 288.0], [1.0, 289.0], [2.0, 290.0]])
    field = Grid(
        axes=(("north", "m", [0.0, 1.0]), ("east", "m", [0.0, 1.0, 2.0])), surfaces=(("dip", "rad", np.ones((2, 3))),)
    )
    height = Output("m", description="height")

    @every("update_period")
    def look(self):
        self.height = self.profile.row[1]


class Bare(Component):
    """Without tables."""

    update_period = Parameter("s", start=1.0, description="period")
    x = Output("m", description="x")

    @every("update_period")
    def look(self):
        self.x = self.x + 1.0


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    return build([Hill, Bare], tmp_path_factory.mktemp("tables"), pictures=False)


def navfmu(*words: object):
    return CliRunner().invoke(main, ["table", *map(str, words)])


def wrote(*words: object) -> None:
    done = navfmu(*words)
    assert done.exit_code == 0, done.output
    assert done.output == f"wrote {words[-1]}\n"


def refused(sentence: str, *words: object) -> None:
    done = navfmu(*words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert sentence in done.stderr and done.stderr.count("\n") == 1


def test_tables_are_listed_with_their_columns(fmus):
    hill, bare = fmus
    listed = navfmu(hill).output
    assert [line.split() for line in listed.splitlines()[1:]] == [
        ["air", "3", "rows", "time", "(s),", "temperature", "(K)"],
        ["field", "2", "x", "3", "north", "(m),", "east", "(m),", "dip", "(rad)"],
        ["profile", "2", "rows", "time", "(s),", "height", "(m)"],
    ]
    assert navfmu(bare).output == f"{bare} has no tables\n"


def test_a_shipped_fmu_has_its_name_unless_there_is_a_file(fmus, tmp_path, monkeypatch):
    hill, bare = fmus
    monkeypatch.setattr(shipped, "folders", lambda: [hill.parent])
    monkeypatch.chdir(tmp_path)
    wrote("hill.fmu", "profile", "--out", "profile.csv")
    (tmp_path / "hill.fmu").write_bytes(bare.read_bytes())
    assert navfmu("hill.fmu").output == "hill.fmu has no tables\n"
    refused("nothing.fmu: no such file; expected an FMU", "nothing.fmu")


def test_a_table_is_written_edited_and_put_in_the_place_of_the_old_one(fmus, tmp_path):
    hill, _ = fmus
    wrote(hill, "profile", "--out", tmp_path / "profile.csv")
    assert (tmp_path / "profile.csv").read_text() == "time (s),height (m)\n0.0,1.0\n10.0,2.0\n"
    (tmp_path / "profile.csv").write_text("time (s),height (m)\n0,5\n1,6\n2,7\n")
    wrote(hill, "profile", "--from", tmp_path / "profile.csv", "--out", tmp_path / "other.fmu")
    result = fmpy.simulate_fmu(str(tmp_path / "other.fmu"), stop_time=1.5, output_interval=0.5)
    assert result["height"].tolist() == [0.0, 0.0, 6.0, 6.0]
    before, after = (fmpy.read_model_description(str(file)).guid for file in (hill, tmp_path / "other.fmu"))
    assert after.startswith(f"{before}.")  # to masters these are two FMUs
    with zipfile.ZipFile(hill) as one, zipfile.ZipFile(tmp_path / "other.fmu") as other:
        changed = [name for name in one.namelist() if one.read(name) != other.read(name)]
        assert one.namelist() == other.namelist()
    assert sorted(changed) == ["modelDescription.xml", "resources/profile.npy"]


def test_a_table_replaced_twice_has_the_guid_of_its_numbers_alone(fmus, tmp_path):
    hill, _ = fmus
    wrote(hill, "profile", "--out", tmp_path / "profile.npy")
    wrote(hill, "air", "--out", tmp_path / "air.npy")
    air = np.load(tmp_path / "air.npy")
    air["temperature (K)"] += 1.0
    np.save(tmp_path / "warm.npy", air)
    wrote(hill, "air", "--from", tmp_path / "warm.npy", "--out", tmp_path / "warm.fmu")
    wrote(tmp_path / "warm.fmu", "air", "--from", tmp_path / "air.npy", "--out", tmp_path / "again.fmu")
    wrote(hill, "profile", "--from", tmp_path / "profile.npy", "--out", tmp_path / "same.fmu")
    guids = [fmpy.read_model_description(str(tmp_path / f"{name}.fmu")).guid for name in ("again", "same", "warm")]
    assert guids[0] == guids[1] != guids[2]


def test_a_file_for_a_string_parameter_is_made_and_added(fmus, tmp_path):
    hill, _ = fmus
    (tmp_path / "p.csv").write_text("time (s),height (m)\n0,5\n1,6\n")
    wrote(hill, "profile", "--from", tmp_path / "p.csv", "--out", tmp_path / "p.npy")
    assert np.load(tmp_path / "p.npy")["height (m)"].tolist() == [5.0, 6.0]
    wrote(hill, "profile", "--from", tmp_path / "p.npy", "--as", "steep", "--out", tmp_path / "more.fmu")
    with zipfile.ZipFile(hill) as one, zipfile.ZipFile(tmp_path / "more.fmu") as other:
        assert other.read("resources/profile.npy") == one.read("resources/profile.npy")
        assert other.read("resources/steep.npy") == (tmp_path / "p.npy").read_bytes()
    listed = navfmu(tmp_path / "more.fmu").output
    assert [line.split()[0] for line in listed.splitlines()[1:]] == ["air", "field", "profile", "steep"]
    fmpy.simulate_fmu(str(tmp_path / "more.fmu"), stop_time=1.0)


def test_a_grid_goes_through_a_text(fmus, tmp_path):
    hill, _ = fmus
    wrote(hill, "field", "--out", tmp_path / "field.csv")
    text = (tmp_path / "field.csv").read_text()
    assert text.startswith("north (m),east (m),dip (rad)\n0.0,0.0,1.0\n0.0,1.0,1.0\n")
    wider = text.replace("1.0,2.0,1.0\n", "1.0,2.0,9.0\n") + "4.0,0.0,1.0\n4.0,1.0,1.0\n4.0,2.0,1.0\n"
    (tmp_path / "field.csv").write_text(wider)
    wrote(hill, "field", "--from", tmp_path / "field.csv", "--out", tmp_path / "other.fmu")
    wrote(tmp_path / "other.fmu", "field", "--out", tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == wider
    fmpy.simulate_fmu(str(tmp_path / "other.fmu"), stop_time=1.0)


def test_what_cannot_be_done_is_told(fmus, tmp_path):
    hill, bare = fmus
    csv, other = tmp_path / "a.csv", tmp_path / "o.fmu"
    csv.write_text("time (s),height (ft)\n0,1\n")
    wrote(hill, "profile", "--out", tmp_path / "good.csv")
    refused(
        "has no table 'profil'; its tables are: air, field, profile; did you mean 'profile'?",
        hill,
        "profil",
        "--out",
        csv,
    )
    refused("has no table 'x'; its tables are: none", bare, "x", "--out", csv)
    for name in ("", "a..b"):  # would be that of the table itself, and one that no string may name
        given = ("--from", tmp_path / "good.csv", "--as", name, "--out", other)
        refused(f"'{name}' cannot be the name of a table", hill, "profile", *given)
    foreign = tmp_path / "foreign.fmu"
    for content, sentence in (
        (
            {"modelDescription.xml": "<fmiModelDescription fmiVersion='3.0'/>"},
            "has no guid; expected an FMU of FMI 2.0",
        ),
        ({}, "foreign.fmu: has no modelDescription.xml; expected an FMU"),
    ):
        with zipfile.ZipFile(hill) as one, zipfile.ZipFile(foreign, "w") as archive:
            for path, data in ({"resources/profile.npy": one.read("resources/profile.npy")} | content).items():
                archive.writestr(path, data)
        refused(sentence, foreign, "profile", "--from", tmp_path / "good.csv", "--out", other)
    refused("which table? Its name is missing", hill, "--out", csv)
    refused("--out is missing, the file to write", hill, "profile")
    refused("--as b names a file within an FMU", hill, "profile", "--as", "b", "--out", tmp_path / "b.npy")
    refused("expected .csv or .npy at its end", hill, "profile", "--out", other)
    refused(
        "'../b' cannot be the name of a table",
        hill,
        "profile",
        "--from",
        tmp_path / "good.csv",
        "--as",
        "../b",
        "--out",
        other,
    )
    refused("expected .csv or .npy at its end", hill, "profile", "--out", tmp_path / "a.xlsx")
    refused("or .fmu at its end", hill, "profile", "--from", csv, "--out", tmp_path / "a.zip")
    refused("a.xlsx: cannot tell the format", hill, "profile", "--from", tmp_path / "a.xlsx", "--out", other)
    refused(
        "none.csv: no such file; expected a table", hill, "profile", "--from", tmp_path / "none.csv", "--out", other
    )
    refused("none.fmu: no such file; expected an FMU", tmp_path / "none.fmu")
    refused("a.csv, line 1: the columns are", hill, "profile", "--from", csv, "--out", other)
    wrote(hill, "air", "--out", tmp_path / "air.npy")
    refused(
        "air.npy: has the columns 'time (s)' (a list), 'temperature (K)' (a list); expected 'time (s)' (a list),",
        hill, "profile", "--from", tmp_path / "air.npy", "--out", other,
    )  # fmt: skip
    assert not other.exists()
