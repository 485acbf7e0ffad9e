"""Functions of the model that are called with arrays: where arrays are kept whole, each is traced once and called.

A function is compiled for arguments of certain shapes and kinds and certain constants; the same ones again are a call
of the same code. What cannot be a call (a function that changes its arguments, is given an object, returns a view of
one, or decides by a value that is known only where it is called) is traced in its place, as if it stood there.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import wraps
from types import FunctionType, ModuleType
from typing import Any
from weakref import WeakSet

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.export.record import arrays
from navfmu.export.record.graph import Node, element, is_inexact, vectors_read
from navfmu.export.record.graph import number as constant
from navfmu.export.tracing import wholes
from navfmu.export.tracing.extent import FEWER, LEAST, TooLong, current, shortest
from navfmu.export.tracing.fresh import running
from navfmu.export.tracing.rules import Scalar, expression
from navfmu.export.tracing.traced import Traced, expressions, symbols, type_of

#: A function of fewer operations is not worth a call.
_FEW = 24

_recorded: WeakSet[Callable] = WeakSet()  # functions that stand for others while tracing


class _NoCall(Exception):
    """This cannot be a call."""


@dataclass(frozen=True)
class _Given:
    """A traced argument or result: its shape, its kind ("f", "i" or "b"), and whether it is a lone element; or numbers
    that are known where the function is called."""

    shape: tuple[int, ...]
    kind: str
    lone: bool
    known: bool = False


@dataclass(frozen=True)
class _Recorded:
    """A function that was traced: its call, and its results as a tree of constants and of places of its numbers."""

    how: arrays.Call
    tree: Any
    numbers: tuple[
        int | float | tuple[int, int], ...
    ]  # of each: its place in the call's, an operand and place, or itself


class _Arguments:
    """What is met in a tree, in order: what is traced, and all arrays. Real numbers that are known are taken for traced
    ones, in arrays of at least ``least``."""

    def __init__(self, tree: Any, known: Iterable[np.ndarray] = (), least: float = math.inf) -> None:
        self.least = least
        self.leaves: list[Any] = []
        self.arrays: list[np.ndarray] = []
        self.known = {id(array): k for k, array in enumerate(known)}
        self.tree = _taken(tree, self)


def recorded(function: FunctionType) -> Callable:
    """Return the function, which is recorded as a call where arrays are kept whole."""

    @wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        extent = current()
        if not extent.calls:
            before = extent.operations
            result = function(*args, **kwargs)
            extent.write_out(function, extent.operations - before)
            return result
        try:
            return _call(function, args, kwargs)
        except _NoCall:
            return function(*args, **kwargs)

    _recorded.add(called)
    return called


def _call(function: FunctionType, args: tuple, kwargs: dict) -> Any:
    found, given = _found(function, (args, kwargs))
    leaves = given.leaves
    columns = [[leaf] if isinstance(leaf, Scalar) else leaf.view(np.ndarray).ravel().tolist() for leaf in leaves]
    operands = [wholes.operand(column) if len(column) == 1 else wholes.block(column) for column in columns]
    array = wholes.made(found.how, len(found.how.results), operands)

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

    return _given(found.tree, filled, given.arrays)[0]


def _found(function: FunctionType, given: Any) -> tuple[_Recorded, _Arguments]:
    """Return what was recorded of a function for such arguments, and the arrays and numbers that are passed.

    Arrays of constants are passed as others are, or each would make a copy of the function; they are part of it where
    it cannot be traced without knowing them.
    """
    known = current().functions
    if not _Arguments(given).leaves:
        raise _NoCall
    for least in (LEAST, math.inf):
        met = _Arguments(given, least=least)
        key = function, met.tree, running().has_room  # one that fails without room is not one that fails
        if key not in known:
            known[key] = None  # also while it is traced: one that calls itself is no call
            known[key] = _record(function, met.tree, len(known))
        if (found := known[key]) is not None:
            return found, met
    raise _NoCall


def _record(function: FunctionType, tree: Any, number: int) -> _Recorded | None:
    """Trace a function with symbols in place of its arguments; None if it has to be traced where it is called."""

    def run() -> tuple[list[Node], Any]:
        places.clear()
        constants: set[str] = set()

        def parameter(given: _Given, _: int) -> Any:
            name = f"p{len(places)}_{number}"
            places[name] = len(places)
            if given.known:
                constants.add(name)
            vector = symbols(name, given.kind * math.prod(given.shape))
            current().meet(vector.size)
            return vector.view(np.ndarray)[0] if given.lone else vector.reshape(given.shape)

        (args, kwargs), made = _given(tree, parameter)
        for array in made:
            array.setflags(write=False)
        alive: list[Any] = []
        before = _held((args, kwargs), alive)
        result = _Arguments(function(*args, **kwargs), made)
        if before != _held((args, kwargs), alive) or _overlap(result.arrays, made):
            raise _NoCall
        nodes = [node for leaf in result.leaves for node in expressions(leaf)]
        if not places.keys() >= {*vectors_read(nodes)}:  # it knows traced values that it was not given
            raise _NoCall
        if is_inexact(nodes, constants):  # NumPy does that where it is traced in place
            raise _NoCall
        return nodes, result.tree

    places: dict[str, int] = {}  # the vectors that stand for the arguments, by their names

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
            numbers.append((places[node.of[0]], node.of[1]))
        else:
            numbers.append(len(results))
            results.append(node)
    if not results:
        return None
    name = re.sub(r"\W", "_", f"{function.__module__.rpartition('.')[2]}_{function.__name__}_{number}", flags=re.ASCII)
    return _Recorded(
        arrays.Call(name, tuple(places), tuple(results), about=_about(function, tree, list(places))),
        result,
        tuple(numbers),
    )


def _about(function: FunctionType, tree: Any, vectors: Sequence[str]) -> str:
    """Return "ins.moved: p0_7 is x (24,), p1_7 is nominal[0] (3,)": the operands in the order in which they are
    passed."""
    args, kwargs = tree.items
    named = inspect.signature(function).bind_partial(*args.items).arguments if args.items else {}
    told: list[str] = []

    def tell(name: str, tree: Any) -> None:
        if isinstance(tree, _Given):
            told.append(f"{vectors[len(told)]} is {name}{f' {tree.shape}'.replace(', ', ',') if tree.shape else ''}")
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


def _held(tree: Any, alive: list[Any]) -> Any:
    """Return what containers hold, by identity, so that it is seen whether one was changed; what is ``alive`` has it
    alone."""
    if isinstance(tree, list | tuple):
        return [_held(item, alive) for item in tree]
    if isinstance(tree, dict):
        return {key: _held(item, alive) for key, item in tree.items()}
    alive.append(tree)
    return id(tree)


def _overlap(results: list[np.ndarray], given: list[np.ndarray]) -> bool:
    """Whether what is assigned to one array of the results would be seen in another, or in an argument."""
    ours, theirs = ([array.view(np.ndarray) for array in arrays] for arrays in (results, given))
    return any(np.may_share_memory(one, other) for k, one in enumerate(ours) for other in [*ours[k + 1 :], *theirs])


@dataclass(frozen=True)
class _Constant:
    """An array of constants, by its numbers, or one of NumPy's numbers; ``traced`` is an array that can get others."""

    dtype: str
    shape: tuple[int, ...]
    content: bytes
    array: bool
    traced: bool = False


@dataclass(frozen=True)
class _Same:
    """A result that is one of the arrays of the arguments."""

    place: int


@dataclass(frozen=True)
class _Container:
    type: type
    keys: tuple
    items: tuple


def _taken(tree: Any, met: _Arguments) -> Any:
    """Return a tree that can be a key, with what is traced in it replaced; that is met."""
    if isinstance(tree, np.ndarray):
        if id(tree) in met.known:
            return _Same(met.known[id(tree)])
        met.arrays.append(tree)
    if isinstance(tree, Scalar):
        met.leaves.append(tree)
        return _Given((), tree.kind, True)
    if isinstance(tree, Traced):
        elements = tree.view(np.ndarray).ravel().tolist()
        if not any(type(e) is Scalar for e in elements):
            numbers = np.array(elements, type_of(elements))
            if numbers.dtype == float and numbers.size >= met.least:
                met.leaves.append(tree)
                return _Given(tree.shape, "f", False, known=True)
            return _Constant(numbers.dtype.str, tree.shape, numbers.tobytes(), True, True)
        met.leaves.append(tree)
        kind = {float: "f", int: "i", bool: "b"}[type_of(elements)]
        return _Given(tree.shape, kind, False)
    if isinstance(tree, FunctionType) and tree not in _recorded and (tree.__closure__ or tree.__defaults__):
        raise _NoCall  # it may know traced values
    if tree is None or isinstance(tree, bool | int | float | str | FunctionType | type) or tree is Ellipsis:
        return _Number(type(tree), repr(tree)) if isinstance(tree, float) else _Plain(type(tree), tree)
    if isinstance(tree, slice):
        return _Container(slice, (), tuple(_taken(item, met) for item in (tree.start, tree.stop, tree.step)))
    if isinstance(tree, np.ndarray) and tree.dtype == float and tree.size >= met.least:
        met.leaves.append(tree)
        return _Given(tree.shape, "f", False, known=True)
    if isinstance(tree, np.ndarray | np.generic) and tree.dtype != object:
        content = np.ascontiguousarray(tree).tobytes()
        return _Constant(tree.dtype.str, np.shape(tree), content, isinstance(tree, np.ndarray))
    if type(tree) in (list, tuple) or (isinstance(tree, tuple) and hasattr(tree, "_fields")):
        return _Container(type(tree), (), tuple(_taken(item, met) for item in tree))
    if type(tree) is dict:
        return _Container(dict, tuple(tree), tuple(_taken(item, met) for item in tree.values()))
    raise _NoCall


@dataclass(frozen=True)
class _Plain:
    type: type
    value: Any


@dataclass(frozen=True)
class _Number:
    type: type
    text: str


def _given(
    tree: Any, filled: Callable[[_Given, int], Any], known: Sequence[np.ndarray] = ()
) -> tuple[Any, list[np.ndarray]]:
    """Return what a tree stands for, with ``filled(given, first)`` for what is traced, and the arrays in it."""
    first = 0
    made: list[np.ndarray] = []

    def build(tree: Any) -> Any:
        nonlocal first
        if isinstance(tree, _Same):
            return known[tree.place]
        if isinstance(tree, _Given | _Constant):
            if isinstance(tree, _Given):
                value = filled(tree, first)
                first += math.prod(tree.shape)
            else:
                value = np.frombuffer(tree.content, tree.dtype).reshape(tree.shape)
                value = value.astype(object).view(Traced) if tree.traced else value.copy() if tree.array else value[()]
            if isinstance(value, np.ndarray):
                made.append(value)
            return value
        if isinstance(tree, _Plain):
            return tree.value
        if isinstance(tree, _Number):
            return float(tree.text)
        items = [build(item) for item in tree.items]
        if tree.type is dict:
            return dict(zip(tree.keys, items, strict=True))
        return tree.type(*items) if tree.type is slice or hasattr(tree.type, "_fields") else tree.type(items)

    return build(tree), made


def functions(modules: Iterable[ModuleType]) -> Iterator[tuple[ModuleType, str, FunctionType]]:
    """Yield the plain functions that modules have of their own and from each other: module, name and function."""
    listed = list(modules)
    names = {module.__name__ for module in listed}
    for module in listed:
        for name, value in vars(module).items():
            if isinstance(value, FunctionType) and value.__module__ in names:
                yield module, name, value
