"""Files that a user names, read without surprises: what is not a file with an end is told, and not waited for."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable
from pathlib import Path

from navfmu.errors import NavfmuError, quoted

NOTHING = (errno.ENOENT, errno.ENOTDIR, errno.EBADF, errno.ELOOP)
NOTHING_ON_WINDOWS = (21, 123, 1921)  # a drive without a medium, a name that cannot be one, a link to itself

KINDS: tuple[tuple[Callable[[int], bool], str], ...] = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def what_is(path: str | Path) -> str | None:
    """What is at a path: "a file", or "a folder", "a pipe", "a device" ...; None where there is nothing.

    To be asked of every path that a user names: where the system does not let us see, or takes no such name, ``exists``
    and its kin of ``Path`` raise what no user can read. This is a ``NavfmuError`` then.
    """
    try:
        mode = Path(path).stat().st_mode
    except ValueError:  # a NUL in the name, which no file has
        return None
    except OSError as error:
        if error.errno in NOTHING or getattr(error, "winerror", None) in NOTHING_ON_WINDOWS:
            return None
        raise out_of_reach(path, error) from None
    return next((words for is_it, words in KINDS if is_it(mode)), "a file")


def located(path: str | Path) -> Path:
    """The path as it is from everywhere, without detours."""
    path = Path(path)
    return resolved(path) if path.name in ("", "..") else resolved(path.parent) / path.name


def resolved(path: str | Path) -> Path:
    """The path without links, as far as there are any; one that leads to itself stays."""
    try:
        return Path(os.path.realpath(path))
    except ValueError as error:  # a NUL in the name
        raise out_of_reach(path, error) from None


def regular(path: str | Path, expected: str) -> Path:
    """The path, if it is that of a file with an end; ``expected`` ("a fault file") goes into the sentence if not."""
    if not str(path).strip():
        raise NavfmuError(f"the name of a file is empty; expected that of {expected}")
    path, found = Path(path), what_is(path)
    if found is None:
        raise NavfmuError(f"{path}: no such file; expected {expected}")
    if found != "a file":
        raise NavfmuError(f"{path}: is {found}, expected {expected}")
    return path


def read_bytes(path: str | Path, expected: str, limit: int | None = None) -> bytes:
    """What a file holds, at most ``limit`` bytes; ``expected`` ("a fault file") goes into the sentence if it cannot."""
    path = regular(path, expected)
    try:
        with open(path, "rb") as file:
            data = file.read(-1 if limit is None else limit + 1)
    except OSError as error:
        raise unreadable(path, error) from None
    if limit is not None and len(data) > limit:
        raise NavfmuError(f"{path}: is larger than {limit // 1_000_000} MB, expected {expected}")
    return data


def unreadable(path: Path, error: Exception) -> NavfmuError:
    """The sentence for a file that the system does not let us read."""
    return NavfmuError(f"{quoted(str(path))}: cannot be read: {getattr(error, 'strerror', None) or error}")


def out_of_reach(path: str | Path, error: Exception) -> NavfmuError:
    """The sentence for a path of which the system does not say what is there; of a long one the beginning."""
    return NavfmuError(f"{quoted(str(path))}: cannot be reached: {getattr(error, 'strerror', None) or error}")
