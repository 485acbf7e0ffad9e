"""Rows of a plan as C: what the master would read, a saboteur has inside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from navfmu.export.graph import c_number


def header(constants: Mapping[str, object], arrays: Mapping[tuple[str, str], Iterable[str]]) -> str:
    """``tables.h``: names for the preprocessor, and arrays by their type and name."""
    lines = ["/* What this saboteur does: rows of the plan of the compiled master. */"]
    lines += [f"#define {name} {value}" for name, value in constants.items()]
    for (kind, name), items in arrays.items():
        lines += ["", f"static const {kind} {name}[] = {{", *(f"    {item}," for item in items), "};"]
    return "\n".join(lines) + "\n"


def row(values: np.void) -> str:
    """A row as a C initialiser; what is 0 is left out, the fields have their names in C."""
    fields = [f".{name} = {_number(values[name])}" for name in values.dtype.names if _is_there(values[name])]
    return f"{{{', '.join(fields) or '0'}}}"


def _is_there(value: np.generic) -> bool:
    return any(map(_is_there, value)) if isinstance(value, np.void) else value.tobytes() != bytes(value.nbytes)


def _number(value: np.generic) -> str:
    if isinstance(value, np.void):
        return row(value)
    if isinstance(value, np.floating):
        return c_number(float(value))
    return f"{'U' if value.dtype.kind == 'u' else ''}INT64_C({int(value)})"
