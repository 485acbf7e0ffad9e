"""A sign that a system gives of itself: it has noticed that something is wrong."""

from __future__ import annotations

import numpy as np

from navfmu.files.schema import Field, Number
from navfmu.report.kind import Kind
from navfmu.report.scene import Recorded


class Notice(Kind):
    """A signal that says that the system has noticed something, from when it is not 0, or has a value."""

    label: str = Field(min_length=1, description="what is noticed, in words")
    signal: str = Field(description="the signal that says so")
    equals: Number | None = Field(None, description="the value with which it says so; default: any but 0")

    @property
    def called(self) -> str:
        return self.label

    def needs(self) -> list[str]:
        return [self.signal]

    def times(self, run: Recorded) -> np.ndarray:
        """When it begins to say so (s), at each of the recorded points; NaN says nothing."""
        values = run[self.signal]
        says = (values != 0) & ~np.isnan(values) if self.equals is None else values == self.equals
        return run.time[says & ~np.append(False, says[:-1])]
