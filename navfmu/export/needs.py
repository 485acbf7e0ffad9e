"""The Python packages that a component calls: without them there is no FMU, and none runs."""

from __future__ import annotations

import importlib.util
import sys

from navfmu.errors import NavfmuError
from navfmu.export.declaration.component import Component


def missing(component: type[Component]) -> list[str]:
    """The packages that a component needs and this Python has not."""
    return [name for name in component.needs if importlib.util.find_spec(name) is None]


def require(component: type[Component]) -> None:
    """Raise the sentence for what is missing."""
    if names := missing(component):
        raise NavfmuError(
            f"'{component.layout.name}' needs the Python package {' and '.join(names)}, which the Python of this "
            f"process ({sys.prefix}) has not; install it there: pip install {' '.join(names)}"
        )
