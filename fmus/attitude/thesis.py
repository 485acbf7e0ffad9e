"""What the two attitude filters of the thesis have in common: all but the attitude's own equations."""

from __future__ import annotations

from enum import IntEnum
from types import ModuleType

import numpy as np

from fmus import examples
from fmus.attitude.interface import Reference
from models.attitude import ahrs, attitude, gyro_axis
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Example, Output, Parameter, ParameterSet, State, every, on_new, start

RATE = 20.0
"""Samples of the gyros in a second, thesis p. 132."""
GYRO = {"gyro_noise": np.radians(0.05), "gyro_drift_sigma": np.radians(0.05), "gyro_drift_time": 1000.0}
PERIODS = {"sample_period": 1.0 / RATE, "aiding_period": 0.5}


def _table(source: str, alpha: float, beta: float, **more: float) -> ParameterSet:
    """Values of a table. R_wn (4.43) is the variance of a sample taken for a density, so alpha is 1 / sqrt(period) of
    that in samples."""
    values = {**PERIODS, **GYRO, "alpha": alpha * float(np.sqrt(RATE)), "beta": beta, "gyro_scale_sigma": 0.0, **more}
    return ParameterSet(source, values)


IDENTITY = float(np.radians(1.0) / np.sqrt(2.0 * GYRO["gyro_drift_sigma"] ** 2 / GYRO["gyro_drift_time"]))
"""What beta is multiplied by where R_wb is not (4.44) but the identity, in (deg/s)^2/s."""
SETS = {
    "table_4_2": _table(
        "Thesis Table 4.2, Horizon gyros and GPS attitude, gains scheduled. beta 2e-4 belongs to the identity in place "
        "of (4.44), in (deg/s)^2/s: so biases settle in 3 to 4 minutes (Fig 4.10); with (4.44) they take hours.",
        0.2,
        2.0e-4 * IDENTITY,
        gains=2,
    ),
    "table_4_3_slow": _table("Thesis Table 4.3, slow poles: Horizon gyros, simulated, and GPS.", 10.0, 1.0, gains=2),
    "table_4_3_fast": _table("Thesis Table 4.3, fast poles: Horizon gyros, simulated, and GPS.", 10.0, 10.0, gains=2),
    "table_4_4": _table(
        "Thesis Table 4.4, level and needle with the gates of p. 149, gains scheduled. beta 1e-5 is so small that no "
        "bias is learned.",
        10.0,
        1.0e-5 * IDENTITY,
        gains=2,
        tilt_sigma=np.radians(0.06),
        needle_sigma=np.radians(0.8),
    ),
}  # fmt: skip


class Gains(IntEnum):
    """How the gains come about, thesis p. 129."""

    computed = 1
    scheduled = 2


DIP_TIME = 600.0
"""s over which the dip is averaged (own choice): errors of the level by wind last for minutes, and an airliner flies
through a degree of dip."""
NOTHING, LEVEL, GPS = range(3)
"""What an aiding took."""


class Thesis(Reference):
    """Base of a filter whose ``model`` is ``models.attitude.ahrs_euler`` or ``ahrs_quaternion``."""

    model: ModuleType
    tick = "sample_period"
    parameter_sets = SETS
    example = Example(
        {"sample_period": 0.05},
        text="A full circle at 3 deg/s in level flight (60 to 184 s), with gyros that are wrong by 0.15 deg/s in roll "
        "and -0.1 deg/s in yaw. Their biases are learned before. In the turn nothing aids (`aiding` is 0): gyros carry "
        "the angles on, and sigmas grow.",
        duration=300.0,
        step=0.05,
        inputs=examples.ahrs_inputs,
        shows=("gyro_bias", "attitude.heading_sigma", "aiding"),
        panels=examples.ahrs_panels,
    )

    # of no meaning here
    airspeed_time = blind_airspeed_sigma = dip_sigma = dip_walk = had_air = None

    gains = Parameter(kind="enumeration", items=Gains, description="computed (4.46), (4.50), or scheduled")
    compensated = Parameter(
        kind="boolean",
        description="whether the acceleration that airspeed and rates say is taken out of the specific force, and "
        "nothing is gated while there are air data; false: the gates of thesis section 4.12",
    )
    turn_limit = Parameter(
        "rad/s",
        start=np.radians(0.5),
        min=0.0,
        display_unit="deg/s",
        description="computed yaw rate (4.67) beyond which level and field are not taken",
    )
    force_limit = Parameter(
        "1", start=1.05, min=0.0, description="specific force over g beyond which they are not (thesis p. 150)"
    )
    beta = Parameter("1", start=1.0, min=0.0, description="tuning factor on the gyro drift (thesis (4.39))")
    tilt_sigma = Parameter(
        "rad",
        start=np.radians(4.0),
        min=1.0e-6,
        display_unit="deg",
        description="error of roll and pitch by one mean specific force: the wind of (3.36), 5 m/s and 400 s, changes "
        "by 2.9 deg of g in 0.5 s (thesis Table 4.4: 0.06 deg, the accelerometers' own noise)",
    )
    needle_sigma = Parameter(
        "rad",
        start=np.radians(3.0),
        min=1.0e-6,
        display_unit="deg",
        description="error of heading by one field sample where the level is known, at a dip of 60 degrees; it goes "
        "with 1 / cos(dip) (thesis Table 4.4: 0.8 deg)",
    )
    aiding = Output(
        kind="integer",
        description="what the last aiding took: 0 nothing, 1 level and field, 2 GPS attitude (thesis Fig 4.18)",
    )
    computed_yaw_rate = Output("rad/s", display_unit="deg/s", description="change of heading between aidings (4.67)")

    covariance = State(21, "1", description="upper triangle of the filter's covariance, row by row (computed gains)")
    axes = State((3, 2, 2), "1", description="covariances of angle and bias of heading, pitch, roll (scheduled gains)")
    scheduled_gps = State(2, "1", description="gain of an angle and of its gyro's bias at rest, by GPS attitude")
    scheduled_tilt = State(2, "1", description="the same of roll and pitch, by specific force")
    scheduled_needle = State(2, "1", description="the same of heading, by the field")
    rest_gps = State((2, 2), "1", description="covariance of angle and bias after an update at rest, by GPS attitude")
    rest_tilt = State((2, 2), "1", description="the same of roll and pitch, by specific force")
    rest_needle = State((2, 2), "1", description="the same of heading, by the field")
    rate = State(3, "rad/s", description="last rate less bias")
    force = State(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="last specific force")
    since = State("s", description="time since the last aiding")
    rotation_sum = State(3, "rad", description="integral of the rate in b since the last aiding")
    force_sum = State(3, "m/s", description="integral of the specific force in n since the last aiding")
    iron_variance = State("1", description="variance of the hard iron")
    dips = State("1", description="samples that the dip is the mean of; that of a chart counts as ten minutes")
    field_n = State(3, "T", description="field at the last known position, n")

    def densities(self):
        """Those of the noise of the angles, rad^2/s, and of the biases, rad^2/s^3: (4.39), (4.43), (4.44)."""
        return (
            (self.alpha * self.gyro_noise) ** 2 * self.sample_period,
            self.beta**2 * 2.0 * self.gyro_drift_sigma**2 / self.gyro_drift_time,
        )

    @start
    def schedule(self):
        self.iron_variance = self.hard_iron_sigma**2
        at_rest = [
            gyro_axis.scheduled(*self.densities(), sigma, self.aiding_period)
            for sigma in (self.gps_sigma, self.tilt_sigma, self.needle_sigma)
        ]
        (self.scheduled_gps, self.rest_gps), (self.scheduled_tilt, self.rest_tilt) = at_rest[:2]
        self.scheduled_needle, self.rest_needle = at_rest[2]

    @every("chart_period")
    def look_up(self):
        field_n, turned = self.chart()
        # GPS attitude is from true north
        by_field = self.time - self.gps_time > self.gps_timeout
        by = np.where(by_field, attitude.wrap(turned), 0.0)
        self.turn = self.model.headed(self.turn, by)
        self.turn_then = self.model.headed(self.turn_then, by)
        down = np.arctan2(field_n[2], np.sqrt(field_n[0] * field_n[0] + field_n[1] * field_n[1]))
        self.dip = np.where(self.charted, down, self.dip)
        self.field_n = np.where(self.charted, field_n, self.field_n)

    @on_new("imu")
    def integrate(self):
        step = self.imu_step()
        known = self.imu_told()
        rate = np.where(known, self.imu.rate - self.gyro_bias, self.rate)
        force = np.where(known, self.imu.specific_force, self.force)
        rotation = 0.5 * step * (rate + self.rate)
        self.turn = self.model.turned(self.turn, rotation)
        roll, pitch, heading = self.model.angles(self.turn)
        self.rotation_sum = self.rotation_sum + rotation
        self.force_sum = self.force_sum + step * self.model.dcm(self.turn) @ force
        self.since = self.since + step
        self.rate = rate
        self.force = force
        self.imu_time = self.imu.time_of_validity
        yaw_rate = (rate[1] * np.sin(roll) + rate[2] * np.cos(roll)) / np.maximum(np.cos(pitch), 1.0e-6)
        self.tell((roll, pitch, heading), yaw_rate, known)

    @every("aiding_period")
    def aid(self):
        model = self.model
        time = self.since
        felt = time > 1.0e-6
        over = np.where(felt, time, 1.0)
        rate = self.rotation_sum / over

        # what aids: GPS attitude, carried on to the last sample
        new_gps = felt & self.new_gps()
        age = self.before(self.gps)
        told = np.where(new_gps, np.stack([self.gps.roll, self.gps.pitch, self.gps.heading]), 0.0)
        by_gps = model.turned(model.of_angles(*told), rate * np.where(new_gps, age, 0.0))
        gps_time = np.where(new_gps, self.time, self.gps_time)
        calibrating = self.time - gps_time <= self.gps_timeout

        # and level and field, turned on to it
        age = self.before(self.field)
        new_field = felt & self.new_field() & (ahrs.length(self.field.field_b) > 1.0e-9)
        field_b = np.where(new_field, self.field.field_b, 0.0)
        field_b = field_b - np.where(new_field, age, 0.0) * np.cross(rate, field_b)
        strength = np.where(self.charted, ahrs.length(self.field_n), ahrs.length(field_b))
        field_b = np.where(new_field, field_b / np.maximum(strength, 1.0e-9), np.array([1.0, 0.0, 0.0]))
        level_b = field_b - self.hard_iron
        c_bn = model.dcm(self.turn).T
        force = np.where(felt, c_bn @ self.force_sum / over, np.array([0.0, 0.0, -STANDARD_GRAVITY]))
        turning = ahrs.turning_acceleration(self.airspeed_seen, rate)
        compensated = self.compensated & self.fresh_air()
        minus_g = force - np.where(compensated, turning, 0.0)
        _, _, heading = model.angles(self.turn)
        _, _, before = model.angles(self.turn_then)
        yaw_rate = attitude.wrap(heading - before) / over
        straight = np.abs(yaw_rate) <= self.turn_limit
        light = ahrs.length(force) <= self.force_limit * STANDARD_GRAVITY
        open_ = compensated | (straight & light)
        heavy = ahrs.length(minus_g) > 0.1 * STANDARD_GRAVITY
        new_level = new_field & heavy & open_ & np.logical_not(calibrating)

        # initial alignment
        roll, pitch = ahrs.level(minus_g, np.zeros(3))
        magnetic, down = ahrs.levelled_heading(level_b, roll, pitch)
        by_needle = model.of_angles(roll, pitch, magnetic + self.local_declination)
        align = np.logical_not(self.aligned) & (new_gps | new_field)
        turn = np.where(align, np.where(new_gps, by_gps, by_needle), self.turn)

        # without a chart, the dip is the mean of what field and level show
        seen = new_field & np.logical_not(self.charted) & ((heavy & open_) | (self.dips < 0.5))
        most = DIP_TIME / self.aiding_period
        self.dips = np.where(self.charted, most, np.minimum(self.dips + np.where(seen, 1.0, 0.0), most))
        shown = np.where(seen, np.arcsin(np.clip(down, -1.0, 1.0)), 0.0)
        dip = np.where(seen, self.dip + (shown - self.dip) / np.maximum(self.dips, 1.0), self.dip)
        needle = ahrs.declination_at(self.needle_sigma, dip)

        # time update
        angle, bias = self.densities()
        gyro = self.gyro_null_shift_sigma**2 + self.gyro_drift_sigma**2
        lasting = self.gyro_scale_sigma * self.rotation_sum
        white = angle * time + lasting**2 * ahrs.TURN_TIME / over
        phi = model.transition(self.turn_then, self.rotation_sum, time)
        moved = kalman.propagate(self.covariance, phi, np.ones(3), np.zeros(6))
        moved = moved + kalman.pack(gyro_axis.noises(model.driven(self.turn_then), white, bias, time))
        first = np.where(new_gps, self.gps_sigma, self.initial_sigma)
        levelled = np.minimum(needle**2 + (np.tan(dip) * self.initial_sigma) ** 2, 1.0)
        squares = np.stack([np.where(new_gps, first**2, levelled), first**2, first**2])
        none = np.zeros((3, 3))
        above = np.concatenate([model.begun(turn, squares), none], axis=1)
        begun = np.concatenate([above, np.concatenate([none, gyro * np.eye(3)], axis=1)])
        covariance = np.where(align, kalman.pack(begun), moved)
        axes = np.stack([gyro_axis.carried(axis, angle, bias, time) for axis in self.axes])
        fresh = np.stack([gyro_axis.diagonal(square, gyro) for square in squares])
        axes = np.where(align, fresh, axes)

        # measurement update, gains computed
        running = self.aligned
        use_gps, use_level = new_gps & running, new_level & running
        spread = np.stack([needle, self.tilt_sigma, self.tilt_sigma])
        gps = model.by_angles(turn, by_gps, self.gps_sigma * np.ones(3))
        level = model.by_vectors(turn, level_b, minus_g, dip, self.local_declination, spread)
        correction = np.zeros(6)
        for (residuals, rows, variances), use in ((gps, use_gps), (level, use_level)):
            for i in range(len(variances)):
                row = np.concatenate([rows[i], np.zeros(3)])
                correction, covariance, _ = kalman.update(correction, covariance, row, variances[i], residuals[i], use)

        # or scheduled
        by_one = np.stack([self.scheduled_gps] * 3)
        by_two = np.stack([self.scheduled_needle, self.scheduled_tilt, self.scheduled_tilt])
        steps = [
            np.where(use, model.scheduled(turn, gains) @ _shown(*measured), 0.0)
            for measured, gains, use in ((gps, by_one, use_gps), (level, by_two, use_level))
        ]
        axes = np.where(use_gps, np.stack([self.rest_gps] * 3), axes)
        axes = np.where(use_level, np.stack([self.rest_needle, self.rest_tilt, self.rest_tilt]), axes)
        scheduled = self.gains == Gains.scheduled
        correction = np.where(scheduled, steps[0] + steps[1], correction)

        turn = model.corrected(turn, correction[:3])
        turns = np.where(scheduled, model.begun(turn, axes[:, 0, 0]), kalman.unpack(covariance)[:3, :3])
        squares = model.variances(turn, turns)
        known = np.isfinite(np.sum(turn) + np.sum(squares)) & (np.min(squares) >= 0.0)
        lost = np.logical_not(known & (np.min(squares) < np.pi * np.pi))
        begin = np.logical_not(running | align) | lost
        at_first = model.of_angles(0.0 * angle, 0.0 * angle, 0.0 * angle)
        self.aligned = np.logical_not(begin)
        self.turn = np.where(lost, at_first, turn)
        self.turn_then = self.turn
        self.covariance = np.where(begin, 0.0, covariance)
        self.axes = np.where(begin, 0.0, axes)
        self.dip = dip
        measured = self.rate + self.gyro_bias
        self.gyro_bias = np.where(begin, 0.0, self.gyro_bias + correction[3:])
        self.rate = measured - self.gyro_bias

        # the hard iron, which GPS attitude and position show
        shown = field_b - model.dcm(turn).T @ self.field_n / np.maximum(strength, 1.0e-9)
        learn = new_field & calibrating & running & self.charted & np.logical_not(begin)
        share = np.where(learn, self.iron_variance / (self.iron_variance + self.field_sigma**2), 0.0)
        self.hard_iron = self.hard_iron + share * np.where(learn, shown - self.hard_iron, 0.0)
        self.iron_variance = (1.0 - share) * self.iron_variance

        self.field_seen = np.where(new_field, self.field.sequence, self.field_seen)
        self.gps_seen = np.where(new_gps, self.gps.sequence, self.gps_seen)
        self.gps_time = gps_time
        self.aiding = np.where(use_gps, GPS, np.where(use_level, LEVEL, NOTHING))
        self.computed_yaw_rate = np.where(felt, yaw_rate, self.computed_yaw_rate)
        self.since = 0.0
        self.rotation_sum = np.zeros(3)
        self.force_sum = np.zeros(3)

        self.sigmas = np.sqrt(np.where(begin, 0.0, squares) + self.unseen() ** 2)


def _shown(residuals, rows, variances):
    """The first three states as the innovations alone show them, (4.31) with weights."""
    weighted = rows.T / variances
    return np.linalg.solve(weighted @ rows, weighted @ residuals)
