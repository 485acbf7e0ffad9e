"""A recorded day flown as FMUs: without data nothing is claimed, and what is elsewhere is said."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd

from evidence.sensors import observations


def test_without_data_it_is_left_out_with_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in observations.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    section = observations.run(tmp_path)
    assert section.left_out.endswith("has no esbc1770.rnx.gz") and not section.claims


def test_arrays_are_gathered_by_place():
    frame = pd.DataFrame({"a": [1.0, 2.0], "b[1]": [3.0, 4.0], "b[2]": [5.0, 6.0]})
    found = observations._gathered(frame)
    np.testing.assert_array_equal(found["a"], [1.0, 2.0])
    np.testing.assert_array_equal(found["b"], [[3.0, 5.0], [4.0, 6.0]])


def test_places_elsewhere_are_said():
    """3 mm in two of 100 places miss the bound of 2 mm."""
    for off, holds in ((1e-3, True), (3e-3, False)):
        apart = np.zeros(1000)
        apart[:20] = off
        assert observations.Day.same.fget(SimpleNamespace(apart=apart)).holds == holds
