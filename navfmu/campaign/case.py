"""What is done to the system in a run of a campaign."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from navfmu.faults import Fault


@dataclass(frozen=True)
class Case:
    """One thing that is done to the system.

    Where a table of the campaign file stands for several cases (its faults one by one or in pairs, the points of its
    axes), each is a case of its own: ``written`` is the name in the file, ``values`` are those of the axes.
    """

    name: str
    description: str = ""
    faults: tuple[Fault, ...] = ()
    parameters: dict[str, Any] = field(default_factory=dict)
    step: float | None = None  # s, where it is not that of the campaign
    written: str = ""
    values: dict[str, float | str | bool] = field(default_factory=dict)  # by axis, in the unit of the axis

    def __post_init__(self) -> None:
        object.__setattr__(self, "written", self.written or self.name)
