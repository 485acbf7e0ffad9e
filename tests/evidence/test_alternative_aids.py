"""Titles and verdicts of the picture of VOR, radar, Doppler radar and LORAN follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import alternative_aids
from evidence.sensors.alternative_aids import ACCURACY, DEG, DISTANCES, SPEED, Found
from navfmu.constants import KNOT, NAUTICAL_MILE
from navfmu.report.page import Page


@pytest.fixture(scope="module")
def honest():
    """What sensors without any mistake would give."""
    rng = np.random.default_rng(7)
    far = 37e3
    movement = np.array([0.0, 1.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.0]) * KNOT
    return Found(
        2.0 * DEG * DISTANCES * NAUTICAL_MILE * rng.standard_normal((300, 5)),
        np.array([15.0, 0.08 * DEG * far]) * rng.standard_normal((300, 2)),
        far,
        np.full(20, 92.0),
        np.full(20, 92.0),
        0.99 * (SPEED - movement),
        ACCURACY * NAUTICAL_MILE / np.sqrt(8.0) * rng.standard_normal((300, 2)),
        rng.standard_normal((100, 2)),
    )


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = alternative_aids.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 5
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"across": 1.4 * f.across}),
        (0, lambda f: {"across": f.across / DISTANCES * 20.0}),
        (1, lambda f: {"scatter": f.scatter[:, ::-1]}),
        (1, lambda f: {"far": 0.5 * f.far}),
        (2, lambda f: {"behind": 0.0 * f.behind}),
        (3, lambda f: {"shown": 2 * 0.99 * SPEED - f.shown}),
        (3, lambda f: {"shown": f.shown / 0.99}),
        (4, lambda f: {"loran": np.sqrt(2.0) * f.loran}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, number, change):
    """Too large a sigma, the same error at all distances, along for across, half of the distance, no delay, a sea that
    moves against the wind or shortens nothing, 2 drms of one axis."""
    claims = alternative_aids.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [i != number for i in range(5)]
    assert claims[number].sentence == claims[number].opposite
