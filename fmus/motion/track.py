"""A recorded flight as an FMU."""

from __future__ import annotations

import numpy as np

from models.air import atmosphere
from models.attitude import attitude
from models.motion import aircraft, recorded_track
from models.processes import gauss_markov, lags
from models.processes.known import known
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

    The table resources/track.npy holds time, position, velocity and acceleration in geodetic coordinates; between two
    rows latitude, longitude and altitude are polynomials of degree five, so the flight and its first two derivatives
    are continuous. With M, N the radii of curvature,

        velocity    v_N = (M + h) latitude',  v_E = (N + h) cos(latitude) longitude',  v_D = -h'

    with two derivatives in closed form. Attitude, specific force and angular rate follow from these by the equations
    of aircraft: wind axes on the velocity relative to the wind, which is felt through two lags, coordinated turns, the
    nose up by the angle of attack that the lift needs. All derivatives are analytic. There are no gusts: those that
    the recording holds are in the motion. Behind the last row the motion goes on with constant rates of latitude,
    longitude and altitude.

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

    wing_loading = Parameter(
        "Pa",
        start=1960.0,
        min=0.0,
        max=2e4,
        description="weight over wing area, 1960 N/m2 for a twin of 5 to 6 t; 0: no angle of attack from lift",
    )
    lift_slope = Parameter("1", start=5.14, min=0.1, max=20.0, description="C_L_alpha per rad")
    zero_lift_angle = Parameter(
        "rad",
        start=-0.0603,
        min=-0.5,
        max=0.5,
        display_unit="deg",
        description="angle of attack without lift, -C_L_0 / C_L_alpha",
    )
    weathercock_time = Parameter(
        "s", start=1.25, min=0.1, max=60.0, description="time constant of each of the two lags of the wind"
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

    air_velocity_n = Output(3, "m/s", display_unit="kn", description="velocity of the air over ground: the wind")
    true_airspeed = Output("m/s", display_unit="kn", description="speed relative to the air")
    angle_of_attack = Output("rad", display_unit="deg", description="of the air-relative velocity, positive from below")
    sideslip = Output("rad", display_unit="deg", description="of the air-relative velocity, positive from the right")

    ground_track = State("rad", description="direction of motion over ground, continuous")
    lift_length = State("m", description="2 wing_loading / (rho g C_L_alpha), rho at the first row")
    felt_wind = State(3, "m/s", description="wind through two lags")
    felt_wind_rate = State(3, "m/s2", description="its rate")
    felt_wind_target = State(3, "m/s", description="wind at the last tick")
    weathercock_decay = State("1", description="exp(-T/tau) of the lags of the wind")

    track = Table(columns=_COLUMNS, rows=_EXAMPLE)

    @start
    def begin(self):
        self.weathercock_decay = gauss_markov.decay(self.update_period, self.weathercock_time)
        self.felt_wind = self.felt_wind_target = known(self.wind_n, 0.0)
        motion = self._motion()
        height = atmosphere.geopotential(motion[2][0])
        density = atmosphere.density(atmosphere.pressure(height), atmosphere.temperature(height))
        self.lift_length = aircraft.lift_length(self.wing_loading, density, self.lift_slope)
        self._publish(*motion)

    @every("update_period")
    def move(self):
        target = known(self.wind_n, self.felt_wind_target)
        self.felt_wind, self.felt_wind_rate = lags.follow(
            self.felt_wind,
            self.felt_wind_rate,
            self.felt_wind_target,
            target,
            self.period,
            self.weathercock_time,
            self.weathercock_decay,
        )
        self.felt_wind_target = target
        self._publish(*self._motion())

    def _motion(self):
        """Latitude, longitude and altitude with their derivatives at this time."""
        row, following = self.track.row, self.track.next_row
        derivatives = recorded_track.between(
            (row[1:4], row[4:7], row[7:10]),
            (following[1:4], following[4:7], following[7:10]),
            self.time - row[0],
            following[0] - row[0],
        )
        return [tuple(derivative[axis] for derivative in derivatives) for axis in range(3)]

    def _publish(self, latitude, longitude, altitude):
        north, east = recorded_track.horizontal_motion(latitude, longitude, altitude)
        velocity, acceleration, jerk = (np.array([north[i], east[i], -altitude[i + 1]]) for i in range(3))
        speed = np.sqrt(north[0] * north[0] + east[0] * east[0])
        track = np.arctan2(east[0], north[0])
        self.ground_track = self.ground_track + attitude.wrap(track - self.ground_track)
        self.latitude = latitude[0]
        self.longitude = longitude[0]
        self.altitude = altitude[0]
        self.velocity_n = velocity
        c_nb, rate_nb = aircraft.trimmed(
            (velocity, acceleration),
            (acceleration, jerk),
            (self.felt_wind, self.felt_wind_rate),
            (self.zero_lift_angle, self.lift_length),
        )
        self.specific_force, self.rate = aircraft.inertial(
            self.latitude, self.altitude, velocity, acceleration, c_nb, rate_nb
        )
        self.roll, self.pitch, self.heading = aircraft.euler(c_nb, self.ground_track, east[0] / speed, north[0] / speed)
        self.air_velocity_n = self.wind_n
        self.true_airspeed, self.angle_of_attack, self.sideslip = aircraft.flow(c_nb, velocity - self.wind_n)
