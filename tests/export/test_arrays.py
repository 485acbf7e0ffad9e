"""Arrays that are kept whole: the same bits as single numbers and as NumPy, whoever prints the record."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from evidence import expressions
from evidence.compiled import compiled, linked, traced
from evidence.drawn import INPUTS, draw
from evidence.drawn import inputs as drawn_inputs
from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, State, every
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.printing.codegen import generate
from navfmu.export.printing.lanes import evaluator, numpy_source
from navfmu.export.printing.printer import c_function, c_helpers
from navfmu.export.record.graph import CALLS, Array, in_order
from navfmu.export.tracing import trace
from navfmu.export.tracing.extent import LARGE, Extent, extent, shortest
from navfmu.export.tracing.lower import lower
from navfmu.repetition import repeat

from .components import Wide

SEED = 3
ROOT = Path(__file__).parents[2]
RNG = np.random.default_rng(SEED)


def kinds(made) -> list[str]:
    """What is kept whole, in order."""
    return [node.op for node in in_order(made.nodes) if isinstance(node, Array)]


def same(a, b) -> bool:
    """Whether two arrays are the same to the bit, NaN with NaN."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    return np.array_equal(a, b, equal_nan=True) and np.array_equal(np.signbit(a[a == 0]), np.signbit(b[b == 0]))


@pytest.mark.parametrize("whole", [1, 4], ids=["all", "vectors"])
def test_drawn_expressions_are_the_same_when_arrays_are_kept_whole(whole, monkeypatch):
    monkeypatch.setattr("evidence.drawn.traced", lambda function, arguments: traced(function, arguments, whole))
    found = expressions.check(150, SEED)
    assert found.numbers > 10_000
    assert not found.differences, "\n\n".join([f"{len(found.differences)} differences", *found.differences[:5]])


def calls_the_library(made) -> bool:
    """Whether it contains functions that NumPy calculates otherwise for many numbers than for one."""
    return any(node.op in CALLS for node in in_order(made.nodes)) or any(
        node.op in CALLS
        for array in in_order(made.nodes)
        if isinstance(array, Array) and hasattr(array.how, "formula")
        for node in in_order([array.how.formula])
    )


def test_a_second_printer_gives_the_same_bits_in_each_lane():
    """NumPy for many instances at once, from the record alone: what one printer does wrong, the other does not."""
    made, seen, count = [], set(), 0
    for i in range(150):
        expression = draw([SEED, i])

        def function(*values, e=expression):
            return e(**dict(zip(INPUTS, values, strict=True)))

        with np.errstate(all="ignore"):
            one = traced(function, [np.zeros(shape) for shape in INPUTS.values()], [np.inf, 1, 4][i % 3])
        if not calls_the_library(one):
            made.append(one)
            seen.update(kinds(one))
    for one in linked(made):
        given = np.array([np.concatenate([np.ravel(x) for x in values.values()]) for values in drawn_inputs(RNG, 5)])
        lanes = evaluator(["v"], one.nodes)(given.T)
        for k, values in enumerate(given):
            assert same(lanes[:, k], np.ravel(one(values))), numpy_source("f", ["v"], one.nodes)
        count += lanes.size
    assert count > 5_000
    assert seen >= {"Map", "Fold", "Run", "Product", "Pack"}


def filter_step(covariance, state, rows, row, variance, residual):
    """A Kalman filter of many states, predicted and updated."""
    covariance = rows @ covariance @ rows.T + np.eye(len(state)) * 0.1
    cross = covariance @ row
    spread = row @ cross + variance
    gain = cross / spread
    state = np.where(spread > 0, state + gain * residual, state)
    covariance = covariance - np.outer(gain, cross)
    sums = np.cumsum(np.maximum(covariance, 0.0), axis=1)
    return np.concatenate([state, covariance.ravel(), sums[:, -1], np.max(covariance, axis=0), [np.sum(covariance)]])


def arguments(n: int) -> list[np.ndarray]:
    root = RNG.normal(size=(n, n))
    vectors = [RNG.normal(size=n), RNG.normal(size=(n, n)), RNG.normal(size=n)]
    return [root @ root.T, *vectors, np.float64(2.0), np.float64(0.3)]


@pytest.mark.parametrize("n", [3, 9, 14])
def test_a_filter_is_the_same_in_single_numbers_in_arrays_and_in_lanes(n):
    given = arguments(n)
    single, whole = traced(filter_step, given), traced(filter_step, given, 8)
    ways = [
        *(one(*given) for one in compiled([(filter_step, given)])),
        *(one(*given) for one in compiled([(filter_step, given)], 8)),
    ]
    vector = np.concatenate([np.ravel(x) for x in given])[:, None]
    ways += [evaluator(["v"], made.nodes)(vector)[:, 0] for made in (single, whole)]
    assert not kinds(single)
    assert kinds(whole)
    assert all(same(ways[0], way) for way in ways[1:])
    np.testing.assert_allclose(ways[0], filter_step(*given), rtol=1e-9, atol=1e-9)


def test_forty_states_are_a_page_of_c():
    text = c_function("f", ["v"], traced(filter_step, arguments(42), 8).nodes).text
    assert len(text) < 9_000
    assert "42 * i + j" in text


def test_what_one_map_hands_to_the_next_is_stored_nowhere():
    """b * x - c is one loop, and a result that is used twice is calculated once."""
    one = traced(lambda a: 3.0 * a * a - a / 2.0, [np.zeros(9)], 8)
    assert c_function("f", ["v"], one.nodes).text.count("for (") == 1
    two = traced(lambda a: (lambda b: np.concatenate([np.cumsum(b), b[::-1]]))(a * a), [np.zeros(9)], 8)
    assert c_function("f", ["v"], two.nodes).text.count(" * v[") == 1


def written_twice(h, p, x):
    """A product, a map that two loops read, and a function of the runtime."""
    once = (h @ p) @ h.T + (h @ p)[:, :3]
    halves = np.linalg.solve(p, x)[:6] + np.linalg.solve(p, x)[6:]
    return np.concatenate([once.ravel(), np.cumsum(2.0 * x + 1.0), (2.0 * x + 1.0)[::-1], halves])


def written_alike(h, p, x):
    """What differs by a stride, a sign of zero, a constant, an order or a shape."""
    products = (p @ x + p.T @ x) @ np.linspace(0.0, 1.0, 12) - p @ x @ np.linspace(1.0, 2.0, 12)
    zeros = np.arctan2(0.0 * x, -1.0) - np.arctan2(-0.0 * x, -1.0)
    sums = np.concatenate([np.sum(p, axis=0), np.sum(p, axis=1), np.cumsum(x), np.cumsum(x[::-1])])
    return np.concatenate([[products], zeros, sums, np.sum(p.reshape(16, 9), axis=1), np.max(p, 0), np.min(p, 0)])


def test_what_is_written_twice_is_calculated_once_and_what_looks_alike_is_not():
    """Wrong: H P of a gain and of a covariance are two products; or, compared by halves, one for two."""
    given = [RNG.normal(size=(3, 12)), RNG.integers(-9, 9, (12, 12)) / 8.0 + 20.0 * np.eye(12), np.arange(12.0) - 4.0]
    made = traced(written_twice, given, 8)
    assert sorted(kinds(made)) == ["Map", "Map", "Map", "Product", "Product", "Routine", "Run"]
    for function in (written_twice, written_alike):
        (single,), (whole,) = compiled([(function, given)]), compiled([(function, given)], 8)
        assert same(single(*given), whole(*given))
        np.testing.assert_allclose(whole(*given), function(*given), rtol=1e-12, atol=1e-12)


def test_buffers_are_used_again():
    def chain(a):
        for _ in range(20):
            a = np.cumsum(a * 0.5)[::-1]
        return a

    text = c_function("f", ["v"], traced(chain, [np.zeros(30)], 8).nodes).text
    assert 1 <= text.count("    double w") <= 3


class Matrices(Component):
    """Products of matrices on the way to one number."""

    sample_period = Parameter("s", start=0.1, description="period")
    gain = Parameter("1", start=0.5, description="what is left of it")
    u = State(150, "1", start=np.cos(np.arange(150.0)), description="one of two vectors whose product it is")
    y = Output("1", description="sum")

    @every("sample_period")
    def step(self):
        matrix = np.outer(self.u, 0.1 * self.u[::-1])
        once = matrix @ matrix
        twice = once @ matrix
        self.u = self.gain * self.u
        self.y = np.sum(once + twice @ once.T)


def blended(a, b):
    return (a @ b + b @ a).T / 180.0


def nested(a, b):
    c = blended(a, b)
    return blended(c, a) + blended(b, c) @ c


def nested_more(a, b):
    c = nested(a, b)
    return nested(c, a) @ nested(b, c) + c


class Nested(Component):
    """Functions that call each other with matrices, and go on in a loop."""

    sample_period = Parameter("s", start=0.1, description="period")
    gain = Parameter("1", start=0.5, description="what is left of it")
    count = Parameter(kind="integer", start=3, max=5, description="passes")
    u = State(90, "1", start=np.cos(np.arange(90.0)), description="one of two vectors whose product it is")
    y = Output("1", description="sum")

    @every("sample_period")
    def step(self):
        matrix = np.outer(self.u, 0.1 * self.u[::-1])
        mean = repeat(lambda x: 0.01 * nested_more(x, matrix) + 0.5, matrix, self.count, 5)
        self.u = self.gain * self.u + 0.001 * mean[0]
        self.y = np.sum(nested_more(matrix, mean))


@pytest.mark.parametrize("component", [Matrices, Nested])
def test_a_thread_with_a_small_stack_can_do_with_large_matrices(component, tmp_path):
    """512 kB, as on macOS, and two instances at once: catches arrays on the stack, whose sum along the calls nobody
    knew, and memory that instances share. In a process of its own, which would be gone."""
    build(component, tmp_path, pictures=False)
    text = generate(lower(component), "{0}")
    assert int(text.partition(".work_count = ")[2].partition(",")[0]) > 10_000
    code = (
        "import json, sys, threading; from pathlib import Path; from tests.export.slave import *;"
        "name, folder, gains = sys.argv[1], Path(sys.argv[2]), json.loads(sys.argv[3]);"
        "fmu = Unzipped(folder / f'{name}.fmu', folder / 'unzipped'); found = {};"
        "ready = threading.Barrier(2);\n"
        "def run(gain):\n"
        "    slave = Slave(fmu); assert slave.initialise(gain=gain) == OK; ready.wait()\n"
        "    found[gain] = [(slave.step(0.1 * k, 0.1), slave.get('y'))[1] for k in range(9)]\n"
        "threading.stack_size(512 * 1024);"
        "threads = [threading.Thread(target=run, args=(gain,)) for gain in gains];"
        "[thread.start() for thread in threads]; [thread.join() for thread in threads];"
        "print(json.dumps([found[gain] for gain in gains]))"
    )
    gains = [0.5, 0.75]
    command = [sys.executable, "-c", code, component.layout.name, str(tmp_path), json.dumps(gains)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, f"{run.returncode}: {run.stderr}"
    for gain, found in zip(gains, json.loads(run.stdout), strict=True):
        floats = Interpreter(component)
        floats.set("gain", gain)
        floats.setup()
        expected = []
        for k in range(9):
            floats.do_step(0.1 * k, 0.1)
            expected.append(floats.get("y"))
        assert np.all(np.isfinite(expected))
        np.testing.assert_allclose(found, expected, rtol=1e-9)


# --- functions of the model ---


def smoothed(x, weights, offset=0.0):
    """Long enough to be worth a call."""
    total = x
    for weight in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6):
        total = total * weight + np.sqrt(np.abs(weights)) * x - offset
    return total, np.sum(total)


def of_many(x, weights):
    found = []
    for i in range(6):
        x, total = smoothed(x + i, weights)
        found.append(total)
    return np.concatenate([x, np.array(found)])


def sometimes(x, first):
    """What it does depends on what it is given."""
    return sum(np.sin(x[k]) for k in range(20)) if first == 0.0 else x[0]


def in_place(x):
    for k in range(30):
        x[0] = x[0] * 0.5 + x[1] * k
    return x


def told_by_a_list(values):
    values.append(values[0] * 2.0)
    return sum(np.sqrt(np.abs(v)) + v * v for v in values for _ in range(9))


def with_a_constant(x):
    """Some of its results are constants and arguments as they came."""
    y = x
    for k in range(40):
        y = y * 0.9 + k
    return np.array([1.0, 0.0]), x, y[0], {"more": (y[1:], None, "text")}


def test_a_function_that_is_called_often_is_compiled_once():
    given = [RNG.normal(size=12), RNG.normal(size=12)]
    made = traced(of_many, given, 8)
    calls = [node for node in in_order(made.nodes) if node.op == "Call"]
    assert len(calls) == 6
    assert len({call.how for call in calls}) == 1
    assert numpy_source("f", ["v"], made.nodes).count("def ") == 2
    assert same(compiled([(of_many, given)], 8)[0](*given), of_many(*given))
    assert "test_arrays_smoothed" in calls[0].how.name


def of_rows(x):
    """A filter's update for measurements that are made of known states: rows of constants."""
    for row in np.eye(6, 12):
        x, _ = smoothed(x, row)
    return x


def decided(x, weights):
    """What it does depends on constants."""
    return smoothed(x, weights)[0] if weights[0] > 0.0 else np.sqrt(np.abs(x)) * 2.0 + weights[1]


def test_arrays_of_constants_make_no_copies_of_a_function():
    """Wrong: one function for each row of zeros and ones, nine times the code for nine measurements."""
    given = [RNG.normal(size=12)]
    made = traced(of_rows, given, 8)
    assert len({node.how for node in in_order(made.nodes) if node.op == "Call"}) == 1
    assert same(compiled([(of_rows, given)], 8)[0](*given), of_rows(*given))


def of_parts(x):
    """Calls with tuples, keywords and a name that is no ASCII."""

    total = 0.0
    for k in range(6):
        total = total + joined((x[:9], x[9]), λ=x[10:] + k)
    return total


def joined(parts, λ):
    for _ in range(9):
        λ = parts[0] * parts[1] + np.sqrt(np.abs(λ))
    return λ


def test_the_code_says_which_function_it_is_and_what_its_operands_are():
    """p0, p1, p2 and the hash of a name told nobody where the code came from."""
    made = traced(of_parts, [RNG.normal(size=19)], 8)
    (text,) = c_helpers(made.nodes)
    head, _, rest = text.partition("\n")
    assert head == "/* test_arrays.joined: p0_1 is parts[0] (9,), p1_1 is parts[1], p2_1 is \\u03bb (9,). */"
    assert "(const double *restrict p0_1, double p1_1, const double *restrict p2_1, double *restrict r)" in rest


def moved(rate, x):
    for _ in range(8):
        x = x + 0.1 * rate(x)
    return x


def as_it_came(x):
    """One of its results is its argument, two are one array."""
    y = x
    for k in range(40):
        y = y * 0.9 + k
    return x, y, y[1:]


def told_twice(values):
    for _ in range(2):
        values[0] = values[0] * 2.0
    return smoothed(values[0], values[0])[0]


def solved(matrix, y):
    for _ in range(30):
        y = (y + np.linalg.solve(matrix, y) * 0.5) / 2.0 + 1.0
    return y


def begun(x):
    """An array of constants, which gets others where it was called."""
    for k in range(40):
        x = x * 0.9 + k
    return np.zeros((3, 3)), x


def last(x, some, values=tuple(range(40))):
    for value in values:
        x = x * 0.5 + x[some][-1] * value
    return x


def into_results(a):
    b = 2.0 * a
    same, y, rest = as_it_came(b)
    same[0], y[1] = 7.0, 8.0
    return np.concatenate([b, same, y, rest])


def into_a_constant(a):
    matrix, x = begun(a)
    matrix[1, 2] = a[0]
    return np.concatenate([matrix.ravel(), x])


CALLED = {
    "a branch on an array of constants": lambda a: (
        decided(a, np.linspace(-1, 1, 20)) + decided(a, np.linspace(1, 2, 20))
    ),
    "a function that knows traced values": lambda a: moved(lambda x: x * a[0], a) + moved(lambda x: x * a[1], a),
    "a function with a traced default": lambda a: moved(lambda x, b=a: x * b, a),
    "results that are assigned to": into_results,
    "a constant that is assigned to": into_a_constant,
    "a list that changes twice": lambda a: (lambda values: told_twice(values) + values[0])([a]),
    "a matrix of one number": lambda a: solved(a[3:4, None] ** 2 + 1.0, a[1:2]),
    "slices": lambda a: last(a, slice(3, 9)) + last(a, slice(None, 8, 2)),
    "a branch on a value that is constant here": lambda a: sometimes(a, 0.0) + sometimes(a, 1.0),
    "a branch on a value that is known only here": lambda a: sometimes(a, np.array([0.0, a[0]])[0]),
    "arguments that are changed": lambda a: in_place(a.copy()) * 1.0,
    "a copy that is changed": lambda a: (lambda b: in_place(b) + b)(2.0 * a),
    "a list that grows": lambda a: (lambda values: told_by_a_list(values) + len(values))([a[0], a[1]]),
    "constants and arguments among results": lambda a: (
        lambda c, x, y, more: x * c[0] + y + c[1] + np.sum(more["more"][0])
    )(*with_a_constant(a)),
    "keywords and defaults": lambda a: smoothed(a, weights=a, offset=a[0])[0] + smoothed(weights=a, x=a)[1],
    "whole numbers and truth values": lambda a: np.where(smoothed(np.trunc(a).astype(int), a, a[0] > 0)[0] > 0, a, 2),
}


@pytest.mark.parametrize("name", CALLED)
def test_a_call_means_what_the_function_means(name):
    a = RNG.normal(size=20)
    (one,) = compiled([(CALLED[name], [a])], 8)
    assert same(one(a), CALLED[name](a))


def inverted(matrix, x):
    for _ in range(30):
        x = np.linalg.inv(matrix) @ (matrix @ matrix @ x)
    return x


def with_a_matrix_of_its_own(a):
    matrix = np.eye(3) * 0.7
    matrix += MATRIX
    return inverted(matrix, a[:3])


def with_a_matrix_of_the_module(a):
    return inverted(MATRIX, a[:3])


MATRIX = np.array([[0.8, 0.2, 0.3], [0.4, 1.2, 0.6], [0.2, 0.9, 0.8]])


@pytest.mark.parametrize("function", [with_a_matrix_of_its_own, with_a_matrix_of_the_module])
def test_constants_are_calculated_with_alike_in_a_call(function):
    """By C in both, or by NumPy in both: products and inverses have other bits."""
    a = RNG.normal(size=20)
    single, whole = (compiled([(function, [a])], whole)[0] for whole in (np.inf, 8))
    assert "Call" in kinds(whole)
    assert same(single(a), whole(a))


KEPT: dict[str, object] = {}


def remembering(x, factor):
    KEPT.setdefault("first", x * 2.0)
    for _ in range(30):
        x = x * 0.5 + KEPT["first"] * factor
    return x


class Remembering(Component):
    """A function of its module keeps what it has calculated."""

    name = "remembering"
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    x = Output(200, "1", start=1.0, description="something")

    @every("sample_period")
    def step(self):
        KEPT.clear()
        self.x = remembering(self.x, 1.0) + remembering(self.x, 2.0)


def test_what_a_function_keeps_of_its_arguments_is_refused():
    with pytest.raises(NavfmuError, match=r"component Remembering: .* leaves what it calculates in .* outside of it"):
        lower(Remembering)


def test_names_in_other_letters_are_names_in_c():
    made = traced(lambda a: größe(größe(a)), [np.zeros(20)], 8)
    (how,) = {node.how for node in in_order(made.nodes) if node.op == "Call"}
    assert how.name.isascii() and how.name.isidentifier()


def größe(x):
    for k in range(40):
        x = np.abs(x) * 0.9 + k
    return x


@pytest.mark.parametrize("step", [lambda x: x * 0.5 + 1.0, lambda x: x * x], ids=["long", "twice"])
def test_one_loop_after_the_other_takes_no_time_of_the_printer(step):
    """Each map within the next: as deep as Python can go, and twice as much for each that is read twice."""

    def chain(x):
        for _ in range(1_000):
            x = step(x)
        return x

    given = np.linspace(-1.0, 1.0, 9)
    with np.errstate(under="ignore"):
        assert same(compiled([(chain, [given])], 8)[0](given), chain(given))


# --- how far a trace goes ---


def test_a_short_trace_is_one_of_single_numbers_and_a_long_one_of_arrays():
    given = np.zeros(12)

    def nodes(times):
        def run():
            x = np.array(symbols)
            for _ in range(times):
                x = x * 0.5 + 1.0
            return x

        with trace.tracing():
            symbols = trace.symbols("v", "f" * given.size)
            return shortest(run, "f", {}, most=100)[1]

    assert not nodes(3).calls
    assert nodes(20).calls


def test_a_large_array_is_whole_also_among_single_numbers():
    def run(a):
        b = a[:, None] * a
        return np.concatenate([b.ravel(), a + b[0]])

    n = int(LARGE**0.5) + 1
    with trace.tracing():
        symbols = trace.symbols("v", "f" * n)
        result, used = shortest(lambda: run(symbols), "f", {})
        nodes = trace.expressions(result)
    assert not used.calls
    assert [node.op for node in in_order(nodes) if isinstance(node, Array)] == ["Map"]
    assert sum(node.op == "add" for node in in_order(nodes)) == n


def test_too_many_operations_on_single_numbers_are_refused_with_a_remedy():
    def run():
        total = 0.0
        for i in range(70_000):
            total = total + symbols[i % 3] * i
        return total

    with trace.tracing(), pytest.raises(NavfmuError) as caught:
        symbols = trace.symbols("v", "fff")
        shortest(run, "model.py, line 7: component Sum, task 'add'", {})
    assert str(caught.value).startswith("model.py, line 7: component Sum, task 'add' has more than 60000 operations")
    assert "function of the module" in str(caught.value)


def test_extents_do_not_leak():
    with extent(Extent(most=5)) as used:
        pass
    assert used.operations == 0
    assert not kinds(traced(lambda a: a * 2.0, [np.zeros(50)]))


def test_a_wide_filter_is_loops_and_calls():
    """And its FMU, its twin and the sanitizers run it: test_twin.py, test_sanitizers.py."""
    (task,) = lower(Wide).tasks
    used = [node for node in in_order(task.values) if isinstance(node, Array)]
    assert {node.op for node in used} >= {"Map", "Product", "Call", "Routine"}
    called = [node.how for node in used if node.op == "Call"]
    assert len([how for how in called if "updated" in how.name]) == 6
    assert len({how for how in called if "updated" in how.name}) == 1


def long(x):
    """A function of thousands of operations."""
    for k in range(1, 700):
        x = x * (1.0 - 1.0 / k) + np.sqrt(np.abs(x))
    return x


def bank(x):
    return np.concatenate([long(x[i : i + 2]) for i in range(0, 8, 2)])


def test_a_bank_of_the_same_is_one_function():
    """Four times 2 800 operations are fewer than what a task may have, and a quarter of the code."""
    with trace.tracing([sys.modules[__name__]]):
        symbols = trace.symbols("v", "f" * 8)
        result, used = shortest(lambda: bank(symbols), "f", {})
        _, alone = shortest(lambda: long(symbols[:2]), "f", {})
        nodes = trace.expressions(result)
    assert used.calls
    assert not alone.calls
    assert len({node.how for node in in_order(nodes) if node.op == "Call"}) == 1
