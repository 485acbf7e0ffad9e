"""Drawn programs: chains of calls on arrays of several shapes, with views that are written into."""

import numpy as np
import pytest

from evidence.compiled import compiled
from navfmu.derivatives import jacobian, value_and_jacobian

from .differences import complex_step

PROGRAMS = 300
LENGTH = 12


def squashed(a):
    """Near 1, so that nothing grows without bounds."""
    return np.tanh(a / 3.0)


ONE = [  # array -> array
    np.sin,
    np.cos,
    np.exp,
    squashed,
    lambda a: a * a,
    lambda a: 1.0 / (3.0 + np.sin(a)),
    lambda a: np.sqrt(3.0 + np.cos(a)),
    lambda a: a**3,
    lambda a: -a,
    lambda a: np.flip(a),
    lambda a: a[..., ::-1],
    lambda a: a[1:],
    lambda a: a[-1],
    lambda a: a[[0, -1, 0]],
    lambda a: a.T,
    lambda a: np.ravel(a),
    lambda a: a[:, None],
    lambda a: a.reshape(1, -1),
    lambda a: np.squeeze(a),
    lambda a: np.sum(a, axis=0),
    lambda a: np.sum(a, axis=-1, keepdims=True),
    lambda a: np.mean(a),
    lambda a: np.cumsum(a, axis=-1),
    lambda a: np.prod(a, axis=0),
    lambda a: np.diff(a, axis=0, prepend=0.0),
    lambda a: np.roll(a, 1),
    lambda a: np.tile(a, 2),
    lambda a: np.repeat(a, 2, axis=0),
    lambda a: np.triu(a),
    lambda a: np.diag(a),
    lambda a: np.trace(a),
    lambda a: np.where(np.arange(a.shape[-1]) % 2 == 0, a, 0.5),
    lambda a: a[np.arange(len(a)) % 2 == 0],
    lambda a: np.split(a, [1])[1],
    lambda a: np.moveaxis(a, 0, -1),
]
TWO = [  # two arrays -> array
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (3.0 + np.sin(b)),
    lambda a, b: a @ b,
    lambda a, b: np.dot(a, b),
    lambda a, b: np.outer(a, b),
    lambda a, b: np.inner(a, b),
    lambda a, b: np.kron(a, b),
    lambda a, b: np.einsum("i...,j...->...ij", a, b),
    lambda a, b: np.concatenate([a, b]),
    lambda a, b: np.stack([a, b], axis=-1),
    lambda a, b: np.column_stack([a, b]),
    lambda a, b: np.array([a, 2.0 * b]),
    lambda a, b: np.array([[a[0], 1.0], [b[0], a[-1]]]),
    lambda a, b: np.append(a, b),
    lambda a, b: np.linalg.solve(4.0 * np.eye(len(a)) + squashed(a), squashed(b)),
]


def _first(a, b):
    a[0] = b
    return a


def _view(a, b):
    shown = a[1:]
    shown[0] = b
    return a + 0.0


def _transposed(a, b):
    a.T[-1] = b
    return a


def _added(a, b):
    a += b
    return a


def _scaled_part(a, b):
    a[..., -1] *= b
    return a


def _kept(a, b):
    before = a[0] + 0.0
    a[0] = b
    return a + before


WRITING = [_first, _view, _transposed, _added, _scaled_part, _kept]  # into the first array


def drawn(seed):
    """A program: which call, of which earlier results. What NumPy refuses is left out."""
    rng = np.random.default_rng(seed)
    results = [np.array([0.3, -0.5, 0.8]), np.array([[0.2, 0.1, -0.4], [0.9, -0.3, 0.5], [0.4, 0.7, -0.2]])]
    program = []
    while len(program) < LENGTH:
        calls = [ONE, TWO, WRITING][rng.choice(3, p=[0.45, 0.35, 0.2])]
        call = calls[rng.integers(len(calls))]
        operands = rng.integers(len(results), size=1 if calls is ONE else 2).tolist()
        try:
            result = call(*taken(results, operands, calls is WRITING))
        except (ValueError, IndexError, TypeError, np.exceptions.AxisError, np.linalg.LinAlgError):
            continue
        if np.size(result) > 40 or np.size(result) == 0 or np.max(np.abs(result)) > 20.0:
            continue
        results.append(result)
        program.append((call, operands, calls is WRITING))
    return program


def taken(results, operands, writing):
    chosen = [results[i] for i in operands]
    return [chosen[0] * 1.0, *chosen[1:]] if writing else chosen


def run(program, x):
    """All results of a program, one after the other."""
    results = [x, np.sin(np.outer(x, x)) + x]
    for call, operands, writing in program:
        results.append(call(*taken(results, operands, writing)))
    return np.concatenate([np.ravel(one) for one in results[-4:]])


POINT = np.array([0.31, -0.52, 0.83])


@pytest.mark.parametrize("hundred", range(PROGRAMS // 100))
def test_drawn_programs_have_the_derivatives_of_the_complex_step(hundred):
    """Whatever follows on whatever: where an element comes from is lost or mistaken if a rule is wrong about places."""
    with np.errstate(all="ignore"):
        for seed in range(100 * hundred, 100 * hundred + 100):
            program = drawn(seed)
            value, found = value_and_jacobian(lambda x, p=program: run(p, x), POINT)
            truth = complex_step(lambda x, p=program: run(p, x), POINT)
            np.testing.assert_array_equal(value, run(program, POINT))
            np.testing.assert_allclose(
                found, truth, rtol=1e-11, atol=1e-12 * (1.0 + np.max(np.abs(truth))), err_msg=f"program {seed}"
            )


@pytest.mark.parametrize("whole", [np.inf, 4], ids=["elements", "whole arrays"])
def test_drawn_programs_have_the_same_derivatives_when_compiled(whole):
    """Structure is the same with floats and while tracing; rounding of products and library functions is not."""
    programs = [p for p in map(drawn, range(60)) if not any(call is TWO[-1] for call, _, _ in p)]
    functions = [(lambda x, p=p: jacobian(lambda x: run(p, x), x), [POINT]) for p in programs]
    with np.errstate(all="ignore"):
        for one, (function, _) in zip(compiled(functions, whole), functions, strict=True):
            expected = function(POINT)
            scale = 1.0 + np.max(np.abs(expected))
            np.testing.assert_allclose(one(POINT), expected, rtol=1e-11, atol=1e-12 * scale)
