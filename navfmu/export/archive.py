"""The .fmu file: a zip whose bytes depend on its contents alone."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from navfmu.files.archive import zipped
from navfmu.files.reading import what_is
from navfmu.files.writing import write_file

#: Stands in what is generated until the GUID, a hash of it, is known.
NO_GUID = "{00000000-0000-0000-0000-000000000000}"
#: Folders below ``binaries/`` for each platform in FMI 2.0; where it has no name, the platform tuple of FMI 3.0.
FOLDERS = {
    "x86_64-linux": "linux64",
    "aarch64-linux": "aarch64-linux",
    "x86_64-windows": "win64",
    "x86_64-darwin": "darwin64",  # a universal library when both processors are built
    "aarch64-darwin": "aarch64-darwin",
}


def write(path: str | Path, files: Mapping[str, bytes | str]) -> Path:
    """Write a zip of ``files`` (name in the archive -> contents), sorted; a file with the same bytes is left alone."""
    path, content = Path(path), zipped({name: files[name] for name in sorted(files)})
    if what_is(path) == "a file" and path.read_bytes() == content:
        return path
    return write_file(path, content)


def guid(*parts: str | bytes) -> str:
    """Return ``{8-4-4-4-12}`` from a hash of the parts."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    text = digest.hexdigest()
    return f"{{{text[:8]}-{text[8:12]}-{text[12:16]}-{text[16:20]}-{text[20:32]}}}"
