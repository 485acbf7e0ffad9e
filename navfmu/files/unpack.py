"""Unpacks archives (FMU, SSP) safely, once for each content, into a cache directory of the user.

An archive is refused when an entry would land outside its folder, is a symbolic link, appears twice, or when it holds
more than ``MAX_FILES`` entries or ``MAX_BYTES`` bytes. A folder appears in the cache complete or not at all: it is
written under a temporary name and then renamed.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import stat
import sys
import tempfile
import time
import zipfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path, PurePosixPath

from navfmu.errors import NavfmuError

MAX_FILES = 20_000
MAX_BYTES = 2 * 1024**3
KEEP = 30 * 86400.0  # s


def cache_directory() -> Path:
    """The user's cache folder of this project; ``NAVFMU_CACHE`` overrides it."""
    override = os.environ.get("NAVFMU_CACHE")
    if override:
        return Path(override)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "navfmu"


def content_hash(path: Path) -> str:
    """SHA-256 of a file in hexadecimal; a missing or unreadable file is a sentence."""
    digest = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
    except FileNotFoundError:
        raise NavfmuError(f"{path}: no such file") from None
    except OSError as error:
        raise NavfmuError(f"{path}: cannot be read: {error.strerror or error}") from None
    return digest.hexdigest()


def check_unchanged(path: Path, digest: str) -> None:
    """Refuse a file that has been replaced since it was hashed: the cache would keep the wrong content for good."""
    if content_hash(path) != digest:
        raise NavfmuError(f"{path}: was changed by somebody else while it was read; try again")


def open_archive(path: Path, kind: str) -> zipfile.ZipFile:
    """Open a zip archive; ``kind`` ("FMU", "SSP") is what the file was expected to be."""
    if not path.exists():
        raise NavfmuError(f"{path}: no such file (expected an {kind})")
    if path.is_dir():
        raise NavfmuError(f"{path}: is a folder, expected an {kind}, which is a zip archive")
    try:
        return zipfile.ZipFile(path)
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: is not an {kind}: {error}") from None


def read_entry(archive: zipfile.ZipFile, name: str, path: Path, limit: int = 64 * 1024**2) -> bytes:
    """One entry of an archive as bytes; at most ``limit`` of them."""
    try:
        info = archive.getinfo(name)
    except KeyError:
        raise NavfmuError(f"{path}: has no {name}") from None
    try:
        with archive.open(info) as source:
            data = source.read(limit + 1)
    except (zipfile.BadZipFile, zlib.error, OSError, RuntimeError, EOFError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: entry {name} is corrupt: {error}") from None
    if len(data) > limit:
        raise NavfmuError(f"{path}: entry {name} is larger than {limit} bytes")
    return data


def check_entries(archive: zipfile.ZipFile, path: Path) -> list[zipfile.ZipInfo]:
    """The files of an archive, after refusing names and sizes that no honest archive has."""
    entries = archive.infolist()
    if len(entries) > MAX_FILES:
        raise NavfmuError(f"{path}: holds {len(entries)} entries, at most {MAX_FILES} are accepted")
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        raise NavfmuError(f"{path}: would unpack to {total} bytes, at most {MAX_BYTES} are accepted")
    seen: set[str] = set()
    for entry in entries:
        # zipfile itself cuts a name at a NUL and turns the platform's separator into "/"
        name = entry.filename
        parts = PurePosixPath(name).parts
        if not parts or name.startswith("/") or "\\" in name or ":" in name or ".." in parts:
            raise NavfmuError(f"{path}: entry {name!r} would be written outside its folder")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise NavfmuError(f"{path}: entry {name!r} is a symbolic link, which is not accepted")
        folded = name.rstrip("/").casefold()
        if folded in seen:
            raise NavfmuError(f"{path}: entry {name!r} appears twice")
        seen.add(folded)
    return [entry for entry in entries if not entry.is_dir()]


def unpack(path: Path, kind: str, digest: str, wanted: Callable[[str], bool] = lambda name: True) -> Path:
    """Unpack the wanted entries of an archive whose content hash is ``digest``; return the folder in the cache."""
    folder = cache_directory() / kind.lower() / digest[:32]
    if folder.is_dir():
        with suppress(OSError):
            os.utime(folder)  # in use
        return folder
    with open_archive(path, kind) as archive:
        entries = check_entries(archive, path)
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            temporary = Path(tempfile.mkdtemp(prefix=".", dir=folder.parent))
        except OSError as error:
            raise NavfmuError(
                f"{folder.parent}: the cache folder cannot be written: {error.strerror}; "
                "set NAVFMU_CACHE to a folder that can"
            ) from None
        try:
            budget = MAX_BYTES
            for entry in entries:
                if wanted(entry.filename):
                    budget -= _extract(archive, entry, temporary, path, budget)
            check_unchanged(path, digest)
            _publish(temporary, folder)
            _forget_old(folder.parent)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    return folder


def _extract(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, folder: Path, path: Path, budget: int) -> int:
    target = folder.joinpath(*PurePosixPath(entry.filename).parts)
    written = 0
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, open(target, "wb") as file:
            while block := source.read(1 << 20):
                written += len(block)
                if written > budget:
                    raise NavfmuError(f"{path}: unpacks to more than {MAX_BYTES} bytes")
                file.write(block)
    except (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: entry {entry.filename} is corrupt: {error}") from None
    except OSError as error:
        raise NavfmuError(f"{path}: cannot be unpacked to {folder}: {error.strerror or error}") from None
    return written


def _publish(temporary: Path, folder: Path) -> None:
    try:
        os.rename(temporary, folder)
    except OSError:
        if not folder.is_dir():  # another process or thread may have been first, with the same content
            raise


def _forget_old(folder: Path) -> None:
    """Remove what nobody has used for a while: each build of an FMU leaves a folder here."""
    with suppress(OSError):
        for entry in folder.iterdir():
            if time.time() - entry.stat().st_mtime <= KEEP:
                continue
            if entry.is_dir():  # first out of the way, so that nobody finds a folder that is half removed
                gone = entry.with_name(f".{entry.name}.gone")
                entry.rename(gone)
                shutil.rmtree(gone, ignore_errors=True)
            else:
                entry.unlink()
