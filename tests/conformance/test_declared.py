"""What few FMUs have (enumerations, strings, offsets, loops that a parameter counts) in hosts of others."""

from __future__ import annotations

import fmpy
import pytest

from navfmu import System
from navfmu.export.build import build
from tests.conformance import hosts
from tests.export.components import Iterating, Modes, Named, Ticking

STEP, STEPS = 0.125, 16


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Name -> FMU."""
    paths = build([Iterating, Modes, Named, Ticking], tmp_path_factory.mktemp("declared"), pictures=False)
    return {path.stem: path for path in paths}


@pytest.mark.parametrize("name", ["iterating", "modes", "named", "ticking"])
@pytest.mark.parametrize("host", [hosts.fmpy_single, hosts.libcosim_single, hosts.ecos_library_single])
def test_hosts_give_the_numbers_of_our_engine(name, host, fmus):
    """Enumerations aside, which libcosim leaves out with a warning."""
    system = System.load(fmus[name])
    (component,) = system.fmus
    result = system.run(stop=STEP * STEPS, step=STEP, algorithm="jacobi", record=[component], record_period=STEP)
    found = host(fmus[name], STEP, STEPS, {})
    assert found
    assert found == {variable: float(result[f"{component}.{variable}"].iloc[-1]) for variable in found}


def test_fmpy_sets_items_by_their_numbers_and_texts(fmus):
    given = {"first": 3, "command": 3, "stride": -1}
    result = fmpy.simulate_fmu(
        str(fmus["modes"]), stop_time=0.2, output_interval=0.1, start_values=given, output=["mode", "seen"]
    )
    assert result["mode"].tolist() == [3, 2, 1]
    assert result["seen"].tolist() == [-1.0, 1.0, 0.0]
    fmpy.simulate_fmu(str(fmus["named"]), stop_time=0.2, start_values={"station": "SGF", "others[2]": "Köln"})
    with pytest.raises(fmpy.fmi1.FMICallException, match="fmi2SetString"):
        fmpy.simulate_fmu(str(fmus["named"]), stop_time=0.2, start_values={"station": "Tulsa DME"})
