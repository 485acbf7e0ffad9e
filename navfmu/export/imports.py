"""What a module imports, read from its source."""

from __future__ import annotations

import ast
import sys
from functools import cache


@cache
def imports(module: str, text: str) -> tuple[str, ...]:
    """Return the names that the source ``text`` of an imported module imports, in order.

    ``from a import b`` gives ``a`` and ``a.b``: which of them are modules, ``sys.modules`` knows.
    """
    package = module if hasattr(sys.modules.get(module), "__path__") else module.rpartition(".")[0]
    found: list[str] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".") if node.level else []
            base = ".".join([*parts[: len(parts) + 1 - node.level], *([node.module] if node.module else [])])
            found += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return tuple(dict.fromkeys(found))
