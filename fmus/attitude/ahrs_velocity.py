"""The FMU ``ahrs_velocity``: attitude and heading by a filter whose level comes from velocity."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.attitude.interface import AIRCRAFT, Reference
from models.attitude import ahrs_velocity as filter_
from models.attitude import attitude, quaternion
from models.attitude.ahrs import length, level, levelled_heading, turning_acceleration
from models.filters import kalman
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Component, Example, Parameter, ParameterSet, State, every, on_new

HAND = ParameterSet(
    "A sensor of a few grams that is held by hand and stays where it is, with a magnetometer that is calibrated, "
    "indoors (own choice; of the recordings of BROAD it gives the errors that stand in the documentation).",
    {
        "aiding_period": 0.07,
        "gap_limit": 0.3,
        "airspeed": 0.0,
        "blind_airspeed_sigma": 0.0,
        "flow_sigma": 0.0,
        "velocity_density": 0.2,
        "place_density": 0.1,
        "velocity_walk": 0.02,
        "gyro_noise": 0.0025,
        "noise_period": 1.0,
        "alpha": 1.0,
        "gyro_scale_sigma": 0.001,
        "turn_time": 1.0,
        "gyro_null_shift_sigma": 0.0015,
        "gyro_drift_sigma": 0.0,
        "field_sigma": 0.05,
        "field_time": 0.14,
        "field_noise": 0.0,
        "field_limit": 4.0,
        "jump_limit": 1.0e6,
        "hard_iron_sigma": 0.005,
        "hard_iron_walk": 0.0001,
        "dip_sigma": 0.005,
        "dip_walk": 0.0,
        "initial_sigma": 0.02,
    },
)

SMALL_AIRCRAFT = ParameterSet(
    "An unmanned aircraft of some kg at 15 to 25 m/s near the ground, with a micromechanical unit that is not nulled "
    "before the flight, and a magnetometer whose hard iron was learned in a minute of it. It rolls by 2 rad/s, so it "
    "is aided every 0.1 s. Gyros: zero-rate offset of 1 deg/s, accelerometers 20 mg (data sheet of the BMI088; a "
    "recorded unit had 1.1 deg/s and 10 to 30 mg). Wind: 0.35 m/s in a second as everywhere, and light turbulence of "
    "MIL-F-8785C at 75 m, 1.13 m/s along the nose for 240 m, which 18 m/s pass in 13 s: 0.44 m/s in a second. Hard "
    "iron: by how much what was learned in a minute and in the whole of a recorded flight differ, 1.8 of 56 "
    "microtesla; it walks by 1 % in 100 s with the currents of the motor (own choice).",
    {
        "aiding_period": 0.1,
        "gap_limit": 1.0,
        "airspeed": 18.0,
        "blind_airspeed_sigma": 5.0,
        "velocity_walk": 0.55,
        "gyro_null_shift_sigma": np.radians(1.0),
        "level_sigma": 0.02,
        "hard_iron_sigma": 0.03,
        "hard_iron_walk": 0.001,
    },
)

SETS = {**AIRCRAFT, "hand": HAND, "small_aircraft": SMALL_AIRCRAFT}


class AhrsVelocity(Reference, Component):
    """Attitude and heading reference without a singular attitude, for aircraft and for what is held by hand.

    With every IMU sample the quaternion is turned by the rates less their estimated biases, exactly for a rate that is
    constant between samples, and the specific force, turned into n, is integrated. Every `aiding_period` a Kalman
    filter with twenty states, errors of attitude (a small rotation in n), velocity, place, gyro biases, hard iron, dip
    and strength of the field, and flow, takes

    - the velocity: what was integrated must be the airspeed, along the nose, but for slip and angle of attack
      (`flow_sigma`, m/s, for `flow_time`), in air whose velocity is a random walk of `velocity_walk`. So acceleration,
      in a turn or not, is none of the level. For a sensor held by hand the airspeed is 0;
    - the place, where `place_density` is not 0: it stays where it is;
    - the magnetic field as a vector, strength and all; what is beyond `field_limit` sigma, as near a magnet, with a
      noise as large as itself which lasts for `disturbance_time`. Where it jumps by more than `jump_limit` sigma, the
      hard iron takes it.

    *Without air data* (not connected, not valid, older than `air_timeout`) the last airspeed is kept, at first
    `airspeed`, and its error grows to `blind_airspeed_sigma`.

    GPS attitude, declination, and what is added to the published sigmas are those of `ahrs`, whose place it can take.
    The parameter set `hand` is that of a sensor which is held by hand, `small_aircraft` that of an unmanned one of some
    kg; `tactical`, `automotive`, which are the defaults, and `consumer` are those of an aircraft by its inertial unit.

    At the first aiding with field and specific force the attitude is set from these; until then `attitude.valid` is
    false.
    """

    tick = "sample_period"
    parameter_sets = SETS
    example = Example(
        {"sample_period": 0.05},
        text="A full circle at 3 deg/s in level flight (60 to 184 s), with gyros that are wrong by 0.15 deg/s in roll "
        "and -0.1 deg/s in yaw. The angles follow the truth (dashed), the biases of the gyros are learned.",
        duration=300.0,
        step=0.05,
        inputs=examples.ahrs_inputs,
        shows=("gyro_bias", "attitude.heading_sigma"),
        panels=examples.ahrs_panels,
    )

    noise_period = Parameter(
        "s", start=0.0, min=0.0, description="period of the samples that gyro_noise is that of; 0: sample_period"
    )
    turn_time = Parameter("s", start=60.0, min=0.0, description="time for which a rate lasts in one direction")
    velocity_walk = Parameter(
        "m/s",
        start=0.35,
        min=0.0,
        description="random walk, in one second, of the velocity of what carries the sensor: a wind of 5 m/s and 400 s "
        "(thesis (3.36)) has 0.35 m/s",
    )
    velocity_density = Parameter(
        "m/s",
        start=2.0,
        min=1.0e-6,
        description="noise of a mean airspeed of one second: gusts of 1 m/s for 2 s",
    )
    place_density = Parameter(
        "m", start=0.0, min=0.0, description="white noise of the place, mean over one second; 0: it moves away"
    )
    flow_sigma = Parameter(
        "m/s",
        start=1.5,
        min=0.0,
        description="velocity of the air across the nose: slip and angle of attack (own choice)",
    )
    flow_time = Parameter("s", start=5.0, min=1.0e-3, description="time for which these last (own choice)")
    field_time = Parameter(
        "s",
        start=3.0,
        min=0.0,
        description="time for which the error of a field sample lasts, as soft iron does that turns with the aircraft "
        "(three recorded flights: 1.6 to 6 s); 0: each sample has its own",
    )
    field_noise = Parameter(
        "1", start=0.01, min=0.0, description="noise of a field sample beside that: 5 mG (thesis Table 3.3)"
    )
    jump_limit = Parameter(
        "1",
        start=3.5,
        min=1.0,
        description="sigmas of a change from field to field beyond which the hard iron has changed (own choice)",
    )
    field_limit = Parameter("1", start=3.0, min=1.0, description="sigmas beyond which a field is disturbed")
    disturbance_time = Parameter(
        "s", start=20.0, min=0.0, description="time for which a disturbance lasts (own choice)"
    )
    hard_iron_walk = Parameter(
        "1",
        start=0.0,
        min=0.0,
        description="random walk, in one second, of the hard iron (over the field)",
    )

    turn = State(4, "1", start=(1, 0, 0, 0), description="quaternion of C_nb")
    velocity = State(3, "m/s", description="velocity with respect to what carries the sensor, n")
    place = State(3, "m", description="way in it, n")
    flow = State(3, "m/s", description="error of the airspeed, slip and angle of attack, b")
    strength = State("1", description="strength of the field over that at first, less 1")
    first_strength = State("T", start=1.0, description="strength at first")
    covariance = State(210, "1", description="upper triangle of the filter's covariance, row by row")
    rate = State(3, "rad/s", description="last rate less bias")
    force = State(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="last specific force")
    since = State("s", description="time that is summed since the last aiding")
    force_sum = State(3, "m/s", description="integral of the specific force in n")
    felt_sum = State(3, "m/s", description="integral of the specific force in b")
    turned_sum = State(3, "rad", description="integral of the rate in b")
    dcm_sum = State((3, 3), "s", description="integral of C_nb")
    square_sum = State(3, "1", description="integral of the squares of the rates in n, rad^2/s")
    field_at = State("s", start=-1.0e9, description="time of validity of the last field used")
    field_left = State(3, "1", description="what was not explained of it, over the strength at first")

    @on_new("imu")
    def integrate(self):
        step = self.imu_step()
        known = self.imu_told()
        rate = np.where(known, self.imu.rate - self.gyro_bias, self.rate)
        force = np.where(known, self.imu.specific_force, self.force)
        mean = 0.5 * (rate + self.rate)
        felt = 0.5 * (force + self.force) * step
        middle = quaternion.dcm(quaternion.product(self.turn, quaternion.of_rotation(0.5 * step * mean)))
        self.turn = quaternion.unit(quaternion.product(self.turn, quaternion.of_rotation(step * mean)))
        self.force_sum = self.force_sum + middle @ felt
        self.felt_sum = self.felt_sum + felt
        self.turned_sum = self.turned_sum + step * mean
        self.dcm_sum = self.dcm_sum + step * middle
        self.square_sum = self.square_sum + step * (middle @ mean) ** 2
        self.since = self.since + step
        self.rate = rate
        self.force = force
        self.imu_time = self.imu.time_of_validity
        roll, pitch, heading = attitude.euler(quaternion.dcm(self.turn))
        yaw_rate = (rate[1] * np.sin(roll) + rate[2] * np.cos(roll)) / np.maximum(np.cos(pitch), 1.0e-6)
        self.tell((roll, pitch, attitude.wrap(heading)), yaw_rate, known)

    @every("chart_period")
    def look_up(self):
        _, turned = self.chart()
        turn = quaternion.of_rotation(attitude.wrap(turned) * np.array([0.0, 0.0, 1.0]))
        dcm = quaternion.dcm(turn)
        self.turn = quaternion.product(turn, self.turn)
        self.velocity = dcm @ self.velocity
        self.place = dcm @ self.place
        self.force_sum = dcm @ self.force_sum
        self.dcm_sum = dcm @ self.dcm_sum
        self.covariance = filter_.rotated(self.covariance, dcm)

    @every("aiding_period")
    def aid(self):
        time = self.since
        felt = time > 1.0e-6
        over = np.where(felt, time, 1.0)
        rate = self.turned_sum / over
        air_sigmas = self.flow_sigma * np.ones(2)

        fresh = self.fresh_air()
        back = fresh & np.logical_not(self.had_air)
        airspeed_sigma = np.where(fresh, self.air.true_airspeed_sigma, self.blind_airspeed_sigma)
        flow_sigmas = np.concatenate([np.reshape(airspeed_sigma, (1,)), air_sigmas])

        # initial alignment
        new_field = felt & self.new_field()
        strength = np.maximum(length(self.field.field_b), 1.0e-9)
        align = np.logical_not(self.aligned) & felt & new_field
        turning = turning_acceleration(np.where(fresh, self.airspeed_seen, 0.0), rate)
        roll, pitch = level(self.felt_sum / over, turning)
        magnetic, down = levelled_heading(self.field.field_b / strength, roll, pitch)
        found = quaternion.of_euler(roll, pitch, magnetic + self.local_declination)
        turn = np.where(align, found, self.turn)
        first_strength = np.where(align, strength, self.first_strength)
        nose = np.array([1.0, 0.0, 0.0]) * self.airspeed_seen
        at_first = quaternion.dcm(turn) @ nose
        dip = np.where(align, np.arcsin(np.clip(down, -1.0, 1.0)), self.dip)
        initial = filter_.initial_covariance(
            turn,
            at_first,
            self.initial_sigma,
            np.sqrt(self.gyro_null_shift_sigma**2 + self.gyro_drift_sigma**2),
            self.dip_sigma,
            self.hard_iron_sigma,
            flow_sigmas,
            self.velocity_density / np.sqrt(over),
        )

        # time update
        placed = self.place_density > 0.0
        moved, gone = filter_.carried(self.velocity, self.place, self.force_sum, time)
        velocity = np.where(align, at_first, moved)
        place = np.where(align | np.logical_not(placed), np.zeros(3), gone)
        times = np.stack([self.airspeed_time, self.flow_time, self.flow_time])
        decay = np.exp(-time / times)
        flow = np.where(back, np.array([0.0, 1.0, 1.0]), 1.0) * decay * self.flow
        period = np.where(self.noise_period > 0.0, self.noise_period, self.sample_period)
        noise = filter_.process_noise(
            (self.alpha * self.gyro_noise) ** 2 * period,
            self.gyro_scale_sigma,
            self.square_sum * self.turn_time,
            self.velocity_walk,
            2.0 * self.gyro_drift_sigma**2 / self.gyro_drift_time,
            self.hard_iron_walk,
            self.dip_walk,
            flow_sigmas**2 * (1.0 - decay * decay),
            time,
        )
        propagated = kalman.propagate(
            filter_.renewed(self.covariance, airspeed_sigma**2, back),
            filter_.transition(self.dcm_sum / over, self.force_sum, time, np.where(placed, 1.0, 0.0)),
            np.concatenate([np.ones(filter_.FLOW.start - filter_.MOVING), decay]),
            noise,
        )
        covariance = np.where(align, initial, propagated)

        # measurement update: velocity and place
        use = felt & self.aligned
        expected, matrix = filter_.rows(filter_.flow_seen, turn, velocity, flow)
        correction, covariance = filter_.updates(
            np.zeros(filter_.STATES), covariance, expected, matrix, nose, self.velocity_density**2 / over, use
        )
        correction, covariance = filter_.updates(
            correction,
            covariance,
            place,
            np.eye(filter_.STATES)[filter_.PLACE],
            np.zeros(3),
            self.place_density**2 / over,
            use & placed,
        )

        # measurement update: field
        age = self.before(self.field)
        then = quaternion.product(turn, quaternion.of_rotation(-rate * np.where(new_field, age, 0.0)))
        strength_then = np.where(align, 0.0, self.strength)
        expected, matrix = filter_.rows(
            filter_.field_seen, then, self.hard_iron, dip, strength_then, self.local_declination
        )
        measured = self.field.field_b / first_strength
        left = measured - expected - matrix @ correction
        apart = np.maximum(self.field.time_of_validity - self.field_at, 1.0e-6)
        kept, own = filter_.correlation(self.field_time, apart), self.field_noise**2
        change = np.where(new_field & self.aligned, left - kept * self.field_left, 0.0)
        covariance = filter_.jumped(
            covariance, matrix, change, self.field_sigma**2, own, noise[filter_.TURN], kept, self.jump_limit
        )
        variance = filter_.lasting(self.field_sigma**2, self.field_time, apart) + own
        disturbance = filter_.disturbance(covariance, matrix, left, self.field_sigma**2, self.field_limit)
        variance = np.maximum(variance, filter_.lasting(disturbance, self.disturbance_time, apart))
        correction, covariance = filter_.updates(
            correction,
            covariance,
            expected,
            matrix,
            measured,
            variance,
            new_field,
        )

        self.field_left = np.where(new_field, measured - expected - matrix @ correction, self.field_left)

        # measurement update: GPS attitude
        told = np.stack([self.gps.roll, self.gps.pitch, self.gps.heading])
        new_gps = felt & self.new_gps()
        age = self.before(self.gps)
        told = quaternion.of_euler(*np.where(new_gps, told, 0.0))
        then = quaternion.product(turn, quaternion.of_rotation(-rate * np.where(new_gps, age, 0.0)))
        expected, matrix = filter_.rows(filter_.turn_seen, then, told)
        correction, covariance = filter_.updates(
            correction, covariance, expected, matrix, np.zeros(3), self.gps_sigma**2, new_gps
        )
        self.gps_seen = np.where(new_gps, self.gps.sequence, self.gps_seen)
        self.gps_time = np.where(new_gps, self.time, self.gps_time)

        running = np.logical_or(self.aligned, align)
        begin = np.logical_not(running) | np.logical_not(filter_.sound(covariance))
        none = np.zeros(3)
        corrected = quaternion.product(quaternion.of_rotation(correction[filter_.TURN]), turn)
        self.aligned = np.logical_not(begin)
        self.turn = np.where(begin, self.turn, quaternion.unit(corrected))
        self.covariance = np.where(begin, 0.0, covariance)
        self.velocity = np.where(begin, none, velocity + correction[filter_.VELOCITY])
        self.place = np.where(begin, none, place + correction[filter_.PLACE])
        measured = self.rate + self.gyro_bias
        self.gyro_bias = np.where(begin, none, self.gyro_bias + correction[filter_.BIAS])
        self.rate = measured - self.gyro_bias
        self.hard_iron = np.where(begin, none, self.hard_iron + correction[filter_.IRON])
        self.dip = np.where(begin, 0.0, dip + correction[filter_.DIP])
        self.strength = np.where(begin, 0.0, strength_then + correction[filter_.STRENGTH])
        self.flow = np.where(begin, none, flow + correction[filter_.FLOW])
        self.first_strength = first_strength
        self.field_seen = np.where(new_field, self.field.sequence, self.field_seen)
        self.field_at = np.where(new_field, self.field.time_of_validity, self.field_at)
        self.had_air = fresh
        self.since = 0.0
        self.force_sum = none
        self.felt_sum = none
        self.turned_sum = none
        self.square_sum = none
        self.dcm_sum = np.zeros((3, 3))

        _, pitch, heading = attitude.euler(quaternion.dcm(self.turn))
        self.sigmas = np.sqrt(filter_.euler_sigmas(self.covariance, heading, pitch) ** 2 + self.unseen() ** 2)
