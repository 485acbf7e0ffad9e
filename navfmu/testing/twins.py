"""A system in which some components run in Python, where a debugger sees them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from navfmu.errors import NavfmuError
from navfmu.ssp.structure import Component as Place
from navfmu.system import shipped
from navfmu.system.system import System

if TYPE_CHECKING:
    from navfmu.export import Component


def with_twins(system: System, twins: Sequence[str] | Mapping[str, type[Component]]) -> System:
    """The system with the Python twins of these components; each runs in this process.

    By name alone it is the twin that was built with the FMU, which carries its sources. By the name and its class it is
    made now and runs the class itself, from the files that it was imported from.
    """
    if isinstance(twins, (list, tuple, Mapping)) and not twins:
        return system
    if not isinstance(twins, (list, tuple, Mapping)) or not all(isinstance(name, str) for name in twins):
        raise NavfmuError(f"twins: {twins!r} is no list of components, such as ['imu']")
    components = dict(system.structure.components)
    with TemporaryDirectory(prefix="navfmu-twins-") as folder:
        for name in twins:
            system.known(name, "twins")
            place = components[name]
            file = _live(twins[name], Path(folder)) if isinstance(twins, Mapping) else _built(name, place)
            components[name] = replace(place, source=file)
        return System.of(replace(system.structure, components=components), system.variant)


def _built(name: str, place: Place) -> Path:
    """The twin that stands in the folder ``python`` of what was built."""
    found = shipped.find(f"python/{place.source.name}")
    if found is None:
        raise NavfmuError(
            f"twins: there is no python/{place.source.name} in the folder of built FMUs; build it, or give the class "
            f"of the component: twins={{'{name}': ITS_CLASS}}"
        )
    return found


def _live(component: type[Component], folder: Path) -> Path:
    from navfmu.export import Component
    from navfmu.export.twin import build_twin

    if not isinstance(component, type) or not issubclass(component, Component):
        raise NavfmuError(f"twins: {component!r} is not the class of a component (navfmu.export.Component)")
    return build_twin(component, folder, pictures=False, live=True)
