"""One FMU on disk: its unpacked folder with the library for this machine, and its description.

The description is read and validated once with FMPy (about 30 ms) and kept beside the unpacked folder; later loads
of the same content take about a millisecond and import neither FMPy nor an XML parser.
"""

from __future__ import annotations

import json
import platform
import sys
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.files import cache
from navfmu.files.archive import names, open_archive, unpack
from navfmu.files.digest import check_unchanged, content_hash
from navfmu.fmi.description import Description
from navfmu.fmi.reading import read

FORMAT = 11  # of the cached descriptions; raise it when their content changes
_memory: dict[tuple[str, int, int], Fmu] = {}


@dataclass(frozen=True)
class Fmu:
    """An unpacked FMU whose library can be loaded on this machine."""

    path: Path  # the .fmu file
    digest: str  # SHA-256 of the file
    folder: Path  # unpacked
    library: Path
    description: Description = field(repr=False)


def platforms() -> tuple[str, ...]:
    """Names of this machine's folder under ``binaries``, preferred one first."""
    machine = platform.machine().lower()
    arm = machine in ("arm64", "aarch64")
    wide = sys.maxsize > 2**32
    if sys.platform == "win32":
        return ("aarch64-windows",) if arm else ("win64", "x86_64-windows") if wide else ("win32", "x86-windows")
    if sys.platform == "darwin":
        return ("aarch64-darwin", "darwin64") if arm else ("darwin64", "x86_64-darwin")
    return ("aarch64-linux", "linux-aarch64") if arm else ("linux64", "x86_64-linux") if wide else ("linux32",)


def library_suffix() -> str:
    """File name ending of shared libraries on this machine."""
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def load(path: str | Path) -> Fmu:
    """Unpack an FMU for co-simulation and find its library for this machine."""
    path = Path(path)
    key = _identity(path)
    if key is not None and (known := _memory.get(key)) is not None and known.library.exists():
        return known
    digest = content_hash(path, "an FMU")
    description = _describe(path, digest)
    folder = unpack(path, "FMU", digest, _needed_here)
    fmu = Fmu(path, digest, folder, _library(path, folder, description), description)
    if key is not None:
        _memory[key] = fmu
    return fmu


def describe(path: str | Path) -> Description:
    """The description of an FMU, whether or not it has a library for this machine."""
    path = Path(path)
    return _describe(path, content_hash(path, "an FMU"))


def binaries(path: str | Path) -> list[str]:
    """The platforms for which an FMU holds a library, by their folder names."""
    path = Path(path)
    with open_archive(path, "FMU") as archive:
        return sorted({platform for platform, _ in _libraries(names(archive, path))})


def _libraries(entries: Iterable[str]) -> list[tuple[str, str]]:
    """Platform and file name of everything under ``binaries``."""
    parts = [name.split("/") for name in entries]
    return [(found[1], "/".join(found[2:])) for found in parts if len(found) > 2 and found[0] == "binaries"]


def _identity(path: Path) -> tuple[str, int, int] | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return str(path.resolve()), status.st_size, status.st_mtime_ns


def _needed_here(name: str) -> bool:
    """Whether an entry is of use on this machine: not the other platforms' binaries, sources and documentation."""
    parts = name.split("/")
    if parts[0] == "binaries" and len(parts) > 2:
        return parts[1] in platforms()
    return parts[0] not in ("sources", "documentation")


def _library(path: Path, folder: Path, description: Description) -> Path:
    for name in platforms():
        library = folder / "binaries" / name / (description.model_identifier + library_suffix())
        if library.is_file():
            return library
    with open_archive(path, "FMU") as archive:
        there = _libraries(names(archive, path))
    wanted = description.model_identifier + library_suffix()
    others = [f"{name}/{file}" for name, file in there if name in platforms() and file.endswith(library_suffix())]
    if others:
        raise NavfmuError(
            f"{path}: has no binary {wanted} for this machine ({platforms()[0]}), but there is binaries/"
            f"{', binaries/'.join(others)}: expected the name that modelIdentifier says"
        )
    has = ", ".join(sorted({name for name, _ in there})) or "none at all"
    raise NavfmuError(f"{path}: has no binary for this machine ({platforms()[0]}, {wanted}); it has: {has}")


def _describe(path: Path, digest: str) -> Description:
    key, name = f"{digest[:32]}.v{FORMAT}", "description.json"
    kept = cache.find("described", key)
    if kept is not None:
        with suppress(OSError, ValueError, KeyError, TypeError):
            return Description.of(json.loads((kept / name).read_bytes()))
    content = read(path)
    check_unchanged(path, digest)
    with suppress(NavfmuError):  # a cache that cannot be written costs time, nothing else
        text = json.dumps(content, separators=(",", ":"))
        cache.keep("described", key, lambda folder: (folder / name).write_text(text, encoding="utf-8"))
    return Description.of(content)
