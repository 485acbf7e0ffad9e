"""The equations of a component: the project's own functions that its tasks call, with their source."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from types import FunctionType, ModuleType
from typing import Any

from navfmu.export.record import ir


@dataclass(frozen=True)
class Equation:
    """One function of a model."""

    name: str  # "module.function"
    signature: str
    text: str  # its docstring
    code: str  # its source without the docstring


def equations(component: type, model: ir.Model) -> Iterable[Equation]:
    """Yield the functions that a component's tasks call, and those that these call, each once."""
    seen: dict[str, FunctionType] = {}
    module = sys.modules.get(component.__module__)
    waiting = [(task.get("source", ""), module) for task in model.documentation.get("tasks", ())]
    while waiting:
        source, module = waiting.pop(0)
        for function in _called(source, module):
            name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
            if name not in seen:
                seen[name] = function
                waiting.append((inspect.getsource(function), sys.modules[function.__module__]))
    for name, function in seen.items():
        yield Equation(name, str(inspect.signature(function)), *_split(inspect.getsource(function)))


def _called(source: str, module: ModuleType | None) -> Iterable[FunctionType]:
    """Yield the project's own functions that a piece of source calls as ``module.name(...)`` or ``name(...)``."""
    for node in ast.walk(ast.parse(inspect.cleandoc("\n" + source))):
        if not isinstance(node, ast.Call):
            continue
        found: Any = None
        if isinstance(node.func, ast.Name):
            found = getattr(module, node.func.id, None)
        elif isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
            found = getattr(getattr(module, node.func.value.id, None), node.func.attr, None)
        if isinstance(found, FunctionType) and not found.__module__.startswith(("navfmu", "numpy")):
            yield found


def _split(source: str) -> tuple[str, str]:
    """Split the source of a function into its docstring and its code without that."""
    source = inspect.cleandoc("\n" + source)
    node = ast.parse(source).body[0]
    text = ast.get_docstring(node) or ""
    lines = source.splitlines()
    if text and isinstance(node, ast.FunctionDef):
        first = node.body[0]
        del lines[first.lineno - 1 : first.end_lineno]
    return text, "\n".join(lines)
