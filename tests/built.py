"""The project's own FMUs, built for this machine once per test session."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from functools import cache
from pathlib import Path

import fmus
from navfmu.export import Component
from navfmu.export.build import build


@cache
def components() -> dict[str, type[Component]]:
    """Every component declared in the folder fmus, by the name of its FMU."""
    found = {}
    for info in pkgutil.walk_packages(fmus.__path__, "fmus."):
        module = importlib.import_module(info.name)
        for _, item in inspect.getmembers(module, inspect.isclass):
            if issubclass(item, Component) and item.__module__ == module.__name__:
                found[item.layout.name] = item
    return found


_folder: list[Path] = []


def folder(factory) -> Path:
    """The folder of this session's FMUs; ``factory`` is pytest's ``tmp_path_factory``."""
    if not _folder:
        _folder.append(factory.mktemp("fmus"))
    return _folder[0]


def fmu(name: str, factory) -> Path:
    """The native FMU of that name."""
    path = folder(factory) / f"{name}.fmu"
    if not path.is_file():
        build([components()[name]], path.parent)
    return path
