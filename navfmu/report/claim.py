"""A claim: a statement with a bound, and what was measured."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Claim:
    """``text`` is true while ``measured`` keeps the ``bound``; ``opposite`` is what is true otherwise."""

    text: str
    measured: float
    bound: float
    at_least: bool = True
    unit: str = ""
    opposite: str = ""

    @property
    def holds(self) -> bool:
        """Whether it is so; not when what was measured is no number."""
        return self.measured >= self.bound if self.at_least else self.measured <= self.bound

    @property
    def sentence(self) -> str:
        """What is true: the text or its opposite."""
        return self.text if self.holds else self.opposite or f"It is not so that: {self.text}"

    @property
    def verdict(self) -> str:
        return "holds" if self.holds else "MISSED"

    @property
    def limit(self) -> str:
        """The bound in words: "at most 926 m"."""
        return f"{'at least' if self.at_least else 'at most'} {self._with_unit(f'{self.bound:g}')}"

    @property
    def finding(self) -> str:
        """What was measured, with its unit."""
        return self._with_unit(f"{self.measured:.4g}")

    def _with_unit(self, number: str) -> str:
        return f"{number} {self.unit}" if self.unit else number
