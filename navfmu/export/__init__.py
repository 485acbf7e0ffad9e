"""Exporter: a component declared in plain NumPy becomes a native FMU, and its PythonFMU twin."""

from navfmu.export.declaration.bundle import Bundle
from navfmu.export.declaration.component import Component
from navfmu.export.declaration.example import Example
from navfmu.export.declaration.grid import Grid
from navfmu.export.declaration.parameter_set import ParameterSet
from navfmu.export.declaration.requirement import require
from navfmu.export.declaration.table import Table
from navfmu.export.declaration.task import every, on_new, start
from navfmu.export.declaration.variable import Input, Output, Parameter, State

__all__ = [
    "Bundle",
    "Component",
    "Example",
    "Grid",
    "Input",
    "Output",
    "Parameter",
    "ParameterSet",
    "State",
    "Table",
    "every",
    "on_new",
    "require",
    "start",
]
