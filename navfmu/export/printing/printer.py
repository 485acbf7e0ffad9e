"""From the record to C: a function that evaluates it, and the functions that it calls."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from weakref import WeakKeyDictionary

import numpy as np

from navfmu.export.record.arrays import Call, Fold, Map, Pack, Product, Repeat, Routine, Run
from navfmu.export.record.graph import CALLS, OPERATIONS, TRUTHS, Array, Node, Operand, depends, in_order

#: What stands somewhere already: a number, or the first one of an array, as a vector's name and a place.
Known = Mapping[Node, tuple[str, int]]
_NONE: Known = MappingProxyType({})
WIDTH = 116  # of lines that are filled
STACK = 1 << 16  # bytes that the arrays of a function, and of those that it calls, may take; a thread may have 512 kB
_KEPT = "\N{NO-BREAK SPACE}"  # a space at which no line ends
_SHORT = 4  # so many statements are no loop
_DEEP = 32  # so many maps, each within the next, are one loop
#: What routines are given besides numbers, as an argument of the functions in which they are called.
DECLARATIONS = {"tables": "Table *tables"}


#: Where arrays lie that are too large for the stack of a host's thread.
WORK = "double *restrict work"


@dataclass(frozen=True)
class Printed:
    """The text of a C function; how many numbers it needs on the stack and in ``work``, with all that it calls."""

    text: str
    stack: int
    work: int


def c_function(
    function: str,
    vectors: Iterable[str],
    results: Sequence[Node],
    known: Known = _NONE,
    values: Container[str] = (),
    others: Sequence[str] = (),
) -> Printed:
    """Return a C function of the vectors and ``double *r`` that sets ``r[i]`` to ``results[i]``.

    The nodes that are ``known`` are read and not calculated; vectors of one number that are among ``values`` are passed
    as such. ``others`` are declarations of what it is given besides: what routines need, and memory to work in, which
    it is given anyway if it needs some.
    """
    body = _Body(results, known, values)
    lines = body.lines()
    others = [*others, *([WORK] if body.work and WORK not in others else [])]
    arguments = [f"double {v}" if v in values else f"const double *restrict {v}" for v in vectors]
    head = f"static void {function}({', '.join([*arguments, *others, 'double *restrict r'])}) {{"
    return Printed("\n".join([head, *lines, "}", ""]), body.stack, body.work)


def c_helpers(results: Iterable[Node]) -> list[str]:
    """Return the C functions that are called in calculating the results, each once and before those that call it."""
    found: dict[Call, str] = {}

    def visit(nodes: Iterable[Node]) -> None:
        for node in in_order(nodes):
            call, operands = _called(node)
            if call is not None and call not in found:
                visit(call.results)
                found[call] = c_call(call, [operand.size for operand in operands])

    visit(results)
    return list(found.values())


def c_call(call: Call, sizes: Sequence[int]) -> str:
    """Return the C function of a call whose operands have these sizes."""
    return _printed(call, sizes).text


_prints: WeakKeyDictionary[Call, Printed] = WeakKeyDictionary()


def _printed(call: Call, sizes: Sequence[int]) -> Printed:
    """Return the function of a call, which is printed once."""
    if call not in _prints:
        values = {name for name, size in zip(call.vectors, sizes, strict=True) if size == 1}
        others = [DECLARATIONS[b] for b in call.before]
        one = c_function(call.name, call.vectors, call.results, values=values, others=others)
        _prints[call] = replace(one, text=f"{comment(call.about)}\n{one.text}") if call.about else one
    return _prints[call]


def comment(text: str) -> str:
    """Return a text as a comment in C, with lines that end at its signs; names may have any letters."""
    text = text.replace("*/", "* /").encode("ascii", "backslashreplace").decode()
    kept = re.sub(r"(?<![,:]) ", _KEPT, text)
    lines = textwrap.fill(f"/*{_KEPT}{kept}.", WIDTH - 3, subsequent_indent=" * ", break_long_words=False)
    return lines.replace(_KEPT, " ") + " */"


def _called(node: Node) -> tuple[Call | None, Sequence[Operand]]:
    """Return the function that a node calls, and what that is given."""
    how = node.how if isinstance(node, Array) else None
    if isinstance(how, Call):
        return how, node.operands
    return (how.call, node.operands[:-1]) if isinstance(how, Repeat) else (None, ())


def has_arrays(results: Iterable[Node]) -> bool:
    """Return whether anything is kept whole, so that the code needs ``arrays.h``."""
    return any(isinstance(node, Array) for node in in_order(results))


def c_number(value: float) -> str:
    """Return a number as C reads it back, to the last bit."""
    if math.isnan(value):
        return "NAN"
    text = "INFINITY" if math.isinf(value) else repr(abs(value))
    return f"(-{text})" if math.copysign(1.0, value) < 0 else text


def _plus(text: str, place: int | str) -> str:
    return text if str(place) == "0" else f"{text} + {place}"


def _operation(node: Node, texts: Mapping[Node, str], truths: Container[str]) -> str:
    """Return the C expression of an operation.

    Truth values are ints, and doubles where one calculates with them; two of them are combined without a jump.
    """
    tells = (0,) if node.op == "where" else TRUTHS.get(node.op, ())
    true = [texts[n] in truths for n in node.of]
    operands = [
        f"(double){texts[n]}" if truth and i not in tells else texts[n]
        for i, (n, truth) in enumerate(zip(node.of, true, strict=True))
    ]
    if node.op in ("and", "or") and all(true):
        return f"{operands[0]} {'&' if node.op == 'and' else '|'} {operands[1]}"
    return OPERATIONS[node.op].format(*operands)


class _Places:
    """Where arrays lie: buffers, each used again when what was in it is not needed any more."""

    def __init__(self) -> None:
        self.sizes: list[int] = []
        self.until: list[float] = []  # when what is in it was used last

    def take(self, size: int, now: int, until: float) -> int:
        """Return the number of a buffer for so many numbers."""
        free = [k for k, end in enumerate(self.until) if end < now]
        fitting = [k for k in free if self.sizes[k] >= size]
        if fitting:
            k = min(fitting, key=lambda k: self.sizes[k])
        elif free:
            k = max(free, key=lambda k: self.sizes[k])
            self.sizes[k] = size
        else:
            k = len(self.sizes)
            self.sizes.append(size)
            self.until.append(0)
        self.until[k] = until
        return k


class _Body:
    """The statements of one function."""

    def __init__(self, results: Sequence[Node], known: Known, values: Container[str]) -> None:
        self.results, self.known, self.values = results, known, values
        self.texts: dict[Node, str] = {}
        self.names: dict[str, str] = {}  # C expression -> the name of its value
        self.truths: set[str] = set()
        self.statements: list[str] = []
        self.constants: dict[tuple[str, bytes], tuple[str, str]] = {}  # kind and numbers -> name and definition
        self.buffers = _Places()
        self.stack = self.work = 0  # numbers that it needs, with what it calls
        self.now = 0  # which node it is that is printed
        self.in_loops = 0  # names that were given
        self.final = self._final()  # arrays that lie in the results, and where

    def lines(self) -> list[str]:
        """Return the lines of the function."""
        order = in_order(self.results, self.known)
        whole = [node for node in order if isinstance(node, Array) and node not in self.known]
        if all(isinstance(array.how, Routine) for array in whole):
            order = _calls_first(order, self.known)
        self.fused = _fused(order, whole)
        last = self._last_uses(order)
        once = self._read_nowhere(order)
        within = self._within_arrays(whole)
        for now, node in enumerate(order):
            if isinstance(node, Array):
                if node not in self.known and node not in self.fused:
                    self.now = now
                    self._array(node, now, last.get(node, 0))
                    self._store_of(node, within.get(node, []))
            elif node in once:
                self.texts[node] = self._stored(node, once[node])
            else:
                self.texts[node] = self._number(node)
        done = {*once.values(), *(i for places in within.values() for i in places)}
        for i, node in enumerate(self.results):
            if i not in done:
                self.statements.append(f"    r[{i}] = {self.texts[node]};")
        return [*(text for _, text in self.constants.values()), *self._memory(whole), *self.statements]

    def _memory(self, whole: Sequence[Array]) -> list[str]:
        """Return the definitions of the buffers, on the stack if it holds them and those of all that is called."""
        called = [_printed(call, [o.size for o in operands]) for call, operands in map(_called, whole) if call]
        self.stack = max((one.stack for one in called), default=0)
        self.work = max((one.work for one in called), default=0)
        sizes = self.buffers.sizes
        if 8 * (sum(sizes) + self.stack) <= STACK:
            self.stack += sum(sizes)
            lines = [f"    double w{k}[{size}];" for k, size in enumerate(sizes)]
            return [*lines, "    double *const rest = work;"] if self.work else lines
        first = [sum(sizes[:k]) for k in range(len(sizes) + 1)]
        lines = [f"    double *const w{k} = {_plus('work', place)};" for k, place in enumerate(first[:-1])]
        lines += [f"    double *const rest = work + {first[-1]};"] if self.work else []
        self.work += first[-1]
        return lines

    def _rest(self, call: Call, sizes: Sequence[int]) -> list[str]:
        """Return the memory that a function is given to work in."""
        return ["rest"] if _printed(call, sizes).work else []

    def _last_uses(self, order: list[Node]) -> dict[Node, float]:
        last: dict[Node, float] = {}

        def use(node: Node, now: float) -> None:
            for used in depends(node):
                if used.op == "element" or used in self.fused:
                    use(used, now)
                elif isinstance(used, Array):
                    last[used] = now

        for now, node in enumerate(order):
            if node not in self.fused and node not in self.known:
                use(node, now)
        return last

    # --- single numbers ---

    def _number(self, node: Node) -> str:
        if node in self.known:
            return "{}[{}]".format(*self.known[node])
        if node.op == "number":
            return c_number(node.of[0])
        if node.op == "element":
            source, place = node.of
            if isinstance(source, Array):
                vector, first = self._array_place(source)
                return f"{vector}[{first + place}]"
            return source if source in self.values else f"{source}[{place}]"
        return self._named(node.op in TRUTHS, _operation(node, self.texts, self.truths), self.names, self.statements)

    def _read_nowhere(self, order: Sequence[Node]) -> dict[Node, int]:
        """Return the operations that are a result once and nothing else, and which result: they need no name."""
        places: dict[Node, list[int]] = {}
        for i, node in enumerate(self.results):
            places.setdefault(node, []).append(i)
        read = {used for node in order for used in depends(node)}
        return {
            node: where[0]
            for node, where in places.items()
            if len(where) == 1 and node.op in OPERATIONS and node not in read and node not in self.known
        }

    def _stored(self, node: Node, place: int) -> str:
        """Set a result to what an operation gives."""
        text = _operation(node, self.texts, self.truths)
        self.statements.append(f"    r[{place}] = {self.names.get(text, text)};")
        return f"r[{place}]"

    def _named(self, truth: bool, text: str, names: dict[str, str], statements: list[str], indent: str = "    ") -> str:
        """Return the name of the value of an expression, which is calculated once."""
        if text not in names:
            name = f"{'is' if truth else 'a'}{len(names)}"
            if names is not self.names:  # within a loop
                self.in_loops += 1
                name = f"t{self.in_loops}"
            names[text] = name
            if truth:
                self.truths.add(name)
            statements.append(f"{indent}const {'int' if truth else 'double'} {name} = {text};")
        return names[text]

    def _final(self) -> dict[Array, int]:
        """Return the arrays that are results as wholes, and where: they are calculated in their place."""
        found: dict[Array, int] = {}
        for i, node in enumerate(self.results):
            array = node.of[0] if node.op == "element" else None
            if not isinstance(array, Array) or node.of[1] or array in self.known or array in found:
                continue
            last = self.results[i : i + array.size]
            if len(last) == array.size and all(
                n.op == "element" and n.of[0] is array and n.of[1] == k for k, n in enumerate(last)
            ):
                found[array] = i
        return found

    def _within_arrays(self, whole: Sequence[Array]) -> dict[Array, list[int]]:
        """Return which results are elements of arrays: they are set as soon as these are calculated."""
        found: dict[Array, list[int]] = {array: [] for array in whole}
        for i, node in enumerate(self.results):
            if node.op == "element" and node not in self.known and node.of[0] in found:
                found[node.of[0]].append(i)
        return found

    def _store_of(self, array: Array, results: Sequence[int]) -> None:
        """Set results that are elements of an array; those at equal distances in a loop."""
        left = list(results)
        if array in self.final:
            left = [i for i in left if not 0 <= i - self.final[array] < array.size]
        vector, first = self._array_place(array)
        while left:
            places = [self.results[left[0]].of[1]]
            for i, before in zip(left[1:], left, strict=False):
                place = self.results[i].of[1]
                if i != before + 1 or (len(places) > 1 and place - places[-1] != places[1] - places[0]):
                    break
                places.append(place)
            n = len(places) if len(places) >= _SHORT else 1
            if n == 1:
                self.statements.append(f"    r[{left[0]}] = {vector}[{first + places[0]}];")
            else:
                read = _sum([("i", places[1] - places[0])], first + places[0])
                self.statements.append(
                    f"    for (int i = 0; i < {n}; i++) r[{_plus('i', left[0])}] = {vector}[{read}];"
                )
            left = left[n:]

    # --- arrays ---

    def _array_place(self, array: Array) -> tuple[str, int]:
        return self.known[array] if array in self.known else (self.texts[array], 0)

    def _array(self, array: Array, now: int, until: float) -> None:
        name = self.texts[array] = f"b{now}"
        where = _plus("r", self.final[array]) if array in self.final else None
        where = where or f"w{self.buffers.take(array.size, now, max(until, now))}"
        self.statements.append(f"    double *const {name} = {where};")
        {
            Pack: self._pack,
            Map: self._map,
            Fold: self._fold,
            Run: self._run,
            Product: self._product,
            Call: self._call,
            Repeat: self._repeat,
            Routine: self._routine,
        }[type(array.how)](array, name)

    def _constant(self, kind: str, numbers: np.ndarray) -> str:
        key = kind, numbers.tobytes()
        if key not in self.constants:
            name = f"{'c' if kind == 'double' else 'n'}{len(self.constants)}"
            texts = (c_number(x).removesuffix(".0") if kind == "double" else str(x) for x in numbers.tolist())
            text = textwrap.fill(", ".join(texts), WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 8)
            self.constants[key] = name, f"    static const {kind} {name}[] = {{\n{text}\n    }};"
        return self.constants[key][0]

    def _vector(self, operand: Operand) -> tuple[str, int]:
        """Return the name of the vector that an operand reads, and by how much its places are shifted there."""
        if isinstance(operand.source, str):
            return f"(&{operand.source})" if operand.source in self.values else operand.source, 0
        if isinstance(operand.source, np.ndarray):
            return self._constant("double", operand.source), 0
        assert isinstance(operand.source, Array)
        return self._array_place(operand.source)

    def _pointer(self, operand: Operand) -> str:
        vector, shift = self._vector(operand)
        assert operand.places is not None
        return _plus(vector, shift + int(operand.places[0]))

    def _value(self, operand: Operand) -> str:
        """Return the one number that an operand is at all its places."""
        if operand.places is None:
            return self.texts[operand.source]
        if isinstance(operand.source, str) and operand.source in self.values:
            return operand.source
        if isinstance(operand.source, np.ndarray):
            return c_number(float(operand.source[operand.places[0]]))
        vector, shift = self._vector(operand)
        return f"{vector}[{shift + int(operand.places[0])}]"

    def _same(self, operand: Operand) -> bool:
        return operand.places is None or bool(np.all(operand.places == operand.places[0]))

    def _map(self, array: Array, name: str) -> None:
        leaves = [o for o in self._leaves(array) if not self._same(o)]
        grid = _Grid(array.how.shape, leaves)
        texts: dict[Operand, str] = {}
        for k, operand in enumerate(leaves):
            vector, shift = self._vector(operand)
            if grid.irregular[k]:
                table = self._constant("int", operand.places)
                index = f"{table}[{grid.index(k)}]"
                texts[operand] = f"{vector}[{_plus(index, shift)}]"
            else:
                texts[operand] = f"{vector}[{grid.index(k, shift + int(operand.places[0]))}]"
        statements: list[str] = []
        indent = "    " * (1 + len(grid.lengths))
        value = self._formula(array, texts, {}, statements, indent)
        self.statements += grid.open()
        if len(statements) or not grid.lengths:
            if grid.lengths:
                self.statements[-1] += " {"
            self.statements += [*statements, f"{indent}{name}[{grid.place}] = {value};"]
            if grid.lengths:
                self.statements.append("    " * len(grid.lengths) + "}")
        else:
            self.statements.append(f"{indent}{name}[{grid.place}] = {value};")

    def _within(self, operand: Operand) -> bool:
        return isinstance(operand.source, Array) and operand.source in self.fused

    def _leaves(self, array: Array) -> list[Operand]:
        """Return what a map reads, and what the maps read that are calculated within it."""
        found: dict[Operand, None] = {}
        for operand in {o.source if self._within(o) else o: o for o in array.operands}.values():
            found |= dict.fromkeys(self._leaves(operand.source) if self._within(operand) else [operand])
        return list(found)

    def _formula(
        self, array: Array, texts: dict[Operand, str], names: dict[str, str], statements: list[str], indent: str
    ) -> str:
        """Write what a map calculates at one place, and return the text of its last operation."""
        given = []
        within: dict[Array, str] = {}
        for operand in array.operands:
            if self._within(operand):
                one = operand.source
                if one not in within:
                    text = self._formula(one, texts, names, statements, indent)
                    within[one] = self._named(one.how.formula.op in TRUTHS, text, names, statements, indent)
                given.append(within[one])
            else:
                given.append(texts[operand] if operand in texts else self._value(operand))
        return self._formula_text(array.how.formula, given, names, statements, indent)

    def _formula_text(
        self, formula: Node, given: Sequence[str], names: dict[str, str], statements: list[str], indent: str
    ) -> str:
        texts: dict[Node, str] = {}
        text = ""
        for node in in_order([formula]):
            if node.op == "number":
                text = c_number(node.of[0])
            elif node.op == "element":
                text = given[node.of[1]]
            else:
                text = _operation(node, texts, self.truths)
                if node is not formula:
                    text = self._named(node.op in TRUTHS, text, names, statements, indent)
            texts[node] = text
        return text

    def _fold(self, array: Array, name: str) -> None:
        how: Fold = array.how
        vector, row, place, along = self._read_rows(array)
        if how.pairwise:
            begin = "" if how.first is None else f"{c_number(how.first)} + "
            self.statements += [
                f"    for (int i = 0; i < {how.rows}; i++)",
                f"        {name}[i] = {begin}sum({_plus(vector, row)}, {how.length}, {along});",
            ]
            return
        first = c_number(how.first) if how.first is not None else f"{vector}[{row}]"
        begin = int(how.first is None)
        self.statements.append(f"    for (int i = 0; i < {how.rows}; i++) {name}[i] = {first};")
        self._rows(how, begin, f"{name}[i]", f"{vector}[{place}]", f"{name}[i]")

    def _read_rows(self, array: Array) -> tuple[str, str, str, int]:
        """Return where rows are read: the vector, the places of row i and of its number j, and the step along a row."""
        (operand,) = array.operands
        vector, shift = self._vector(operand)
        across, along = operand.strides((array.how.rows, array.how.length))
        start = shift + int(operand.places[0])
        return vector, _sum([("i", across)], start), _sum([("i", across), ("j", along)], start), along

    def _rows(self, how: Fold | Run, begin: int, before: str, read: str, to: str) -> None:
        """Write the loops that fold rows, all rows side by side: so none waits for itself."""
        statements: list[str] = []
        text = self._formula_text(how.formula, [before, read], {}, statements, "            ")
        self.statements += [
            f"    for (int j = {begin}; j < {how.length}; j++)",
            f"        for (int i = 0; i < {how.rows}; i++) {{",
            *statements,
            f"            {to} = {text};",
            "        }",
        ]

    def _run(self, array: Array, name: str) -> None:
        how: Run = array.how
        vector, first, place, _ = self._read_rows(array)
        row, step = _sum([("i", how.length)], 0), _sum([("i", how.length), ("j", 1)], 0)
        self.statements.append(f"    for (int i = 0; i < {how.rows}; i++) {name}[{row}] = {vector}[{first}];")
        self._rows(how, 1, f"{name}[{step} - 1]", f"{vector}[{place}]", f"{name}[{step}]")

    def _product(self, array: Array, name: str) -> None:
        how: Product = array.how
        texts = []
        for operand, shape in zip(array.operands, ((how.rows, how.inner), (how.inner, how.columns)), strict=True):
            down, right = operand.strides(shape)
            texts.append(f"{self._pointer(operand)}, {down}, {right}")
        sizes = f"{how.rows}, {how.inner}, {how.columns}"
        self.statements.append(f"    product({sizes}, {', '.join(texts)}, {name});")

    def _call(self, array: Array, name: str) -> None:
        given = [self._value(o) if o.size == 1 else self._pointer(o) for o in array.operands]
        given += self._rest(array.how, [o.size for o in array.operands])
        self.statements.append(f"    {array.how.name}({', '.join([*given, name])});")

    def _repeat(self, array: Array, name: str) -> None:
        how: Repeat = array.how
        begin, *others, count = array.operands
        self._copy(begin, name, 0)
        now = f"{name}[0]" if array.size == 1 else name
        given = [now, *(self._value(o) if o.size == 1 else self._pointer(o) for o in others), *how.call.before]
        given += self._rest(how.call, [o.size for o in array.operands[:-1]])
        after = f"w{self.buffers.take(array.size, self.now, self.now)}"
        self.statements += [
            f"    for (int i = 0; i < {how.most} && i < {self._value(count)}; i++) {{",
            f"        {how.call.name}({', '.join([*given, after])});",
            f"        for (int j = 0; j < {array.size}; j++) {name}[j] = {after}[j];",
            "    }",
        ]

    def _routine(self, array: Array, name: str) -> None:
        how: Routine = array.how
        given = [self._value(o) if k in how.values else self._pointer(o) for k, o in enumerate(array.operands)]
        arguments = [*how.before, *map(str, how.numbers), *given, name]
        self.statements.append(f"    {how.name}({', '.join(arguments)});")

    def _pack(self, array: Array, name: str) -> None:
        first = 0
        for piece in array.operands:
            self._copy(piece, name, first)
            first += piece.size

    def _copy(self, piece: Operand, name: str, first: int) -> None:
        """Copy what an operand reads to ``name[first]`` and behind."""
        if self._same(piece):
            value = self._value(piece)
            if piece.size < _SHORT:
                self.statements += [f"    {name}[{first + i}] = {value};" for i in range(piece.size)]
            else:
                self._loop(piece.size, name, first, lambda i: value)
            return
        vector, shift = self._vector(piece)
        places = piece.places + shift
        if piece.size < _SHORT:
            self.statements += [f"    {name}[{first + i}] = {vector}[{p}];" for i, p in enumerate(places.tolist())]
            return
        steps = np.diff(places)
        length = int(np.argmax(steps != steps[0])) + 1 if np.any(steps != steps[0]) else piece.size
        if length == piece.size:
            text = _sum([("i", int(steps[0]))], int(places[0]))
            self._loop(piece.size, name, first, lambda i: f"{vector}[{text}]")
        elif piece.size % length == 0 and length > 1 and piece.strides((piece.size // length, length)):
            across, along = piece.strides((piece.size // length, length))
            text = _sum([("i", across), ("j", along)], int(places[0]))
            self.statements += [
                f"    for (int i = 0; i < {piece.size // length}; i++)",
                f"        for (int j = 0; j < {length}; j++)",
                f"            {name}[{_sum([('i', length), ('j', 1)], first)}] = {vector}[{text}];",
            ]
        else:
            table = self._constant("int", places)
            self._loop(piece.size, name, first, lambda i: f"{vector}[{table}[i]]")

    def _loop(self, n: int, name: str, first: int, text: Callable[[str], str]) -> None:
        self.statements.append(f"    for (int i = 0; i < {n}; i++) {name}[{_plus('i', first)}] = {text('i')};")


def _sum(terms: Iterable[tuple[str, int]], first: int) -> str:
    """Return the text of ``first`` plus multiples of variables."""
    parts = [variable if step == 1 else f"{step} * {variable}" for variable, step in terms if step]
    text = " + ".join([*parts, *([str(first)] if first or not parts else [])])
    return text


class _Grid:
    """Loops over all places of a shape: axes that all operands go through as if they were one become one."""

    def __init__(self, shape: Sequence[int], operands: Sequence[Operand]) -> None:
        strides = [operand.strides(shape) for operand in operands]
        flat = [math.prod(shape[axis + 1 :]) for axis in range(len(shape))]
        self.irregular = [steps is None for steps in strides]
        steps = [flat, *(flat if s is None else s for s in strides)]
        self.lengths: list[int] = []
        self.steps: list[list[int]] = [[] for _ in steps]
        for axis, n in enumerate(shape):
            if n == 1:
                continue
            if self.lengths and all(mine[-1] == of[axis] * n for mine, of in zip(self.steps, steps, strict=True)):
                self.lengths[-1] *= n
                for mine, of in zip(self.steps, steps, strict=True):
                    mine[-1] = of[axis]
            else:
                self.lengths.append(n)
                for mine, of in zip(self.steps, steps, strict=True):
                    mine.append(of[axis])
        self.variables = "ijklmnopq"[: len(self.lengths)]
        self.place = _sum(zip(self.variables, self.steps[0], strict=True), 0)

    def index(self, k: int, first: int = 0) -> str:
        """Return the place of operand k in its source."""
        return _sum(zip(self.variables, self.steps[k + 1], strict=True), first)

    def open(self) -> list[str]:
        """Return the heads of the loops."""
        return [
            f"{'    ' * (1 + k)}for (int {i} = 0; {i} < {n}; {i}++)"
            for k, (i, n) in enumerate(zip(self.variables, self.lengths, strict=True))
        ]


def _fused(order: Sequence[Node], whole: Sequence[Array]) -> set:
    """Return the maps that are calculated within the one map that reads them and stored nowhere."""
    users: dict[Node, list[Node]] = {}
    for node in order:
        for used in depends(node):
            if isinstance(used, Array):
                users.setdefault(used, []).append(node)
    found = set()
    depth: dict[Node, int] = {}  # how many maps are within a map, one in another
    for array in whole:
        depth[array] = 1 + max((depth[node] for node in array.of if node in found), default=0)
        if depth[array] > _DEEP or not isinstance(array.how, Map) or len(users.get(array, ())) != 1:
            continue
        (user,) = users[array]
        if not isinstance(user, Array) or not isinstance(user.how, Map) or user.size != array.size:
            continue
        reading = [o for o in user.operands if o.source is array]
        if all(o.contiguous and o.size == array.size for o in reading):
            found.add(array)
    return found


def _calls_first(nodes: list[Node], known: Container[Node]) -> list[Node]:
    """Return nodes in another valid order: calls early, before each only what it needs.

    A call destroys all registers: what was calculated before it and is used after it goes to memory and back.
    """

    def operands(node: Node) -> tuple:
        return () if node in known else depends(node)

    calls = {node for node in nodes if (node.op in CALLS or isinstance(node, Array)) and node not in known}
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
