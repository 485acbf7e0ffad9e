"""Finds the engine's binary for this machine; in a checkout it is built when its sources have changed.

``python -m navfmu.engine.library [host|all|PLATFORM ...]`` builds binaries, as the wheel needs them. The compiler is
imported only for building: an installed wheel has the binaries.
"""

from __future__ import annotations

import hashlib
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import library_suffix, platforms

HERE = Path(__file__).parent
NATIVE = HERE / "native"  # native/<platform tuple>/navfmu_engine-<hash>.so
SOURCE = HERE / "source"
EXPORT = HERE.parent / "export"
RUNTIME = EXPORT / "runtime"  # FMI headers and the noise that FMUs use
UNITS = (
    *(
        SOURCE / f"{name}.c"
        for name in ("master", "jacobi", "gauss_seidel", "callbacks", "floating", "layout", "guard")
    ),
    RUNTIME / "noise.c",
)
HEADERS = (
    *(SOURCE / f"{name}.h" for name in ("master", "exchange", "act", "effects", "loss", "program", "trigger")),
    *(SOURCE / f"{name}.h" for name in ("expression", "floating", "initial", "monitor")),
    *(RUNTIME / f"{name}.h" for name in ("noise", "fmi2TypesPlatform", "fmi2FunctionTypes")),
)


def host() -> str:
    """The platform tuple of this machine, such as ``x86_64-linux``."""
    return next(name for name in platforms() if "-" in name)


def sources() -> tuple[Path, ...]:
    """The files of which the binary is made: C units, their headers, and how they are compiled."""
    return (*UNITS, *HEADERS, EXPORT / "toolchain.py")


@cache
def source_hash() -> str:
    """Twelve hexadecimal digits that name the sources and how they are compiled; part of the binary's name."""
    digest = hashlib.sha256()
    for path in sources():
        content = path.read_bytes().replace(b"\r\n", b"\n")
        digest.update(f"{path.name} {len(content)} ".encode() + content)
    return digest.hexdigest()[:12]


@cache
def binary_hash() -> str:
    """A hash of the binary itself: of all that determines its numbers, the version of the compiler included."""
    return hashlib.sha256(binary().read_bytes()).hexdigest()


@cache
def binary() -> Path:
    """The engine's library for this machine; built first if there is none of these sources."""
    path = NATIVE / host() / f"navfmu_engine-{source_hash()}{library_suffix()}"
    return path if path.exists() else build(host())


def build(platform: str, native: Path = NATIVE) -> Path:
    """The engine's library for a platform in the folder ``native``, compiled if there is none of these sources."""
    from navfmu.export import toolchain

    path = native / platform / f"navfmu_engine-{source_hash()}{toolchain.suffix(platform)}"
    if path.exists():
        return path
    try:
        toolchain.compile_shared(UNITS, path, platform, include=(SOURCE, RUNTIME))
    except NavfmuError as error:
        sentence, _, lines = str(error).partition("\n")
        raise NavfmuError(f"the engine has no binary for {platform} and cannot be built: {sentence}", lines) from None
    except OSError as error:
        raise NavfmuError(f"the engine's binary cannot be written to {path.parent}: {error}") from None
    for old in path.parent.glob("navfmu_engine-*"):
        if old != path:
            with suppress(OSError):  # Windows keeps a library that another process has loaded
                old.unlink()
    return path


def build_all(native: Path = NATIVE) -> list[Path]:
    """The engine's libraries for all platforms."""
    from navfmu.export import toolchain

    return [build(platform, native) for platform in toolchain.resolve("all")]


def main(names: list[str]) -> None:
    """Build for "host", "all" or the named platforms."""
    from navfmu.export import toolchain

    for platform in toolchain.resolve(names or "host"):
        print(build(platform))


if __name__ == "__main__":
    main(sys.argv[1:])
