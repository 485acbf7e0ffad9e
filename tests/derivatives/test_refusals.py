"""What would lose derivatives without a word, or has none, is refused with file, line and remedy."""

import math
import threading

import numpy as np
import pytest
from numpy import array as array_by_name

from navfmu.derivatives import jacobian
from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, State, every
from navfmu.export.interpreter import Interpreter
from navfmu.export.tracing.lower import lower

OUTSIDE = np.zeros(3)


def _store_outside(x):
    OUTSIDE[0] = x[0]
    return OUTSIDE


def _add_outside(x):
    here = OUTSIDE
    here += x
    return here


def _store_inner(x):
    kept = np.zeros(3)

    def inner(y):
        kept[0] = y[0]
        return kept

    return jacobian(inner, x)


REFUSED = {
    "math": (lambda x: math.sin(x[0]), "np.sin"),
    "float": (lambda x: float(x[0]), "np.sin"),
    "a list for an array": (lambda x: np.sin([x[0], x[1]]), "np.array([...])"),
    "array by a name of its own": (lambda x: array_by_name([x[0], 1.0]), "np.array([...])"),
    "an array made outside": (_store_outside, "np.zeros inside"),
    "added to an array made outside": (_add_outside, "np.zeros inside"),
    "an array made outside of the inner one": (_store_inner, "np.zeros inside"),
    "an index": (lambda x: [1, 2, 3][x[0]], "constants"),
    "partition": (lambda x: np.partition(x, 1), "np.sort"),
    "sort as a method": (lambda x: x.sort(), "NumPy's functions"),
    "quantile": (lambda x: np.quantile(x, 0.5), "np.sort"),
    "a place for the result": (lambda x: np.cumsum(x, out=np.zeros(3)), "assign the result"),
    "where of a ufunc": (lambda x: np.sqrt(x, where=x > 1.0), "np.where"),
    "where of a quotient": (lambda x: np.divide(1.0, x, out=np.zeros_like(x), where=x > 1.0), "np.where"),
    "where of a mean": (lambda x: np.mean(x, where=[True, False, True]), "np.where"),
    "where of a variance": (lambda x: np.var(x, where=[True, False, True]), "np.where"),
    "where of a product": (lambda x: np.prod(x, where=[True, False, True]), "np.where"),
    "least squares": (lambda x: np.linalg.lstsq(np.outer(x, x), x), "np.linalg.solve"),
    "eigenvalues": (lambda x: np.linalg.eigvalsh(np.outer(x, x)), "see the tutorial"),
    "an unknown ufunc": (lambda x: np.spacing(x), "see the tutorial"),
    "an unknown way of a ufunc": (lambda x: np.add.reduceat(x, [0, 1]), "see the tutorial"),
    "norm of another order": (lambda x: np.linalg.norm(x, ord=1), "np.abs"),
    "interp in turns": (lambda x: np.interp(x, [0.0, 1.0], [0.0, 1.0], period=1.0), "np.mod"),
    "interp by abscissae": (lambda x: np.interp(0.5, x, [0.0, 1.0, 2.0]), "write the interpolation out"),
    "two dimensions": (lambda x: np.einsum(x, [0], x, [0], [0]), "'ij,jk->ik'"),
    "nothing": (lambda x: None, "expected numbers"),
    "a text": (lambda x: "x", "expected numbers"),
    "lists of several lengths": (lambda x: [x[:2], x], "of one shape"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_it_names_file_line_and_remedy(name):
    function, remedy = REFUSED[name]
    with pytest.raises(NavfmuError) as caught:
        jacobian(function, np.array([1.0, 2.0, 3.0]))
    code = function.__code__
    sentence = str(caught.value)
    assert sentence.startswith(f"{code.co_filename}, line "), sentence
    line = int(sentence.split("line ", 1)[1].split(":", 1)[0])
    asked = test_it_names_file_line_and_remedy.__code__.co_firstlineno
    assert code.co_firstlineno <= line <= code.co_firstlineno + 8 or line > asked, sentence
    assert remedy in sentence, sentence
    assert not np.any(OUTSIDE)


@pytest.mark.parametrize("x", ["text", None, [[1.0], [1.0, 2.0]], {"a": 1.0}])
def test_x_that_is_no_array_is_refused(x):
    with pytest.raises(NavfmuError, match=r"test_refusals\.py, line \d+: jacobian by .*numbers"):
        jacobian(np.sin, x)


def test_numpy_is_as_it_was_also_after_an_error():
    names = ("array", "asarray", "zeros", "full", "sum", "eye", "max")
    before = [getattr(np, name) for name in names]
    jacobian(np.sin, np.ones(2))
    with pytest.raises(ZeroDivisionError):
        jacobian(lambda x: 1 // 0, np.ones(2))
    with pytest.raises(NavfmuError):
        jacobian(np.partition, np.ones(2), 1)
    assert [getattr(np, name) for name in names] == before


def test_arrays_that_do_not_depend_on_x_are_arrays():
    """Inside, np.zeros gives something that can take derivatives; as long as it has none it does what an array does."""

    def function(x):
        constant = np.eye(3)
        assert np.linalg.eigvalsh(constant + 0.0).tolist() == [1.0, 1.0, 1.0]
        assert math.sin(np.zeros(1)[0]) == 0.0 and float(constant[1, 1]) == 1.0
        assert constant.tolist()[0] == [1.0, 0.0, 0.0] and np.sort(np.ones(2))[0] == 1.0
        assert [1, 2, 3][int(np.ones(1)[0])] == 2 and len(np.zeros((4, 2))) == 4
        constant.sort()
        return x * 2.0

    np.testing.assert_array_equal(jacobian(function, np.ones(3)), 2.0 * np.eye(3))


class Leaking(Component):
    """A value with derivatives becomes an output."""

    pace = Parameter("s", start=0.1, description="period")
    x = State(2, "1", start=[1.0, 2.0], description="where")
    y = Output("1", description="what is assigned")

    @every("pace")
    def inside(self):
        def function(x):
            self.y = x[0] * x[1]
            return x

        jacobian(function, self.x)


class LeakingLater(Component):
    """A value with derivatives is kept, and becomes an output when there are none any more."""

    pace = Parameter("s", start=0.1, description="period")
    x = State(2, "1", start=[1.0, 2.0], description="where")
    y = Output("1", description="what is assigned")

    @every("pace")
    def outside(self):
        kept = []
        jacobian(lambda x: kept.append(x[0]) or x, self.x)
        self.y = kept[0]


@pytest.mark.parametrize("component", [Leaking, LeakingLater])
@pytest.mark.parametrize("way", ["traced", "with floats"])
def test_no_variable_takes_a_value_with_derivatives(component, way):
    def run():
        if way == "traced":
            return lower(component)
        one = Interpreter(component)
        one.setup()
        return one.do_step(0.0, 0.1)

    with pytest.raises(
        NavfmuError, match=r"test_refusals\.py, line \d+: .* a variable of a component\); use .* returns"
    ):
        run()


def test_another_thread_and_a_later_day_have_numpys_own_arrays():
    """Names of NumPy are changed for the whole process, what they do only for the thread that differentiates."""
    made, kept = [], []

    def function(x):
        thread = threading.Thread(target=lambda: made.extend([np.zeros(2), np.array([1.0, 2.0]), np.full(2, 1.0)]))
        thread.start()
        thread.join(5.0)
        kept.extend([np.zeros, np.array, np.eye, np.sum])
        assert type(np.zeros(2)) is not np.ndarray
        return x * 2.0

    jacobian(function, np.ones(2))
    made += [kept[0](2), kept[1]([1.0]), kept[2](2)]
    assert [type(one) for one in made] == 6 * [np.ndarray]
    assert kept[3]([1.0, 2.0]) == 3.0 and kept[1].__name__ == "array"
