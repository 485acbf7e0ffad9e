"""The FMU ``doppler_radar``: velocity over the surface in body axes."""

from __future__ import annotations

import numpy as np

from models.attitude import attitude
from models.processes.known import known
from models.radio import doppler
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start


class DopplerRadar(Component):
    """Doppler velocity sensor: forward, right and down velocity over the surface below, at 7.5 Hz.

        v = (1 + s) C_m C_bn (v_n - u_n) + b + fluctuation

    s, b, C_m    scale factor, bias and mounting, each a given value plus one drawn at turn-on
    fluctuation  of the beams' spectra, independent from sample to sample
    u_n          over a sea (over_water) its surface moves with the wind, at 3 kn in 10 kn of wind to 6 kn in 50 kn
                 (Journal of Navigation, "Doppler correction for surface movement"): what is shown leads upwind

    A sea scatters the steeper part of a beam more, which shortens what is measured by sea_bias, 1 percent.

    AGARD CP-298, P1, has 7.5 Hz and a scale factor; the other figures are own choice, of a class of 0.2 to 0.3 percent.
    The sensor tracks up to largest_roll and largest_pitch and below highest_altitude. When it does not, or over smooth
    water (signal_lost), it says so: valid is false, the values are the last ones.
    """

    name = "doppler_radar"
    example = Example(
        {"velocity_n": (46.0, 0.0, 0.0), "altitude": 600.0},
        steps={"over_water": True},
        text="Half-way the aircraft comes over the sea: what is measured is shorter by 1 percent. There is no wind.",
        shows=("velocity.velocity_b",),
    )

    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground: north, east, down")
    roll = Input("rad", display_unit="deg", description="true roll")
    pitch = Input("rad", display_unit="deg", description="true pitch")
    heading = Input("rad", display_unit="deg", description="true heading, may be unwrapped")
    altitude = Input("m", display_unit="ft", description="true height above what is below")
    wind_n = Input(3, "m/s", display_unit="kn", description="wind, for the motion of water: velocity of the air in n")
    over_water = Input(kind="boolean", description="a sea is below")
    signal_lost = Input(kind="boolean", fault=True, description="fault: too little comes back, as from smooth water")
    scale_factor_change = Input("1", fault=True, description="fault: change of the scale factor")

    scale_factor = Parameter("1", start=0.0, min=-0.5, max=0.5, description="given part of the scale factor error")
    scale_factor_sigma = Parameter(
        "1", start=0.002, min=0.0, description="standard deviation of the part that is drawn at turn-on"
    )
    misalignment = Parameter(
        3,
        "rad",
        start=0.0,
        min=-0.2,
        max=0.2,
        display_unit="deg",
        description="given part of the rotation of the antenna about the body axes",
    )
    misalignment_sigma = Parameter(
        "rad",
        start=float(np.radians(0.15)),
        min=0.0,
        max=0.05,
        display_unit="deg",
        description="standard deviation of the part that is drawn at turn-on, each axis",
    )
    bias = Parameter(3, "m/s", start=0.0, display_unit="kn", description="given bias, forward, right, down")
    bias_sigma = Parameter("m/s", start=0.05, min=0.0, description="standard deviation of the bias drawn at turn-on")
    fluctuation_sigma = Parameter(
        3, "m/s", start=(0.4, 0.4, 0.1), min=0.0, description="standard deviation of a sample: forward, right, down"
    )
    sea_bias = Parameter(
        "1", start=doppler.SEA_BIAS, min=0.0, max=0.5, description="share by which a sea shortens the velocity"
    )
    largest_roll = Parameter(
        "rad", start=float(np.radians(45.0)), min=0.0, max=np.pi, display_unit="deg", description="largest roll"
    )
    largest_pitch = Parameter(
        "rad", start=float(np.radians(25.0)), min=0.0, max=np.pi / 2, display_unit="deg", description="largest pitch"
    )
    highest_altitude = Parameter(
        "m", start=15000.0, min=0.0, display_unit="ft", description="height above which too little comes back"
    )
    sample_period = Parameter(
        "s", start=1.0 / 7.5, min=1e-3, max=10.0, description="time between samples: 7.5 Hz (AGARD CP-298, P1)"
    )

    velocity = Bundle(
        velocity_b=Output(3, "m/s", display_unit="kn", description="measured velocity: forward, right, down"),
        description="velocity over the surface",
    )
    own_scale_factor = State("1", description="scale factor error after turn-on")
    own_bias = State(3, "m/s", description="bias after turn-on")
    mounting = State(3, 3, "1", description="C_m after turn-on")

    @start
    def turn_on(self, noise):
        self.own_scale_factor = self.scale_factor + self.scale_factor_sigma * noise(1)[0]
        self.own_bias = self.bias + self.bias_sigma * noise(3)
        self.mounting = attitude.mounting(self.misalignment + self.misalignment_sigma * noise(3))

    @every("sample_period")
    def sample(self, noise):
        moving = np.where(self.over_water, doppler.surface(known(self.wind_n, 0.0)), 0.0)
        velocity_b = attitude.dcm(self.roll, self.pitch, self.heading).T @ (self.velocity_n - moving)
        scale_factor = self.own_scale_factor + self.scale_factor_change - np.where(self.over_water, self.sea_bias, 0.0)
        fluctuation = self.fluctuation_sigma * noise(3)
        shown = doppler.measured(velocity_b, self.mounting, scale_factor, self.own_bias, fluctuation)
        level = (np.abs(self.roll) <= self.largest_roll) & (np.abs(self.pitch) <= self.largest_pitch)
        tracks = level & (self.altitude <= self.highest_altitude) & np.logical_not(self.signal_lost)
        tracks = tracks & np.all(np.isfinite(shown))
        self.velocity.publish(velocity_b=np.where(tracks, shown, self.velocity.velocity_b), valid=tracks)
