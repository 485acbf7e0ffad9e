"""The FMU ``field_correction``: takes the errors that a calibration has found out of a triad's field."""

from __future__ import annotations

import numpy as np

from fmus.attitude.ahrs import Ahrs
from fmus.magnetic import examples
from fmus.magnetic.magnetometer import Magnetometer
from models.magnetic import magnetometer
from navfmu.export import Bundle, Component, Example, Output, Parameter, State, on_new, require, start


class FieldCorrection(Component):
    """Calibrated field of a magnetometer triad, between the triad and whatever takes its field.

    Thesis (3.28) solved for the field, without its noise:

        B^b = (C_m C_sf C_si)^-1 B_m - dB^b

    The parameters are those of `magnetometer`, by the same names, so that a set of `navfmu calibrate magnetometer`
    makes the one err as the recorded triad did, and the other undo it. Each sample is passed on at once, with its
    number and its time of validity. What is no number is passed on as not valid.
    """

    name = "field_correction"
    tick = "tick_period"
    example = Example(
        {"hard_iron": examples.IRON, "scale_factor": examples.SCALE},
        text="A full circle at 3 deg/s in level flight (60 to 184 s) with hard iron of 98 mG and scale factors that "
        "are off by some percent: the corrected field is of one strength.",
        duration=240.0,
        step=0.1,
        inputs=examples.correction_inputs,
        panels=examples.correction_panels,
    )

    field = Ahrs.field

    tick_period = Parameter("s", start=0.01, min=1e-4, max=60.0, description="how often new samples are looked for")
    hard_iron = Magnetometer.hard_iron
    soft_iron = Magnetometer.soft_iron
    scale_factor = Magnetometer.scale_factor
    misalignment = Magnetometer.misalignment

    corrected = Bundle(
        field_b=Output(3, "T", display_unit="mG", description="magnetic field without the errors, body axes"),
        description="calibrated measurement",
    )

    inverse = State((3, 3), "1", description="(C_m C_sf C_si)^-1")

    @require("soft_iron, scale_factor and misalignment make of some field none at all; expected errors below 1")
    def fields_are_told_apart(self):
        return np.abs(np.linalg.det(self._distortion())) > 1.0e-6

    @start
    def solve(self):
        self.inverse = np.linalg.inv(self._distortion())

    @on_new("field")
    def correct(self):
        field_b = magnetometer.corrected(self.field.field_b, self.hard_iron, self.inverse)
        told = np.isfinite(np.sum(field_b))
        self.corrected.publish(
            field_b=np.where(told, field_b, self.corrected.field_b),
            valid=self.field.valid & told,
            sequence=self.field.sequence,
            time_of_validity=self.field.time_of_validity,
        )

    def _distortion(self):
        return magnetometer.distortion(self.soft_iron, self.scale_factor, self.misalignment)
