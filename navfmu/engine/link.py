"""A link: what one input gets from one output, all conversions of its connection taken together."""

from __future__ import annotations

from dataclasses import dataclass


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
