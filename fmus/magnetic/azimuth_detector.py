"""The magnetic azimuth detector as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.grades import AZIMUTH
from models.attitude import attitude
from models.magnetic import azimuth, magnetic_field
from models.processes import gauss_markov
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, require, start


class AzimuthDetector(Component):
    """Magnetic azimuth detector: a pendulous flux valve that gives heading from magnetic north.

    The field in n is that of the World Magnetic Model of the date, computed every field_period. The detector hangs in
    the aircraft: it measures the two components of the field in the plane across the specific force, and its heading is
    that of thesis (2.3) in this plane,

        psi_m = atan2(-B_right, B_ahead) + deviation + dpsi + noise

    deviation  A + B sin psi + C cos psi + D sin 2 psi + E cos 2 psi of the heading without it, thesis (3.52): A
               mounting, B and C hard iron and currents, D and E soft iron; and the fault input
    dpsi       first-order Gauss-Markov process, (7) of AGARD CP-298, P1, and thesis (3.83)-(3.85): 2.5 degrees,
               120 s. P1 leaves its figures out. It starts in its stationary distribution and is advanced exactly
    noise      3.5 degrees a sample at 20 Hz, thesis Fig 3.29, which are the 0.8 degrees of (3.86) at 1 Hz

    In a turn it hangs along the apparent vertical and measures of the steep field, too: on north with 15 degrees of
    bank and a dip of 60 the heading is off by 24 degrees against the turn, on east by little. Thesis section 3.6.1:
    such compasses cannot be used in turns. Without a specific force (not connected) it hangs along the true vertical.

    Where the horizontal field is below least_horizontal, near the magnetic poles, the heading is not valid. True
    heading is psi_m and the variation (declination) of the place. Not modelled: the stops and the swinging of the
    pendulum, and the crustal anomaly.
    """

    name = "azimuth_detector"
    example = Example(
        {"latitude": 0.6581, "longitude": -2.1262, "altitude": 1500.0, "heading": 1.0},
        steps={"heading": 0.5},
        text="The aircraft turns by 28.65 degrees at once. The magnetic heading is less than the true one by the "
        "declination, 12.7 degrees, and off by what the swing left, which changes within minutes; noise is 3.5 "
        "degrees.",
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid")
    roll = Input("rad", display_unit="deg", description="true roll angle")
    pitch = Input("rad", display_unit="deg", description="true pitch angle")
    heading = Input("rad", display_unit="deg", description="true heading, from true north")
    specific_force = Input(3, "m/s2", description="true specific force, body axes; 0 to hang along the true vertical")
    deviation_change = Input(
        5, "rad", display_unit="deg", fault=True, description="fault: change of the deviation's A, B, C, D, E"
    )

    date = Parameter(
        "1", start=2026.0, description="date in decimal years, 2010.0 to 2030.0 (validity of WMM2010 to WMM2025)"
    )
    deviation = Parameter(
        5,
        "rad",
        start=0.0,
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="coefficients A, B, C, D, E of the deviation that the swing left, thesis (3.52)",
    )
    drift_sigma = Parameter(
        "rad",
        start=AZIMUTH["drift_sigma"],
        min=0.0,
        display_unit="deg",
        description="standard deviation of the error that changes slowly, thesis (3.84): 2.5 deg",
    )
    drift_time = Parameter(
        "s", start=AZIMUTH["drift_time"], min=1e-3, description="its correlation time, thesis (3.85): 120 s"
    )
    noise_sigma = Parameter(
        "rad",
        start=AZIMUTH["noise_sigma"],
        min=0.0,
        display_unit="deg",
        description="wide-band noise per sample, thesis Fig 3.29: 3.5 deg at 20 Hz",
    )
    least_horizontal = Parameter(
        "T",
        start=2e-6,
        min=0.0,
        display_unit="mG",
        description="least horizontal field of a valid heading; NOAA's blackout zones are below 2000 nT",
    )
    sample_period = Parameter(
        "s", start=0.05, min=1e-3, max=10.0, description="sampling period, thesis Fig 3.29: 20 Hz"
    )
    field_period = Parameter("s", start=1.0, min=1e-3, max=60.0, description="period at which the field is computed")

    azimuth = Bundle(
        magnetic_heading=Output("rad", display_unit="deg", description="heading from magnetic north, -pi to pi"),
        description="measurement",
    )

    field_n = State(3, "T", description="Earth's field, north, east, down")
    field_known = State(kind="boolean", description="the field has been computed")
    drift = State("rad", description="error that changes slowly")

    @require(
        "the date {date} is outside the validity of every World Magnetic Model that is known here: those of 2010, "
        "2015, 2020 and 2025 are valid from 2010.0 to 2030.0"
    )
    def model_is_valid(self):
        return magnetic_field.known(self.date)

    @start
    def turn_on(self, noise):
        self.drift = gauss_markov.stationary(self.drift_sigma, noise(1)[0])

    @every("field_period")
    def compute_field(self):
        self.field_n = magnetic_field.field(self.latitude, self.longitude, self.altitude, self.date)
        self.field_known = True

    @every("sample_period")
    def sample(self, noise):
        n = noise(2)
        phi = gauss_markov.decay(self.sample_period, self.drift_time)
        self.drift = gauss_markov.advance(self.drift, phi, gauss_markov.drive(self.drift_sigma, phi), n[0])
        C_bn = attitude.dcm(self.roll, self.pitch, self.heading).T
        down_b = azimuth.hanging(self.specific_force, C_bn[:, 2])
        seen = azimuth.heading(C_bn @ self.field_n, down_b)
        deviation = azimuth.deviation(seen, self.deviation + self.deviation_change)
        shown = attitude.wrap(seen + deviation + self.drift + self.noise_sigma * n[1])
        horizontal = np.hypot(self.field_n[0], self.field_n[1])
        self.azimuth.publish(
            magnetic_heading=shown,
            valid=(horizontal >= self.least_horizontal) & np.isfinite(shown),
            when=self.field_known,
        )
