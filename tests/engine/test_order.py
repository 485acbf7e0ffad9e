"""Components run after those they take values from."""

from navfmu.engine.order import sort_components


def test_a_chain_given_backwards_is_sorted():
    assert sort_components(4, [(3, 2), (2, 1), (1, 0)]) == ([3, 2, 1, 0], [])


def test_the_order_of_the_description_is_kept_where_it_can_be():
    assert sort_components(4, [(0, 3)]) == ([0, 1, 2, 3], [])


def test_a_ring_is_cut_at_its_first_component():
    order, cut = sort_components(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
    assert order == [0, 1, 2, 3]
    assert cut == [(3, 0)]


def test_a_cycle_is_cut_at_its_own_first_component_not_at_one_behind_it():
    order, cut = sort_components(4, [(2, 3), (3, 2), (3, 0), (0, 1)])  # 0 and 1 wait for the cycle 2 <-> 3
    assert order == [2, 3, 0, 1]
    assert cut == [(3, 2)]


def test_two_cycles_in_a_row_are_cut_once_each():
    order, cut = sort_components(5, [(0, 1), (1, 0), (1, 2), (2, 3), (3, 2), (3, 4)])
    assert order == [0, 1, 2, 3, 4]
    assert cut == [(1, 0), (3, 2)]


def test_a_component_that_feeds_itself_is_cut():
    assert sort_components(2, [(1, 1), (0, 1)]) == ([0, 1], [(1, 1)])
