"""Titles and verdicts of the wind's picture follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import wind
from evidence.sensors.flown_wind import (
    DISTANCE,
    FREQUENCY,
    GUSTS,
    HEIGHTS,
    LAGS,
    LEVELS,
    SHEAR,
    STEP,
    Flown,
    certified,
    exponential,
    power_law,
    specified,
    spectrum,
)
from fmus.grades import TURBULENCE
from navfmu.report.page import Page


@pytest.fixture
def honest():
    """What a wind without any mistake, and without any chance, would give."""
    time = np.arange(0.0, 601.0)
    return Flown(
        spectrum(FREQUENCY),
        exponential(LAGS),
        power_law(HEIGHTS),
        {name: certified(DISTANCE) for name in GUSTS},
        {name: specified(LEVELS, name)[0] for name in TURBULENCE},
        time,
        -SHEAR * time,
    )


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = wind.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 6
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"power": spectrum(FREQUENCY, folded=False)}),
        (0, lambda f: {"power": f.power[:, ::-1]}),
        (1, lambda f: {"correlations": np.tile(np.exp(-LAGS * STEP / 400.0), (3, 1))}),
        (2, lambda f: {"profile": 10.0 * (np.clip(HEIGHTS, 1.0, 274.0) / 274.0) ** (1.0 / 7.0)}),
        (3, lambda f: {"gusts": {n: certified(DISTANCE - 1.0) for n in GUSTS}}),
        (4, lambda f: {"error": -f.error}),
        (4, lambda f: {"error": 0.9 * f.error}),
        (5, lambda f: {"intensities": {n: v[:, ::-1] for n, v in f.intensities.items()}}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, number, change):
    """A process that is continuous, axes exchanged, travelling time that is time, another power, a gust a metre late,
    an error to the other side, a tenth of it missing, intensities exchanged."""
    claims = wind.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [i != number for i in range(6)]
    assert claims[number].sentence == claims[number].opposite
