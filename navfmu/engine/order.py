"""The order in which components run: every component after those it takes values from; cycles are cut."""

from __future__ import annotations

from collections.abc import Iterable


def sort_components(count: int, edges: Iterable[tuple[int, int]]) -> tuple[list[int], list[tuple[int, int]]]:
    """Topological order of components 0 ... count-1 and the edges that were cut to get one.

    ``edges`` are (source, target). Where there is a choice, the order of the system description is kept. A cycle is
    cut at its first component in the system description: what that component takes from the rest of the cycle is one
    communication step old.
    """
    waiting: list[set[int]] = [set() for _ in range(count)]  # the sources each component still waits for
    cut: list[tuple[int, int]] = []
    for source, target in sorted(set(edges)):
        if source == target:
            cut.append((source, target))
        else:
            waiting[target].add(source)
    order: list[int] = []
    left = list(range(count))
    while left:
        ready = next((c for c in left if not waiting[c]), None)
        if ready is None:
            ready = _first_of_a_cycle(left, waiting)
            cut += [(source, ready) for source in sorted(waiting[ready])]
            waiting[ready].clear()
        order.append(ready)
        left.remove(ready)
        for sources in waiting:
            sources.discard(ready)
    return order, cut


def _first_of_a_cycle(left: list[int], waiting: list[set[int]]) -> int:
    """The first component that waits only for components that wait for it."""
    ancestors = {c: _ancestors(c, waiting) for c in left}
    return next(c for c in left if all(c in ancestors[a] for a in ancestors[c]))


def _ancestors(component: int, waiting: list[set[int]]) -> set[int]:
    found: set[int] = set()
    stack = [component]
    while stack:
        for source in waiting[stack.pop()] - found:
            found.add(source)
            stack.append(source)
    return found
