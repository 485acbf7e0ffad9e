"""Finding components: every subclass of Component that a module in a folder defines."""

from __future__ import annotations

import importlib
import sys
import traceback
from collections.abc import Iterable, Iterator
from pathlib import Path

from navfmu.errors import NavfmuError, nearest
from navfmu.export.declaration.component import Component
from navfmu.files.reading import resolved, what_is


def components(*folders: str | Path) -> dict[str, type[Component]]:
    """Return the components that the modules in ``folders`` define, by name, sorted.

    A folder with ``__init__.py`` is imported as a package from its parent folder, so that its modules can import its
    neighbours; else the folder itself is where imports are looked up. The packages in it are looked through as well.
    Names that begin with an underscore are helpers.
    """
    found: dict[str, type[Component]] = {}
    for folder in folders:
        _look_through(resolved(folder), found)
    return dict(sorted(found.items()))


def _look_through(folder: Path, found: dict[str, type[Component]]) -> None:
    """Add the components in one folder; there is one at least."""
    before = len(found)
    if what_is(folder) != "a folder":
        raise NavfmuError(f"there is no folder {folder}; expected one with modules that define components")
    package = (folder / "__init__.py").is_file()
    root = str(folder.parent if package else folder)
    if root not in sys.path:
        sys.path.insert(0, root)
    for file in _modules(folder):
        module = _import(".".join(file.relative_to(root).with_suffix("").parts), file)
        for item in vars(module).values():
            if not (isinstance(item, type) and issubclass(item, Component)) or item.__module__ != module.__name__:
                continue
            if item.__name__.startswith("_"):
                continue
            name = item.layout.name
            if name in found:
                raise NavfmuError(f"{file}: component '{name}' is defined in {found[name].__module__} too")
            found[name] = item
    if len(found) == before:
        raise NavfmuError(f"no module in {folder} defines a subclass of navfmu.export.Component")


def choose(known: dict[str, type[Component]], names: Iterable[str]) -> list[type[Component]]:
    """Return the components with these names, all of them when there are none."""
    names = list(dict.fromkeys(names))
    for name in names:
        if name not in known:
            raise NavfmuError(
                f"there is no component '{name}'; expected one of {', '.join(known)}{nearest(name, known)}"
            )
    return [known[name] for name in names or known]


def _modules(folder: Path) -> Iterator[Path]:
    for file in sorted(folder.iterdir()):
        if file.name.startswith(("_", ".")):
            continue
        if file.suffix == ".py" and file.is_file():
            yield file
        elif (file / "__init__.py").is_file():
            yield from _modules(file)


def _import(name: str, file: Path):
    try:
        module = importlib.import_module(name)
    except NavfmuError:
        raise
    except Exception as error:
        lines = [line for line in traceback.extract_tb(error.__traceback__) if "importlib" not in line.filename]
        where = f"{lines[-1].filename}, line {lines[-1].lineno}" if lines else str(file)
        if isinstance(error, SyntaxError) and error.filename:
            where = f"{error.filename}, line {error.lineno}"
        raise NavfmuError(f"{where}: {type(error).__name__}: {error}") from error
    if Path(module.__file__ or "").resolve() != file:
        raise NavfmuError(f"{file} cannot be imported: another module '{name}' comes first ({module.__file__})")
    return module
