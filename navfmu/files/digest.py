"""What a file holds, as one number: SHA-256."""

from __future__ import annotations

import hashlib
from pathlib import Path

from navfmu.errors import NavfmuError
from navfmu.files.reading import regular, unreadable


def content_hash(path: Path, expected: str = "a file") -> str:
    """SHA-256 of a file in hexadecimal; what is missing, unreadable or not ``expected`` is a sentence."""
    try:
        with open(regular(path, expected), "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise unreadable(path, error) from None


def check_unchanged(path: Path, digest: str) -> None:
    """Refuse a file that has been replaced since it was hashed: the cache would keep the wrong content for good."""
    if content_hash(path) != digest:
        raise NavfmuError(f"{path}: was changed by somebody else while it was read; try again")
