"""Reads TOML files and knows on which line each of their entries stands."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.files.reading import read_bytes

MAX_BYTES = 10_000_000  # nobody writes more by hand

Place = tuple[str | int, ...]  # ("case", 0, "faults"): keys, and numbers of elements counted from 0


class Document:
    """A TOML file: its content, and sentences with file and line about places in it.

    document = Document.read("campaign.toml", "campaign file")
    document.content["case"][0]["name"]
    raise document.error("there are two cases of that name", "case", 0, "name")   # campaign.toml, line 7: there are ...
    """

    def __init__(self, text: str, name: str) -> None:
        """Parse ``text``; ``name`` is the file's name in messages."""
        self.name = name
        try:
            self.content: dict[str, Any] = tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            raise NavfmuError(f"{name}{_sentence(error)}") from None
        self._lines = dict(reversed(list(_places(text))))  # the first line of a place counts

    @classmethod
    def read(cls, path: str | Path, kind: str = "TOML file", name: str = "") -> Document:
        """Read a file; ``kind`` ("campaign file") says in messages what it was expected to be, ``name`` what it is."""
        return cls(read_text(path, kind, name), name or str(path))

    def line(self, *place: str | int) -> int:
        """The line on which the entry at a place is written; an entry that is not there has the line of its table."""
        while place and place not in self._lines:
            place = place[:-1]
        return self._lines.get(place, 1)

    def error(self, sentence: str, *place: str | int) -> NavfmuError:
        """A sentence with file and, where a place is given, line."""
        return NavfmuError(f"{self.where(*place)}: {sentence}")

    def where(self, *place: str | int) -> str:
        """Name and line: "campaign.toml, line 7"."""
        return f"{self.name}, line {self.line(*place)}" if place else self.name


def read_text(path: str | Path, kind: str, name: str = "") -> str:
    """The text of a file of bounded size; ``kind`` says in messages what it was expected to be, ``name`` what it is."""
    try:
        return read_bytes(path, f"a {kind}", MAX_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise NavfmuError(f"{name or path}: the {kind} cannot be read: it is not text in UTF-8") from None


_KEY = re.compile(r"'([^']*)'")
_KEYS = re.compile(r"\(('[^']*'(, )?)+,?\)")  # as the parser names them: ('table', 'sub')


def _sentence(error: Exception) -> str:
    """The parser's message, its place first: ", line 3, column 9: invalid value"."""
    if isinstance(error, RecursionError):
        return ": is nested too deeply"
    found = re.fullmatch(r"(.*) \(at (.*)\)", str(error), re.DOTALL)
    sentence, place = found.groups() if found else (str(error), "")
    sentence = _KEYS.sub(lambda keys: f"'{'.'.join(_KEY.findall(keys[0]))}'", sentence)
    return f"{', ' if place else ''}{place}: {sentence[:1].lower()}{sentence[1:]}"


# ---- lines -----------------------------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"""(?P<space>[ \t\r]+|\#[^\n]*)
      | (?P<text>\"{3}(?:\\.|[^\\])*?\"{3,5} | '{3}.*?'{3,5} | "(?:\\.|[^"\\])*" | '[^']*')
      | (?P<mark>[\[\]{}=.,\n])
      | (?P<word>[^\s\[\]{}=.,\#"']+)""",
    re.VERBOSE | re.DOTALL,
)


class _Tokens:
    """The tokens of a text that is known to be TOML, each with its line."""

    def __init__(self, text: str) -> None:
        self.found: list[tuple[str, int]] = []
        line = 1
        for match in _TOKEN.finditer(text):
            if match.lastgroup != "space":
                self.found.append((match[0], line))
            line += match[0].count("\n")
        self.found.append(("", line))
        self.at = 0

    @property
    def next(self) -> str:
        return self.found[self.at][0]

    @property
    def line(self) -> int:
        return self.found[self.at][1]

    def take(self) -> str:
        self.at += 1
        return self.found[self.at - 1][0]

    def skip(self, *tokens: str) -> None:
        while self.next in tokens and self.next:
            self.at += 1


def _places(text: str) -> Iterator[tuple[Place, int]]:
    """Every place of a TOML text, with its line, in the order of the text."""
    tokens, table, tables = _Tokens(text), (), {}
    while True:
        tokens.skip("\n")
        if not tokens.next:
            return
        if tokens.next != "[":
            yield from _entry(tokens, table)
            continue
        line = tokens.line
        tokens.take()
        many = tokens.next == "["
        tokens.skip("[")
        table = ()
        for key in (keys := _key(tokens))[:-1]:
            table = _newest((*table, key), tables)
        table = (*table, keys[-1])
        yield table, line
        if many:
            tables[table] = tables.get(table, -1) + 1
            table = _newest(table, tables)
            yield table, line
        tokens.skip("]")


def _newest(table: Place, tables: dict[Place, int]) -> Place:
    """A table, or the newest element of an array of tables."""
    return (*table, tables[table]) if table in tables else table


def _key(tokens: _Tokens) -> list[str]:
    """A key with dots, as its parts; the token after it comes next."""
    parts = []
    while tokens.next not in ("=", "]"):
        part = tokens.take()
        if part != ".":
            parts.append(next(iter(tomllib.loads(f"{part} = 0"))) if part[0] in "\"'" else part)
    return parts


def _entry(tokens: _Tokens, table: Place) -> Iterator[tuple[Place, int]]:
    """``key = value``, and what is inside the value."""
    line = tokens.line
    for part in _key(tokens):
        table = (*table, part)
        yield table, line
    tokens.take()
    yield from _value(tokens, table)


def _value(tokens: _Tokens, place: Place) -> Iterator[tuple[Place, int]]:
    if tokens.next == "[":
        tokens.take()
        number = 0
        while True:
            tokens.skip("\n", ",")
            if tokens.next == "]":
                break
            yield (*place, number), tokens.line
            yield from _value(tokens, (*place, number))
            number += 1
        tokens.take()
    elif tokens.next == "{":
        tokens.take()
        while True:
            tokens.skip("\n", ",")
            if tokens.next == "}":
                break
            yield from _entry(tokens, place)
        tokens.take()
    else:
        while tokens.next not in (",", "]", "}", "\n", ""):
            tokens.take()
