"""The backup navigator of ten FMUs: engine against engine, and saved states."""

import numpy as np
import pytest

from navfmu.engine import compiled, reference
from navfmu.engine.compiled import Compiled
from navfmu.faults import Fault
from system_ssp.backup_navigator.system import COMPONENTS

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
def system(load):
    return load()


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


def test_gauss_seidel_cuts_only_the_way_back_to_the_chart_and_keeps_the_order_of_the_description(system):
    """The declination is looked up at the navigator's position, which therefore comes one step late; the attitude does
    not, and initial values need no iteration."""
    plan = system.plan(stop=1.0, step=0.01)
    assert plan.cut and all(cut.startswith("navigator.solution.") for cut in plan.cut)
    assert all(cut.rpartition(" ")[2].startswith("ahrs.position.") for cut in plan.cut)
    assert plan.notes == (), "a bundle says itself how old it is"
    assert [plan.parts[i].component.name for i in plan.order] == list(COMPONENTS)
