"""Lines of a text file, however it is packed, with sentences that say which line is wrong."""

from __future__ import annotations

import codecs
import io
import re
from datetime import date
from pathlib import Path

from navfmu.errors import NavfmuError, quoted
from navfmu.satellite.packed import unpacked

BOM = codecs.BOM_UTF8
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([EeDd][+-]?\d+)?")
CENTURY = 80  # years of two digits from here on are 19..


class Lines:
    """Lines of a file, counted from 1; ``expected`` ("a YUMA almanac") goes into the sentence if it is none.

    ``remarks`` say what may be wrong with it.
    """

    def __init__(self, path: str | Path, expected: str) -> None:
        self.path, self.expected = Path(path), expected
        text = unpacked(self.path, expected).removeprefix(BOM).decode("latin1")
        self.text = io.StringIO(text, newline=None).read().split("\n")
        if not self.text[-1]:
            del self.text[-1]
        self.remarks = [] if text.endswith(("\n", "\r")) else ["the last line does not end: the file may be cut off"]

    def __len__(self) -> int:
        return len(self.text)

    def wrong(self, at: int, what: str) -> NavfmuError:
        """The sentence for what is wrong in a line."""
        return NavfmuError(f"{self.path}, line {at}: {what}")

    def line(self, at: int, what: str) -> str:
        """A line in which ``what`` is expected."""
        if at > len(self.text):
            raise NavfmuError(f"{self.path}: ends after {len(self.text)} lines; expected {what}, the file is cut off")
        return self.text[at - 1]

    def number(self, at: int, text: str, what: str) -> float:
        """A number as Fortran writes it, too: 1.5D-03."""
        text = text.strip()
        if not NUMBER.fullmatch(text):
            raise self.wrong(at, f"{what} is '{quoted(text)}'; expected a number" if text else f"{what} is missing")
        value = float(text.replace("D", "E").replace("d", "e"))
        if abs(value) == float("inf"):
            raise self.wrong(at, f"{what} is {text}; expected a number that a computer has")
        return value

    def whole(self, at: int, text: str, what: str) -> int:
        """A whole number of at most nine digits."""
        value = self.number(at, text, what)
        if value != int(value) or abs(value) >= 1e9:
            raise self.wrong(at, f"{what} is {quoted(text)}; expected a whole number")
        return int(value)

    def instant(self, at: int, fields: list[str]) -> tuple[date, float]:
        """A date and the seconds of the day: year, month, day, hour, minute, second."""
        parts = ("the year", "the month", "the day", "the hour", "the minute")
        fields = [*fields, *[""] * 6]  # what is missing is told
        year, month, day, hour, minute = (self.whole(at, text, what) for text, what in zip(fields, parts, strict=False))
        second = self.number(at, fields[5], "the second")
        if len(fields[0].strip()) <= 2:
            year += 1900 if year >= CENTURY else 2000
        try:
            found = date(year, month, day)
        except ValueError:
            raise self.wrong(at, f"{year}-{month}-{day} is no date") from None
        if not (0 <= hour < 24 and 0 <= minute < 60 and 0.0 <= second < 60.0):
            raise self.wrong(at, f"{hour}:{minute}:{second:g} is no time of day")
        if found.year < 1980 or (found - date(1980, 1, 6)).days < 0:
            raise self.wrong(at, f"{found} is before GPS time begins, 1980-01-06")
        return found, hour * 3600.0 + minute * 60.0 + second
