"""Every native FMU of this project in hosts that it did not write: the same numbers everywhere."""

from __future__ import annotations

import pytest
from fmpy.validation import validate_fmu

from navfmu import System
from tests import built
from tests.conformance import hosts

STEP, STEPS = 0.125, 24
NAMES = sorted(built.components())


@pytest.fixture(params=NAMES)
def fmu(request, tmp_path_factory):
    return built.fmu(request.param, tmp_path_factory)


@pytest.fixture
def expected(fmu):
    """Outputs after the run in the engine of this project."""
    system = System.load(fmu)
    (name,) = system.fmus
    start = {f"{name}.{variable}": value for variable, value in hosts.starts(fmu).items()}
    result = system.run(
        stop=STEP * STEPS, step=STEP, algorithm="jacobi", parameters=start, record=[name], record_period=STEP
    )
    last = {column.removeprefix(f"{name}."): float(result[column].iloc[-1]) for column in result.columns}
    assert set(last) == {v.name for v in hosts.outputs(fmu)}
    return last


def test_fmpy_finds_nothing_to_complain_about(fmu):
    assert validate_fmu(str(fmu)) == []


def test_fmpy_gives_the_same_numbers(fmu, expected):
    assert hosts.fmpy_single(fmu, STEP, STEPS, hosts.starts(fmu)) == expected


def test_libcosim_gives_the_same_numbers(fmu, expected):
    assert hosts.libcosim_single(fmu, STEP, STEPS, hosts.starts(fmu)) == expected


def test_ecos_gives_the_same_numbers(fmu, expected):
    assert hosts.ecos_library_single(fmu, STEP, STEPS, hosts.starts(fmu)) == expected


def test_the_program_ecos_runs_it_without_any_python(fmu, tmp_path):
    hosts.ecos_library()  # says what is missing
    values = hosts.ecos_program_run(fmu, STEP, STEPS, tmp_path)["instance"]
    default = hosts.fmpy_single(fmu, STEP, STEPS, {})
    for variable in hosts.outputs(fmu):
        assert values[variable.name] == pytest.approx(default[variable.name], abs=0.6e-6), variable.name
