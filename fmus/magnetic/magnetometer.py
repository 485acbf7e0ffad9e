"""The magnetometer triad as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.grades import CRUSTAL_LENGTH, MAGNETOMETER
from models.attitude import attitude
from models.earth import earth
from models.magnetic import magnetic_field, magnetometer
from models.processes import gauss_markov
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, require, start


class Magnetometer(Component):
    """Strapdown magnetometer triad in Earth's field: the World Magnetic Model of the date and a crustal anomaly.

    The field in n at the true position and the date is that of the World Magnetic Model, a spherical harmonic series of
    degree 12, which is made anew every five years: WMM2010, WMM2015 version 2, WMM2020, WMM2025, so from 2010.0 to
    2030.0. It is computed every field_period (it changes by some 5 nT per km) and, with an anomaly, turned to body axes
    with the true attitude at every sample. The anomaly, what rocks of the crust and currents above add to a
    series that ends at waves of 3300 km, is on each axis of n a first-order Gauss-Markov process over the distance
    flown, with the standard deviations of that model's error model (WMM2025): 95 to 165 nT north and east, so that the
    declination is off by sqrt(0.26^2 + (5417 nT / H)^2) degrees in a horizontal field H, and 141 nT down. It has no
    map: the same place, flown over twice, has two anomalies. The triad makes of the field, thesis (3.28), p. 58,

        B_m = C_m C_sf C_si (B^b + dB^b) + noise

    dB^b  hard iron, and the fault input
    C_si  = I + soft_iron
    C_sf  = I + diag(scale_factor)
    C_m   = I - [misalignment x], (3.29)

    Each error is a given value plus one drawn at turn-on, which is what a calibration leaves.
    Calibrated triads were left with 4 to 7 mG, which is up to 2.5 degrees of heading (section 3.11, Figs 3.27, 3.30);
    noise is 1 to 5 mG (Table 3.3). The first sample follows the first computation of the field, at field_period.
    """

    name = "magnetometer"
    example = Example(
        {"latitude": 0.6581, "longitude": -2.1262, "altitude": 1500.0, "heading": 1.0},
        steps={"heading": 0.5},
        text="The aircraft turns by 28.65 degrees at once: the horizontal field moves between the forward [1] and the "
        "right [2] axis, the downward part [3] stays. Constant offsets of some mG are the hard iron left by the "
        "calibration.",
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid")
    roll = Input("rad", display_unit="deg", description="true roll angle")
    pitch = Input("rad", display_unit="deg", description="true pitch angle")
    heading = Input("rad", display_unit="deg", description="true heading, from true north")
    hard_iron_change = Input(
        3, "T", display_unit="mG", fault=True, description="fault: change of the hard iron field, body axes"
    )

    crustal_level = Parameter(
        "1",
        start=1.0,
        min=0.0,
        max=10.0,
        description="crustal anomaly over that of the error model, which holds on the ground; 0 for none",
    )
    crustal_length = Parameter(
        "m",
        start=CRUSTAL_LENGTH,
        min=100.0,
        display_unit="km",
        description="distance over which the crustal anomaly is correlated",
    )
    date = Parameter(
        "1", start=2026.0, description="date in decimal years, 2010.0 to 2030.0 (validity of WMM2010 to WMM2025)"
    )
    hard_iron = Parameter(
        3, "T", start=0.0, display_unit="mG", description="given part of the hard iron field, dB^b of thesis (3.28)"
    )
    hard_iron_sigma = Parameter(
        3,
        "T",
        start=MAGNETOMETER["hard_iron_sigma"],
        min=0.0,
        display_unit="mG",
        description="standard deviation of the hard iron left by the calibration, thesis Fig 3.27: 4 to 7 mG",
    )
    soft_iron = Parameter(
        (3, 3),
        "1",
        start=0.0,
        min=-0.9,
        max=10.0,
        description="given part of the soft iron, C_si - I of thesis (3.28), body axes",
    )
    soft_iron_sigma = Parameter(
        "1",
        start=MAGNETOMETER["soft_iron_sigma"],
        min=0.0,
        max=0.1,
        description="standard deviation of each element of the soft iron left by the calibration",
    )
    scale_factor = Parameter(
        3,
        "1",
        start=0.0,
        min=-0.9,
        max=10.0,
        description="given part of the scale factor errors, the diagonal of C_sf - I of (3.28)",
    )
    scale_factor_sigma = Parameter(
        3,
        "1",
        start=MAGNETOMETER["scale_factor_sigma"],
        min=0.0,
        max=0.1,
        description="standard deviation of the scale factor errors left by the calibration",
    )
    misalignment = Parameter(
        3,
        "rad",
        start=0.0,
        min=-0.2,
        max=0.2,
        display_unit="deg",
        description="given part of the rotation of the triad about the body axes, thesis (3.29)",
    )
    misalignment_sigma = Parameter(
        3,
        "rad",
        start=MAGNETOMETER["misalignment_sigma"],
        min=0.0,
        max=0.05,
        display_unit="deg",
        description="standard deviation of the part of that rotation that is drawn at turn-on",
    )
    noise_sigma = Parameter(
        3,
        "T",
        start=MAGNETOMETER["noise_sigma"],
        min=0.0,
        display_unit="mG",
        description="wide-band noise per sample, thesis Table 3.3: 1 to 5 mG",
    )
    sample_period = Parameter(
        "s", start=0.05, min=1e-3, max=10.0, description="sampling period, thesis Fig 3.29: 20 Hz"
    )
    field_period = Parameter("s", start=1.0, min=1e-3, max=60.0, description="period at which the field is computed")

    field = Bundle(
        field_b=Output(3, "T", display_unit="mG", description="measured field, body axes"),
        description="measurement",
    )

    field_n = State(3, "T", description="Earth's field, north, east, down")
    crust = State(3, "1", description="crustal anomaly over its standard deviation, north, east, down")
    place_e = State(3, "m", description="where the field was computed last, earth-centred axes")
    field_known = State(kind="boolean", description="the field has been computed")
    hard_iron_b = State(3, "T", description="hard iron after turn-on")
    distortion = State((3, 3), "1", description="C_m C_sf C_si")

    @require(
        "the date {date} is outside the validity of every World Magnetic Model that is known here: those of 2010, "
        "2015, 2020 and 2025 are valid from 2010.0 to 2030.0"
    )
    def model_is_valid(self):
        return magnetic_field.known(self.date)

    @start
    def turn_on(self, noise):
        n = noise(21)
        self.hard_iron_b = self.hard_iron + self.hard_iron_sigma * n[0:3]
        self.distortion = magnetometer.distortion(
            self.soft_iron + self.soft_iron_sigma * n[3:12].reshape(3, 3),
            self.scale_factor + self.scale_factor_sigma * n[12:15],
            self.misalignment + self.misalignment_sigma * n[15:18],
        )
        self.crust = gauss_markov.stationary(1.0, n[18:21])

    @every("field_period")
    def compute_field(self, noise):
        place_e = earth.to_ecef(self.latitude, self.longitude, self.altitude)
        flown = np.where(self.field_known, np.sqrt(np.sum((place_e - self.place_e) ** 2)), 0.0)
        phi = gauss_markov.decay(flown, self.crustal_length)
        self.crust = gauss_markov.advance(self.crust, phi, gauss_markov.drive(1.0, phi), noise(3))
        model_n = magnetic_field.field(self.latitude, self.longitude, self.altitude, self.date)
        self.field_n = model_n + self.crustal_level * magnetic_field.left_out(model_n, self.date) * self.crust
        self.place_e = place_e
        self.field_known = True

    @every("sample_period")
    def sample(self, noise):
        field_b = attitude.dcm(self.roll, self.pitch, self.heading).T @ self.field_n
        measured = magnetometer.sense(
            field_b, self.hard_iron_b + self.hard_iron_change, self.distortion, self.noise_sigma * noise(3)
        )
        self.field.publish(field_b=measured, when=self.field_known)
