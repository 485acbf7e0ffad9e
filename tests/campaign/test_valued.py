"""The curve of a requirement's expression: made from what is recorded, with its bound. By closed forms."""

from __future__ import annotations

import numpy as np

from navfmu.campaign.drawn import Artist
from navfmu.campaign.scenes import pictures_of, scene
from navfmu.system.scene import windows
from tests.campaign.test_asked import flown


def pictures(folder, *entries, **more):
    """Expression -> picture, and the only run."""
    outcome = flown(folder, *entries, **more)
    run = outcome.runs[0]
    return {p.signal: p for p in pictures_of(outcome, run.run.variant, run.run.case)}, outcome, run


def test_the_value_of_an_expression_is_drawn_with_its_bound(tmp_path):
    """Wrong: no curve, one of a signal in it, or the bound in another unit than the curve."""
    text = "m0.y + 2 * m1.y * time / 1 s"
    found, outcome, judged = pictures(tmp_path, f'signal = "{text}"\nat_most = "2 ft"\nfrom = 0.2', period=0.1)
    made = scene(outcome, judged.run.variant, judged.run.case, found[text], [judged], judged)
    (panel,) = found[text].panels(made)
    value, bound = panel.curves
    np.testing.assert_allclose(value.y, 1.0 + 2.0 * np.arange(11) / 10, rtol=1e-12)  # every lag stands at 1 m
    assert set(np.asarray(bound.y)) == {2 * 0.3048} and min(bound.x) == 0.2 and max(bound.x) == 1.0
    assert panel.title.startswith(text) and panel.y == "value, m"
    assert text in found[text].draw(made).title
    assert Artist(outcome).draw(judged, curves=True).curves


def test_what_has_no_value_of_its_own_is_not_drawn(tmp_path):
    """Truth values, and events."""
    found, *_ = pictures(
        tmp_path,
        'signal = "m0.y > 0.5 m"',
        'events = "m0.y > 0.5 m"\nat_most = 1',
        'signal = "m0.y"\nat_most = 1',
    )
    assert list(found) == ["m0.y"]


def test_two_requirements_on_one_expression_share_a_picture(tmp_path):
    found, *_ = pictures(tmp_path, 'signal = "abs(m0.y)"\nat_most = 1', 'signal = "abs(m0.y)"\nat_least = 0.5')
    assert list(found) == ["abs(m0.y)"]


def test_a_fault_that_comes_and_goes_is_shaded_where_it_acts():
    """Wrong: one window from its first beginning to its last end."""
    both = {"a": [[1.0, 2.0], [4.0, 5.0]]}
    assert [window.spans for window in windows([both])] == [((1.0, 2.0), (4.0, 5.0))]
    other = {"a": [[1.5, 3.0], [7.0, 8.0], [8.0, 9.0]]}
    (window,) = windows([both, other])
    assert window.spans == ((1.0, 3.0), (4.0, 5.0), (7.0, 9.0)) and "in each run at another time" in window.name
