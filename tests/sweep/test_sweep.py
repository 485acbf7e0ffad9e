"""Step-size sweeps from Python: orders of convergence, lost samples, recommendation."""

from __future__ import annotations

import shlex

import numpy as np
import pytest

from navfmu import System
from navfmu.sweep.recommendation import recommendation
from navfmu.sweep.result import Sweep
from navfmu.sweep.sweep import sweep
from tests.components import systems


@pytest.fixture(scope="module")
def result() -> Sweep:
    system = System.load(systems.tracker())
    return sweep(system.experiment(record=["lag", "estimator", "sensor.reading"], seed=2), [1.0, 0.1, 0.2, 0.5])


def test_interpolated_inputs_converge_in_second_order_and_held_ones_in_first(result):
    assert result.order("gauss_seidel", "lag.y").value == pytest.approx(2.0, abs=0.2)
    assert result.order("jacobi", "lag.y").value == pytest.approx(1.0, abs=0.2)


def test_the_smallest_step_is_the_reference(result):
    for algorithm in ("gauss_seidel", "jacobi"):
        errors = [row.rms for row in result.of(algorithm, "lag.y")]
        assert errors[0] == 0.0 and errors == sorted(errors)
    assert result.steps == (0.1, 0.2, 0.5, 1.0) and result.period == 1.0


def test_jacobi_delivers_one_step_late(result):
    """A sine of 10 m and 5 s: the rms of its change in 0.1 s is 10 * 0.1 / 5 / sqrt 2, and the lag changes little."""
    assert result.apart["lag.y"] == pytest.approx(0.14, abs=0.02)


def test_samples_are_lost_above_their_period_and_counted(result):
    counts = result.lost["estimator.reading.lost"]
    assert counts["gauss_seidel", 0.1] == 0
    assert counts["gauss_seidel", 1.0] == 180  # of 200, one in each second remains
    assert not any("lost" in note for note in result.notes)  # the table tells it
    assert result.recommended("gauss_seidel") == 0.1 and "No step above 0.1 s" in recommendation(result)


def test_the_noise_is_the_same_at_every_step():
    system = System.load(systems.tracker())
    record = {"record": ["sensor.reading.length"], "record_period": 1.0, "seed": 4, "stop": 10.0}
    still = {"truth.amplitude": 0.0}  # nothing is coupled, all that is left is noise
    a, b = (system.run(step=step, parameters=still, **record) for step in (0.01, 1.0))
    assert np.array_equal(a.to_numpy(), b.to_numpy()) and a.to_numpy().std() > 0.1


def test_a_sweep_says_how_to_repeat_it():
    """sweep.json once said "seed: null, parameters: {}" after --seed 9 --set ..."""
    system = System.load(systems.tracker(), "slow")
    experiment = system.experiment(
        seed=9, parameters={"lag.tau": "2 s"}, faults="stuck", stop=5.0, record=["lag.y"], step=0.1
    )
    about = sweep(experiment, [0.1, 0.5]).provenance
    assert (about["seed"], about["parameters"], about["stop"]) == (9, {"lag.tau": "2 s"}, 5.0)
    assert about["steps"] == [0.1, 0.5] and about["variant"] == "slow" and about["faults"][0]["id"] == "F1"
    words = shlex.split(about["command"])
    for pair in (("--seed", "9"), ("--set", "lag.tau=2 s"), ("--faults", "stuck"), ("--signals", "lag.y")):
        assert words[words.index(pair[0]) + 1] == pair[1]
    assert words[words.index("--steps") + 1] == "0.1,0.5"


def test_start_values_before_the_first_measurement_are_not_compared():
    tracker = System.load(systems.tracker())
    record = ["*.solution.length"]  # the validity comes along, whatever the name
    early = sweep(tracker.experiment(record=record, stop=0.4, seed=3), [0.05, 0.1])
    frame = System.load(systems.tracker()).run(
        stop=0.4, step=0.05, seed=3, record=["estimator.solution"], record_period=0.1
    )
    values = frame["estimator.solution.length"][frame["estimator.solution.valid"].astype(bool)]
    assert len(values) < len(frame)
    (row, *_) = early.of("gauss_seidel", "estimator.solution.length")
    assert row.span == pytest.approx(values.max() - values.min())
