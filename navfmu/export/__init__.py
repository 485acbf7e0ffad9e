"""Exporter: a component declared in plain NumPy becomes a native FMU, and its PythonFMU twin."""

from navfmu.export.bundle import Bundle
from navfmu.export.component import Component
from navfmu.export.example import Example
from navfmu.export.grid import Grid
from navfmu.export.requirement import require
from navfmu.export.table import Table
from navfmu.export.task import every, on_new, start
from navfmu.export.variable import Input, Output, Parameter, State

__all__ = [
    "Bundle",
    "Component",
    "Example",
    "Grid",
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
