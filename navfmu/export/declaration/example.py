"""The example run of a component, shown in its documentation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Example:
    """Class attribute ``example``: the run shown in the documentation, and what to see in it.

    ``Example({"latitude": 0.66}, steps={"heading": 1.5}, text="...")``: parameters and inputs by name (an array for a
    vector), in their units. Without ``steps`` and ``inputs`` all Real inputs step, at a fifth of the ``duration``.
    """

    values: Mapping[str, Any] = field(default_factory=dict)
    steps: Mapping[str, Any] | None = None
    text: str = ""  # what the picture shows
    duration: float = 60.0  # s
    step: float | None = None  # communication step, s
    mark: float | None = None  # time of a dotted line, s; where inputs step unless given
    inputs: Callable[[np.ndarray], Mapping[str, Any]] | None = field(default=None, repr=False)
    """Inputs over time instead of steps: from the times (s) to arrays whose first axis is time, by name."""
    periods: Mapping[str, float] = field(default_factory=dict)
    """How often new data comes in each input bundle, s; at every communication point unless given."""
    shows: Sequence[str] | None = None  # outputs in the picture, all Real ones unless given
    panels: Callable[[Mapping[str, np.ndarray]], Mapping[str, Mapping[str, np.ndarray]]] | None = field(
        default=None, repr=False
    )
    """Further curves: from "time" and all outputs by name to title -> label -> curve; a label that begins with "~" is
    dashed."""
