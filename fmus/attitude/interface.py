"""What all attitude references have in common, so that one stands for another in a system.

Bundles, parameters, and what is done with them before a filter begins: which samples are taken, the declination.
"""

from __future__ import annotations

import numpy as np

from fmus.grades import AIR_DATA, GRADES, ahrs_parameters
from models.attitude import ahrs
from models.magnetic import magnetic_field
from models.processes.known import told
from models.satellite.gps import ATTITUDE_SIGMA
from navfmu.constants import STANDARD_GRAVITY
from navfmu.export import Bundle, Input, Output, Parameter, ParameterSet, State, on_new, require, start

_DEFAULT = ahrs_parameters("automotive")

AIRCRAFT = {
    grade: ParameterSet(
        f"An aircraft with an inertial unit of {grade} grade (thesis Table 3.2, p. 56); magnetometer and air data "
        "have the errors that are built in.",
        ahrs_parameters(grade),
    )
    for grade in GRADES
}
"""Of filters that model what these do: by grade of ``imu``."""


RATE_MOST, FORCE_MOST, AIRSPEED_MOST, ANGLE_MOST, ALTITUDE_MOST = 100.0, 500.0, 1000.0, 7.0, 1.0e6
"""What no sample of an aircraft is beyond, rad/s, m/s2, m/s, rad, m: such a number is none (own choice; the
coarsest gyros and accelerometers there are have 4000 deg/s and 40 g, and an angle is within a turn)."""


class Instrument:
    """Inputs, the bundle ``attitude``, and the parameters of every attitude reference."""

    imu = Bundle(
        rate=Input(3, "rad/s", display_unit="deg/s", description="angular rate, body axes"),
        specific_force=Input(3, "m/s2", start=(0, 0, -STANDARD_GRAVITY), description="specific force, body axes"),
        description="inertial measurement",
    )
    field = Bundle(
        field_b=Input(3, "T", display_unit="mG", description="magnetic field, body axes"), description="magnetic field"
    )
    air = Bundle(
        true_airspeed=Input("m/s", display_unit="kn", description="true airspeed"),
        true_airspeed_sigma=Input(
            "m/s",
            start=AIR_DATA["airspeed_error_sigma"],
            min=0.0,
            display_unit="kn",
            description="standard deviation of true airspeed by its instrument (thesis (3.32) has 2.6 m/s of the "
            "indicated one)",
        ),
        description="air data",
    )
    position = Bundle(
        latitude=Input("rad", display_unit="deg", description="geodetic latitude"),
        longitude=Input("rad", display_unit="deg", description="longitude"),
        altitude=Input("m", display_unit="ft", description="height above the ellipsoid"),
        description="position, to look up the declination; may stay unconnected",
    )
    gps = Bundle(
        roll=Input("rad", display_unit="deg", description="roll"),
        pitch=Input("rad", display_unit="deg", description="pitch"),
        heading=Input("rad", display_unit="deg", description="true heading"),
        description="GPS attitude of three antennas; may stay unconnected",
    )

    sample_period = Parameter(
        "s", start=0.01, min=1.0e-4, max=1.0, description="period at which new IMU samples are looked for and expected"
    )
    declination = Parameter(
        "rad",
        start=np.radians(12.74),
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="magnetic declination, east positive, until there is a position; 12.74 deg at Livermore by the "
        "WMM2025 for 2026",
    )
    declination_sigma = Parameter(
        "rad",
        start=_DEFAULT["declination_sigma"],
        min=0.0,
        display_unit="deg",
        description="error of the declination along a flight without position, at a dip of 60 degrees: local "
        "anomalies, and its change; it goes with 1 / cos(dip)",
    )
    chart_period = Parameter(
        "s",
        start=10.0,
        min=1.0e-3,
        max=600.0,
        description="period at which the declination is looked up (own choice: 2 km at 200 m/s, 0.02 deg at 70 degrees "
        "north)",
    )
    date = Parameter(
        "1", start=2026.0, description="date in decimal years, 2010.0 to 2030.0 (validity of WMM2010 to WMM2025)"
    )
    mounting_sigma = Parameter(
        "rad",
        start=_DEFAULT["mounting_sigma"],
        min=0.0,
        display_unit="deg",
        description="error of the needle by the triad's mounting, soft iron and scale factors, rms over all headings",
    )
    level_sigma = Parameter(
        "rad",
        start=_DEFAULT["level_sigma"],
        min=0.0,
        display_unit="deg",
        description="constant error of the level: null shift of the accelerometers over g, mounting",
    )
    field_sigma = Parameter(
        "1",
        start=_DEFAULT["field_sigma"],
        min=1.0e-6,
        description="error of each component of the direction of a field sample: noise of 1 to 5 mG (thesis Table "
        "3.3), soft iron",
    )
    hard_iron_sigma = Parameter(
        "1",
        start=_DEFAULT["hard_iron_sigma"],
        min=0.0,
        description="hard iron of each axis over the strength of the field: 4 to 7 mG (thesis Fig 3.27) of 480, and "
        "what the field cannot tell from it",
    )
    airspeed = Parameter(
        "m/s", start=60.0, min=0.0, display_unit="kn", description="airspeed that is assumed before there is air data"
    )
    air_timeout = Parameter("s", start=2.0, min=0.0, description="age beyond which air data are lost")

    attitude = Bundle(
        roll=Output("rad", display_unit="deg", description="roll"),
        pitch=Output("rad", display_unit="deg", description="pitch"),
        heading=Output("rad", display_unit="deg", description="true heading in [-pi, pi)"),
        yaw_rate=Output("rad/s", display_unit="deg/s", description="rate of heading"),
        roll_sigma=Output("rad", display_unit="deg", description="standard deviation of roll"),
        pitch_sigma=Output("rad", display_unit="deg", description="standard deviation of pitch"),
        heading_sigma=Output("rad", display_unit="deg", description="standard deviation of heading"),
        description="attitude",
    )

    dip = Output("rad", display_unit="deg", description="estimated dip of the field, positive down")
    local_declination = Output("rad", display_unit="deg", description="magnetic declination in use, east positive")

    airspeed_seen = State("m/s", description="last airspeed of the instrument")
    charted = State(kind="boolean", description="the declination is that of a known position")
    chart_sigma = State("rad", display_unit="deg", description="error of the declination at that position")

    @require(
        "the date {date} is outside the validity of every World Magnetic Model that is known here: those of 2010, "
        "2015, 2020 and 2025 are valid from 2010.0 to 2030.0"
    )
    def model_is_valid(self):
        return magnetic_field.known(self.date)

    @start
    def assume(self):
        self.airspeed_seen = self.airspeed
        self.local_declination = self.declination

    def imu_told(self):
        """Whether the sample of the inertial unit is one of numbers; its ``valid`` is that of the attitude."""
        rate, force = np.max(np.abs(self.imu.rate)), np.max(np.abs(self.imu.specific_force))
        return told((rate <= RATE_MOST) & (force <= FORCE_MOST), rate, force)

    def air_told(self):
        """Whether there is an airspeed, and what it is worth."""
        sound = self.air.valid & (np.abs(self.air.true_airspeed) <= AIRSPEED_MOST)
        return told(sound, self.air.true_airspeed, self.air.true_airspeed_sigma)

    def field_told(self):
        """Whether there is a field."""
        return told(self.field.valid, self.field.field_b)

    def chart(self):
        """Look the declination up at the position.

        Returns the field of the chart in n, T, and the angle by which a heading turns that was found before there was
        a position, rad: what the field has said of it, it has said from magnetic north. Later on it is 0, as a filter
        follows along the flight.
        """
        here = self.position
        on_earth = (np.abs(here.latitude) <= 0.5 * np.pi) & (np.abs(here.longitude) <= ANGLE_MOST)
        near = on_earth & (np.abs(here.altitude) <= ALTITUDE_MOST)
        there = told(here.valid & near, here.latitude, here.longitude, here.altitude)
        field_n = magnetic_field.field(here.latitude, here.longitude, here.altitude, self.date)
        charted = magnetic_field.declination(field_n)
        turned = np.where(there & np.logical_not(self.charted), charted - self.local_declination, 0.0)
        self.local_declination = np.where(there, charted, self.local_declination)
        self.chart_sigma = np.where(there, magnetic_field.declination_sigma(field_n, self.date), self.chart_sigma)
        self.charted = there
        return field_n, turned

    def still(self):
        """Sigmas of roll, pitch and heading, rad, by what stands still in the aircraft or in the chart."""
        uncharted = ahrs.declination_at(self.declination_sigma, self.dip)
        declination_sigma = np.where(self.charted, self.chart_sigma, uncharted)
        return ahrs.unseen(self.level_sigma, self.mounting_sigma, declination_sigma)


class Reference(Instrument):
    """What filters have beside that: gyros with errors that are learned, and GPS attitude."""

    aiding_period = Parameter(
        "s", start=0.5, min=0.001, max=60.0, description="period of aiding (thesis Fig 4.7: 2 Hz)"
    )
    gyro_noise = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_noise"],
        min=0.0,
        display_unit="deg/s",
        description="wide-band noise of a gyro sample (thesis Table 3.2, Table 4.4 sigma_p, sigma_q, sigma_r)",
    )
    alpha = Parameter(
        "1", start=3.0, min=0.0, description="tuning factor on the gyro noise (thesis (4.39); Table 4.4 has 10)"
    )
    gyro_scale_sigma = Parameter(
        "1",
        start=_DEFAULT["gyro_scale_sigma"],
        min=0.0,
        description="standard deviation of the gyros' scale factor error",
    )
    gyro_null_shift_sigma = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_null_shift_sigma"],
        min=0.0,
        display_unit="deg/s",
        description="standard deviation of the gyros' null shift",
    )
    gyro_drift_sigma = Parameter(
        "rad/s",
        start=_DEFAULT["gyro_drift_sigma"],
        min=0.0,
        display_unit="deg/s",
        description="standard deviation of the gyro drift (thesis Table 3.2, Table 4.4 sigma_w)",
    )
    gyro_drift_time = Parameter(
        "s", start=_DEFAULT["gyro_drift_time"], min=1.0, description="correlation time of the drift (thesis Table 3.2)"
    )
    gap_limit = Parameter(
        "s",
        start=5.0,
        min=0.0,
        max=1.0e6,
        description="time without inertial samples over which no attitude is carried: it is aligned anew (own choice; "
        "in 5 s a turn of 3 deg/s is missed by 15 degrees)",
    )
    airspeed_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time of the airspeed error (thesis (3.32))"
    )
    blind_airspeed_sigma = Parameter(
        "m/s",
        start=10.0,
        min=0.0,
        display_unit="kn",
        description="standard deviation of the airspeed without air data (own choice)",
    )
    dip_sigma = Parameter(
        "rad",
        start=np.radians(10.0),
        min=0.0,
        display_unit="deg",
        description="error of the first dip, which is read from field and specific force",
    )
    dip_walk = Parameter(
        "rad",
        start=np.radians(0.02),
        min=0.0,
        display_unit="deg",
        description="random walk of the dip in one second: 1.2 deg in an hour; at 200 m/s to the north it changes by "
        "twice as much, and crustal anomalies of 140 nT over 10 km are 0.17 deg in 50 s",
    )
    gps_sigma = Parameter(
        "rad",
        start=ATTITUDE_SIGMA,
        min=1.0e-6,
        display_unit="deg",
        description="standard deviation of GPS attitude (thesis Table 4.2: 0.25 deg)",
    )
    gps_timeout = Parameter("s", start=2.0, min=0.0, description="age beyond which GPS attitude is lost")
    initial_sigma = Parameter(
        "rad",
        start=np.radians(5.0),
        min=0.0,
        display_unit="deg",
        description="error of roll and pitch at the initial alignment",
    )

    gyro_bias = Output(3, "rad/s", display_unit="deg/s", description="estimated null shift and drift of the gyros")
    hard_iron = Output(3, "1", description="estimated hard iron over the strength of the field, body axes")

    sigmas = State(3, "rad", display_unit="deg", description="standard deviations of these")
    imu_time = State("s", start=-1.0e9, description="time of validity of the last IMU sample")
    had_air = State(kind="boolean", description="there were air data at the last aiding")
    field_seen = State(kind="integer", description="sequence number of the last field used")
    gps_seen = State(kind="integer", description="sequence number of the last GPS attitude used")
    gps_time = State("s", start=-1.0e9, description="when it was used")
    aligned = State(kind="boolean", description="initial alignment has been done")

    def tell(self, angles, yaw_rate, known):
        """Publish roll, pitch and heading, rad, and the yaw rate, rad/s, of the last inertial sample."""
        self.attitude.publish(
            roll=angles[0],
            pitch=angles[1],
            heading=angles[2],
            yaw_rate=yaw_rate,
            roll_sigma=self.sigmas[0],
            pitch_sigma=self.sigmas[1],
            heading_sigma=self.sigmas[2],
            valid=self.aligned & self.imu.valid & known,
            time_of_validity=self.imu.time_of_validity,
        )

    @on_new("air")
    def take_air(self):
        self.airspeed_seen = np.where(self.air_told(), self.air.true_airspeed, self.airspeed_seen)

    def imu_step(self):
        """Time from the last inertial sample to this, s; 0 for the first, and for one after a gap.

        Nobody knows how it turned in a gap, so the attitude is no longer aligned.
        """
        step = np.maximum(self.imu.time_of_validity - self.imu_time, 0.0)
        gap = step > self.gap_limit
        self.aligned = self.aligned & np.logical_not(gap)
        return np.where(gap, 0.0, step)

    def fresh_air(self):
        """Whether the airspeed is not too old."""
        return self.air_told() & (self.time - self.air.time_of_validity <= self.air_timeout + 1.0e-6)

    def new_field(self):
        """Whether there is a field that was not used yet, and no gap lies between it and the attitude."""
        due = self.field.time_of_validity <= self.time + 1.0e-6
        near = self.before(self.field) <= self.gap_limit + 1.0e-6
        return self.field_told() & (self.field.sequence != self.field_seen) & due & near

    def new_gps(self):
        """Whether there is GPS attitude that was not used yet."""
        age = self.time - self.gps.time_of_validity
        largest = np.max(np.abs(np.stack([self.gps.roll, self.gps.pitch, self.gps.heading])))
        come = told(self.gps.valid & (largest <= ANGLE_MOST), self.gps.roll, self.gps.pitch, self.gps.heading)
        in_time = (age >= -1.0e-6) & (age <= self.gps_timeout + 1.0e-6)
        return come & in_time & (self.gps.sequence != self.gps_seen)

    def before(self, bundle):
        """Time from a sample to the last of the inertial unit, s: the attitude is that of then, not of the aiding."""
        return self.imu_time - bundle.time_of_validity

    def unseen(self):
        """Sigmas of :meth:`still`, which are none while GPS tells the attitude."""
        return np.where(self.time - self.gps_time <= self.gps_timeout, 0.0, self.still())
