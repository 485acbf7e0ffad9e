"""Characters that no XML document can hold, not even escaped: most control characters, halves of characters."""

from __future__ import annotations

import re

_ILLEGAL = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def illegal(text: str) -> str:
    """The first of them in a text, as one writes it in Python: "\\x01"; empty if there is none."""
    found = _ILLEGAL.search(text)
    return repr(found[0])[1:-1] if found else ""


def shown(text: str) -> str:
    """The text with all of them as one writes them in Python."""
    return _ILLEGAL.sub(lambda found: repr(found[0])[1:-1], text)
