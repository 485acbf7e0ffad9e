"""Tables of an FMU, files of NumPy's format in its resources: read, and replaced without building anything.

An FMU of ours reads its tables when it is instantiated. It accepts its own GUID followed by a dot and a hash, so that
with another table it is another FMU to masters that tell FMUs apart by their GUID.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

import numpy as np

from navfmu.errors import NavfmuError, nearest
from navfmu.files.archive import entries, open_archive, read_entry
from navfmu.files.markup import parse
from navfmu.files.numbers import form, packed, unpacked
from navfmu.files.numbers_as_text import columns
from navfmu.fmi.reading import NAME as DESCRIPTION

FOLDER, SUFFIX = "resources", ".npy"
LIMIT = 1 << 30  # bytes of a table


def contents(path: str | Path) -> dict[str, bytes]:
    """Return all files of an FMU, name -> content."""
    path = Path(path)
    with open_archive(path, "FMU") as archive:
        files = {name: read_entry(archive, name, path, LIMIT) for name in entries(archive, path)}
    if DESCRIPTION not in files:
        raise NavfmuError(f"{path}: has no {DESCRIPTION}; expected an FMU")
    return files


def known(files: Iterable[str]) -> list[str]:
    """Return the names of the tables among the files of an FMU."""
    paths = map(PurePosixPath, files)
    return sorted(path.stem for path in paths if path.parent.as_posix() == FOLDER and path.suffix == SUFFIX)


def read(files: Mapping[str, bytes], name: str, what: str) -> dict[str, np.ndarray]:
    """Return a table, label of a column -> its numbers; ``what`` the files are begins the sentence of what is wrong."""
    names = known(files)
    if name not in names:
        have = ", ".join(names) or "none"
        raise NavfmuError(f"{what}: has no table '{name}'; its tables are: {have}{nearest(name, names)}")
    return unpacked(files[_file(name)], f"{what}: {_file(name)}")


def like(table: Mapping[str, np.ndarray], data: bytes, source: str) -> dict[str, np.ndarray]:
    """Return the numbers of a file, .csv or .npy by the name of its ``source``, with the columns of a table."""
    if source.lower().endswith(SUFFIX):
        found = unpacked(data, source)
    else:
        found = columns(data.decode("utf-8", "replace"), table, source)
    if form(found) != form(table):
        raise NavfmuError(f"{source}: has the columns {form(found)}; expected {form(table)}")
    return found


def replaced(files: Mapping[str, bytes], name: str, table: Mapping[str, np.ndarray], what: str) -> dict[str, bytes]:
    """Return the files of an FMU with these numbers as the table of that name, in the place of another if there is one;
    ``what`` the files are begins the sentence of what is wrong."""
    from lxml import etree

    if not re.fullmatch(r"\w[\w.-]*", name) or ".." in name:
        raise NavfmuError(
            f"{what}: '{name}' cannot be the name of a table; expected letters, digits, '_', '-' and single '.'"
        )
    files = {**files, _file(name): packed(table)}
    digest = hashlib.sha256(b"".join(each.encode() + files[_file(each)] for each in known(files))).hexdigest()
    root = parse(files[DESCRIPTION], f"{what}: {DESCRIPTION}")
    if not root.get("guid"):
        raise NavfmuError(f"{what}: {DESCRIPTION}: has no guid; expected an FMU of FMI 2.0")
    root.set("guid", f"{root.get('guid').split('.')[0]}.{digest[:16]}")
    files[DESCRIPTION] = etree.tostring(root, xml_declaration=True, encoding="UTF-8")
    return files


def _file(name: str) -> str:
    return f"{FOLDER}/{name}{SUFFIX}"
