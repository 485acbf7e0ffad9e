"""Finds the engine's binary for this machine; in a checkout it is built when its sources have changed.

``python -m navfmu.engine.library [host|all|PLATFORM ...]`` builds binaries, as the wheel needs them.
"""

from __future__ import annotations

import hashlib
import sys
from functools import cache
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.export import toolchain

HERE = Path(__file__).parent
NATIVE = HERE / "native"  # native/<platform tuple>/navfmu_engine-<hash>.so
SOURCE = HERE / "source"
RUNTIME = HERE.parent / "export" / "runtime"  # FMI headers and the noise that FMUs use
UNITS = (*(SOURCE / f"{name}.c" for name in ("master", "jacobi", "gauss_seidel", "callbacks")), RUNTIME / "noise.c")
HEADERS = (
    *(SOURCE / f"{name}.h" for name in ("master", "exchange", "effects")),
    *(RUNTIME / f"{name}.h" for name in ("noise", "fmi2TypesPlatform", "fmi2FunctionTypes")),
)


@cache
def source_hash() -> str:
    """Twelve hexadecimal digits that name the sources and flags."""
    digest = hashlib.sha256(" ".join(toolchain.FLAGS).encode())
    for path in (*UNITS, *HEADERS):
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:12]


def binary(platform: str = "host") -> Path:
    """The engine's library for a platform; built first if there is none of these sources."""
    (target,) = toolchain.resolve(platform)
    path = NATIVE / target / f"navfmu_engine-{source_hash()}{toolchain.suffix(target)}"
    return path if path.exists() else _build(path, target)


def _build(path: Path, target: str) -> Path:
    try:
        toolchain.compile_shared(UNITS, path, target, include=(SOURCE, RUNTIME))
    except NavfmuError as error:
        raise NavfmuError(f"the engine has no binary for {target} and cannot be built: {error}") from None
    except OSError as error:
        raise NavfmuError(f"the engine's binary cannot be written to {path.parent}: {error}") from None
    for old in path.parent.glob("navfmu_engine-*"):
        if old != path:
            old.unlink(missing_ok=True)
    return path


if __name__ == "__main__":
    for name in toolchain.resolve(sys.argv[1:] or "host"):
        print(binary(name))
