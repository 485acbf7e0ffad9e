"""A hash over all that a built FMU depends on, found without tracing or importing the tools that build it."""

from __future__ import annotations

import hashlib
import importlib.metadata
import sys
import sysconfig
from functools import cache
from pathlib import Path

from navfmu import __version__
from navfmu.export.declaration.component import Component
from navfmu.export.imports import imports

#: Files beside a model's modules that it may read, such as coefficients.
DATA = {".csv", ".json", ".toml", ".txt", ".cof", ".npz", ".npy", ".yaml"}
#: What turns sources into FMUs; another version is another FMU.
_TOOLS = ("ziglang", "numpy", "matplotlib", "pythonfmu", "jinja2")
_INSTALLED = {Path(sysconfig.get_path(key)).resolve() for key in ("stdlib", "platstdlib", "purelib", "platlib")}
_EXPORT = Path(__file__).parent
_ENDINGS = {".py", ".c", ".h", ".txt", ".j2"}  # of the exporter's own files
#: What it takes from other rooms that shows in an FMU.
_BESIDE = [
    file
    for pattern in (
        "errors.py",
        "constants.py",
        "place.py",
        "derivatives/*.py",
        "repetition/*.py",
        "files/archive.py",
        "files/characters.py",
        "fmi/description.py",
        "fmi/names.py",
        "fmi/units.py",
        "report/template.py",
    )
    for file in sorted(_EXPORT.parent.glob(pattern))
]


def fingerprint(component: type[Component], *parts: str) -> str | None:
    """Return a hash of a component's sources (its module and those it imports, data files beside them), of the
    exporter, of the tools' versions and of ``parts``.

    None for a class inside a function: what it does may depend on that function's values.
    """
    if "<locals>" in component.__qualname__:
        return None
    digest = hashlib.sha256()
    layout = component.layout  # its numbers may come from elsewhere than from the sources
    tables = [(table.name, table.digest()) for table in layout.tables]
    declared = repr((layout.variables, tables, getattr(component, "example", None)))
    for part in (component.__qualname__, *parts, _exporter(), declared):
        digest.update(part.encode() + b"\0")
    modules = source_files(component.__module__)
    data = {file for folder in {m.parent for m in modules} for file in folder.iterdir() if file.suffix.lower() in DATA}
    for file in [*sorted(modules), *sorted(data)]:
        _add(digest, file)
    return digest.hexdigest()[:32]


@cache
def _exporter() -> str:
    """Return a hash of the exporter and of the tools' versions."""
    digest = hashlib.sha256("\0".join([__version__, sys.version, *(_version(tool) for tool in _TOOLS)]).encode())
    for file in [*sorted(file for file in _EXPORT.rglob("*") if file.suffix in _ENDINGS), *_BESIDE]:
        _add(digest, file)
    return digest.hexdigest()


def _add(digest: hashlib._Hash, file: Path) -> None:
    content = file.read_bytes()
    digest.update(f"{file.name} {len(content)} ".encode() + content)


def source_files(module: str) -> list[Path]:
    """Return the files of a module and of all it imports, without the standard library and installed packages."""
    return list(sources(module).values())


def sources(module: str) -> dict[str, Path]:
    """Return these files by the names of their modules."""
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        file = _file(name)
        if name in found or file is None:
            continue
        found[name] = file
        waiting += _imports(name, file)
        if "." in name:
            waiting.append(name.rpartition(".")[0])
    return found


@cache
def _file(name: str) -> Path | None:
    """Return the file of an imported module that belongs to the project at hand, else None."""
    text = getattr(sys.modules.get(name), "__file__", None)
    if text is None or not text.endswith(".py") or name.partition(".")[0] == "navfmu":
        return None
    file = Path(text).resolve()
    return None if any(file.is_relative_to(folder) for folder in _INSTALLED) else file


@cache
def _imports(name: str, file: Path) -> tuple[str, ...]:
    return imports(name, file.read_text(encoding="utf-8"))


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
