"""A picture of imported observations: which satellites were measured, how strongly, and which are of use."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from navfmu.files.writing import replacing
from navfmu.recorded.observations.imported import Imported


def draw(imported: Imported, path: str | Path) -> None:
    """Write a PNG: satellites over time coloured by their strength, and how many there are."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    epochs, good = imported.epochs, imported.good
    row, place = np.nonzero(epochs.number)
    figure, (sky, count) = plt.subplots(2, 1, figsize=(12, 8), sharex=True, height_ratios=(3, 1))
    number = epochs.number[row, place]
    shown = sky.scatter(epochs.time[row], number, c=epochs.signal_to_noise[row, place], s=3, marker="s")
    bad = ~good[row, place]
    sky.plot(epochs.time[row[bad]], number[bad], "x", ms=3, color="C3", label="not tracked: no orbit, or unhealthy")
    sky.set(ylabel="PRN", ylim=(0, 33))
    figure.colorbar(shown, ax=sky, label="C/N0 (dB-Hz)", orientation="horizontal", pad=0.04, aspect=60)
    if bad.any():
        sky.legend(fontsize=8)
    count.step(epochs.time, good.sum(axis=1), where="post", color="C0")
    count.set(xlabel="t (s)", ylabel="satellites with an orbit", ylim=(0, None))
    for axis in (sky, count):
        axis.grid(alpha=0.3)
    figure.suptitle(Path(imported.source).name)
    figure.tight_layout()
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=80)
    plt.close(figure)
