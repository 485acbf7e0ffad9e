"""Tables that are whole at every width: names may fold and sentences wrap, numbers are never cut.

What does not fit side by side goes below: first the sentence at the end of a row, under its row; then columns, in a
further block that repeats the names; in a very narrow terminal every value gets a line of its own.
"""

from __future__ import annotations

import itertools
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum, auto

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions
from rich.text import Text

from navfmu.terminal.console import one_line

GAP = 2  # spaces between columns
SENTENCE = 24  # the least that a sentence needs beside the other columns
UNBROKEN = 8  # longer headings wrap
INDENT = 4  # of what stands under its row


class Kind(Enum):
    """What a column holds."""

    NAME = auto()  # folds after its dots and underscores
    WORD = auto()  # whole, to the left
    NUMBER = auto()  # whole, to the right
    SENTENCE = auto()  # wraps between words; the last column only


@dataclass(frozen=True)
class Column:
    """A heading, which may wrap between its words, and what stands below it."""

    heading: str
    kind: Kind = Kind.NUMBER


class Table:
    """A table that rich can print. Cells are text without markup, or styled ``Text`` where nothing folds.

    The first ``keys`` columns are repeated in further blocks; by default those are the names that a row begins with.
    """

    def __init__(
        self, columns: Sequence[Column], rows: Iterable[Sequence[str | Text]], title: str = "", keys: int | None = None
    ) -> None:
        self.columns = list(columns)
        self.rows = [[one_line(cell) for cell in row] for row in rows]
        self.title = title
        names = itertools.takewhile(lambda column: column.kind is Kind.NAME, self.columns)
        self.keys = sum(1 for _ in names) if keys is None else keys

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        return iter(self.lines(options.max_width))

    def fits(self, width: int) -> bool:
        """Whether all columns find room side by side."""
        return self._widths(width, list(range(len(self.columns)))) is not None

    def lines(self, width: int) -> list[Text]:
        """The table in lines of at most ``width`` characters."""
        title = [Text(line, style="italic") for line in textwrap.wrap(self.title, width)]
        return title + self._body(width)

    def _body(self, width: int) -> list[Text]:
        last = len(self.columns) - 1
        sentence = last if self.columns[last].kind is Kind.SENTENCE else None
        folding = (Kind.NAME,) if sentence is None else (Kind.SENTENCE,)
        beside = self._widths(width, list(range(len(self.columns))), folding)
        if beside:
            return self._side_by_side(beside)
        rest = [i for i in range(len(self.columns)) if i != sentence]
        below = self._widths(width, rest)
        if below:
            return self._side_by_side(below, sentence, width)
        lines: list[Text] = []
        for block in self._blocks(width, rest) or []:
            lines += self._side_by_side(self._widths(width, block), None if lines else sentence, width)
        return lines or self._records(width)

    def _widths(
        self, width: int, chosen: list[int], folding: Sequence[Kind] = (Kind.SENTENCE, Kind.NAME)
    ) -> dict[int, int] | None:
        """Widths of the chosen columns by their numbers, folded as far as needed; None if they do not fit."""
        widths = {i: self._natural(i) for i in chosen}
        least = {i: self._least(i) for i in chosen}
        excess = sum(widths.values()) + GAP * (len(chosen) - 1) - width
        for kind in folding:
            while excess > 0:
                give = [i for i in chosen if self.columns[i].kind is kind and widths[i] > least[i]]
                if not give:
                    break
                widest = max(give, key=widths.__getitem__)
                widths[widest] -= 1
                excess -= 1
        for i in chosen:
            if self.columns[i].kind is Kind.NAME and widths[i] < self._natural(i):  # no wider than what is folded
                lines = (len(line) for row in self.rows for line in _folded(str(row[i]), widths[i]))
                widths[i] = max([*lines, len(self.columns[i].heading)])
        return widths if excess <= 0 else None

    def _natural(self, i: int) -> int:
        heading = self.columns[i].heading
        words = [heading] if len(heading) <= UNBROKEN else heading.split()
        return max(cell_len(str(text)) for text in ["", *words, *(row[i] for row in self.rows)])

    def _least(self, i: int) -> int:
        natural, kind = self._natural(i), self.columns[i].kind
        if kind is Kind.SENTENCE:
            words = [cell_len(word) for row in self.rows for word in str(row[i]).split()]
            return min(natural, max([SENTENCE, *words]))
        if kind is Kind.NAME:
            parts = [len(part) + 1 for row in self.rows for part in _parts(str(row[i]))]
            return min(natural, max([*parts, len(self.columns[i].heading)]))
        return natural

    def _blocks(self, width: int, chosen: list[int]) -> list[list[int]] | None:
        """Groups of columns that fit, each with the keys; None if a column does not fit beside them."""
        keys = list(range(self.keys))
        blocks = [keys]
        for i in chosen[self.keys :]:
            if self._widths(width, [*blocks[-1], i]) is None:
                blocks.append(keys)
            if self._widths(width, [*blocks[-1], i]) is None:
                return None
            blocks[-1] = [*blocks[-1], i]
        return blocks if len(blocks[0]) > self.keys else None

    def _side_by_side(self, widths: dict[int, int], sentence: int | None = None, width: int = 0) -> list[Text]:
        headings = {i: textwrap.wrap(self.columns[i].heading, size) or [""] for i, size in widths.items()}
        lines = self._row(headings, widths, "dim") if any(self.columns[i].heading for i in widths) else []
        for row in self.rows:
            cells = {i: self._cell(row[i], i, size) for i, size in widths.items()}
            lines += self._row(cells, widths)
            if sentence is not None:
                wrapped = textwrap.wrap(str(row[sentence]), max(width - INDENT, 1), break_on_hyphens=False)
                lines += [Text(" " * INDENT + line, style="dim") for line in wrapped]
        return lines

    def _cell(self, cell: str | Text, i: int, size: int) -> Sequence[str | Text]:
        kind = self.columns[i].kind
        if kind is Kind.NAME:
            return _folded(str(cell), size)
        if kind is Kind.SENTENCE:
            return textwrap.wrap(str(cell), size, break_on_hyphens=False) or [""]
        return [cell]

    def _row(self, cells: dict[int, Sequence[str | Text]], widths: dict[int, int], style: str = "") -> list[Text]:
        lines = []
        for number in range(max(map(len, cells.values()))):
            line = Text(style=style, no_wrap=True, overflow="ignore")
            for place, (i, size) in enumerate(widths.items()):
                cell = cells[i][number] if number < len(cells[i]) else ""
                space = " " * (size - cell_len(str(cell)))
                line.append(" " * GAP if place else "")
                right = self.columns[i].kind is Kind.NUMBER
                for part in (space, cell) if right else (cell, space):
                    line.append_text(part) if isinstance(part, Text) else line.append(part)
            line.rstrip()
            lines.append(line)
        return lines

    def _records(self, width: int) -> list[Text]:
        """Every value on a line of its own, under the first of its row."""
        lines = []
        for row in self.rows:
            lines += _folded(str(row[0]), width)
            for column, cell in zip(self.columns[1:], row[1:], strict=True):
                text = f"{column.heading} {cell}" if str(cell) else ""
                lines += textwrap.wrap(text, width, initial_indent="  ", subsequent_indent="  ", break_on_hyphens=False)
        return [Text(line, no_wrap=True, overflow="ignore") for line in lines]


def _parts(name: str) -> list[str]:
    """Where a name may be folded: "navigator.", "solution.", "velocity_", "n[1]"."""
    return [part for part in re.split(r"(?<=[._/ ,])", name) if part]


def _folded(name: str, size: int) -> list[str]:
    """A name in lines; those after the first are moved in by one."""
    lines = [""]
    for part in _parts(name):
        if lines[-1].strip() and len(lines[-1]) + len(part.rstrip()) > size:
            lines.append(" ")
        lines[-1] += part
    return [line.rstrip() for line in lines]
