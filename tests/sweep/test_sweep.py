"""Step-size sweeps from Python: orders of convergence, lost samples, recommendation."""

from __future__ import annotations

import shlex

import numpy as np
import pandas as pd
import pytest

from navfmu import System
from navfmu.sweep.sweep import Row, Sweep, _size, sweep
from tests.components import systems


@pytest.fixture(scope="module")
def result() -> Sweep:
    system = System.load(systems.tracker())
    return sweep(system.experiment(record=["lag", "estimator", "sensor.reading"], seed=2), [1.0, 0.1, 0.2, 0.5])


def test_interpolated_inputs_converge_in_second_order_and_held_ones_in_first(result):
    assert result.slope("gauss_seidel", "lag.y") == pytest.approx(2.0, abs=0.2)
    assert result.slope("jacobi", "lag.y") == pytest.approx(1.0, abs=0.2)


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
    assert result.recommended("gauss_seidel") == 0.1 and "No step above 0.1 s" in result.recommendation()


def test_the_noise_is_the_same_at_every_step():
    system = System.load(systems.tracker())
    record = {"record": ["sensor.reading.length"], "record_period": 1.0, "seed": 4, "stop": 10.0}
    still = {"truth.amplitude": 0.0}  # nothing is coupled, all that is left is noise
    a, b = (system.run(step=step, parameters=still, **record) for step in (0.01, 1.0))
    assert np.array_equal(a.to_numpy(), b.to_numpy()) and a.to_numpy().std() > 0.1


def made(errors: dict[str, list[float]], steps=(0.1, 0.2, 0.4)) -> Sweep:
    rows = [
        Row(algorithm, step, "a.y", "m", error, error, 10.0)
        for algorithm, values in errors.items()
        for step, error in zip(steps, values, strict=True)
    ]
    return Sweep("made", tuple(steps), 1.0, 0.4, tuple(rows), {"a.y": 0.5}, {}, 0.01, {})


def test_the_order_takes_into_account_that_the_reference_has_an_error_too():
    for order in (1.0, 2.0, 3.0):
        errors = [3.0 * (h**order - 0.1**order) for h in (0.1, 0.2, 0.4)]
        assert made({"gauss_seidel": errors}).slope("gauss_seidel", "a.y") == pytest.approx(order, abs=0.011)


def test_the_recommendation_is_the_greatest_step_below_which_all_is_well():
    result = made({"gauss_seidel": [0.0, 0.05, 0.3], "jacobi": [0.0, 0.2, 0.05]})
    assert result.recommended("gauss_seidel") == 0.2 and result.recommended("jacobi") == 0.1
    assert "Use gauss_seidel with steps up to 0.2 s" in result.recommendation()
    assert "the two differ by up to 5 %" in result.recommendation()


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


@pytest.mark.parametrize(("unit", "largest"), [("rad", 0.02), ("m", 2.0 * np.pi - 0.02)])
def test_angles_differ_by_the_short_way_round(unit, largest):
    angles = [pd.DataFrame({"a": [0.0, np.pi - 0.01]}), pd.DataFrame({"a": [0.0, -np.pi + 0.01]})]
    for frame in angles:
        frame.attrs["units"] = {"a": unit}
    assert _size(*angles, "a")[1] == pytest.approx(largest)


def test_start_values_before_the_first_measurement_are_not_compared():
    tracker = System.load(systems.tracker())
    early = sweep(tracker.experiment(record=["estimator.solution"], stop=0.4, seed=3), [0.05, 0.1])
    frame = System.load(systems.tracker()).run(
        stop=0.4, step=0.05, seed=3, record=["estimator.solution"], record_period=0.1
    )
    values = frame["estimator.solution.length"][frame["estimator.solution.valid"].astype(bool)]
    assert len(values) < len(frame)
    (row, *_) = early.of("gauss_seidel", "estimator.solution.length")
    assert row.span == pytest.approx(values.max() - values.min())
