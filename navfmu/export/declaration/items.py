"""Items of enumerations: names with numbers that leave no gap."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import Any, NoReturn

from navfmu.errors import nearest
from navfmu.export.place import check_text


def numbered(items: type[IntEnum] | Sequence[str], place: str, fail: Callable[[str], NoReturn]) -> dict[str, int]:
    """Return the items with their numbers, in order; ``fail`` raises the error for the declaration."""
    if isinstance(items, type) and issubclass(items, IntEnum):
        found = {item.name: int(item) for item in items}
    elif isinstance(items, list | tuple) and len(set(items)) == len(items):
        found = {name: number for number, name in enumerate(items, 1)}
    else:
        found = {}
    if not found or not all(isinstance(name, str) and name.strip() for name in found):
        fail(f"items are {items!r}, expected names, each of them once, or an IntEnum")
    first, last = extremes(found)
    if sorted(found.values()) != list(range(first, last + 1)):
        told = ", ".join(f"{name} = {number}" for name, number in found.items())
        fail(f"items have the numbers {told}; expected numbers without gaps")
    for name in found:
        check_text(place, "items of an enumeration", name)
    return found


def extremes(items: Mapping[str, int]) -> tuple[int, int]:
    """Return the least and the largest number of an item."""
    return min(items.values()), max(items.values())


def numbers(items: Mapping[str, int], start: Any, fail: Callable[[str], NoReturn]) -> Any:
    """Return start values with the numbers of the items that stand there by name; the first item for None."""
    if start is None:
        return next(iter(items.values()))
    if isinstance(start, str):
        if start not in items:
            fail(f"start is {start!r}, expected one of {', '.join(items)}{nearest(start, items)}")
        return items[start]
    return [numbers(items, part, fail) for part in start] if isinstance(start, list | tuple) else start
