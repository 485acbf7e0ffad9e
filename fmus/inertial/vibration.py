"""What shakes the unit. A part of the inertial measurement unit."""

from __future__ import annotations

import numpy as np

from models.inertial import vibration
from navfmu.export import Input, Parameter


class Vibration:
    """Adds a vibration of one frequency to what acts on the sensors, as it is at the samples.

    The start values are a light aircraft's engine at 2400 rpm with 0.2 g (own choice).
    """

    vibrating = Input(
        kind="boolean", fault=True, description="fault F15: the unit is shaken by the vibration_ parameters"
    )
    vibration_frequency = Parameter("Hz", start=40.0, min=0.0, max=1e4, description="frequency of the vibration")
    vibration_swing_sine = Parameter(
        3,
        "rad",
        start=(3e-4, 0.0, 0.0),
        min=-0.1,
        max=0.1,
        description="s: the unit turns by s sin(2 pi f t) + c cos(2 pi f t) against the vehicle, body axes",
    )
    vibration_swing_cosine = Parameter(
        3, "rad", start=(0.0, 3e-4, 0.0), min=-0.1, max=0.1, description="c; s and c across one another are coning"
    )
    vibration_shake_sine = Parameter(
        3,
        "m/s2",
        start=(0.0, 2.0, 0.0),
        description="p: it is shaken by the specific force p sin(2 pi f t) + q cos(2 pi f t), body axes",
    )
    vibration_shake_cosine = Parameter(
        3, "m/s2", start=(0.0, 0.0, 2.0), description="q; p across s, and q across c, are sculling"
    )
    accelerometer_rectification = Parameter(
        3,
        "s2/m",
        start=1e-4,
        description="k: vibration causes a null shift of k times its mean square; 1e-4 s2/m is 1 mg/g2 (own choice)",
    )

    def shaken(self, rate, specific_force):
        """Rate and specific force that act on the shaken sensors, rad/s and m/s2."""
        frequency = 2.0 * np.pi * self.vibration_frequency
        turn = np.where(self.vibrating, frequency * self.time, 0.0)
        swing = (self.vibration_swing_sine, self.vibration_swing_cosine)
        shake = (self.vibration_shake_sine, self.vibration_shake_cosine)
        more_rate = vibration.rate(*swing, frequency, turn)
        more_force = vibration.specific_force(*swing, *shake, turn)
        more_force = more_force + vibration.rectified(*shake, self.accelerometer_rectification)
        return (
            rate + np.where(self.vibrating, more_rate, 0.0),
            specific_force + np.where(self.vibrating, more_force, 0.0),
        )
