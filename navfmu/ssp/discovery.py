"""Finding systems: every folder that has a ``system.py`` with a function ``source(fmus) -> SystemSource``."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.files.reading import resolved, what_is
from navfmu.ssp.writer import SystemSource


def sources(folder: str | Path, fmus: str | Path) -> dict[Path, SystemSource]:
    """Return the systems below ``folder`` (a package), described with the FMUs in ``fmus``, by their own folder."""
    folder = resolved(folder)
    if what_is(folder) != "a folder":
        raise NavfmuError(f"there is no folder {folder}; expected one with systems")
    if str(folder.parent) not in sys.path:
        sys.path.insert(0, str(folder.parent))
    found: dict[Path, SystemSource] = {}
    for file in sorted(folder.glob("*/system.py")):
        module = importlib.import_module(f"{folder.name}.{file.parent.name}.system")
        if not hasattr(module, "source"):
            raise NavfmuError(f"{file} has no function source(fmus) that returns a SystemSource")
        found[file.parent] = module.source(fmus)
    return found


def pack(folder: str | Path, out: str | Path) -> list[Path]:
    """Pack each system with all its variants to ``out``/NAME.ssp, and each variant alone to ``out``/NAME_VARIANT.ssp.

    A host that reads nothing but SystemStructure.ssd needs the packages of single variants; ours needs only the first.
    """
    packed = []
    for source in sources(folder, out).values():
        packed.append(source.pack(Path(out) / f"{source.name}.ssp"))
        packed += [source.pack(Path(out) / f"{source.name}_{v}.ssp", variant=v) for v in source.variants]
    return packed
