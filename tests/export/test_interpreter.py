"""The interpreter: when tasks run, what they see, and what is said when something is refused."""

import json
import subprocess
import sys

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.export import Bundle, Component, Input, Output, Parameter, every, on_new
from navfmu.export.interpreter import Interpreter
from navfmu.export.noise import Normals

from .components import Listener, Sensor, Source, TwoRates


def running(component, **values):
    run = Interpreter(component)
    for name, value in values.items():
        run.set(name, value)
    run.setup()
    return run


def advance(run, h, stop, each=None):
    for k in range(round(stop / h)):
        if each:
            each(k * h)
        run.do_step(k * h, h)


@pytest.mark.parametrize("h", [0.01, 0.05, 0.1, 0.25, 1.0, 3.0])
def test_a_component_samples_at_its_own_period_whatever_the_step(h):
    reference = running(Sensor, u=[1.0, 2.0])
    advance(reference, 0.1, 3.0)
    run = running(Sensor, u=[1.0, 2.0])
    advance(run, h, 3.0)
    assert run.get("reading.sequence") == 30
    assert run.get("reading.time_of_validity") == 30 * 0.1
    np.testing.assert_array_equal(run.get("reading.s"), reference.get("reading.s"))


def test_noise_is_keyed_by_seed_and_stream_and_counted_by_sample():
    run = running(Sensor, seed=5, stream=9, sigma=0.1)
    bias = 0.1 * Normals(5, 9, 0, 0)(2)
    np.testing.assert_array_equal(run.get("bias"), bias)
    advance(run, 0.1, 0.3)
    np.testing.assert_array_equal(run.get("reading.s"), bias + 0.1 * Normals(5, 9, 3, 1)(2))


def test_sensor_shows_start_values_until_its_first_sample():
    run = running(Sensor, u=[1.0, 2.0])
    run.do_step(0.0, 0.09)
    assert (run.get("reading.valid"), run.get("reading.sequence")) == (False, 0)
    np.testing.assert_array_equal(run.get("reading.s"), [0.0, 0.0])
    run.do_step(0.09, 0.01)
    assert (run.get("reading.valid"), run.get("reading.sequence")) == (True, 1)


def test_publish_when_keeps_everything_otherwise():
    run = running(Sensor, u=[1.0, 2.0])
    run.do_step(0.0, 0.2)
    before = (run.get("reading.s").tolist(), run.get("reading.sequence"), run.get("reading.time_of_validity"))
    run.set("broken", True)
    run.do_step(0.2, 0.5)
    assert before == (run.get("reading.s").tolist(), run.get("reading.sequence"), run.get("reading.time_of_validity"))
    run.set("broken", False)
    run.do_step(0.7, 0.1)
    assert run.get("reading.sequence") == 3


class Numbered(Component):
    """Tells numbers of its own: two samples at each tick, of which the second is seen; of two bundles, one apart."""

    period_ = Parameter("s", start=0.1, description="period")
    told = Bundle(count=Output("1"))
    pair = Bundle(2, count=Output("1"))

    @every("period_")
    def tell(self):
        number = self.told.sequence + 2
        self.told.publish(count=1.0 * number, sequence=number)
        self.pair.publish(count=np.array([1.0, 2.0]), sequence=np.array([1, 10]) * number)


class Counting(Component):
    """Waits for samples, and counts those that it has not seen."""

    period_ = Parameter("s", start=0.1, description="period")
    seen = Bundle(count=Input("1"))
    total = Output(kind="integer")

    @on_new("seen")
    def take(self):
        self.total = self.total + 1

    @every("period_")
    def pass_time(self):
        self.total = self.total + 0


def test_a_number_that_is_published_says_what_was_lost():
    """Fails for a number that is counted up by one, that is one for all bundles, or that moves without being told."""
    run, other = running(Numbered), running(Counting)
    for k in range(5):
        run.do_step(0.1 * k, 0.1)
        for name in ("sequence", "count", "valid"):
            other.set(f"seen.{name}", run.get(f"told.{name}"))
        other.do_step(0.1 * k, 0.1)
    assert (run.get("told.sequence"), run.get("told.count")) == (10, 10.0)
    assert [run.get(f"pair[{i}].sequence") for i in (1, 2)] == [10, 100]
    assert (other.get("total"), other.get("seen.lost")) == (5, 5)


def test_two_clocks_tick_together_and_tasks_run_in_order():
    run = running(TwoRates)
    advance(run, 0.05, 0.9)
    np.testing.assert_array_equal(run.get("count"), [9, 3])
    assert run.get("slow_sees") == 9
    np.testing.assert_allclose(run.get("times"), [0.9, 0.9], rtol=1e-15)
    np.testing.assert_array_equal(run.get("periods"), [0.1, 0.3])


def test_ticks_neither_drift_nor_get_lost_in_a_long_run():
    run = running(TwoRates, fast=0.01, slow=0.07)
    time = 0.0
    for _ in range(700):
        run.do_step(time, 0.013)
        time += 0.013
    np.testing.assert_array_equal(run.get("count"), [910, 130])


def announce(run, sequence, s=(1.0, 2.0), at=0.0, valid=True):
    run.set("reading.s", s)
    run.set("reading.sequence", sequence)
    run.set("reading.time_of_validity", at)
    run.set("reading.valid", valid)


def test_new_data_is_used_once():
    run = running(Listener)
    announce(run, 1)
    advance(run, 0.1, 1.0)
    assert (run.get("updates"), run.get("seen_at")) == (1, 0.1)
    np.testing.assert_array_equal(run.get("held"), [1.0, 2.0])
    announce(run, 2, valid=False)
    run.do_step(1.0, 0.1)
    assert run.get("updates") == 2
    np.testing.assert_array_equal(run.get("held"), [1.0, 2.0])


def test_new_data_waits_for_its_time_of_validity():
    run = running(Listener)
    announce(run, 1, at=0.35)
    run.do_step(0.0, 0.3)
    assert run.get("updates") == 0
    run.do_step(0.3, 0.3)
    assert (run.get("updates"), run.get("seen_at")) == (1, 0.4)


def test_a_jump_of_the_sequence_is_counted_as_lost():
    run = running(Listener)
    announce(run, 1)
    run.do_step(0.0, 0.1)
    announce(run, 5)
    run.do_step(0.1, 0.1)
    assert (run.get("updates"), run.get("reading.lost")) == (2, 3)
    assert "3 samples of 'reading.sequence' were lost" in run.events[0]
    announce(run, 1)  # the sensor was restarted
    run.do_step(0.2, 0.1)
    assert (run.get("updates"), run.get("reading.lost")) == (3, 3)


def test_inputs_are_interpolated_at_ticks_and_only_over_the_coming_step():
    run = running(TwoRates)
    run.set("u", 10.0)
    run.set_derivatives([run.layout.index("u")], [1], [2.0])
    run.do_step(0.0, 0.25)
    assert run.get("sampled") == 10.0 + 2.0 * 0.2
    assert run.get("u") == 10.0
    run.do_step(0.25, 0.1)
    assert run.get("sampled") == 10.0
    run.set_derivatives([run.layout.index("u")], [1], [2.0])
    run.set("u", 20.0)
    run.do_step(0.35, 0.1)
    assert run.get("sampled") == 20.0 + 2.0 * (0.4 - 0.35), "the derivative holds, also when the value comes after it"


def test_sources_show_calculated_outputs_during_initialisation():
    run = Interpreter(Source)
    run.set("offset", 1.0)
    run.enter_initialization()
    assert run.get("x") == 1.0
    run.set("offset", 2.0)
    assert run.get("x") == 2.0
    run.exit_initialization()
    assert run.get("x") == 2.0


def test_tables_are_searched_by_time_and_clamped_at_both_ends():
    run = running(Source, offset=0.0)
    seen = {}
    for k in range(80):
        run.do_step(k * 0.05, 0.05)
        seen[k + 1] = run.get("x")
    np.testing.assert_allclose(
        [seen[10], seen[20], seen[30], seen[60], seen[80]], [1.0, 2.0, 1.5, 0.0, 0.0], atol=1e-12
    )
    table = Source.layout.tables[0]
    assert [table.find(0, t) for t in (-1.0, 0.0, 0.99, 1.0, 2.9, 3.0, 99.0)] == [0, 0, 0, 1, 1, 1, 1]


def test_ticks_count_from_the_start_time():
    run = Interpreter(TwoRates)
    run.setup(start=100.0)
    run.do_step(100.0, 0.3)
    np.testing.assert_allclose(run.get("times"), [100.3, 100.3], rtol=1e-15)
    np.testing.assert_array_equal(run.get("count"), [3, 1])


def test_restored_state_repeats_to_the_last_bit_also_from_json():
    run = running(Sensor, u=[1.0, 2.0])
    advance(run, 0.03, 0.33)
    saved = run.get_state()
    text = json.dumps(saved)

    def go(run):
        seen = []
        for k in range(20):
            run.set("u", [np.sin(k), 1.0])
            run.do_step(0.33 + k * 0.03, 0.03)
            seen.append([*run.get("reading.s"), run.get("reading.sequence")])
        return seen

    first = go(run)
    run.set_state(saved)
    assert go(run) == first
    other = Interpreter(Sensor)
    other.set_state(json.loads(text))
    assert go(other) == first


def test_hidden_state_is_saved_too():
    run = running(Listener)
    announce(run, 1)
    run.do_step(0.0, 0.1)
    saved = run.get_state()
    run.do_step(0.1, 0.1)
    run.set_state(saved)
    run.do_step(0.1, 0.1)
    assert run.get("updates") == 1
    with pytest.raises(NavfmuError, match="not a saved state of this build of 'sensor'"):
        Interpreter(Sensor).set_state(saved)


def test_reset_returns_to_the_start():
    run = running(Sensor, u=[1.0, 2.0])
    run.do_step(0.0, 0.5)
    first = run.get("reading.s")
    run.reset()
    assert run.get("reading.sequence") == 0
    run.set("u", [1.0, 2.0])
    run.setup()
    run.do_step(0.0, 0.5)
    np.testing.assert_array_equal(run.get("reading.s"), first)


def test_values_by_name_element_and_reference():
    run = Interpreter(Sensor)
    run.set("u[2]", 7.0)
    run.set(0, 3.0)
    np.testing.assert_array_equal(run.get("u"), [3.0, 7.0])
    assert run.get(1) == 7.0
    assert run.get("reading.valid") is False
    assert isinstance(run.get("reading.sequence"), int)


PARAMETERS = {
    "below the minimum": ({"sigma": -1.0}, "Parameter 'sigma' is -1 m; expected a value from 0 to 10 m."),
    "only a minimum": (
        {"sample_period": 0.0},
        "Parameter 'sample_period' is 0 s; expected a value of at least 0.001 s.",
    ),
    "no unit": ({"gain": 0.1}, "Parameter 'gain' is 0.1; expected a value of at least 0.5."),
    "not a number": ({"sigma": np.nan}, "Parameter 'sigma' is nan m; expected a value from 0 to 10 m."),
    "both": (
        {"sigma": 11.0, "seed": -1},
        "Parameter 'sigma' is 11 m; expected a value from 0 to 10 m. "
        "Parameter 'seed' is -1; expected a value of at least 0.",
    ),
    "requirement": ({"sigma": 0.5}, "sigma 0.5 m must be below a tenth of gain 1"),
}


@pytest.mark.parametrize("name", PARAMETERS)
def test_wrong_parameters_end_initialisation_with_a_sentence(name):
    values, sentence = PARAMETERS[name]
    with pytest.raises(NavfmuError) as caught:
        running(Sensor, **values)
    assert str(caught.value) == sentence


def test_what_cannot_be_set_now_is_refused():
    run = running(Sensor)
    run.set("gain", 2.0)
    for name, value, part in (
        ("sigma", 0.1, "fixed once initialisation has ended"),
        ("bias", 0.0, "calculated"),
        ("gain", 0.1, "at least 0.5"),
        ("sigmma", 0.1, "did you mean 'sigma'?"),
        (99, 0.1, "value reference 99"),
    ):
        with pytest.raises(NavfmuError) as caught:
            run.set(name, value)
        assert part in str(caught.value)
    with pytest.raises(NavfmuError, match="continuous Real input"):
        run.set_derivatives([run.layout.index("gain")], [1], [1.0])
    run.terminate()
    with pytest.raises(NavfmuError, match="after fmi2Terminate"):
        run.set("gain", 1.0)


def test_impossible_steps_are_refused():
    run = Interpreter(Sensor)
    with pytest.raises(NavfmuError, match="before initialisation"):
        run.do_step(0.0, 0.1)
    run.setup(stop=1.0)
    for t, h, part in (
        (0.0, -0.1, "positive"),
        (0.0, 0.0, "positive"),
        (0.5, 0.1, "at 0 s"),
        (0.0, np.inf, "positive"),
        (0.0, 2.0, "ends at 1 s"),
    ):
        with pytest.raises(NavfmuError) as caught:
            run.do_step(t, h)
        assert part in str(caught.value)
    with pytest.raises(NavfmuError, match="interval of time"):
        Interpreter(Sensor).setup(start=1.0, stop=0.0)


def test_an_integer_takes_whole_numbers_only():
    class Counter(Component):
        """Counts in halves."""

        T = Parameter("s", start=1.0)
        n = Output(kind="integer")

        @every("T")
        def step(self):
            self.n = self.n + 0.5

    with pytest.raises(NavfmuError, match=r"'n' is an Integer and is assigned 0\.5") as told:
        running(Counter).do_step(0.0, 1.0)
    assert str(told.value).startswith(f"{__file__}, line "), "the model's line, not the interpreter's"


def test_a_component_with_rates_and_new_data_does_both_in_order():
    class Filter(Component):
        """Predicts at its own rate, corrects on new data."""

        fix = Bundle(x=Input("m"))
        T = Parameter("s", start=0.1)
        x = Output("m")

        @every("T")
        def predict(self):
            self.x = self.x + self.period

        @on_new("fix")
        def correct(self):
            self.x = self.fix.x

    run = running(Filter)
    run.do_step(0.0, 0.2)
    assert run.get("x") == pytest.approx(0.2)
    run.set("fix.x", 5.0)
    run.set("fix.sequence", 1)
    run.do_step(0.2, 0.1)
    assert run.get("x") == 5.0
    run.do_step(0.3, 0.1)
    assert run.get("x") == pytest.approx(5.1)


def test_running_with_floats_needs_numpy_alone():
    code = (
        "import sys; import tests.export.components as c; from navfmu.export.interpreter import Interpreter;"
        "r = Interpreter(c.Sensor); r.setup(); r.do_step(0.0, 1.0);"
        "print(sorted({'ziglang', 'pandas', 'fmpy', 'scipy'} & set(sys.modules)))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (run.stdout.strip(), run.stderr) == ("[]", "")
