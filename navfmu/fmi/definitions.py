"""Units, display units, types and items of enumerations that a model description defines more than once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from navfmu.errors import NavfmuError

#: Elements that hold definitions, and what stands in them.
HOLDERS = (
    ("UnitDefinitions", "Unit", "unit"),
    ("UnitDefinitions/Unit", "DisplayUnit", "display unit"),
    ("TypeDefinitions", "SimpleType", "type"),
    ("TypeDefinitions/SimpleType/Enumeration", "Item", "item"),
)


def repeated(root: Any, where: str) -> Iterator[str]:
    """A sentence for each definition that stands there again; one that differs from the first is refused."""
    for path, tag, kind in HOLDERS:
        for holder in root.iterfind(path):
            known: dict[str, Any] = {}
            for element in holder.iterfind(tag):
                name, content = element.get("name"), _content(element)
                if known.get(name, content) != content:
                    place = f"{where}, line {element.sourceline}"
                    raise NavfmuError(f"{place}: {kind} '{name}' is defined twice, and differs")
                if name in known:
                    yield f"{kind} '{name}' is defined twice"
                known[name] = content


def _content(element: Any) -> tuple[Any, ...]:
    """What an element says, whatever the spaces, comments and descriptions in it."""
    said = {name: value for name, value in element.attrib.items() if name != "description"}
    return element.tag, said, [_content(child) for child in element if isinstance(child.tag, str)]
