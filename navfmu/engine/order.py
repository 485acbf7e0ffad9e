"""The order of things of which some need others first: components that pass values on, variables that depend on others.

Things are numbered from 0 in the order of the system description, which is kept where there is a choice. An edge is
(source, target): the target comes after the source.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from heapq import heapify, heappop, heappush

Edge = tuple[int, int]


def sort(count: int, edges: Iterable[Edge]) -> tuple[list[int], list[Edge]]:
    """Topological order and the edges that were cut to get one.

    A cycle is cut at its first thing in the system description: what that takes from the rest of the cycle comes too
    late for it.
    """
    waiting: list[set[int]] = [set() for _ in range(count)]  # the sources each still waits for
    followers: list[list[int]] = [[] for _ in range(count)]
    cut: list[Edge] = []
    for source, target in sorted(set(edges)):
        if source == target:
            cut.append((source, target))
        else:
            waiting[target].add(source)
            followers[source].append(target)
    ready = [thing for thing in range(count) if not waiting[thing]]
    heapify(ready)
    order: list[int] = []
    while len(order) < count:
        if not ready:
            first = _first_of_a_cycle(waiting)
            cut += [(source, first) for source in sorted(waiting[first])]
            waiting[first].clear()
            ready.append(first)
        done = heappop(ready)
        order.append(done)
        for target in followers[done]:
            if done in waiting[target]:
                waiting[target].remove(done)
                if not waiting[target]:
                    heappush(ready, target)
    return order, cut


def _first_of_a_cycle(waiting: list[set[int]]) -> int:
    """The first thing that waits only for things that wait for it."""
    edges = [(source, target) for target, sources in enumerate(waiting) for source in sources]
    closed = [group for group in cycles(len(waiting), edges) if all(waiting[thing] <= set(group) for thing in group)]
    return min(closed)[0]


def cycles(count: int, edges: Iterable[Edge]) -> list[list[int]]:
    """The sets of things that all need each other, or of one thing that needs itself."""
    known = set(edges)
    return [group for group in _connected(count, known) if len(group) > 1 or (group[0], group[0]) in known]


def groups(count: int, edges: Iterable[Edge]) -> list[list[int]]:
    """Topological order of all things, where those that need each other stand together."""
    known = set(edges)
    found = sorted(_connected(count, known))
    place = {thing: number for number, group in enumerate(found) for thing in group}
    between = {(place[source], place[target]) for source, target in known if place[source] != place[target]}
    return [found[number] for number in sort(len(found), between)[0]]


def _connected(count: int, edges: Collection[Edge]) -> list[list[int]]:
    """Strongly connected components, by Tarjan, SIAM J. Comput. 1 (1972) 146, without recursion."""
    targets: list[list[int]] = [[] for _ in range(count)]
    for source, target in edges:
        targets[source].append(target)
    found: list[list[int]] = []
    number: dict[int, int] = {}  # in which things are met
    low: dict[int, int] = {}  # the first thing met that can be reached from each
    stack: list[int] = []
    open_: set[int] = set()  # those on the stack

    def meet(thing: int) -> tuple[int, Iterator[int]]:
        number[thing] = low[thing] = len(number)
        stack.append(thing)
        open_.add(thing)
        return thing, iter(targets[thing])

    for root in range(count):
        path = [] if root in number else [meet(root)]
        while path:
            thing, others = path[-1]
            for target in others:
                if target not in number:
                    path.append(meet(target))
                    break
                if target in open_:
                    low[thing] = min(low[thing], number[target])
            else:
                path.pop()
                if path:
                    low[path[-1][0]] = min(low[path[-1][0]], low[thing])
                if low[thing] == number[thing]:
                    group = [stack.pop()]
                    while group[-1] != thing:
                        group.append(stack.pop())
                    open_.difference_update(group)
                    found.append(sorted(group))
    return found
