"""Components run after those they take values from."""

import random

from navfmu.engine.order import cycles, groups, sort


def test_a_chain_given_backwards_is_sorted():
    assert sort(4, [(3, 2), (2, 1), (1, 0)]) == ([3, 2, 1, 0], [])


def test_the_order_of_the_description_is_kept_where_it_can_be():
    assert sort(4, [(0, 3)]) == ([0, 1, 2, 3], [])


def test_a_ring_is_cut_at_its_first_component():
    order, cut = sort(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
    assert order == [0, 1, 2, 3]
    assert cut == [(3, 0)]


def test_a_cycle_is_cut_at_its_own_first_component_not_at_one_behind_it():
    order, cut = sort(4, [(2, 3), (3, 2), (3, 0), (0, 1)])  # 0 and 1 wait for the cycle 2 <-> 3
    assert order == [2, 3, 0, 1]
    assert cut == [(3, 2)]


def test_two_cycles_in_a_row_are_cut_once_each():
    order, cut = sort(5, [(0, 1), (1, 0), (1, 2), (2, 3), (3, 2), (3, 4)])
    assert order == [0, 1, 2, 3, 4]
    assert cut == [(1, 0), (3, 2)]


def test_a_component_that_feeds_itself_is_cut():
    assert sort(2, [(1, 1), (0, 1)]) == ([0, 1], [(1, 1)])


def test_things_that_need_each_other_stand_together():
    edges = [(0, 1), (1, 2), (2, 0), (3, 2), (2, 4), (4, 4)]
    assert groups(6, edges) == [[3], [0, 1, 2], [4], [5]]
    assert sorted(cycles(6, edges)) == [[0, 1, 2], [4]]
    assert groups(3, [(2, 1)]) == [[0], [2], [1]] and cycles(3, [(2, 1)]) == []


def test_groups_and_cuts_are_those_of_the_definition():
    rng = random.Random(1)
    for _ in range(200):
        count = rng.randint(1, 9)
        edges = [(rng.randrange(count), rng.randrange(count)) for _ in range(rng.randint(0, 14))]
        reached = {thing: reach(thing, edges) for thing in range(count)}
        for group in groups(count, edges):
            thing = group[0]
            assert group == sorted({thing} | {o for o in reached[thing] if thing in reached[o]})
        flat = [thing for group in groups(count, edges) for thing in group]
        for source, target in edges:
            assert flat.index(source) < flat.index(target) or source in reached[target]
        order, cut = sort(count, edges)
        for source, target in set(edges) - set(cut):
            assert order.index(source) < order.index(target)
        assert all(source == target or source in reached[target] for source, target in cut)


def reach(thing, edges):
    found, left = set(), [thing]
    while left:
        for source, target in edges:
            if source == left[-1] and target not in found:
                found.add(target)
                left.insert(0, target)
        left.pop()
    return found
