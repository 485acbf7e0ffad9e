"""A model in plain NumPy and its traced form are the same function, or the model is refused with a sentence."""

import datetime
import math
import os
import random
import subprocess
import sys
import threading
import time
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import scipy.special
from numpy import array as array_by_name
from numpy.random import random as drawn_by_name

from evidence.compiled import compiled
from evidence.compiled import traced as only_traced
from navfmu.errors import NavfmuError
from navfmu.export.tracing import trace

ROOT = Path(__file__).parents[2]
EYE = np.eye(3)
SKEW = np.array([[0.0, -3.0, 2.0], [3.0, 0.0, -1.0], [-2.0, 1.0, 0.0]])


def traced(function, *arguments):
    """Trace ``function`` with symbols in the shapes of ``arguments``, compile it and run it with their values."""
    return compiled([(function, arguments)])[0](*arguments)


A = np.random.default_rng(1).normal(size=3)
B = np.random.default_rng(2).normal(size=3)
M = np.random.default_rng(3).normal(size=(3, 3))
N = np.random.default_rng(4).normal(size=(2, 3))
S = np.float64(0.7)
V = np.random.default_rng(5).normal(size=37)
T = np.array([True, False, True])

EXACT = {
    "arithmetic": (lambda a, b: 2 * a - b / 3 + a * b - (-a) + abs(b) / (1 + a * a), A, B),
    "cancellation is kept": (lambda a, b: (a + b) - b, A * 1e-9, B),
    "twice a half": (lambda a: 0.1 * a + 0.2 * a - 0.3 * a, A),
    "powers": (lambda a: a**2 + a**-1 + abs(a) ** 0.5 + np.square(a) + a**1 + a**0, A),
    "scalar and array": (lambda s, a: s * a + a[0] * s - 1 / s, S, A),
    "numpy scalar first": (lambda a: np.float64(3.0) * a[1] + np.pi * a, A),
    "elements to array": (lambda a, s: np.array([a[0], 1.0, s]) + np.array([[1, s, a[2]]] * 3), A, S),
    "asarray and full": (lambda a, s: np.asarray([a[0], s, 2]) + np.full(3, s), A, S),
    "array imported by name": (lambda a, s: array_by_name([a[0], a[1], s]) + a, A, S),
    "matrix times vector": (lambda m: SKEW @ m @ EYE[0] + m[0] @ m[1], M),
    "cross": (lambda a, b: np.cross(a, b) + np.cross(a, [1.0, 2.0, 3.0]), A, B),
    "outer": (lambda a, b: np.outer(a, b) + np.multiply.outer(a, b), A, B),
    "dot": (lambda a: np.dot(SKEW, a) + np.inner(a, EYE[1]) + a.dot(EYE), A),
    "norm": (lambda m: np.linalg.norm(m, axis=1), M),
    "joining": (lambda a, n: np.concatenate([np.stack([a, 2 * a]), n, np.vstack([a, a]), np.ones((1, 3))]), A, N),
    "columns": (lambda a, n: np.column_stack([a, n.T]) + np.hstack([n.T, a[:, None]]), A, N),
    "block": (lambda m, s: np.block([[m, np.zeros((3, 2))], [np.ones((1, 4)), s * np.ones((1, 1))]]), M, S),
    "einsum": (lambda m: np.einsum("ij,kj->ik", m, EYE), M),
    "cross of many": (
        lambda m, a: np.cross(m, m[::-1]) + np.cross(m, a, axisa=0) + np.cross(m, m.T, axis=0),
        M,
        A,
    ),
    "kron": (lambda m: np.kron(m, EYE) + np.kron(EYE, m), M),
    "diagonals": (lambda a, m: np.diag(a) + np.diag(np.diag(m)) + np.trace(m), A, M),
    "triangles": (lambda m: np.triu(m) + 2 * np.tril(m, -1), M),
    "reshaping": (lambda n: n.reshape(3, 2).T + np.reshape(n, (2, 3)) + np.transpose(n.T) + n.ravel()[0], N),
    "tile, repeat, roll, flip": (lambda a: np.tile(a, 2) + np.repeat(a, 2) + np.roll(np.tile(a, 2), 1)[::-1], A),
    "cumulated sums": (lambda v: np.cumsum(v) + np.cumprod(v[:4]).sum() + np.diff(v, prepend=0.0), V),
    "long sum": (lambda v: np.sum(v) + v.sum() + np.sum(v[:12]) + np.sum(v[:7]), V),
    "sums over axes": (lambda m: m.sum(axis=0) + np.sum(m, axis=1) + np.prod(m, axis=0), M),
    "sums of a lone number over an axis": (lambda s: np.sum(s, axis=0) + np.max(s, axis=-1, keepdims=True), S),
    "very long sum": (lambda v: np.sum(np.tile(v, 9)), V),
    "nothing, summed": (
        lambda a: np.concatenate([np.cumsum(a[:0]), [np.sum(a[:0])], np.cumsum(a[:0, None], 0)[:, 0]]),
        A,
    ),
    "mean": (lambda m, v: np.mean(m, axis=0) + v.mean(), M, V),
    "python sum and for": (lambda v: sum(v[:5]) + sum(x * y for x, y in zip(v[:9], v[9:18], strict=True)), V),
    "unpacking": (lambda a: (lambda x, y, z: np.array([z, y, x]))(*a), A),
    "index arrays": (lambda v: v[[0, 5, 3]] + v[np.array([1, 2, 3])] + v[-3:], V),
    "constant mask": (lambda v: v[np.arange(37) % 5 == 0], V),
    "item assignment in own arrays": (lambda a, s: _assigned(a, s), A, S),
    "add in place": (lambda a, s: _accumulated(a, s), A, S),
    "a total that goes on, kept as it was": (lambda a: _totals(a), A),
    "views by functions, assigned to": (lambda v: _through_functions(v), V),
    "the array itself, assigned to": (lambda a: _the_same(a), A),
    "filled": (lambda a: _all_at_once(a), A),
    "where": (lambda a, b: np.where(a > b, a, 1.0) + np.where(np.array([True, False, True]), a, b), A, B),
    "where guards": (lambda a: np.where(a > 0, np.sqrt(np.where(a > 0, a, 1.0)), 7.0), A),
    "select": (lambda a: np.select([a > 0.5, a > 0], [a, 2 * a], default=-1.0), A),
    "clip": (lambda a: np.clip(a, -0.5, 0.5) + a.clip(-1, 0.1) + np.clip(a, None, 0) + np.clip(a, a[0], None), A),
    "maximum": (lambda a, b: np.maximum(a, b) + np.minimum(a, 0.1) + np.fmax(a, b) + np.fmin(1, b), A, B),
    "max over axis": (lambda m: np.max(m, axis=0) + m.min() + np.amax(m), M),
    "sign": (lambda a: np.sign(a) + np.sign(a * 0) + np.copysign(2.0, a), A),
    "rounding": (lambda a: np.floor(9 * a) + np.ceil(9 * a) + np.trunc(9 * a) + np.rint(9 * a) + np.round(a), A),
    "halves to even": (lambda a: np.rint(a), np.array([0.5, 1.5, 2.5, -0.5, -1.5, 2.4999, 7.0])),
    "remainders": (lambda a: np.mod(9 * a, 2.0) + (a % -0.3) + np.fmod(7 * a, 0.7) + 9 * a // 2, A),
    "remainder by traced": (lambda a, b: np.mod(9 * a, b) + np.floor_divide(5 * a, b), A, B),
    "angle wrap": (lambda a: np.mod(9 * a + np.pi, 2 * np.pi) - np.pi, A),
    "comparisons": (lambda a, b: np.stack([a < b, a <= b, a > b, a >= b, a == b, a != b, a < 0, 0 < a]), A, B),
    "logic": (lambda a, b: np.logical_and(a > 0, b > 0) | np.logical_or(a > 1, b < 0) & ~(a < b) ^ (b > 0), A, B),
    "logic on numbers": (lambda a: np.logical_not(a) | np.logical_xor(a, a - a) | np.logical_and(a, 1), A),
    "truth values": (lambda t, a: np.where(t & (a > 0), a, 0) + t + t * a + (1 - t) + (t + t), T, A),
    "truth values joined with numbers": (
        lambda t, a: np.concatenate([t, a])[0] + np.array([t[0], 2.0])[0] + t[0],
        T,
        A,
    ),
    "choice of truth value or number": (lambda t, a: (lambda c: c + c)(np.where([True, True, False], t, a)), T, A),
    "sums and products of truth values": (lambda t: np.cumsum(t) + np.cumsum(t[:1]) + np.prod(t[:1]) + t.sum(), T),
    "truth values stored": (lambda t, a: _stored_truth(t, a), T, A),
    "types on request": (lambda t, a: np.array(t, float) + np.array(t, dtype=float) + np.array(3 * a, int), T, A),
    "truth on request": (lambda a: (lambda c: c + c)(np.array([a[0], 0.0, 3.0], bool)), A),
    "full of a type": (lambda t: (lambda c: c + c)(np.full(2, t[0], float)), T),
    "any and all": (lambda a: np.array([np.any(a > 0), np.all(a > 0), (a > 9).any(), np.all(a < 9)]), A),
    "counting": (lambda a: np.sum(a > 0) + np.count_nonzero(a > 0) + np.cumsum(a > 0), A),
    "astype": (lambda t, a: t.astype(float) * a + (a > 0).astype(int) + (3 * a).astype(int), T, A),
    "finite": (lambda a: np.isfinite(a) & ~np.isnan(a) & ~np.isinf(a), np.array([1.0, np.nan, np.inf, -np.inf])),
    "nan spreads": (lambda a: np.maximum(a, 0.0) + np.minimum(1.0, a), np.array([1.0, np.nan, -2.0])),
    "zeros_like": (lambda a: np.zeros_like(a) + np.ones_like(a) * a + np.full_like(a, a[0]), A),
    "degrees": (lambda a: np.deg2rad(a) + np.radians(a) + np.rad2deg(a), A),
    "interp": (lambda a: np.interp(a, [-1.0, 0.0, 0.25, 1.0], [3.0, 1.0, 4.0, 1.5]), A),
    "zeros, then assigned": (lambda a: _filled(a), A),
    "an array of constants, then assigned": (lambda a: _changed(a), A),
    "copies of constants, assigned to": (lambda a: _copied(a), A),
    "made like another one, then assigned": (lambda a: _made_like(a), A),
    "diagonals filled": (lambda a: _diagonals(a), A),
    "constants alone": (lambda a: _of_constants(a), A),
    "empty, then assigned": (lambda a: _filled_from_nothing(a), A),
    "rows assigned through views": (lambda m: _through_views(m), M),
    "assigned where a mask holds": (lambda a, m: _masked(a, m), A, M),
    "a mask on both sides": (lambda a, b, m: _mask_on_both_sides(a, b, m), A, B, M),
    "a table that is kept": (lambda a: a * _kept(3), A),
    "index of the largest": (lambda v, m: v.argmax() + np.argmin(v) + m.argmax(axis=0) + np.argmin(m, axis=1), V, M),
    "first of equal ones, and NaN": (
        lambda a: np.stack([np.argmax(a, axis=1), np.argmin(a, axis=1), np.argmax(a, 1, keepdims=True)[:, 0]]),
        np.array([[1.0, 3.0, 3.0, 1.0], [1.0, np.nan, 5.0, np.nan], [np.nan, 0.0, 1.0, -np.inf], [2.0, 2.0, 2.0, 2.0]]),
    ),
    "sorted": (lambda v, m: np.concatenate([np.sort(v), np.sort(m).ravel(), np.sort(m, axis=None)]), V, M),
    "sorted in place": (lambda m: _sorted_in_place(m), M),
    "sorted with NaN": (lambda a: np.sort(a), np.array([3.0, np.nan, -np.inf, 1.0, np.nan, np.inf, 2.0, 2.0, -7.0])),
    "median": (lambda v, m: np.median(v) + np.median(v[:4]) + np.median(m, axis=0) + np.median(m, 1)[0], V, M),
    "median of NaN": (lambda a: np.median(a), np.array([3.0, np.nan, 1.0])),
    "variance": (lambda v, m: np.var(v) + np.std(v, ddof=1) + np.var(m, axis=0) + m.std(axis=1) + v.var(), V, M),
    "linspace": (lambda a: np.linspace(a[0], a[1], 7) + np.linspace(0, a[2], 7, endpoint=False), A),
    "linspace of arrays": (lambda a, b: np.linspace(a, b, 4) + np.linspace(a, b[0], 3, axis=1).ravel()[0], A, B),
    "linspace of nothing": (lambda a: np.linspace(a[0], a[0], 3) + np.linspace(a[0], 2.0, 1), A),
    "numbers for NaN": (
        lambda a: np.nan_to_num(a) + np.nan_to_num(a, nan=7.0, posinf=1.0, neginf=-1.0),
        np.array([np.nan, np.inf, -np.inf, -0.0, 2.0]),
    ),
    "close": (
        lambda a, b: np.isclose(a, b) + 2 * np.isclose(a, b, equal_nan=True) + 4 * np.allclose(a, b),
        np.array([1.0, 1.0, np.nan, np.inf, 0.0]),
        np.array([1.0 + 1e-6, 1.1, np.nan, np.inf, 1e-9]),
    ),
    "square roots": (lambda a: np.sqrt(abs(a)) + 1 / np.sqrt(1 + a * a), A),
}

LIBRARY = {  # NumPy and the C library may differ in the last place
    "exp and log": lambda a: np.exp(a) + np.log(abs(a)) + np.expm1(a) + np.log1p(abs(a)),
    "other logarithms": lambda a: np.log2(abs(a)) + np.log10(abs(a)) + np.exp2(a),
    "sin, cos, tan": lambda a: np.sin(a) + np.cos(a) + np.tan(a),
    "inverse": lambda a: np.arcsin(a / 9) + np.arccos(a / 9) + np.arctan(a) + np.arctan2(a, 2.0) + np.arctan2(1.0, a),
    "hyperbolic": lambda a: np.sinh(a) + np.cosh(a) + np.tanh(a) + np.arcsinh(a) + np.arctanh(a / 9),
    "hypot": lambda a: np.hypot(a, 1.0) + np.hypot(3.0, a) + np.linalg.norm(a),
    "powers": lambda a: a**3 + abs(a) ** 1.7 + 2.0 ** (a[0]) + np.power(abs(a), a) + a**-2,
    "einsum of one": lambda a: (lambda m: np.einsum("ii", m) + np.einsum("ij->j", m) + np.einsum("ii->i", m))(
        np.outer(a, a + 1.0)
    ),
    "einsum of more": lambda a: (lambda m: np.einsum("ij,kj,j->ik", m, SKEW, a) @ a + np.einsum("ij,jk", m, m)[0])(
        np.outer(a, a)
    ),
    "products": lambda a: np.outer(a, a) @ a + a @ a + np.vdot(a, a) + np.linalg.multi_dot([SKEW, SKEW, a]),
}


def _assigned(a, s):
    b = a.copy()
    b[1] = s
    b[2:] = a[:1]
    return b


def _filled(a):
    b = np.zeros((2, 3))
    b[0] = a
    b[1, 1:] += a[:2]
    c = np.eye(3)
    c[2, 0] = a[1]
    d = np.ones(2)
    d[0] = a[0] > 0.0
    return b @ c + d[:, None] + np.full((2, 3), 2.0)


def _changed(a):
    f = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    f[0, 1] = a[0]
    f[2, 1:] += a[1]
    g = np.diag([1.0, 2.0, 3.0])
    g[:, 0] *= a
    steps = np.arange(3.0)
    steps[1] = a[2]
    return np.concatenate([f, g, steps[None]])


def _copied(a):
    f = SKEW.copy()
    f[0] = a
    g = EYE * 2.0
    g[1, 1] = a[0]
    h = np.array(EYE)
    h += a[1]
    return np.concatenate([f, g, h, SKEW + EYE])


def _made_like(a):
    f = np.zeros_like(SKEW)
    f[1:] = a
    g = np.ones_like(EYE)
    g[0, 2] = a[0]
    h = np.full_like(EYE, 7.0)
    h[2] -= a[2]
    return np.concatenate([f, g, h])


def _diagonals(a):
    f, g = SKEW.copy(), np.zeros((7, 3))
    np.fill_diagonal(f, a)
    np.fill_diagonal(g, a[:2], wrap=True)
    np.fill_diagonal(g[4:], 2.0)
    return np.concatenate([f, g])


def _of_constants(a):
    """What NumPy can do with constants, it can also where others have room for traced values."""
    f = np.array([3.0, 1.0, 2.0])
    g = f[np.argsort(f)] + np.linalg.eigvalsh(EYE) + np.searchsorted(f, f) + f.argsort() + np.spacing(f)
    f[0] = np.interp(a[0], np.array([0.0, 1.0]), np.array([1.0, 2.0]))
    return f + g


def _filled_from_nothing(a):
    b = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            b[i, j] = a[i] * j
    return b


def _through_views(m):
    b = np.zeros((3, 4))
    for i, row in enumerate(b.T[:3]):
        row[...] = m[i]
    b[:, 3] = b[:, 0] + 1.0
    return b


def _masked(a, m):
    b, n = a.copy(), 1.0 * m
    b[a > 0.0] = 0.0
    b[a < -1.0] = a[0]
    n[a > 0.0] = 7.0
    n[m < 0.0] = m[0, 0]
    return b + n


def _mask_on_both_sides(a, b, m):
    x, y, z = a.copy(), 2.0 * b, np.zeros((3, 3))
    x[a > 0.0] = b[a > 0.0]
    y[b < a] += np.sqrt(np.abs(x[b < a])) / a[b < a] - a[0] * x[b < a] ** 2
    z[a < 1.0] = m[a < 1.0] * b
    z[m > 0.0] -= 1.0
    return x + y + z


@cache
def _kept(n):
    """The constants of a model that are calculated once: as NumPy has them, whenever that is."""
    table = np.zeros(n)
    table[0] = 2.0
    assert table.dtype == float
    return table


def _sorted_in_place(m):
    b = m.copy()
    b.sort(axis=0)
    return b


def _stored_truth(t, a):
    b, c = ~t, 2 * a
    b[0] = a[0]
    c[1] = t[0]
    return np.where(b, c + c, b + b)


def _accumulated(a, s):
    b = 2 * a
    c = b
    b += s
    return b + c


def _totals(a):
    """A number is no place: += gives a new one."""
    total, found = 0.0, []
    for x in a:
        total += x
        found.append(total)
    first = last = np.sum(a)
    last *= 2.0
    count = more = np.sum(a > 0.0)
    more += 0.5
    return np.array([*found, first, last, count, more])


def _through_functions(v):
    b = 2.0 * v[:36]
    np.ravel(b)[0] = 1.0
    np.reshape(b, (6, 6))[1] = 2.0
    np.transpose(np.reshape(b, (6, 6)))[3, 2] = 3.0
    np.squeeze(b[None])[4] = 4.0
    np.flip(b)[0] = 5.0
    np.split(b, 2)[1][5] = 6.0
    np.swapaxes(np.expand_dims(b, 0), 0, 1)[6] = 7.0
    np.moveaxis(np.atleast_2d(b), 0, 1)[-7] = 8.0
    return b


def _the_same(a):
    b = 2.0 * a
    np.asarray(b)[0] = 1.0
    b.astype(float, copy=False)[1] = 2.0
    np.array(b)[2] = b.astype(float)[2] = np.copy(b)[2] = 3.0
    return b


def _all_at_once(a):
    b = np.zeros(3)
    b.fill(a[0])
    b[0] += 1.0
    return b


@pytest.fixture(scope="module")
def native():
    """The functions of both tables, compiled."""
    functions = {name: (function, arguments) for name, (function, *arguments) in EXACT.items()}
    functions |= {f"library {name}": (function, [A]) for name, function in LIBRARY.items()}
    return dict(zip(functions, compiled(functions.values()), strict=True))


@pytest.mark.parametrize("name", EXACT)
def test_traced_function_equals_numpy_to_the_last_bit(name, native):
    function, *arguments = EXACT[name]
    with np.errstate(invalid="ignore"):
        expected = np.asarray(function(*arguments)).astype(float)
    result = native[name](*arguments)
    assert result.shape == expected.shape
    np.testing.assert_array_equal(result, expected)


@pytest.mark.parametrize("name", LIBRARY)
def test_traced_library_functions_equal_numpy_to_a_few_last_places(name, native):
    np.testing.assert_allclose(native[f"library {name}"](A), LIBRARY[name](A), rtol=1e-15, atol=2e-15)


def strapdown_filter(x, p, z, h):
    """One step of a nine-state filter: position, velocity, attitude errors; prediction and three updates."""
    eye, zero = np.eye(3), np.zeros((3, 3))
    c, s = np.sqrt(1 - x[6] ** 2), x[6]
    c_nb = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    f = np.block([[eye, h * eye, zero], [zero, eye, h * c_nb], [zero, zero, (1 - h / 100) * eye]])
    x = np.concatenate([x[:3] + h * x[3:6], x[3:6] + h * c_nb @ x[6:], (1 - h / 100) * x[6:]])
    p = f @ p @ f.T + h * np.diag([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
    for i in range(3):
        row = np.eye(9)[i]
        k = p @ row / (row @ p @ row + 4.0)
        x = x + k * (z[i] - row @ x)
        j = np.eye(9) - np.outer(k, row)
        p = j @ p @ j.T + 4.0 * np.outer(k, k)
    return np.concatenate([x, ((p + p.T) / 2).ravel()])


FILTER_INPUT = (np.arange(9) * 0.05, np.diag(np.arange(1.0, 10.0)) + 0.01, np.array([1.0, -2.0, 0.5]), np.float64(0.01))


def test_nine_state_filter_equals_numpy_to_the_last_bit():
    """In a process where NumPy's matrix product does not fuse multiplication and addition."""
    code = (
        "import numpy as np; from tests.export.test_trace import *;"
        "e = strapdown_filter(*FILTER_INPUT); r = traced(strapdown_filter, *FILTER_INPUT);"
        "print(np.count_nonzero(e != r), np.count_nonzero(e))"
    )
    environment = os.environ | {"OPENBLAS_CORETYPE": "Nehalem", "PYTHONPATH": str(ROOT)}
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    different, nonzero = map(int, run.stdout.split())
    assert nonzero > 60
    assert different == 0


def test_nine_state_filter_traces_in_less_than_a_second():
    begin = time.process_time()
    only_traced(strapdown_filter, FILTER_INPUT)
    assert time.process_time() - begin < 1.0
    result = traced(strapdown_filter, *FILTER_INPUT)
    np.testing.assert_allclose(result, strapdown_filter(*FILTER_INPUT), rtol=1e-13, atol=1e-15)


MADE_BEFORE = np.zeros(5)


def _store(a):
    MADE_BEFORE[0] = a[0]


def _store_slice(a):
    MADE_BEFORE[1:4] = a


def _add_to_float_array(a):
    b = MADE_BEFORE[:3]
    b += a


def _store_narrow(a):
    """What comes back out of it would have other bits."""
    b = np.zeros(3, np.float32)
    b[:] = a


def _values_for_a_mask(a):
    b = 2.0 * a
    b[a > 0] = a


def _branch(a):
    return 1.0 if a[0] > 0 else 2.0


CHANCE = np.random.default_rng(7)

REFUSED = {
    "if on a value": (_branch, "np.where"),
    "and, or, not": (lambda a: a[0] > 0 and a[1] > 0, "np.logical_and"),
    "max": (lambda a: max(a[0], a[1]), "np.maximum"),
    "chained comparison": (lambda a: 0 < a[0] < 1, "np.logical_and"),
    "while": (lambda a: [None for _ in iter(lambda: bool(a[0] > 0), False)], "np.where"),
    "float": (lambda a: float(a[0]), "instead of float"),
    "numpy's float": (lambda a: np.float64(a[0]), "instead of float"),
    "int": (lambda a: int(a[0]), "np.floor"),
    "math.sin": (lambda a: math.sin(a[0]), "math.*"),
    "math.hypot": (lambda a: math.hypot(a[0], a[1]), "math.*"),
    "range": (lambda a: range(a[0]), "np.where"),
    "index of a list": (lambda a: [1, 2, 3][a[0]], "np.where"),
    "index of a traced array": (lambda a: a[a[0]], "np.where"),
    "mask": (lambda a: a[a > 0], "np.where"),
    "sum over a mask": (lambda a: np.sum(a[a > 0]), "np.where"),
    "another mask": (lambda a: (2.0 * a).__setitem__(a > 0, a[a > 1]), "with one"),
    "array beside a mask": (lambda a: a[a > 0] * a, "np.where"),
    "stack of a mask": (lambda a: np.stack([a[a > 0], a]), "np.where"),
    "store in an array that is there before": (_store, "np.array([...])"),
    "store in a slice of it": (_store_slice, "np.array([...])"),
    "add to it": (_add_to_float_array, "x = x + y"),
    "store in what shows it": (lambda a: np.reshape(MADE_BEFORE, -1).__setitem__(0, a[0]), "np.array([...])"),
    "store in an array of 32 bits": (_store_narrow, "np.zeros"),
    "read before it is assigned": (lambda a: np.empty(3) + a, "np.zeros"),
    "values for a mask": (_values_for_a_mask, "np.where"),
    "inverse of what is not square": (lambda a: np.linalg.inv(np.outer(a, a)[:2]), "(n, n)"),
    "right sides of another length": (lambda a: np.linalg.solve(EYE, a[:2] * a[0]), "as many rows"),
    "argsort": (lambda a: np.argsort(a), "np.sort"),
    "argsort method": (lambda a: a.argsort(), "np.sort"),
    "least squares": (lambda a: np.linalg.lstsq(EYE, a), "normal equations"),
    "eigenvalues": (lambda a: np.linalg.eigh(np.outer(a, a)), "fixed number"),
    "pseudoinverse": (lambda a: np.linalg.pinv(np.outer(a, a)), "np.linalg.solve(A.T @ A, A.T)"),
    "search in numbers": (lambda a: np.searchsorted(np.arange(4.0), a), "Table"),
    "function of another library": (lambda a: scipy.special.erf(a), "functions that can"),
    "random number": (lambda a: a + np.random.standard_normal(3), "noise(n)"),  # noqa: NPY002
    "random number of a generator": (lambda a: a + CHANCE.normal(size=3), "noise(n)"),
    "random number of Python": (lambda a: a + random.gauss(0.0, 1.0), "noise(n)"),
    "random numbers with a seed": (lambda a: a + np.random.default_rng(7).normal(size=3), "outside of functions"),
    "random number by a name of its own": (lambda a: a * drawn_by_name(), "noise(n)"),  # noqa: NPY002
    "clock": (lambda a: a * time.time(), "self.time"),
    "date": (lambda a: a * datetime.datetime.now().hour, "self.time"),
    "environment": (lambda a: a * len(os.environ["PATH"]), "Parameter"),
    "printed with a format": (lambda a: f"{a[0]:.3f}", "runs with floats"),
    "comparison with a text": (lambda a: a[0] == "track", "IntEnum"),
    "unknown ufunc": (lambda a: np.spacing(a), "functions that can"),
    "where with one argument": (lambda a: np.where(a > 0), "both branches"),
    "ufunc with where": (lambda a: np.sqrt(a, where=a > 0), "np.where"),
    "invert a number": (lambda a: ~a, "compare first"),
    "complex": (lambda a: complex(a[0]), "real"),
    "dict key": (lambda a: {a[0]: 1}, "np.where"),
    "product of truth values": (lambda a: (a > 0) @ (a > 1), "astype(float)"),
    "difference of truth values": (lambda a: (a > 0) - (a > 1), "np.logical_xor"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_traced_names_file_line_and_remedy(name):
    function, remedy = REFUSED[name]
    with pytest.raises(NavfmuError) as caught:
        traced(function, A)
    code = function.__code__
    sentence = str(caught.value)
    assert sentence.startswith(f"{code.co_filename}, line ")
    line = int(sentence.split("line ", 1)[1].split(":", 1)[0])
    assert code.co_firstlineno <= line <= code.co_firstlineno + 3
    assert remedy in sentence


def test_object_array_that_mixes_floats_and_symbols_does_not_fall_through():
    """An array made behind the tracer's back still computes what NumPy computes, or is refused."""
    mixed = np.empty(3, object)

    def function(a):
        mixed[:] = [a[0], 2.0, np.float64(3.0)]
        return np.where(mixed * a > 0, mixed + 1, a)

    expected = np.where(np.array([A[0], 2.0, 3.0]) * A > 0, np.array([A[0], 2.0, 3.0]) + 1, A)
    np.testing.assert_array_equal(traced(function, A), expected)
    with pytest.raises(TypeError, match="sqrt"):
        traced(lambda a: (function(a), np.sqrt(mixed))[1], A)


def test_numpy_is_left_as_it_was():
    before = (np.array, np.asarray, np.full)
    with pytest.raises(NavfmuError), trace.tracing():
        traced(_branch, A)
    assert before == (np.array, np.asarray, np.full)


def test_dates_that_are_written_are_traced_and_libraries_read_what_they_like():
    """Wrong: a date is refused because it could tell the present one, or a path because a library asks for it."""

    seen = []

    def function(a):
        thread = threading.Thread(target=lambda: seen.append(time.time() + len(os.environ["PATH"])))
        thread.start()
        thread.join()
        then = datetime.datetime(2026, 11, 30)
        return a * then.day + isinstance(then, datetime.date) + len(os.path.expanduser("~"))

    assert np.array_equal(traced(function, A), function(A))
    assert len(seen) == 2, "another thread of the same module does not trace"
    assert type(datetime.datetime.now()) is type(datetime.datetime(2026, 11, 30)) is datetime.datetime


def test_two_threads_that_trace_at_once_leave_numpy_as_it_was():
    originals = (np.array, np.full)
    first_inside, second_started = threading.Event(), threading.Event()
    inside = []

    def first():
        with trace.tracing():
            first_inside.set()
            second_started.wait(5.0)
            time.sleep(0.05)
            inside.append("first")

    def second():
        first_inside.wait(5.0)
        second_started.set()
        with trace.tracing():
            inside.append("second")

    threads = [threading.Thread(target=function) for function in (first, second)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10.0)
    assert inside == ["first", "second"]
    assert (np.array, np.full) == originals


def test_constants_of_the_model_are_what_they_were_though_there_was_room():
    """Wrong: the next one who reads them gets an array of objects, or what was written into it."""
    before = [SKEW, EYE, np.diag, np.linalg.inv]
    only_traced(_copied, [A])
    with pytest.raises(NavfmuError):
        only_traced(lambda a: MADE_BEFORE.__setitem__(0, a[0]), [A])
    assert [*map(id, before)] == [*map(id, [SKEW, EYE, np.diag, np.linalg.inv])]
    assert not MADE_BEFORE.any()
    assert MADE_BEFORE.dtype == float


@cache
def _some_constants():
    return np.random.default_rng(7).normal(size=3) + CHANCE.normal(size=3) * 0.0


def test_random_numbers_that_a_function_keeps_are_constants():
    assert np.array_equal(traced(lambda a: a + _some_constants(), A), A + _some_constants())
    assert CHANCE.random() != CHANCE.random(), "the generator of the module is back"
    assert drawn_by_name is np.random.random


def test_only_functions_of_the_model_make_traced_arrays(tmp_path, monkeypatch):
    """Not another thread, nor other libraries, nor a module that is imported meanwhile: they would keep them."""
    late = "from numpy import zeros, array as joined\nTABLE = zeros(3)\nclass Kept:\n    table = zeros(2)\n"
    (tmp_path / "late_tables.py").write_text(late)
    monkeypatch.syspath_prepend(tmp_path)
    found = {}

    def function(a):
        import late_tables

        thread = threading.Thread(target=lambda: found.update(thread=np.zeros(3)))
        thread.start()
        thread.join()
        found.update(table=late_tables.TABLE, kept=late_tables.Kept.table, module=late_tables)
        block = scipy.linalg.block_diag(scipy.linalg.expm(EYE[:2, :2]), EYE[:1, :1])
        return block @ a + late_tables.TABLE + np.pad(EYE[0, :1], 1)

    np.testing.assert_allclose(traced(function, A), function(A), rtol=1e-15)
    only_traced(lambda a: (sys.modules.pop("late_tables"), function(a))[1], [A])
    module = found["module"]
    made = [found["thread"], found["table"], found["kept"], module.zeros(2), module.joined([1.0])]
    assert {(type(array), array.dtype.kind) for array in made} == {(np.ndarray, "f")}
    sys.modules.pop("late_tables")
