"""Figures of a source beside our own: what is printed, what we find, and whether the two agree."""

from navfmu.figures.comparison import Comparison, Difference
from navfmu.figures.row import Found, Row, row
from navfmu.figures.task import Task

__all__ = ["Comparison", "Difference", "Found", "Row", "Task", "row"]
