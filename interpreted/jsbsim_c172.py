"""A Cessna 172 in JSBSim, flown along a flight plan, as an FMU that needs Python."""

from __future__ import annotations

import copy

import numpy as np

from fmus.motion.aircraft import Aircraft
from interpreted.cessna import Cessna
from models.motion import aircraft, autopilot, flight_plan
from navfmu.export import Component, Output, Parameter, State, every, require, start


def _airspeed(speed, description):
    """A speed of the plan of aircraft, which is one over ground there."""
    speed = copy.copy(speed)
    speed.description = description
    return speed


class JsbsimC172(Component):
    """True motion of a Cessna 172P by JSBSim; the interface of aircraft. Needs the Python package jsbsim.

    The package has to be in the Python of the host: pip install jsbsim. The state of the FMU cannot be saved.

    The motion of aircraft is its plan, and the attitude follows from the motion; here all follows from the controls.
    JSBSim, a flight dynamics model that this project did not write, integrates the forces that its tables give for
    wings, tail, engine and propeller. Input, outputs and the parameters of the flight plan are those of aircraft, so
    this FMU takes the place of aircraft.fmu in a system. The plan is what an autopilot (models.motion.autopilot) is
    asked for:

        track      course over ground, by bank; position is not held
        altitude   above the ellipsoid, by pitch
        speed      segment_speed is the true airspeed here, by throttle; an aircraft in wind then has another ground
                   speed than the plan says

    The motion is that of the centre of gravity. The flight begins trimmed, nose into the relative wind. The wind is
    wind_n as it is given at each step; turbulence of JSBSim's own is off. The air is the standard atmosphere.
    JSBSim's earth is the WGS-84 ellipsoid with gravity to J2; specific_force belongs to that gravity, which is up to
    1.2e-4 m/s2 beside normal gravity (5e-5 at 38 degrees). Fuel is burnt: after some hours the engine stops.

    How the flight agrees with itself, and what a shipped system does on it: docs/jsbsim.md.
    """

    name = "jsbsim_c172"
    needs = ("jsbsim",)

    wind_n = Aircraft.wind_n

    initial_latitude = Aircraft.initial_latitude
    initial_longitude = Aircraft.initial_longitude
    initial_altitude = Aircraft.initial_altitude
    initial_track = Aircraft.initial_track
    initial_speed = _airspeed(Aircraft.initial_speed, "true airspeed at t = 0, 30 to 60 m/s")
    segment_duration = Aircraft.segment_duration
    segment_turn_rate = Aircraft.segment_turn_rate
    segment_vertical_speed = Aircraft.segment_vertical_speed
    segment_speed = _airspeed(Aircraft.segment_speed, "true airspeed, 30 to 60 m/s")
    roll_rate_limit = Aircraft.roll_rate_limit
    acceleration_limit = Aircraft.acceleration_limit
    vertical_acceleration_limit = Aircraft.vertical_acceleration_limit
    update_period = Parameter(
        "s", start=0.01, min=1e-3, max=0.02, description="period of the autopilot, and step of JSBSim's integration"
    )
    plan_period = Aircraft.plan_period

    latitude = Aircraft.latitude
    longitude = Aircraft.longitude
    altitude = Aircraft.altitude
    velocity_n = Aircraft.velocity_n
    roll = Aircraft.roll
    pitch = Aircraft.pitch
    heading = Aircraft.heading
    specific_force = Aircraft.specific_force
    rate = Aircraft.rate
    air_velocity_n = Aircraft.air_velocity_n
    true_airspeed = Aircraft.true_airspeed
    angle_of_attack = Aircraft.angle_of_attack
    sideslip = Aircraft.sideslip
    aileron = Output("1", description="control, -1 to 1, positive rolls to the right")
    elevator = Output("1", description="control without its trim, -1 to 1, positive lowers the nose")
    throttle = Output("1", description="control, 0 to 1")
    rudder = Output("1", description="control, -1 to 1, positive turns the nose to the left")

    roll_integral = State("1", description="I_phi of the autopilot (4)")
    pitch_integral = State("rad", description="I_w of the autopilot (3)")
    speed_integral = State("1", description="I_V of the autopilot (6)")

    _plan = Aircraft._plan
    plan_has_no_gap = Aircraft.plan_has_no_gap
    transitions_fit = Aircraft.transitions_fit

    @require("a speed of the flight plan is not one of a Cessna 172: 30 m/s to 60 m/s of true airspeed")
    def plan_is_flown(self):
        speeds = np.concatenate([np.reshape(self.initial_speed, (1,)), self.segment_speed])
        flown = np.concatenate([np.array([True]), self.segment_duration > 0.0])
        return np.all(np.where(flown, np.logical_and(speeds >= 30.0, speeds <= 60.0), True))

    @require("initial_altitude {initial_altitude} m is not one of a Cessna 172: 0 m to 4000 m")
    def altitude_is_flown(self):
        return np.logical_and(self.initial_altitude >= 0.0, self.initial_altitude <= 4000.0)

    @start
    def begin(self):
        self.kept["plan"] = aircraft.schedule(*self._plan())
        flight = self.kept["flight"] = Cessna(
            (self.initial_latitude, self.initial_longitude, self.initial_altitude),
            self.initial_track + _crab(self.initial_track, self.initial_speed, self.wind_n),
            self.initial_speed,
            self.wind_n,
            self.update_period,
        )
        self.pitch_integral = flight.pitch
        self.speed_integral = flight.trim["throttle"]
        self._publish(flight, flight.trim)

    @every("update_period")
    def fly(self):
        flight = self.kept["flight"]
        controls = self._controls(flight, flight_plan.asked(self.kept["plan"], self.time - self.period))
        flight.step(self.wind_n, **controls)
        self._publish(flight, controls)

    def _controls(self, flight, plan):
        """What the autopilot does where the flight is, to be where the plan is."""
        north, east, down = flight.velocity_n
        airspeed, bank = flight.airspeed, flight.roll
        roll_rate, pitch_rate, yaw_rate = flight.relative_rate
        bank_asked = autopilot.asked_bank(
            np.arctan2(east, north), np.hypot(north, east), plan["track"], plan["turn_rate"]
        )
        climb_asked = autopilot.asked_climb(flight.altitude, plan["altitude"], plan["vertical_speed"])
        aileron, self.roll_integral = autopilot.roll(
            bank, bank_asked, roll_rate, self.roll_integral, flight.trim["aileron"], self.period
        )
        pitch_asked, self.pitch_integral = autopilot.pitch(
            -down, climb_asked, airspeed, self.pitch_integral, self.period
        )
        throttle, self.speed_integral = autopilot.throttle(airspeed, plan["speed"], self.speed_integral, self.period)
        elevator = autopilot.elevator(flight.pitch, pitch_asked, pitch_rate, bank, airspeed, flight.trim["elevator"])
        rudder = autopilot.rudder(flight.sideslip, yaw_rate, bank, airspeed, flight.trim["rudder"])
        return {"aileron": aileron, "elevator": elevator, "throttle": throttle, "rudder": rudder}

    def _publish(self, flight, controls):
        """Outputs from the flight."""
        self.latitude = flight.latitude
        self.longitude = flight.longitude
        self.altitude = flight.altitude
        self.velocity_n = flight.velocity_n
        self.roll = flight.roll
        self.pitch = flight.pitch
        self.heading = flight.heading
        self.specific_force = flight.specific_force
        self.rate = flight.rate
        self.air_velocity_n = flight.air_velocity_n
        self.true_airspeed = flight.airspeed
        self.angle_of_attack = flight.angle_of_attack
        self.sideslip = flight.sideslip
        self.aileron = controls["aileron"]
        self.elevator = controls["elevator"]
        self.throttle = controls["throttle"]
        self.rudder = controls["rudder"]


def _crab(track, airspeed, wind_n):
    """Heading minus track in a wind that blows across, rad."""
    across = wind_n[1] * np.cos(track) - wind_n[0] * np.sin(track)
    return -np.arcsin(np.clip(across / airspeed, -0.7, 0.7))
