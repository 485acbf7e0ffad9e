"""Self-contained HTML pages: text, tables and embedded pictures in one file that opens offline and prints well."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from navfmu.report.template import fill

_TEMPLATE = Path(__file__).parent / "templates" / "page.html.j2"
_MANY = 9  # columns from which a table is set in small type
_WORD = 20  # letters up to which a word stays whole


class Page:
    """A page under construction, read from top to bottom."""

    def __init__(self, title: str, lead: str = "") -> None:
        self._title = title
        self._lead = lead
        self._parts: list[dict[str, Any]] = []

    def heading(self, text: str) -> None:
        """A section."""
        self._add("heading", text=text)

    def text(self, text: str) -> None:
        """A paragraph."""
        self._add("text", text=text)

    def items(self, lines: Iterable[str]) -> None:
        """A list."""
        self._add("items", lines=list(lines))

    def code(self, text: str) -> None:
        """Text to copy."""
        self._add("code", text=text)

    def table(self, headings: Sequence[str], rows: Iterable[Sequence[Any]], classes: Any = None) -> None:
        """A table; numbers go to the right. ``classes(row, column)`` may name a style for a cell."""
        rows = [list(row) for row in rows]
        right = [bool(rows) and all(_is_number(row[i]) for row in rows) for i in range(len(headings))]
        body = [
            [
                (_shown(cell), _names(_layout(cell, right[column]), classes(number, column) if classes else None))
                for column, cell in enumerate(row)
            ]
            for number, row in enumerate(rows)
        ]
        head = [(text, _names("n" if numbers else None)) for text, numbers in zip(headings, right, strict=True)]
        self._add("table", head=head, rows=body, style="many" if len(headings) >= _MANY else "")

    def picture(self, png: bytes, title: str, caption: str = "") -> None:
        """An embedded picture; the title says what to see and is its text for those who cannot."""
        self._add("picture", data=base64.b64encode(png).decode(), title=title, caption=caption)

    def folded(self, summary: str, inner: Page) -> None:
        """A part that opens on demand."""
        self._add("folded", summary=summary, parts=inner._parts)

    def html(self) -> str:
        """The whole document."""
        return fill(_TEMPLATE, title=self._title, lead=self._lead, parts=self._parts)

    def _add(self, kind: str, **values: Any) -> None:
        self._parts.append({"kind": kind, **values})


def _layout(cell: Any, number: bool) -> str | None:
    """Numbers go to the right and stay whole; a long name may be broken anywhere, a short word may not."""
    if number:
        return "n"
    return "long" if max(map(len, str(cell).split()), default=0) > _WORD else None


def _names(*names: str | None) -> str:
    return " ".join(name for name in names if name)


def _is_number(cell: Any) -> bool:
    if isinstance(cell, (int, float)) and not isinstance(cell, bool):
        return True
    text = str(cell).strip().rstrip("%").strip()
    if text in ("", "-"):
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True


def _shown(cell: Any) -> str:
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
