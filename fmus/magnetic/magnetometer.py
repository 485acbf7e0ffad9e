"""The magnetometer triad as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.grades import CRUSTAL_LENGTH, MAGNETOMETER
from models.attitude import attitude
from models.earth import earth
from models.magnetic import crust, magnetic_field, magnetometer, wire
from models.processes import gauss_markov
from models.processes.known import known
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
    map: the same place, flown over twice, has two anomalies. With crust_decays it falls with the height, as waves that
    are correlated over crustal_length on the ground do: 87 % are left at 500 m, 79 % at 1 km, 50 % at 5 km.
    The triad makes of the field, thesis (3.28), p. 58,

        B_m = C_m C_sf C_si (B^b + dB^b) + noise

    dB^b  hard iron, its change, and the field of a straight wire with a current
    C_si  = I + soft_iron, and its change
    C_sf  = I + diag(scale_factor)
    C_m   = I - [misalignment x], (3.29)

    and gives it within its range, in steps of its resolution.
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
        3, "T", display_unit="mG", fault=True, description="fault F16: change of the hard iron field, body axes"
    )
    soft_iron_change = Input((3, 3), "1", fault=True, description="fault F17: change of the soft iron, body axes")
    wire_current = Input("A", fault=True, description="fault F16: current of the wire, from its begin to its end")
    anomaly_n = Input(
        3,
        "T",
        display_unit="mG",
        fault=True,
        description="fault F18: field of something on the ground, north, east, down; it decays from ground_altitude on",
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
    crust_decays = Parameter(
        kind="boolean", start=False, description="the crustal anomaly falls with the height above ground_altitude"
    )
    ground_altitude = Parameter(
        "m",
        start=0.0,
        min=-500.0,
        max=9000.0,
        display_unit="ft",
        description="height of the ground above the ellipsoid",
    )
    anomaly_depth = Parameter(
        "m",
        start=50.0,
        min=0.1,
        description="depth below the ground of what makes anomaly_n, a dipole; (depth / (depth + h))^3 of it is left "
        "at the height h (own choice: 50 m)",
    )
    wire_begin_b = Parameter(
        3,
        "m",
        start=(-1.0, 0.0, 0.5),
        min=-100.0,
        max=100.0,
        description="where the current enters the wire, from the triad, body axes (own choice: 0.5 m below it)",
    )
    wire_end_b = Parameter(
        3,
        "m",
        start=(1.0, 0.0, 0.5),
        min=-100.0,
        max=100.0,
        description="where the current leaves the wire; 2 m along the fuselage, 0.5 m below, are 3.6 mG an ampere",
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
    field_range = Parameter(
        "T",
        start=2e-4,
        min=1e-5,
        display_unit="mG",
        description="largest field of an axis; 2 G of a Honeywell HMR2300, the thesis's (section 4.11.1)",
    )
    resolution = Parameter(
        "T",
        start=0.0,
        min=0.0,
        display_unit="mG",
        description="step of the output, 0 for none; the HMR2300 has 0.067 mG",
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
    triad = State((3, 3), "1", description="C_m C_sf")
    wire_field_b = State(3, "T/A", description="field of the wire over its current")

    @require(
        "the date {date} is outside the validity of every World Magnetic Model that is known here: those of 2010, "
        "2015, 2020 and 2025 are valid from 2010.0 to 2030.0"
    )
    def model_is_valid(self):
        return magnetic_field.known(self.date)

    @require("the wire from wire_begin_b to wire_end_b passes within 1 mm of the triad; expected at some distance")
    def wire_passes_by(self):
        return wire.distance(self.wire_begin_b, self.wire_end_b) >= 1.0e-3

    @start
    def turn_on(self, noise):
        n = noise(21)
        self.hard_iron_b = self.hard_iron + self.hard_iron_sigma * n[0:3]
        soft_iron = self.soft_iron + self.soft_iron_sigma * n[3:12].reshape(3, 3)
        scale_factor = self.scale_factor + self.scale_factor_sigma * n[12:15]
        misalignment = self.misalignment + self.misalignment_sigma * n[15:18]
        self.distortion = magnetometer.distortion(soft_iron, scale_factor, misalignment)
        self.triad = magnetometer.triad(scale_factor, misalignment)
        self.wire_field_b = wire.field(self.wire_begin_b, self.wire_end_b, 1.0)
        self.crust = gauss_markov.stationary(1.0, n[18:21])

    @every("field_period")
    def compute_field(self, noise):
        place_e = earth.to_ecef(self.latitude, self.longitude, self.altitude)
        flown = np.where(self.field_known, np.sqrt(np.sum((place_e - self.place_e) ** 2)), 0.0)
        phi = gauss_markov.decay(known(flown, 0.0), self.crustal_length)
        self.crust = gauss_markov.advance(self.crust, phi, gauss_markov.drive(1.0, phi), noise(3))
        model_n = magnetic_field.field(self.latitude, self.longitude, self.altitude, self.date)
        left_out_n = self.crustal_level * magnetic_field.left_out(model_n, self.date)
        share = np.where(self.crust_decays, crust.wave_share(self._height(), self.crustal_length), 1.0)
        self.field_n = model_n + left_out_n * self.crust * share
        self.place_e = known(place_e, self.place_e)
        self.field_known = True

    @every("sample_period")
    def sample(self, noise):
        anomaly_n = self.anomaly_n * crust.dipole_share(self._height(), self.anomaly_depth)
        field_b = attitude.dcm(self.roll, self.pitch, self.heading).T @ (self.field_n + anomaly_n)
        hard_iron_b = self.hard_iron_b + self.hard_iron_change + self.wire_current * self.wire_field_b
        distortion = self.distortion + self.triad @ self.soft_iron_change
        measured = magnetometer.sense(field_b, hard_iron_b, distortion, self.noise_sigma * noise(3))
        self.field.publish(
            field_b=magnetometer.digitise(measured, self.field_range, self.resolution),
            valid=np.isfinite(np.sum(measured)),
            when=self.field_known,
        )

    def _height(self):
        return np.maximum(self.altitude - self.ground_altitude, 0.0)
