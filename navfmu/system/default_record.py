"""What is recorded when nothing is named: the entry ``record`` of the system's report file.

It is read by itself: a run without a report needs nothing else of the file, nor what checks the rest of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from navfmu.errors import nearest
from navfmu.files.toml import Document
from navfmu.fmi.fmu import Fmu
from navfmu.fmi.names import is_pattern, stands_for
from navfmu.fmi.values import group

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
    component, dot, rest = name.removesuffix("@true").partition(".")
    if is_pattern(name):
        return any(stands_for(name, known) for known in _names(fmus))
    return component in fmus and (not dot or bool(group(fmus[component].description.by_name, rest)))


def unknown(name: str, fmus: Fmus) -> str:
    """What is wrong with a name that no variant has."""
    component, dot, rest = name.removesuffix("@true").partition(".")
    if is_pattern(name):
        return f"no output matches the pattern '{name}'"
    if component not in fmus:
        return f"'{name}': there is no component '{component}'{nearest(component, fmus)}"
    by_name = fmus[component].description.by_name
    members = list(group(by_name, rest).values())
    if dot and members:
        text = f"'{name}' stands for {len(members)} signals; name one"
        return f"{text}, for example '{component}.{members[0]}'"
    bases = {re.split(r"\[", known)[0] for known in by_name} | set(by_name)
    return f"'{name}': {component} has no variable '{rest}'{nearest(rest, sorted(bases))}"


def _names(fmus: Fmus) -> Iterator[str]:
    return (f"{name}.{v.name}" for name, fmu in fmus.items() for v in fmu.description.variables)
