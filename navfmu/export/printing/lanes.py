"""From the record to NumPy: a function that evaluates it for many instances at once, side by side in lanes.

Every number is an array with an element for each lane, every array one of shape (size, lanes). It shows what the record
is without any C, and it is the second opinion on the C printer: the same record, printed by other means, gives the same
bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.record.arrays import Call, Fold, Map, Pack, Product, Repeat, Run
from navfmu.export.record.graph import OPERATIONS, TRUTHS, Array, Node, Operand, in_order

_NAMES = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "asinh": "arcsinh"}
_NAMES |= {"acosh": "arccosh", "atanh": "arctanh", "pow": "power"}
_OWN = {"and": "logical_and", "or": "logical_or", "not": "logical_not", "where": "where"}


def numpy_source(name: str, vectors: Iterable[str], results: Sequence[Node]) -> str:
    """Return the source of a Python function of vectors of shape (size, lanes) that returns (results, lanes)."""
    return "\n\n\n".join([*_helpers(results), _function(name, [*vectors], results)]) + "\n"


def evaluator(vectors: Sequence[str], results: Sequence[Node]) -> Callable[..., np.ndarray]:
    """Return that function, ready to be called."""
    names: dict[str, Any] = {"np": np, "fold": fold, "run": run, "product": product, "pairwise": pairwise}
    exec(numpy_source("evaluate", vectors, results), names)

    def evaluate(*given: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            return names["evaluate"](*given)

    return evaluate


def _helpers(results: Iterable[Node]) -> list[str]:
    found: dict[Call, str] = {}

    def visit(nodes: Iterable[Node]) -> None:
        for node in in_order(nodes):
            if isinstance(node, Array) and isinstance(node.how, Call) and node.how not in found:
                visit(node.how.results)
                found[node.how] = _function(node.how.name, [*node.how.vectors], node.how.results)

    visit(results)
    return list(found.values())


def _function(name: str, vectors: list[str], results: Sequence[Node]) -> str:
    texts: dict[Node, str] = {}
    lines = [f"def {name}({', '.join(vectors)}):", f"    lanes = np.shape({vectors[0]})[-1]"]
    for node in in_order(results):
        if node.op == "number":
            texts[node] = _number(node.of[0])
        elif node.op == "element":
            source, place = node.of
            texts[node] = f"{texts[source] if isinstance(source, Array) else source}[{place}]"
        else:
            texts[node] = f"{'b' if isinstance(node, Array) else 'is' if node.op in TRUTHS else 'a'}{len(texts)}"
            value = _array(node, texts) if isinstance(node, Array) else _operation(node, texts)
            lines.append(f"    {texts[node]} = {value}")
    rows = ", ".join(f"np.broadcast_to({texts[node]} * 1.0, lanes)" for node in results)
    return "\n".join([*lines, f"    return np.array([{rows}])"])


def _number(value: float) -> str:
    return f"np.float64({repr(float(value))!r})"


def _operation(node: Node, texts: dict[Node, str]) -> str:
    """Return the expression of an operation; truth values are numbers where one calculates with them."""
    tells = (0,) if node.op == "where" else TRUTHS.get(node.op, ())
    operands = [f"({texts[n]} * 1.0)" if n.op in TRUTHS and i not in tells else texts[n] for i, n in enumerate(node.of)]
    if node.op in _OWN:
        return f"np.{_OWN[node.op]}({', '.join(operands)})"
    text = OPERATIONS[node.op].format(*operands)
    return f"np.{text.replace(node.op, _NAMES.get(node.op, node.op), 1)}" if text.startswith(f"{node.op}(") else text


def _operand(operand: Operand, texts: dict[Node, str], shape: Sequence[int] = ()) -> str:
    """Return an operand as an array of shape (size, lanes), or of another shape before the lanes."""
    if operand.places is None:
        text = f"np.broadcast_to({texts[operand.source]} * 1.0, ({operand.size}, lanes))"
    elif isinstance(operand.source, np.ndarray):
        numbers = ", ".join(map(_number, operand.source[operand.places].tolist()))
        text = f"np.broadcast_to(np.array([{numbers}])[:, None], ({operand.size}, lanes))"
    else:
        source = texts[operand.source] if isinstance(operand.source, Array) else operand.source
        first = int(operand.places[0])
        text = f"{source}[{first}:{first + operand.size}]"
        text = text if operand.contiguous else f"{source}[{operand.places.tolist()}]"
    return f"{text}.reshape({', '.join(map(str, shape))}, lanes)" if shape else text


def _formula(formula: Node, given: Sequence[str]) -> str:
    texts: dict[Node, str] = {}
    for node in in_order([formula]):
        if node.op == "number":
            texts[node] = _number(node.of[0])
        elif node.op == "element":
            texts[node] = given[node.of[1]]
        else:
            texts[node] = f"({_operation(node, texts)})"
    return f"{texts[formula]} * 1.0" if formula.op in TRUTHS else texts[formula]


def _array(array: Array, texts: dict[Node, str]) -> str:
    how = array.how
    if isinstance(how, Pack):
        return f"np.concatenate([{', '.join(_operand(o, texts) for o in array.operands)}])"
    if isinstance(how, Map):
        return _formula(how.formula, [_operand(o, texts) for o in array.operands])
    if isinstance(how, Call):
        return f"{how.name}({', '.join(_operand(o, texts) for o in array.operands)})"
    if isinstance(how, Product):
        left, right = array.operands
        shapes = (how.rows, how.inner), (how.inner, how.columns)
        return f"product({_operand(left, texts, shapes[0])}, {_operand(right, texts, shapes[1])})"
    if isinstance(how, Fold | Run):
        rows = _operand(array.operands[0], texts, (how.rows, how.length))
        rule = f"lambda x, y: {_formula(how.formula, ['x', 'y'])}"
        if isinstance(how, Run):
            return f"run({rows}, {rule})"
        first = None if how.first is None else _number(how.first)
        return f"pairwise({rows}, {first})" if how.pairwise else f"fold({rows}, {first}, {rule})"
    name = "repeat" if isinstance(how, Repeat) else how.name
    raise NavfmuError(f"'{name}' is done by the C runtime and has no form in lanes; run the FMU instead")


def fold(rows: np.ndarray, first: Any, rule: Callable) -> np.ndarray:
    """Fold (rows, length, lanes) from the left."""
    numbers = [*np.moveaxis(rows, 1, 0)] if first is None else [first, *np.moveaxis(rows, 1, 0)]
    result = numbers[0]
    for number in numbers[1:]:
        result = rule(result, number)
    return result


def run(rows: np.ndarray, rule: Callable) -> np.ndarray:
    """Return all that a fold passes through, (rows * length, lanes)."""
    found = [rows[:, 0]]
    for j in range(1, rows.shape[1]):
        found.append(rule(found[-1], rows[:, j]))
    return np.stack(found, axis=1).reshape(-1, rows.shape[-1])


def pairwise(rows: np.ndarray, first: Any) -> np.ndarray:
    """Sum (rows, length, lanes) along the rows in NumPy's own order, and add that to ``first``."""
    sums = np.add.reduce(np.ascontiguousarray(np.moveaxis(rows, 1, -1)), axis=-1, initial=-0.0)
    return sums if first is None else first + sums


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Multiply (rows, inner, lanes) and (inner, columns, lanes); each sum goes from the first product to the last."""
    total = np.zeros((a.shape[0], b.shape[1], a.shape[-1]))
    for k in range(a.shape[1]):
        total = total + a[:, k, None] * b[None, k]
    return total.reshape(-1, a.shape[-1])
