"""The sources of several FMUs in one program: names of FMI's functions have a prefix, all others are local."""

import subprocess
import sys
from pathlib import Path

import pytest

from .slave import OK, Slave

HERE = Path(__file__).parent
NAMES = ("sensor", "source")  # one with noise, one with a table


def compile_c(*arguments):
    command = [sys.executable, "-m", "ziglang", "cc", "-std=c11", "-O1", "-ffp-contract=off", "-Wall", "-Werror"]
    command += ["-fno-sanitize=undefined", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def globals_of(*objects):
    """The names that object files define for others."""
    done = subprocess.run(
        ["nm", "-g", "--defined-only", *map(str, objects)], capture_output=True, text=True, check=True
    )
    return [line.split()[-1] for line in done.stdout.splitlines() if len(line.split()) == 3]


def outputs(fmu):
    """References of the Real outputs."""
    found = [n for n, v in fmu.variables.items() if v.get("causality") == "output" and fmu.type(n) == "Real"]
    return [fmu.reference(name) for name in found]


@pytest.fixture(scope="module")
def objects(unzipped, tmp_path_factory):
    """Name -> the object of an FMU, compiled from its own sources."""
    folder = tmp_path_factory.mktemp("static")
    made = {name: folder / f"{name}.o" for name in NAMES}
    for name, file in made.items():
        compile_c(f"-DFMI2_FUNCTION_PREFIX={name}_", "-c", unzipped[name].folder / "sources" / "fmu.c", "-o", file)
    return made


def test_all_that_an_fmu_defines_for_others_are_fmi_functions_with_its_prefix(objects):
    for name, file in objects.items():
        found = globals_of(file)
        assert f"{name}_fmi2DoStep" in found
        assert [symbol for symbol in found if not symbol.startswith(f"{name}_fmi2")] == []


def test_two_fmus_share_no_name(objects):
    found = globals_of(*objects.values())
    assert len(found) == len(set(found)) > 50


def test_two_fmus_linked_into_one_program_compute_what_their_libraries_compute(objects, unzipped, tmp_path):
    main = tmp_path / "main.c"
    declared = "".join(f"int run_{name}(const char *, const char *);\n" for name in NAMES)
    calls = "".join(f"    if (run_{name}(v[{2 * i + 1}], v[{2 * i + 2}])) return 1;\n" for i, name in enumerate(NAMES))
    main.write_text(f"{declared}int main(int n, char **v) {{\n    (void)n;\n{calls}    return 0;\n}}\n")
    hosts = [tmp_path / f"host_{name}.o" for name in NAMES]
    for name, host in zip(NAMES, hosts, strict=True):
        references = ",".join(map(str, outputs(unzipped[name])))
        flags = [f"-DFMI2_FUNCTION_PREFIX={name}_", f"-DRUN=run_{name}", f"-DREFERENCES={references}"]
        compile_c(*flags, f"-I{unzipped[name].folder / 'sources'}", "-c", HERE / "linked.c", "-o", host)
    program = tmp_path / "program"
    compile_c(main, *hosts, *objects.values(), "-o", program, "-lm")
    given = [text for name in NAMES for text in (unzipped[name].guid, (unzipped[name].folder / "resources").as_uri())]
    done = subprocess.run([str(program), *given], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    expected = []
    for name in NAMES:
        slave = Slave(unzipped[name])
        assert slave.initialise() == OK
        for k in range(20):
            assert slave.step(0.1 * k, 0.1) == OK
        expected += slave.get_references("Real", outputs(unzipped[name]))[1]
    assert [float.fromhex(line) for line in done.stdout.split()] == expected
