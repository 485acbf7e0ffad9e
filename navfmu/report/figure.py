"""Pictures: one look, drawn without a screen, returned as PNG."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Colours that remain distinct in print and with colour blindness (Okabe and Ito).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#777777"
_STYLE = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "font.size": 9.5,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "svg.hashsalt": "navfmu",
}
_lock = Lock()


@contextmanager
def figure(
    rows: int = 1,
    columns: int = 1,
    size: tuple[float, float] = (9.0, 4.5),
    below: float = 0.0,
    above: float = 0.0,
    left: float = 0.75,
    right: float = 0.15,
    **options: Any,
) -> Iterator[Any]:
    """Yield (figure, axes) with the common style; not through pyplot, so that nothing global is kept.

    Margins are fixed lengths (inch): a layout that measures its texts would draw everything twice. ``below`` is room
    for legends under the axes, ``above`` for what stands between the first panel and its title.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width, height = size
    with _lock, matplotlib.rc_context(_STYLE):
        drawing = Figure(figsize=size)
        FigureCanvasAgg(drawing)
        drawing.subplots_adjust(
            left=left / width,
            right=1 - right / width,
            bottom=(0.5 + below) / height,
            top=1 - (0.35 + above) / height,
            wspace=0.08 if options.get("sharey") else 0.3,
            hspace=0.25,
        )
        yield drawing, drawing.subplots(rows, columns, **options)


def title(drawing: Figure, axis: Any, text: str, pad: float = 6.0, whole: bool = False) -> None:
    """A title of a panel, in letters small enough to fit over it, or over the ``whole`` width of the drawing.

    ``pad`` (points) is its distance.
    """
    place = axis.get_position()
    room = (0.98 if whole else place.width) * drawing.get_figwidth()
    wide = 0.0094 * max(len(line) for line in text.split("\n"))  # inch for each point of the size of letters
    found = axis.set_title(text, pad=pad, fontsize=max(5.0, min(11.0, room / max(wide, 1e-9))))
    if whole:
        found.set_x((0.01 - place.x0) / place.width)


def png(drawing: Figure, dpi: int = 110) -> bytes:
    """The drawing as bytes that depend on nothing but the drawing."""
    buffer = io.BytesIO()
    drawing.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()
