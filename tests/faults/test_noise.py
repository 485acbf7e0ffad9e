"""The noise of faults is Philox4x64-10, numbered by sample, the same in C and in Python."""

import numpy as np
from scipy import stats

from navfmu.engine import compiled
from navfmu.engine.effect import fault_stream
from navfmu.engine.philox import STREAM_BASE, normal
from navfmu.engine.plan import make_plan
from navfmu.export.noise import Normals
from navfmu.faults import Fault
from tests.engine.probe import probe


def test_the_numbers_are_those_of_the_runtime_of_the_fmus():
    for seed, stream, lane, j in [(0, 0, 0, 0), (1, 2, 3, 4), (2**31 - 1, 2**32 + 5, 7, 2**40)]:
        assert normal(seed, stream, lane, j) == Normals(seed, stream, j, lane)(1)[0]


def test_the_compiled_engine_draws_the_numbers_of_numpy():
    fault = Fault("x", "a.y", "noise", 0.0, parameters={"sigma": 2.0, "period": 0.1, "stream": 5})
    plan = make_plan([probe("a")], [], step=0.1, stop=20.0, faults=[fault], seed=3, record=["a.y"])
    expected = [2.0 * normal(3, STREAM_BASE + 5, 0, j) for j in range(201)]
    assert compiled.run(plan)["a.y"].tolist() == expected


def test_the_noise_is_normal_with_the_given_sigma():
    fault = Fault("x", "a.y", "noise", 0.0, parameters={"sigma": 0.5, "period": 0.01})
    plan = make_plan([probe("a")], [], step=0.01, stop=200.0, faults=[fault], record=["a.y"])
    drawn = compiled.run(plan)["a.y"]
    assert stats.kstest(drawn, "norm", args=(0.0, 0.5)).pvalue > 1e-3
    assert abs(np.corrcoef(drawn[1:], drawn[:-1])[0, 1]) < 0.03


def test_two_faults_have_two_streams():
    one, two = (Fault(name, "a.y", "noise", parameters={"sigma": 1.0, "period": 1.0}) for name in ("one", "two"))
    assert fault_stream(one) != fault_stream(two)
