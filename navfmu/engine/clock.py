"""Time of a run: communication points counted in integers, so that 10 steps of 0.1 s end at 1.0 s exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from navfmu.errors import NavfmuError
from navfmu.fmi.seconds import is_finite, short

TOLERANCE = 1e-9  # relative; absorbs the rounding of decimal times written as doubles
FOREVER = 2**62  # step number that no run reaches


def exact(value: float) -> Fraction:
    """The decimal number that a user wrote when a double is read back, e.g. 1/10 for 0.1."""
    return Fraction(repr(float(value)))


@dataclass(frozen=True)
class Clock:
    """Communication points t_k = k * numerator / denominator, k = 0 ... steps, in s.

    The step is kept as a ratio of integers wherever a short one gives the same double, because k * n / d is then the
    double nearest to the decimal time (0.3 and not 0.30000000000000004).
    """

    step: float
    steps: int
    numerator: float
    denominator: float

    @classmethod
    def of(cls, step: float, stop: float) -> Clock:
        """The clock of a run from 0 to ``stop`` (s) in steps of ``step`` (s), of which it must be a multiple."""
        for name, value in (("step", step), ("stop time", stop)):
            if not (is_finite(value) and value > 0):
                raise NavfmuError(f"the {name} must be a positive number of seconds, not {short(value)}")
        step, stop = float(step), float(stop)
        ratio_of_step = Fraction(step).limit_denominator(1_000_000)
        is_short = 0 < ratio_of_step.numerator < 2**20 and float(ratio_of_step) == step
        numerator, denominator = (ratio_of_step.numerator, ratio_of_step.denominator) if is_short else (step, 1.0)
        ratio = exact(stop) / (ratio_of_step if is_short else Fraction(step))
        steps = round(ratio)
        if steps < 1 or abs(ratio - steps) > Fraction(TOLERANCE) * steps:
            below, above = math.floor(ratio) * step, math.ceil(ratio) * step
            near = f"{above:.9g} s" if below == 0 else f"{below:.9g} s or {above:.9g} s"
            raise NavfmuError(
                f"the stop time {stop:.9g} s is not a multiple of the step {step:.9g} s; the nearest is {near}"
            )
        if steps >= 2**53 or steps * numerator >= 2**53:
            raise NavfmuError(
                f"{stop:.9g} s in steps of {step:.9g} s are more steps than can be counted exactly; take a larger "
                "step or an earlier stop time"
            )
        return cls(step, steps, float(numerator), float(denominator))

    @property
    def ratio(self) -> Fraction:
        """The step in s as an exact ratio."""
        return Fraction(self.numerator) / Fraction(self.denominator)

    def time(self, k: int) -> float:
        """Communication point ``k`` in s, by the same two operations as the compiled engine."""
        return k * self.numerator / self.denominator

    def index(self, time: float) -> int:
        """The first communication point at or after ``time`` (s)."""
        if not math.isfinite(time):
            return FOREVER
        points = exact(time) / self.ratio
        return max(0, min(FOREVER, math.ceil(points - Fraction(TOLERANCE) * max(1, points))))

    def last(self, time: float) -> int:
        """The last communication point at or before ``time`` (s), which is not negative and finite."""
        points = exact(time) / self.ratio
        return min(FOREVER, math.floor(points + Fraction(TOLERANCE) * max(1, points)))

    def multiple(self, period: float, what: str) -> int:
        """``period`` (s) as a whole number of steps, at least 1; ``what`` names it in the error."""
        if not (is_finite(period) and period > 0):
            raise NavfmuError(f"the {what} must be a positive number of seconds, not {short(period)}")
        ratio = exact(period) / self.ratio
        count = round(ratio)
        if count >= 2**53:
            raise NavfmuError(f"the {what} {period:.9g} s is too long for the step {self.step:.9g} s to be counted")
        if count < 1 or abs(ratio - count) > count * Fraction(TOLERANCE):
            raise NavfmuError(f"the {what} {period:.9g} s is not a multiple of the step {self.step:.9g} s")
        return count
