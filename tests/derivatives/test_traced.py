"""Derivatives of traced functions: the C code has the bits of the Python code, and does no more than is needed."""

import math
import subprocess
import sys
import threading

import numpy as np
import pytest

from evidence.compiled import compiled, traced
from navfmu.derivatives import jacobian, value_and_jacobian
from navfmu.export.record.graph import OPERATIONS
from navfmu.export.tracing import trace
from navfmu.export.twin import sources
from tests.built import components

from . import strapdown
from .functions import ANALYTIC, CHOOSING
from .test_rules import NESTED, POINTS

BOTH = {**ANALYTIC, **CHOOSING}
NOT_TRACED = {"branch", "logaddexp, cbrt", "sum of some", "max over axis"}  # by the tracer itself
LIBRARY = {  # NumPy and the C library may differ in the last place
    *("broken powers", "whole powers", "power of a number", "numbers' powers", "exp", "log", "sin, cos, tan"),
    *("inverse functions", "hyperbolic", "inverse hyperbolic", "loop", "array of elements", "hypot, norm"),
    *("arctan2", "where", "float powers", "gradient", "quotient"),
}
ROUTINES = {  # linear equations have a routine of their own in C
    *("solve", "solve a constant side", "solve with a constant matrix", "solve stacks", "solve a stack for a vector"),
    *("inverse", "determinant", "determinants of stacks", "by a matrix", "cholesky", "matrix"),
}
PRODUCTS = {  # NumPy leaves the order of their sums to a library; those of derivatives have one
    name for name, function in BOTH.items() if "matri" in name or "dot" in name or "einsum" in name
}


@pytest.fixture(scope="module", params=[math.inf, 2], ids=["elements", "whole arrays"])
def native(request):
    """Value and derivatives of all functions, compiled: as single numbers, and with arrays kept whole."""
    functions = {name: function for name, function in BOTH.items() if name not in NOT_TRACED}
    functions |= {f"Hessian of {n}": lambda x, f=f: jacobian(f, x) for n, f in NESTED.items()}
    made = compiled([(lambda x, f=f: flat(f, x), [POINTS[0]]) for f in functions.values()], request.param)
    return {name: (functions[name], one) for name, one in zip(functions, made, strict=True)}


def flat(function, x):
    value, derivatives = value_and_jacobian(function, x)
    return np.concatenate([np.ravel(value), np.ravel(derivatives)])


@pytest.mark.parametrize("name", [*(n for n in BOTH if n not in NOT_TRACED), *(f"Hessian of {n}" for n in NESTED)])
def test_traced_derivatives_equal_those_of_numpy(name, native):
    """To the last bit; an operation that is left out, added or in another place in one of both ways changes some."""
    function, compiled_one = native[name]
    bare = name.removeprefix("Hessian of ")
    for x in POINTS:
        expected, found = flat(function, x), compiled_one(x)
        np.testing.assert_allclose(found, expected, rtol=2e-14, atol=2e-14 * np.max(np.abs(expected)))
        if not (bare in LIBRARY | PRODUCTS | ROUTINES or name.startswith("Hessian")):
            values = np.size(function(x))
            np.testing.assert_array_equal(found[values:], expected[values:])


def operations(function, *arguments):
    """How many operations the C function has, each counted once."""
    waiting, seen = list(traced(function, arguments).nodes), set()
    while waiting:
        node = waiting.pop()
        if node not in seen and node.op in OPERATIONS:
            seen.add(node)
            waiting += node.of
    return len(seen)


COUNTS = {  # function, how many operations its derivatives are when written by hand
    "linear: none": (lambda x: 3.0 * x + x[::-1] - 2.0 * x[0], 0),
    "squares: one each": (lambda x: x * x, 3),  # 2 x, as x + x
    "product of two: none": (lambda x: x[0] * x[1], 0),
    "sine: one": (lambda x: np.sin(x[0]), 1),
    "of one element only": (lambda x: np.stack([np.cos(x[1]), x[0], 4.0]), 2),  # -sin
    "moved about: none": (lambda x: np.concatenate([x[::-1], np.tile(x, 3), np.outer(x, [1.0, 0.0])[:, 1]]), 0),
    "chosen by a constant: none": (lambda x: x[np.array([True, False, True])], 0),
}


@pytest.mark.parametrize("name", COUNTS)
def test_what_is_zero_or_one_by_the_text_is_not_calculated(name):
    function, count = COUNTS[name]
    assert operations(lambda x: jacobian(function, x), POINTS[0]) == count


def test_only_what_depends_on_x_is_differentiated():
    """Ten states in a chain, each driven by the next: two derivatives in each row, not ten."""

    def chain(x):
        return x * x + np.concatenate([np.sin(x[1:]) * x[:-1], [0.0]])

    x = np.linspace(0.1, 1.0, 10)
    assert np.count_nonzero(jacobian(chain, x)) == 19
    # 2 x, sin, cos and its product with x for nine, the sum on the diagonal
    assert operations(lambda x: jacobian(chain, x), x) == 10 + 4 * 9


def test_fifteen_states_of_strapdown_cost_little_more_than_their_matrix_by_hand():
    """Operations of both, those of the function itself included where they are needed; 355 and 253 when written."""
    arguments = strapdown.example(0)
    found = operations(lambda *a: jacobian(strapdown.derivatives, *a), *arguments)
    assert found <= 1.5 * operations(strapdown.by_hand, *arguments)


def test_derivatives_need_numpy_alone():
    """What a component imports is imported by its twin, and by an instance of it in a second."""
    code = "import sys, navfmu.derivatives; print(*(m for m in sys.modules if '.' not in m or m.startswith('navfmu')))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert not loaded & {"scipy", "pandas", "matplotlib", "lxml", "fmpy", "navfmu.export"}
    own = {m for m in loaded if m.startswith("navfmu.") and not m.startswith("navfmu.derivatives")}
    assert own == {"navfmu.errors", "navfmu.place"}


def test_a_component_that_does_without_does_not_carry_them():
    assert not [name for name in sources(components()["imu"]) if "derivatives" in name]


def test_tracing_and_differentiating_go_in_turns():
    """Both change names of NumPy for a while; at the same time, one would put back what the other one had put there."""
    before, order = np.array, []
    differentiating, tracing = threading.Event(), threading.Event()

    def function(x):
        differentiating.set()
        tracing.wait(0.2)
        order.append("differentiated")
        return x

    def trace_something():
        differentiating.wait(5.0)
        with trace.tracing():
            tracing.set()
            order.append("traced")

    thread = threading.Thread(target=trace_something)
    thread.start()
    jacobian(function, np.ones(2))
    thread.join(5.0)
    assert order == ["differentiated", "traced"]
    assert np.array is before
