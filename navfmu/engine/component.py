"""An instance of an FMU as the master and faults see it: its variables and its start values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from navfmu.fmi.description import Description
from navfmu.fmi.fmu import Fmu


@dataclass(frozen=True)
class Component:
    """An FMU instance of a system: an unpacked FMI 2.0 co-simulation FMU and its start values."""

    name: str
    fmu: Fmu
    start: Mapping[str, Any] = field(default_factory=dict)  # parameters and inputs, set before initialisation

    @property
    def description(self) -> Description:
        """What its FMU says about itself."""
        return self.fmu.description

    @property
    def restores(self) -> bool:
        """Whether a state can be saved and restored."""
        return self.description.can_get_and_set_state
