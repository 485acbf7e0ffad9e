"""Where the accelerometers sit. A part of the inertial measurement unit."""

from __future__ import annotations

import numpy as np

from models.inertial import lever_arm
from navfmu.export import Parameter, State


class LeverArm:
    """Adds to the specific force what it is more at the accelerometers, from the rate and its last two samples."""

    lever_arm = Parameter(
        3,
        "m",
        start=0.0,
        min=-100.0,
        max=100.0,
        description="where the accelerometers are, from where specific_force holds, body axes",
    )
    last_rates = State(2, 3, "rad/s", description="true rate at the last two samples, the latest first")

    def begin_rates(self):
        """The vehicle has turned at this rate before."""
        self.last_rates = np.stack([self.rate, self.rate])

    def force_at_the_arm(self):
        """True specific force at the accelerometers, m/s2."""
        acceleration = lever_arm.acceleration(self.rate, self.last_rates[0], self.last_rates[1], self.sample_period)
        return lever_arm.moved(self.specific_force, self.rate, acceleration, self.lever_arm)

    def remember_rate(self):
        """What is now is past at the next sample."""
        self.last_rates = np.stack([self.rate, self.last_rates[0]])
