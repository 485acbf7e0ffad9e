"""model.png of an FMU: what hosts show on the block."""

from __future__ import annotations

import hashlib
import io

import numpy as np


def icon(name: str) -> bytes:
    """Return a PNG of the name on a disc with a compass needle, whose colour comes from the name."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, Polygon

    hue = hashlib.sha256(name.encode()).digest()[0] / 256 * 2 * np.pi
    colour = (95 + 50 * np.cos(hue + np.array([0.0, 2.1, 4.2]))) / 255
    figure = Figure(figsize=(1.28, 1.28), dpi=100, facecolor="none")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(-1.0, 1.0), ylim=(-1.0, 1.0), aspect="equal", frame_on=False)
    axes.set_axis_off()
    axes.add_patch(Circle((0.0, 0.0), 0.98, color=colour, linewidth=0.0))
    axes.add_patch(Circle((0.0, 0.0), 0.88, fill=False, edgecolor="white", linewidth=1.5))
    tip, side = np.array([0.30, 0.43]) * 0.8, np.array([0.082, -0.057])
    centre = np.array([0.0, 0.4])
    for sign, shade in ((1.0, "white"), (-1.0, "0.12")):
        axes.add_patch(Polygon([centre + sign * tip, centre + side, centre - side], color=shade, linewidth=0.0))
    lines = name.split("_")
    longest = max(map(len, lines))
    size = min(24.0, 100.0 / longest, 34.0 / len(lines))
    axes.text(
        0.0, -0.28, "\n".join(lines), size=size, color="white", ha="center", va="center", weight="bold", linespacing=0.9
    )
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()
