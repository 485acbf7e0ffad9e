"""A delay as a parameter of a navigator."""

from __future__ import annotations

from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import values_document

NAME = "fix_delay"


def document(delay: float, fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU that takes fixes which are ``delay`` s late; none are early."""
    description = describe(fmu)
    if NAME not in description.by_name:
        raise NavfmuError(f"{fmu}: has no parameter {NAME}; expected a navigator")
    return values_document(description, expand(description, {NAME: max(delay, 0.0)}, str(fmu)), text)
