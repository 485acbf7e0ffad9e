"""What has become of a row, kept as a file: written last, and taken again only for the same sources, FMUs and seed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from navfmu.figures.comparison import Comparison, worst
from navfmu.figures.row import Found, Row
from navfmu.files.digest import content_hash
from navfmu.files.reading import read_bytes, what_is
from navfmu.files.writing import write_file
from navfmu.system.provenance import environment

FAILED = "FAILED"
_PACKAGE = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Answer:
    """A row's comparisons and picture, or the sentence why there are none."""

    row: str
    claim: str
    source: str
    key: str
    comparisons: tuple[Comparison, ...] = ()
    notes: tuple[str, ...] = ()
    words: str = ""
    picture: bytes = b""
    error: str = ""

    @classmethod
    def of(cls, row: Row, key: str, found: Found) -> Answer:
        """That of a row that has found something."""
        found_of = tuple(found.comparisons), tuple(found.notes), found.words, found.picture
        return cls(row.name, row.claim, row.source, key, *found_of)

    @classmethod
    def failed(cls, row: Row, key: str, error: str) -> Answer:
        """That of a row that has not."""
        return cls(row.name, row.claim, row.source, key, error=error)

    @property
    def verdict(self) -> str:
        """The worst of the comparisons, or FAILED."""
        return FAILED if self.error else worst([one.verdict for one in self.comparisons])

    def describe(self) -> dict[str, Any]:
        """As plain data, without the picture."""
        return {
            "row": self.row,
            "verdict": self.verdict,
            "claim": self.claim,
            "source": self.source,
            "error": self.error,
            "comparisons": [one.describe() for one in self.comparisons],
            "notes": list(self.notes),
            "words": self.words,
        }

    def write(self, folder: Path) -> None:
        """Keep it: the picture first, then the words, which name its hash."""
        if self.picture:
            write_file(folder / f"{self.row}.png", self.picture)
        about = self.describe() | {"key": self.key, "picture": hashlib.sha256(self.picture).hexdigest()}
        write_file(folder / f"{self.row}.json", json.dumps(about, indent=2, ensure_ascii=False, allow_nan=False) + "\n")

    @classmethod
    def read(cls, row: Row, key: str, folder: Path) -> Answer | None:
        """What is kept for a row; None where there is nothing, or it is damaged or of other sources."""
        file, picture = folder / f"{row.name}.json", folder / f"{row.name}.png"
        if what_is(file) is None:
            return None
        try:
            about = json.loads(read_bytes(file, "the answer of a row"))
            if about["key"] != key:
                return None
            if about["error"]:
                return cls.failed(row, key, about["error"])
            shown = read_bytes(picture, "the picture of a row") if what_is(picture) is not None else b""
            if hashlib.sha256(shown).hexdigest() != about["picture"]:
                return None
            comparisons = tuple(Comparison.restored(one) for one in about["comparisons"])
            return cls(row.name, row.claim, row.source, key, comparisons, tuple(about["notes"]), about["words"], shown)
        except (ValueError, KeyError, TypeError, AttributeError):
            return None


def key(row: Row, seed: int, fmus: Sequence[Path], folder: Path) -> str:
    """A hash of all that a row's figures depend on: sources, FMUs, seed, machine, versions."""
    about = [row.name, row.claim, row.source, seed, _sources(), _hash(folder), environment()]
    about += [[path.name, content_hash(path)] for path in fmus]
    return hashlib.sha256(json.dumps(about).encode()).hexdigest()[:32]


@cache
def _sources() -> str:
    """Of the whole package: a row may use any of its rooms."""
    return _hash(_PACKAGE)


def _hash(folder: Path) -> str:
    digest = hashlib.sha256()
    for file in sorted(folder.rglob("*.py")):
        content = file.read_bytes().replace(b"\r\n", b"\n")
        digest.update(f"{file.relative_to(folder).as_posix()} {len(content)} ".encode() + content)
    return digest.hexdigest()
