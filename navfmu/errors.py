"""The one error this project raises on purpose: a sentence for the user."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

LENGTH = 500  # characters that are quoted of a message


class NavfmuError(Exception):
    """A problem that the user can mend, told in a sentence.

    The sentence names what was wrong, where (file, element, line) and what was expected. The command line prints it
    without a traceback and exits with code 2. ``details`` are lines of another tool that belong below the sentence.
    """

    exit_code = 2

    def __init__(self, sentence: object = "", details: str = "") -> None:
        super().__init__(visible(str(sentence)) + (f"\n{details}" if details else ""))


class Interrupted(NavfmuError):
    """The user stopped it."""

    exit_code = 130  # as shells have it for Ctrl-C


class NavfmuWarning(UserWarning):
    """A note about a run that the user should see: a cut cycle, a warning of an FMU, something without effect."""


def visible(text: str) -> str:
    """The text in one line that does nothing to a terminal: control characters as one writes them in Python."""
    if text.isprintable():
        return text
    import unicodedata

    hidden = ("Cc", "Cf", "Cs", "Zl", "Zp")  # controls, marks of direction, halves of characters, ends of lines
    return "".join(repr(c)[1:-1] if unicodedata.category(c) in hidden else c for c in text)


def quoted(text: str, more: int = 0) -> str:
    """What an FMU or another program has said: visible, and at most ``LENGTH`` characters of it.

    ``more`` characters are cut off already.
    """
    text = text.strip()
    more += max(len(text) - LENGTH, 0)
    return visible(text[:LENGTH]) + (f"... {more} more characters" if more else "")


def nearest(name: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the known name nearest to ``name``, or an empty string."""
    match = difflib.get_close_matches(str(name), list(known), n=1, cutoff=0.5)
    return f"; did you mean '{match[0]}'?" if match else ""


def check_progress(given: object) -> None:
    """Refuse what is to be called with progress and cannot be; None is not called."""
    if given is not None and not callable(given):
        raise NavfmuError(f"progress is {given!r}, expected a function that is called with what is done and all of it")
