"""The variant whose DME receiver has a part of the bias that is common to its stations."""

import numpy as np
import pytest

from fmus.radio.stations import STATION_SETS
from models.radio import dme

SHARE = (315.0 / 370.0) ** 2
"""Of the receiver in the variance of a range: ICAO Annex 10, volume I, 3.5.3.1.3.3."""
PLACES = 2
FLIGHTS = 4


@pytest.mark.parametrize(("variant", "share"), [(None, 0.0), ("shared_bias", SHARE)])
def test_ranges_of_a_flight_have_the_share_in_common(load, variant, share):
    """Difference and sum of two biases have variances of (1 - s) to (1 + s).

    Flown over 35 minutes at 46 m/s a bias is forgotten after 0.5 nmi: some 50 times, and of an exponential correlation
    as many independent numbers; the logarithm of the ratio of two variances of n of them scatters by 2 / sqrt(n). Five
    of that for four flights: 0.7. Independent biases, or those of the receiver alone, are farther off than that.
    """
    stations = STATION_SETS["thesis_like"].parameters()
    columns = [stations[f"station_{name}"][:PLACES] for name in ("latitude", "longitude", "altitude")]
    names = [f"aircraft.{name}" for name in ("latitude", "longitude", "altitude")]
    differences, sums = [], []
    for seed in range(1, FLIGHTS + 1):
        run = load(variant).run(
            parameters={"dme.mode": 3}, seed=seed, record=[*names, "dme.ranging.slant_range"], record_period=1.0
        )
        run = run[run.index >= 10.0]
        true = np.array([dme.slant_range(*place, *columns) for place in run[names].to_numpy()])
        first, second = (run[[f"dme.ranging.slant_range[{i}]" for i in (1, 2)]].to_numpy() - true).T
        differences.append(np.mean((first - second) ** 2))
        sums.append(np.mean((first + second) ** 2))
    ratio = np.mean(differences) / np.mean(sums)
    assert abs(np.log(ratio / ((1.0 - share) / (1.0 + share)))) < 0.7
