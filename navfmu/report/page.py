"""Self-contained HTML pages: text, tables and embedded pictures in one file that opens offline and prints well."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from typing import Any

_CSS = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; color: #1a1a1a; background: #fff;
       max-width: 1080px; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
p.lead { color: #444; margin-top: 0; }
table { border-collapse: collapse; margin: .6rem 0; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid #d5d5d5; padding: .25rem .7rem .25rem 0; text-align: left; vertical-align: top; }
td.n, th.n { text-align: right; padding-left: .7rem; }
th { border-bottom: 2px solid #888; font-weight: 600; }
.good { background: #dff2e4; } .bad { background: #fbe0dc; } .none { background: #eee; color: #555; }
td.good, td.bad, td.none { padding-left: .5rem; border: 2px solid #fff; }
figure { margin: 1rem 0; } img { max-width: 100%; } figcaption { color: #444; font-size: .9rem; }
pre { background: #f5f5f5; padding: .6rem .8rem; overflow-x: auto; font-size: .85rem; white-space: pre-wrap; }
details { margin: .5rem 0; } summary { cursor: pointer; }
.wide { overflow-x: auto; }
@media print { body { max-width: none; margin: 0; font-size: 11px; } figure, tr { break-inside: avoid; } }
"""


class Page:
    """A page under construction, read from top to bottom."""

    def __init__(self, title: str, lead: str = "") -> None:
        self._title = title
        self._parts = [f"<h1>{html.escape(title)}</h1>"]
        if lead:
            self._parts.append(f'<p class="lead">{html.escape(lead)}</p>')

    def heading(self, text: str) -> None:
        """A section."""
        self._parts.append(f"<h2>{html.escape(text)}</h2>")

    def text(self, text: str) -> None:
        """A paragraph."""
        self._parts.append(f"<p>{html.escape(text)}</p>")

    def items(self, lines: Iterable[str]) -> None:
        """A list."""
        self._parts.append("<ul>" + "".join(f"<li>{html.escape(line)}</li>" for line in lines) + "</ul>")

    def code(self, text: str) -> None:
        """Text to copy."""
        self._parts.append(f"<pre>{html.escape(text)}</pre>")

    def table(self, headings: Sequence[str], rows: Iterable[Sequence[Any]], classes: Any = None) -> None:
        """A table; numbers go to the right. ``classes(row, column)`` may name a style for a cell."""
        rows = [list(row) for row in rows]
        right = [bool(rows) and all(_is_number(row[i]) for row in rows) for i in range(len(headings))]
        head = "".join(
            f"<th{' class=n' if r else ''}>{html.escape(h)}</th>" for h, r in zip(headings, right, strict=True)
        )
        body = []
        for number, row in enumerate(rows):
            cells = []
            for column, cell in enumerate(row):
                names = ["n"] if right[column] else []
                extra = classes(number, column) if classes else None
                names += [extra] if extra else []
                attribute = f' class="{" ".join(names)}"' if names else ""
                cells.append(f"<td{attribute}>{_cell(cell)}</td>")
            body.append(f"<tr>{''.join(cells)}</tr>")
        self._parts.append(f'<div class="wide"><table><tr>{head}</tr>{"".join(body)}</table></div>')

    def picture(self, png: bytes, title: str, caption: str = "") -> None:
        """An embedded picture; the title says what to see and is its text for those who cannot."""
        data = base64.b64encode(png).decode()
        below = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
        image = f'<img alt="{html.escape(title, quote=True)}" src="data:image/png;base64,{data}">'
        self._parts.append(f"<figure>{image}{below}</figure>")

    def folded(self, summary: str, inner: Page) -> None:
        """A part that opens on demand."""
        self._parts.append(f"<details><summary>{html.escape(summary)}</summary>{inner.body(False)}</details>")

    def body(self, with_title: bool = True) -> str:
        """The parts one after the other."""
        return "\n".join(self._parts if with_title else self._parts[1:])

    def html(self) -> str:
        """The whole document."""
        return (
            f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{html.escape(self._title)}</title><style>{_CSS}</style></head><body>\n{self.body()}\n</body></html>\n"
        )


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


def _cell(cell: Any) -> str:
    return html.escape(f"{cell:.4g}" if isinstance(cell, float) else str(cell))
