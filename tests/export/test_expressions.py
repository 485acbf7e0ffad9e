"""C computes what NumPy computes: expressions drawn over all that a model may contain, and cases worth a name."""

import math

import numpy as np
import pytest

from evidence import expressions
from evidence.compiled import compiled
from evidence.drawn import INPUTS, draw, numbers
from evidence.functions import FUNCTIONS
from navfmu.errors import NavfmuError
from navfmu.export import Component, Input, Output, Parameter, State, every, start
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.tracing import functions, linear, ufuncs
from navfmu.export.tracing.rules import RULES

from .slave import ERROR, OK, Slave, Unzipped

SEED, COUNT = 2, 1000  # make evidence has another seed


def test_thousand_drawn_expressions_are_in_c_what_they_are_in_numpy():
    found = expressions.check(COUNT, SEED)
    assert found.expressions == COUNT
    assert found.numbers > 100_000
    assert not found.differences, "\n\n".join([f"{len(found.differences)} differences", *found.differences[:5]])
    assert 0 < found.places <= 2


def test_all_that_can_be_traced_is_drawn(monkeypatch):
    used = set()
    ufunc, function = ufuncs.apply, functions.apply
    monkeypatch.setattr(ufuncs, "apply", lambda of, *rest: (used.add(of), ufunc(of, *rest))[1])
    monkeypatch.setattr(functions, "apply", lambda of, *rest: (used.add(of), function(of, *rest))[1])
    for i in range(COUNT):
        draw([SEED, i]).traced()
    missing = {*RULES, *functions.FUNCTIONS, *functions.STRUCTURAL} - used - linear.FUNCTIONS.keys()  # by residuals
    missing.remove(np.fill_diagonal)  # which gives nothing back: test_trace.py
    assert {f.__name__ for f in missing} <= set()


def test_the_same_seed_draws_the_same_expressions():
    assert [draw([3, i]).source() for i in range(20)] == [draw([3, i]).source() for i in range(20)]
    assert draw([3, 0]).source() != draw([3, 1]).source()


WRONG = [(np.maximum, np.fmax, "max"), (np.floor, np.ceil, "floor"), (np.exp, np.expm1, "exp")]


@pytest.mark.parametrize("ufunc, wrong, word", WRONG)
def test_a_rule_that_is_wrong_is_found_and_shown_as_source(ufunc, wrong, word, monkeypatch):
    monkeypatch.setitem(RULES, ufunc, RULES[wrong])
    found = expressions.check(400, SEED)
    assert found.differences
    one = next(text for text in found.differences if word in text.partition("\nwith\n")[0])  # np.max is maximum, too
    source, _, told = one.partition("\nwith\n")
    assert source.startswith("# draw([2, ")
    assert " = " in told
    assert "C gives " in told and "NumPy " in told


def test_claims_are_missed_when_numbers_differ():
    found = expressions.Found(expressions=1, numbers=10, places=3.0, wrong=1, differences=["x + y with ..."])
    assert [claim.holds for claim in expressions.section(found).claims] == [False, False]
    assert all(c.holds for c in expressions.section(expressions.Found(1, 10, 2.0)).claims)


# ---- cases that were wrong ----

T, F = np.array([True]), np.array([False])
X = np.array([0.0, -0.0, 1.0, -2.5, math.inf, -math.inf, math.nan])
CASES = {
    "a chosen -0.0 keeps its sign": (lambda c: np.arctan2(0.0, np.where(c, -0.0, 5.0)), T),
    "what is not chosen does not matter": (lambda c: np.where(c, -0.0, np.inf), T),
    "interp of what is no number": (lambda x: np.interp(x, [0.0, 1.0], [2.0, 3.0]), X),
    "interp between infinities": (lambda x: np.interp(x, [-2.5, 0.0, 1.0], [np.inf, np.inf, 1.0]), X),
    "a product with 0 is not 0": (lambda x: 0 * x, X),
    "a sum of -0.0": (lambda x: np.sum(-0.0 * x[:1]), X),
    "a product of matrices of -0.0": (lambda x: np.eye(2) @ (-0.0 * x[:2]), np.array([1.0, 2.0])),
    "there is no whole -0": (lambda c: np.arctan2(0.0, -np.where(c, 1, 0)), F),
    "a truth value has no sign either": (lambda c: 1.0 / (c * -1), F),
    "of -0.5 rounded to a whole number": (lambda x: 1.0 / -(x.astype(int)), np.array([-0.5])),
    "a whole number divided by 0": (lambda c: np.where(c, 3, 2) // np.where(c, 0, 1) + np.where(c, 3, 2) % 0, T),
    "whole numbers to powers": (lambda c: np.where(c, 3, 2) ** 2 + np.where(c, 3, 2) ** 5, T),
    "round of one number": (lambda x: round(x[0]) / 2 + 3.0 * round(x[1]), np.array([2.5, -0.3])),
    "whole sums": (lambda c: 1.0 / -np.sum(np.where(c, 1, 0)) + 1.0 / -np.cumsum(c)[0], F),
}


@pytest.fixture(scope="module")
def cases():
    return dict(zip(CASES, compiled((function, arguments) for function, *arguments in CASES.values()), strict=True))


@pytest.mark.parametrize("name", CASES)
def test_case(name, cases):
    function, *arguments = CASES[name]
    with np.errstate(all="ignore"):
        expected = np.asarray(function(*arguments), float)
    assert not np.any(expressions.distance(cases[name](*arguments), expected))


def test_a_chosen_negative_zero_points_backwards(cases):
    assert cases["a chosen -0.0 keeps its sign"](T) == math.pi


REFUSED = {
    "powers of whole numbers": (lambda c: np.where(c, 3, 2) ** -1, "x.astype(float)"),
    "traced powers of whole numbers": (lambda c: 2 ** np.where(c, 3, 2), "x.astype(float)"),
    "reciprocal of whole numbers": (lambda c: np.reciprocal(np.where(c, 3, 2)), "1.0 / x"),
    "division of truth values": (lambda c: c // c, "x.astype(float)"),
    "sign of truth values": (lambda c: np.sign(c), "x.astype(float)"),
    "single precision": (lambda c: c.astype(np.float32), "float, int or bool"),
    "a type for a function": (lambda c: np.add(c, 1.0, dtype=np.float32), "x.astype(...)"),
    "real numbers into whole ones": (lambda c: np.where(c, 3, 2).__iadd__(0.5 * c), "x = x + y"),
    "interp that does not increase": (lambda c: np.interp(1.0 * c, [1.0, 0.0], [1.0, 2.0]), "sort"),
    "interp with a period": (lambda c: np.interp(1.0 * c, [0.0, 1.0], [1.0, 2.0], period=1.0), "np.mod"),
    "decimals": (lambda c: round(1.0 * c[0], 1), "np.rint"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_numpy_computes_in_another_way_is_refused(name):
    function, remedy = REFUSED[name]
    with pytest.raises(NavfmuError) as caught:
        compiled([(function, [T])])
    assert remedy in str(caught.value)


# ---- an FMU and its interpreter ----


class Corners(Component):
    """What FMU and twin once did in two ways."""

    sample_period = Parameter("s", start=1.0, description="sampling period")
    fraction = Input("1", description="added to the count")
    backwards = Input(kind="boolean", start=True, description="the direction")
    count = State(kind="integer", description="a whole number")
    mirrored = Output("rad", description="angle of the count, mirrored")
    angle = Output("rad", description="angle of the direction")
    looked_up = Output("1", description="from a curve")
    calculated = Output("1", description="calculated when initialisation ends")

    @start
    def begin(self):
        self.calculated = 2.0 * self.sample_period

    @every("sample_period")
    def step(self):
        self.mirrored = np.arctan2(0.0, -self.count)
        self.angle = np.arctan2(0.0, np.where(self.backwards, -0.0, 5.0))
        self.looked_up = np.interp(self.fraction, [0.0, 1.0], [2.0, 3.0])
        self.count = self.count + self.fraction


def _both(component, folder):
    """Return an instance of the native FMU and the interpreter."""
    (path,) = build(component, folder, pictures=False)
    return Slave(Unzipped(path, folder / "unzipped")), Interpreter(component)


def _initialise(native, twin):
    assert native.initialise() == OK
    twin.setup_experiment(0.0, None)
    twin.enter_initialization()
    twin.exit_initialization()


@pytest.mark.parametrize("fraction", [0.5, math.nan, math.inf])
def test_corners_of_native_fmu_and_twin_are_the_same(fraction, tmp_path):
    native, twin = _both(Corners, tmp_path)
    index = Corners.layout.index
    reference = index("calculated")
    assert native.set_references("Real", [reference], [1.0]) == ERROR
    with pytest.raises(NavfmuError) as refused:
        twin.set_values("Real", [reference], [1.0])
    assert native.said == str(refused.value)
    _initialise(native, twin)
    native.messages.clear()
    assert native.step(0.0, 1.0) == OK
    twin.do_step(0.0, 1.0)
    for name, expected in {"angle": math.pi, "mirrored": 0.0, "looked_up": 2.0, "calculated": 2.0}.items():
        assert native.get(name) == expected == twin.get_values("Real", [index(name)])[0]
    native.set("fraction", fraction)
    twin.set_values("Real", [index("fraction")], [fraction])
    native.messages.clear()
    assert native.step(1.0, 1.0) == ERROR
    with pytest.raises(NavfmuError) as refused:
        twin.do_step(1.0, 1.0)
    assert str(refused.value).endswith(f": component Corners: {native.said}")
    assert native.said.startswith("'count' is an Integer")


EXPRESSIONS = 20
_BITS = [f for f in FUNCTIONS if not f.places and not f.any_zero and not f.reference]


def _component():
    """A component whose outputs are drawn expressions of its inputs: those that have the same bits in C."""
    drawn = [draw([SEED, i], _BITS) for i in range(EXPRESSIONS)]
    body = {name: Input(shape, "1") if shape else Input("1") for name, shape in INPUTS.items()}
    body["sample_period"] = Parameter("s", start=1.0)
    for i, expression in enumerate(drawn):
        body[f"e{i}"] = Output(sum(math.prod(step.shape) for step in expression.steps), "1")

    def step(self):
        for i, expression in enumerate(drawn):
            setattr(self, f"e{i}", expression(**{name: getattr(self, name) for name in INPUTS}))

    return type("Drawn", (Component,), {**body, "__doc__": "Drawn expressions.", "step": every("sample_period")(step)})


def test_fmu_and_interpreter_have_the_same_bits_for_drawn_expressions(tmp_path):
    component = _component()
    native, twin = _both(component, tmp_path)
    _initialise(native, twin)
    inputs = [i for v in component.layout.variables if v.causality == "input" for i in v.indices]
    outputs = [i for v in component.layout.variables if v.causality == "output" for i in v.indices]
    rng = np.random.default_rng(SEED)
    with np.errstate(all="ignore"):
        for k in range(20):
            given = numbers(rng, len(inputs)).tolist()
            assert native.set_references("Real", inputs, given) == OK
            twin.set_values("Real", inputs, given)
            assert native.step(float(k), 1.0) == OK
            twin.do_step(float(k), 1.0)
            status, got = native.get_references("Real", outputs)
            assert status == OK
            apart = expressions.distance(np.array(got), np.array(twin.get_values("Real", outputs), float))
            assert not np.any(apart), [component.layout.elements[outputs[i]].name for i in np.flatnonzero(apart)]
