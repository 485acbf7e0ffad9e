"""Titles and verdicts of the picture of what a GPS receiver may have besides follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import gps_options, reference_station
from evidence.sensors.gps_options import BACK, LOST, SIZES, SKIES, STOP, TIMEOUT, TIMES, Found
from navfmu.report.page import Page


@pytest.fixture(scope="module")
def honest():
    """What a receiver without any mistake would give."""
    rng = np.random.default_rng(5)
    errors = rng.standard_normal((TIMES, STOP, 3)) * (0.3, 0.3, 0.8)
    errors[:, LOST + TIMEOUT : BACK] *= 3.0
    best = rng.uniform(2.0, 4.0, SKIES)
    fresh = rng.uniform(-0.9, 0.9, (reference_station.TIMES, reference_station.FRESH, 2, 3))
    fresh[..., 1, :] *= 6.0
    aged = rng.uniform(-1.2, 1.2, (reference_station.TIMES, reference_station.OLD, 2, 3))
    masked = rng.uniform(-0.9, 0.9, (reference_station.TIMES, reference_station.FRESH, len(reference_station.MASKS), 3))
    station = reference_station.Station(fresh, aged, masked)
    skies = np.stack([0.8 * best, 1.02 * best, best, 3.0 * best], axis=1)
    return Found(errors, 0.25 / np.array(SIZES), skies, station)


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = gps_options.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 9
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


def stay_lost(errors):
    return np.where(np.arange(STOP)[:, None] >= BACK, 3.0 * errors, errors)


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (0, lambda f: {"errors": 10.0 * f.errors}),
        (1, lambda f: {"errors": f.errors[:, np.arange(STOP) % LOST]}),
        (2, lambda f: {"errors": stay_lost(f.errors)}),
        (3, lambda f: {"attitude": 1.3 * f.attitude}),
        (4, lambda f: {"attitude": 0.25 / np.array(SIZES) ** 0.5}),
        (5, lambda f: {"dilution": f.dilution[:, [0, 3, 2, 1]]}),
        (6, lambda f: {"station": replace(f.station, fresh=4.0 * f.station.fresh)}),
        (7, lambda f: {"station": replace(f.station, fresh=f.station.fresh[:, :, [0, 0]])}),
        (8, lambda f: {"station": replace(f.station, aged=10.0 * f.station.aged)}),
    ],
)
def test_a_mistake_is_told_where_it_is(honest, number, change):
    claims = gps_options.make_claims(replace(honest, **change(honest)))
    assert [claim.holds for claim in claims] == [k != number for k in range(9)]
    assert claims[number].sentence == claims[number].opposite


def test_dilution_of_a_regular_sky():
    """Four in a tetrahedron have sqrt(10) / 2."""
    tetrahedron = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
    assert gps_options.gdop(tetrahedron) == pytest.approx(np.sqrt(10.0) / 2.0)
    assert gps_options.gdop(np.vstack([tetrahedron[:3], tetrahedron[0]])) == 1e3
