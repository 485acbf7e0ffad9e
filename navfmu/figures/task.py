"""What a row is given to work with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from navfmu.errors import NavfmuError, nearest


def _silent(done: int, total: int) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True)
class Task:
    """``seed`` decides all that is random in a row; ``folder`` is an empty one for what it builds.

    ``progress`` may be called with what is done and all of it.
    """

    seed: int
    folder: Path
    fmus: dict[str, Path]
    progress: Callable[[int, int], None] = _silent

    def fmu(self, name: str) -> Path:
        """The built FMU of a name that the row has declared: what is not declared, a kept result does not depend on."""
        if name not in self.fmus:
            raise NavfmuError(
                f"the row uses '{name}' and does not declare it{nearest(name, self.fmus)} "
                f"(declared: {', '.join(self.fmus) or 'nothing'})"
            )
        return self.fmus[name]
