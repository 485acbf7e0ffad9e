"""What is recorded when nothing is named: the entry ``record`` of the system's report file.

It is read by itself: a run without a report needs nothing else of the file, nor what checks the rest of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from navfmu.errors import NavfmuError
from navfmu.files.toml import Document
from navfmu.fmi.fmu import Fmu
from navfmu.fmi.names import Signal, signals

Fmus = Mapping[str, Fmu]  # of one variant, by component


def default_record(document: Document, fmus: Fmus, others: Callable[[], Sequence[Fmus]] = tuple) -> list[str]:
    """The components, bundles, signals and patterns that the variant with these FMUs has.

    What it does not have, one of the ``others`` (the other variants, opened only then) must have.
    """
    names = document.content.get("record", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise document.error("'record' must be a list of texts", "record")
    for number, name in enumerate(names):
        if not _recordable(name, fmus) and not any(_recordable(name, other) for other in others()):
            raise document.error(f"'record': {unknown(name, fmus)}", "record", number)
    return [name for name in names if _recordable(name, fmus)]


def _recordable(name: str, fmus: Fmus) -> bool:
    """Whether a component, signal, array, bundle or pattern is there."""
    try:
        return bool(_signals(name, fmus))
    except NavfmuError:
        return False


def unknown(name: str, fmus: Fmus) -> str:
    """What is wrong with a name that no variant has, or that stands for several signals."""
    try:
        found = _signals(name, fmus)
    except NavfmuError as error:
        return str(error)
    return f"'{name}' stands for {len(found)} signals; name one, for example '{found[0]}'"


def _signals(name: str, fmus: Fmus) -> list[Signal]:
    descriptions = {component: fmu.description for component, fmu in fmus.items()}
    return signals(descriptions, name.removesuffix("@true"), f"'{name}'")
