"""What a browser draws of one run: curves as plain numbers, in panels. Nothing here knows how it is drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Curve:
    """Numbers with a name. ``x`` and ``y`` have one length; where one of them is no number the curve has a gap.

    ``look`` is ``line``, ``steps`` (held to the next point), ``band`` (from -y to y), ``outline`` (thin) or ``marks``
    (points, with ``texts``). A ``sampled`` curve has a point for each recorded one and may be thinned out; where its
    ``peaks`` matter they are kept.
    """

    name: str
    x: np.ndarray
    y: np.ndarray
    look: str = "line"
    colour: str = "#000000"
    sampled: bool = True
    peaks: bool = False
    texts: tuple[str, ...] = ()
    symbol: str = "circle"


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves on common axes. Over time (``timed``) faults are shaded, and marked is what happened."""

    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    timed: bool = True
    equal: bool = False  # whether both axes have one scale


def constant(name: str, level: float, start: float, end: float, colour: str) -> Curve:
    """A level from one time to another (s)."""
    return Curve(name, np.array([start, end]), np.array([level, level]), "outline", colour, sampled=False)
