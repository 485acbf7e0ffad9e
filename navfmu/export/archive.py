"""The .fmu file: a zip whose bytes depend on its contents alone."""

from __future__ import annotations

import hashlib
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from navfmu.files import write_file
from navfmu.zip import zipped

#: Folders below ``binaries/`` for each platform in FMI 2.0; where it has no name, the platform tuple of FMI 3.0.
FOLDERS = {
    "x86_64-linux": "linux64",
    "aarch64-linux": "aarch64-linux",
    "x86_64-windows": "win64",
    "x86_64-darwin": "darwin64",  # a universal library when both processors are built
    "aarch64-darwin": "aarch64-darwin",
}


def write(path: str | Path, files: Mapping[str, bytes | str]) -> Path:
    """Write a zip of ``files`` (name in the archive -> contents), sorted; a file with the same bytes is left alone."""
    path, content = Path(path), zipped({name: files[name] for name in sorted(files)})
    if path.is_file() and path.read_bytes() == content:
        return path
    return write_file(path, content)


def guid(*parts: str | bytes) -> str:
    """Return ``{8-4-4-4-12}`` from a hash of the parts."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    text = digest.hexdigest()
    return f"{{{text[:8]}-{text[8:12]}-{text[12:16]}-{text[16:20]}-{text[20:32]}}}"


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
    for sign, shade in ((1.0, "white"), (-1.0, "0.12")):
        axes.add_patch(Polygon(np.array([sign * tip, side, -side]) + (0.0, 0.4), color=shade, linewidth=0.0))
    lines = name.split("_")
    longest = max(map(len, lines))
    size = min(24.0, 100.0 / longest, 34.0 / len(lines))
    axes.text(
        0.0, -0.28, "\n".join(lines), size=size, color="white", ha="center", va="center", weight="bold", linespacing=0.9
    )
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()
