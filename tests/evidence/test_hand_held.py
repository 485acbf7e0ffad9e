"""The metric of BROAD on turns of known size, and what the section says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evidence.sensors import hand_held
from navfmu.report.page import Page

TRUE = Rotation.random(50, random_state=np.random.default_rng(1))


def turned(vector_deg):
    return Rotation.from_rotvec(np.radians(np.tile(vector_deg, (50, 1)))) * TRUE


def test_errors_of_turns_in_the_earths_frame():
    """A turn about the vertical is all heading, one about the north none; catches errors in the sensor's frame."""
    np.testing.assert_allclose(hand_held.rms(turned([0.0, 0.0, -3.0]), TRUE), [3.0, 3.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(hand_held.rms(turned([4.0, 0.0, 0.0]), TRUE), [4.0, 0.0, 4.0], atol=1e-6)
    total, heading, inclination = hand_held.rms(turned([3.0, 0.0, 4.0]), TRUE)
    assert total == pytest.approx(5.0, abs=1e-6)
    assert heading == pytest.approx(4.0, abs=0.01)
    assert inclination == pytest.approx(3.0, abs=0.01)


def test_errors_are_root_mean_square():
    """Half of the rows are off by 6 degrees: 3 would be the mean of the sizes."""
    mixed = Rotation.concatenate([turned([0.0, 0.0, 6.0])[:25], TRUE[25:]])
    assert hand_held.rms(mixed, TRUE)[0] == pytest.approx(6.0 / np.sqrt(2.0))


def test_axes_are_forward_right_down_in_north_east_down():
    """Forward, left, up that look north with the left hand west are the identity; a mirror image has no rotation."""
    flat = Rotation.from_euler("z", 90.0, degrees=True)  # forward is north in east, north, up
    np.testing.assert_allclose((hand_held.NED_OF_ENU * flat * hand_held.FRD_OF_FLU).as_matrix(), np.eye(3), atol=1e-15)
    assert np.linalg.det(hand_held.NED_OF_ENU.as_matrix()) == pytest.approx(1.0)


@pytest.mark.parametrize(("size", "holds"), [(2.9, True), (3.1, False)])
def test_the_claim_is_of_the_mean_of_trials(size, holds):
    """The mean counts, not the best or the middle one; where it is missed, the page says so."""
    errors = {"one": np.array([size + 2.0, 1.0, 1.0]), "two": np.array([size - 1.0, 1.0, 1.0])}
    errors["three"] = np.array([size - 1.0, 1.0, 1.0])
    section = hand_held.section(errors)
    assert section.claims[0].holds == holds
    page = Page("")
    section.write(page)
    assert f"{size:.2f}" in page.html()


def test_without_recordings_it_is_left_out(monkeypatch, tmp_path):
    monkeypatch.delenv("NAVFMU_DATA", raising=False)
    assert "NAVFMU_DATA" in hand_held.run(tmp_path).left_out
    monkeypatch.setenv("NAVFMU_DATA", str(tmp_path))
    assert "*.parquet" in hand_held.run(tmp_path).left_out
