"""FMU files: safe unpacking, the cached description, and a sentence for every way a file can be wrong."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest
from click.testing import CliRunner

from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.files import archive
from navfmu.files.digest import content_hash
from navfmu.fmi import fmu

from . import fmus


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(fmu, "_memory", {})
    return tmp_path / "cache"


def test_the_description_says_what_the_xml_says(tmp_path):
    about = fmu.describe(fmus.sensor(tmp_path))
    assert about.model_name == "sensor" and about.guid == "{1}"
    bias = about.by_name["bias[2]"]
    assert (bias.causality, bias.unit, bias.min, bias.max, bias.start) == ("parameter", "rad/s", 0.0, 1.0, 0.0)
    assert about.by_name["aligned"].start is False and about.by_name["seed"].start == 1
    assert about.units["ft"].factor == 0.3048 and about.units["rad/s"].exponents == (0, 0, -1, 0, 0, 0, 0, 1)
    assert about.display_units["m"]["nmi"] == (0.0005399568034557236, 0.0)


def test_a_second_load_reads_the_cache_and_imports_neither_fmpy_nor_lxml(tmp_path):
    file = fmus.sensor(tmp_path)
    first = fmu.load(file)
    script = (
        "import sys, json; from navfmu.fmi import fmu; f = fmu.load(sys.argv[1]);"
        "print(json.dumps([len(f.description.variables), 'fmpy' in sys.modules, 'lxml' in sys.modules]))"
    )
    out = subprocess.run([sys.executable, "-c", script, str(file)], capture_output=True, text=True, check=True).stdout
    assert json.loads(out) == [len(first.description.variables), False, False]


def test_a_cached_load_takes_about_a_millisecond(tmp_path, monkeypatch):
    file = fmus.sensor(tmp_path)
    fmu.load(file)
    durations = []
    for _ in range(20):
        monkeypatch.setattr(fmu, "_memory", {})
        start = time.perf_counter()
        fmu.load(file)
        durations.append(time.perf_counter() - start)
    assert min(durations) < 0.005


@pytest.mark.parametrize("change", [lambda t: "{", lambda t: t.replace('"guid":"{1}"', '"guid":"{2}"'), lambda t: ""])
def test_a_damaged_cached_description_is_read_anew(tmp_path, cache, change):
    """Also one that still is a description, but another one."""
    file = fmus.sensor(tmp_path)
    first = fmu.describe(file)
    (cached,) = cache.glob("described/*/content/description.json")
    good = cached.read_text()
    cached.write_text(change(good))
    assert cached.read_text() != good
    assert fmu.describe(file) == first
    assert cached.read_text() == good


def test_only_what_this_machine_needs_is_unpacked(tmp_path):
    file = fmus.sensor(tmp_path)
    with zipfile.ZipFile(file, "a") as packed:
        for name in ("binaries/vax/sensor.exe", "sources/a.c", "documentation/index.html", "resources/table.csv"):
            packed.writestr(name, "x")
    folder = fmu.load(file).folder
    assert (folder / "resources" / "table.csv").is_file()
    assert not (folder / "binaries" / "vax").exists() and not (folder / "sources").exists()


def test_many_threads_unpack_one_archive_at_once(tmp_path):
    file = fmus.sensor(tmp_path)
    digest = content_hash(file)
    with ThreadPoolExecutor(8) as pool:
        folders = set(pool.map(lambda _: archive.unpack(file, "FMU", digest), range(32)))
    assert len(folders) == 1 and (folders.pop() / "modelDescription.xml").is_file()
    assert not list((tmp_path / "cache" / "unpacked").glob(".*"))


def test_a_file_that_is_replaced_while_it_is_read_leaves_nothing_in_the_cache(tmp_path, cache, monkeypatch):
    old, new = fmus.sensor(tmp_path), tmp_path / "new.fmu"
    new.write_bytes(old.read_bytes())
    with zipfile.ZipFile(new, "a") as packed:
        packed.writestr("resources/table.csv", "x")
    digest = content_hash(old)
    new.replace(old)
    with pytest.raises(NavfmuError, match=r"sensor\.fmu: was changed by somebody else while it was read"):
        archive.unpack(old, "FMU", digest)
    with monkeypatch.context() as patch:
        patch.setattr(fmu, "content_hash", lambda *_: digest)
        with pytest.raises(NavfmuError, match="was changed by somebody else"):
            fmu.describe(old)
    assert not list((cache / "unpacked").iterdir())
    assert (fmu.load(old).folder / "resources" / "table.csv").is_file()


def test_what_nobody_used_for_a_month_is_removed_as_a_whole(tmp_path, cache):
    file = fmus.sensor(tmp_path)
    unused = cache / "unpacked" / "unused"
    (unused / "binaries").mkdir(parents=True)
    (cache / "unpacked" / "unused.json").write_text("{}")
    for path in (unused, cache / "unpacked" / "unused.json"):
        os.utime(path, (0, 0))
    content = archive.unpack(file, "FMU", content_hash(file))
    assert [path.name for path in (cache / "unpacked").iterdir()] == [content.parent.name]


def archive_with(path, *entries):
    with zipfile.ZipFile(path, "w") as packed:
        for entry in entries:
            packed.writestr(*(entry if isinstance(entry, tuple) else (entry, b"x")))
    return path


def link(name):
    entry = zipfile.ZipInfo(name)
    entry.create_system = 3
    entry.external_attr = 0o120777 << 16
    return entry


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    ("entries", "sentence"),
    [
        (["../evil"], "would be written outside its folder"),
        (["a/../../evil"], "would be written outside its folder"),
        (["/etc/evil"], "would be written outside its folder"),
        (["C:/evil"], "would be written outside its folder"),
        (["..\\evil"], "would be written outside its folder"),
        ([link("resources/link")], "is a symbolic link"),
        (["a", ("a", b"other")], "appears twice, with different contents"),
        (["a/b", "a\\b", ("./a/b", b"y")], "appears twice, with different contents"),
        (["a", "a/b"], "is a file and a folder"),
        (["a/b", "a"], "is a file and a folder"),
    ],
)
def test_a_hostile_archive_is_refused_and_leaves_nothing_behind(tmp_path, cache, entries, sentence):
    file = archive_with(tmp_path / "x.fmu", *entries)
    with pytest.raises(NavfmuError, match=sentence):
        archive.unpack(file, "FMU", content_hash(file))
    assert not (tmp_path / "evil").exists() and not list(cache.glob("unpacked/*"))


HARMLESS = {
    "a folder twice": ["binaries/", "binaries/", "./", "./binaries/", "Resources/", "resources/"],
    "the same file twice": ["resources/a", "resources/a", "./resources/a", "resources\\a"],
    "a link that nobody needs": [link("documentation/link"), link("sources/link"), link("binaries/other/lib.so.1")],
    "twice what nobody needs": ["documentation/a", ("documentation/a", b"other"), "sources/a", ("sources/a", b"y")],
}


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("entries", HARMLESS.values(), ids=HARMLESS)
def test_what_an_archive_has_too_much_of_without_harm_is_put_up_with(tmp_path, entries):
    file = fmus.sensor(tmp_path)
    with zipfile.ZipFile(file, "a") as packed:
        for entry in entries:
            packed.writestr(*(entry if isinstance(entry, tuple) else (entry, b"x")))
    folder = fmu.load(file).folder
    assert {path.name for path in folder.iterdir()} <= {"binaries", "resources", "modelDescription.xml"}
    assert fmu.binaries(file) and fmu.describe(file).model_identifier == "sensor"


def test_names_that_differ_in_capital_letters_are_two_where_the_file_system_has_two(tmp_path):
    file = archive_with(tmp_path / "x.fmu", ("resources/a", b"small"), ("resources/A", b"large"))
    if (tmp_path / "X.FMU").exists():
        with pytest.raises(NavfmuError, match="differs from another one in capital letters alone"):
            archive.unpack(file, "FMU", content_hash(file))
    else:
        folder = archive.unpack(file, "FMU", content_hash(file)) / "resources"
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"a": b"small", "A": b"large"}


def test_a_decompression_bomb_is_refused(tmp_path, cache, monkeypatch):
    monkeypatch.setattr(archive, "MAX_BYTES", 1_000_000)
    with zipfile.ZipFile(tmp_path / "x.fmu", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("big", b"0" * 2_000_000)
    with pytest.raises(NavfmuError, match="at most 1000000 are accepted"):
        archive.unpack(tmp_path / "x.fmu", "FMU", "0" * 64)
    assert not list(cache.glob("unpacked/*"))


def test_too_many_entries_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MAX_FILES", 3)
    with pytest.raises(NavfmuError, match="holds 4 entries"):
        archive.unpack(archive_with(tmp_path / "x.fmu", *"abcd"), "FMU", "0" * 64)


def corrupt(path):
    """An archive whose directory is whole and whose data are not."""
    data = bytearray(path.read_bytes())
    start = data.index(b"<?xml")
    data[start : start + 200] = bytes(200)
    path.write_bytes(data)
    return path


def broken(folder, name, change):
    description = fmus.describe("broken", [fmus.variable("x", "parameter", reference=1)])
    return fmus.write(folder / name, change(description))


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda f: f / "none.fmu", "none.fmu: no such file"),
        (lambda f: f, "is a folder, expected an FMU"),
        (lambda f: (f / "t.fmu").write_text("hello") and f / "t.fmu", "is not an FMU"),
        (lambda f: archive_with(f / "e.fmu", "a"), "has no modelDescription.xml"),
        (lambda f: corrupt(fmus.sensor(f)), "modelDescription.xml is corrupt"),
        (lambda f: broken(f, "x.fmu", lambda d: d[:200]), "is not well-formed XML"),
        (
            lambda f: broken(f, "x.fmu", lambda d: d.replace("fmiModelDescription", "root")),
            "is not a model description",
        ),
        (lambda f: broken(f, "x.fmu", lambda d: d.replace('fmiVersion="2.0"', 'fmiVersion="1.0"')), "is for FMI 1.0"),
        (lambda f: broken(f, "x.fmu", lambda d: d.replace("CoSimulation", "ModelExchange")), "model exchange only"),
        (lambda f: broken(f, "x.fmu", lambda d: d.replace("<ModelStructure>", "<Wrong/><ModelStructure>")), "Wrong"),
        (
            lambda f: broken(f, "x.fmu", lambda d: d.replace('modelIdentifier="broken"', 'modelIdentifier="$x"')),
            "is not an identifier",
        ),
        (
            lambda f: broken(f, "x.fmu", lambda d: d.replace("?>", '?><!DOCTYPE a [<!ENTITY b "c">]>', 1)),
            "document type declaration",
        ),
    ],
)
def test_a_bad_file_is_answered_by_a_sentence_that_names_it(tmp_path, make, sentence):
    file = make(tmp_path)
    with pytest.raises(NavfmuError) as error:
        fmu.load(file)
    assert sentence in str(error.value) and str(file) in str(error.value)


def test_an_fmu_without_a_binary_for_this_machine_says_which_it_has(tmp_path):
    file = tmp_path / "vax.fmu"
    with zipfile.ZipFile(file, "w") as packed:
        packed.writestr("modelDescription.xml", fmus.describe("vax", [fmus.variable("x", "parameter", reference=1)]))
        packed.writestr("binaries/vms/vax.exe", b"x")
    with pytest.raises(NavfmuError, match=r"no binary for this machine .*; it has: vms"):
        fmu.load(file)


FURLONG = '<Unit name="furlong"><BaseUnit m="1" factor="200"/><DisplayUnit name="chain" factor="0.1"/></Unit>'
MODE = '<SimpleType name="Mode"><Enumeration><Item name="off" value="1"/></Enumeration></SimpleType>'


@pytest.mark.parametrize(
    ("twice", "other", "kind"),
    [
        (FURLONG, FURLONG.replace("200", "201.168"), "unit 'furlong'"),
        ('<DisplayUnit name="chain" factor="0.1"/>', '<DisplayUnit name="chain" factor="10"/>', "display unit 'chain'"),
        (MODE, MODE.replace("1", "2"), "type 'Mode'"),
        ('<Item name="off" value="1"/>', '<Item name="off" value="2"/>', "item 'off'"),
    ],
)
def test_a_definition_that_stands_there_twice_and_differs_is_refused(tmp_path, twice, other, kind):
    units = f"{FURLONG}</UnitDefinitions>"
    text = fmus.describe("m", [fmus.variable("y", "output")]).replace("</UnitDefinitions>", units)
    text = text.replace("<ModelVariables>", f"<TypeDefinitions>{MODE}</TypeDefinitions><ModelVariables>")
    assert not fmu.describe(fmus.write(tmp_path / "once.fmu", text)).lenient
    same = fmu.describe(fmus.write(tmp_path / "same.fmu", text.replace(twice, f"{twice}<!-- again -->{twice}")))
    assert same.lenient == (f"modelDescription.xml: {kind} is defined twice",)
    with pytest.raises(NavfmuError, match=rf"line \d+: {kind} is defined twice, and differs"):
        fmu.describe(fmus.write(tmp_path / "other.fmu", text.replace(twice, twice + other)))


def test_an_enumeration_is_an_integer_for_everybody_and_info_says_what_it_is(tmp_path):
    mode = fmus.variable("mode", "parameter", "Enumeration", 1, start="2", declaredType="Mode")
    types = (
        '<TypeDefinitions><SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="2"/>'
        "</Enumeration></SimpleType></TypeDefinitions><ModelVariables>"
    )
    file = fmus.write(tmp_path / "m.fmu", fmus.describe("m", [mode]).replace("<ModelVariables>", types))
    for _ in range(2):  # read, and read from the cache
        (variable,) = fmu.describe(file).variables
        assert (variable.type, variable.start, variable.enumeration, variable.fault) == ("Integer", 2, "Mode", False)
    shown = CliRunner().invoke(main, ["info", str(file)])
    assert shown.exit_code == 0 and "Enumeration" in shown.output
