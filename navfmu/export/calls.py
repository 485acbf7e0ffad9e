"""Functions of the model that are called with arrays: where arrays are kept whole, each is traced once and called.

A function is compiled for arguments of certain shapes and kinds and certain constants; the same ones again are a call
of the same code. What cannot be a call (a function that changes its arguments, is given an object, or decides by a
value that is known only where it is called) is traced in its place, as if it stood there.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import wraps
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export import arrays, wholes
from navfmu.export.extent import FEWER, LEAST, TooLong, current, shortest
from navfmu.export.graph import Array, Node, element
from navfmu.export.graph import number as constant
from navfmu.export.rules import Scalar, expression
from navfmu.export.traced import Traced, expressions, symbols, type_of

#: A function of fewer operations is not worth a call.
_FEW = 24


class _NoCall(Exception):
    """This cannot be a call."""


@dataclass(frozen=True)
class _Given:
    """A traced argument or result: its shape, its kind ("f", "i" or "b"), and whether it is a lone element."""

    shape: tuple[int, ...]
    kind: str
    lone: bool


@dataclass(frozen=True)
class _Recorded:
    """A function that was traced: its call, and its results as a tree of constants and of places of its numbers."""

    how: arrays.Call
    tree: Any
    numbers: tuple[
        int | float | tuple[int, int], ...
    ]  # of each: its place in the call's, an operand and place, or itself


def recorded(function: FunctionType) -> Callable:
    """Return the function, which is recorded as a call where arrays are kept whole."""

    @wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        if not current().calls:
            return function(*args, **kwargs)
        try:
            return _call(function, args, kwargs)
        except _NoCall:
            return function(*args, **kwargs)

    return called


def _call(function: FunctionType, args: tuple, kwargs: dict) -> Any:
    found, leaves = _found(function, (args, kwargs))
    columns = [[leaf] if isinstance(leaf, Scalar) else leaf.view(np.ndarray).ravel().tolist() for leaf in leaves]
    operands = [wholes.operand(column) if len(column) == 1 else wholes.block(column) for column in columns]
    array = Array(found.how, len(found.how.results), operands)

    def filled(given: _Given, first: int) -> Any:
        numbers = []
        for where in found.numbers[first : first + math.prod(given.shape)]:
            if isinstance(where, tuple):
                node = expression(columns[where[0]][where[1]])
            else:
                node = element(array, where) if isinstance(where, int) else constant(where)
            numbers.append(Scalar(node, given.kind))
        if given.lone:
            return numbers[0]
        result = np.empty(len(numbers), object)
        result[:] = numbers
        return result.reshape(given.shape).view(Traced)

    return _given(found.tree, filled)


def _found(function: FunctionType, given: Any) -> tuple[_Recorded, list[Any]]:
    """Return what was recorded of a function for such arguments, and the arrays and numbers that are passed.

    Arrays of constants are passed as others are, or each would make a copy of the function; they are part of it where
    it cannot be traced without knowing them.
    """
    known = current().functions
    if not _leaves(given, constants=False)[1]:
        raise _NoCall
    for constants in (True, False):
        tree, leaves = _leaves(given, constants)
        key = function, tree
        if key not in known:
            known[key] = None  # also while it is traced: one that calls itself is no call
            known[key] = _record(function, tree, len(known))
        if (found := known[key]) is not None:
            return found, leaves
    raise _NoCall


def _leaves(given: Any, constants: bool) -> tuple[Any, list[Any]]:
    """Return a tree that can be a key, and what is left out there; arrays of constants too if that is wanted."""
    leaves: list[Any] = []
    return _taken(given, leaves, LEAST if constants else math.inf), leaves


def _record(function: FunctionType, tree: Any, number: int) -> _Recorded | None:
    """Trace a function with symbols in place of its arguments; None if it has to be traced where it is called."""

    def run() -> tuple[list[Node], Any]:
        serial = iter(range(1_000_000))

        def parameter(given: _Given, _: int) -> Any:
            vector = symbols(f"p{next(serial)}", given.kind * math.prod(given.shape))
            current().meet(vector.size)
            if given.lone:
                return vector.view(np.ndarray)[0]
            vector = vector.reshape(given.shape)
            vector.setflags(write=False)
            return vector

        args, kwargs = _given(tree, parameter)
        before = _held(args), _held(kwargs)
        leaves: list[Any] = []
        result = _taken(function(*args, **kwargs), leaves)
        if before != (_held(args), _held(kwargs)):
            raise _NoCall
        return [node for leaf in leaves for node in expressions(leaf)], result

    try:
        (nodes, result), used = shortest(run, f"function {function.__name__}", current().functions, FEWER)
    except (_NoCall, NavfmuError, TooLong, TypeError, ValueError, IndexError, KeyError, ArithmeticError):
        return None
    if not used.calls and used.operations < _FEW:
        return None
    results: list[Node] = []
    numbers: list[int | float | tuple[int, int]] = []
    for node in nodes:
        if node.op == "number":
            numbers.append(node.of[0])
        elif node.op == "element" and isinstance(node.of[0], str):
            numbers.append((int(node.of[0][1:]), node.of[1]))
        else:
            numbers.append(len(results))
            results.append(node)
    if not results:
        return None
    name = re.sub(r"\W", "_", f"{function.__module__.rpartition('.')[2]}_{function.__name__}_{number}")
    return _Recorded(arrays.Call(name, tuple(results), about=_about(function, tree)), result, tuple(numbers))


def _about(function: FunctionType, tree: Any) -> str:
    """Return "ins.moved: p0 is x (24,), p1 is nominal[0] (3,)": the operands in the order in which they are passed."""
    args, kwargs = tree.items
    named = inspect.signature(function).bind_partial(*args.items).arguments if args.items else {}
    told: list[str] = []

    def tell(name: str, tree: Any) -> None:
        if isinstance(tree, _Given):
            told.append(f"p{len(told)} is {name}{f' {tree.shape}'.replace(', ', ',') if tree.shape else ''}")
        elif isinstance(tree, _Container):
            for key, item in zip(tree.keys or range(len(tree.items)), tree.items, strict=True):
                tell(f"{name}[{key}]", item)

    for name, value in named.items():
        many = isinstance(value, tuple)  # *args
        for i, item in enumerate(value) if many else [(0, value)]:
            tell(f"{name}[{i}]" if many else name, item)
    for name, item in zip(kwargs.keys, kwargs.items, strict=True):
        tell(name, item)
    return f"{function.__module__.rpartition('.')[2]}.{function.__name__}: {', '.join(told)}"


def _held(tree: Any) -> Any:
    """Return what containers hold, by identity, so that it is seen whether one was changed."""
    if isinstance(tree, list | tuple):
        return [_held(item) for item in tree]
    if isinstance(tree, dict):
        return {key: _held(item) for key, item in tree.items()}
    return id(tree)


@dataclass(frozen=True)
class _Constant:
    """An array of constants among arguments, by its numbers."""

    dtype: str
    shape: tuple[int, ...]
    content: bytes


@dataclass(frozen=True)
class _Container:
    type: type
    keys: tuple
    items: tuple


def _taken(tree: Any, leaves: list[Any], least: float = math.inf) -> Any:
    """Return a tree that can be a key, with what is traced in it replaced; that is appended to the leaves. So are real
    numbers that are known, in arrays of at least ``least``."""
    if isinstance(tree, Traced | Scalar):
        leaves.append(tree)
        if isinstance(tree, Scalar):
            return _Given((), tree.kind, True)
        elements = tree.view(np.ndarray).ravel().tolist()
        if not any(type(e) is Scalar for e in elements):
            leaves.pop()
            return _taken(np.array(elements, type_of(elements)).reshape(tree.shape), leaves, least)
        kind = {float: "f", int: "i", bool: "b"}[type_of(elements)]
        return _Given(tree.shape, kind, False)
    if tree is None or isinstance(tree, bool | int | float | str | FunctionType | type | slice) or tree is Ellipsis:
        return _Number(type(tree), repr(tree)) if isinstance(tree, float) else _Plain(type(tree), tree)
    if isinstance(tree, np.ndarray) and tree.dtype == float and tree.size >= least:
        leaves.append(tree)
        return _Given(tree.shape, "f", False)
    if isinstance(tree, np.ndarray | np.generic) and tree.dtype != object:
        return _Constant(tree.dtype.str, np.shape(tree), np.ascontiguousarray(tree).tobytes())
    if type(tree) in (list, tuple) or (isinstance(tree, tuple) and hasattr(tree, "_fields")):
        return _Container(type(tree), (), tuple(_taken(item, leaves, least) for item in tree))
    if type(tree) is dict:
        return _Container(dict, tuple(tree), tuple(_taken(item, leaves, least) for item in tree.values()))
    raise _NoCall


@dataclass(frozen=True)
class _Plain:
    type: type
    value: Any


@dataclass(frozen=True)
class _Number:
    type: type
    text: str


def _given(tree: Any, filled: Callable[[_Given, int], Any]) -> Any:
    """Return what a tree stands for, with ``filled(given, first)`` for what is traced."""
    first = 0

    def build(tree: Any) -> Any:
        nonlocal first
        if isinstance(tree, _Given):
            value = filled(tree, first)
            first += math.prod(tree.shape)
            return value
        if isinstance(tree, _Plain):
            return tree.value
        if isinstance(tree, _Number):
            return float(tree.text)
        if isinstance(tree, _Constant):
            array = np.frombuffer(tree.content, tree.dtype).reshape(tree.shape)
            return array if tree.shape else array[()]
        items = [build(item) for item in tree.items]
        if tree.type is dict:
            return dict(zip(tree.keys, items, strict=True))
        return tree.type(*items) if hasattr(tree.type, "_fields") else tree.type(items)

    return build(tree)


def functions(modules: Iterable[ModuleType]) -> Iterator[tuple[ModuleType, str, FunctionType]]:
    """Yield the plain functions that modules have of their own and from each other: module, name and function."""
    listed = list(modules)
    names = {module.__name__ for module in listed}
    for module in listed:
        for name, value in vars(module).items():
            if isinstance(value, FunctionType) and value.__module__ in names:
                yield module, name, value
