"""Saved states of every component with random numbers, all errors on: the future repeats to the last bit."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from benchmarks.everything_on import EVERYTHING
from tests.built import fmu
from tests.export.slave import OK, Slave, Unzipped


def advance(slave, times):
    """All values after each step between the given times."""
    rows = []
    for now, then in pairwise(times):
        assert slave.step(now, then - now) == OK, slave.said
        rows.append(slave.everything())
    return rows


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_state_that_is_saved_between_samples_goes_on_as_if_nothing_had_been(name, tmp_path_factory):
    """In the same instance and, serialised, in one that has another seed: latency, pulses, lags and the clocks too.

    A tenth of the interval between samples lies between the steps, so that ticks are not at their ends.
    """
    unzipped = Unzipped(fmu(name, tmp_path_factory), tmp_path_factory.mktemp(name))
    told = {key: np.ravel(value).tolist() if np.ndim(value) else value for key, value in EVERYTHING[name].items()}
    one, two = Slave(unzipped), Slave(unzipped)
    for slave, seed in ((one, 3), (two, 4)):
        for key, value in told.items():
            size = len(slave._names(key))
            assert slave.set(key, [value] * size if np.ndim(value) == 0 and size > 1 else value) == OK, slave.said
        assert slave.initialise(seed=seed) == OK
    past, future = np.linspace(0.0, 2.345, 80), np.linspace(2.345, 5.0, 80)
    advance(one, past)
    state = one.save()
    data, saved = one.serialise(state), one.everything()
    expected = advance(one, future)
    assert expected[-1] != saved
    assert one.call("SetFMUstate", state) == OK
    assert one.everything() == saved
    assert advance(one, future) == expected
    advance(two, past[:40])
    assert two.everything() != saved
    status, copy = two.deserialise(data)
    assert status == OK and two.call("SetFMUstate", copy) == OK, two.said
    assert advance(two, future) == expected
    one.free(), two.free()
