"""The FMU ``ahrs_quaternion``: attitude and heading by the thesis's quaternion filter."""

from __future__ import annotations

from fmus.attitude.thesis import Thesis
from models.attitude import ahrs_quaternion
from navfmu.export import Component, State


class AhrsQuaternion(Thesis, Component):
    """Attitude and heading reference of the thesis: quaternion's error and gyro biases, six states, (4.52)-(4.60).

    With every IMU sample the quaternion is turned by the rates less their estimated biases, (4.5). Every
    `aiding_period` the filter takes

    - GPS attitude (`gps`), where it has come, as the quaternion's error, (4.59);
    - else two vectors, (4.60), field and gravity, when a new field has come: the field with what it is in n by the
      World Magnetic Model at `position` (without one, by `declination` and the dip of the first field), and the
      specific force. Their directions have the errors that make the heading's `needle_sigma` and the level's
      `tilt_sigma`.

    All else is that of `ahrs_euler`: gates or compensation of acceleration, calibration by GPS, parameters. There is no
    attitude that it cannot pass through; at 90 degrees of pitch roll and heading are not to be told apart, and their
    sigmas say so. Scheduled gains by GPS do not depend on attitude (Fig 4.17); those by vectors do as the vertical does
    in b.
    """

    model = ahrs_quaternion

    turn = State(4, "1", start=(1, 0, 0, 0), description="quaternion of C_nb")
    turn_then = State(4, "1", start=(1, 0, 0, 0), description="the same after the last aiding")
