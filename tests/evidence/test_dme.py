"""Titles and verdicts of the DME's picture follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import dme
from evidence.sensors.dme import AIRCRAFT, DISTANCE, SHARE, SIGMA, SPEED, TIMELINE, Found
from navfmu.report.page import Page


@pytest.fixture(scope="module")
def honest():
    """What a receiver without any mistake would give."""
    rng = np.random.default_rng(4)
    phi = np.exp(-SPEED / DISTANCE)
    process = np.empty((60, 800, 6))
    process[:, 0] = rng.standard_normal((60, 6))
    for k in range(1, process.shape[1]):
        process[:, k] = phi * process[:, k - 1] + np.sqrt(1.0 - phi * phi) * rng.standard_normal((60, 6))
    errors = SIGMA * (np.sqrt(1.0 - SHARE) * process[..., :5] + np.sqrt(SHARE) * process[..., 5:])
    phases = {name: rng.integers(1, 5, (dme.SHOWN, 5)) for name in TIMELINE}
    rates = 30.5 * AIRCRAFT + 25.0
    answered = np.minimum(1.0 / (1.0 + 60e-6 * rates), 3000.0 / rates)
    return Found(errors, phases, np.array([1130.0, 1130.0]), answered, 1.0 * (AIRCRAFT < 180), answered)


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = dme.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 4
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"errors": 1.2 * f.errors}),
        (0, lambda f: {"errors": f.errors[:, ::2]}),
        (0, lambda f: {"errors": np.random.default_rng(1).permuted(f.errors, axis=0)}),  # stations of other flights
        (1, lambda f: {"pulses": 1.5 * f.pulses}),
        (2, lambda f: {"answered": np.exp(-60e-6 * (30.5 * AIRCRAFT + 25.0))}),
        (2, lambda f: {"answered": f.answered * np.where(AIRCRAFT > 100, 100.0 / np.maximum(AIRCRAFT, 1), 1.0)}),
        (3, lambda f: {"ranged": 1.0 * (AIRCRAFT < 90)}),
    ],
)
def test_a_mistake_is_told_where_it_is(honest, number, change):
    claims = dme.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [k != number for k in range(4)]
    assert claims[number].sentence == claims[number].opposite


def test_a_transponder_that_is_played_gives_what_it_can():
    assert dme.play(10.0, 20.0) == pytest.approx(1.0, abs=0.01)
    assert dme.play(9000.0, 20.0) == pytest.approx(1.0 / 3.0, rel=0.02)
