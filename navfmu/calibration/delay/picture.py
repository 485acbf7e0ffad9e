"""What is left over the delay, with the best ones."""

from __future__ import annotations

from navfmu.calibration.delay.fit import Found
from navfmu.errors import visible
from navfmu.report.figure import COLOURS, figure, png


def draw(found: Found) -> bytes:
    """A curve for horizontal and vertical velocity each."""
    with figure(1, 1, size=(8.0, 4.4), above=0.2) as (drawing, axis):
        for i, name in enumerate(found.axes):
            axis.plot(found.grid, found.misfit[:, i], color=COLOURS[i], label=f"{name}: {found.delay[i]:.3f} s")
            low, high = found.delay[i] - found.half[i], found.delay[i] + found.half[i]
            axis.axvspan(low, high, color=COLOURS[i], alpha=0.25, lw=0)
            axis.plot(found.delay[i], found.left[i], "o", color=COLOURS[i])
        axis.set(xlabel="delay, s", ylabel="left of velocity, m/s rms", xlim=(found.grid[0], found.grid[-1]))
        axis.set_ylim(bottom=0.0)
        axis.set_title(visible(found.source), parse_math=False, fontsize=9.0)
        axis.legend()
        return png(drawing)
