"""Where the model's code is, and what a text may hold that goes into an FMU."""

from __future__ import annotations

from navfmu.errors import NavfmuError
from navfmu.files.characters import illegal
from navfmu.place import is_foreign, place

__all__ = ["check_text", "is_foreign", "place"]


def check_text(where: str, what: str, text: str) -> None:
    """Refuse a text that the description of an FMU and its C code cannot hold; ``where`` is its file and line."""
    if not isinstance(text, str):
        raise NavfmuError(f"{where}: {what}: {text!r} is no text")
    wrong = illegal(text) or next((repr(c)[1:-1] for c in text if "\x7f" <= c <= "\x9f"), "")
    if wrong:
        raise NavfmuError(f"{where}: {what}: the text has the character {wrong}; expected no control characters")
