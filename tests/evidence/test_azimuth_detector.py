"""Titles and verdicts of the azimuth detector's picture follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import azimuth_detector
from evidence.sensors.azimuth_detector import BANKS, HEADINGS, SIGMA, TIME, Found
from navfmu.report.page import Page


@pytest.fixture(scope="module")
def honest():
    """What a detector without any mistake would give."""
    rng = np.random.default_rng(4)
    phi = np.exp(-1.0 / TIME)
    slow = np.empty((100, 1800))
    slow[:, 0] = SIGMA * rng.standard_normal(100)
    for k in range(1, slow.shape[1]):
        slow[:, k] = phi * slow[:, k - 1] + SIGMA * np.sqrt(1.0 - phi * phi) * rng.standard_normal(100)
    field = (22000.0, 41000.0)
    turning = {bank: azimuth_detector.turning_error(HEADINGS, bank, field) for bank in BANKS}
    seen = 3.5 * rng.standard_normal(18000)
    return Found(turning, field, slow, 1.0 + 0.05 * np.arange(18000), seen)


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = azimuth_detector.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 3
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"turning": {bank: -error for bank, error in f.turning.items()}}),
        (0, lambda f: {"turning": {bank: 0.0 * error for bank, error in f.turning.items()}}),
        (1, lambda f: {"slow": 1.5 * f.slow}),
        (1, lambda f: {"slow": f.slow[:, ::2]}),
        (1, lambda f: {"slow": f.slow * np.minimum(np.arange(f.slow.shape[1]) / 600.0, 1.0)}),
        (2, lambda f: {"seen": 0.5 * f.seen}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, number, change):
    """Turned the other way, no error in turns, too large a sigma, half of its time, one that starts at zero, half of
    the noise."""
    claims = azimuth_detector.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [i != number for i in range(3)]
    assert claims[number].sentence == claims[number].opposite
