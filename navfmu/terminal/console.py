"""Standard output for tables and sentences."""

from __future__ import annotations

import os
import re

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from navfmu.errors import visible

FILE_WIDTH = 160  # columns where nobody says how many there are: a file, a pipe


def console() -> Console:
    """Standard output, as wide as the terminal or the environment variable COLUMNS says, else ``FILE_WIDTH``."""
    out = Console(highlight=False)
    return out if out.is_terminal or _columns() else Console(highlight=False, width=FILE_WIDTH)


def say(out: Console, text: str | Text, indent: int = 0, hang: int = 0) -> None:
    """A sentence, wrapped between words, none of which is broken; in a file it stays one line, to be searched for.

    All lines are moved in by ``indent``, those after the first by ``hang`` more. Paths
    are printed with ``soft_wrap`` instead: what is to be copied has no breaks.
    """
    line = one_line(text)
    content = line if isinstance(line, Text) else Text(line)
    if not (out.is_terminal or _columns()):
        out.print(Text(" " * indent) + content, soft_wrap=True)
        return
    for number, line in enumerate(content.divide(_breaks(content.plain, out.width - indent, hang))):
        line.rstrip()
        out.print(Text(" " * (indent + (hang if number else 0))) + line, soft_wrap=True)


def _breaks(text: str, width: int, hang: int) -> list[int]:
    """Where new lines begin; all but the first are shorter by ``hang``. A word that is too long stays whole."""
    found, column = [], 0
    for word in re.finditer(r"\s*(\S+)", text):
        if column and column + cell_len(word[0]) > width:
            found.append(word.start(1))
            column = hang + cell_len(word[1])
        else:
            column += cell_len(word[0])
    return found


def one_line(text: str | Text) -> str | Text:
    """The same in one line, with control characters made visible; styles are lost where there are any."""
    plain = text.plain if isinstance(text, Text) else text
    return text if plain.isprintable() else visible(re.sub(r"\s*\n\s*", " ", plain))


def _columns() -> bool:
    return os.environ.get("COLUMNS", "").isdigit()
