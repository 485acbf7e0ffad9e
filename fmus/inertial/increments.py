"""Increments of angle and velocity: what they are made of, and the bundle. A part of the inertial measurement unit."""

from __future__ import annotations

import numpy as np

from models.inertial import coning, increments, sculling, series, shaping
from navfmu.export import Bundle, Output, Parameter, State, require

MOST = 4
"""Samples that a product of coning reaches over; its order is twice that."""
TRAPEZOID = [float(x) for x in series.product(coning.SHAPES["trapezoid"], coning.SHAPES["trapezoid"])[: shaping.POWERS]]
"""F^2 of the integration, by powers."""


class Increments:
    """Sums what gyros and accelerometers sense, counts whole quanta, and adds coning and sculling."""

    increment_samples = Parameter(
        kind="integer",
        start=1,
        min=1,
        max=10000,
        description="samples of an increment: it spans so many sample periods",
    )
    coning_samples = Parameter(
        kind="integer",
        start=MOST,
        min=1,
        max=MOST,
        description="samples m that a product for coning and sculling reaches over, order 2m (RTO MP-43 (1999), Mark "
        "and Tazartes, Table 1); 1: how rotations add up, and no more",
    )
    coning_fits_lag = Parameter(
        kind="boolean",
        start=False,
        description="whether the products fit what the gyros' lag passes of a cone, too (RTO MP-43 (1999), Mark and "
        "Tazartes, (A-28)); they then raise noise near the bandwidth",
    )
    angle_quantum = Parameter(
        "rad",
        start=0.0,
        min=0.0,
        display_unit="arcsec",
        description="angle of a pulse of the gyros; 0: increments are not counted in pulses",
    )
    velocity_quantum = Parameter("m/s", start=0.0, min=0.0, description="velocity of a pulse of the accelerometers")

    increment = Bundle(
        angle=Output(3, "rad", description="increment of the angle since the last one with coning, body axes"),
        velocity=Output(
            3, "m/s", description="increment of velocity with sculling, body axes; not turned to those of the beginning"
        ),
        interval=Output("s", description="time that the increments span; it ends at the time of validity"),
        description="increments",
    )

    last_rate = State(3, "rad/s", description="rate sensed at the last sample, without wide-band noise")
    last_force = State(3, "m/s2", description="specific force sensed at the last sample, without wide-band noise")
    angle_rest = State(3, "rad", description="angle sensed and not yet counted")
    velocity_rest = State(3, "m/s", description="velocity sensed and not yet counted")
    coning_numbers = State(MOST - 1, "1", description="c_1 ... c_3 of the products with past samples")
    past_angles = State((MOST - 1, 3), "rad", description="increments of the last samples, the latest first")
    past_velocities = State((MOST - 1, 3), "m/s", description="increments of the last samples, the latest first")
    interrupted = State(kind="boolean", description="a sample since the last increment was not known")
    summed = State("1", description="samples since the last increment")
    angle_sum = State(3, "rad", description="angle since the last increment")
    velocity_sum = State(3, "m/s", description="velocity since the last increment")
    coning_sum = State(3, "rad", description="coning since the last increment")
    sculling_sum = State(3, "m/s", description="sculling since the last increment")

    @require(
        "coning_fits_lag is true and gyro_bandwidth is {gyro_bandwidth} Hz; with a sample_period of {sample_period} s "
        "expected 0 or at least a tenth of the sampling rate, as products that fit a slower lag are mostly of noise"
    )
    def lag_can_be_fitted(self):
        slow = np.logical_and(self.gyro_bandwidth > 0.0, self.gyro_bandwidth * self.sample_period < 0.1)
        return np.logical_not(np.logical_and(self.coning_fits_lag, slow))

    def begin_increments(self, rate, specific_force, lag):
        """What is sensed when initialisation ends, and F^2 of the gyros' lag.

        (Not a task of its own: it would move the noise of the others.)
        """
        self.last_rate, self.last_force = rate, specific_force
        squared = [np.where(self.coning_fits_lag, x, k == 0) for k, x in enumerate(lag)]
        squared = series.product(TRAPEZOID, squared)
        numbers = [np.concatenate([coning.fitted(m, squared), np.zeros(MOST - 1 - m)]) for m in range(1, MOST)]
        self.coning_numbers = np.select(
            [self.coning_samples == m for m in range(1, MOST)], [np.zeros(MOST - 1), *numbers[:-1]], numbers[-1]
        )

    def integrate(self, rate, specific_force, rate_noise, force_noise, known):
        """Take a sample as it is sensed, the wide-band noise of its reading, and whether what is sensed is known."""
        angle = increments.trapezoid(self.last_rate, rate, self.period) + rate_noise * self.period
        velocity = increments.trapezoid(self.last_force, specific_force, self.period) + force_noise * self.period
        self.last_rate, self.last_force = rate, specific_force
        angle, self.angle_rest = increments.counted(angle, self.angle_rest, self.angle_quantum)
        velocity, self.velocity_rest = increments.counted(velocity, self.velocity_rest, self.velocity_quantum)

        angles, velocities = (
            (self.angle_sum, self.past_angles, angle),
            (self.velocity_sum, self.past_velocities, velocity),
        )
        coning_sum = self.coning_sum + coning.step(*angles, self.coning_numbers)
        sculling_sum = self.sculling_sum + sculling.step(*angles, *velocities, self.coning_numbers)
        self.past_angles = np.vstack([angle, self.past_angles[:-1]])
        self.past_velocities = np.vstack([velocity, self.past_velocities[:-1]])
        angle_sum, velocity_sum, summed = self.angle_sum + angle, self.velocity_sum + velocity, self.summed + 1.0

        ends, whole = summed >= self.increment_samples, known & ~self.interrupted
        self.increment.publish(
            angle=angle_sum + coning_sum,
            velocity=velocity_sum + sculling_sum,
            interval=summed * self.period,
            valid=whole,
            when=ends,
        )
        self.summed, self.interrupted = np.where(ends, 0.0, summed), ~(ends | whole)
        self.angle_sum, self.velocity_sum = np.where(ends, 0.0, angle_sum), np.where(ends, 0.0, velocity_sum)
        self.coning_sum, self.sculling_sum = np.where(ends, 0.0, coning_sum), np.where(ends, 0.0, sculling_sum)
