"""The user's cache: what can be made again from FMUs, packages and components, kept so that it need not be.

CACHE/KIND/KEY/content/...      an entry; KEY is a hash of all that its content depends on
CACHE/KIND/KEY/sums.json        sizes and SHA-256 of its files
CACHE/.used                     locked by each process that uses the cache

An entry appears complete or not at all, and is used only while it is what was put there: one that was cut short,
changed or emptied is made anew. What nobody has used for a month is removed.
"""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError, quoted
from navfmu.files.digest import content_hash
from navfmu.files.reading import out_of_reach, what_is

try:
    import fcntl
except ImportError:  # Windows, where what is open cannot be removed anyway
    fcntl = None  # type: ignore[assignment]

KINDS = {
    "unpacked": "unpacked FMUs",
    "described": "descriptions of FMUs",
    "systems": "unpacked systems",
    "built": "built FMUs",
    "compiled": "compiled libraries",
}
EARLIER = ("fmu", "ssp", "fmus", "libraries")  # folders of earlier versions, without sums
KEEP = 30 * 86400.0  # s
CONTENT, SUMS, USED = "content", "sums.json", ".used"
_KEY = re.compile(r"[0-9a-f]{32}\b.*")

Stamps = dict[str, tuple[int, int]]  # size and time of change of each file of a content
_checked: dict[Path, Stamps] = {}  # what this process has found intact
_used: dict[Path, int] = {}  # the locks of this process, as files that stay open until it ends


def directory() -> Path:
    """The user's cache folder of this project; ``NAVFMU_CACHE`` overrides it."""
    override = os.environ.get("NAVFMU_CACHE")
    if override:
        return _absolute(override)
    from platformdirs import user_cache_path

    return user_cache_path("navfmu", appauthor=False)


@functools.cache
def _absolute(name: str) -> Path:
    """A folder as it was seen first: an FMU may make another one the current one."""
    return Path(name).absolute()


def folder() -> Path:
    """The cache folder, which may be missing but not be something else."""
    home, found = directory(), what_is(directory())
    if found not in ("a folder", None):
        raise NavfmuError(f"{home}: is {found}, expected the folder of the cache; set NAVFMU_CACHE to one")
    return home


# ---- entries ---------------------------------------------------------------------------------------------------------


def find(kind: str, key: str) -> Path | None:
    """The folder with the content of an entry; None when there is none or it is damaged."""
    entry = directory() / kind / key
    _use(directory())
    if not _intact(entry):
        return None
    with suppress(OSError):
        os.utime(entry)
    return entry / CONTENT


def keep(kind: str, key: str, fill: Callable[[Path], None]) -> Path:
    """Like ``find``, and what is missing or damaged is made: ``fill`` is given an empty folder."""
    found = find(kind, key)
    if found is not None:
        return found
    entry = directory() / kind / key
    try:
        _make(entry, fill)
    except OSError as error:  # also of a full disk, which lets one make a file and not write into it
        raise NavfmuError(
            f"{quoted(str(entry.parent))}: the cache folder cannot be written: {error.strerror or error}; "
            "set NAVFMU_CACHE to a folder that can"
        ) from None
    for folder in (kind, *EARLIER):
        _forget_old(directory() / folder)
    return entry / CONTENT


def _make(entry: Path, fill: Callable[[Path], None]) -> None:
    """Make an entry beside its place, and put it there."""
    entry.parent.mkdir(parents=True, exist_ok=True)
    _use(directory())
    temporary = Path(tempfile.mkdtemp(prefix=".", dir=entry.parent))
    try:
        (temporary / CONTENT).mkdir()
        fill(temporary / CONTENT)
        sums = {
            name: [size, content_hash(temporary / CONTENT / name)] for name, (size, _) in _stamps(temporary).items()
        }
        (temporary / SUMS).write_text(json.dumps(sums, indent=1), encoding="utf-8")
        _publish(temporary, entry)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _intact(entry: Path) -> bool:
    """Whether an entry is what was put there; its bytes are read once in a process, unless a file was touched since."""
    try:
        stamps = _stamps(entry)
        if _checked.get(entry) == stamps:
            return True
        sums: dict[str, Any] = json.loads((entry / SUMS).read_bytes())
        sizes = {name: size for name, (size, _) in stamps.items()}
        if sizes != {name: size for name, (size, _) in sums.items()}:
            return False
        if any(content_hash(entry / CONTENT / name) != digest for name, (_, digest) in sums.items()):
            return False
    except (OSError, ValueError, TypeError, AttributeError, NavfmuError):
        return False
    _checked[entry] = stamps
    return True


def _stamps(entry: Path) -> Stamps:
    """Every file of an entry's content, by its name there with slashes."""
    found: Stamps = {}
    waiting = [("", entry / CONTENT)]
    while waiting:
        prefix, folder = waiting.pop()
        with os.scandir(folder) as inside:
            for item in inside:
                if item.is_dir(follow_symlinks=False):
                    waiting.append((f"{prefix}{item.name}/", Path(item.path)))
                else:
                    status = item.stat(follow_symlinks=False)
                    found[prefix + item.name] = (status.st_size, status.st_mtime_ns)
    return found


def _publish(temporary: Path, entry: Path) -> None:
    """Give a finished entry its name; a damaged one makes way, one that another process was first with stays."""
    for attempt in range(3):
        try:
            os.rename(temporary, entry)
            return
        except OSError as error:
            if _intact(entry):
                return
            if attempt == 2 or not _remove(entry):
                raise NavfmuError(
                    f"{entry}: is damaged and cannot be replaced: {error.strerror or error}; remove this folder"
                ) from None


def _remove(entry: Path) -> bool:
    """Remove an entry as a whole: first out of the way, so that nobody finds it half removed."""
    gone = entry.with_name(f".{entry.name.lstrip('.')}.{os.getpid()}.{time.monotonic_ns()}.gone")
    try:
        entry.rename(gone)
    except OSError:
        return not entry.exists()
    if gone.is_dir():
        shutil.rmtree(gone, ignore_errors=True)
    else:
        gone.unlink(missing_ok=True)
    return True


def _forget_old(home: Path) -> None:
    """Remove what nobody has used for a while: each build of an FMU leaves an entry here."""
    with suppress(OSError):
        for entry in home.iterdir():
            if time.time() - entry.stat().st_mtime > KEEP:
                _remove(entry)


# ---- seen from outside -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Holding:
    """What a cache has of one kind."""

    what: str
    entries: int
    bytes: int
    damaged: tuple[Path, ...] = ()  # also what an interrupted process left behind


def holdings() -> list[Holding]:
    """What the cache has, by kind; every entry is verified."""
    home, found = folder(), []
    for kind, what in KINDS.items():
        entries = _own(home / kind)
        damaged = tuple(entry for entry in entries if not _intact(entry))
        found.append(Holding(what, len(entries), _size(entries), damaged))
    earlier = [entry for kind in EARLIER for entry in _own(home / kind)]
    return [*found, Holding("of earlier versions", len(earlier), _size(earlier))] if earlier else found


def _size(entries: Sequence[Path]) -> int:
    inside = (file for entry in entries for file in ([entry] if entry.is_file() else entry.rglob("*")))
    return sum(file.stat().st_size for file in inside if file.is_file())


def clear() -> int:
    """Remove all entries and return how many there were; nothing else is touched."""
    home = folder()
    strange = sorted(path.name for path in _inside(home) if path.name not in (*KINDS, *EARLIER, USED))
    if strange:
        raise NavfmuError(f"{home}: is no cache of navfmu: it holds '{strange[0]}'; nothing was removed")
    if what_is(home) is None:
        return 0
    with _alone(home):
        kinds = (*KINDS, *EARLIER)
        entries = [entry for kind in kinds for entry in _own(home / kind)]
        removed = sum(_remove(entry) for entry in entries)
        for kind in kinds:
            with suppress(OSError):  # something else is in it
                (home / kind).rmdir()
    if removed < len(entries):
        raise NavfmuError(f"{home}: {len(entries) - removed} of {len(entries)} entries are in use and stay")
    return removed


def _own(home: Path) -> list[Path]:
    """The entries of a kind, unfinished ones included; what cannot be one is left out."""
    return [path for path in _inside(home) if path.name.startswith(".") or _KEY.fullmatch(path.name)]


def _inside(home: Path) -> list[Path]:
    """What a folder holds; nothing where there is none."""
    try:
        return sorted(home.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        raise out_of_reach(home, error) from None


# ---- several processes -----------------------------------------------------------------------------------------------


def _use(home: Path) -> None:
    """Tell other processes, until this one ends, that the cache is used."""
    if fcntl is None or home in _used:
        return
    with suppress(OSError):  # a folder that is missing, or cannot be written, or locked
        lock = os.open(home / USED, os.O_WRONLY | os.O_CREAT, 0o666)
        try:
            fcntl.flock(lock, fcntl.LOCK_SH)
        except OSError:
            os.close(lock)
            raise
        _used[home] = lock


class _alone:
    """While no other process uses the cache."""

    def __init__(self, home: Path) -> None:
        self.home = home

    def __enter__(self) -> None:
        _use(self.home)
        if self.home in _used:
            try:
                fcntl.flock(_used[self.home], fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise NavfmuError(
                    f"{self.home}: another process of navfmu uses this cache; clear it when that has ended"
                ) from None

    def __exit__(self, *_: object) -> None:
        if self.home in _used:
            fcntl.flock(_used[self.home], fcntl.LOCK_SH)
