"""What cannot be so in observations of satellites: orbits of another time, units, signs, times of UTC."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from navfmu.constants import WAVELENGTH
from navfmu.recorded.observations.epochs import Epochs

NEAREST, FARTHEST = 1.8e7, 3.2e7
"""Pseudoranges, m: 20 200 to 25 800 km, and a clock that is off by some ms."""
FASTEST = 1.2e4
"""Of range rates, m/s: a fast aircraft and a bad clock."""
STEP = 60.0
"""s between epochs of which rates are compared."""


def doubts(epochs: Epochs) -> Iterator[str]:
    """Yield what is not plausible."""
    seen = epochs.number > 0.0
    yield from _outside("pseudorange", "m", epochs, epochs.pseudorange, seen, NEAREST, FARTHEST)
    yield from _outside("range_rate", "m/s", epochs, epochs.range_rate, seen, -FASTEST, FASTEST)
    yield from _rates(epochs)


def _outside(name, unit, epochs: Epochs, values, seen, low, high) -> Iterator[str]:
    wrong = np.argwhere(seen & ((values < low) | (values > high)))
    if len(wrong):
        row, place = wrong[0]
        yield (
            f"{name} of satellite {epochs.number[row, place]:g} at {epochs.moment(row)} is {values[row, place]:.10g} "
            f"{unit}; expected {low:g} to {high:g} ({len(wrong)} of {np.count_nonzero(seen)} are beyond)"
        )


def _rates(epochs: Epochs) -> Iterator[str]:
    """Pseudoranges change by what range rates say: their sign and scale are told by the middle of all."""
    step = np.diff(epochs.time)[:, None]
    same = (epochs.number[1:] == epochs.number[:-1]) & (epochs.number[1:] > 0.0) & (step <= STEP)
    rate = (np.diff(epochs.pseudorange, axis=0) / np.where(step > 0.0, step, 1.0))[same]
    told = (0.5 * (epochs.range_rate[1:] + epochs.range_rate[:-1]))[same]
    if not len(rate) or np.median(np.abs(rate)) < 1.0:
        return
    apart, most = np.median(np.abs(rate - told)), 0.2 * np.median(np.abs(rate))
    if apart <= most:
        return
    scales = {
        "with the other sign": -1.0,
        "in m/s, positive where ranges shrink,": 1.0 / WAVELENGTH,
        "in m/s, positive where ranges grow,": -1.0 / WAVELENGTH,
    }
    better = [words for words, scale in scales.items() if np.median(np.abs(rate - scale * told)) <= most]
    yield (
        f"range rates differ from what pseudoranges change by, by {apart:.3g} m/s in the middle; expected less than "
        f"{most:.3g}" + (f": Doppler {better[0]} would agree" if better else "")
    )
