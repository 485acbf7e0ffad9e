"""``field_correction``: what ``magnetometer`` has made of a field, undone."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.magnetic.field_correction import FieldCorrection
from fmus.magnetic.magnetometer import Magnetometer
from navfmu.errors import NavfmuError
from tests.models.native import interpret

ERRORS = {
    "hard_iron": (9e-6, -4e-6, 6e-6),
    "scale_factor": (0.3, -0.2, 0.1),
    "soft_iron": ((0.1, 0.2, -0.05), (-0.1, 0.05, 0.1), (0.02, -0.03, 0.2)),
    "misalignment": (0.05, -0.03, 0.1),
}
QUIET = {
    "noise_sigma": 0.0, "crustal_level": 0.0, "hard_iron_sigma": 0.0, "soft_iron_sigma": 0.0, "scale_factor_sigma": 0.0,
    "misalignment_sigma": 0.0, "latitude": 0.66, "longitude": -2.1, "roll": 0.4, "pitch": -0.2, "heading": 2.0,
}  # fmt: skip


def field(**values):
    run = interpret(Magnetometer, **QUIET, **values)
    run.do_step(0.0, 1.2)
    return np.asarray(run.get("field.field_b"))


def given(run, measured, sequence, time=0.0, valid=True):
    run.set("field.field_b", measured)
    run.set("field.valid", valid)
    run.set("field.sequence", sequence)
    run.set("field.time_of_validity", time)


def test_it_undoes_what_the_magnetometer_does_with_the_same_parameters():
    """Wrong: hard iron before the matrix is undone, C_si and C_sf in the other order, the transpose of C_m for its
    inverse: each is wrong by 1 % and more."""
    run = interpret(FieldCorrection, **ERRORS)
    given(run, field(**ERRORS), 5, 0.3)
    run.do_step(0.0, 0.5)
    np.testing.assert_allclose(run.get("corrected.field_b"), field(), rtol=1e-12)
    assert run.get("corrected.sequence") == 5
    assert run.get("corrected.time_of_validity") == 0.3
    assert run.get("corrected.valid")


def test_without_errors_it_passes_samples_on():
    """Wrong: a number of its own, an old field with a new number."""
    run = interpret(FieldCorrection)
    for sequence in (1, 2, 4):
        given(run, np.array([1e-5, 2e-5, 3e-5]) * sequence, sequence)
        run.do_step(run.time, 0.1)
        np.testing.assert_array_equal(run.get("corrected.field_b"), np.array([1e-5, 2e-5, 3e-5]) * sequence)
        assert run.get("corrected.sequence") == sequence


def test_what_is_not_valid_stays_so():
    """Wrong: valid for whatever has come."""
    run = interpret(FieldCorrection)
    given(run, np.full(3, 1e-5), 1, valid=False)
    run.do_step(0.0, 0.1)
    assert not run.get("corrected.valid")
    given(run, np.array([np.nan, 0.0, 0.0]), 2)
    run.do_step(0.1, 0.1)
    assert not run.get("corrected.valid")


def test_errors_that_leave_no_field_are_refused():
    """A row that is the negative of another. Wrong: fields that are infinite."""
    with pytest.raises(NavfmuError, match="make of some field none at all"):
        interpret(FieldCorrection, soft_iron=((0.0, -1.0 + 1.9, 0.0), (1.0 / 0.9, 0.0, 0.0), (0.0, 0.0, 0.0)))
