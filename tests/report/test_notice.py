"""When a system begins to say that something is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.report.notice import Notice
from navfmu.report.scene import Recorded

TIME = np.arange(8.0)


@pytest.mark.parametrize(
    ("values", "equals", "expected"),
    [
        ([False, False, True, True, False, True, True, True], None, [2.0, 5.0]),
        ([True, True, False, True, False, False, False, False], None, [0.0, 3.0]),  # also from the start on
        ([1, 1, 2, 2, 1, 0, 2, 2], 2, [2.0, 6.0]),
        ([1, 1, 2, 3, 0, 0, 4, 4], None, [0.0, 6.0]),
        ([0.0, np.nan, np.nan, 0.0, np.inf, 0.0, 0.0, 0.0], None, [4.0]),  # what is no number says nothing
        ([0] * 8, None, []),
    ],
)
def test_it_is_noticed_when_the_signal_begins_to_say_so(values, equals, expected):
    notice = Notice(label="x", signal="a.b", equals=equals)
    run = Recorded("", TIME, {"a.b": np.array(values)})
    assert notice.times(run).tolist() == expected
