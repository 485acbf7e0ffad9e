"""The functions that a model may contain, as they are drawn: how each is written, and how NumPy repeats it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

PLACES = 2  # units in the last place by which two libraries of elementary functions may differ

# Operands: {n} a number of any shape, {r} a real one, {v} a vector, {m} a matrix, {s} a scalar, {c} a constant,
# {b} a truth value. A number may be whole where it need not be real.
_EXACT = """
{n} + {n}; {n} - {n}; {n} * {n}; {n} / {n}; -{n}; +{n}; abs({n}); {n} + {n} * {n}; {n} % {n}; {n} // {n}; {n} * -1
{v} ** 2; {n} ** 1; {n} ** 0; {v} ** 0.5; np.add({n}, {n}); np.multiply({n}, {n}); np.divide({n}, {n}); np.negative({n})
np.subtract({n}, {n}); np.positive({n}); np.fabs({n}); np.absolute({n}); np.mod({n}, {n}); np.fmod({n}, {n})
np.floor_divide({n}, {n}); np.maximum({n}, {n}); np.minimum({n}, {n}); np.sign({n}); np.copysign({n}, {n})
np.square({n}); np.reciprocal({r}); np.sqrt({n})
np.floor({n}); np.ceil({n}); np.trunc({n}); np.rint({n}); np.round({n}); np.around({r}); {r}.round()
np.deg2rad({n}); np.rad2deg({n}); np.radians({n}); np.degrees({n})
{n} < {n}; {n} <= {n}; {n} > {n}; {n} >= {n}; {n} == {n}; {n} != {n}; np.less({n}, {n}); np.greater_equal({n}, {n})
np.less_equal({n}, {n}); np.greater({n}, {n}); np.equal({n}, {n}); np.not_equal({n}, {n}); {b} < {n}; {b} == {b}
np.isfinite({n}); np.isinf({n}); np.isnan({n})
{b} & {b}; {b} | {b}; {b} ^ {b}; ~{b}; {b} + {b}; {b} * {b}; {b} + {n}; {b} * {n}; {n} - {b}; {b} / {n}; abs({b})
1 - {b}; {b} * -1; {b} * 2.0; {b} % {n}; {b} // {r}; {b} ** 2; np.maximum({b}, {b}); np.minimum({b}, {n})
np.square({b})
np.logical_and({n}, {n}); np.logical_or({n}, {b}); np.logical_not({n}); np.logical_xor({n}, {n}); np.floor({b})
np.bitwise_and({b}, {b}); np.bitwise_or({b}, {b}); np.bitwise_xor({b}, {b}); np.invert({b})
{r}.astype(int); {n}.astype(bool); {b}.astype(float); {b}.astype(int); np.array({r}, int); np.asarray({b}, float)
np.array([{s}, {s}], bool); np.full(2, {s}, int); np.sum({b}, dtype=int); np.sum({b}, dtype=float)
np.where({b}, {n}, {n}); np.where({b}, {c}, {n}); np.where({b}, {n}, {c}); np.where({b}, {c}, {c})
np.where({n}, {n}, {n})
np.where({b}, {b}, {n}); np.where({b}, {b}, {b}); -np.where({b}, 1, 0); np.where({b}, 3, -2) * {n}
np.select([{b}, {b}], [{n}, {n}], {c}); np.select([{b}], [{n}])
np.interp({n}, [-1.0, 0.5, 2.0], [3.0, -1.0, 0.5]); np.interp({n}, [0.0, 1.0], [inf, 2.0]); np.interp({n}, [2], [7])
np.interp({n}, [-1, 0, 1], [-0.0, 0.0, -0.0], left=-7.0, right=nan); np.interp({n}, [0.0, 1.0], {v}[:2], right=-1)
np.sum({n}); np.sum({m}, axis=0); np.sum({m}, axis=1); np.mean({n}); np.prod({n}); {m}.prod(axis=0); {v}.mean()
np.sum(np.tile({v}, 3)); np.sum(np.tile({v}, 60)); np.sum(np.tile({m}, (9, 5)), axis=0); np.sum({v} * 1.0, initial={c})
np.prod({v} * 1.0, initial={c}); sum({v}); np.sum(list({v}) * 3); 7 % np.round(np.sum({b}))
np.mean(list({v}) * 5); np.max([{s}, {s}, {c}])
np.cumsum({v}); np.cumprod({v}); np.cumsum({m}, axis=1); np.cumsum({m}); np.diff({v}); np.diff({v}, prepend=0.0)
np.trace({m}); np.linalg.trace({m}); np.any({n}); np.all({b}); np.all({m}, axis=1); {b}.any()
np.count_nonzero({n}); np.sum({b}); np.mean({b}); np.prod({b}); np.cumsum({b}); np.polyval([{c}, 2.0], {n})
np.cross({v}[:3], {v}[1:]); np.linalg.cross({v}[:3], {v}[1:]); np.outer({v}[:2], {v}[2:]); np.linalg.outer({v}, {v})
np.kron({m}, {m}); np.multiply.outer({s}, {v}); np.array([[1, 0], [-2, 3]]) @ np.where({m} > 0, 1, 0)
np.concatenate([{v}, {v}]); np.stack([{v}, {v}]); np.vstack([{v}, {v}]); np.hstack([{v}, {s}]); np.dstack([{m}, {m}])
np.column_stack([{v}, {v}]); np.block([[{m}, np.zeros((2, 1))]]); np.append({v}, {s}); np.insert({v}, 1, {s})
np.array([{s}, {c}, 1]); np.array([{s}, {b}.ravel()[0]]); np.full(2, {s}); np.broadcast_to({s}, (2, 2))
np.broadcast_arrays({s}, {v})[0]; np.tile({v}, 2); np.repeat({v}, 2); np.delete({v}, 1); np.copy({n}) + {s}
np.roll({v}, 1); np.flip({m}); np.fliplr({m}); np.flipud({m}); np.rot90({m}); np.diag({v}); np.diagonal({m})
np.diagflat({v})
np.linalg.diagonal({m}); np.triu({m}); np.tril({m}); {m}.T; np.transpose({m}); np.linalg.matrix_transpose({m})
np.moveaxis({m}, 0, 1); np.swapaxes({m}, 0, 1); np.rollaxis({m}, 1); {v}.reshape(2, 2); np.reshape({v}, (2, 2))
np.ravel({m}); {m}.flatten(); np.squeeze({m}[:1]); np.expand_dims({v}, 0)[0]
np.atleast_1d({s}); np.atleast_2d({v}); np.atleast_3d({v}); np.take({v}, [2, 0]); {v}.take([1]); {m}[1]; {v}[1]
{v}[::-1]
{m}[:, 0]; {v}[[0, 3]]; {v}[np.array([True, False, True, True])]; np.split({v}, 2)[1]; np.array_split({v}, 3)[0]
np.hsplit({m}, 2)[0]; np.vsplit({m}, 2)[1]; np.shape({m}) + {s}; np.ndim({m}) * {s}; np.size({v}) - {s}
np.zeros_like({n}) + {n}; np.ones_like({n}) * {n}; np.full_like({v}, {s}); -np.zeros_like({n})
np.full_like([1, 2], {s})
np.argmax({v}); np.argmin({n}); np.argmax({m}, axis=1); {m}.argmin(axis=0); np.var({r}); np.std({m}, axis=0)
{v}.var(); np.linspace({s}, {s}, 5); np.nan_to_num({n}); np.isclose({n}, {n}); np.allclose({n}, {c})
"""
#: Which of two zeros NumPy chooses is not specified, and differs between scalars and arrays.
_ANY_ZERO = """
np.fmax({n}, {n}); np.fmin({n}, {n}); np.max({n}); np.min({n}); np.amax({v}); np.amin({m}, axis=1); np.max({m}, axis=0)
{m}.min(axis=1); np.clip({n}, {n}, {n}); np.clip({n}, {c}, {c}); np.clip({n}, None, {n}); np.clip({n}, {c}, None)
np.max({v} * 1.0, initial={c}); {v}.clip({c}, {v}); np.sort({v}); np.sort({m}, axis=0); np.median({v})
np.median({m}, axis=1)
"""
#: Sums of products: NumPy leaves their order to a library; here each begins at 0 and goes from the first to the last.
_PRODUCTS = {
    "{m} @ {m}": "product({}, {})",
    "{m} @ {v}[:2]": "product({}, {}[:2])",
    "{v} @ {v}": "product({}, {})",
    "{v}[:2] @ {m}": "product({}[:2][None], {})[0]",
    "np.matmul({m}, {m})": "product({}, {})",
    "np.dot({v}, {v})": "product({}, {})",
    "{m}.dot({m})": "product({}, {})",
    "np.inner({v}, {v})": "product({}, {})",
    "np.vdot({m}, {m})": "product({}.ravel(), {}.ravel())",
    "[[1, 0], [0.5, 0.0]] @ {m}": "product(np.array([[1, 0], [0.5, 0.0]]), {})",
    "{m} @ np.eye(2)": "product({}, np.eye(2))",
    "np.einsum('ij,kj->ik', {m}, {m})": "product({}, {}.T)",
    "np.tensordot({m}, {m}, 1)": "product({}, {})",
    "np.linalg.tensordot({m}, {m}, axes=1)": "product({}, {})",
    "np.linalg.matmul({m}, {m})": "product({}, {})",
    "np.linalg.multi_dot([{m}, {m}])": "product({}, {})",
    "np.linalg.matrix_power({m}, 2)": "product({0}, {0})",
    "np.linalg.norm({r})": "np.sqrt(np.sum(np.ravel({0}) ** 2))",
    "np.linalg.norm({m}, axis=1)": "np.sqrt(np.sum({0} * {0}, axis=1))",
}
_LIBRARY = """
np.exp({n}); np.expm1({n}); np.exp2({n}); np.log({n}); np.log1p({n}); np.log2({n}); np.log10({n})
np.sin({n}); np.cos({n}); np.tan({n}); np.arcsin({n}); np.arccos({n}); np.arctan({n}); np.arctan2({n}, {n})
np.arctan2({c}, {n}); np.sinh({n}); np.cosh({n}); np.tanh({n}); np.arcsinh({n}); np.arccosh({n}); np.arctanh({n})
np.hypot({n}, {n}); {n} ** 3; {r} ** -1; {r} ** -2; {s} ** 0.5; {n} ** 1.7; 2.0 ** {n}; {r} ** {r}; {c} ** {r}
np.power({r}, {n}); np.power({n}, -0.5); np.float_power({n}, {n}); np.float_power({v}, 2)
"""


@dataclass(frozen=True)
class Function:
    """A function that is drawn."""

    template: str
    reference: str = ""  # how NumPy repeats it, when not as it is written
    places: int = 0  # units in the last place by which the two may differ
    any_zero: bool = False  # 0.0 and -0.0 are one value

    @property
    def operands(self) -> list[str]:
        """The letter of each operand."""
        return re.findall(r"\{(\w)\}", self.template)

    def written(self, operands: list[str], reference: bool = False) -> str:
        """Return it as source with its operands put in, as NumPy repeats it if told."""
        text = self.reference if reference and self.reference else re.sub(r"\{\w\}", "{}", self.template)
        return text.format(*operands)


def _templates(text: str) -> list[str]:
    return [template for line in text.strip().splitlines() for template in line.split("; ")]


FUNCTIONS = [
    *(Function(template) for template in _templates(_EXACT)),
    *(Function(template, any_zero=True) for template in _templates(_ANY_ZERO)),
    *(Function(template, reference) for template, reference in _PRODUCTS.items()),
    *(Function(template, places=PLACES) for template in _templates(_LIBRARY)),
]


def product(a: np.ndarray, b: np.ndarray) -> Any:
    """Matrix product whose sums begin at 0 and go from the first term to the last."""
    if a.ndim == 1:
        return reduce(np.add, [p * q for p, q in zip(a, b, strict=True)], 0)
    if b.ndim == 1:
        return np.array([product(row, b) for row in a])
    return np.array([[product(row, column) for column in b.T] for row in a])


#: What the source of an expression may name.
NAMES = {"np": np, "inf": float("inf"), "nan": float("nan"), "product": product}
