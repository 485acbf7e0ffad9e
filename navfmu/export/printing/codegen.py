"""From the lowered model to its C source: a function for each task, and tables of constants around them."""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections import Counter
from collections.abc import Iterable

from navfmu.errors import NavfmuError
from navfmu.export import life
from navfmu.export.printing.printer import (
    DECLARATIONS,
    WIDTH,
    WORK,
    c_function,
    c_helpers,
    c_number,
    comment,
    has_arrays,
)
from navfmu.export.record import ir
from navfmu.export.record.graph import Array, Node, element, settled
from navfmu.files import numbers

#: The vectors that a task's function reads, in order, what its routines search, and where it works.
VECTORS, OTHERS = ("v", "noise", "time", "fixed"), (DECLARATIONS["tables"], WORK)


def generate(model: ir.Model, guid: str) -> str:
    """Return ``model.c``: everything that the generic runtime needs to know about ``model``."""
    return "\n".join(_source(model, guid)) + "\n"


def clocks(model: ir.Model) -> list[ir.Clock]:
    """Return the distinct clocks that drive the model."""
    return list(dict.fromkeys(task.clock for task in model.tasks if task.clock is not None))


def continuous_inputs(model: ir.Model) -> list[int]:
    """Return the indices of the inputs that may have a derivative; what passes through has its value only."""
    return [] if model.through else [i for v in model.variables if is_continuous_input(v) for i in v.indices]


def is_continuous_input(variable: ir.Variable) -> bool:
    """Return whether a host may set a derivative of this variable."""
    return variable.causality == "input" and variable.type == "Real" and variable.variability == "continuous"


def _check(model: ir.Model) -> None:
    """Refuse a model that the runtime cannot run."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", model.name):
        raise NavfmuError(f"component '{model.name}': expected a name of letters, digits and underscores")
    if [e.index for e in model.elements] != list(range(len(model.elements))):
        raise NavfmuError(f"component '{model.name}': the variables are not numbered from 0")
    name, times = Counter(e.name for e in model.elements).most_common(1)[0] if model.elements else ("", 0)
    if times > 1:
        raise NavfmuError(f"component '{model.name}': two variables are named '{name}'")
    if len(clocks(model)) > 64:
        raise NavfmuError(f"component '{model.name}' has {len(clocks(model))} clocks; expected at most 64")
    if any(task.normals for task in model.tasks) and (model.seed is None or model.stream is None):
        raise NavfmuError(f"component '{model.name}' takes noise but has no parameters 'seed' and 'stream'")


def _source(model: ir.Model, guid: str) -> Iterable[str]:
    _check(model)
    ticking = clocks(model)
    yield f"/* The model {model.name}, generated from its equations. */"
    yield '#include "model.h"'
    if model.tables:
        yield '#include "table.h"'
    yield ""
    yield "#include <math.h>"
    yield ""
    yield comment(f"In v lies {_in_vector(model, range(len(model.elements)))}")
    yield ""
    fixed = _fixed(model)
    known = {node: ("fixed", place) for node, place in fixed.items()}
    once = _once(fixed)
    results = [*once, *(value for task in model.tasks for value in task.values), *(c.holds for c in model.checks)]
    if has_arrays(results):
        yield '#include "arrays.h"'
        yield ""
        yield from c_helpers(results)
    functions = [c_function("fixed_values", ["v"], once, others=OTHERS)]
    yield functions[-1].text
    for i, task in enumerate(model.tasks):
        yield comment(f"Task '{task.name}': r is what it assigns, {_in_vector(model, task.targets)}")
        to_know = known if task.kind != "start" else {}
        functions.append(c_function(f"task_{i}", VECTORS, task.values, to_know, others=OTHERS))
        yield functions[-1].text
    for i, check in enumerate(model.checks):
        functions.append(c_function(f"check_{i}", VECTORS, [check.holds], others=OTHERS))
        yield functions[-1].text
    yield from _array(
        "Variable",
        "model_variables",
        (
            f"{{{_text(e.name)}, {_text(v.unit if v.unit not in (None, '1') else '')}, {c_number(e.start)}, "
            f"{c_number(-math.inf if e.min is None else e.min)}, {c_number(math.inf if e.max is None else e.max)}, "
            f"{int(v.causality == 'parameter')}}}"
            for v in model.variables
            for e in v.elements()
        ),
    )
    access = (text for v in model.variables for text in [_access(v)] * v.size)
    texts, text_bytes = [], 0
    for variable in model.variables:
        for text in variable.texts:
            texts.append(f"{{{_text(text)}, {variable.longest}, {text_bytes}}}")
            text_bytes += variable.longest + 1
    yield from _array("Text", "model_texts", texts)
    yield from _array("unsigned short", "model_access", access)
    inputs = continuous_inputs(model)
    yield from _array("int", "model_inputs", inputs)
    slots = {index: slot for slot, index in enumerate(inputs)}
    yield from _array("int", "model_input_slot", (slots.get(i, -1) for i in range(len(model.elements))))
    places = ((c.period, -1 if c.offset is None else c.offset) for c in ticking)
    yield from _array("ClockInfo", "model_clocks", (f"{{{period}, {offset}}}" for period, offset in places))
    for i, task in enumerate(model.tasks):
        yield from _array("int", f"targets_{i}", task.targets)
        yield from _array("int", f"wholes_{i}", _wholes(model, task))
    yield from _array("Task", "model_tasks", (_task(model, i, ticking) for i in range(len(model.tasks))))
    messages = []
    for i, check in enumerate(model.checks):
        message, values = _message(check)
        yield from _array("int", f"values_{i}", values)
        messages.append(f"{{check_{i}, {_text(message)}, values_{i}}}")
    yield from _array("Check", "model_checks", messages)
    for i, table in enumerate(model.tables):
        yield from _array("char *const", f"labels_{i}", map(_text, table.labels))
        yield from _array("int", f"keys_{i}", table.keys)
    yield from _array("TableInfo", "model_tables", (_table(model, i) for i in range(len(model.tables))))

    if model.through:
        yield f"void {model.name}_through(double *v, double *memory, int64_t k);"
        yield ""
        yield from _array("double", "model_memory", map(c_number, model.through.memory))

    def most(values: Iterable[int]) -> int:
        return max(values, default=0)

    fields = {
        "identifier": _text(model.name),
        "guid": _text(guid),
        "variable_count": len(model.elements),
        "access": "model_access",
        "variables": "model_variables",
        "task_count": len(model.tasks),
        "tasks": "model_tasks",
        "check_count": len(model.checks),
        "checks": "model_checks",
        "text_count": len(texts),
        "text_bytes": text_bytes,
        "texts": "model_texts",
        "clock_count": len(ticking),
        "clocks": "model_clocks",
        "table_count": len(model.tables),
        "tables": "model_tables",
        "input_count": len(inputs),
        "inputs": "model_inputs",
        "input_slot": "model_input_slot",
        "work_count": most(one.work for one in functions),
        "fixed_count": len(once),
        "fix": "fixed_values",
        "seed": -1 if model.seed is None else model.seed,
        "stream": -1 if model.stream is None else model.stream,
        "through": f"{model.name}_through" if model.through else 0,
        "direct": int(bool(model.through and model.through.direct)),
        "memory_count": len(model.through.memory) if model.through else 0,
        "memory": "model_memory" if model.through else 0,
        "step": c_number(model.through.step if model.through else 0.0),
        "has_calculated": int(any(v.initial == "calculated" for v in model.variables)),
        "most_normals": most(task.normals for task in model.tasks),
        "most_targets": most([1, *(len(task.targets) for task in model.tasks)]),
    }
    yield "static const Model model = {"
    yield from (f"    .{name} = {value}," for name, value in fields.items())
    yield "};"


def _in_vector(model: ir.Model, places: Iterable[int]) -> str:
    """Return the names of variables, each with its place when they stand one after the other: "x at 0, P at 4"."""
    first: dict[str, int] = {}
    for place, index in enumerate(places):
        first.setdefault(model.elements[index].variable.name, place)
    return ", ".join(f"{name} at {place}" for name, place in first.items()) or "nothing"


def _fixed(model: ir.Model) -> dict[Node, int]:
    """Return the operations of the tasks whose values stand when initialisation has ended, as :func:`settled` does."""
    running = [task for task in model.tasks if task.kind != "start"]
    changing = {index for task in running for index in (*task.targets, task.lost)}
    changing |= {i for v in model.variables if life.State.STEPPING in _settable(v) for i in v.indices}

    def constant(element: Node) -> bool:
        vector, index = element.of
        return vector == "v" and index not in changing

    return settled((value for task in running for value in task.values), constant)


def _once(fixed: dict[Node, int]) -> list[Node]:
    """Return what is calculated once, number by number."""
    found: dict[int, list[Node]] = {}
    for node, place in fixed.items():
        one = [element(node, i) for i in range(node.size)] if isinstance(node, Array) else [node]
        found.setdefault(place, one)
    return [node for place in sorted(found) for node in found[place]]


def _wholes(model: ir.Model, task: ir.Task) -> list[int]:
    """Return which of a task's results are Integers."""
    return [place for place, index in enumerate(task.targets) if model.elements[index].variable.type == "Integer"]


def _task(model: ir.Model, i: int, ticking: list[ir.Clock]) -> str:
    task = model.tasks[i]
    kind = {"start": "ON_START", "every": "ON_CLOCK", "on_new": "ON_NEW"}[task.kind]
    clock = 0 if task.clock is None else ticking.index(task.clock)

    def place(index: int | None) -> int:
        return -1 if index is None else index

    return (
        f"{{{_text(task.name)}, {kind}, task_{i}, {task.normals}, UINT64_C({task.stream}), {clock}, "
        f"{place(task.sequence)}, {place(task.time_of_validity)}, {place(task.lost)}, "
        f"{len(task.targets)}, targets_{i}, {len(_wholes(model, task))}, wholes_{i}}}"
    )


def _table(model: ir.Model, i: int) -> str:
    table = model.tables[i]
    header = _bytes(numbers.header(table.labels, table.is_grid))
    columns = f"{len(table.columns)}, labels_{i}, {len(table.keys)}, keys_{i}"
    text = next((int(v.start[0]) for v in model.variables if v.name == table.named_by), -1)
    return f"{{{_text(table.file)}, {header}, {int(table.is_grid)}, {columns}, {text}}}"


def _access(variable: ir.Variable) -> str:
    """Return the type and the states in which the variable may be set."""
    states = _settable(variable)
    bits = [variable.type.upper(), *(state.name for state in life.State if state in states)]
    if variable.enumeration:
        bits.append("ENUMERATION")
    if variable.causality == "parameter" and life.State.STEPPING in states:
        bits.append("TUNABLE")
    return " | ".join(bits)


def _settable(variable: ir.Variable) -> life.State:
    return life.settable(variable.causality, variable.variability, variable.initial)


def _message(check: ir.Check) -> tuple[str, list[int]]:
    """Return the message with each ``{name}`` replaced by ``{}``, and the indices of the values in their order."""
    known = dict(check.names)
    values = []

    def replace(match: re.Match[str]) -> str:
        if match[1] not in known:
            return match[0]
        values.append(known[match[1]])
        return "{}"

    return re.sub(r"\{([^{}]+)\}", replace, check.message), values


def _array(kind: str, name: str, items: Iterable[object]) -> Iterable[str]:
    """Yield the definition of a constant array; C has none of length 0, so an empty one gets one zero element."""
    lines = [f"{item}," for item in items]
    if kind in ("int", "double"):
        lines = textwrap.wrap(" ".join(lines), WIDTH - 4, break_long_words=False, break_on_hyphens=False)
    lines = [f"    {line}" for line in lines]
    yield f"static const {kind} {name}[] = {{"
    yield from lines or ["    {0},"] if kind[0].isupper() else lines or ["    0,"]
    yield "};"
    yield ""


def _text(text: str) -> str:
    """Return a C string of the text in UTF-8."""
    if text.isascii():
        return json.dumps(text).replace("\\u007f", "\\177").replace("?", "\\?")  # ??/ is a \\ in C99
    return _bytes(text.encode())


def _bytes(data: bytes) -> str:
    return '"' + "".join(chr(b) if 32 <= b < 127 and b not in b'"\\?' else f"\\{b:03o}" for b in data) + '"'
