"""What a file of satellite navigation holds, however it is packed: by gzip, by compress, by Hatanaka's method."""

from __future__ import annotations

import gzip
import io
import warnings
import zlib
from pathlib import Path

from navfmu.errors import NavfmuError, quoted
from navfmu.files.reading import read_bytes

LIMIT = 1 << 30  # bytes
GZIP, COMPRESS = b"\x1f\x8b", b"\x1f\x9d"
HATANAKA = b"CRINEX VERS"
"""In the first line of an observation file that is packed by Y. Hatanaka's method, which is text."""


def unpacked(path: Path, expected: str) -> bytes:
    """The file's content; ``expected`` ("a YUMA almanac") goes into the sentence if there is none."""
    data = read_bytes(path, expected, LIMIT)
    if data.startswith(GZIP):
        data = _by_gzip(path, data, expected)
    if data.startswith(COMPRESS) or is_hatanaka(data):
        data = _by_hatanaka(path, data, expected)
    if len(data) > LIMIT:
        raise NavfmuError(f"{path}: is larger than {LIMIT // 1_000_000} MB, expected {expected}")
    return data


def is_hatanaka(data: bytes) -> bool:
    """Whether content is packed by Hatanaka's method."""
    return HATANAKA in data[:80]


def _by_gzip(path: Path, data: bytes, expected: str) -> bytes:
    try:
        return gzip.GzipFile(fileobj=io.BytesIO(data)).read(LIMIT + 1)
    except (EOFError, OSError, zlib.error) as error:
        raise _damaged(path, error, expected) from None


def _by_hatanaka(path: Path, data: bytes, expected: str) -> bytes:
    """By Hatanaka's program, in a package that unpacks compress, too."""
    try:
        import hatanaka
    except ImportError:
        what = "Hatanaka's method" if is_hatanaka(data) else "compress (.Z)"
        raise NavfmuError(
            f"{path}: is packed by {what}, which the package hatanaka unpacks, that is not installed: "
            f"pip install 'navfmu[rinex]'; or expected {expected}, as text or packed by gzip"
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # it warns of what it leaves out
            return hatanaka.decompress(data)
    except (RuntimeError, ValueError, UserWarning, zlib.error) as error:
        raise _damaged(path, error, expected) from None


def _damaged(path: Path, error: Exception, expected: str) -> NavfmuError:
    why = quoted(" ".join(str(error).split()))
    return NavfmuError(f"{path}: cannot be unpacked: {why}; expected {expected}, all of it")
