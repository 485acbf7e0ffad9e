"""The backup navigator of ten FMUs: engine against engine, saved states, and its physical faults."""

import numpy as np
import pytest

from navfmu import System
from navfmu.engine import compiled, reference
from navfmu.engine.compiled import Compiled
from navfmu.faults import Fault
from system_ssp.backup_navigator.system import COMPONENTS, source
from tests import built

FAULTS = [
    Fault("jammed", "gps.jammed", "input", 2.0, 1.5),
    Fault("gyro", "imu.reading.rate", "bias", 1.0, 3.0, {"value": [0.01, 0.0, -0.01]}),
    Fault("air", "air_data.air", "dropout", 1.5, 2.0),
    Fault("altitude", "aircraft.altitude", "noise", 0.5, 4.0, {"sigma": 5.0, "period": 0.05}),
    Fault("wind", "wind.wind_n", "drift", 1.0, 2.0, {"rate": [0.1, 0.2, 0.0]}),
    Fault("iron", "magnetometer.hard_iron_change", "input", 2.5, 1.0, {"value": 1e-6}),
    Fault("roll", "ahrs.attitude.roll", "stuck", 3.0, 1.0),
]


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    fmus = [built.fmu(name, tmp_path_factory) for name in COMPONENTS]
    return source(fmus[0].parent).pack(tmp_path_factory.mktemp("ssp") / "backup_navigator.ssp")


@pytest.fixture(scope="module")
def system(packed):
    return System.load(packed)


@pytest.mark.parametrize("faults", [[], FAULTS], ids=["without faults", "with faults"])
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
def test_both_engines_record_the_same_bits(system, algorithm, faults):
    plan = system.plan(stop=5.0, step=0.01, algorithm=algorithm, faults=faults, record=["*"], record_period=0.01)
    fast, slow = compiled.run(plan), reference.run(plan)
    assert [name for name in fast.names if fast[name].tobytes() != slow[name].tobytes()] == []
    assert fast.values.shape == (501, len(plan.recorded))
    if faults:
        clean = compiled.run(system.plan(stop=5.0, step=0.01, algorithm=algorithm, record=["*"], record_period=0.01))
        assert np.array_equal(fast.values[:50], clean.values[:50])
        assert not np.array_equal(fast.values, clean.values)


@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
def test_restoring_a_saved_state_and_repeating_gives_the_same_bits(system, algorithm):
    plan = system.plan(stop=60.0, step=0.02, algorithm=algorithm, faults=FAULTS, record=["*"], record_period=0.02)
    straight = compiled.run(plan).values.tobytes()
    with Compiled(plan) as engine:
        engine.initialise()
        engine.advance(120)  # 2.4 s: several faults are active
        snapshot = engine.snapshot()
        engine.advance()
        engine.rows[121:] = np.nan
        engine.restore(snapshot)
        engine.advance()
        assert engine.recording().values.tobytes() == straight


def test_gauss_seidel_needs_no_cut_and_keeps_the_order_of_the_description(system):
    plan = system.plan(stop=1.0, step=0.01)
    assert plan.cut == ()
    assert [plan.parts[i].component.name for i in plan.order] == list(COMPONENTS)


def test_every_physical_fault_input_changes_something(packed):
    system = System.load(packed, variant="bay_area")
    options = {"stop": 900.0, "step": 0.05, "record": ["*"], "record_period": 1.0}
    clean = compiled.run(system.plan(**options))
    connected = {target for _, target, _, _ in system.links}
    inputs = [
        (name, variable)
        for name, fmu in system.fmus.items()
        for variable in fmu.description.variables
        if variable.causality == "input" and f"{name}.{variable.name}" not in connected
    ]
    assert {name for name, _ in inputs} == {"gps", "dme", "air_data", "magnetometer"}
    for name, variable in inputs:
        parameters = {} if variable.type == "Boolean" else {"value": 2e-6}
        fault = Fault("f", f"{name}.{variable.name}", "input", 300.0, 300.0, parameters)
        faulted = compiled.run(system.plan(**options, faults=[fault]))
        own = [i for i, column in enumerate(clean.names) if column.startswith(f"{name}.")]
        assert np.array_equal(faulted.values[:300], clean.values[:300]), variable.name
        assert not np.array_equal(faulted.values[300:600, own], clean.values[300:600, own]), variable.name
