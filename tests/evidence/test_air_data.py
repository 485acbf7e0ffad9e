"""Titles and verdicts of the air data's picture follow the data."""

import ambiance
import numpy as np
import pandas as pd
import pytest

from evidence.sensors import air_data
from evidence.sensors.air_data import DRAIN, FAULTS, FROM, LAG, STOP, UNTIL, airspeed, impact, pressure, viscosity
from navfmu.report.page import Page

TIME = np.round(np.arange(0.1, STOP + 0.05, 0.1), 6)
HEIGHT = np.interp(TIME, [0, 60, 120, 180, 300, 360], [1000.0, 1000.0, 1300.0, 1300.0, 700.0, 700.0])
FAULTY = (TIME > FROM) & (TIME <= UNTIL)


@pytest.fixture
def honest():
    """What air data without any mistake would give: by time, in frames as of a run."""
    outside = pressure(pd.Series(HEIGHT))
    start = np.flatnonzero(FAULTY)[0] - 1
    speed = airspeed(impact(np.full(TIME.shape, 48.0)))
    clean = pd.DataFrame(
        {"altitude": HEIGHT, "calibrated_airspeed": speed, "pressure_altitude": HEIGHT, "vertical_speed": 0.0}, TIME
    )

    def other(**columns):
        return clean.assign(**{name: np.where(FAULTY, values, clean[name]) for name, values in columns.items()})

    tau = LAG / DRAIN * 101325.0 / outside[start] * viscosity(1000.0)[0]
    late = 5.0 * 101325.0 / outside * viscosity(HEIGHT)
    flights = dict.fromkeys(FAULTS, clean)
    flights["pitot tube and drain blocked"] = other(
        calibrated_airspeed=airspeed(outside[start] + impact(speed[start]) - outside)
    )
    flights["static port blocked"] = other(
        calibrated_airspeed=airspeed(outside + impact(speed) - outside[start]), pressure_altitude=1000.0
    )
    flights["pitot tube blocked, drain open"] = other(
        calibrated_airspeed=airspeed(impact(speed) * np.exp(-np.maximum(TIME - FROM, 0.0) / tau))
    )
    flights["static line of 1 s"] = clean.assign(pressure_altitude=HEIGHT - late)
    ones = np.ones(36)
    return flights, {"time": 10.0 + ones, "calibrated_airspeed": ones, "pressure_altitude": ones}


def test_without_a_mistake_every_claim_holds_and_the_picture_is_drawn(honest):
    found = air_data.section(*honest)
    assert all(claim.holds for claim in found.claims) and len(found.claims) == 7
    page = Page("")
    found.write(page)
    assert "data:image/png" in page.html()


@pytest.mark.parametrize(
    ("claim", "flight", "reading", "change"),
    [
        ("blocked", "pitot tube and drain blocked", "calibrated_airspeed", lambda v: v + 0.05),
        ("drain", "pitot tube blocked, drain open", "calibrated_airspeed", lambda v: v * np.exp(-(TIME - FROM) / 99.0)),
        ("static", "static port blocked", "pressure_altitude", lambda v: np.where(TIME > 300.0, v + 1e-6, v)),
        ("late", "static line of 1 s", "pressure_altitude", lambda v: v - 0.1),
        ("climb", "static port blocked", "vertical_speed", lambda v: v + 0.02),
        ("recovery", "lines swapped", "pressure_altitude", lambda v: v + 1e-9),
    ],
)
def test_a_mistake_misses_its_claim_and_turns_the_title(honest, claim, flight, reading, change):
    """Pressures that are not trapped, a drain of another size, a port that leaks, a lag of another pressure, a chamber
    that does not come to rest, a fault that leaves something."""
    flights, squares = honest
    flights[flight] = flights[flight].assign(**{reading: change(flights[flight][reading].to_numpy())})
    claims = air_data.make_claims(flights, squares)
    assert not claims[claim].holds and claims[claim].sentence == claims[claim].opposite
    assert all(other.holds for name, other in claims.items() if name not in (claim, "recovery"))


@pytest.mark.parametrize("square", [0.5, 2.0])
def test_a_wrong_sigma_misses_its_claim(honest, square):
    flights, squares = honest
    squares["pressure_altitude"] = np.where(np.arange(36) == 35, square, squares["pressure_altitude"])
    assert not air_data.make_claims(flights, squares)["sigma"].holds


def test_pressures_are_those_of_the_standard_day():
    assert pressure(pd.Series([0.0, 11000.0])) == pytest.approx(ambiance.Atmosphere([0.0, 11000.0]).pressure)
    assert airspeed(impact(np.array([30.0, 250.0]))) == pytest.approx([30.0, 250.0])
