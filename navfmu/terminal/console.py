"""Standard output for tables."""

from __future__ import annotations

from rich.console import Console


def console() -> Console:
    """Standard output; wide when it is not a terminal, so that nothing is cut off in a file."""
    out = Console(highlight=False)
    return out if out.is_terminal else Console(highlight=False, width=160)
