"""When a fault acts, in words."""

import pytest

from navfmu import Fault
from navfmu.report import faults


@pytest.mark.parametrize(
    ("times", "words"),
    [
        ({}, "from 0 s"),
        ({"start": 3.0, "duration": 2.0}, "3 to 5 s"),
        ({"when": "a.y > 1"}, "once a.y > 1"),
        (
            {"when": "a.y > 1", "hold": 3.0, "start": 5.0, "duration": 2.0},
            "from 5 s on, once a.y > 1 has held for 3 s, for 2 s",
        ),
        ({"during": "cruise"}, "while cruise"),
        ({"during": "cruise", "hold": 3.0, "start": 5.0}, "from 5 s, while cruise has held for 3 s"),
    ],
)
def test_when_a_fault_acts_is_told_with_its_condition(times, words):
    cells = faults.cells(Fault("x", "a.y", "bias", value=1.0, **times).describe())
    assert cells == ["x", "a.y", "bias (value = 1.0)", words]
