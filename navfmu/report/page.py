"""Self-contained HTML pages: text, tables and embedded pictures in one file that opens offline and prints well."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from navfmu.report.template import fill

_TEMPLATE = Path(__file__).parent / "templates" / "page.html.j2"
_MANY = 9  # columns from which a table is set in small type
_WORD = 20  # letters up to which a word stays whole


@dataclass(frozen=True)
class Link:
    """A cell of a table that leads somewhere in the page, and what kind of word it is."""

    text: str
    href: str

    def __str__(self) -> str:
        return self.text


class Page:
    """A page under construction, read from top to bottom."""

    def __init__(self, title: str, lead: str = "", contents: bool = False) -> None:
        """With ``contents`` the headings are listed at the top."""
        self._title = title
        self._lead = lead
        self._contents = contents
        self._scripts: tuple[str, ...] = ()
        self._parts: list[dict[str, Any]] = []

    def heading(self, text: str, level: int = 2) -> None:
        """A section; links lead to ``anchor(text)``."""
        self._add("heading", text=text, level=level, anchor=anchor(text))

    def link(self, text: str, href: str) -> None:
        """A paragraph that leads somewhere in the page."""
        self._add("link", text=text, href=href)

    def block(self, template: str, **values: Any) -> None:
        """A part with a template of its own, a file in ``templates``."""
        self._add("block", template=template, **values)

    def data(self, name: str, value: Any) -> None:
        """Plain data for scripts: the text of an element with this id, as JSON."""
        text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
        self._add("data", name=name, type="application/json", text=Markup(text))

    def packed(self, name: str, text: str) -> None:
        """A text in base 64 for scripts."""
        self._add("data", name=name, type="text/plain", text=Markup(text))

    def run(self, *scripts: str) -> None:
        """Scripts at the end of the page, files in ``templates``."""
        self._scripts = scripts

    def text(self, text: str) -> None:
        """A paragraph."""
        self._add("text", text=text)

    def items(self, lines: Iterable[str]) -> None:
        """A list."""
        self._add("items", lines=list(lines))

    def code(self, text: str) -> None:
        """Text to copy."""
        self._add("code", text=text)

    def table(
        self, headings: Sequence[str], rows: Iterable[Sequence[Any]], classes: Any = None, paper: bool = False
    ) -> None:
        """A table; numbers go to the right. ``classes(row, column)`` may name a style for a cell.

        A table for ``paper`` is not seen on a screen where scripts show more than it does.
        """
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
        self._add("table", head=head, rows=body, paper=paper, style="many" if len(headings) >= _MANY else "")

    def picture(self, png: bytes, title: str, caption: str = "", tall: bool = False) -> None:
        """An embedded picture; the title says what to see and is its text for those who cannot.

        A ``tall`` one, with a row for each thing, gets most of a page on paper.
        """
        style = "tall" if tall else ""
        self._add("picture", data=base64.b64encode(png).decode(), title=title, caption=caption, style=style)

    def folded(self, summary: str, inner: Page, style: str = "") -> None:
        """A part that opens on demand."""
        self._add("folded", summary=summary, parts=inner._parts, style=style)

    def html(self) -> str:
        """The whole document."""
        listed = [part for part in self._parts if part["kind"] == "heading" and part["level"] == 2]
        return fill(
            _TEMPLATE,
            title=self._title,
            lead=self._lead,
            parts=self._parts,
            contents=listed if self._contents else [],
            scripts=self._scripts,
        )

    def _add(self, kind: str, **values: Any) -> None:
        self._parts.append({"kind": kind, **values})


def anchor(heading: str) -> str:
    """The id of a heading."""
    return re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-")


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


def _shown(cell: Any) -> str | Link:
    if isinstance(cell, Link):
        return cell
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
