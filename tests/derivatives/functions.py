"""Functions of a vector of three elements, for each thing that NumPy does: what is tested in several ways.

``ANALYTIC`` ones take complex numbers, too; ``CHOOSING`` ones have branches, or functions that know real numbers only.
"""

from __future__ import annotations

import numpy as np

M = np.random.default_rng(3).normal(size=(3, 3))
N = np.random.default_rng(4).normal(size=(2, 3))
T = np.random.default_rng(6).normal(size=(3, 2, 3))
C = np.random.default_rng(5).normal(size=3)
EYE = np.eye(3)


def positive_definite(x):
    return np.outer(x, x) + np.diag(x * x) + 4.0 * EYE


def assigned(x):
    matrix = np.zeros((3, 3))
    matrix[0, 1] = x[0]
    matrix[1] = x * x
    row = matrix[2]
    row[0] = x[1] * x[2]  # a view: this is an element of the matrix
    matrix.T[2, 0] += x[2]
    matrix[0] *= 2.0
    matrix[:, 1] = np.stack([x[0], x[0], 1.0])
    return matrix @ x


def diagonals(x):
    square, tall = np.outer(x, x), np.zeros((7, 3))
    np.fill_diagonal(square, x * x)
    np.fill_diagonal(tall, x[:2], wrap=True)
    np.fill_diagonal(tall[4:], 2.0)
    return np.concatenate([square, tall])


def accumulated(x):
    b = 2.0 * x
    c = b
    b += x[0]
    b[1:] *= x[1]
    return b + c  # both are the changed one


def symmetric_fill(x):
    p = np.empty((3, 3))
    for i in range(3):
        for j in range(i, 3):
            p[i, j] = p[j, i] = x[i] * x[j] + i
    q = p.copy()
    q[0, 0] = 0.0
    return p - q + p.reshape(9)[::4]


def aliases(x):
    y = np.asarray(2.0 * x)
    itself, copied, turned, flat = np.asarray(y, float), np.array(y), np.outer(y, x).T, np.outer(y, x)
    itself[0] = 5.0 * x[1]  # y, too
    copied[1] = x[0]  # nothing else
    turned[0, 1] *= x[2]
    flat.ravel()[1] = x[0]  # a view
    flat.flatten()[2] = x[0]  # a copy
    flat.reshape(3, 3)[2][1] += x[1]
    first, *others = flat
    others[0][:] = first  # rows are views
    first[:] = 0.0
    return np.stack([y, itself, copied, *turned, *flat])


def mixed_row(x):
    a, b, c = x
    return np.array([[a, 1.0, b * c], [0.0, np.sin(a), 2.0], [a * b, b, np.exp(c)]])


ANALYTIC = {
    "sum and difference": lambda x: (x + C) - (3.0 - x) + (C + x) - x[0],
    "negative, positive": lambda x: -x + (+x) * 2.0,
    "product": lambda x: x * x[::-1] * C,
    "product with numbers": lambda x: 3 * x * np.float64(0.5) * x[1],
    "quotient": lambda x: x / (x[::-1] + 5.0) + 1.0 / (x + 4.0) + x / 3.0,
    "whole powers": lambda x: x**2 + x**3 + (x + 4.0) ** -2 + x**1 + x**0,
    "broken powers": lambda x: (x + 4.0) ** 0.5 + (x + 4.0) ** 1.7,
    "power of a number": lambda x: 2.0**x + (x + 4.0) ** x[0],
    "numbers' powers": lambda x: x[0] ** 2 + (x[1] + 4.0) ** 0.5 + 3.0 ** x[2],
    "square, reciprocal": lambda x: np.square(x) + np.reciprocal(x + 4.0),
    "roots": lambda x: np.sqrt(x + 4.0),
    "exp": lambda x: np.exp(x) + np.expm1(x) + np.exp2(x),
    "log": lambda x: np.log(x + 4.0) + np.log1p(x + 4.0) + np.log2(x + 4.0) + np.log10(x + 4.0),
    "sin, cos, tan": lambda x: np.sin(x) + np.cos(x) * C + np.tan(x) * N[0],
    "inverse functions": lambda x: np.arcsin(x / 4.0) + C * np.arccos(x / 4.0) + np.arctan(x) * N[0],
    "hyperbolic": lambda x: np.sinh(x) + C * np.cosh(x) + np.tanh(x) * N[0],
    "inverse hyperbolic": lambda x: np.arcsinh(x) + C * np.arccosh(x + 5.0) + np.arctanh(x / 4.0) * N[0],
    "matrix times vector": lambda x: M @ x + x @ M + (x @ x) * x,
    "matrix times matrix": lambda x: np.outer(x, x) @ M @ np.diag(x),
    "stacked matrices": lambda x: (T * x) @ np.outer(x, x) + (x @ T.transpose(0, 2, 1))[..., None] * x,
    "dot": lambda x: np.dot(M, x) + np.dot(x, x) * np.dot(x, 2.0) + x.dot(M),
    "dot of stacks": lambda x: np.dot(T * x, np.outer(x, x)),
    "inner, vdot": lambda x: (
        np.inner(N, x)[0] + np.inner(np.outer(x, C), M) + np.dot(np.ravel(M), np.outer(x, x).ravel())
    ),
    "tensordot": lambda x: np.tensordot(np.outer(x, x), T, axes=([1], [2])) + np.tensordot(M, np.outer(x, x), 2),
    "outer": lambda x: np.outer(x, C) + np.multiply.outer(x, x) + np.add.outer(x, x),
    "kron": lambda x: np.kron(np.outer(x, x), N) + np.kron(N, np.outer(x, x)) + np.kron(x, N)[0, 0],
    "cross": lambda x: np.cross(x, C) + np.cross(M, x) + np.cross(x[::-1], x),
    "einsum": lambda x: np.einsum("ij,jk,k->i", np.outer(x, x), M, x) + np.einsum("ii", np.outer(x, x)),
    "einsum of many axes": lambda x: (
        np.einsum("ij,...kj->...ki", np.outer(x, x), T) + np.einsum("ij,kj", M, T[0] * x).T
    ),
    "einsum of a diagonal": lambda x: (
        np.einsum("ii->i", np.outer(x, x)) + np.einsum("iji->j", np.outer(x, x)[:, :, None] * x)
    ),
    "multi_dot, matrix_power": lambda x: (
        np.linalg.multi_dot([M, np.outer(x, x), x]) + np.linalg.matrix_power(np.diag(x) + M, 3)
    ),
    "trace, diagonal": lambda x: np.trace(np.outer(x, x)) + np.diagonal(np.outer(x, x), 1)[0] + np.diag(np.outer(x, x)),
    "sum": lambda x: np.sum(np.outer(x, x), axis=0) + x.sum() + np.sum(np.outer(x, x) * x, 1, keepdims=True)[1],
    "sum over two axes": lambda x: np.sum(T * x, axis=(0, 2)) + np.add.reduce(np.outer(x, x))[0],
    "sum of a list": lambda x: np.sum([x[0], 2.0, x[1] * x[2]]) + sum(x) + np.mean([x[0], x[1]]),
    "sum of some": lambda x: np.sum(x * x, where=[True, False, True], initial=2.0),
    "product over axes": lambda x: np.prod(x) + np.prod(np.outer(x, x), axis=0) + np.multiply.reduce(x),
    "running sum and product": lambda x: np.cumsum(x) + np.cumprod(x) + np.cumsum(np.outer(x, x), axis=1)[1],
    "mean": lambda x: np.mean(x * x) + np.outer(x, x).mean(axis=0),
    "differences": lambda x: np.diff(x * x) + np.diff(x, prepend=0.0, append=x[:1], n=2)[0],
    "polynomial": lambda x: np.polyval([1.0, 2.0, 3.0], x) + np.polyval(np.array([x[0], x[1], 2.0]), x[2]),
    "line": lambda x: np.linspace(x[0], x[1], 4) + np.linspace(0.0, x[2], 4, endpoint=False),
    "solve": lambda x: np.linalg.solve(np.outer(x, x) + np.diag(x) + 5.0 * EYE, x * x),
    "solve a constant side": lambda x: np.linalg.solve(np.outer(x, x) + 5.0 * EYE, M),
    "solve with a constant matrix": lambda x: np.linalg.solve(M + 4.0 * EYE, np.outer(x, x)),
    "solve stacks": lambda x: np.linalg.solve(np.tanh(T[:, :1] * x) + 5.0 * EYE, (T * x).transpose(0, 2, 1)),
    "solve a stack for a vector": lambda x: np.linalg.solve(np.tanh(T[:, :1] * x) + 5.0 * EYE, x),
    "inverse": lambda x: np.linalg.inv(np.outer(x, x) + np.diag(x) + 5.0 * EYE),
    "determinants of stacks": lambda x: (
        np.linalg.det(np.tanh(T[:, :1] * x) + np.outer(x, x)) + np.linalg.det(x[:, None, None])
    ),
    "determinant": lambda x: np.linalg.det(np.outer(x, C) + np.diag(x) + M),
    "array of elements": mixed_row,
    "joining": lambda x: np.concatenate([x, C, 2.0 * x]) + np.concatenate([[x[0]] * 3, np.ones(3), x[::-1]]),
    "stacking": lambda x: np.stack([x, C]) + np.vstack([x, x * x]) + np.column_stack([x[:2], C[:2], x[1:]]),
    "stacking along others": lambda x: np.stack([x, C], 1) + np.hstack([x[:, None], (x * x)[:, None]]),
    "block": lambda x: np.block([[np.outer(x, x), x[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]]),
    "append, insert": lambda x: np.append(x, [1.0, x[0]]) + np.insert(x, [1, 2], [x[1] * x[1], 4.0]),
    "shapes": lambda x: np.outer(x, C).reshape(9)[2:5] + np.outer(x, x).T.ravel()[:3] + x[:, None].squeeze(),
    "axes": lambda x: np.swapaxes(T * x, 0, 1)[0] + np.moveaxis(T * x, 0, 2)[0].T + np.transpose(T * x, (1, 2, 0))[0].T,
    "triangles": lambda x: np.triu(np.outer(x, x)) + 2.0 * np.tril(np.outer(x, x), -1) + np.diag(x, 1)[:3, :3],
    "tile, repeat, roll, flip": lambda x: (
        np.tile(x, 2) + np.repeat(x, 2) + np.roll(np.tile(x, 2), 1)[::-1] + np.flip(x)[0]
    ),
    "broadcasting": lambda x: np.broadcast_to(x, (2, 3)) * N + np.broadcast_arrays(x, N)[0] + np.expand_dims(x, 0),
    "parts": lambda x: np.split(np.tile(x, 2), 2)[1] + np.delete(np.tile(x, 2), [0, 1, 2]) + np.take(x, [2, 1, 0]),
    "indices": lambda x: x[[2, 0, 0]] + x[np.array([True, True, True])] + x[-1] + np.outer(x, x)[[0, 1, 2], [1, 1, 0]],
    "filled": lambda x: np.full(3, x[1]) + np.full_like(x, x[2]) + np.zeros_like(x) + np.ones_like(x) * x,
    "loop": lambda x: [x := x + 0.1 * np.stack([x[1], -np.sin(x[0]), 0.1 * x[2]]) for _ in range(5)][-1],
    "constant": lambda x: np.array([1.0, 2.0]),
    "by a matrix": lambda x: np.linalg.inv(np.reshape(np.concatenate([x, C, x * x]), (3, 3)) + 5.0 * EYE) @ x,
}

CHOOSING = {
    "symmetric": symmetric_fill,
    "accumulated": accumulated,
    "aliases": aliases,
    "assigned": assigned,
    "diagonals": diagonals,
    "abs": lambda x: abs(x) + np.fabs(x) * C + np.absolute(x[0]),
    "arctan2": lambda x: np.arctan2(x[0], x[1]) + np.arctan2(x, 2.0) + np.arctan2(-1.0, x),
    "hypot, norm": lambda x: (
        np.hypot(x, x[::-1] + 1.0) + np.linalg.norm(x) + np.linalg.norm(np.outer(x, x) + M, axis=1)
    ),
    "where": lambda x: np.where(x > 0.1, x * x, np.sin(x)) + np.where([True, False, True], x, 2.0),
    "where guards": lambda x: np.where(x > 0.0, np.sqrt(np.where(x > 0.0, x, 1.0)), 7.0),
    "where of one": lambda x: np.where(x[0] > 0.0, x, -x),
    "select": lambda x: np.select([x > 0.5, x > 0.0], [x * x, 2.0 * x], default=-x),
    "maximum": lambda x: np.maximum(x, 0.1) + np.minimum(x * x, x) + np.fmax(x, x[::-1] + 0.3) + np.fmin(C, x),
    "max over axis": lambda x: np.max(np.outer(x, C), axis=0) + x.min() + np.amax(x * x) + np.ptp(x),
    "clip": lambda x: np.clip(x, -0.5, 0.5) + x.clip(-1.0, x[0] * x[0]) + np.clip(x, None, 0.1) + np.clip(x, 0.2, None),
    "remainders": lambda x: np.mod(9.0 * x, 2.0) + (x % -0.3) + np.fmod(7.0 * x, 0.7) + np.mod(5.0, x + 3.0),
    "steps": lambda x: np.floor(9.0 * x) * x + np.rint(9.0 * x) + np.sign(x) * x + x // 0.3 + np.round(7 * x),
    "copysign": lambda x: np.copysign(x, x[::-1]) + np.copysign(2.0, x) + np.copysign(x, -1.0),
    "interp": lambda x: np.interp(x, [-1.0, 0.0, 0.25, 1.0], [3.0, 1.0, 4.0, 1.5]),
    "interp of unknown ordinates": lambda x: np.interp(x, [-1.0, 0.0, 1.0], np.array([x[0], x[1] * x[1], 2.0])),
    "interp beyond the ends": lambda x: np.interp(x, [-0.1, 0.1], [1.0, 2.0], left=-5.0, right=7.0),
    "var, std": lambda x: np.var(x) + np.std(np.outer(x, C), axis=0, ddof=1),
    "angle wrap": lambda x: x - 2.0 * np.pi * np.floor((x + np.pi) / (2.0 * np.pi)),
    "degrees": lambda x: np.deg2rad(x) + np.rad2deg(x) + np.radians(x) * np.degrees(x),
    "logaddexp, cbrt": lambda x: np.logaddexp(x, C) + np.cbrt(x + 4.0) + np.logaddexp(1.0, x),
    "cholesky": lambda x: np.linalg.cholesky(positive_definite(x)),
    "finite": lambda x: np.nan_to_num(np.where(x > 0.0, x * x, np.nan)),
    "comparisons": lambda x: (x > 0.0) * x + np.any(x > 0.0) * x[0] + np.argmax(x) * x[1] + np.count_nonzero(x) * x,
    "branch": lambda x: x * x if x[0] > 0.0 else -x,
    "sort": lambda x: np.sort(x) + np.sort(np.outer(x, C), axis=0)[1] + np.sort(np.outer(C, x), axis=None)[3:6],
    "median": lambda x: (
        np.median(x) + np.median(np.outer(x, x), axis=1) + np.median(T[0] * x, axis=0, keepdims=True)[0]
    ),
    "float powers": lambda x: np.float_power(abs(x), 1.5) + np.power(abs(x), x),
}
