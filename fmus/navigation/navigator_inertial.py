"""The FMU ``navigator_inertial``: an inertial navigator, aided by GPS, by pressure altitude and by DME."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.grades import GRADES, inertial_parameters
from fmus.navigation.interface import LONGEST_DELAY, MOMENTS, PLACES, Navigation, known_share
from fmus.navigation.small_aircraft import INERTIAL
from models.attitude import attitude, quaternion
from models.attitude.ahrs_velocity import euler_sigmas
from models.filters import kalman
from models.navigation import inertial, navigator
from models.processes import past
from models.processes.known import known, told
from models.radio import dme
from models.satellite import gps
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, ParameterSet, State, every, on_new

OFFSET, BIASES = inertial.STATES, slice(inertial.STATES + 1, inertial.STATES + 1 + PLACES)
STATES = inertial.STATES + 1 + PLACES
APART = LONGEST_DELAY / (MOMENTS - 2)
"""How far moments of the past are apart at least, s."""
RATE_MOST, FORCE_MOST = 100.0, 500.0
"""What no sample of an aircraft is beyond, rad/s, m/s2."""
BEGUN_ANEW = 1.0e8
"""Variance of what is not believed at all, in variances of what it is begun anew from."""
_DEFAULT = inertial_parameters("automotive")
SETS = {
    grade: ParameterSet(
        f"An inertial unit of {grade} grade (thesis Table 5.2, p. 176), with its turn-on errors as `imu` has them.",
        inertial_parameters(grade),
    )
    for grade in GRADES
} | {
    f"table_5_2_{grade}": ParameterSet(
        f"The analysis of thesis section 5.5: {grade} grade, no error at the last fix (5.60), no turn-on errors, and "
        "the altitude is held.",
        {
            **inertial_parameters(grade),
            "gyro_null_shift_sigma": 0.0,
            "accelerometer_null_shift_sigma": 0.0,
            "gyro_scale_sigma": 0.0,
            "level_sigma": 0.0,
            "known_share": 1.0,
            "pressure_walk": 0.0,
        },
    )
    for grade in GRADES
}


class NavigatorInertial(Navigation, Component):
    """Inertial navigator: specific force and rate are integrated to velocity, position and attitude.

    Thesis section 5.4: (5.36), (5.37) in north, east and down on the WGS-84 ellipsoid, from samples of `imu`, and the
    error model (5.38)-(5.56) with fifteen states in an extended Kalman filter: position, velocity, tilt, and biases of
    accelerometers and gyros. To these come what pressure altitude is wrong by, and the bias of each station's ranges,
    which are Gauss-Markov (3.38) or, the first, a random walk.

    *Beginning.* With a fix, and roll, pitch and heading of an attitude reference, whose sigmas are those of the tilt.
    Later on it is not looked at, but where a fix finds a tilt of more than `tilt_limit`: then it begins anew.

    *Phases* are those of `navigator`: each fix corrects position and velocity (`mode` 1), and after GPS is lost each
    range along its line of sight (`mode` 2). A fix is compared with what the navigator was at its time of validity,
    from a past of a second. One that is beyond the gate is believed: position and velocity are begun anew.

    *Vertical channel.* An inertial altitude runs away, with a time constant of 9.5 minutes. Pressure altitude is a
    measurement like others: its error walks by `pressure_walk` and has noise of `pressure_noise`. (3.34) has 23 m for
    400 s, which gains as much in short.

    *Biases* are one process for what is constant after turn-on and what drifts: it has the variance of both and gains
    in short what the drift does. White noise has the density of `gyro_noise` at one sample every `noise_period`.

    *Ranges* as `navigator_full` has them: a range is refused beyond `innovation_gate`; one that is refused twice in a
    row widens position by what its variance lacks, as far as it is news, unless outvoted.

    Over `gap_limit` without inertial samples it does not know where it is, until there is a fix.
    """

    tick = "sample_period"
    parameter_sets = SETS | {"small_aircraft": INERTIAL}
    example = Example(
        text="Level flight to the west at 90 kn with biases of 0.02 deg/s and 5 mg that nobody knows. GPS is lost at "
        "300 s (dotted): what it has learned of the biases carries the position for a minute, and ranges from then on "
        "(dashed: three sigma).",
        duration=600.0,
        step=0.05,
        mark=examples.GPS_LOST,
        inputs=examples.inertial_inputs,
        periods={"imu": 0.05, "air": 0.1, "fix": 1.0, "ranging": 15.0},
        shows=("gyro_bias", "accelerometer_bias", "innovation", "mode"),
        panels=examples.navigator_panels,
    )

    imu = Bundle(
        rate=Input(3, "rad/s", display_unit="deg/s", description="angular rate, body axes"),
        specific_force=Input(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="specific force, body axes"),
        description="inertial measurement",
    )
    attitude = Bundle(
        roll=Input("rad", display_unit="deg", description="roll"),
        pitch=Input("rad", display_unit="deg", description="pitch"),
        heading=Input("rad", display_unit="deg", description="true heading"),
        yaw_rate=Input("rad/s", display_unit="deg/s", description="rate of heading"),
        roll_sigma=Input(
            "rad", start=np.radians(1.0), min=0.0, display_unit="deg", description="standard deviation of roll"
        ),
        pitch_sigma=Input(
            "rad", start=np.radians(1.0), min=0.0, display_unit="deg", description="standard deviation of pitch"
        ),
        heading_sigma=Input(
            "rad",
            start=np.radians(2.5),
            min=0.0,
            display_unit="deg",
            description="standard deviation of heading (thesis (3.84), p. 101: 2.5 deg)",
        ),
        description="attitude to begin with",
    )

    sample_period = Parameter(
        "s", start=0.01, min=1.0e-4, max=1.0, description="period at which new IMU samples are looked for"
    )
    filter_period = Parameter("s", start=0.1, min=1.0e-3, max=1.0, description="period of the Kalman filter")
    gap_limit = Parameter(
        "s",
        start=1.0,
        min=0.0,
        max=60.0,
        description="time without inertial samples over which nothing is carried (own choice)",
    )
    gyro_noise = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_noise"],
        min=0.0,
        display_unit="deg/s",
        description="wide-band noise of a gyro sample (thesis Table 5.2)",
    )
    accelerometer_noise = Parameter(
        "m/s2",
        start=_DEFAULT["accelerometer_noise"],
        min=0.0,
        description="wide-band noise of an accelerometer sample (thesis Table 5.2)",
    )
    noise_period = Parameter(
        "s",
        start=0.01,
        min=1.0e-6,
        max=100.0,
        description="time between the samples that have this noise: 0.01 where it is that of samples at 100 Hz, 1 "
        "where the density is its square over 1 Hz",
    )
    gyro_drift_sigma = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_drift_sigma"],
        min=0.0,
        display_unit="deg/s",
        description="standard deviation of the gyro drift (thesis Table 5.2)",
    )
    gyro_drift_time = Parameter(
        "s", start=_DEFAULT["gyro_drift_time"], min=1.0, description="correlation time of the drift (thesis Table 5.2)"
    )
    gyro_null_shift_sigma = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_null_shift_sigma"],
        min=0.0,
        display_unit="deg/s",
        description="standard deviation of the gyros' null shift",
    )
    gyro_scale_sigma = Parameter(
        "1",
        start=_DEFAULT["gyro_scale_sigma"],
        min=0.0,
        description="standard deviation of the gyros' scale factor error and mounting",
    )
    turn_time = Parameter("s", start=60.0, min=0.0, description="time for which a rate lasts in one direction")
    accelerometer_drift_sigma = Parameter(
        "m/s2",
        start=_DEFAULT["accelerometer_drift_sigma"],
        min=0.0,
        description="standard deviation of the accelerometer drift (thesis Table 5.2)",
    )
    accelerometer_drift_time = Parameter(
        "s",
        start=_DEFAULT["accelerometer_drift_time"],
        min=1.0,
        description="correlation time of the drift (thesis Table 5.2)",
    )
    accelerometer_null_shift_sigma = Parameter(
        "m/s2",
        start=_DEFAULT["accelerometer_null_shift_sigma"],
        min=0.0,
        description="standard deviation of the accelerometers' null shift",
    )
    level_sigma = Parameter(
        "rad",
        start=_DEFAULT["level_sigma"],
        min=0.0,
        display_unit="deg",
        description="least standard deviation of roll and pitch at the beginning, beside what their reference says: "
        "that has the same accelerometers",
    )
    known_share = known_share()
    altitude_sigma = Parameter(
        "m",
        start=gps.VERTICAL_SIGMA,
        min=1.0e-3,
        description="standard deviation of the altitude of a fix (thesis section 3.10)",
    )
    pressure_walk = Parameter(
        "m",
        start=23.0 * np.sqrt(2.0 / 400.0),
        min=0.0,
        description="random walk, in one second, of what pressure altitude is wrong by: sigma sqrt(2 / tau) of thesis "
        "(3.34), p. 66",
    )
    pressure_noise = Parameter(
        "m",
        start=3.0,
        min=1.0e-3,
        description="noise of a sample of pressure altitude (own choice: AGARD CP-298, p. 15-11, has 2.7 m)",
    )
    tilt_limit = Parameter(
        "rad",
        start=0.3,
        min=0.0,
        display_unit="deg",
        description="standard deviation of tilt beyond which a fix begins anew with the attitude reference: sines are "
        "then no longer angles (own choice)",
    )

    angles = Bundle(
        roll=Output("rad", display_unit="deg", description="roll"),
        pitch=Output("rad", display_unit="deg", description="pitch"),
        heading=Output("rad", display_unit="deg", description="true heading in [-pi, pi)"),
        roll_sigma=Output("rad", display_unit="deg", description="standard deviation of roll"),
        pitch_sigma=Output("rad", display_unit="deg", description="standard deviation of pitch"),
        heading_sigma=Output("rad", display_unit="deg", description="standard deviation of heading"),
        description="attitude of the inertial navigator",
    )
    gyro_bias = Output(3, "rad/s", display_unit="deg/s", description="estimated biases of the gyros, body axes")
    accelerometer_bias = Output(3, "m/s2", description="estimated biases of the accelerometers, body axes")
    state_sigma = Output(
        STATES,
        "1",
        description="standard deviations of the filter's states: position north, east, up (m), velocity north, east, "
        "down (m/s), tilt about north, east, down (rad), biases of accelerometers (m/s2) and gyros (rad/s), error of "
        "pressure altitude (m), bias of each station's ranges (m)",
    )

    position = State(3, "1", description="latitude, longitude (rad) and altitude (m) at the last inertial sample")
    velocity_n = State(3, "m/s", description="velocity over ground then")
    turn = State(4, "1", start=(1, 0, 0, 0), description="quaternion of C_nb then")
    rate = State(3, "rad/s", description="last rate less bias")
    force = State(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="last specific force less bias")
    imu_time = State("s", start=-1.0e9, description="time of validity of the last inertial sample")
    past_times = State(MOMENTS, "s", description="moments of the past")
    past_velocities = State((MOMENTS, 3), "m/s", description="velocity over ground then")
    since = State("s", description="time that is summed since the last prediction")
    force_sum = State(3, "m/s", description="integral of the specific force in n")
    dcm_sum = State((3, 3), "s", description="integral of C_nb")
    square_sum = State(3, "1", description="integral of the squares of the rates in n, rad^2/s")
    pressure_error = State("m", description="estimate of pressure altitude less altitude")
    range_bias = State(PLACES, "m", description="estimated bias of each station's ranges")
    upper = State(STATES * (STATES + 1) // 2, "1", description="upper triangle of the filter's covariance, row by row")
    angle_sigmas = State(3, "rad", display_unit="deg", description="standard deviations of roll, pitch and heading")
    air_seen = State(kind="integer", description="sequence number of the last air data used")
    fix_seen = State(kind="integer", description="sequence number of the last fix used")
    ranging_seen = State(kind="integer", description="sequence number of the last ranges used")

    def imu_told(self):
        """Whether the sample of the inertial unit is one of numbers."""
        rate, force = np.max(np.abs(self.imu.rate)), np.max(np.abs(self.imu.specific_force))
        return told(self.imu.valid & (rate <= RATE_MOST) & (force <= FORCE_MOST), rate, force)

    def attitude_told(self):
        """Whether there is an attitude."""
        one = self.attitude
        sigmas = one.roll_sigma + one.pitch_sigma + one.heading_sigma
        return told(one.valid, one.roll, one.pitch, one.heading, one.yaw_rate, sigmas)

    @on_new("imu")
    def integrate(self):
        good = self.imu_told()
        step = np.where(good, np.maximum(self.imu.time_of_validity - self.imu_time, 0.0), 0.0)
        begins = good & (step > self.gap_limit)
        self.initialised = self.initialised & np.logical_not(begins)
        step = np.where(begins, 0.0, step)
        rate = np.where(good, self.imu.rate - self.gyro_bias, self.rate)
        force = np.where(good, self.imu.specific_force - self.accelerometer_bias, self.force)
        mean, felt = 0.5 * (rate + self.rate), 0.5 * (force + self.force)
        position, velocity_n, turn = inertial.strapdown(self.position, self.velocity_n, self.turn, mean, felt, step)
        middle = quaternion.dcm(quaternion.product(self.turn, quaternion.of_rotation(0.5 * step * mean)))
        moving = self.initialised
        self.position = np.where(moving, position, self.position)
        self.velocity_n = np.where(moving, velocity_n, self.velocity_n)
        self.turn = np.where(moving, turn, self.turn)
        self.since = self.since + step
        self.force_sum = self.force_sum + step * (middle @ felt)
        self.dcm_sum = self.dcm_sum + step * middle
        self.square_sum = self.square_sum + step * (middle @ mean) ** 2
        self.rate, self.force = rate, force
        self.imu_time = np.where(good, self.imu.time_of_validity, self.imu_time)
        times, velocities = past.remember(self.past_times, self.past_velocities, self.imu_time, self.velocity_n, APART)
        self.past_times = np.where(good, times, self.past_times)
        self.past_velocities = np.where(good, velocities, self.past_velocities)

    def predicted(self):
        """Covariance at the last inertial sample, (6.31) with F (5.40)."""
        time = self.since
        over = np.where(time > 0.0, time, 1.0)
        matrix = inertial.dynamics(self.position, self.velocity_n, self.force_sum / over, self.dcm_sum / over)
        matrix = inertial.transition(matrix, time)
        rows = np.concatenate([matrix, np.zeros((inertial.DRIVEN, STATES - inertial.STATES))], axis=1)
        force, force_time = inertial.slow(
            self.accelerometer_null_shift_sigma, self.accelerometer_drift_sigma, self.accelerometer_drift_time
        )
        rate, rate_time = inertial.slow(self.gyro_null_shift_sigma, self.gyro_drift_sigma, self.gyro_drift_time)
        speed = np.sqrt(np.sum(self.velocity_n[:2] * self.velocity_n[:2]))
        bias_time = self.correlation_distance / np.maximum(speed, 1.0)
        three, places = np.ones(3), np.ones(PLACES)
        decay = np.exp(
            -time / np.concatenate([force_time * three, rate_time * three, 1.0e12 * np.ones(1), bias_time * places])
        )
        sigmas = np.concatenate([force * three, rate * three, np.zeros(1), self.bias_sigma * places])
        gained = sigmas**2 * (1.0 - decay * decay)
        walk = self.pressure_walk**2 * time * np.concatenate([np.zeros(6), np.ones(1), np.zeros(PLACES)])
        tilt = self.gyro_noise**2 * self.noise_period * time + self.gyro_scale_sigma**2 * self.turn_time * (
            self.square_sum
        )
        velocity = self.accelerometer_noise**2 * self.noise_period * time * three
        noise = np.concatenate([np.zeros(3), velocity, tilt, gained + walk])
        return kalman.propagate(self.upper, rows, decay, noise), decay

    def first_variances(self):
        """Of all states at the beginning."""
        force, _ = inertial.slow(
            self.accelerometer_null_shift_sigma, self.accelerometer_drift_sigma, self.accelerometer_drift_time
        )
        rate, _ = inertial.slow(self.gyro_null_shift_sigma, self.gyro_drift_sigma, self.gyro_drift_time)
        three, scale = np.ones(3), inertial.metres(self.fix.latitude, self.fix.altitude)
        place = np.stack([self.fix_sigma_told(), self.fix_sigma_told(), self.altitude_sigma]) / scale
        level = np.hypot(np.maximum(self.attitude.roll_sigma, self.attitude.pitch_sigma), self.level_sigma)
        tilt = np.stack([level, level, self.attitude.heading_sigma])
        offset = np.hypot(self.altitude_sigma, self.pressure_noise)
        sigmas = np.concatenate(
            [
                place,
                self.velocity_sigma * three,
                tilt,
                force * three,
                rate * three,
                offset * np.ones(1),
                self.bias_sigma * np.ones(PLACES),
            ]
        )
        return sigmas * sigmas

    @every("filter_period")
    def aid(self):
        running = self.initialised & (self.time - self.imu_time <= self.gap_limit + self.filter_period)
        upper, decay = self.predicted()
        self.upper = np.where(running, upper, self.upper)
        self.range_bias = np.where(running, decay[7:], 1.0) * self.range_bias
        self.since = 0.0
        self.force_sum = np.zeros(3)
        self.dcm_sum = np.zeros((3, 3))
        self.square_sum = np.zeros(3)
        self.initialised = running
        self.take_fix()
        self.take_air()
        self.take_ranges()
        self.claim()

    def take_fix(self):
        """Begin with a fix, or correct position and velocity of its time of validity."""
        fix = self.fix
        new = fix.sequence != self.fix_seen
        good = told(self.fix_told() & new, fix.time_of_validity)
        moment = known(self.fix_moment(), self.imu_time)
        tilted = np.max(self.sigmas()[inertial.TILT]) > self.tilt_limit
        lost = np.logical_not(self.initialised) | tilted
        age = self.time - self.imu_time
        begins = good & lost & self.attitude_told() & (age <= self.gap_limit)
        behind = self.imu_time - moment
        there = np.stack([fix.latitude, fix.longitude, fix.altitude])
        near = np.where(good, there, self.position)
        scale = inertial.metres(near[0], near[2])
        moved = np.array([1.0, 1.0, -1.0]) * (
            np.where(begins, fix.velocity_n, self.velocity_n) * behind
            + np.where(begins, 0.0, past.since(self.past_times, self.past_velocities, moment))
        )
        there = near + moved / scale
        turned = self.attitude.yaw_rate * np.clip(self.imu_time - self.attitude.time_of_validity, -1.0, 1.0)
        angles = self.attitude.roll, self.attitude.pitch, self.attitude.heading + turned
        self.position = np.where(begins, there, self.position)
        self.velocity_n = np.where(begins, fix.velocity_n, self.velocity_n)
        self.turn = np.where(begins, quaternion.of_euler(*(np.where(begins, one, 0.0) for one in angles)), self.turn)
        self.past_velocities = np.where(begins, fix.velocity_n, self.past_velocities)
        self.pressure_error = np.where(
            begins & self.pressure_told(), self.air.pressure_altitude - there[2], self.pressure_error
        )
        start = kalman.of_variances(np.where(begins, (1.0 - self.known_share) * self.first_variances(), 0.0))
        upper = np.where(begins, start, self.upper)

        away = np.concatenate([there[:1] - self.position[:1], self._around(there), there[2:] - self.position[2:]])
        then = past.at(self.past_times, self.past_velocities, moment)
        residuals = np.concatenate([away, fix.velocity_n - then])
        sigmas = np.concatenate(
            [
                np.stack([self.fix_sigma_told(), self.fix_sigma_told(), self.altitude_sigma]) / scale,
                self.velocity_sigma * np.ones(3),
            ]
        )
        use = good & np.logical_not(begins) & self.initialised
        variances = kalman.diagonal(upper)[:6] + sigmas**2
        squares = residuals * residuals
        beyond = use & (self.innovation_gate > 0.0) & np.any(squares > self.innovation_gate**2 * variances)
        upper = np.where(beyond, self._anew(upper, BEGUN_ANEW * sigmas**2), upper)
        correction = np.zeros(STATES)
        for place, row in enumerate(np.eye(STATES)[:6]):
            correction, upper, _ = kalman.update(correction, upper, row, sigmas[place] ** 2, residuals[place], use)
        self.upper = upper
        self.correct(correction)
        self.upper = np.where(use, (1.0 - self.known_share) * self.upper, self.upper)
        self.initialised = self.initialised | begins
        self.remember_fix(good, new)

    def remember_fix(self, good, new):
        """What the family keeps of a report of the receiver."""
        before = self.fix_time, self.fix_good, self.last_speed, self.initialised
        self.note_fix(good)
        self.fix_time = np.where(new, self.fix_time, before[0])
        self.fix_good = np.where(new, self.fix_good, before[1])
        self.last_speed = np.where(new, self.last_speed, before[2])
        self.initialised = before[3]
        self.fix_seen = np.where(new, self.fix.sequence, self.fix_seen)

    def _around(self, there):
        """Difference of longitude the short way round, rad, shape (1,)."""
        return attitude.wrap(there[1:2] - self.position[1:2])

    def _anew(self, upper, variances):
        """Position and velocity with these variances, and independent of the other states."""
        kept = np.concatenate([np.zeros(6), np.ones(STATES - 6)])
        own = np.concatenate([variances, np.zeros(STATES - 6)])
        return upper * kalman.pack(np.outer(kept, kept)) + kalman.of_variances(own)

    def pressure_told(self):
        """Whether there is a pressure altitude."""
        return told(self.air.valid, self.air.pressure_altitude)

    def take_air(self):
        """Correct the altitude by pressure altitude."""
        new = self.air.sequence != self.air_seen
        use = new & self.pressure_told() & self.initialised
        row = np.eye(STATES)[2] + np.eye(STATES)[OFFSET]
        expected = self.position[2] + self.pressure_error
        residual = np.where(use, self.air.pressure_altitude - expected, 0.0)
        correction, self.upper, _ = kalman.update(
            np.zeros(STATES), self.upper, row, self.pressure_noise**2, residual, use, self.innovation_gate
        )
        self.correct(correction)
        self.air_seen = np.where(new, self.air.sequence, self.air_seen)

    def take_ranges(self):
        """Sequential updates by slant ranges, (6.39)-(6.42)."""
        new = self.ranging.sequence != self.ranging_seen
        moment = known(self.ranging.time_of_validity, self.imu_time)
        back = np.array([1.0, 1.0, -1.0]) * self.velocity_n * (moment - self.imu_time)
        at = self.position + back / inertial.metres(self.position[0], self.position[2])
        sight = dme.line_of_sight(
            at[0], at[1], at[2], self.station_latitude, self.station_longitude, self.station_altitude
        )
        north, east, distance = navigator.direction_cosines(at[0], at[1], sight)
        up = navigator.vertical_cosine(at[0], at[1], sight)
        wanted = told(self.wants_ranges() & new, self.ranging.time_of_validity)
        measured = self.ranges_there() & wanted
        scale = inertial.metres(at[0], at[2])
        plane = self.plane(scale)
        heard = np.maximum(self.range_time, self.refused_time)
        speed = np.maximum(np.sqrt(np.sum(self.velocity_n[:2] * self.velocity_n[:2])), 1.0)
        news = navigator.news(moment - heard, self.correlation_distance / speed)
        curvature = navigator.curvature(plane, north, east, distance)
        none = np.zeros((PLACES, STATES - 3))
        own = np.concatenate([np.zeros((PLACES, BIASES.start - 3)), np.eye(PLACES)], axis=1) + none
        rows = np.concatenate([np.stack([north, east, up], -1) * scale, own], axis=1)
        correction, upper, taken, innovations, spreads = kalman.updates(
            np.zeros(STATES),
            self.upper,
            rows,
            self.noise_sigma**2 + curvature,
            np.where(measured, self.ranging.slant_range - distance - self.range_bias, 0.0),
            measured,
            self.innovation_gate,
        )
        self.upper = upper
        self.correct(correction)
        gates = self.gate, self.innovation, self.innovation_sigma
        self.judge(measured, taken, innovations, spreads)
        self.gate, self.innovation, self.innovation_sigma = (
            np.where(new, now, then)
            for now, then in zip((self.gate, self.innovation, self.innovation_sigma), gates, strict=True)
        )

        refused = measured & np.logical_not(taken)
        again = refused & (self.refused_time > np.maximum(self.range_time, self.fix_time))
        self.rejected = self.rejected + np.sum(np.where(refused, 1.0, 0.0))
        self.used = self.used + np.sum(np.where(taken, 1.0, 0.0))
        self.range_time = np.where(taken, moment, self.range_time)
        self.refused_time = np.where(refused, moment, self.refused_time)
        used = self.used_lately(moment)
        recent = moment - self.refused_time <= self.geometry_window
        against = recent & (self.refused_time > np.maximum(self.range_time, self.fix_time))
        believed = used & np.logical_not(against)
        self.hdop = np.where(wanted, dme.dilution(north, east, used), self.hdop)
        outvoted = navigator.outvoted(against, believed, dme.dilution(north, east, believed), self.dilution_limit)
        lacking = np.maximum(innovations**2 - navigator.variance_along(self.plane(scale), north, east), 0.0)
        lacking = np.max(np.where(again & np.logical_not(outvoted), news * lacking, 0.0))
        wider = np.concatenate([lacking / scale[:2] ** 2, np.zeros(STATES - 2)])
        self.upper = self.upper + kalman.of_variances(wider)
        self.ranging_seen = np.where(new, self.ranging.sequence, self.ranging_seen)

    def plane(self, scale):
        """Covariance of position north and east, m2, packed."""
        upper = kalman.pack(kalman.unpack(self.upper)[:2, :2])
        return upper * np.stack([scale[0] * scale[0], scale[0] * scale[1], scale[1] * scale[1]])

    def correct(self, correction):
        """Blend the corrections into position, velocity, attitude and biases."""
        self.position = self.position + correction[inertial.POSITION]
        self.velocity_n = self.velocity_n + correction[inertial.VELOCITY]
        self.past_velocities = self.past_velocities + correction[inertial.VELOCITY]
        turned = quaternion.of_rotation(correction[inertial.TILT])
        self.turn = quaternion.unit(quaternion.product(turned, self.turn))
        self.accelerometer_bias = self.accelerometer_bias + correction[inertial.FORCE]
        self.force = self.force - correction[inertial.FORCE]
        self.gyro_bias = self.gyro_bias + correction[inertial.RATE]
        self.rate = self.rate - correction[inertial.RATE]
        self.pressure_error = self.pressure_error + correction[OFFSET]
        self.range_bias = self.range_bias + correction[BIASES]

    def sigmas(self):
        """Standard deviations of the states, those of position still in rad."""
        return np.sqrt(np.maximum(kalman.diagonal(self.upper), 0.0))

    def claim(self):
        """Show what the filter says of its errors."""
        scale = inertial.metres(self.position[0], self.position[2])
        self.state_sigma = self.sigmas() * np.concatenate([scale, np.ones(STATES - 3)])
        self.position_covariance = self.plane(scale)
        self.north_sigma, self.east_sigma = self.state_sigma[0], self.state_sigma[1]
        _, pitch, heading = attitude.euler(quaternion.dcm(self.turn))
        tilts = kalman.pack(kalman.unpack(self.upper)[inertial.TILT, inertial.TILT])
        self.angle_sigmas = euler_sigmas(tilts, heading, pitch)

    @every("sample_period")
    def report(self):
        """Publish what is known now: position is carried from the last inertial sample."""
        scale = inertial.metres(self.position[0], self.position[2])
        age = np.clip(self.time - self.imu_time, 0.0, self.gap_limit)
        here = self.position + np.array([1.0, 1.0, -1.0]) * self.velocity_n * age / scale
        self.solution.publish(
            latitude=here[0],
            longitude=attitude.wrap(here[1]),
            altitude=here[2],
            velocity_n=self.velocity_n,
            wind_n=np.zeros(2),
            valid=self.initialised,
        )
        roll, pitch, heading = attitude.euler(quaternion.dcm(self.turn))
        self.angles.publish(
            roll=roll,
            pitch=pitch,
            heading=attitude.wrap(heading),
            roll_sigma=self.angle_sigmas[0],
            pitch_sigma=self.angle_sigmas[1],
            heading_sigma=self.angle_sigmas[2],
            valid=self.initialised,
            time_of_validity=self.imu_time,
        )
        self.tell_mode()
