"""What expressions mean: names, units, and sentences for what cannot be."""

import math
import random
import re

import numpy as np
import pytest

from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.parser import ExpressionError
from navfmu.expressions.program import Op
from navfmu.fmi.description import Description
from tests.expressions.made import SYSTEM, out, random_text


def value(text, signals=None, time=0.0, active=None, **more):
    """The value of an expression; signals by name."""
    program = compile_expression(text, SYSTEM, **more)
    return float(program.value([(signals or {})[str(source)] for source in program.sources], time, active))


@pytest.mark.parametrize(
    ("text", "signals", "expected"),
    [
        ("a.x <= 0.5 nmi", {"a.x": 926.0}, 1),
        ("a.x < 0.5 nmi", {"a.x": 926.0}, 0),
        ("a.x < 926", {"a.x": 925.9}, 1),  # a number without a unit is in that of the signal
        ("a.bearing < 30", {"a.bearing": 29.0}, 1),  # which is deg here
        ("a.bearing < 30 deg", {"a.bearing": 31.0}, 0),
        ("a.bearing > 0.5 rad", {"a.bearing": 28.7}, 1),
        ("30 > abs(a.bearing)", {"a.bearing": -29.0}, 1),
        ("a.warm > 20 degC", {"a.warm": 20.5}, 1),
        ("a.warm > 293.15 K", {"a.warm": 19.9}, 0),
        ("a.warmer > 2 K", {"a.warmer": 2.5}, 1),  # a difference has no origin
        ("norm(a.rate) > 30 deg/s", {"a.rate[1]": 0.3, "a.rate[2]": -0.4, "a.rate[3]": 0.2}, 1),
        ("max(a.rate) - min(a.rate)", {"a.rate[1]": 0.3, "a.rate[2]": -0.4, "a.rate[3]": 0.2}, 0.3 + 0.4),
        ("a.x * a.y > 4 m^2", {"a.x": 2.0, "a.y": 2.5}, 1),
        ("a.v / a.x < 3 s^-1", {"a.v": 2.0, "a.x": 1.0}, 1),
        ("sqrt(a.x * a.y) < 3 m", {"a.x": 4.0, "a.y": 4.0}, 0),
        ("a.v * 2 s < a.x", {"a.v": 2.0, "a.x": 4.5}, 1),
        ("a.bare > a.x", {"a.bare": 1.0, "a.x": 0.0}, 1),  # no unit goes with every unit
        ("5 < a.x < 7", {"a.x": 6.0}, 1),
        ("5 < a.x < 7", {"a.x": 8.0}, 0),
        ("not a.fix.valid or a.mode == 2", {"a.fix.valid": 1.0, "a.mode": 2.0}, 1),
        ("a.fix.valid != (a.mode > 1)", {"a.fix.valid": 1.0, "a.mode": 1.0}, 1),
        ("'odd name-1.x' > 3 ft", {"odd name-1.x": 1.0}, 1),
        ("a.x@true - a.x", {"a.x": 1.0, "a.x@true": 3.0}, 2.0),
        ("a.u > 0", {"a.u": 1.0}, 1),
    ],
)
def test_a_value_by_hand(text, signals, expected):
    assert value(text, signals) == pytest.approx(expected, rel=1e-15)


def test_time_and_faults():
    assert value("time >= 5 min", time=300.0) == 1
    assert value("active(f) and not active(g)", active={"f": 1, "g": 0}, faults=["f", "g"]) == 1
    assert value("active('f 1')", active={"f 1": 1}) == 1
    assert value("active()", active={"": 1}) == 1


def test_expressions_have_names():
    named = {"cruise": "a.x > 3000 m and calm", "calm": "abs(a.v) < 1 m/s"}
    assert value("cruise", {"a.x": 3001.0, "a.v": -0.5}, named=named) == 1
    with pytest.raises(ExpressionError, match=r"'loop': in 'not loop', character 5: 'loop' is explained by itself"):
        compile_expression("true or loop", SYSTEM, named={"loop": "not loop"})
    with pytest.raises(ExpressionError, match=r"character 9: 'bad': in 'a.z > 1', character 1: component 'a' has no"):
        compile_expression("true or bad", SYSTEM, named={"bad": "a.z > 1"})


def test_what_is_not_a_number_is_in_no_comparison_and_in_every_extreme():
    nan = {"a.x": math.nan, "a.y": 1.0}
    for sign in ("<", "<=", ">", ">=", "=="):
        assert value(f"a.x {sign} 1", nan) == 0
    assert value("a.x != 1", nan) == 1
    for text in ("min(a.x, a.y)", "max(a.y, a.x)", "norm(a.x, a.y)"):
        assert math.isnan(value(text, nan))
    assert value("a.y / 0", {"a.y": -1.0}) == -math.inf


@pytest.mark.parametrize(
    ("text", "place", "sentence"),
    [
        ("", 1, "it ends, expected a value"),
        ("a.x <", 6, "it ends, expected a value"),
        ("a.x < < 2", 7, "there is '<', expected a value"),
        ("a.x $ 2", 5, "'$' has no meaning"),
        ("(a.x", 5, "it ends, expected"),
        ("a.x)", 4, "there is ')'"),
        ("a.x + a.v", 5, "'+' joins m and m/s, expected one dimension"),
        ("a.x < 3 deg", 5, "'<' joins m and rad"),
        ("max(a.x, 2 s)", 1, "max() joins m and s"),
        ("a.x < 3 furlongs", 7, "the unit 'furlongs' is not known"),
        ("a.x < 3 nm", 7, "did you mean 'nmi'?"),
        ("1 > 3 m/a.x", 5, "the unit 'm/a.x' is not known; between a unit and a sign belongs a blank"),
        ("b.x < 3", 1, "there is no component 'b'; did you mean 'a.x'?"),
        ("a.xx < 3", 1, "component 'a' has no variable 'xx'"),
        ("a.fix > 3", 1, "'a.fix' is a bundle, expected one of its members: fix.height, fix.valid"),
        ("a.rate > 3", 1, "this is an array of 3"),
        ("a.label == 1", 1, "'a.label' is a text"),
        ("a.tau > 1", 1, "'a.tau' is a parameter"),
        ("a.u@true > 1", 1, "only outputs have a value without faults"),
        ("a.x and true", 1, "this is a number, expected a truth value"),
        ("a.x + a.fix.valid", 7, "this is a truth value, expected a number"),
        ("not a.mode", 5, "this is a number, expected a truth value"),
        ("sqrt(a.x)", 1, "sqrt() of m, expected even powers"),
        ("sqrt(1, 2)", 1, "sqrt() takes one value, not 2"),
        ("norm()", 1, "norm() takes at least one value"),
        ("cos(a.x)", 1, "there is no function 'cos'"),
        ("nrm(a.x)", 1, "did you mean 'norm'?"),
        ("active(h)", 8, "there is no fault 'h' (faults: g)"),
        ("active(1)", 1, "active() takes the id of one fault"),
        ("1e999 < a.x", 1, "this number is too large"),
        ("-" * 150 + "1", 101, "more than 100 parts within one another"),
        ("1" + " + 1" * 600, 2001, "expected at most 2000 characters"),
        ("a.x\x00", 4, "has no meaning"),
    ],
)
def test_what_cannot_be_is_a_sentence_with_the_place(text, place, sentence):
    with pytest.raises(ExpressionError) as caught:
        compile_expression(text, SYSTEM, ["g"], boolean=None)
    assert caught.value.at == place
    assert sentence in str(caught.value)
    assert str(caught.value).isprintable()


def test_whether_it_is_a_truth_value_can_be_asked_for():
    with pytest.raises(ExpressionError, match="expected a truth value, such as 'x < 1', but this is a number"):
        compile_expression("a.x", SYSTEM, boolean=True)
    with pytest.raises(ExpressionError, match="expected a number, but this is a truth value"):
        compile_expression("a.x < 1", SYSTEM, boolean=False)


def test_a_deep_stack_is_refused():
    deep = "a.bare"
    for _ in range(80):
        deep = f"a.bare + ({deep})"
    with pytest.raises(ExpressionError, match="it takes 81 values at a time, expected at most 64"):
        compile_expression(deep, SYSTEM)


PLAIN = {"p": Description("p", "", "p", tuple(out(n) for n in "xyz") + tuple(out(n, type="Boolean") for n in "tf"))}


def test_python_reads_the_same_text_in_the_same_way():
    """Precedence, chains of comparisons and brackets against another reader: Python's."""
    draw = random.Random(3)
    for _ in range(1500):
        text = random_text(draw, draw.randint(1, 4), draw.random() < 0.6)
        signals = {f"p.{n}": draw.choice([-2.0, -0.5, 0.0, 0.5, 1.0, 3.0]) for n in "xyz"} | {"p.t": 1.0, "p.f": 0.0}
        program = compile_expression(text, PLAIN)
        ours = program.value([signals[str(source)] for source in program.sources], 7.0)
        assert np.array_equal(ours, _by_python(text, signals), equal_nan=True), text


def _by_python(text, signals):
    class P:
        x, y, z, t, f = (np.float64(signals[f"p.{n}"]) for n in "xyztf")

    P.t, P.f = bool(P.t), bool(P.f)

    def norm(*values):
        total = values[0] * values[0]
        for other in values[1:]:
            total = total + other * other
        return np.sqrt(np.float64(total))

    def extreme(compare):
        def of(*values):
            return np.float64(math.nan) if any(map(math.isnan, values)) else compare(values)

        return of

    names = {"p": P, "true": True, "false": False, "norm": norm, "sqrt": lambda v: np.sqrt(np.float64(v))}
    names |= {"min": extreme(min), "max": extreme(max)}
    numbers = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e\d+)?|\.\d+)", r"F(\1)", text)  # plain ones are not IEEE 754 in Python
    with np.errstate(all="ignore"):
        return np.float64(eval(numbers, names | {"F": np.float64, "time": np.float64(7.0)}))


def test_operations_have_their_place_on_the_stack():
    """What the depth is calculated from: these push, these take two, the others change the top."""
    assert [op.name for op in Op if op <= Op.ACTIVE] == ["CONSTANT", "LOAD_SIGNAL", "TIME", "ACTIVE"]
    assert [op.name for op in Op if Op.ACTIVE < op < Op.PLUS] == ["NEGATE", "ABS", "SQUARE", "SQRT", "NOT"]
