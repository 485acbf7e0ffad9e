"""The lines of the analysis, as they stand in a file beside the system."""

from __future__ import annotations

from pathlib import Path

from navfmu.files.schema import Field, Table, Texts, validated
from navfmu.files.toml import Document


class Line(Table):
    """One kind of failure."""

    number: str = Field(pattern=r"^F\d+$", description="its number, that 'fmea' of faults names")
    failure: str = Field(min_length=1, description="what fails, in words")
    cases: Texts = Field([], description="cases that belong to it, beside those in which a fault names it")
    lacking: str = Field("", description="what of it cannot be injected yet, and why")


class Lines(Table):
    """The file."""

    references: Texts = Field(description="cases without a failure of their own, with which the others are compared")
    line: list[Line] = Field(min_length=1, description="the lines, in the order of the table")


def load_lines(path: Path) -> Lines:
    """The lines of a file."""
    return validated(Document.read(path, "file of the lines of an analysis"), Lines)
