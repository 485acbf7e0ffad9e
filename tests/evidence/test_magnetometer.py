"""Titles and verdicts of the magnetometer's picture follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import magnetometer
from evidence.sensors.magnetometer import DATES, FAULTS, HEADINGS, HEIGHTS, OFF, ON, PLACES, Found
from navfmu.report.page import Page


@pytest.fixture
def honest():
    """What a magnetometer without any mistake would give."""
    field = {name: np.ones((len(DATES), 3)) * 2e-5 for name in PLACES}
    turned = {name: np.sin(np.radians(HEADINGS)) for name in FAULTS}
    time = np.arange(1.0, 30.0, 0.05)
    flows = np.where((time > ON + 1e-9) & (time < OFF + 1e-9), 2.0, 0.0)
    return Found(
        field, dict(field), turned, dict(turned), magnetometer.dipole_left(HEIGHTS), magnetometer.waves_left(HEIGHTS),
        time, 0.0 * time, flows,
    )  # fmt: skip


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = magnetometer.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 4
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"charted": {n: v + 2e-10 for n, v in f.charted.items()}}),
        (1, lambda f: {"turned": {n: -v for n, v in f.turned.items()}}),
        (2, lambda f: {"dipole": magnetometer.dipole_left(HEIGHTS) ** (2 / 3)}),
        (2, lambda f: {"crust": np.ones(len(HEIGHTS))}),
        (3, lambda f: {"faulty": f.faulty + 1e-9}),
        (3, lambda f: {"faulty": 0.0 * f.faulty}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, number, change):
    """The field of another model, a needle turned the other way, a square law, a crust that does not decay, a current
    that stays, one that does nothing."""
    claims = magnetometer.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [i != number for i in range(4)]
    assert claims[number].sentence == claims[number].opposite
