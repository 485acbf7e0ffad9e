"""The smallest magnitude that violates a requirement, by bisection."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from navfmu.campaign.axis import Axis, Span, texts
from navfmu.campaign.case import Case


@dataclass(frozen=True)
class Bracket:
    """Two values of an axis as near to one another as was asked, of which one holds and the other violates.

    Where both ends of the axis are alike there is nothing between them to look for: one of the two is None.
    """

    holds_at: float | None
    violated_at: float | None


@dataclass(frozen=True)
class Search:
    """A case, and the axis along which it is changed until a requirement is violated."""

    case: Case
    axis: Axis

    @property
    def requirement(self) -> str:
        """Its id."""
        return self.axis.goal.requirement

    @property
    def sentence(self) -> str:
        """What is varied, in words."""
        ends = " to ".join(texts(self.axis, [self.span.low, self.span.high]))
        return f"searched: {self.axis.name} from {ends} for {self.requirement}"

    @property
    def span(self) -> Span:
        """From where to where is searched."""
        return self.axis.values

    @property
    def most(self) -> int:
        """The number of runs that it may take."""
        low, count = self.span.low, 2
        while self.span.high - low > self.axis.goal.tolerance:  # the upper half is never the narrower one
            low, count = self.span.middle(low, self.span.high), count + 1
        return count

    def at(self, value: float) -> Case:
        """The case with this value."""
        case = self.axis.laid(self.case, value)
        told = f"{self.axis.name}={self.axis.text(value, 9)}"
        return replace(case, name=f"{case.name[:-1]}, {told})" if self.case.values else f"{case.name} ({told})")

    def bracket(self, holds: Callable[[float], bool]) -> Bracket:
        """Ask ``holds`` of one value after the other, beginning with the ends."""
        low, high = self.span.low, self.span.high
        at_low, at_high = holds(low), holds(high)
        if at_low == at_high:
            return Bracket(high, None) if at_low else Bracket(None, low)
        while high - low > self.axis.goal.tolerance:
            middle = self.span.middle(low, high)
            if holds(middle) == at_low:
                low = middle
            else:
                high = middle
        return Bracket(low, high) if at_low else Bracket(high, low)
