"""How Allan variances of overlapping averages scatter, and how those of different averaging times go together.

The difference of neighbouring averages over n samples is the samples through a filter, thesis section C.3: with the
spectrum S of the samples over the frequency f in cycles a sample,

    v_n = integral P_n S df,   P_n = 2 sin^4(pi f n) / (n sin(pi f))^2,   f from -1/2 to 1/2.

The mean of M squares of normal numbers has, by Parseval's theorem, for M far above n,

    cov(s_m, s_n) = 2 integral P_m P_n S^2 df / sqrt(M_m M_n).
"""

from __future__ import annotations

import numpy as np

from navfmu.calibration.allan.chart import Chart

CELLS = 20000
"""Of the frequencies, each wider than the one before by the same factor."""
SLOWEST = 0.02
"""Lowest frequency, in cycles over the longest average."""


def frequencies(chart: Chart) -> tuple[np.ndarray, np.ndarray]:
    """Middles and widths of the cells, cycles a sample."""
    edges = np.geomspace(SLOWEST * chart.period / chart.time[-1], 0.5, CELLS + 1)
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)


def filters(chart: Chart, frequency: np.ndarray) -> np.ndarray:
    """P_n, (levels, frequencies)."""
    n = np.round(chart.time / chart.period)[:, None]
    return 2.0 * np.sin(np.pi * frequency * n) ** 4 / (n * np.sin(np.pi * frequency)) ** 2


def covariance(chart: Chart, spectrum: np.ndarray, variance: np.ndarray, still: np.ndarray) -> np.ndarray:
    """Covariance (levels, levels) of s / v for one axis, whose samples have the ``spectrum`` at ``frequencies``.

    ``variance`` (levels,) is v; what is no process, ``still`` of it (a ramp), is taken to scatter as pairs of averages
    do that do not overlap.
    """
    frequency, width = frequencies(chart)
    passed = filters(chart, frequency) * spectrum * np.sqrt(2.0 * width) / (variance * np.sqrt(chart.count))[:, None]
    return 2.0 * passed @ passed.T + np.diag(2.0 / chart.pairs * (still / variance) ** 2)
