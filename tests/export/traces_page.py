"""Write what traces, and what is refused and how, into ``docs/what_traces.md``: ``python -m tests.export.traces_page``.

The page is made of the tests: what stands there is what they try.
"""

from __future__ import annotations

import ast
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from evidence.compiled import traced
from navfmu.errors import NavfmuError
from navfmu.export.tracing import extent, fresh, functions, linear, order
from navfmu.export.tracing.rules import RULES

from . import test_trace

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "what_traces.md"

HEAD = """# What traces

A method of a component, and every function of the model that it calls, is run once with symbols in place of numbers;
what it does with them is what the FMU does. This page is made of the tests (`python -m tests.export.traces_page`): all
that stands here is compiled there and compared with NumPy, or refused with the sentence that is shown.

Elementwise operations, choices and comparisons have NumPy's bits; `exp`, `sin` and their kin may differ by two units in
the last place, and so NumPy differs from itself between machines. Sums along the last axis go in NumPy's order (eight
sums side by side up to 128 numbers, halves above), other sums and all products of matrices from the first term to the
last. `solve`, `inv`, `det` and `cholesky` are judged by what they leave over; for a matrix that is singular or not
positive definite NumPy raises an error (also in the interpreter and the Python twin), and here the result is infinite
or NaN. So what is not chosen must be guarded as well: `np.linalg.solve(np.where(enough, N, np.eye(4)), y)`.

Small arrays become single numbers, large ones loops, and functions that are called often are compiled once; no bit
depends on it ([array_nodes](decisions/array_nodes.md)). A task of more than {limit} operations on single numbers is
refused.

Arrays are assigned to as in NumPy. Where a function assigns values to what it has made of constants, or copied from
those of its module, the task is traced once more with room for values in all of them; what they are calculated with
until then is done by the rules above, and no longer by NumPy while tracing.

An FMU keeps its variables and nothing else. A model may calculate constants once and keep them (`functools.cache`, a
dict of the module); each task is traced as if none had been kept, and what a task leaves outside of its variables that
makes a difference at the next tick, or in another task, is refused: declare a State.
"""


def page() -> str:
    """Return the text of the page."""
    text = HEAD.format(limit=f"{extent.LIMIT:_}".replace("_", " "))
    return "\n".join([text, *_functions(), *_written(), *_refused()]) + "\n"


def _name(function: Callable) -> str:
    module = getattr(function, "__module__", None) or "numpy"
    return f"{module}.{function.__name__}".removeprefix("numpy.").removeprefix("_core.umath.")


def _functions() -> Iterable[str]:
    own = {order: "Order", linear: "Linear algebra"}
    groups: dict[str, set[str]] = {"At each place": {_name(f) for f in RULES}}
    for function, ours in functions.FUNCTIONS.items():
        group = next((what for module, what in own.items() if getattr(ours, "__module__", "") == module.__name__), None)
        groups.setdefault(group or "With a form of their own", set()).add(_name(function))
    groups["That move elements about, or call the others"] = {_name(f) for f in functions.STRUCTURAL}
    groups["That make arrays"] = {"arange", "triu_indices", *fresh.MAKES}
    yield "## Functions of NumPy"
    yield ""
    for title, names in groups.items():
        yield textwrap.fill(f"**{title}**: {' '.join(sorted(names))}.", 120, break_long_words=False)
        yield ""


def _written() -> Iterable[str]:
    yield "## As it is written"
    yield ""
    yield "| what | code |"
    yield "|---|---|"
    for name in ("EXACT", "LIBRARY"):
        for title, code in _sources(name):
            yield f"| {title} | {code} |"
    yield ""


def _refused() -> Iterable[str]:
    yield "## What is refused, and the sentence"
    yield ""
    yield "Each begins with the file and the line of the model."
    yield ""
    yield "| what | sentence |"
    yield "|---|---|"
    codes = dict(_sources("REFUSED"))
    alike: dict[str, list[str]] = {}
    for title, (function, _) in test_trace.REFUSED.items():
        try:
            traced(function, [test_trace.A])
        except NavfmuError as error:
            sentence = _cell(str(error).partition(": ")[2])
            alike.setdefault(sentence, []).append(f"{title}: {codes[title]}")
    for sentence, what in alike.items():
        yield f"| {'<br>'.join(what)} | {sentence} |"


def _sources(name: str) -> Iterable[tuple[str, str]]:
    """Yield the titles in a dictionary of the tests, and the source of the function of each."""
    text = Path(test_trace.__file__).read_text(encoding="utf-8")
    tree = ast.parse(text)
    bodies = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    (value,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == name
    )
    for key, item in zip(value.keys, value.values, strict=True):
        function = item.elts[0] if isinstance(item, ast.Tuple) else item
        lines = [_code(function.body if isinstance(function, ast.Lambda) else function)]
        for node in ast.walk(function):
            if isinstance(node, ast.Name) and node.id in bodies:
                found = bodies[node.id]
                body = found.body[
                    isinstance(found.body[0], ast.Expr) and isinstance(found.body[0].value, ast.Constant) :
                ]
                lines = [_code(line) for line in body]
        yield ast.literal_eval(key), "<br>".join(lines)


def _code(node: ast.AST) -> str:
    lines = ast.unparse(node).splitlines()
    return "<br>".join(f"`{_indent(line)}{_cell(line)}`" for line in lines)


def _indent(line: str) -> str:
    """Return the indentation of a line in spaces that a page keeps."""
    return "\N{NO-BREAK SPACE}" * (len(line) - len(line.lstrip()))


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


if __name__ == "__main__":
    np.seterr(all="ignore")
    PAGE.write_text(page(), encoding="utf-8")
