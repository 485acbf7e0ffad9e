"""Named values of a component's parameters, with their source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class ParameterSet:
    """Values of parameters by name, and where they come from: a sentence that goes along with them.

    A component's ``parameter_sets = {"tactical": ParameterSet("Table 3.2, p. 56.", {"drift_sigma": 1.7e-6})}`` are
    written beside its FMU, as files that any tool which reads SSP can give an instance of it.
    """

    source: str
    values: Mapping[str, Any]
