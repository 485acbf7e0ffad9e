"""What numbers depend on beside the experiment: versions, machine, and the package's own sources."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib import metadata
from pathlib import Path

from navfmu import __version__
from navfmu.engine.library import binary_hash

PACKAGES = ("numpy", "pandas", "fmpy")
ROOMS = (
    "constants",
    "errors",
    "files",
    "fmi",
    "ssp",
    "expressions",
    "faults",
    "engine",
    "system",
)  # of the package: what makes a recording
_PACKAGE = Path(__file__).resolve().parents[1]


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    found = [
        ("navfmu", __version__),
        ("python", platform.python_version()),
        ("platform", f"{platform.system()} {platform.machine()}"),
    ]
    found += [(package, metadata.version(package)) for package in PACKAGES]
    return tuple(found)


def versions() -> dict[str, str]:
    """Versions of Python, the machine and the packages that numbers depend on."""
    return dict(_versions())


@cache
def package_hash() -> str:
    """A hash of what makes a recording, in Python and in C: a mended engine makes its runs anew."""
    digest = hashlib.sha256(binary_hash().encode())
    files = (file for ending in ("py", "lark") for file in _PACKAGE.rglob(f"*.{ending}"))
    for file in sorted(file for file in files if _room(file) in ROOMS):
        content = file.read_bytes().replace(b"\r\n", b"\n")
        digest.update(f"{file.relative_to(_PACKAGE).as_posix()} {len(content)} ".encode() + content)
    return digest.hexdigest()[:32]


def _room(file: Path) -> str:
    return file.relative_to(_PACKAGE).parts[0].removesuffix(".py")


def environment() -> dict[str, str]:
    """Everything beside the experiment that could change a recording."""
    return versions() | {"package": package_hash()}
