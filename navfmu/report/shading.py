"""Grey where a fault is present, and a strip above the picture that names it: legends stay for the curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from navfmu.report.figure import GREY
from navfmu.report.scene import Window

ROW = 0.17  # inch for each row of the strip
POINTS = 72.0  # in an inch


def height(windows: Sequence[Window]) -> float:
    """Inches above the first panel that the strip needs."""
    return ROW * len(_rows(windows))


def shade(drawing: Any, axes: Sequence[Any], windows: Sequence[Window], first: float, last: float) -> float:
    """Shade the windows in all panels, from the times ``first`` to ``last`` (s) that are drawn.

    Returns the distance (points) at which the title of the first panel stands above it.
    """
    top = axes[0]
    inches = top.get_position().height * drawing.get_figheight()
    rows = _rows(windows)
    for number, (spans, text) in enumerate(rows):
        low = 1.0 + ROW * (len(rows) - 1 - number) / inches
        high = low + 0.8 * ROW / inches
        across = top.get_xaxis_transform()
        for start, end in spans:
            begin, finish = min(max(start, first), last), max(min(end, last), first)
            for axis in axes:
                axis.axvspan(begin, finish, color=GREY, alpha=0.10, linewidth=0)
            top.fill_between([begin, finish], low, high, color=GREY, alpha=0.25, lw=0, transform=across, clip_on=False)
        begin = min(max(spans[0][0], first), last)
        late = begin > first + 0.7 * (last - first)
        top.text(
            last if late else begin, (low + high) / 2, f"{text} " if late else f" {text}", transform=across,
            ha="right" if late else "left", va="center_baseline", fontsize=7.5,
        )  # fmt: skip
    return 6.0 + POINTS * height(windows)


def _rows(windows: Sequence[Window]) -> list[tuple[tuple[tuple[float, float], ...], str]]:
    """Times and text of each row: what begins and ends together shares one."""
    times = sorted({window.spans for window in windows if window.spans})
    return [(spans, ", ".join(dict.fromkeys(w.name for w in windows if w.spans == spans))) for spans in times]
