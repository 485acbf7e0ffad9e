"""The graph of a traced computation, and the C function that evaluates it.

A :class:`Node` is a number, an element of one of the vectors that a task reads, or an operation on other nodes.
Nothing is rewritten: the C function does the operations that were recorded, each once, and every operation is that of
the C language on doubles, so that ``-0.0``, infinities and NaN go their way.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

#: What can be done: operation -> C expression. A truth value is 0.0 or 1.0; what is not zero is true, NaN too.
OPERATIONS = {
    "add": "{} + {}",
    "subtract": "{} - {}",
    "multiply": "{} * {}",
    "divide": "{} / {}",
    "negative": "-{}",
    "less": "{} < {}",
    "less_equal": "{} <= {}",
    "equal": "{} == {}",
    "not_equal": "{} != {}",
    "and": "{} && {}",
    "or": "{} || {}",
    "not": "!{}",
    "where": "{} ? {} : {}",
}
_OF_ONE = """
fabs floor ceil trunc rint sqrt exp expm1 exp2 log log1p log2 log10 sin cos tan asin acos atan sinh cosh tanh asinh
acosh atanh
""".split()
_OF_TWO = "copysign fmod pow atan2 hypot fmax fmin".split()
OPERATIONS |= {name: f"{name}({{}})" for name in _OF_ONE}
OPERATIONS |= {name: f"{name}({{}}, {{}})" for name in _OF_TWO}


class Node:
    """``op`` is ``"number"`` (of its value), ``"element"`` (of a vector's name and an index) or one of OPERATIONS."""

    __slots__ = ("of", "op")

    def __init__(self, op: str, *of: object) -> None:
        self.op, self.of = op, of


def number(value: float) -> Node:
    """Return the node of a number."""
    return Node("number", float(value))


def element(vector: str, index: int) -> Node:
    """Return the node of an element of a vector."""
    return Node("element", vector, index)


def c_function(name: str, vectors: Iterable[str], results: Sequence[Node]) -> str:
    """Return a C function of the vectors and ``double *r`` that sets ``r[i]`` to ``results[i]``."""
    arguments = ", ".join([*(f"const double *restrict {vector}" for vector in vectors), "double *restrict r"])
    names: dict[str, str] = {}  # C expression -> the name of its value
    texts: dict[Node, str] = {}
    for node in _in_order(results):
        if node.op == "number":
            texts[node] = c_number(node.of[0])
        elif node.op == "element":
            texts[node] = "{}[{}]".format(*node.of)
        else:
            text = OPERATIONS[node.op].format(*(texts[n] for n in node.of))
            texts[node] = names.setdefault(text, f"a{len(names)}")
    lines = [f"    const double {value} = {text};" for text, value in names.items()]
    lines += [f"    r[{i}] = {texts[node]};" for i, node in enumerate(results)]
    return "\n".join([f"static void {name}({arguments}) {{", *lines, "}", ""])


def elements_used(results: Sequence[Node], vector: str) -> list[set[int]]:
    """Return, for each result, the indices of the elements of a vector that it depends on, choices included."""
    used: dict[Node, set[int]] = {}
    for node in _in_order(results):
        if node.op == "element":
            used[node] = {node.of[1]} if node.of[0] == vector else set()
        else:
            used[node] = set().union(*(used[n] for n in node.of)) if node.op != "number" else set()
    return [used[node] for node in results]


def _in_order(results: Iterable[Node]) -> list[Node]:
    """Return the nodes that the results depend on, each after those that it depends on itself."""
    order: dict[Node, None] = {}
    waiting = [(node, False) for node in reversed(list(results))]
    while waiting:
        node, ready = waiting.pop()
        if node in order:
            continue
        if ready or node.op in ("number", "element"):
            order[node] = None
        else:
            waiting.append((node, True))
            waiting += [(n, False) for n in reversed(node.of)]
    return list(order)


def c_number(value: float) -> str:
    """Return a number as C reads it back, to the last bit."""
    if math.isnan(value):
        return "NAN"
    text = "INFINITY" if math.isinf(value) else repr(abs(value))
    return f"(-{text})" if math.copysign(1.0, value) < 0 else text
