"""One figure of a source beside our own, and the verdict."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from navfmu.errors import NavfmuError

AGREES, EXPLAINED, DIFFERS = "agrees", "differs, explained", "DIFFERS"


@dataclass(frozen=True)
class Difference:
    """Why our figure is another than the printed one, and from where to where it then lies."""

    low: float
    high: float
    why: str


@dataclass(frozen=True)
class Comparison:
    """``printed`` stands in the source; ours, ``found``, agrees from ``low`` to ``high``, for the reason ``why``.

    A ``difference`` that is known has bounds of its own: outside of these it explains nothing.
    """

    what: str
    printed: str
    found: float
    low: float
    high: float
    why: str
    unit: str = ""
    difference: Difference | None = None

    def __post_init__(self) -> None:
        for one in (self, self.difference):
            if one is not None and not one.low <= one.high:
                span = f"from {one.low:g} to {one.high:g}"
                raise NavfmuError(f"'{self.what}' agrees {span}; expected the smaller one first")
            if one is not None and not one.why.strip():
                raise NavfmuError(f"'{self.what}' says from where to where it agrees and not why; expected a sentence")

    @property
    def verdict(self) -> str:
        """AGREES, EXPLAINED or DIFFERS; a figure that is no number differs."""
        if self.low <= self.found <= self.high:
            return AGREES
        known = self.difference
        return EXPLAINED if known is not None and known.low <= self.found <= known.high else DIFFERS

    @property
    def finding(self) -> str:
        """Our figure with its unit."""
        return self._with_unit(_number(self.found))

    @property
    def bounds(self) -> str:
        """Where ours agrees, in words: "0 to 17", "at most 2.5 deg"."""
        return self._with_unit(_between(self.low, self.high))

    @property
    def explanation(self) -> str:
        """Why ours differs, and from where to where it is explained; "" where it agrees or nobody knows."""
        if self.verdict != EXPLAINED:
            return ""
        span = self._with_unit(_between(self.difference.low, self.difference.high))
        return f"{self.difference.why} (explained: {span})"

    def _with_unit(self, text: str) -> str:
        return f"{text} {self.unit}" if self.unit else text

    def describe(self) -> dict[str, Any]:
        """As plain data; what is infinite or no number is a text, which JSON does not have as a number."""
        return _plain(asdict(self)) | {"verdict": self.verdict}

    @classmethod
    def restored(cls, about: dict[str, Any]) -> Comparison:
        """The comparison that was described."""
        about = _numbers({name: value for name, value in about.items() if name != "verdict"})
        if about["difference"] is not None:
            about["difference"] = Difference(**_numbers(about["difference"]))
        return cls(**about)


def worst(verdicts: list[str]) -> str:
    """The verdict of several together."""
    return max(verdicts, key=(AGREES, EXPLAINED, DIFFERS).index)


def _between(low: float, high: float) -> str:
    if low == -math.inf:
        return f"at most {_number(high)}"
    return f"at least {_number(low)}" if high == math.inf else f"{_number(low)} to {_number(high)}"


def _number(value: float) -> str:
    """Four digits, and large numbers whole: 8371, not 8.371e+03."""
    return f"{value:.0f}" if 1000.0 <= abs(value) < 1e9 else f"{value:.4g}"


def _plain(about: dict[str, Any]) -> dict[str, Any]:
    return {
        name: _plain(value) if isinstance(value, dict) else str(value) if _endless(value) else value
        for name, value in about.items()
    }


def _endless(value: Any) -> bool:
    return isinstance(value, float) and not math.isfinite(value)


def _numbers(about: dict[str, Any]) -> dict[str, Any]:
    return {name: float(value) if name in ("found", "low", "high") else value for name, value in about.items()}
