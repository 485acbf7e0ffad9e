"""Keywords of a call, checked by the schema that a file with the same entries has."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from navfmu.errors import NavfmuError


class Keywords:
    """What :func:`navfmu.files.schema.validated` takes of a document, of a call: without lines.

    A name that Python has for itself ends in an underscore: ``from_=300``.
    """

    def __init__(self, call: str, given: Mapping[str, Any]) -> None:
        self.call = call
        self.content = {name.rstrip("_"): _plain(value) for name, value in given.items()}

    def line(self, *place: str | int) -> int:
        """A call has one."""
        return 1

    def error(self, sentence: str, *place: str | int) -> NavfmuError:
        """The sentence, and what was called."""
        return NavfmuError(f"{self.call}: {sentence}")


def _plain(value: Any) -> Any:
    """Numbers and lists of Python for those of NumPy."""
    return value.tolist() if hasattr(value, "tolist") else value
