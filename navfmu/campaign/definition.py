"""What a campaign is: a system's variants, the cases that are done to them, seeds and requirements."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from navfmu.campaign.requirement import Requirement
from navfmu.faults import Fault
from navfmu.system.system import System


@dataclass(frozen=True)
class Case:
    """One thing that is done to the system."""

    name: str
    description: str = ""
    faults: tuple[Fault, ...] = ()
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Campaign:
    """A campaign file, checked against its system."""

    name: str
    path: Path
    description: str
    system: Path
    systems: dict[str, System]  # by variant
    cases: tuple[Case, ...]
    seeds: tuple[int, ...]
    stop: float
    step: float
    algorithm: str
    parameters: dict[str, Any]
    record: tuple[str, ...]
    record_period: float | None
    requirements: tuple[Requirement, ...]

    @property
    def size(self) -> int:
        """How many runs it has."""
        return len(self.systems) * len(self.cases) * len(self.seeds)
