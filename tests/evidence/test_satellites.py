"""Titles and verdicts of the picture of satellites follow the data."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from evidence.sensors import satellites
from evidence.sensors.satellites import PRECISE, Found
from navfmu.report.page import Page


@pytest.fixture(scope="module")
def honest():
    """Differences as small as they are, and of precise orbits as large as others found."""
    states = pd.DataFrame({"usable": [True, True], "position": 0.05, "velocity": 0.006, "clock": [0.3, 0.6]})
    sign = np.array([1.0, -1.0] * 10)
    precise = pd.DataFrame({"hour": np.arange(20.0), "prn": 1.0, **{name: rms * sign for name, rms in PRECISE.items()}})
    theirs = np.array([0.9, 1.5, 1.8, 0.8, 1.0, 1.9, 2.1])
    rows = [
        {"latitude": lat, "mask": mask, "ours": theirs + 3e-4, "theirs": theirs}
        for lat in (0.0, 45.0)
        for mask in (5.0, 10.0)
    ]
    return Found(states, 0.5, precise, precise, pd.DataFrame(rows), np.ones((3, 4)))


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = satellites.section(honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 6
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("wrong", "change"),
    [
        ({0}, lambda f: {"states": f.states.assign(position=1.5)}),
        ({0}, lambda f: {"states": f.states.assign(usable=[True, False])}),
        ({1}, lambda f: {"states": f.states.assign(velocity=0.2)}),
        ({2}, lambda f: {"states": f.states.assign(clock=3.4)}),
        ({3}, lambda f: {"almanac": 2.0}),
        ({4}, lambda f: {"precise": f.precise.assign(along=1.1 * f.precise["along"])}),
        ({4}, lambda f: {"precise": f.precise.assign(clock=0.9 * f.precise["clock"])}),
        ({5}, lambda f: {"dilutions": f.dilutions.assign(ours=[row + 0.001 for row in f.dilutions["ours"]])}),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, wrong, change):
    """A satellite or its clock off by mm, other ephemerides, another almanac, another orbit, slots elsewhere."""
    claims = satellites.make_claims(replace(honest, **change(honest)))
    assert {i for i, claim in enumerate(claims) if not claim.holds} == wrong
    assert all(claims[i].sentence == claims[i].opposite for i in wrong)


def test_a_made_file_of_precise_orbits(tmp_path):
    """A file of the format SP3: km, us, epochs; a clock that is not known is left out, other systems are."""
    import gzip

    text = (
        "#cP2020  6 25  0  0  0.00000000      96\n"
        "*  2020  6 25  1 15  0.00000000\n"
        "PG05 -11562.163582  14053.114306  23345.128269   -884.707516\n"
        "PE05 -11562.163582  14053.114306  23345.128269   -884.707516\n"
        "PG06 -11562.163582  14053.114306  23345.128269 999999.999999\n"
    )
    path = tmp_path / "orbits.gz"
    path.write_bytes(gzip.compress(text.encode()))
    ((second, prn, position, clock),) = satellites.read_precise(path)
    assert second == 345600.0 + 4500.0 and prn.tolist() == [5.0]
    np.testing.assert_allclose(position[0], [-11562163.582, 14053114.306, 23345128.269])
    np.testing.assert_allclose(clock, [-884.707516e-6])
