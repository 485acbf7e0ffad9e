"""One compiler for every platform: ``python -m ziglang cc``.

The wheel ``ziglang`` (extra ``build``) carries clang, the C libraries and the linkers of all five platforms, so that
one machine builds them all. Flags are chosen for equal numbers everywhere: ``-ffp-contract=off`` keeps a*b+c from
becoming a fused operation on some processors only.
"""

from __future__ import annotations

import importlib.util
import os
import platform as _platform
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path

from navfmu.errors import NavfmuError, nearest

#: FMI 3 platform tuple -> zig target; glibc 2.17 is that of 2013, so every living Linux will do.
TARGETS = {
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos.11.0",
    "aarch64-darwin": "aarch64-macos.11.0",
}
#: Names of FMI 2 for the platforms that it knows.
FMI2_NAMES = {"linux64": "x86_64-linux", "win64": "x86_64-windows", "darwin64": "x86_64-darwin"}
SUFFIXES = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}
#: Flags of every build; they are part of the GUID of an FMU.
FLAGS = (
    "-std=c11",
    "-O2",
    "-ffp-contract=off",
    "-fno-math-errno",  # a square root is one instruction; nothing here reads errno
    "-fno-sanitize=undefined",
    "-fvisibility=hidden",
    "-shared",
    "-s",
)


def host() -> str:
    """Return the platform tuple of this machine, such as ``x86_64-linux``."""
    machine = {"amd64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}.get(
        _platform.machine().lower(), _platform.machine().lower()
    )
    return f"{machine}-{_platform.system().lower()}"


def resolve(platforms: str | Iterable[str]) -> tuple[str, ...]:
    """Return platform tuples for ``"host"``, ``"all"`` or names of FMI 2 or FMI 3."""
    names = [platforms] if isinstance(platforms, str) else list(platforms)
    tuples: list[str] = []
    for name in names:
        for item in TARGETS if name == "all" else [host() if name == "host" else FMI2_NAMES.get(name, name)]:
            if item not in TARGETS:
                known = [*TARGETS, *FMI2_NAMES, "host", "all"]
                raise NavfmuError(
                    f"unknown platform '{item}': expected one of {', '.join(known)}{nearest(item, known)}"
                )
            if item not in tuples:
                tuples.append(item)
    return tuple(tuples)


def suffix(platform: str) -> str:
    """Return the suffix of a shared library on a platform, ``.so``, ``.dll`` or ``.dylib``."""
    return SUFFIXES[resolve(platform)[0].split("-")[1]]


@cache
def version() -> str:
    """Return the version of the compiler wheel, without starting it."""
    if importlib.util.find_spec("ziglang") is None:
        raise NavfmuError(
            "the compiler is missing: expected the package 'ziglang'; install navfmu with its extra 'build', "
            'for example  pip install -e ".[build]"  in a checkout'
        )
    from importlib.metadata import version as installed

    return installed("ziglang")


def compile_shared(
    sources: Sequence[str | Path],
    output: str | Path,
    platform: str = "host",
    include: Sequence[str | Path] = (),
    flags: Sequence[str] = (),
) -> Path:
    """Compile C sources into one shared library for a platform and return its path.

    ``include`` are directories with headers, ``flags`` come after :data:`FLAGS`. The library appears at ``output``
    only when it is complete, and nothing else (``.pdb``, ``.lib``) is left beside it. Raises
    :class:`~navfmu.errors.NavfmuError` with the compiler's own words when it fails.
    """
    version()
    (target,) = resolve(platform)
    output = Path(output).resolve()
    output.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="navfmu-", dir=output.parent, ignore_cleanup_errors=True) as scratch:
        result = Path(scratch) / output.name
        command = [sys.executable, "-m", "ziglang", "cc", "-target", TARGETS[target], *FLAGS]
        if "darwin" in target:
            command.append(f"-Wl,-install_name,@rpath/{output.name}")
        command += [f"-I{Path(folder).resolve()}" for folder in include]
        command += [*flags, *(str(Path(source).resolve()) for source in sources), "-o", str(result)]
        if "windows" not in target:
            command.append("-lm")
        done = subprocess.run(command, cwd=scratch, capture_output=True, text=True, check=False)
        if done.returncode or not result.is_file():
            names = ", ".join(Path(source).name for source in sources)
            raise NavfmuError(f"the compiler failed on {names} for {target}:", done.stderr.strip()[-4000:])
        os.replace(result, output)
    return output


def universal(images: Sequence[bytes]) -> bytes:
    """Join macOS libraries for several processors into one universal library (what ``lipo -create`` does)."""
    align = 14  # each begins at a multiple of 2^14 bytes, the page size of Apple's processors
    page = 1 << align
    header, body = struct.pack(">II", 0xCAFEBABE, len(images)), b""
    for image in images:
        magic, cpu, subtype = struct.unpack_from("<IiI", image)
        if magic != 0xFEEDFACF:
            raise NavfmuError("a universal library can only be made of 64-bit Mach-O libraries")
        body += b"\0" * (-len(body) % page)
        header += struct.pack(">iIIII", cpu, subtype, page + len(body), len(image), align)
        body += image
    return header.ljust(page, b"\0") + body
