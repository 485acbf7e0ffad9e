"""What an FMU is shown with: an icon, and its example run. A step of its own, which a build can do without.

It needs matplotlib and, for the example, a library that runs on this machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from navfmu.export.declaration.example import Example
from navfmu.export.page.icon import icon
from navfmu.export.page.response import Response, step_response
from navfmu.export.record import ir


@dataclass(frozen=True)
class Illustration:
    """What is shown of one FMU."""

    icon: bytes  # a PNG
    response: Response  # the run of its example


def illustrate(model: ir.Model, guid: str, library: Path, example: Example | None) -> Illustration:
    """Draw the icon and run the example in the library of this machine."""
    return Illustration(icon(model.name), step_response(model, guid, library, example))
