"""What requirements ask: expressions, while something holds, for how long at a time, how often. By closed forms.

Six lags stand at 1 m; runs of 1 s in steps of 0.1 s have 11 communication points, of which two or three are recorded.
"""

from __future__ import annotations

import re

import pytest

from navfmu.campaign import load_campaign, run_campaign
from navfmu.errors import NavfmuError
from tests.components import systems

BLINK = "0.2 s <= time < 0.4 s or 0.6 s <= time < 0.7 s or time >= 0.9 s"  # for two points, one, and two


def flown(folder, *entries, period=0.5):
    text = f'system = "{systems.ring()}"\nstop = 1.0\nstep = 0.1\nrecord_period = {period}\n'
    for number, entry in enumerate(entries):
        text += f'\n[[requirement]]\nid = "R-{number}"\n{entry}\n'
    (folder / "c.toml").write_text(text)
    return run_campaign(load_campaign(folder / "c.toml"), folder / "out", workers="thread")


def findings(folder, *entries, **more):
    outcome = flown(folder, *entries, **more)
    return [(outcome.runs[0].findings[cell.requirement.id], cell.passed) for cell in outcome.cells]


def test_a_value_of_several_signals_is_judged_between_recorded_points(tmp_path):
    (climb, _), (feet, passed) = findings(
        tmp_path,
        'signal = "m0.y + time * 1 m/s"\nat_most = 1.35',  # beyond from 0.4 s on; recorded at 0, 0.5 and 1 s
        'signal = "norm(m0.y, m1.y) - 2 * m2.y"\nat_most = "-1.9 ft"\npercent = 100',
    )
    assert (climb.percent, climb.first_violation) == (pytest.approx(100 * 4 / 11), 0.4)
    assert (climb.worst, climb.worst_time) == (2.0, 1.0)
    assert passed and feet.worst == pytest.approx(2**0.5 - 2)  # -0.586 m, and -1.9 ft are -0.579 m


def test_a_truth_value_needs_no_bound_and_may_be_asked_for_a_time_only(tmp_path):
    (never, a), (asked, b), (part, c) = findings(
        tmp_path,
        f'signal = "not ({BLINK})"',
        f'signal = "m0.y > 0.5 m"\nwhen = "{BLINK}"',
        f'signal = "time > 0.25 s"\nwhen = "{BLINK}"\npercent = 80',
    )
    assert not a and never.percent == pytest.approx(100 * 6 / 11)
    assert b and asked.percent == 100.0
    assert c and part.percent == pytest.approx(80.0) and part.first_violation == 0.2


@pytest.mark.parametrize(("tolerance", "share", "first"), [("0 s", 5, 0.2), ("100 ms", 4, 0.2), ("0.2 s", 0, None)])
def test_being_outside_for_a_short_time_is_put_up_with(tmp_path, tolerance, share, first):
    ((finding, passed),) = findings(tmp_path, f'signal = "not ({BLINK})"\ntolerance = "{tolerance}"')
    assert finding.percent == pytest.approx(100 * (11 - share) / 11)
    assert finding.first_violation == first and passed == (share == 0)


@pytest.mark.parametrize(("more", "count", "passed"), [
    ("", 3, False), ("at_most = 2", 3, False), ("at_most = 3", 3, True), ('tolerance = "0.1 s"\nat_most = 2', 2, True),
    ('from = 0.5\nto = 0.8\nat_most = 1', 1, True), ('when = "time < 0.5 s"\nat_most = 1', 1, True),
])  # fmt: skip
def test_events_are_counted(tmp_path, more, count, passed):
    outcome = flown(tmp_path, f'events = "{BLINK}"\n{more}')
    (cell,), finding = outcome.cells, outcome.runs[0].findings["R-0"]
    assert (finding.worst, cell.passed) == (count, passed)
    first = finding.first_violation
    assert f"; worst: seed 1, {count} time{'s' if count > 1 else ''}, first at t = {first:.9g} s" in cell.sentence
    assert "inside" not in cell.sentence
    most = 0 if "at_most" not in more else int(more[-1])
    assert re.search(r" at most (\d times?)", cell.requirement.sentence)[1] == f"{most} time{'s' if most != 1 else ''}"


def test_what_is_never_asked_says_so(tmp_path):
    """A verdict without a reason: violated, and nothing to be seen of it."""
    outcome = flown(tmp_path, 'signal = "m0.y"\nat_most = 2.0\nwhen = "time > 5 s"')
    assert outcome.cells[0].sentence == "held in 0 of 1 runs; in 1 it was never asked, which counts as not held"


def test_a_quantile_may_be_of_an_expression(tmp_path):
    outcome = flown(tmp_path, 'signal = "m0.y * 2 + time * 1 m/s"\nat_most = 2.9\nquantile = 0.5')
    assert "50th percentile of 1 runs at worst 3 m at t = 1 s" in outcome.cells[0].sentence


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ("at_most = 1", "line 7: expected one of 'signal', 'events', 'detects', 'recovers'"),
        ('signal = "m0.y"\nevents = "true"', "line 9: expected one of 'signal', 'events', 'detects', 'recovers'"),
        ('signal = "m0.y"', "line 7: this requirement has neither 'at_most' nor 'at_least'"),
        ('signal = "m0.y >"\nat_most = 1', "line 8: variant 'main': in 'm0.y >', character 7: it ends"),
        ('signal = "m0.y"\nat_most = 1\nwhen = "m0.y"', "line 10: variant 'main': in 'm0.y', character 1: expected a"),
        ('signal = "m0.y * 2"\nat_most = "3 s"', "line 9: 'at_most' = 3 s: 'm0.y * 2' is in m"),
        ('signal = "m0.y * 2"\nat_most = "m1.y"', "line 9: 'at_most' = m1.y: expected a number"),
        ('signal = "m0.y"\nat_most = 1\ntolerance = "5 m"', "line 10: 'tolerance'"),
        ('signal = "m0.y"\nat_most = 1\ntolerance = -1', "line 10: 'tolerance' is -1.0, expected a time in s"),
        ('signal = "m0.y"\nat_most = 1\ntolerance = 1\nquantile = 0.5', "line 10: 'tolerance' is asked within a run"),
        ('signal = "active(gps)"', "line 8: variant 'main': in 'active(gps)', character 8: there is no fault 'gps'"),
        ('events = "m0.y"', "line 8: variant 'main': in 'm0.y', character 1: expected a truth value"),
        ('events = "true"\nat_most = 1.5', "line 9: 'at_most' is 1.5, expected a number of events: 0, 1, 2"),
        ('events = "true"\nat_least = 1', "line 9: of events there is an 'at_most' only"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_is_told_with_its_line(tmp_path, entry, sentence):
    with pytest.raises(NavfmuError) as caught:
        flown(tmp_path, entry)
    assert sentence in str(caught.value)
