"""The air data computer as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.grades import AIR_DATA
from models.air import air_data, atmosphere
from models.processes import gauss_markov
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, State, every, start


class AirData(Component):
    """Air data system: pitot-static chain, airspeed and pressure altitude.

    From the true altitude and air-relative velocity come the static pressure p, the total pressure p_t and the
    temperature of the standard atmosphere (with a temperature and a sea-level pressure of the day), behind the ports
    the measured ones, and from these (thesis section 2.5.3, p. 24)

        h_p = T_0/lambda (1 - (p/p_0)^(R lambda/g))               pressure altitude, (2.1)
        V_c = a_0 sqrt(5 ((1 + (p_t - p)/p_0)^(2/7) - 1))         calibrated airspeed, the compressible form of (2.2)
        V_i = V_c + dV + dV_w                                     indicated airspeed, (3.30)-(3.31), p. 63
        V   = a sqrt(5 ((1 + q_c(V_i)/p)^(2/7) - 1))              true airspeed with the measured temperature
        h   = h_p + dh                                            (3.34), p. 65

    dV and dh are first-order Gauss-Markov: 2.6 m/s (5 kn), 400 s (3.32)-(3.33); 23 m (75 ft), 400 s (3.34). They
    start in their stationary distributions. dV_w is white, zero in the thesis (1 m/s in its source). The transducer
    shows the difference of pressures as (1 + pitot coefficient) (p_t - p) + offset; these two and the error of the
    temperature probe are constant, each a given value plus one drawn at turn-on.

    A pitot tube takes the total pressure of an oblique flow, too (to within 1 % up to 10 degrees), so angle of attack
    and sideslip do not enter.

    What the sigmas of all these errors are in true airspeed at the density and speed of the moment is published with
    it: 2.6 m/s at sea level are 4 m/s at 8.5 km. Given errors and blocked ports are not in it.

    A blocked port keeps the pressure it had; one that is blocked before the first sample keeps that of the first
    sample. Blocked pitot tube: the airspeed does not answer to speed and rises in a climb. Blocked static port: the
    altitude freezes; the airspeed reads low above the altitude of blocking, high below it.
    """

    name = "air_data"
    example = Example(
        {"altitude": 1500.0, "velocity_n": (46.3, 0.0, 0.0)},
        steps={"altitude": 300.0, "wind_n": (-10.0, 0.0, 0.0)},
        text="The aircraft is 300 m higher at once and meets a head wind of 10 m/s: airspeeds rise by 19.4 kn less "
        "what the thinner air takes from the calibrated one, temperature falls by 2 degrees. The slow wandering is the "
        "Gauss-Markov error of the instruments.",
    )

    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid")
    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground, north, east, down")
    wind_n = Input(3, "m/s", display_unit="kn", description="velocity of the air over ground, north, east, down")
    pitot_blocked = Input(kind="boolean", fault=True, description="fault: pitot tube and its drain blocked")
    static_blocked = Input(kind="boolean", fault=True, description="fault: static port blocked")

    airspeed_error_sigma = Parameter(
        "m/s",
        start=AIR_DATA["airspeed_error_sigma"],
        min=0.0,
        display_unit="kn",
        description="standard deviation of the airspeed error, thesis (3.32): 2.6 m/s (5 kn)",
    )
    airspeed_error_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time of the airspeed error, thesis (3.32): 400 s"
    )
    airspeed_noise_sigma = Parameter(
        "m/s",
        start=0.0,
        min=0.0,
        display_unit="kn",
        description="white noise of the airspeed per sample, thesis section 3.7.1: 0 (1 m/s in its source)",
    )
    altitude_error_sigma = Parameter(
        "m",
        start=AIR_DATA["altitude_error_sigma"],
        min=0.0,
        display_unit="ft",
        description="standard deviation of the altitude error, thesis (3.34): 23 m (75 ft)",
    )
    altitude_error_time = Parameter(
        "s", start=400.0, min=1.0, description="correlation time of the altitude error, thesis (3.34): 400 s"
    )
    pitot_coefficient = Parameter(
        "1",
        start=0.0,
        min=-0.5,
        max=0.5,
        description="given part of the error of the difference of pressures, relative",
    )
    pitot_coefficient_sigma = Parameter(
        "1",
        start=AIR_DATA["pitot_coefficient_sigma"],
        min=0.0,
        max=0.1,
        description="standard deviation of the part that is drawn at turn-on; 2 % is 1 % of the airspeed",
    )
    pressure_offset = Parameter(
        "Pa",
        start=0.0,
        min=-1e3,
        max=1e3,
        description="given part of the error of the difference of pressures, absolute",
    )
    pressure_offset_sigma = Parameter(
        "Pa",
        start=AIR_DATA["pressure_offset_sigma"],
        min=0.0,
        max=1e3,
        description="standard deviation of the part that is drawn at turn-on",
    )
    temperature_error = Parameter(
        "K", start=0.0, min=-50.0, max=50.0, description="given part of the error of the temperature probe"
    )
    temperature_error_sigma = Parameter(
        "K",
        start=AIR_DATA["temperature_error_sigma"],
        min=0.0,
        max=20.0,
        description="standard deviation of the part that is drawn at turn-on",
    )
    temperature_deviation = Parameter(
        "K", start=0.0, min=-60.0, max=60.0, description="temperature of the day minus the standard one, at all heights"
    )
    sea_level_pressure = Parameter(
        "Pa",
        start=atmosphere.PRESSURE,
        min=80000.0,
        max=110000.0,
        display_unit="hPa",
        description="pressure of the day at mean sea level (standard: 1013.25 hPa)",
    )
    geoid_height = Parameter(
        "m", start=0.0, min=-120.0, max=120.0, description="height of mean sea level above the ellipsoid"
    )
    sample_period = Parameter("s", start=0.1, min=1e-3, max=10.0, description="sampling period")

    air = Bundle(
        true_airspeed=Output("m/s", display_unit="kn", description="true airspeed"),
        true_airspeed_sigma=Output(
            "m/s", display_unit="kn", description="standard deviation of true airspeed by the errors that are drawn"
        ),
        calibrated_airspeed=Output("m/s", display_unit="kn", description="airspeed as indicated, V_i"),
        pressure_altitude=Output("m", display_unit="ft", description="pressure altitude, setting 1013.25 hPa"),
        temperature=Output(
            "K", start=atmosphere.TEMPERATURE, display_unit="degC", description="outside air temperature"
        ),
        description="air data",
    )

    sampled = State(kind="boolean", description="there has been a sample, whose pressures a blocked port keeps")
    static_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="behind the static port")
    total_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="behind the pitot tube")
    pitot_gain_error = State("1", description="relative error of the difference of pressures")
    pressure_bias = State("Pa", description="absolute error of the difference of pressures")
    temperature_bias = State("K", description="error of the temperature probe")
    airspeed_error = State("m/s", description="Gauss-Markov error of the airspeed")
    altitude_error = State("m", description="Gauss-Markov error of the altitude")
    airspeed_decay = State("1", description="exp(-T/tau) of the airspeed error")
    altitude_decay = State("1", description="exp(-T/tau) of the altitude error")
    airspeed_drive = State("m/s", description="sigma sqrt(1 - phi^2) of the airspeed error")
    altitude_drive = State("m", description="sigma sqrt(1 - phi^2) of the altitude error")

    @start
    def turn_on(self, noise):
        n = noise(5)
        self.pitot_gain_error = self.pitot_coefficient + self.pitot_coefficient_sigma * n[2]
        self.pressure_bias = self.pressure_offset + self.pressure_offset_sigma * n[3]
        self.temperature_bias = self.temperature_error + self.temperature_error_sigma * n[4]
        self.airspeed_error = gauss_markov.stationary(self.airspeed_error_sigma, n[0])
        self.altitude_error = gauss_markov.stationary(self.altitude_error_sigma, n[1])
        self.airspeed_decay = gauss_markov.decay(self.sample_period, self.airspeed_error_time)
        self.altitude_decay = gauss_markov.decay(self.sample_period, self.altitude_error_time)
        self.airspeed_drive = gauss_markov.drive(self.airspeed_error_sigma, self.airspeed_decay)
        self.altitude_drive = gauss_markov.drive(self.altitude_error_sigma, self.altitude_decay)

    @every("sample_period")
    def sample(self, noise):
        n = noise(3)
        self.airspeed_error = gauss_markov.advance(self.airspeed_error, self.airspeed_decay, self.airspeed_drive, n[0])
        self.altitude_error = gauss_markov.advance(self.altitude_error, self.altitude_decay, self.altitude_drive, n[1])

        relative = self.velocity_n - self.wind_n
        static, total, temperature = air_data.pressures(
            np.sqrt(np.sum(relative * relative)),
            atmosphere.geopotential(self.altitude - self.geoid_height),
            self.temperature_deviation,
            self.sea_level_pressure,
        )
        self.static_pressure = air_data.trapped(static, self.static_pressure, self.sampled & self.static_blocked)
        self.total_pressure = air_data.trapped(total, self.total_pressure, self.sampled & self.pitot_blocked)
        self.sampled = True

        difference = air_data.sensed(
            self.total_pressure - self.static_pressure, self.pitot_gain_error, self.pressure_bias
        )
        calibrated = air_data.calibrated_airspeed(difference)
        indicated = np.maximum(calibrated + self.airspeed_error + self.airspeed_noise_sigma * n[2], 0.0)
        measured_temperature = temperature + self.temperature_bias
        sigma = air_data.true_airspeed_sigma(
            indicated,
            self.static_pressure,
            measured_temperature,
            np.hypot(self.airspeed_error_sigma, self.airspeed_noise_sigma),
            self.pitot_coefficient_sigma,
            self.pressure_offset_sigma,
            self.temperature_error_sigma,
        )
        self.air.publish(
            calibrated_airspeed=indicated,
            true_airspeed=air_data.true_airspeed(indicated, self.static_pressure, measured_temperature),
            true_airspeed_sigma=sigma,
            pressure_altitude=atmosphere.pressure_altitude(self.static_pressure) + self.altitude_error,
            temperature=measured_temperature,
        )
