"""The plot of a run: the signals in question with their bounds, and the pictures of the system's report."""

from __future__ import annotations

import io
from collections.abc import Collection, Sequence

import numpy as np

from navfmu.report.kind import Picture
from navfmu.report.pictures import lines, percentiles
from navfmu.report.scene import Bound, Recorded
from navfmu.system.report_file import missing
from navfmu.system.scene import scene_of
from navfmu.testing.flown import Flown

DRAWN = 24  # signals that are drawn where neither the test nor the system says what is to be seen


def plot(run: Flown, signals: Sequence[str]) -> bytes:
    """All pictures of a run below one another, as PNG; those of ``signals`` come first."""
    system = run.experiment.system
    columns = {name: run.frame[name].to_numpy() for name in run.frame.attrs["units"] if name in run.frame}
    required = [asked.requirement for asked in run.asked]
    bounds = [Bound(r.id, r.signal, r.least, r.most, r.unit, r.start, r.end) for r in required if r.kind == "signal"]
    first = [
        name for name in dict.fromkeys([*signals, *(name for r in required for name in r.signals)]) if name in columns
    ]
    recorded = Recorded(run.name, run.frame.index.to_numpy(), columns, run.experiment.points)
    acted = run.frame.attrs["acted"]
    own = system.report.pictures if system.report else ()
    pictures = _pictures(first, [p for p in own if not missing(p, system.fmus)], columns)
    return _below_one_another(
        [
            picture.draw(scene_of(picture, run.experiment, [recorded], recorded, [acted], run.title, bounds)).png
            for picture in pictures
        ]
    )


def _pictures(first: Sequence[str], own: Sequence[Picture], columns: dict[str, np.ndarray]) -> list[Picture]:
    """Curves of what comes first, and what the system shows in reports as far as it was recorded."""
    curves = [name for name in first if columns[name].dtype.kind == "f"]
    found: list[Picture] = [percentiles.Picture(kind="percentiles", signal=name) for name in curves]
    others = [name for name in first if name not in curves]
    found += [lines.Picture(kind="lines", signals=others)] if others else []
    found += [picture for picture in own if _can_be_drawn(picture, columns) and picture not in found]
    return found or [lines.Picture(kind="lines", signals=list(columns)[:DRAWN])]


def _can_be_drawn(picture: Picture, columns: Collection[str]) -> bool:
    return all(name in columns for name in picture.needs())


def _below_one_another(drawn: Sequence[bytes]) -> bytes:
    """One picture of several, on white."""
    from matplotlib.image import imread, imsave

    pixels = [imread(io.BytesIO(png), format="png")[:, :, :3] for png in drawn]
    width = max(picture.shape[1] for picture in pixels)
    filled = [np.pad(p, ((0, 0), (0, width - p.shape[1]), (0, 0)), constant_values=1.0) for p in pixels]
    buffer = io.BytesIO()
    imsave(buffer, np.vstack(filled), format="png", metadata={"Software": None})
    return buffer.getvalue()
