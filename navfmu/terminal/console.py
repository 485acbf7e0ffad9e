"""Standard output for tables and sentences."""

from __future__ import annotations

import os
import re

from rich.console import Console
from rich.text import Text

from navfmu.errors import visible

FILE_WIDTH = 160  # columns where nobody says how many there are: a file, a pipe


def console() -> Console:
    """Standard output, as wide as the terminal or the environment variable COLUMNS says, else ``FILE_WIDTH``."""
    out = Console(highlight=False)
    return out if out.is_terminal or _columns() else Console(highlight=False, width=FILE_WIDTH)


def say(out: Console, text: str | Text, indent: int = 0, hang: int = 0) -> None:
    """A sentence, wrapped between words; in a file it stays one line, so that it can be searched for.

    All lines are moved in by ``indent``, those after the first by ``hang`` more. Paths
    are printed with ``soft_wrap`` instead: what is to be copied has no breaks.
    """
    line = one_line(text)
    content = line if isinstance(line, Text) else Text(line)
    if not (out.is_terminal or _columns()):
        out.print(Text(" " * indent) + content, soft_wrap=True)
        return
    room = max(out.width - indent, 1)
    first, *rest = content.wrap(out, room) if content else [content]
    if rest and hang:
        tail = content[len(first) :]
        tail = tail[len(tail) - len(tail.plain.lstrip()) :]
        rest = tail.wrap(out, max(room - hang, 1))
    for number, line in enumerate([first, *rest]):
        line.rstrip()
        out.print(Text(" " * (indent + (hang if number else 0))) + line, no_wrap=True)


def one_line(text: str | Text) -> str | Text:
    """The same in one line, with control characters made visible; styles are lost where there are any."""
    plain = text.plain if isinstance(text, Text) else text
    return text if plain.isprintable() else visible(re.sub(r"\s*\n\s*", " ", plain))


def _columns() -> bool:
    return os.environ.get("COLUMNS", "").isdigit()
