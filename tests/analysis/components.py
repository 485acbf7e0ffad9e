"""A navigator whose errors and claims have closed forms, and what tells it one of its sigmas."""

from __future__ import annotations

import numpy as np

from navfmu.export import Component, Input, Output, Parameter, State, every, start


class Drifter(Component):
    """Errors x = slope t + offset_x, y = slope t / 2 + offset_y + bend x^2, each of the three drawn once."""

    told_offset = Input("m", start=3.0, min=0.0, description="standard deviation of both offsets as it is told")
    x_error = Output("m", description="error along the first axis")
    y_error = Output("m", description="error along the second axis")
    covariance = Output(3, "m2", description="of both errors as claimed: xx, xy, yy")
    running = Output(kind="boolean", description="from 2 s on")

    slope_sigma = Parameter("m/s", start=0.4, min=0.0, description="standard deviation of the slope")
    offset_sigma = Parameter(2, "m", start=(3.0, 3.0), min=0.0, description="standard deviations of the offsets")
    idle_sigma = Parameter("m", start=1.0, min=0.0, description="of nothing")
    told_slope = Parameter("m/s", start=0.4, min=0.0, description="standard deviation of the slope as it is told")
    bend = Parameter("1/m", start=0.0, description="what is not linear")
    nothing = Parameter("s", start=1e9, description="time from which there is no number")
    sample_period = Parameter("s", start=1.0, min=0.01, description="time between values")
    drawn = State(3, "1", description="what was drawn")

    @start
    def draw(self, noise):
        self.drawn = noise(3)

    @every("sample_period")
    def wander(self):
        slope, offset = self.slope_sigma * self.drawn[0], self.offset_sigma * self.drawn[1:]
        x = slope * self.time + offset[0]
        self.x_error = np.where(self.time > self.nothing, np.sqrt(self.nothing - self.time), x)
        self.y_error = 0.5 * slope * self.time + offset[1] + self.bend * x * x
        way, still = (self.told_slope * self.time) ** 2, self.told_offset**2
        self.covariance = np.stack([way + still, 0.5 * way, 0.25 * way + still])
        self.running = self.time > 1.5


class Teller(Component):
    """Tells the drifter what its offsets are."""

    offset = Output("m", description="standard deviation of the offsets")
    value = Parameter("m", start=3.0, description="what is told")

    @start
    def tell(self):
        self.offset = self.value


ALL = [Drifter, Teller]
