"""Going back to a saved state and repeating gives the same bits."""

import numpy as np
import pytest

from navfmu.engine.compiled import Compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.engine.reference import Reference
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from tests.engine.probe import chain, probe

FAULTS = [
    Fault("bias", "lag0.y", "bias", 2.0, 3.0, {"value": 0.5}),
    Fault("noise", "lag1.y", "noise", 1.0, 6.0, {"sigma": 0.1, "period": 0.25}),
    Fault("late", "lag0.data", "dropout", 4.5, 2.0),
    Fault("stuck", "lag1.y", "stuck", 6.0, 1.0),
    Fault("drift", "lag2.y", "drift", 0.0, 9.0, {"rate": 0.1}),
    Fault("pushed", "lag2.number", "input", 3.0, 4.0, {"value": 7}),
    Fault("spikes", "lag1.y", "spike", 1.0, 8.0, {"value": 0.1, "every": 0.45, "on": 1.0, "off": 0.3}),
    Fault("seldom", "lag2.y", "slow", 1.5, 5.0, {"period": 0.7, "on": 0.9, "off": 0.2}),
    Fault("old", "lag0.y", "delay", 2.5, 6.0, {"delay": 0.2, "jitter": 0.4, "period": 0.3}),
    Fault("any", "lag3.y", "garbage", 0.5, 9.0, {"low": -1.0, "high": 1.0, "period": 0.35}),
]


def system():
    lags, connections = chain(4, interpolates=True, start=1.0, u=0.5)
    return lags, [*connections, Link("lag0.data.sequence", "lag1.number")]


@pytest.mark.parametrize("faults", [[], FAULTS], ids=["without faults", "with faults"])
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_restoring_and_repeating_gives_the_same_bits(kind, algorithm, faults):
    plan = make_plan(*system(), step=0.1, stop=10.0, algorithm=algorithm, faults=faults)
    with kind(plan) as engine:
        straight = engine.run().values.tobytes()
    with kind(plan) as engine:
        engine.initialise()
        for k in (0, 20, 33, 47, 61):  # before, at the edge of, and within windows
            engine.advance(k)
            snapshot = engine.snapshot()
            engine.advance()
            assert engine.recording().values.tobytes() == straight
            engine.rows[k + 1 :] = np.nan
            engine.restore(snapshot)
            assert engine.k == k
            engine.advance()
            assert engine.recording().values.tobytes() == straight
            engine.restore(snapshot)
            engine.free(snapshot)


def test_a_snapshot_belongs_to_its_engine():
    plan = make_plan(*system(), step=0.1, stop=1.0)
    with Compiled(plan) as one, Compiled(plan) as other:
        one.initialise()
        other.initialise()
        with pytest.raises(NavfmuError, match="only in the engine that made it"):
            other.restore(one.snapshot())


@pytest.mark.parametrize("kind", [Compiled, Reference])
def test_an_fmu_that_cannot_save_its_state_is_named(kind):
    plan = make_plan([probe("a"), probe("stiff", restores=False)], [], step=0.1, stop=1.0)
    with kind(plan) as engine:
        engine.initialise()
        with pytest.raises(NavfmuError, match="component 'stiff' cannot save its state"):
            engine.snapshot()
