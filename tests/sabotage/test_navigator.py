"""The backup navigator, sabotaged: the table of docs/sabotage.md."""

from __future__ import annotations

import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest

from navfmu import Fault, System
from navfmu.sabotage.system import sabotage
from system_ssp.backup_navigator.system import FMUS, source
from tests import built
from tests.conformance import hosts

STEP, STEPS = 1.0 / 64.0, 64 * 60
FAULTS = (
    Fault("jammed", "gps.jammed", "input", 20.0),
    Fault("pitot", "air_data.air.true_airspeed", "drift", 25.0, rate="0.2 kn/s"),
    Fault("ranges", "navigator.ranging", "dropout", 30.0, on=5.0, off=3.0),
)
LATE = (
    Fault("late air", "air_data.air", "delay", delay=STEP),
    Fault("late ranges", "navigator.ranging", "delay", delay=STEP),
)


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    for name in FMUS:
        folder = built.fmu(name, tmp_path_factory).parent
    package = source(folder).pack(tmp_path_factory.mktemp("ssp") / "scanning.ssp", variant="scanning")
    return System.load(package)


@pytest.fixture(scope="module")
def package(system, tmp_path_factory):
    file = tmp_path_factory.mktemp("sabotaged") / "it.ssp"
    sabotage(system.experiment(stop=STEPS * STEP, step=STEP, seed=7, faults=FAULTS), file)
    return file


@pytest.fixture(scope="module")
def flown(system, package):
    """By the words of the table."""

    def fly(of, *faults):
        record = ["navigator.*", "evaluation.*"]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return of.run(
                stop=STEPS * STEP,
                step=STEP,
                algorithm="jacobi",
                seed=7,
                faults=faults,
                record=record,
                record_period=STEP,
            )

    return {
        "own injection, behind delays of one step": fly(system, *LATE, *FAULTS),
        "sabotaged, in this master (Jacobi)": fly(System.load(package)),
    }


def test_in_this_master_all_bits_are_the_same_at_all_points(flown):
    late, sabotaged = (
        flown[name] for name in ("own injection, behind delays of one step", "sabotaged, in this master (Jacobi)")
    )
    assert len(late) == 3841 and late.columns.equals(sabotaged.columns)
    for name in late:
        np.testing.assert_array_equal(late[name].to_numpy(), sabotaged[name].to_numpy(), name)


@pytest.mark.parametrize("host", ["libcosim", "Ecos"])
def test_in_other_masters_all_bits_are_the_same_at_the_end(package, flown, host, tmp_path):
    fmus = {name: Path(fmu.path) for name, fmu in System.load(package).fmus.items()}
    if host == "libcosim":
        with zipfile.ZipFile(package) as archive:
            archive.extractall(tmp_path)
        found = hosts.libcosim_ssp(tmp_path, fmus, STEP, STEPS)
    else:
        found = hosts.ecos_library_ssp(package, fmus, STEP, STEPS)
    expected = flown["own injection, behind delays of one step"].iloc[-1]
    for name in expected.index:
        component, _, variable = name.partition(".")
        assert found[component][variable] == float(expected[name]), name
