"""What does not depend on x is a constant, also where it is a traced value, and whatever side it stands on."""

import math

import numpy as np
import pytest

from evidence.compiled import compiled
from navfmu.derivatives import jacobian, value_and_jacobian

from .differences import extrapolated

RNG = np.random.default_rng(21)
X, K, S, M, T = (
    RNG.normal(size=3),
    RNG.normal(size=3),
    np.float64(0.7),
    RNG.normal(size=(3, 3)),
    np.array([1, 0, 1]) > 0,
)


def by_rows(x, k):
    f = np.zeros((2, 3))
    for row in f:
        row[0] = x[0] * x[1]
    f[1][2] = x[2]
    return f @ k + f[0, 1]


def filled(x, k, s):
    f, g = np.zeros((3, 3)), np.eye(3)
    f[0] = k
    f[:, 1] = x
    f[2, 2] = s
    f[1] += k
    f += np.outer(k, x)
    f[0, 0] = f[0, 0] * s
    g[0, 1] = k[0]
    g[1, 0] = s
    return f @ g @ x


FUNCTIONS = {
    "arithmetic": lambda x, k, s, m, t: k * x + k / x + k - x + s * x + (k + x) * s + k**2 * x,
    "choices": lambda x, k, s, m, t: (
        np.where(t, x, k) + np.where(k > 0, x * x, 0.0) + np.where(s > 0, k, x) + np.where((x > k) & t, x * s, s)
    ),
    "larger, smaller": lambda x, k, s, m, t: (
        np.maximum(k, x) + np.minimum(s, x) + np.clip(x, -s, s) + np.clip(k, x, 1.0)
    ),
    "joining": lambda x, k, s, m, t: (
        np.concatenate([k, x]) + np.hstack([x, [s] * 3]) + np.stack([k, x]).ravel() + np.append(k, x)
    ),
    "inserting": lambda x, k, s, m, t: np.insert(k, 1, x[0]) + np.insert(x, 1, s) + np.array([s, x[0], k[1], 1.0]),
    "products": lambda x, k, s, m, t: (
        m @ x + k @ m * x + np.dot(m, x) + np.outer(k, x) @ k + np.einsum("ij,j->i", m, x) + np.tensordot(m, x, 1)
    ),
    "other products": lambda x, k, s, m, t: np.cross(k, x) + np.kron(k, x)[:3] + np.inner(k, x) + np.vdot(x, k),
    "linear equations": lambda x, k, s, m, t: (
        np.linalg.solve(m + 5.0 * np.eye(3), x) + np.linalg.solve(m + np.diag(x * x + 5.0), k)
    ),
    "rows that are written into": lambda x, k, s, m, t: by_rows(x, k),
    "arrays that are filled": lambda x, k, s, m, t: filled(x, k, s),
    "full arrays": lambda x, k, s, m, t: np.full(3, s) * x[0] + np.full_like(k, x[1]),
    "functions of two": lambda x, k, s, m, t: (
        np.arctan2(k, x) + np.hypot(s, x) + np.abs(k) ** x + np.copysign(k, x) * x + np.mod(k, np.abs(x) + 3.0)
    ),
    "interpolation": lambda x, k, s, m, t: np.interp(x, [-3.0, 0.0, 3.0], np.array([s, 1.0, 2.0])),
    "derivatives by another": lambda x, k, s, m, t: jacobian(lambda s: np.sin(s) * x * s, s),
    "derivatives by a matrix": lambda x, k, s, m, t: jacobian(lambda m: (m + 5.0 * np.eye(3)) @ x * x, m),
}


@pytest.fixture(scope="module", params=[math.inf, 2], ids=["elements", "whole arrays"])
def native(request):
    functions = [(lambda *a, f=f: flat(f, *a), (X, K, S, M, T)) for f in FUNCTIONS.values()]
    return dict(zip(FUNCTIONS, compiled(functions, request.param), strict=True))


def flat(function, *arguments):
    return np.concatenate([np.ravel(one) for one in value_and_jacobian(function, *arguments)])


@pytest.mark.parametrize("name", FUNCTIONS)
def test_constants_are_constants_with_floats(name):
    function = FUNCTIONS[name]
    truth, bound = extrapolated(lambda x: function(x, K, S, M, T), X, 1e-4)
    assert np.all(np.abs(jacobian(function, X, K, S, M, T) - truth) <= bound)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_constants_are_constants_when_traced(name, native):
    """A traced value that stands first is asked first what a call means, and must leave that to the other one."""
    expected = flat(FUNCTIONS[name], X, K, S, M, T)
    np.testing.assert_allclose(native[name](X, K, S, M, T), expected, rtol=0.0, atol=1e-14 * np.max(np.abs(expected)))
