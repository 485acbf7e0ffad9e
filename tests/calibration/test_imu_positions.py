"""What stands tell of an inertial unit: the covariances that AGARD CP-298, paper 10 (Joos and Krogmann) prints.

Each of a mean reading with one sigma, in units of it and of g; Figs. 9 and 14.
"""

from __future__ import annotations

import numpy as np
import pytest

from evidence.sensors.turntable import LATITUDE, eight_by_three, faces
from navfmu.calibration.imu.determination import determine
from navfmu.calibration.imu.earth import gravity, rotation_n, to_body
from navfmu.calibration.imu.fit import information
from navfmu.calibration.imu.stands import Stands

G = gravity(LATITUDE, 0.0)
BLIND = 1e6
"""Sigma of readings that tell nothing."""
EIGHT = np.vstack([faces(), np.radians([[135.0, 0.0, 0.0], [225.0, 0.0, 0.0]])])
"""Of its 24 positions the only kind of eight with the covariance printed: the faces, and two slants about x."""


def told(attitudes, sigma, without):
    """The covariance by names, of a unit without errors."""
    to_b = to_body(*attitudes.T)
    force, rate = to_b @ [0.0, 0.0, -G], to_b @ rotation_n(LATITUDE)
    time = np.arange(len(force), dtype=float)
    found = determine(Stands("made", time, time, rate, force, G, rate, force), without, np.array(sigma))
    names = [element.name for element in found.elements]

    def part(*asked):
        at = [names.index(name) for name in asked]
        return found.fit.covariance[np.ix_(at, at)]

    return part


@pytest.mark.parametrize(
    ("attitudes", "plain", "square", "both", "bias"),
    [(faces(), 0.5, 0.75, -0.25, 0.25), (eight_by_three(), 0.125, 0.3, -0.1, 0.075)],
    ids=["6 positions", "24 positions"],
)
def test_accelerometers_are_told_as_well_as_printed(attitudes, plain, square, both, bias):
    """Scale factor and the two misalignments of x, its square term and null shift, Fig. 14; what is known before
    (a square term of 1e-3 g) is of no weight beside readings of 1e-6 g, 1e-6 of a variance.

    Wrong: a column of the square term in m/s2 for its square, the square of the true specific force for that along a
    sensor with scale, a turn of the case that each axis counts anew, sigma instead of its square.
    """
    sigma = 1e-6 * G
    part = told(attitudes, (BLIND, sigma), ["accelerometer_scale_factor_asymmetry"])
    crossed = part("accelerometer_scale_factor x", "misalignment y", "misalignment z") / sigma**2 * G**2
    assert crossed == pytest.approx(plain * np.eye(3), rel=1e-4, abs=1e-4)
    units = np.array([G**2, 1.0])
    bent = part("accelerometer_square x", "accelerometer_null_shift x") / sigma**2 * np.outer(units, units)
    assert bent == pytest.approx(np.array([[square, both], [both, bias]]), rel=1e-4)
    sigmas = np.sqrt([plain, square, bias])
    printed = {0.5: (0.71, 0.87, 0.50), 0.125: (0.35, 0.54, 0.27)}[plain]
    assert sigmas == pytest.approx(printed, abs=0.01)  # as printed; sqrt(0.3) is 0.548


def test_gyros_are_told_as_well_as_printed_but_for_anisoelasticity():
    """Mass unbalance, quadrature and null shift from 24 positions at 0.01 deg/h, Fig. 9: 0.125, 0.125 and 0.04, 0.004,
    0.004 deg/h/g and 0.002 deg/h. Anisoelasticity is printed with 0.7 and 0.008 deg/h/g2, and is 1.0 and 0.010: of the
    24 positions four have half of g squared along both of the axes, each counts a quarter.

    Wrong: the specific force along the axis itself for that along the others, n with the square of one component.
    """
    hour = np.radians(1.0) / 3600.0
    sigma = 0.01 * hour
    rates = ["gyro_scale_factor", "gyro_scale_factor_asymmetry", "gyro_nonorthogonality"]
    part = told(eight_by_three(), (sigma, 1e-6), rates)
    names = ("gyro_g_sensitivity xx", "gyro_g_sensitivity xy", "gyro_anisoelasticity x", "gyro_null_shift x")
    units = np.array([G, G, G**2, 1.0])
    found = part(*names) / sigma**2 * np.outer(units, units)
    assert found == pytest.approx(np.diag([0.125, 0.125, 1.0, 1.0 / 24.0]), rel=1e-3, abs=1e-3)
    assert np.sqrt(np.diag(found))[[0, 1, 3]] * 0.01 == pytest.approx([0.004, 0.004, 0.002], abs=0.0005)


def test_eight_positions_tell_gyros_as_well_as_printed():
    """0.36, 0.5 and 2 for m, q and n, -0.06 between m and the null shift: 8 / 22 and -sqrt(2) / 22; sigma of the null
    shift 0.004 deg/h, sqrt(3 / 22) of 0.01. In the paper these four are all there is; m goes with the axis
    that hangs down at first, here z: rows of (a_z, a_x, a_y a_z, 1).

    Wrong: a sum of squares that is not inverted, variances of one column at a time.
    """
    a = to_body(*EIGHT.T) @ [0.0, 0.0, 1.0]
    rows = np.column_stack([a[:, 2], a[:, 0], a[:, 1] * a[:, 2], np.ones(8)])
    big = 1e4
    found = np.linalg.inv(information(rows, np.ones(8), np.full(4, big))) * big**2
    assert np.diag(found) == pytest.approx([8.0 / 22.0, 0.5, 2.0, 3.0 / 22.0], rel=1e-6)
    assert abs(found[0, 3]) == pytest.approx(np.sqrt(2.0) / 22.0, rel=1e-6)
    assert np.diag(found)[:3] == pytest.approx([0.36, 0.5, 2.0], abs=0.005)
    assert 0.01 * np.sqrt(found[3, 3]) == pytest.approx(0.004, abs=0.0005)
