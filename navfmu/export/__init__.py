"""Exporter: a component declared in plain NumPy becomes a native FMU, and its PythonFMU twin."""

from navfmu.export.declaration import (
    Bundle,
    Component,
    Example,
    Input,
    Output,
    Parameter,
    State,
    Table,
    every,
    on_new,
    require,
    start,
)

__all__ = [
    "Bundle",
    "Component",
    "Example",
    "Input",
    "Output",
    "Parameter",
    "State",
    "Table",
    "every",
    "on_new",
    "require",
    "start",
]
