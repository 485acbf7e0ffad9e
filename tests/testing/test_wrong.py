"""Wrong input of every kind is a sentence: never an exception of another kind, and nothing is flown."""

from __future__ import annotations

import math

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.testing.bench import Bench
from navfmu.testing.logbook import Logbook
from navfmu.testing.marks import Setting
from tests.components import Lag, systems

NONSENSE = (None, 5, -1, math.nan, math.inf, 1e300, 1e-320, "", " ", "\0", "nonsense", "ä.ö", "a.b.c", ".", "5 parsecs")
NONSENSE += (
    [],
    {},
    [None],
    ["nonsense"],
    [[]],
    {"a": 1},
    object(),
    b"bytes",
    True,
    np.float64(math.nan),
    ("lag", "lag"),
    Lag,
)


def bench(folder, **given):
    return Bench(
        systems.tracker(), given.pop("variant", None), given.pop("setting", Setting()), folder[0], folder[1], given
    )


@pytest.fixture
def place(tmp_path):
    return Logbook(lambda: tmp_path / "kept", "test_it.py::test_it"), tmp_path


CALLS = {
    "system": lambda place, value: Bench(value, None, Setting(), *place, {}),
    "variant": lambda place, value: bench(place, variant=value),
    "twins": lambda place, value: bench(place, twins=value),
    "twins by name": lambda place, value: bench(place, twins={"lag": value}),
    "parameters": lambda place, value: bench(place, parameters=value).run(0.1),
    "a parameter": lambda place, value: bench(place, parameters={"lag.tau": value}).run(0.1),
    "fault": lambda place, value: bench(place).fault(value),
    "faults": lambda place, value: bench(place).faults(value),
    "type": lambda place, value: bench(place).fault("lag.y", value),
    "at": lambda place, value: _run(bench(place), at=value),
    "duration": lambda place, value: _run(bench(place), duration=value),
    "id": lambda place, value: _run(bench(place), id=value),
    "value": lambda place, value: _run(bench(place), value=value),
    "signal": lambda place, value: bench(place).require(value, at_most=1),
    "at_most": lambda place, value: bench(place).require("lag.y", at_most=value),
    "percent": lambda place, value: bench(place).require("lag.y", at_most=1e9, percent=value),
    "from": lambda place, value: bench(place).require("lag.y", at_most=1e9, from_=value),
    "stop": lambda place, value: bench(place).run(value),
    "step": lambda place, value: bench(place).run(0.1, step=value),
    "marked step": lambda place, value: bench(place, setting=Setting(step=value)).run(0.1),
    "marked algorithm": lambda place, value: bench(place, setting=Setting(algorithm=value)).run(0.1),
    "seed": lambda place, value: bench(place).run(0.1, seed=value),
    "record": lambda place, value: _required(bench(place), value),
    "record_period": lambda place, value: bench(place).run(0.1, record_period=value),
    "engine": lambda place, value: bench(place).run(0.1, engine=value),
    "allow": lambda place, value: bench(place).run(0.1, allow=value),
}
"""Some of the nonsense makes sense in one place or another: a parameter of 5 is one."""


def _run(s, **given):
    s.fault("lag.bias", **{"value": 1.0, **given})
    s.run(0.1, allow="idle")


def _required(s, record):
    s.require("lag.y", at_most=1e9)
    s.run(0.1, record=record)


@pytest.mark.filterwarnings("ignore::navfmu.errors.NavfmuWarning")
@pytest.mark.parametrize("call", CALLS)
def test_nonsense_is_a_sentence(call, place):
    refused = 0
    for value in NONSENSE:
        if call == "stop" and value == 1e300:
            continue  # a long run
        try:
            CALLS[call](place, value)
        except NavfmuError as error:
            refused += 1
            assert len(str(error)) > 15 and str(error).isprintable(), (value, error)
    assert refused > len(NONSENSE) / 2
    assert not (place[1] / "kept").exists()
