"""``repeat``: with floats, traced and compiled the same bits, whatever the count; and what it is not for."""

import numpy as np
import pytest

from evidence.compiled import compiled, traced
from navfmu.derivatives import jacobian
from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, Table, every
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.printing.printer import c_function, c_helpers
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin
from navfmu.repetition import repeat
from navfmu.repetition.repeat import masked
from tests.export.components import Iterating, nearer
from tests.export.slave import OK, Slave, Unzipped

COUNTS = (0, 1, 2, 5, 8, 9, 100, -3)


def applied(function, value, count, most):
    """The oracle, which is a loop over range."""
    for _ in range(max(0, min(count, most))):
        value = function(value)
    return value


# --- functions of a count and of arrays; each as repeat and as the oracle does it ---


def newton(loop, count, a):
    """A square root; the body reads what does not change, ``a``, and its logarithm is calculated before the loop."""
    return loop(lambda x: 0.5 * (x + a / x) + 0.0 * np.log(a), a, count, 8)


def rotation(loop, count, a, b):
    """A vector, and a number that is whole at first and then is not."""

    def turn(state):
        x, n = state
        return np.array([0.8 * x[0] - 0.6 * x[1], 0.6 * x[0] + 0.8 * x[1]]) + b, n + 1.5

    x, n = loop(turn, (np.array([a, a + 1.0]), 0), count, 8)
    return np.array([*x, n])


def mixture(loop, count, a, b):
    """Truth values, whole numbers and real ones in nested tuples."""

    def step(state):
        (up, n), x = state
        x = np.where(up, x * a, x - b)
        return (np.logical_not(up), n + 2), x

    (up, n), x = loop(step, ((a > b, 1), 1.0), count, 8)
    return np.array([up + 0.0, n, x])


def nested(loop, count, a, b):
    """A loop in a loop, whose count changes from one pass to the next."""

    def outer(state):
        x, n = state
        x = loop(lambda y: y * a + x + b, 1.0, n, 4)
        return x, n + 1

    x, n = loop(outer, (0.5, 0), count, 5)
    return np.array([x, n])


def large(loop, count, a, b):
    """Arrays that are kept whole: products, sums, pieces, what does not change among them."""
    A = np.reshape(np.arange(144.0), (12, 12)) / 500.0 + a * np.eye(12)
    still = np.sum(A * A, axis=1) + b

    def step(P):
        Q = A @ P @ A.T + np.diag(still)
        return Q / (1.0 + np.sum(Q * Q)) + np.concatenate([P[6:], P[:6]])

    return loop(step, np.eye(12), count, 7)


def alone(loop, count, a):
    """What is returned does not depend on what is given."""
    return loop(lambda x: a + 0.0 * a, -1.0, count, 3)


FUNCTIONS = {f.__name__: f for f in (newton, rotation, mixture, nested, large, alone)}
GIVEN = {1: [(2.0,), (0.3,), (1e200,)], 2: [(2.0, 0.25), (-0.3, 3.0), (0.9, -1.0)]}


@pytest.fixture(scope="module")
def made():
    """Every function compiled, with single numbers and with arrays kept whole."""
    cases = []
    for function in FUNCTIONS.values():
        arguments = GIVEN[function.__code__.co_argcount - 2][0]
        cases.append(((lambda *a, f=function: f(repeat, *a)), (np.int64(1), *arguments)))
    singles, whole = compiled(cases), compiled(cases, whole=8)
    return {name: both for name, *both in zip(FUNCTIONS, singles, whole, strict=True)}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("count", COUNTS)
def test_the_same_bits_as_a_loop_over_range(name, count, made):
    """Products are summed in their own order where arrays are kept whole, so ``large`` has a bound: 12 terms."""
    function = FUNCTIONS[name]
    for arguments in GIVEN[function.__code__.co_argcount - 2]:
        with np.errstate(all="ignore"):
            expected = np.asarray(function(applied, count, *arguments), float)
            assert np.array_equal(np.asarray(function(repeat, count, *arguments), float), expected, equal_nan=True)
            for form in made[name]:
                found = form(count, *arguments)
                if name == "large":
                    assert np.allclose(found, expected, rtol=1e-12, atol=0)
                else:
                    assert np.array_equal(found, expected, equal_nan=True), (form.nodes, found, expected)


def test_a_count_that_is_no_number_is_none(made):
    assert made["newton"][0](np.nan, 3.0) == 3.0
    assert repeat(lambda x: x + 1, 3.0, np.nan, 4) == 3.0


def test_the_loop_is_left_when_the_count_is_reached_and_holds_what_changes_only():
    """The text: one loop, whose condition has the count, and one logarithm, which is not in it."""
    form = traced(lambda n, a: newton(repeat, n, a), (np.int64(1), 2.0))
    (body,) = c_helpers(form.nodes)
    text = c_function("f", ["v"], form.nodes).text
    assert "i < 8 && i < v[0]" in text
    assert text.count("log(") == 1 and "log(" not in body


def test_what_is_done_at_most_once_is_calculated_only_if_it_is_done():
    """The text: the logarithm that does not change is in the body, that of before is not, and is not taken twice.
    What comes of it is that of floats, done or not."""

    def once(n, a):
        before = np.log(a)
        return repeat(lambda x: x + np.exp(a) + before, a, n, 1)

    form = traced(once, (np.int64(1), 2.0))
    (body,) = c_helpers(form.nodes)
    text = c_function("f", ["v"], form.nodes).text
    assert "exp(" in body and "log(" not in body
    assert "exp(" not in text and text.count("log(") == 1
    (native,) = compiled([(once, (np.int64(1), 2.0))])
    for n in (-1, 0, 1, 5):
        expected = 2.0 + np.exp(2.0) + np.log(2.0) if n > 0 else 2.0
        assert native(n, 2.0) == pytest.approx(expected, rel=1e-15)


def test_the_same_body_is_one_function():
    def twice(n, a):
        first = repeat(lambda x: x * a + 1.0, 1.0, n, 4)
        return repeat(lambda x: x * a + 1.0, first, n, 6)

    form = traced(twice, (np.int64(1), 2.0))
    assert len(c_helpers(form.nodes)) == 1


@pytest.mark.parametrize("count", [0, 1, 3])
def test_derivatives_go_through(count):
    """With respect to what changes, and to what does not; against those of the loop over range."""

    def end(loop, x, n):
        return loop(lambda y: np.array([y[0] * x[1], np.sin(y[1]) + x[0]]), x, n, 4)

    x = np.array([0.7, 1.3])
    expected = jacobian(lambda x: end(applied, x, count), x)
    assert np.array_equal(jacobian(lambda x: end(repeat, x, count), x), expected)
    (form,) = compiled([(lambda n, x: jacobian(lambda x: end(repeat, x, n), x), (np.int64(1), x))])
    assert np.array_equal(form(count, x), expected)


def test_selecting_gives_the_same_as_leaving():
    for count in COUNTS:
        left = repeat(lambda x: np.sqrt(x + 1.0), 3.0, count, 8)
        assert masked(lambda x: np.sqrt(x + 1.0), 3.0, count, 8) == left


WRONG = {
    "most is a value": (
        lambda n: repeat(lambda x: x, 1.0, n, n),
        "most=a value); expected a whole number of at least 1",
    ),
    "most is none": (lambda n: repeat(lambda x: x, 1.0, n, 0), "most=0); expected a whole number of at least 1"),
    "a vector of counts": (lambda n: repeat(lambda x: x, 1.0, np.array([n, n]), 3), "a count of shape (2,)"),
    "no function": (lambda n: repeat(1.0, 1.0, n, 3), "repeat(1.0, ...); expected a function of one value"),
    "another shape": (
        lambda n: repeat(lambda x: np.array([x, x]), 1.0, n, 3),
        "the function of repeat returns shape (2,) for shape (); return what is like the value that it is given",
    ),
    "nothing": (lambda n: repeat(lambda x: None, 1.0, n, 3), "the function of repeat returns None for shape ()"),
    "fewer": (lambda n: repeat(lambda x: x[0], (1.0, n), n, 3), "returns shape () for (shape (), shape ())"),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("form", ["floats", "traced"])
def test_wrong_use_is_a_sentence(name, form):
    function, sentence = WRONG[name]
    if (name, form) == ("most is a value", "floats"):
        return  # it is a number there
    with pytest.raises(NavfmuError) as refused:
        function(2) if form == "floats" else traced(function, (np.int64(1),))
    assert "test_repeat.py, line " in str(refused.value) and sentence in str(refused.value)


def test_range_of_a_value_says_what_to_write():
    with pytest.raises(NavfmuError, match=r"or loop with navfmu\.repetition\.repeat"):
        traced(lambda n: [0 for _ in range(n)], (np.int64(1),))


# --- in a component ---


def _component(task, **members):
    period = Parameter("s", start=0.1)
    members = {"n": Parameter(kind="integer", start=2, min=0, max=4), "y": Output("1"), **members}
    return type("Made", (Component,), {"__doc__": "Made.", "T": period, "step": every("T")(task), **members})


def _assigns(self):
    def body(x):
        self.y = x
        return x

    self.y = repeat(body, 1.0, self.n, 4)


def _fills(self):
    seen = np.zeros(4)

    def body(x):
        seen[1] = x
        return x + 1.0

    self.y = repeat(body, 1.0, self.n, 4) + seen[1]


def _draws(self, noise):
    self.y = repeat(lambda x: x + noise(1)[0], 1.0, self.n, 4)


@pytest.mark.parametrize(
    ("task", "sentence"),
    [
        (_assigns, "'y' is assigned in the function of repeat; let it return what it calculates"),
        (_draws, "noise is drawn in the function of repeat; let it return what it calculates"),
    ],
)
def test_a_body_only_calculates(task, sentence):
    made = _component(task)
    run = Interpreter(made)
    run.setup()
    for call in (lambda: lower(made), lambda: run.do_step(0.0, 0.1)):
        with pytest.raises(NavfmuError) as refused:
            call()
        assert sentence in str(refused.value)


@pytest.fixture(scope="module")
def iterating(tmp_path_factory):
    """Native and as a twin."""
    folder = tmp_path_factory.mktemp("iterating")
    (path,) = build([Iterating], folder, pictures=False)
    (folder / "python").mkdir()
    twin = build_twin(Iterating, folder / "python")
    return Unzipped(path, folder / "native"), Unzipped(twin, folder / "twin")


@pytest.mark.parametrize("count", range(9))
def test_a_parameter_counts_the_passes_in_every_form(count, iterating):
    """Against Newton's method written out; the count changes while it runs."""
    expected = np.array([1.0, 4.0, 9.0])
    for _ in range(count):
        expected = nearer(expected, np.array([1.0, 4.0, 9.0]))
    floats = Interpreter(Iterating)
    floats.setup()
    floats.do_step(0.0, 0.1)
    floats.set("iterations", count)
    floats.do_step(0.1, 0.1)
    assert np.array_equal(floats.get("root"), expected) and floats.get("steps") == count
    for fmu in iterating:
        slave = Slave(fmu)
        slave.initialise()
        assert slave.step(0.0, 0.1) == OK
        slave.set("iterations", count)
        assert slave.step(0.1, 0.1) == OK
        assert slave.get("root") == expected.tolist() and slave.get("steps") == count
        slave.free()


def test_a_table_is_searched_in_a_loop(tmp_path):
    """Where a ray meets the ground; natively the loop's function is given the tables."""

    class Ray(Component):
        """Goes down from 1000 m until it is a metre above ground."""

        passes = Parameter(kind="integer", start=9, min=0, max=40, description="passes of the search")
        sample_period = Parameter("s", start=0.1, description="sampling period")
        ground = Table(
            columns=(("distance", "m"), ("height", "m")),
            rows=[[0.0, 0.0], [500.0, 200.0], [1000.0, 600.0], [2e3, 900.0]],
        )
        distance = Output("m", description="where the ray is low")

        @every("sample_period")
        def search(self):
            def nearer(x):
                return x + 0.4 * (1000.0 - 0.3 * x - self.ground.around(distance=x).linear()[1])

            self.distance = repeat(nearer, 10.0, self.passes, 40)

    (path,) = build([Ray], tmp_path, pictures=False)
    fmu = Unzipped(path, tmp_path / "ray")
    assert "Table *tables" in c_helpers(lower(Ray).tasks[0].values)[-1], "in the function of the loop"
    for count in (0, 1, 9, 40):
        expected = 10.0
        for _ in range(count):
            height = np.interp(expected, [0.0, 500.0, 1000.0, 2000.0], [0.0, 200.0, 600.0, 900.0])
            expected = expected + 0.4 * (1000.0 - 0.3 * expected - height)
        native, floats = Slave(fmu), Interpreter(Ray)
        native.initialise(passes=count)
        floats.set("passes", count)
        floats.setup()
        floats.do_step(0.0, 0.1)
        assert native.step(0.0, 0.1) == OK
        assert native.get("distance") == floats.get("distance")
        assert np.isclose(floats.get("distance"), expected, rtol=1e-12)
        native.free()


def test_a_body_that_fills_an_array_of_others_is_refused_when_it_is_built():
    with pytest.raises(NavfmuError) as refused:
        lower(_component(_fills))
    sentence = "or of repeat, leaves what it calculates in an array or a list outside of it; let it return what it calc"
    assert "test_repeat.py, line " in str(refused.value) and sentence in str(refused.value)
