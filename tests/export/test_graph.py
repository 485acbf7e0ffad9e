"""What is written for a graph: each operation once, truth values that are numbers too, and what can be done before."""

import re

import numpy as np

from evidence.compiled import compiled
from navfmu.export.printing.codegen import generate
from navfmu.export.printing.printer import c_function
from navfmu.export.record.graph import Node, element, number, settled
from navfmu.export.tracing.lower import lower

from .components import Lag, Wide


def test_truth_values_are_numbers_where_one_calculates_with_them():
    """An int would divide as ints do, and has no -0."""
    x = np.array([3.0, 2.0, 2.0])
    functions = [
        lambda v: (v > 2.0) / np.array([2.0, 4.0, 8.0]),
        lambda v: np.negative((v > 2.0) * 1.0),
        lambda v: np.where((v > 2.0) & (v[0] > v), 1.0, 2.0),
        lambda v: np.where((v > 2.0) | v.astype(bool), v * (v == 2.0), 2.0),
        lambda v: np.hypot((v == 2.0) + 0.0, 1.0 * (v > 2.0)),
    ]
    for function, one in zip(functions, compiled([(f, (x,)) for f in functions]), strict=True):
        expected, got = np.asarray(function(x), float), np.asarray(one(x))
        assert np.array_equal(got.view(np.int64), expected.view(np.int64)), function


def test_what_stands_is_found_once_and_what_leads_to_it_is_not():
    a, b, c = (element("v", i) for i in range(3))
    product, same = Node("multiply", a, b), Node("multiply", a, b)
    root = Node("sqrt", Node("add", product, number(1.0)))
    lone = Node("negative", number(2.0))
    results = [Node("add", Node("multiply", root, c), same), Node("subtract", c, product), lone]
    found = settled(results, lambda node: node is not c)
    assert found.keys() == {root, product, same, lone}
    assert found[product] == found[same]
    assert sorted(set(found.values())) == [0, 1, 2]
    assert settled(results, lambda node: False).keys() == {lone}
    text = c_function("f", ["v"], results, {node: ("fixed", place) for node, place in found.items()}).text
    assert "sqrt" not in text
    assert text.count("=") == 4  # a product that a sum reads, and three results: the sum, a difference, what stands


def test_a_parameter_that_can_be_tuned_and_what_tasks_change_are_calculated_anew():
    """What the factor of the lag is made of stands; sqrt(gain) does not."""
    text = generate(lower(Lag), "{}")
    before, task = (
        text.split("static void fixed_values")[1].split("static void task_0")[0],
        text.split("void task_1")[1],
    )
    task = task.split("\n}")[0]
    assert before.count("exp(") == before.count("sqrt(") == 1
    assert "exp(" not in task
    assert task.count("sqrt(") == 1


def test_the_code_says_what_lies_where():
    """v[24] told nobody that a position begins there, and numbers stood one on a line."""
    model = lower(Wide)
    text = generate(model, "{}")
    places = {v.name: v.index for v in model.variables}
    assert places["state"] == 14
    told = text[text.index("/* In v lies ") :].partition(" */")[0]
    told = told.removeprefix("/* In v lies ").replace("\n *", "").removesuffix(".")
    assert told == ", ".join(f"{name} at {place}" for name, place in places.items())
    assert not re.search(r" at\n", text), "a name is torn from its place"
    assert "/* Task 'estimate': r is what it assigns, state at 0, covariance at 24, " in text
    assert max(map(len, text.split("targets_0[] = {\n")[1].split("\n};")[0].splitlines())) > 100


def test_what_is_only_a_result_has_no_name_and_is_set_where_it_is_calculated():
    """Wrong: what is a result and an operand calculated twice, and what is a result twice set once."""
    a, b = (element("v", i) for i in range(2))
    total, product = Node("add", a, b), Node("multiply", a, b)
    text = c_function("f", ["v"], [total, product, Node("sqrt", total), product, Node("less", a, b)]).text
    assert "r[2] = sqrt(a0);" in text and "r[4] = v[0] < v[1];" in text
    assert text.index("r[2]") < text.index("r[0] = a0;")
    assert text.count("v[0] + v[1]") == text.count("v[0] * v[1]") == 1
    assert "r[1] = a1;" in text and "r[3] = a1;" in text
