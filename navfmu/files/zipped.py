"""Zip archives (FMU, SSP) whose bytes depend on their contents alone: fixed dates and rights, in the order given."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

DATE = (1980, 1, 1, 0, 0, 0)  # the first that a zip archive can hold
UNIX = 3  # "made on", whatever machine this is
RIGHTS = 0o100644 << 16


def zipped(files: Mapping[str, bytes | str], stored: str | None = None) -> bytes:
    """An archive of ``files`` (name -> contents) in their order; names that end with ``stored`` are not compressed."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, DATE)
            entry.create_system, entry.external_attr = UNIX, RIGHTS
            plain = stored is not None and name.endswith(stored)
            entry.compress_type = zipfile.ZIP_STORED if plain else zipfile.ZIP_DEFLATED
            archive.writestr(entry, data.encode() if isinstance(data, str) else data)
    return buffer.getvalue()
