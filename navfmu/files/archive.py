"""Zip archives (FMU, SSP): written with bytes that depend on their contents alone, read and unpacked safely.

An archive is refused when an entry would land outside its folder, or when it holds more than ``MAX_FILES`` entries or
``MAX_BYTES`` bytes; and of what is read or unpacked, when it is a symbolic link, or there twice with other contents.
"""

from __future__ import annotations

import io
import stat
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path, PurePosixPath

from navfmu.errors import NavfmuError
from navfmu.files import cache
from navfmu.files.digest import check_unchanged
from navfmu.files.reading import regular

MAX_FILES = 20_000
MAX_BYTES = 2 * 1024**3
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


def open_archive(path: Path, kind: str) -> zipfile.ZipFile:
    """Open a zip archive; ``kind`` ("FMU", "SSP") is what the file was expected to be."""
    try:
        return zipfile.ZipFile(regular(path, f"an {kind}, which is a zip archive"))
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: is not an {kind}: {error}") from None


def read_entry(archive: zipfile.ZipFile, name: str, path: Path, limit: int = 64 * 1024**2) -> bytes:
    """One entry of an archive as bytes; at most ``limit`` of them."""
    info = entries(archive, path, lambda entry: entry == name).get(name)
    if info is None:
        raise NavfmuError(f"{path}: has no {name}")
    try:
        with archive.open(info) as source:
            data = source.read(limit + 1)
    except (zipfile.BadZipFile, zlib.error, OSError, RuntimeError, EOFError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: entry {name} is corrupt: {error}") from None
    if len(data) > limit:
        raise NavfmuError(f"{path}: entry {name} is larger than {limit} bytes")
    return data


def names(archive: zipfile.ZipFile, path: Path) -> list[str]:
    """The plain names of the files of an archive, after refusing names and sizes that no honest archive has.

    "./a" and "a" are one name, and so are "a\\b" and "a/b".
    """
    return list(dict.fromkeys(name for name, _ in _files(archive, path)))


def entries(
    archive: zipfile.ZipFile, path: Path, wanted: Callable[[str], bool] = lambda name: True
) -> dict[str, zipfile.ZipInfo]:
    """The wanted files of an archive by their plain names; links, and one name for two contents, are refused."""
    files: dict[str, zipfile.ZipInfo] = {}
    for name, entry in _files(archive, path):
        if not wanted(name):
            continue
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise NavfmuError(f"{path}: entry {entry.filename!r} is a symbolic link, which is not accepted")
        if name in files and not _same(files[name], entry):
            raise NavfmuError(f"{path}: entry {entry.filename!r} appears twice, with different contents")
        files[name] = entry
    return files


def _files(archive: zipfile.ZipFile, path: Path) -> Iterator[tuple[str, zipfile.ZipInfo]]:
    listed = archive.infolist()
    if len(listed) > MAX_FILES:
        raise NavfmuError(f"{path}: holds {len(listed)} entries, at most {MAX_FILES} are accepted")
    total = sum(entry.file_size for entry in listed)
    if total > MAX_BYTES:
        raise NavfmuError(f"{path}: would unpack to {total} bytes, at most {MAX_BYTES} are accepted")
    for entry in listed:
        # zipfile itself cuts a name at a NUL and turns the platform's separator into "/"
        name = entry.filename.replace("\\", "/")
        parts = PurePosixPath(name).parts
        folder = name.endswith("/")
        if name.startswith("/") or ":" in name or ".." in parts or not (parts or folder):
            raise NavfmuError(f"{path}: entry {entry.filename!r} would be written outside its folder")
        if not folder:
            yield "/".join(parts), entry


def _same(one: zipfile.ZipInfo, other: zipfile.ZipInfo) -> bool:
    """Whether two entries hold the same, as far as the archive says; what it says is checked when they are read."""
    return (one.file_size, one.CRC) == (other.file_size, other.CRC)


def habits(archive: zipfile.ZipFile) -> list[str]:
    """What the names in an archive have that they should not have, in sentences."""
    names = archive.namelist()
    found = []
    if any(name.startswith("./") for name in names):
        found.append("names in the archive begin with './'")
    if any("\\" in name for name in names):
        found.append("names in the archive have '\\' between folders, expected '/'")
    return found


def unpack(path: Path, kind: str, digest: str, wanted: Callable[[str], bool] = lambda name: True) -> Path:
    """Unpack the wanted entries of an archive whose content hash is ``digest``; return the folder in the cache."""

    def fill(folder: Path) -> None:
        with open_archive(path, kind) as archive:
            budget = MAX_BYTES
            for name, entry in entries(archive, path, wanted).items():
                budget -= _extract(archive, entry, folder / name, path, budget)
        check_unchanged(path, digest)

    return cache.keep({"FMU": "unpacked", "SSP": "systems"}[kind], digest[:32], fill)


def _extract(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, target: Path, path: Path, budget: int) -> int:
    written = 0
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, open(target, "xb") as file:
            while block := source.read(1 << 20):
                written += len(block)
                if written > budget:
                    raise NavfmuError(f"{path}: unpacks to more than {MAX_BYTES} bytes")
                file.write(block)
    except (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError, NotImplementedError) as error:
        raise NavfmuError(f"{path}: entry {entry.filename} is corrupt: {error}") from None
    except FileExistsError:
        raise NavfmuError(
            f"{path}: entry {entry.filename!r} differs from another one in capital letters alone, or is a file and a "
            "folder: on this machine there is room for one of the two"
        ) from None
    except OSError as error:
        raise NavfmuError(f"{path}: cannot be unpacked to {target}: {error.strerror or error}") from None
    return written
