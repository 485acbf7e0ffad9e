"""A picture of imported samples: the values over time, how regularly they come, gaps and repeats."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from navfmu.errors import visible
from navfmu.files.writing import replacing
from navfmu.recorded.replay import account
from navfmu.recorded.replay.importer import Imported
from navfmu.recorded.replay.samples import Samples

GAPS, REPEATS, INVALID = "C1", "C3", "0.6"
MOST = 1000
"""Gaps, the longest, and samples that are not valid, the first, that are shaded."""


def draw(imported: Imported, path: str | Path) -> None:
    """Write a PNG: a panel for each quantity that was recorded, and one for the intervals of each table."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    panels = [(samples, name) for samples in imported.streams for name in (*_recorded(samples), None)]
    figure, axes = plt.subplots(len(panels), 1, figsize=(12, 2.4 * len(panels) + 0.6), squeeze=False)
    for axis, (samples, name) in zip(axes[:, 0], panels, strict=True):
        if name is None:
            _intervals(axis, samples, imported.tick)
        else:
            _values(axis, samples, name)
        axis.grid(alpha=0.3)
        axis.set_xlim(0.0, imported.duration)
        axis.set_xlabel("t (s)")
    figure.suptitle(visible(Path(imported.source).name), parse_math=False)
    figure.tight_layout()
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=80)
    plt.close(figure)


def _recorded(samples: Samples) -> list[str]:
    return [q.name for q in samples.wanted.quantities if q.name in samples.values and samples.sources[q.name].columns]


def _values(axis, samples: Samples, name: str) -> None:
    quantity = next(q for q in samples.wanted.quantities if q.name == name)
    seen = samples.valid & samples.known.get(name, np.ones(len(samples), bool))
    values = samples.values[name].reshape(len(samples), -1)
    for label, column in zip(quantity.labels, values.T, strict=True):
        axis.plot(samples.time[seen], column[seen], ".", ms=1.5, label=label.partition(" ")[0])
    _shade(axis, samples)
    columns = samples.sources[name].columns
    title = name if columns == (name,) else f"{name}: {visible(', '.join(columns))}"
    axis.set_title(title, parse_math=False)  # names of columns may have a $
    axis.set_ylabel(quantity.unit)
    _legend(axis)


def _intervals(axis, samples: Samples, tick: float) -> None:
    """Time from each sample to the next one; those that repeat the values of the one before in another colour."""
    interval, repeated = 1e3 * np.diff(samples.time), samples.repeated()
    places, lost = account.gaps(samples), account.lost(samples, tick)
    axis.plot(samples.time[1:], interval, ".", ms=1.5, c="C0", label="to the one before")
    if repeated.any():
        again = samples.time[1:][repeated[1:]]
        axis.plot(again, interval[repeated[1:]], ".", ms=3, c=REPEATS, label="repeats its values")
    axis.axhline(1e3 * tick, c="k", lw=1.0, ls=":", zorder=3, label="a tick of the FMU")
    _shade(axis, samples)
    found = f"gaps (shaded) {len(places)}, repeats {int(repeated.sum())}, lost in ticks of {1e3 * tick:g} ms {lost}"
    axis.set_ylim(0.0, 1.15 * np.max(np.append(interval, 1e3 * tick)))
    axis.set(title=f"samples {len(samples)}, {found}", ylabel="ms")
    _legend(axis)


def _legend(axis) -> None:
    """Beside the panel, where it hides nothing."""
    axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), fontsize=8, markerscale=5, frameon=False)


def _shade(axis, samples: Samples) -> None:
    places, interval = account.gaps(samples), np.diff(samples.time)
    for place in places[np.argsort(interval[places])[-MOST:]]:
        axis.axvspan(samples.time[place], samples.time[place + 1], color=GAPS, alpha=0.4, lw=0.8)  # wider than nothing
    for time in samples.time[~samples.valid][:MOST]:
        axis.axvline(time, color=INVALID, lw=0.3, zorder=0)
