"""The graph of a traced computation, and the C function that evaluates it.

A :class:`Node` is a number, an element of one of the vectors that a task reads, or an operation on other nodes.
Nothing is rewritten: the C functions do the operations that were recorded, each once, and every operation is that of
the C language on doubles, so that ``-0.0``, infinities and NaN go their way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from types import MappingProxyType

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
#: The operations that give a truth value, and which of their operands are truth values.
TRUTHS = {"less": (), "less_equal": (), "equal": (), "not_equal": (), "and": (0, 1), "or": (0, 1), "not": (0,)}
_PLAIN_OF_ONE, _PLAIN_OF_TWO = "fabs floor ceil trunc rint sqrt".split(), "copysign fmax fmin".split()
_CALLS_OF_ONE = """
exp expm1 exp2 log log1p log2 log10 sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh
""".split()
_CALLS_OF_TWO = "fmod pow atan2 hypot".split()
OPERATIONS |= {name: f"{name}({{}})" for name in _PLAIN_OF_ONE + _CALLS_OF_ONE}
OPERATIONS |= {name: f"{name}({{}}, {{}})" for name in _PLAIN_OF_TWO + _CALLS_OF_TWO}
#: Those that are calls of a function of the C library, and not an instruction or a few.
_CALLS = frozenset(_CALLS_OF_ONE + _CALLS_OF_TWO)


_NONE: Mapping = MappingProxyType({})


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


def c_function(
    function: str, vectors: Iterable[str], results: Sequence[Node], known: Mapping[Node, str] = _NONE
) -> str:
    """Return a C function of the vectors and ``double *r`` that sets ``r[i]`` to ``results[i]``; the nodes in ``known``
    have that text and are not calculated."""
    arguments = ", ".join([*(f"const double *restrict {vector}" for vector in vectors), "double *restrict r"])
    names: dict[str, str] = {}  # C expression -> the name of its value
    texts: dict[Node, str] = {}
    for node in _calls_first(_in_order(results, known), known):
        if node in known:
            texts[node] = known[node]
        elif node.op == "number":
            texts[node] = c_number(node.of[0])
        elif node.op == "element":
            texts[node] = "{}[{}]".format(*node.of)
        else:
            text = _expression(node, texts)
            texts[node] = names.setdefault(text, f"{'is' if node.op in TRUTHS else 'a'}{len(names)}")
    kinds = {name: "int" if name.startswith("is") else "double" for name in names.values()}
    lines = [f"    const {kinds[name]} {name} = {text};" for text, name in names.items()]
    lines += [f"    r[{i}] = {texts[node]};" for i, node in enumerate(results)]
    return "\n".join([f"static void {function}({arguments}) {{", *lines, "}", ""])


def _expression(node: Node, texts: Mapping[Node, str]) -> str:
    """Return the C expression of an operation. Truth values are ints named is..., and doubles where one calculates with
    them; two of them are combined without a jump."""
    tells = (0,) if node.op == "where" else TRUTHS.get(node.op, ())
    truths = [texts[n].startswith("is") for n in node.of]
    operands = [
        f"(double){texts[n]}" if truth and i not in tells else texts[n]
        for i, (n, truth) in enumerate(zip(node.of, truths, strict=True))
    ]
    if node.op in ("and", "or") and all(truths):
        return f"{operands[0]} {'&' if node.op == 'and' else '|'} {operands[1]}"
    return OPERATIONS[node.op].format(*operands)


def settled(results: Iterable[Node], constant: Callable[[Node], bool]) -> dict[Node, int]:
    """Return what can be calculated once, before any of the results is: the operations that depend on constant elements
    only and that the results or others of their operations use. Equal ones have one number, counted from 0."""
    results = list(results)
    still: dict[Node, bool] = {}
    same: dict[tuple, Node] = {}  # what a node is -> the first that is so
    first: dict[Node, Node] = {}
    found: dict[Node, None] = {}
    for node in _in_order(results):
        if node.op in OPERATIONS:
            what = (node.op, *(first[n] for n in node.of))
            still[node] = all(still[n] for n in node.of)
            if not still[node]:
                found |= dict.fromkeys(n for n in node.of if still[n])
        else:
            what = (node.op, *(c_number(of) if node.op == "number" else of for of in node.of))
            still[node] = node.op == "number" or constant(node)
        first[node] = same.setdefault(what, node)
    found |= dict.fromkeys(node for node in results if still[node])
    numbers: dict[Node, int] = {}
    return {n: numbers.setdefault(first[n], len(numbers)) for n in found if n.op in OPERATIONS}


def _calls_first(nodes: list[Node], known: Container[Node]) -> list[Node]:
    """Return nodes in another valid order: the functions of the C library as early as they can be called, and before
    each only what it needs. A call destroys all registers: what was calculated before it and is used after it goes to
    memory and back."""

    def operands(node: Node) -> tuple:
        return node.of if node.op in OPERATIONS and node not in known else ()

    calls = {node for node in nodes if node.op in _CALLS and node not in known}
    depth: dict[Node, int] = {}  # how many calls one after the other lead to it
    for node in nodes:
        depth[node] = max((depth[n] for n in operands(node)), default=0) + (node in calls)
    latest = max(depth.values(), default=0) + 1
    first: dict[Node, int] = {}  # the depth of the first call that needs it
    for node in reversed(nodes):
        needed = first[node] = depth[node] if node in calls else first.get(node, latest)
        for n in operands(node):
            first[n] = min(first.get(n, latest), needed)
    return sorted(nodes, key=lambda node: first[node])


def elements_used(results: Sequence[Node], vector: str) -> list[set[int]]:
    """Return, for each result, the indices of the elements of a vector that it depends on, choices included."""
    used: dict[Node, set[int]] = {}
    for node in _in_order(results):
        if node.op == "element":
            used[node] = {node.of[1]} if node.of[0] == vector else set()
        else:
            used[node] = set().union(*(used[n] for n in node.of)) if node.op != "number" else set()
    return [used[node] for node in results]


def _in_order(results: Iterable[Node], known: Container[Node] = ()) -> list[Node]:
    """Return the nodes that the results depend on, each after those that it depends on itself unless it is known."""
    order: dict[Node, None] = {}
    waiting = [(node, False) for node in reversed(list(results))]
    while waiting:
        node, ready = waiting.pop()
        if node in order:
            continue
        if ready or node.op in ("number", "element") or node in known:
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
