"""Building: same bytes everywhere, unchanged FMUs for nothing, changed ones anew, all platforms."""

import os
import shutil
import struct
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import fmpy
import pytest

from navfmu import NavfmuError
from navfmu.export import Component, Input, Output, Parameter, every, toolchain
from navfmu.export import build as building
from navfmu.export.build import build, build_all

from .components import Sensor, Source, TwoRates

ROOT = Path(__file__).parents[2]


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def names(path):
    with zipfile.ZipFile(path) as archive:
        return archive.namelist()


def test_an_fmu_has_everything_in_its_place(tmp_path):
    (path,) = build(Source, tmp_path)
    found = names(path)
    assert found == sorted(found)
    for name in (
        "modelDescription.xml",
        "model.png",
        "binaries/linux64/source.so",
        "documentation/index.html",
        "documentation/licenses/license.txt",
        "documentation/licenses/fmi-standard.txt",
        "resources/track.npy",
        "sources/fmu.c",
        "sources/model.c",
        "sources/fmi2Functions.h",
    ):
        assert name in found
    with zipfile.ZipFile(path) as archive:
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.read("model.png").startswith(b"\x89PNG")


def test_two_builds_in_two_folders_give_the_same_bytes(tmp_path):
    """Each in a process, a copy of the sources and a cache of its own."""
    results = []
    for name in ("one", "another/deeper"):
        folder = tmp_path / name
        shutil.copytree(Path(__file__).parent, folder / "parts", ignore=shutil.ignore_patterns("test_*", "__pycache__"))
        environment = os.environ | {"NAVFMU_CACHE": str(folder / "cache"), "PYTHONPATH": str(ROOT)}
        environment["PYTHONHASHSEED"] = str(len(results))
        code = (
            "from parts.components import Sensor, Source; from navfmu.export.build import build_all;"
            "build_all([Sensor, Source], 'dist', twins='dist/python')"
        )
        subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, check=True)
        results.append([(folder / "dist" / n).read_bytes() for n in ("sensor.fmu", "source.fmu", "python/sensor.fmu")])
    assert results[0] == results[1]


def test_without_pictures_nothing_is_drawn_and_nothing_runs_here(tmp_path, empty_cache):
    code = (
        "import sys; sys.modules['matplotlib'] = None; from navfmu.export import build, toolchain;"
        "from tests.export.components import Sensor; from navfmu.export.build import build_all;"
        "toolchain.host = None; out, twins = sys.argv[1:];"
        "build_all([Sensor], out, 'win64', twins=twins, pictures=False)"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path), str(tmp_path / "python")], cwd=ROOT, check=True)
    found = names(tmp_path / "sensor.fmu")
    assert "binaries/win64/sensor.dll" in found and "documentation/index.html" in found
    assert "model.png" not in found and "model.png" not in names(tmp_path / "python" / "sensor.fmu")
    assert not [name for name in found if "linux" in name]


def test_pictures_are_all_that_a_build_without_them_lacks(tmp_path):
    (with_pictures,) = build(Sensor, tmp_path)
    (without,) = build(Sensor, tmp_path / "plain", pictures=False)
    assert set(names(with_pictures)) - set(names(without)) == {"model.png"}
    with zipfile.ZipFile(with_pictures) as one, zipfile.ZipFile(without) as other:
        different = [name for name in other.namelist() if one.read(name) != other.read(name)]
    assert different == ["documentation/index.html"]


def test_code_and_description_are_generated_once_for_all_platforms(tmp_path, empty_cache, monkeypatch):
    calls = []
    for module, name in ((building.codegen, "generate"), (building.description, "describe")):
        original = getattr(module, name)

        def counted(*arguments, name=name, original=original, **options):
            calls.append(name)
            return original(*arguments, **options)

        monkeypatch.setattr(module, name, counted)
    (path,) = build(Sensor, tmp_path, ("host", "win64"), pictures=False)
    assert sorted(calls) == ["describe", "generate"]
    with zipfile.ZipFile(path) as archive:
        guid = fmpy.read_model_description(path).guid
        assert guid in archive.read("sources/model.c").decode() and "00000000-" not in guid


def test_an_unchanged_fmu_is_neither_traced_nor_compiled(tmp_path, empty_cache, monkeypatch):
    first = build_all([Sensor, Source], tmp_path, twins=tmp_path / "python")
    assert [built.unchanged for built in first] == [False] * 4
    for name in ("_lower", "library", "pack"):
        monkeypatch.setattr(building, name, None)
    started = time.perf_counter()
    again = build_all([Sensor, Source], tmp_path, twins=tmp_path / "python")
    assert [built.unchanged for built in again] == [True] * 4
    assert time.perf_counter() - started < 1.0
    before = first[0].path.read_bytes()
    first[0].path.unlink()
    elsewhere = build([Sensor], tmp_path / "elsewhere")
    assert elsewhere[0].read_bytes() == before


@pytest.mark.parametrize("kind", ["built", "compiled"])
def test_a_damaged_file_of_the_cache_does_not_reach_the_result(tmp_path, empty_cache, kind):
    (first,) = build([Source], tmp_path / "one")
    kept = list(empty_cache.glob(f"{kind}/*/content/*"))
    assert kept
    for path in kept:
        data = bytearray(path.read_bytes())
        data[len(data) // 2] ^= 1
        path.unlink()  # this process may have it loaded
        path.write_bytes(data)
    if kind == "compiled":  # with the finished FMU the library would not be asked for
        shutil.rmtree(empty_cache / "built")
    (second,) = build([Source], tmp_path / "two")
    assert second.read_bytes() == first.read_bytes()


def write_component(folder, gain):
    (folder / "fmus").mkdir(exist_ok=True)
    (folder / "equations.py").write_text(f"def double(x):\n    return {gain} * x\n")
    (folder / "fmus" / "__init__.py").write_text("")
    (folder / "fmus" / "doubler.py").write_text(
        "import equations\n"
        "from navfmu.export import Component, Input, Output, Parameter, every\n\n\n"
        "class Doubler(Component):\n"
        '    """Twice its input."""\n\n'
        '    x = Input("m", description="input")\n'
        '    sample_period = Parameter("s", start=0.1, min=0.01, description="period")\n'
        '    y = Output("m", description="output")\n\n'
        '    @every("sample_period")\n'
        "    def run(self):\n"
        "        self.y = equations.double(self.x)\n"
    )


def command(folder, *arguments, cache=None):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    if cache:
        environment["NAVFMU_CACHE"] = str(cache)
    call = [sys.executable, "-m", "navfmu.export", *arguments]
    return subprocess.run(call, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_somebody_elses_folder_of_components_is_built_and_rebuilt_when_an_equation_changes(tmp_path):
    write_component(tmp_path, 2)
    done = command(tmp_path, "--no-twins", cache=tmp_path / "cache")
    assert done.returncode == 0, done.stderr
    assert "1 FMUs, 1 built anew" in done.stdout
    fmu = tmp_path / "dist" / "doubler.fmu"
    before = fmu.read_bytes()
    assert fmpy.simulate_fmu(str(fmu), start_values={"x": 3.0}, stop_time=1.0, step_size=0.5)["y"][-1] == 6.0
    assert "1 FMUs, 0 built anew" in command(tmp_path, "--no-twins", cache=tmp_path / "cache").stdout
    write_component(tmp_path, 5)
    done = command(tmp_path, "--no-twins", cache=tmp_path / "cache")
    assert "1 FMUs, 1 built anew" in done.stdout
    assert fmpy.simulate_fmu(str(fmu), start_values={"x": 3.0}, stop_time=1.0, step_size=0.5)["y"][-1] == 15.0
    guids = {fmpy.read_model_description(str(path)).guid for path in (fmu,)}
    (tmp_path / "old.fmu").write_bytes(before)
    assert fmpy.read_model_description(str(tmp_path / "old.fmu")).guid not in guids


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["doublr"], "there is no component 'doublr'; expected one of doubler; did you mean 'doubler'?"),
        (["--folder", "nowhere"], "there is no folder"),
        (["--folder", "loop"], "there is no folder"),
        (["--folder", "empty"], "defines a subclass of navfmu.export.Component"),
        (["--platforms", "win46"], "unknown platform 'win46'"),
        (["--folder", "broken"], "wrong.py, line 2: NameError: name 'y' is not defined"),
        (["--folder", "unreadable"], "wrong.py, line 1: SyntaxError"),
    ],
)
def test_wrong_calls_end_with_a_sentence_and_code_2(tmp_path, arguments, sentence):
    write_component(tmp_path, 2)
    for folder, text in (("empty", ""), ("broken", "\nx = y\n"), ("unreadable", "def\n")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "wrong.py").write_text(text)
    (tmp_path / "loop").symlink_to("loop")
    done = command(tmp_path, *arguments)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "dist").exists()


def make(gain, start):
    """A component whose numbers do not stand in its source."""

    class Scaled(Component):
        """A factor times the input."""

        x = Input("m", start=start, description="input")
        sample_period = Parameter("s", start=0.1, min=0.01, description="period")
        y = Output("m", description="output")

        @every("sample_period")
        def run(self):
            self.y = gain * self.x

    return Scaled


def test_values_from_outside_the_source_are_never_taken_from_the_cache(tmp_path, empty_cache):
    for gain, start in ((2.0, 1.0), (3.0, 1.0), (3.0, 5.0)):
        (path,) = build(make(gain, start), tmp_path)
        assert fmpy.simulate_fmu(str(path), stop_time=1.0, step_size=0.5)["y"][-1] == gain * start


def test_two_components_of_one_name_are_refused(tmp_path):
    with pytest.raises(NavfmuError, match="two components are named 'sensor'"):
        build([Sensor, Sensor], tmp_path)
    with pytest.raises(NavfmuError, match="is not a component"):
        build([int], tmp_path)


def test_the_compilers_words_are_told(tmp_path):
    (tmp_path / "wrong.c").write_text("int f(void) { return missing; }\n")
    with pytest.raises(NavfmuError, match=r"the compiler failed on wrong.c for x86_64-linux:\n.*missing"):
        toolchain.compile_shared([tmp_path / "wrong.c"], tmp_path / "wrong.so", "x86_64-linux")
    assert not (tmp_path / "wrong.so").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["wrong.c"]


def test_libraries_need_nothing_but_an_old_c_library(tmp_path):
    (path,) = build(Sensor, tmp_path, "x86_64-linux")
    fmpy.extract(str(path), str(tmp_path / "x"))
    library = tmp_path / "x" / "binaries" / "linux64" / "sensor.so"
    done = subprocess.run(["objdump", "-p", str(library)], capture_output=True, text=True, check=True)
    needed = {line.split()[1] for line in done.stdout.splitlines() if "NEEDED" in line}
    assert needed <= {"libc.so.6", "libm.so.6"}
    versions = {word for word in done.stdout.split() if word.startswith("GLIBC_2.")}
    assert max(int(word.split(".")[1]) for word in versions) <= 17


def test_only_the_interface_is_exported(unzipped):
    library = unzipped["sensor"].folder / "binaries" / "linux64" / "sensor.so"
    done = subprocess.run(["nm", "-D", "--defined-only", str(library)], capture_output=True, text=True, check=True)
    exported = {line.split()[-1].split("@")[0] for line in done.stdout.splitlines()}
    assert {name for name in exported if not name.startswith("fmi2")} <= {"_init", "_fini"}
    assert {"fmi2DoStep", "fmi2SerializeFMUstate", "fmi2SetRealInputDerivatives"} <= exported


@pytest.mark.slow
def test_all_platforms_are_built_from_this_one_with_the_same_bytes_twice(tmp_path, monkeypatch):
    results = []
    for name in ("one", "two"):
        monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / name))
        (path,) = build(TwoRates, tmp_path / f"dist-{name}", "all")
        results.append(path.read_bytes())
    assert results[0] == results[1]
    with zipfile.ZipFile(path) as archive:
        binaries = {n: archive.read(n) for n in archive.namelist() if n.startswith("binaries/")}
    assert set(binaries) == {
        "binaries/linux64/two_rates.so",
        "binaries/aarch64-linux/two_rates.so",
        "binaries/win64/two_rates.dll",
        "binaries/darwin64/two_rates.dylib",
        "binaries/aarch64-darwin/two_rates.dylib",
    }
    assert binaries["binaries/linux64/two_rates.so"][18:20] == b"\x3e\x00"
    assert binaries["binaries/aarch64-linux/two_rates.so"][18:20] == b"\xb7\x00"
    assert binaries["binaries/win64/two_rates.dll"].startswith(b"MZ")
    universal = binaries["binaries/darwin64/two_rates.dylib"]
    assert struct.unpack_from(">II", universal) == (0xCAFEBABE, 2)
    processors = [struct.unpack_from(">iIIII", universal, 8 + 20 * i) for i in range(2)]
    assert [p[0] for p in processors] == [0x01000007, 0x0100000C]
    for _, _, offset, size, align in processors:
        assert offset % (1 << align) == 0
        assert universal[offset : offset + 4] == b"\xcf\xfa\xed\xfe"
        assert b"@rpath/two_rates.dylib" in universal[offset : offset + size]
    assert universal.endswith(binaries["binaries/aarch64-darwin/two_rates.dylib"])


def test_the_sources_in_the_fmu_make_its_binary_again(unzipped, tmp_path):
    """A host that compiles FMUs itself gets the same numbers."""
    fmu = unzipped["sensor"]
    listed = [file.get("name") for file in fmu.xml.findall("CoSimulation/SourceFiles/File")]
    folder = tmp_path / "again"
    shutil.copytree(fmu.folder, folder)
    library = folder / "binaries" / "linux64" / "sensor.so"
    library.unlink()
    sources = [str(folder / "sources" / name) for name in listed]
    flags = ["-O2", "-ffp-contract=off", "-shared", "-fPIC", f"-I{folder / 'sources'}"]
    subprocess.run(["gcc", *flags, *sources, "-o", str(library), "-lm"], check=True)
    runs = [
        fmpy.simulate_fmu(str(place), stop_time=2.0, step_size=0.1, output=["reading.s[1]"])
        for place in (fmu.folder, folder)
    ]
    assert runs[0]["reading.s[1]"].tolist() == runs[1]["reading.s[1]"].tolist()
