"""Station sets: parameters of both components, in sight of the shipped flight, with the geometry they claim."""

import numpy as np
import pytest

from fmus.motion.flight_plans import FLIGHT_PLANS
from fmus.radio.stations import PLACES, STATION_SETS
from models.navigation import navigator
from models.radio import dme


def along_the_flight(name, count):
    """HDOP every 10 s of the Livermore flight with the first ``count`` stations, and whether all are in reach."""
    truth = FLIGHT_PLANS["livermore"].sample(10.0)
    parameters = {**STATION_SETS[name].parameters(), **STATION_SETS[name].ranges()}
    place = [parameters[f"station_{key}"][:count] for key in ("latitude", "longitude", "altitude")]
    dilutions, reached = [], []
    for latitude, longitude, altitude in zip(truth["latitude"], truth["longitude"], truth["altitude"], strict=True):
        sight = dme.line_of_sight(latitude, longitude, altitude, *place)
        north, east, distance = navigator.direction_cosines(latitude, longitude, sight)
        dilutions.append(dme.dilution(north, east, np.ones(count, bool)))
        limit = np.minimum(dme.horizon(altitude, place[2], 10.0), parameters["station_range"][:count])
        reached.append(np.all(distance < limit))
    return np.array(dilutions), np.array(reached)


@pytest.mark.parametrize("name", STATION_SETS)
def test_sets_fill_five_places(name):
    parameters = STATION_SETS[name].parameters()
    assert 1 <= parameters["station_count"] <= PLACES
    for key in ("latitude", "longitude", "altitude"):
        assert parameters[f"station_{key}"].shape == (PLACES,)
    assert STATION_SETS[name].ranges()["station_range"].shape == (PLACES,)
    used = parameters["station_latitude"][: parameters["station_count"]]
    assert np.all((used > np.radians(36.5)) & (used < np.radians(38.5)))  # degrees have become radians


@pytest.mark.parametrize(
    ("name", "count", "worst"), [("thesis_like", 2, 1.501), ("bay_area", 2, 1.55), ("bay_area", 5, 1.1)]
)
def test_geometry_is_good_along_the_whole_flight(name, count, worst):
    """Two lines of sight at 90 degrees give 1.414, the best there is; to the runway it stays near that."""
    dilution, reached = along_the_flight(name, count)
    assert np.max(dilution) < worst
    assert np.min(dilution) > 0.8 if count > 2 else np.min(dilution) >= np.sqrt(2.0) - 1e-3
    assert np.mean(reached) > 0.97


def test_the_hypothetical_pair_is_always_in_reach():
    assert np.all(along_the_flight("thesis_like", 2)[1])
