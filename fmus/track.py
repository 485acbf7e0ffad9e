"""A recorded flight as an FMU."""

from __future__ import annotations

import numpy as np

from models import aircraft, attitude, gauss_markov, recorded_track
from navfmu.export import Component, Example, Input, Output, Parameter, State, Table, every, start

_COLUMNS = (
    ("time", "s"),
    ("latitude", "rad"),
    ("longitude", "rad"),
    ("altitude", "m"),
    ("latitude_rate", "rad/s"),
    ("longitude_rate", "rad/s"),
    ("vertical_speed", "m/s"),
    ("latitude_acceleration", "rad/s2"),
    ("longitude_acceleration", "rad/s2"),
    ("vertical_acceleration", "m/s2"),
)
_EXAMPLE = np.array([[t, 0.6526 + 5e-6 * t, -2.1301 + 6e-6 * t, 900.0, 5e-6, 6e-6, 0, 0, 0, 0] for t in (0.0, 120.0)])


class Track(Component):
    """True motion of an aircraft along a recorded track; the same interface as aircraft.

    The table resources/track.csv holds time, position, velocity and acceleration in geodetic coordinates; between two
    rows latitude, longitude and altitude are polynomials of degree five, so the flight and its first two derivatives
    are continuous. With M, N the radii of curvature,

        velocity    v_N = (M + h) latitude',  v_E = (N + h) cos(latitude) longitude',  v_D = -h'

    and ground speed V, rate of turn omega, vertical speed w and their derivatives in closed form. Attitude, specific
    force and angular rate follow from these by the equations of aircraft: nose on the flight path, coordinated turns,
    crab angle into the wind through two first-order lags. All derivatives are analytic. Behind the last row the motion
    goes on with constant rates of latitude, longitude and altitude.

    `navfmu track FILE.csv --out NAME.fmu` writes this FMU with a flight of yours in its table; as built it holds two
    minutes of level flight.
    """

    name = "track"
    example = Example(
        steps={"wind_n": (0.0, 8.0, 0.0)},
        text="The built-in track, level flight to the north-east. When a wind of 8 m/s to the east sets in the nose "
        "turns into it, through two lags of 1.25 s each; the track over ground stays what was recorded.",
    )

    wind_n = Input(3, "m/s", display_unit="kn", description="velocity of the air over ground, north, east, down")

    weathercock_time = Parameter(
        "s", start=1.25, min=0.1, max=60.0, description="time constant of each of the two lags of the crab angle"
    )
    update_period = Parameter("s", start=0.01, min=1e-4, max=1.0, description="period at which the motion is computed")

    latitude = Output("rad", display_unit="deg", description="geodetic latitude")
    longitude = Output("rad", display_unit="deg", description="longitude, continuous")
    altitude = Output("m", display_unit="ft", description="height above the ellipsoid")
    velocity_n = Output(3, "m/s", display_unit="kn", description="velocity over ground, north, east, down")
    roll = Output("rad", display_unit="deg", description="roll angle, right wing down positive")
    pitch = Output("rad", display_unit="deg", description="pitch angle, nose up positive")
    heading = Output("rad", display_unit="deg", description="heading from true north, continuous (not wrapped)")
    specific_force = Output(3, "m/s2", description="specific force in body axes")
    rate = Output(3, "rad/s", display_unit="deg/s", description="rate with respect to inertial space, body axes")

    ground_track = State("rad", description="direction of motion over ground, continuous")
    crab = State("rad", description="angle from track to heading")
    crab_rate = State("rad/s", description="its rate")
    crab_target = State("rad", description="angle from track to the air-relative velocity at the last tick")
    weathercock_decay = State("1", description="exp(-T/tau) of the weathercock")

    track = Table(columns=_COLUMNS, rows=_EXAMPLE)

    @start
    def begin(self):
        self.weathercock_decay = gauss_markov.decay(self.update_period, self.weathercock_time)
        motion, speed, turn = self._motion()
        self._publish(motion, speed, turn)

    @every("update_period")
    def move(self):
        motion, speed, turn = self._motion()
        sine, cosine = motion[2][0] / speed[0], motion[1][0] / speed[0]
        target = aircraft.desired_crab(sine, cosine, speed[0], self.wind_n)
        self.crab, self.crab_rate = aircraft.weathercock(
            self.crab,
            self.crab_rate,
            self.crab_target,
            target,
            self.period,
            self.weathercock_time,
            self.weathercock_decay,
        )
        self.crab_target = target
        self._publish(motion, speed, turn)

    def _motion(self):
        """(Position and derivatives by axis, north, east), ground speed and rate of turn at this time."""
        row, following = self.track.row, self.track.next_row
        derivatives = recorded_track.between(
            (row[1:4], row[4:7], row[7:10]),
            (following[1:4], following[4:7], following[7:10]),
            self.time - row[0],
            following[0] - row[0],
        )
        axes = [tuple(derivative[axis] for derivative in derivatives) for axis in range(3)]
        north, east = recorded_track.horizontal_motion(*axes)
        return (axes, north, east), *recorded_track.ground_motion(north, east)

    def _publish(self, motion, speed, turn):
        (latitude, longitude, altitude), north, east = motion
        track = np.arctan2(east[0], north[0])
        self.ground_track = self.ground_track + attitude.wrap(track - self.ground_track)
        self.latitude = latitude[0]
        self.longitude = longitude[0]
        self.altitude = altitude[0]
        self.heading = self.ground_track + self.crab
        self.velocity_n, self.roll, self.pitch, self.specific_force, self.rate = aircraft.kinematics(
            latitude[0],
            altitude[0],
            east[0] / speed[0],
            north[0] / speed[0],
            speed,
            turn,
            altitude[1:4],
            self.crab,
            self.crab_rate,
        )
