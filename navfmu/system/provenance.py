"""What a result file says about where it comes from: versions, machine, command, time."""

from __future__ import annotations

import platform
import shlex
import sys
from functools import cache
from importlib import metadata
from pathlib import Path

from navfmu import __version__

PACKAGES = ("numpy", "pandas", "fmpy")


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


def command() -> str:
    """The command line of this process, as one would type it."""
    program = Path(sys.argv[0]).name if sys.argv and sys.argv[0] else "python"
    if program in ("__main__.py", "cli.py"):
        program = "python -m navfmu"
    return " ".join([program, *(shlex.quote(argument) for argument in sys.argv[1:])])
