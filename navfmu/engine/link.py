"""A link: what one input gets from one output, all conversions of its connection taken together."""

from __future__ import annotations

import math
from dataclasses import dataclass

from navfmu.errors import NavfmuError
from navfmu.fmi.description import Variable
from navfmu.fmi.names import Signal

TYPES = ("Real", "Integer", "Boolean")  # of values that are passed on


@dataclass(frozen=True, slots=True)
class Link:
    """``target = factor * source + offset``; 1 and 0 copy the bits."""

    source: str  # "component.output"
    target: str  # "component.input"
    factor: float = 1.0
    offset: float = 0.0

    @property
    def scaled(self) -> bool:
        """Whether it does more than copy."""
        return (self.factor, self.offset) != (1.0, 0.0)

    def check(self, source: Variable, target: Variable, where: str) -> None:
        """Refuse what cannot be passed on from one variable to the other."""
        if source.causality != "output":
            raise NavfmuError(f"{where}: '{self.source}' is not an output ({source.causality})")
        if target.causality != "input":
            raise NavfmuError(f"{where}: '{self.target}' is not an input ({target.causality})")
        kinds = source.type, target.type
        if kinds[0] not in TYPES or (kinds[0] != kinds[1] and kinds != ("Integer", "Real")):
            raise NavfmuError(f"{where}: a {kinds[0]} cannot be connected to a {kinds[1]}")
        if self.scaled and kinds[1] != "Real":
            raise NavfmuError(f"{where}: only Real values can be scaled, not {kinds[1]}")
        if not (math.isfinite(self.factor) and math.isfinite(self.offset)):
            raise NavfmuError(f"{where}: factor {self.factor!r} and offset {self.offset!r} must be finite")


Wire = tuple[Signal, Signal, Link]  # a link between its ends: source, target
