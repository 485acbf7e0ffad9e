"""Titles and verdicts of the picture of ground stations follow the data."""

from dataclasses import replace

import numpy as np
import pytest

from evidence.sensors import navaids
from evidence.sensors.navaids import Found
from navfmu.constants import NAUTICAL_MILE
from navfmu.navaids.coverage import Coverage, Points
from navfmu.report.page import Page
from navfmu_figures.thesis.t26 import COUNT, HEIGHT, MIDDLE, SIDE, THREE, around, dilution, made


@pytest.fixture(scope="module")
def honest():
    """Three and two made stations, calculated by their angles in a plane, and the airports of a made region."""
    sides = np.linspace(-SIDE, SIDE, COUNT)
    north, east = np.meshgrid(sides, sides, indexing="ij")

    def plane(*bearings):
        far = [
            (np.array([SIDE * np.cos(b) - north, SIDE * np.sin(b) - east, 0.25 + 0.0 * east]))
            for b in np.radians(bearings)
        ]
        h = np.array([(f / np.linalg.norm(f, axis=0))[:2] for f in far])
        nn, ee, ne = (np.sum(h[:, i] * h[:, j], axis=0) for i, j in ((0, 0), (1, 1), (0, 1)))
        determinant = nn * ee - ne * ne
        return np.where(determinant > 1e-9, np.sqrt((nn + ee) / np.maximum(determinant, 1e-9)), np.inf)

    region = Coverage.of(
        [made(0.0), made(120.0)], Points.around(*MIDDLE, SIDE * NAUTICAL_MILE, 9, [0.3 * HEIGHT, HEIGHT])
    )
    heard = {"here": np.array([[1, 2], [2, 3]]), "there": np.array([[3, 4]])}
    return Found(sides, plane(0.0, 120.0, 240.0), plane(0.0, 180.0), heard, 0.1, region, "made, around X")


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = navaids.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 3
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


def test_the_maps_are_those_of_a_plane(honest):
    """20 nmi of a round Earth hardly differ from a plane. Wrong: maps with north to the right, or upside down."""
    near = np.abs(dilution(THREE, around()) / honest.three - 1.0)
    assert np.quantile(near, 0.99) < 0.01


def test_shares_count_airports(honest):
    assert navaids.shares(honest.heard["here"]) == [50.0, 100.0, 0.0, 50.0]


@pytest.mark.parametrize(
    ("wrong", "change"),
    [
        ({0}, lambda f: {"three": 1.01 * f.three}),
        ({1}, lambda f: {"two": f.two**2}),
        ({2}, lambda f: {"different": 2.0}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, wrong, change):
    """A percent too much, a square for the root, horizons of another radius."""
    claims = navaids.make_claims(replace(honest, **change(honest)))
    assert {i for i, claim in enumerate(claims) if not claim.holds} == wrong
    assert all(claims[i].sentence == claims[i].opposite for i in wrong)
