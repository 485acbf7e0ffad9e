"""The FMU ``ahrs_euler``: attitude and heading by the thesis's filter of Euler angles."""

from __future__ import annotations

from fmus.attitude.thesis import Thesis
from models.attitude import ahrs_euler
from navfmu.export import Component, State


class AhrsEuler(Thesis, Component):
    """Attitude and heading reference of the thesis: Euler angles and gyro biases, six states, (4.32)-(4.51).

    With every IMU sample (the thesis has 20 Hz) heading, pitch and roll are advanced by the rates less their estimated
    biases, (4.45). Every `aiding_period` (2 Hz) the filter takes

    - GPS attitude (`gps`), where it has come: three angles with the noise `gps_sigma`, (4.47)-(4.51). It calibrates the
      gyros; and where there is a position, too, the hard iron is learned, as what the field has more than the World
      Magnetic Model turned into b;
    - else level and needle (thesis section 4.12), (4.8), (4.9), (2.3), with `tilt_sigma` and `needle_sigma`, when
      a new field has come. They are not taken where the yaw rate that is computed from heading, (4.67), is beyond
      `turn_limit`, or the specific force is beyond `force_limit`: in turns the gyros are alone. With `compensated` they
      are always taken, and w x (V, 0, 0) by airspeed V and rates, with which the vertical shows in turns, too, is
      taken out of the specific force. Without air data (not connected, not valid, older than `air_timeout`) the gates
      hold.

    *Gains* are `computed`, (4.46) and (4.50), or `scheduled`: those that they come to in the end, as a function
    of attitude (Fig 4.16), from a Riccati equation that is solved at the start. Scheduled gains know nothing of the
    first minutes, in which biases are far off, and the sigmas that are published with them are those in the end. They
    suppose that something comes at each aiding.

    *What it cannot do.* Pitch of 90 degrees. What the thesis leaves out is left out: that the specific force in
    straight flight shows the wind's changes (`ahrs` learns how much), dip, disturbed fields.

    Tables 4.2 to 4.4 are parameter sets. `alpha` is in samples, as in `ahrs`: 0.2 of Table 4.2 is 0.89 here.

    At the first GPS attitude, or field with specific force, the angles are set; until then `attitude.valid` is
    false.
    """

    model = ahrs_euler

    turn = State(3, "rad", display_unit="deg", description="heading, pitch, roll")
    turn_then = State(3, "rad", display_unit="deg", description="the same after the last aiding")
