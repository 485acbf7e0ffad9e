"""Running systems: closed forms, seeds, faults, recordings, threads, and sentences for wrong arguments."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas
import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from tests.components import systems


@pytest.fixture(scope="module")
def ring() -> System:
    return System.load(systems.ring())


@pytest.fixture(scope="module")
def tracker() -> System:
    return System.load(systems.tracker())


def test_a_ring_of_lags_keeps_its_value_and_a_disturbed_one_has_its_closed_form(ring):
    steady = ring.run(algorithm="jacobi")
    assert (steady == 1.0).all().all() and list(steady.index) == [k / 10 for k in range(11)]
    disturbed = System.load(systems.ring(), variant="one").run(algorithm="jacobi", stop=0.5)
    assert disturbed["m0.y"].to_numpy() == pytest.approx([0.9**k for k in range(6)], rel=1e-14)


def test_both_engines_return_the_same_bits(tracker):
    for algorithm in ("jacobi", "gauss_seidel"):
        arguments = {"algorithm": algorithm, "seed": 3, "faults": "stuck", "record": ["sensor", "estimator", "lag"]}
        a, b = tracker.run(**arguments), tracker.run(**arguments, engine="reference")
        pandas.testing.assert_frame_equal(a, b, check_exact=True)


def test_the_recording_has_time_units_types_and_where_it_comes_from(tracker):
    frame = tracker.run(record=["sensor.reading", "estimator.reading.lost"], seed=5)
    assert frame.index.name == "time" and frame.index[-1] == 20.0
    assert frame.attrs["units"]["sensor.reading.length"] == "m"
    assert frame["sensor.reading.valid"].dtype == bool and frame["sensor.reading.sequence"].dtype == np.int64
    about = frame.attrs["provenance"]
    assert about["seed"] == 5 and about["step"] == 0.1 and set(about["fmus"]) == {"truth", "lag", "sensor", "estimator"}
    assert about["versions"]["python"] == sys.version.split()[0]


def test_a_seed_repeats_a_run_and_another_one_does_not(tracker):
    a, b, c = (tracker.run(seed=seed, record=["sensor.reading.length"]) for seed in (1, 1, 2))
    assert a.equals(b) and not a.equals(c)


def test_a_parameter_given_for_a_component_wins_over_the_seed_of_the_run(tracker):
    a = tracker.run(seed=9, parameters={"sensor.seed": 1}, record=["sensor.reading.length"])
    assert a.equals(tracker.run(seed=1, record=["sensor.reading.length"]))


def test_parameters_take_display_units(tracker):
    feet = tracker.run(parameters={"truth.amplitude": "100 ft"}, record=["truth.y"])
    metres = tracker.run(parameters={"truth.amplitude": 30.48}, record=["truth.y"])
    np.testing.assert_allclose(feet.to_numpy(), metres.to_numpy(), rtol=1e-15)


def test_a_fault_shows_in_the_recording_beside_the_true_value(tracker):
    signals = ["sensor.reading.length", "sensor.reading.length@true"]
    frame = tracker.run(faults="stuck", record=signals, seed=1)
    during = (frame.index >= 5.0) & (frame.index < 10.0)
    assert (frame.loc[during, signals[0]] == 3.0).all()
    healthy = tracker.run(record=signals[:1], seed=1)
    assert frame[signals[1]].equals(healthy[signals[0]].rename(signals[1]))
    assert frame.loc[~during, signals[0]].equals(healthy.loc[~during, signals[0]])


def test_faults_can_be_given_as_objects(tracker):
    faults = [Fault("F", "lag.bias", "input", start=2.0, parameters={"value": 1.0})]
    difference = tracker.run(faults=faults, record=["lag.y"]) - tracker.run(record=["lag.y"])
    expected = 1 - 0.9 ** np.arange(0, 181)
    np.testing.assert_allclose(difference["lag.y"].to_numpy()[20:], expected, atol=1e-12)


def test_a_system_can_be_run_by_many_threads_at_once(tracker):
    expected = {seed: tracker.run(seed=seed) for seed in range(8)}
    with ThreadPoolExecutor(4) as pool:
        for seed, frame in zip(range(8), pool.map(lambda s: tracker.run(seed=s), range(8)), strict=True):
            assert frame.equals(expected[seed])


def test_a_single_fmu_is_a_system():
    system = System.load(systems.fmus() / "source.fmu")
    frame = system.run(stop=1.0, step=0.01, record=["source.y"])
    assert frame["source.y"].to_numpy() == pytest.approx(10 * np.sin(frame.index.to_numpy()), abs=1e-12)


def test_a_long_run_is_recorded_more_rarely(tracker):
    frame = tracker.run(stop=2000.0, step=0.1)
    assert len(frame) == 2001 and frame.index[1] == 1.0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"stop": 0}, "stop time must be a positive number"),
        ({"stop": -1}, "stop time must be a positive number"),
        ({"seed": "1"}, "the seed is '1', expected a whole number"),
        ({"seed": 1.5}, "the seed is 1.5, expected a whole number"),
        ({"algorithm": None}, "unknown algorithm 'None'"),
        ({"step": 0}, "step must be a positive number"),
        ({"step": float("nan")}, "step must be a positive number"),
        ({"stop": 1.05}, "is not a multiple of the step"),
        ({"algorithm": "jakobi"}, "did you mean 'jacobi'"),
        ({"engine": "compild"}, "did you mean 'compiled'"),
        ({"record": ["sensr.reading"]}, "no component 'sensr'; did you mean 'sensor'"),
        ({"record": ["sensor.readin.length"]}, "did you mean 'reading.length'"),
        ({"record_period": 0.15}, "recording period 0.15 s is not a multiple"),
        ({"parameters": {"sensr.sigma": 1}}, "no component 'sensr'; did you mean 'sensor'"),
        ({"parameters": {"sensor.sigmo": 1}}, "no parameter 'sigmo'; did you mean 'sigma'"),
        ({"parameters": {"sensor.sigma": -1}}, "is out of range: expected at least 0 m"),
        ({"parameters": {"sensor.sigma": "1 s"}}, "'s' cannot be converted to 'm'"),
        ({"parameters": {"sensor.sigma": "one"}}, "expected a number"),
        ({"seed": -1}, "the seed is -1, expected a whole number"),
        ({"faults": "nothing.toml"}, "nothing.toml"),
        ({"faults": [Fault("F", "sensor.reading.valid", "bias", parameters={"value": 1.0})]}, "acts on Real outputs"),
        ({"faults": [Fault("F", "lag.u", "input", parameters={"value": 1.0})]}, "is a connected input"),
    ],
)
def test_a_wrong_argument_is_answered_by_a_sentence(tracker, arguments, sentence):
    with pytest.raises(NavfmuError) as error:
        tracker.run(**arguments)
    assert sentence in str(error.value)


def test_importing_the_package_is_cheap():
    script = "import sys, navfmu; print([m for m in ('numpy', 'pandas', 'fmpy', 'lxml', 'click') if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert out.strip() == "[]"


def test_faults_from_several_files_act_together(tracker, tmp_path):
    file = tmp_path / "more.toml"
    file.write_text('[[fault]]\nid = "F2"\ntarget = "lag.y"\ntype = "bias"\nvalue = 1.0\n')
    frame = tracker.run(faults=["stuck", file], record=["lag.y", "lag.y@true", "sensor.reading.length"])
    assert (frame["lag.y"] - frame["lag.y@true"]).to_numpy() == pytest.approx(1.0)
    assert frame.loc[7.0, "sensor.reading.length"] == 3.0
    assert [fault["id"] for fault in frame.attrs["provenance"]["faults"]] == ["F1", "F2"]
    with pytest.raises(NavfmuError, match="two faults have the id 'F1'"):
        tracker.run(faults=["stuck", "stuck"])
