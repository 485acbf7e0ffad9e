"""The .fmu file: a zip whose bytes depend on its contents alone."""

from __future__ import annotations

import hashlib
import os
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

#: Folders below ``binaries/`` for each platform in FMI 2.0; where it has no name, the platform tuple of FMI 3.0.
FOLDERS = {
    "x86_64-linux": "linux64",
    "aarch64-linux": "aarch64-linux",
    "x86_64-windows": "win64",
    "x86_64-darwin": "darwin64",  # a universal library when both processors are built
    "aarch64-darwin": "aarch64-darwin",
}


def write(path: str | Path, files: Mapping[str, bytes | str]) -> Path:
    """Write a zip of ``files`` (name in the archive -> contents): sorted, with fixed dates and rights.

    An existing file with the same bytes is left alone, and a new one appears only when it is complete.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, scratch = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for name in sorted(files):
                entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = 3  # Unix, whatever machine this is
                entry.external_attr = 0o100644 << 16
                data = files[name]
                archive.writestr(entry, data.encode() if isinstance(data, str) else data)
        place(scratch, path)
    finally:
        if os.path.exists(scratch):
            os.unlink(scratch)
    return path


def place(source: str | Path, target: Path) -> None:
    """Move a finished file to its place, unless the same bytes are there already."""
    new = Path(source).read_bytes()
    if target.is_file() and target.stat().st_size == len(new) and target.read_bytes() == new:
        os.unlink(source)
        return
    os.chmod(source, 0o644)
    os.replace(source, target)


def guid(*parts: str | bytes) -> str:
    """Return ``{8-4-4-4-12}`` from a hash of the parts."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    text = digest.hexdigest()
    return f"{{{text[:8]}-{text[8:12]}-{text[12:16]}-{text[16:20]}-{text[20:32]}}}"


def icon(name: str) -> bytes:
    """Return a PNG of a compass needle on a disc whose colour comes from the name."""
    size = 96
    y, x = np.mgrid[0:size, 0:size] * (2 / (size - 1)) - 1
    radius, angle = np.hypot(x, y), np.deg2rad(35.0)
    along, across = x * np.sin(angle) - y * np.cos(angle), x * np.cos(angle) + y * np.sin(angle)
    edge = size / 2  # one pixel of smoothing at edges

    def inside(distance: np.ndarray) -> np.ndarray:
        return np.clip(0.5 - distance * edge, 0.0, 1.0)[..., None]

    hue = hashlib.sha256(name.encode()).digest()[0] / 256 * 2 * np.pi
    colour = 95 + 50 * np.cos(hue + np.array([0.0, 2.1, 4.2]))
    image = np.zeros((size, size, 4))
    for mask, rgb in (
        (inside(radius - 0.98), colour),
        (inside(np.abs(radius - 0.84) - 0.025), np.full(3, 255.0)),
        (inside(4.2 * np.abs(across) + along - 0.72) * (along >= 0)[..., None], np.full(3, 255.0)),
        (inside(4.2 * np.abs(across) - along - 0.72) * (along < 0)[..., None], np.full(3, 30.0)),
    ):
        image[..., :3] = image[..., :3] * (1 - mask) + rgb * mask
        image[..., 3:] = np.maximum(image[..., 3:], 255 * mask)
    pixels = np.rint(image).astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", size, size, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
