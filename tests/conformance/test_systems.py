"""The flat SSP of the connected FMUs in masters that this project did not write: equal to its own Jacobi.

With positions of GPS, and with signals and their solver, between which go whole numbers and switches of 24 satellites.
"""

from __future__ import annotations

import zipfile

import pytest

from navfmu import System
from system_ssp.backup_navigator.system import COMPONENTS, FMUS, source
from tests import built
from tests.conformance import hosts

STEP, STEPS = 1.0 / 64.0, 64 * 40  # the first GPS fixes, a calibrated wind and two rounds of DME ranges


@pytest.fixture(scope="module", params=["bay_area_scanning", "gps_signals"])
def variant(request):
    """With values that FMUs do not have, and with another structure."""
    return request.param


@pytest.fixture(scope="module")
def fmus(variant, tmp_path_factory):
    """Files by component."""
    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    files = dict(zip(COMPONENTS, COMPONENTS, strict=True))
    if variant == "gps_signals":
        files |= {"gps": "gps_signals", "gps_solver": "gps_solver"}
    return {name: built.fmu(file, tmp_path_factory) for name, file in files.items()}


@pytest.fixture(scope="module")
def ssp(variant, fmus, tmp_path_factory):
    package = tmp_path_factory.mktemp("ssp") / f"{variant}.ssp"
    return source(fmus["gps"].parent).pack(package, variant=variant)


@pytest.fixture(scope="module")
def expected(variant, ssp, fmus):
    result = System.load(ssp).run(
        stop=STEP * STEPS, step=STEP, algorithm="jacobi", record=list(fmus), record_period=STEP
    )
    values = {name: {} for name in fmus}
    for column in result.columns:
        component, _, variable = column.partition(".")
        values[component][variable] = float(result[column].iloc[-1])
    assert values["navigator"]["mode"] > 0 and values["dme"]["ranging.sequence"] > 1
    ranges = [values["dme"][f"ranging.slant_range[{i}]"] > 0 for i in range(1, 6)]
    assert sum(ranges) >= {"bay_area_scanning": 4, "gps_signals": 2}[variant]
    assert "gps_solver" not in fmus or (values["gps_solver"]["satellites"] >= 6 and values["gps_solver"]["fix.valid"])
    return values


def test_libcosim_flies_it_with_the_same_numbers(ssp, fmus, expected, tmp_path):
    with zipfile.ZipFile(ssp) as archive:
        archive.extractall(tmp_path)
    assert hosts.libcosim_ssp(tmp_path, fmus, STEP, STEPS) == expected


def test_ecos_flies_it_with_the_same_numbers(ssp, fmus, expected):
    assert hosts.ecos_library_ssp(ssp, fmus, STEP, STEPS) == expected


def test_the_program_ecos_flies_it_without_any_python(ssp, fmus, expected, tmp_path):
    hosts.ecos_library()  # says what is missing
    values = hosts.ecos_program_run(ssp, STEP, STEPS, tmp_path)
    for component, variables in expected.items():
        for name, value in variables.items():
            assert values[component][name] == pytest.approx(value, abs=0.6e-6), f"{component}.{name}"
