"""Docstrings as the text of a page: paragraphs, lists and blocks, with names in backticks and *stressed* words."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from typing import Any, NamedTuple


class Piece(NamedTuple):
    """A run of words in one style."""

    tag: str  # "code", "em", or "" for plain words
    text: str


class Block(NamedTuple):
    """A paragraph and the like."""

    kind: str  # "paragraph", "list", "terms" or "verbatim"
    content: Any  # pieces; a list of pieces; a list of (name, pieces); text


def blocks(text: str) -> Iterable[Block]:
    """Yield the paragraphs, the lists of lines that begin with "- ", and the indented blocks of a docstring."""
    for block in re.split(r"\n\s*\n", text.strip("\n")):
        lines = block.splitlines()
        if not block.strip():
            continue
        if all(line.startswith("  ") for line in lines):
            yield Block("verbatim", inspect.cleandoc(block))
        elif all(re.match(r"\S+( \S+)? {2,}\S|\s{4}", line) for line in lines):  # name, blanks, meaning
            terms = (re.split(r" {2,}", item, maxsplit=1) for item in re.split(r"\n(?=\S)", block))
            yield Block("terms", [(name, pieces(meaning)) for name, meaning in terms])
        elif lines[0].lstrip().startswith(("- ", "* ")):
            items = re.split(r"^\s*[-*] ", block, flags=re.M)[1:]
            yield Block("list", [pieces(item) for item in items])
        else:
            yield Block("paragraph", pieces(block))


def pieces(text: str) -> list[Piece]:
    """Split a sentence at its `names` and *stressed* words."""
    found: list[Piece] = []
    for i, part in enumerate(re.split(r"`{1,2}([^`]+)`{1,2}", " ".join(text.split()))):
        if i % 2:
            found.append(Piece("code", part))
        else:
            words = re.split(r"(?<![\w*])\*(\S[^*]*?[\w.])\*(?![\w*])", part)
            found += [Piece("em" if k % 2 else "", word) for k, word in enumerate(words)]
    return [piece for piece in found if piece.text]
