"""What a file holds, as one number: SHA-256."""

from __future__ import annotations

import hashlib
from pathlib import Path

from navfmu.errors import NavfmuError


def content_hash(path: Path) -> str:
    """SHA-256 of a file in hexadecimal; a missing or unreadable file is a sentence."""
    if path.exists() and not path.is_file():
        raise NavfmuError(f"{path}: cannot be read: it is not a file with an end")
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError:
        raise NavfmuError(f"{path}: no such file") from None
    except OSError as error:
        raise NavfmuError(f"{path}: cannot be read: {error.strerror or error}") from None


def check_unchanged(path: Path, digest: str) -> None:
    """Refuse a file that has been replaced since it was hashed: the cache would keep the wrong content for good."""
    if content_hash(path) != digest:
        raise NavfmuError(f"{path}: was changed by somebody else while it was read; try again")
