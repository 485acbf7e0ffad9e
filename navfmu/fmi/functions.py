"""Functions of FMI that an FMU's library may lack: FMI wants all of them, a run only those of what the FMU can do."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from navfmu.errors import NavfmuError
from navfmu.files.archive import MAX_BYTES, names, read_entry

#: By what the description of an FMU claims that it can do.
OPTIONAL = {
    "can_get_and_set_state": ("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate"),
    "can_interpolate_inputs": ("fmi2SetRealInputDerivatives",),
}


def lacking(archive: zipfile.ZipFile, path: Path, identifier: str, abilities: dict[str, bool]) -> Iterator[str]:
    """A sentence for each library of an FMU that lacks functions of what the FMU cannot do.

    No library is loaded for that: the name of each function that one offers stands in it, or in a file beside it;
    where not even the first does, the names cannot be read.
    """
    wanted = [name for ability, names in OPTIONAL.items() if not abilities[ability] for name in names]
    files = [PurePosixPath(name) for name in names(archive, path)]
    for library in files:
        if wanted and library.parts[0] == "binaries" and len(library.parts) == 3 and library.stem == identifier:
            beside = (_contents(archive, str(f), path) for f in files if f.parent == library.parent)
            contents = b"\0".join(beside)
            missing = [name for name in wanted if name.encode() + b"\0" not in contents]
            if missing and b"fmi2Instantiate\0" in contents:
                yield f"{library} has no {', '.join(missing)}"


def _contents(archive: zipfile.ZipFile, name: str, path: Path) -> bytes:
    """A file beside a library, perhaps for another machine: what cannot be read matters only where it is needed."""
    try:
        return read_entry(archive, name, path, MAX_BYTES)
    except NavfmuError:
        return b""
