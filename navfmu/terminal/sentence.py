"""Sentences on the standard error stream, without what tables need: help and refusals stay quick."""

from __future__ import annotations

import sys


def tell(sentence: str) -> None:
    """Print a sentence; a terminal gets it in lines that break between words, a file in one."""
    if sys.stderr.isatty():
        import shutil
        import textwrap

        width = shutil.get_terminal_size().columns
        whole = {"break_long_words": False, "break_on_hyphens": False}
        sentence = "\n".join(textwrap.fill(line, width, **whole) for line in sentence.split("\n"))
    print(sentence, file=sys.stderr, flush=True)
