"""A row of a table of figures: a function that finds ours, and what it says of the source."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from navfmu.errors import NavfmuError
from navfmu.figures.comparison import Comparison
from navfmu.figures.task import Task

_PARTS = re.compile(r"([A-Z][A-Z_]*)(\d*)([A-Z]*)")


@dataclass(frozen=True)
class Found:
    """What a row has found: its figures beside the printed ones, a picture as PNG, and what the picture shows.

    ``notes`` are sentences on the source, such as misprints that were corrected.
    """

    comparisons: Sequence[Comparison]
    picture: bytes
    words: str
    notes: Sequence[str] = ()

    def __post_init__(self) -> None:
        if not self.comparisons:
            raise NavfmuError("a row has found nothing to compare; expected one comparison at least")


@dataclass(frozen=True)
class Row:
    """``claim`` is what the source says, in a sentence, ``source`` where: page, section, equation, figure.

    ``fmus`` are the built FMUs that it needs, by name.
    """

    name: str
    claim: str
    source: str
    fmus: tuple[str, ...]
    find: Callable[[Task], Found]

    @property
    def order(self) -> tuple[str, int, str]:
        """T9 before T10, T10a before T10b."""
        letters, number, rest = _PARTS.fullmatch(self.name).groups()
        return letters, int(number or 0), rest


def row(claim: str, source: str, *, fmus: Sequence[str] = ()) -> Callable[[Callable[[Task], Found]], Row]:
    """Make a row of a function, whose name it has: ``t31`` is the row T31."""

    def made(find: Callable[[Task], Found]) -> Row:
        name = find.__name__.upper()
        if not _PARTS.fullmatch(name):
            raise NavfmuError(f"'{find.__name__}' is no name of a row; expected letters and a number, such as t31")
        return Row(name, claim, source, tuple(fmus), find)

    return made
