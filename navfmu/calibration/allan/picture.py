"""A picture of Allan deviations and the terms that make them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from navfmu.calibration.allan.identification import Identification
from navfmu.calibration.allan.sensor import Sensor
from navfmu.errors import visible
from navfmu.report.figure import COLOURS, GREY, figure, png

SIGMAS = 2.0
"""Of the bars."""


def draw(found: Mapping[Sensor, Identification], source: str) -> bytes:
    """A panel for each sensor: the chart with its scatter, the sum of the terms, and the terms of the first axis."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    with figure(1, len(found), size=(5.6 * len(found), 4.4), above=0.25, left=0.85, squeeze=False) as (drawing, axes):
        drawing.suptitle(visible(source), x=0.01, ha="left", fontsize=9.5, parse_math=False)
        for axis, (sensor, one) in zip(axes[0], found.items(), strict=True):
            chart, fine = one.chart, np.geomspace(one.chart.time[0], one.chart.time[-1], 200)
            shares = one.shares(fine)
            low, high = np.exp(-SIGMAS * chart.spread), np.exp(SIGMAS * chart.spread)
            for i, name in enumerate("xyz"):
                seen = chart.deviation[:, i]
                bars = np.stack([seen * (1.0 - low), seen * (high - 1.0)])
                axis.errorbar(chart.time, seen, yerr=bars, fmt="o", color=COLOURS[i], ms=3, lw=1, label=name)
                axis.plot(fine, np.sqrt(shares[:, :, i].sum(axis=0)), color=COLOURS[i], lw=1)
            for term, share in zip(one.terms, np.sqrt(shares.mean(axis=2)), strict=True):
                axis.plot(fine, share, "--", color=GREY, lw=0.8)
                at = len(fine) // 3 if term.slope < 0 else 2 * len(fine) // 3
                axis.annotate(term.name, (fine[at], share[at]), color=GREY, fontsize=8)
            axis.set(xscale="log", yscale="log", xlabel="averaging time, s")
            bottom = chart.deviation.min()
            axis.set_ylim(0.5 * bottom, 2.0 * chart.deviation.max())
            for one_way in (axis.xaxis, axis.yaxis):
                one_way.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
                one_way.set_minor_formatter(NullFormatter())
            axis.set_ylabel(f"Allan deviation, {sensor.unit}")
            axis.set_title(f"{sensor.quantity}: {', '.join(map(str, one.terms))}", fontsize=10)
            axis.legend(title="axes; lines: terms together; bars: 2 sigma", ncols=3, fontsize=8, loc="upper center")
        return png(drawing)
