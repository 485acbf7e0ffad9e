"""Both algorithms and both engines against closed forms. Every run here is made by both engines and compared bitwise.

The lag is one explicit step of y' = (u - y) / tau with tau = 1 s, so at h = 0.1 s: y <- 0.9 y + 0.1 u.
"""

import numpy as np
import pytest

from navfmu.engine import compiled
from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from tests.engine.probe import chain, probe, ring, rows, run_both, simulate

ALGORITHMS = ["jacobi", "gauss_seidel"]
H = {"step": 0.1, "stop": 10.0}


def test_a_ring_of_lags_at_one_stays_at_one():
    for algorithm in ALGORITHMS:
        assert np.all(simulate(ring(), algorithm=algorithm, record=["*.y"], **H).values == 1.0)


def test_a_lag_decays_by_a_factor_of_nine_tenths_per_step():
    for algorithm in ALGORITHMS:
        recording = simulate(chain(1, start=1.0), algorithm=algorithm, record=["lag0.y"], **H)
        np.testing.assert_allclose(recording["lag0.y"], 0.9 ** np.arange(101), rtol=1e-13)


def test_ten_steps_of_a_tenth_end_at_one_second():
    recording = simulate(chain(1, start=1.0), step=0.1, stop=1.0, record=["lag0.y", "lag0.time"])
    assert len(recording.time) == 11
    assert recording.time[-1] == 1.0
    assert recording["lag0.y"][-1] == pytest.approx(0.3486784401, abs=1e-15)
    assert recording["lag0.time"][-1] == 1.0


def test_jacobi_delays_every_hop_by_one_step():
    recording = simulate(chain(3, start=1.0), algorithm="jacobi", record=["*.y", "*.seen"], **H)
    k = rows(recording)
    np.testing.assert_allclose(recording["lag1.y"], k * 0.1 * 0.9 ** (k - 1.0), rtol=1e-12)
    np.testing.assert_allclose(recording["lag2.y"], k * (k - 1) / 2 * 0.01 * 0.9 ** (k - 2.0), rtol=1e-12)
    assert np.array_equal(recording["lag1.seen"][1:], recording["lag0.y"][:-1])


def test_gauss_seidel_gives_an_interpolating_component_the_straight_line_between_the_points():
    recording = simulate(chain(2, start=1.0, interpolates=True), record=["*.y", "lag1.seen", "lag1.slope"], **H)
    k = rows(recording)
    np.testing.assert_allclose(recording["lag1.y"], k * 0.095 * 0.9 ** (k - 1.0), rtol=1e-12)
    np.testing.assert_allclose(recording["lag1.seen"], recording["lag0.y"], rtol=1e-15)
    np.testing.assert_allclose(recording["lag1.slope"][1:], np.diff(recording["lag0.y"]) / 0.1, rtol=1e-12)


def test_gauss_seidel_gives_other_components_the_newest_value():
    recording = simulate(chain(2, start=1.0), record=["*.y", "lag1.seen", "lag1.slope"], **H)
    k = rows(recording)
    np.testing.assert_allclose(recording["lag1.y"], k * 0.09 * 0.9 ** (k - 1.0), rtol=1e-12)
    assert np.array_equal(recording["lag1.seen"], recording["lag0.y"])
    assert not recording["lag1.slope"].any()


def test_the_order_of_the_description_does_not_matter_without_cycles():
    lags, connections = chain(4, start=1.0, interpolates=True)
    forwards = simulate((lags, connections), record=["*.y"], **H)
    backwards = simulate((lags[::-1], connections[::-1]), record=["*.y"], **H)
    for name in forwards.names:
        assert forwards[name].tobytes() == backwards[name].tobytes()


def test_discrete_values_are_the_newest_in_gauss_seidel_and_one_step_old_in_jacobi():
    system = (
        [probe("a"), probe("b")],
        [Link("a.data.sequence", "b.number"), Link("a.data.valid", "b.flag")],
    )
    newest = simulate(system, record=["b.echo", "b.flag_echo", "a.data"], **H)
    assert np.array_equal(newest["b.echo"], newest["a.data.sequence"])
    assert np.array_equal(newest["b.flag_echo"], newest["a.data.valid"])
    late = simulate(system, algorithm="jacobi", record=["b.echo", "a.data"], **H)
    assert np.array_equal(late["b.echo"][1:], late["a.data.sequence"][:-1])


def test_a_discrete_value_is_never_interpolated():
    system = ([probe("a"), probe("b", interpolates=True)], [Link("a.data.value", "b.u")])
    recording = simulate(system, record=["b.slope", "b.seen", "a.data.value"], **H)
    assert not recording["b.slope"].any()
    assert np.array_equal(recording["b.seen"], recording["a.data.value"])


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_start_values_are_right_at_the_first_exchange(algorithm):
    lags = [probe(f"lag{i}", start=float(i + 1)) for i in range(3)]
    connections = [Link(f"lag{i}.y", f"lag{(i + 1) % 3}.u") for i in range(3)]
    recording = simulate((lags, connections), algorithm=algorithm, record=["*.y", "*.current"], **H)
    assert [recording[f"lag{i}.y"][0] for i in range(3)] == [1.0, 2.0, 3.0]
    assert [recording[f"lag{i}.current"][0] for i in range(3)] == [103.0, 101.0, 102.0]
    assert recording["lag0.y"][1] == pytest.approx(0.9 * 1.0 + 0.1 * 3.0)


def test_outputs_computed_from_inputs_during_initialisation_reach_the_end_of_a_chain():
    lags = [probe("c"), probe("b"), probe("a", u=1.0)]  # against the direction of flow
    system = (lags, [Link("a.current", "b.u"), Link("b.current", "c.u")])
    for algorithm in ALGORITHMS:
        recording = simulate(system, algorithm=algorithm, record=["*.current"], **H)
        assert [recording[f"{name}.current"][0] for name in "abc"] == [101.0, 201.0, 301.0]


def test_a_cycle_is_cut_at_the_first_component_and_reported():
    plan = make_plan(*ring(3), step=0.1, stop=1.0)
    assert plan.cut == ("lag2.y -> lag0.u",)
    assert any("lag2.y -> lag0.u" in note for note in plan.notes)
    lags = [probe(f"lag{i}", start=float(i), interpolates=True) for i in range(3)]
    recording = simulate((lags, ring(3)[1]), record=["*.y", "lag0.seen", "lag0.slope"], **H)
    assert np.array_equal(recording["lag0.seen"][1:], recording["lag2.y"][:-1])
    assert not recording["lag0.slope"].any()


def test_connections_convert_units():
    system = (
        [probe("a", start=1.0), probe("b", interpolates=True)],
        [Link("a.y", "b.u", factor=9 / 5, offset=32.0)],
    )
    for algorithm in ALGORITHMS:
        recording = simulate(system, algorithm=algorithm, record=["a.y", "b.u", "b.seen", "b.current"], **H)
        assert np.array_equal(recording["b.u"], 9 / 5 * recording["a.y"] + 32.0)
        assert recording["b.current"][0] == 9 / 5 + 32 + 100
    np.testing.assert_allclose(recording["b.seen"], 9 / 5 * recording["a.y"] + 32.0, rtol=1e-14)


def test_a_plain_connection_keeps_every_bit():
    system = ([probe("a", start=-0.0), probe("b")], [Link("a.y", "b.u")])
    recording = simulate(system, record=["a.y", "b.u", "b.seen"], **H)
    assert recording.values[0].tobytes() == np.full(3, -0.0).tobytes()


def test_an_integer_may_feed_a_real():
    system = ([probe("a"), probe("b")], [Link("a.data.sequence", "b.u")])
    recording = simulate(system, record=["b.seen", "a.data.sequence"], **H)
    assert np.array_equal(recording["b.seen"], recording["a.data.sequence"])


def test_inputs_that_do_not_change_are_not_set_again():
    lags = [probe("a", start=1.0, u=1.0), probe("b")]  # a.y stays 1
    plan = make_plan(lags, [Link("a.y", "b.u"), Link("a.data.sequence", "b.number")], record=["b.sets"], **H)
    at_start, *later = compiled.run(plan)["b.sets"]
    assert later[-1] == at_start + 100  # the Integer alone, once in each step


def test_recording_at_a_longer_period_takes_every_nth_row():
    system = chain(2, start=1.0)
    every = simulate(system, record=["*.y"], **H)
    tenth = simulate(system, record=["*.y"], record_period=1.0, **H)
    assert np.array_equal(tenth.time, np.arange(11.0))
    assert np.array_equal(tenth.values, every.values[::10])
    fourth = simulate(system, record=["*.y"], record_period=0.4, step=0.1, stop=1.0)
    assert np.array_equal(fourth.time, [0.0, 0.4, 0.8])


def test_what_is_recorded_does_not_change_the_run():
    system = chain(3, start=1.0, interpolates=True)
    few = simulate(system, record=["lag2.y"], **H)
    many = simulate(system, record=["*", "lag0.tau", "lag1.u", "lag0.time", "lag0.number", "lag0.flag"], **H)
    assert few["lag2.y"].tobytes() == many["lag2.y"].tobytes()
    assert np.all(many["lag0.tau"] == 1.0)
    assert np.array_equal(many["lag1.u"], many["lag0.y"])


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("seed", range(6))
def test_random_systems_run_alike_in_both_engines(seed, algorithm):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 8))
    components = [
        probe(
            f"p{i}",
            interpolates=bool(rng.integers(2)),
            restores=bool(rng.integers(2)),
            start=float(rng.normal()),
            tau=float(rng.uniform(0.5, 3)),
            u=float(rng.normal()),
            number=int(rng.integers(100)),
            flag=bool(rng.integers(2)),
        )
        for i in range(count)
    ]
    sources = {"u": ["y", "seen", "data.value", "data.sequence"], "number": ["echo", "data.sequence"]}
    sources["flag"] = ["flag_echo", "data.valid"]
    connections = []
    for i in range(count):
        for target, names in sources.items():
            if rng.random() < 0.8:
                scale = {"factor": 0.5, "offset": -0.25} if target == "u" and rng.random() < 0.3 else {}
                source = f"p{rng.integers(count)}.{rng.choice(names)}"
                connections.append(Link(source, f"p{i}.{target}", **scale))
    plan = make_plan(components, connections, step=0.02, stop=2.0, algorithm=algorithm)
    recording = run_both(plan)
    assert np.isfinite(recording.values).all()
    assert np.ptp(recording.values, axis=0).any()
