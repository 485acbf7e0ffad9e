"""The air data computer as an FMU."""

from __future__ import annotations

import numpy as np

from fmus.air.grades import AIR
from fmus.grades import AIR_DATA
from models.air import air_data, altimeter, atmosphere, pneumatics
from models.attitude import attitude
from models.earth import geoid
from models.processes import gauss_markov
from navfmu.export import Bundle, Component, Example, Grid, Input, Output, Parameter, State, every, start


class AirData(Component):
    """Air data system: pitot-static lines, airspeeds, altitudes, vertical speed and temperature.

    From the true altitude and air-relative velocity come the static pressure p, the impact pressure q_c = p_t - p and
    the temperature of the standard atmosphere (with a temperature and a sea-level pressure of the day). The ports take

        p + C_p q_c,  C_p = C_0 + C_alpha alpha + C_beta beta^2     static port: position error, off at first
        p_t                                                         pitot tube, calibrated with its drain hole

    (for C_alpha and C_beta connect roll, pitch and heading; with `geoid_by_position` and latitude and longitude heights
    are above the sea as EGM96 has it, to 1 m rms). A pitot tube takes the total pressure of an oblique flow
    (to within 1 % up to 10 degrees). Two lines lead to the instruments: volumes that fill through what openings they
    have, tau p' = sum g_i (p_i - p), with tau = tau_0 (p_0/p) (mu/mu_0) by the law of Hagen and Poiseuille, 0 at first.

    pitot_inlet_blocked  only the drain is open (F20): the airspeed falls to 0, with tau / drain
    pitot_blocked  inlet and drain are shut (F21): airspeed deaf to speed, rises in a climb, falls in a descent
    static_blocked  F22: altitude frozen, vertical speed 0, airspeed low above the height of blocking, high below it
    pitot_ice  the inlet closes to this share in `freezing_time` (F23): the airspeed sinks, slowly, then fast
    drain_blocked  airspeed high by half the drain's share; ice then traps the pressure
    alternate_static  cabin air instead of the port (F24): altitude and airspeed high, for a moment a climb
    static_leak, pitot_leak  cabin air as well (F24): pressures between those of outside and of the cabin
    lines_swapped  each line at the other's instrument (F25): no airspeed, altitude low by V^2 / (2 g)
    static_water, pitot_water  in the lowest place of the line: readings stick, then lag in climb and descent

    From the pressures at the instruments (thesis section 2.5.3, p. 24)

        h_p = T_0/lambda (1 - (p/p_0)^(R lambda/g))               pressure altitude, (2.1)
        V_c = a_0 sqrt(5 ((1 + (p_t - p)/p_0)^(2/7) - 1))         calibrated airspeed, the compressible form of (2.2)
        V_i = V_c + dV + dV_w                                     indicated airspeed, (3.30)-(3.31), p. 63
        M   = sqrt(5 ((1 + q_c(V_i)/p)^(2/7) - 1)),  V = a M      Mach number and true airspeed, measured temperature
        h   = h_p + dh + B + w                                    (3.34), p. 65
        h_i = h - h_p(setting)                                    altitude shown with the pilot's setting

    dV and dh are first-order Gauss-Markov: 2.6 m/s (5 kn), 400 s (3.32)-(3.33); 23 m (75 ft), 400 s (3.34). They
    start in their stationary distributions. dV_w is white, zero in the thesis (1 m/s in its source). B is Gauss-Markov
    over the distance flown and w white, both zero at first; AGARD CP-298, paper 15, p. 15-10 f. has 10 m and 100 km
    for B, and the variance 2.7^2 + (0.0035 h)^2 m2 for w. The transducer shows the difference of pressures as
    (1 + pitot coefficient) (p_t - p) + offset; these two and the error of the temperature probe are constant, each a
    given value plus one drawn at turn-on. The vertical speed is that of h_p, behind one lag; it has no part in dh.

    The probe is warmed by the flow, T (1 + r M^2/5), with a lag; the computer takes that out again with the Mach number
    that it has, so a blocked pitot tube spoils the temperature, too. r is 0 at first: a compensated probe.

    What the sigmas of dV, dV_w, the transducer and the probe are in true airspeed at the density and speed of the
    moment is published with it: 2.6 m/s at sea level are 4 m/s at 8.5 km. Given errors and faults are not in it.

    A port that is blocked before the first sample keeps the pressure of the first sample; a line starts with the
    pressure at which it settles, the vertical speed with 0. `valid` is false where the pressure altitude is not within
    -5 to 20 km, for which the standard atmosphere is here, from Mach 1 on, and where a reading is no number.
    """

    name = "air_data"
    parameter_sets = AIR
    example = Example(
        {"altitude": 1500.0, "velocity_n": (46.3, 0.0, 0.0)},
        steps={"altitude": 300.0, "wind_n": (-10.0, 0.0, 0.0)},
        text="The aircraft is 300 m higher at once and meets a head wind of 10 m/s: airspeeds rise by 19.4 kn less "
        "what the thinner air takes from the calibrated one, temperature falls by 2 degrees. The slow wandering is the "
        "Gauss-Markov error of the instruments.",
    )

    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid")
    latitude = Input("rad", display_unit="deg", description="true geodetic latitude, for the geoid")
    longitude = Input("rad", display_unit="deg", description="true longitude, for the geoid")
    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground, north, east, down")
    wind_n = Input(3, "m/s", display_unit="kn", description="velocity of the air over ground, north, east, down")
    roll = Input("rad", display_unit="deg", description="true roll angle, for the position error")
    pitch = Input("rad", display_unit="deg", description="true pitch angle, for the position error")
    heading = Input("rad", display_unit="deg", description="true heading, for the position error")
    temperature_deviation = Input(
        "K", start=0.0, min=-60.0, max=60.0, description="temperature of the day minus the standard one, at all heights"
    )
    sea_level_pressure = Input(
        "Pa",
        start=atmosphere.PRESSURE,
        min=80000.0,
        max=110000.0,
        display_unit="hPa",
        description="pressure of the day at mean sea level (standard: 1013.25 hPa)",
    )
    baro_setting = Input(
        "Pa",
        start=atmosphere.PRESSURE,
        min=80000.0,
        max=110000.0,
        display_unit="hPa",
        description="the pilot's setting of the altimeter, QNH (standard: 1013.25 hPa)",
    )
    pitot_blocked = Input(kind="boolean", fault=True, description="fault: pitot tube and its drain blocked (F21)")
    pitot_inlet_blocked = Input(kind="boolean", fault=True, description="fault: pitot tube blocked, drain open (F20)")
    drain_blocked = Input(kind="boolean", fault=True, description="fault: drain of the pitot tube blocked")
    pitot_ice = Input(
        "1",
        min=0.0,
        max=1.0,
        fault=True,
        description="fault: share of the pitot tube's inlet that ice closes in the end; 0: it melts (F23)",
    )
    static_blocked = Input(kind="boolean", fault=True, description="fault: static port blocked (F22)")
    alternate_static = Input(
        kind="boolean", fault=True, description="fault: the alternate static source, cabin air, is selected (F24)"
    )
    static_leak = Input(
        "1",
        min=0.0,
        fault=True,
        description="fault: leak of the static line into the cabin, by the clear opening (F24)",
    )
    pitot_leak = Input(
        "1", min=0.0, fault=True, description="fault: leak of the pitot line into the cabin, by the clear opening (F24)"
    )
    lines_swapped = Input(
        kind="boolean", fault=True, description="fault: pitot and static line at each other's instrument (F25)"
    )
    static_water = Input("m", min=0.0, fault=True, description="fault: height of the water in the static line")
    pitot_water = Input("m", min=0.0, fault=True, description="fault: height of the water in the pitot line")

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
    altitude_field_sigma = Parameter(
        "m",
        start=0.0,
        min=0.0,
        max=1e3,
        display_unit="ft",
        description="standard deviation of the altitude error that changes with distance, CP-298 p. 15-11: 10 m",
    )
    altitude_field_distance = Parameter(
        "m",
        start=100e3,
        min=100.0,
        display_unit="nmi",
        description="correlation distance of that error, CP-298 p. 15-11: 100 km",
    )
    altitude_noise_sigma = Parameter(
        "m",
        start=0.0,
        min=0.0,
        max=1e3,
        display_unit="ft",
        description="white noise of the altitude per sample, CP-298 p. 15-11: 2.7 m",
    )
    altitude_noise_slope = Parameter(
        "1",
        start=0.0,
        min=0.0,
        max=0.1,
        description="white noise of the altitude per sample by the height, CP-298 p. 15-11: 0.0035",
    )
    static_coefficient = Parameter(
        "1",
        start=0.0,
        min=-0.5,
        max=0.5,
        tunable=True,
        description="C_0: error of the static port by the impact pressure; 30 ft at 100 kn, which 14 CFR 23.1325(e) "
        "allowed (2011), is 0.067",
    )
    static_coefficient_attack = Parameter(
        "1",
        start=0.0,
        min=-5.0,
        max=5.0,
        tunable=True,
        description="C_alpha: its change by the angle of attack, per rad",
    )
    static_coefficient_sideslip = Parameter(
        "1",
        start=0.0,
        min=-20.0,
        max=20.0,
        tunable=True,
        description="C_beta: its change by the square of the sideslip, per rad2",
    )
    static_lag_time = Parameter(
        "s",
        start=0.0,
        min=0.0,
        max=10.0,
        tunable=True,
        description="time constant of the static line at sea level; 0.02 s with 5 m of 4.7 mm and 0.3 l",
    )
    total_lag_time = Parameter(
        "s",
        start=0.0,
        min=0.0,
        max=10.0,
        tunable=True,
        description="time constant of the pitot line at sea level",
    )
    drain_opening = Parameter(
        "1",
        start=0.02,
        min=0.0,
        max=1.0,
        description="flow through the drain hole of the pitot tube by that through its clear inlet (own choice)",
    )
    cabin_coefficient = Parameter(
        "1",
        start=-0.1,
        min=-0.5,
        max=0.5,
        description="cabin pressure less that outside, by the impact pressure, where the cabin is open (own choice: "
        "4 kn and 36 ft at 90 kn; the owner's manual of a small Cessna has no more than 6 mph and 50 ft)",
    )
    cabin_pressure = Parameter(
        "Pa",
        start=0.0,
        min=0.0,
        max=110000.0,
        display_unit="hPa",
        description="least pressure of a pressurised cabin; 0: it is open",
    )
    freezing_time = Parameter("s", start=300.0, min=1.0, description="time in which ice closes the pitot tube's inlet")
    melting_time = Parameter("s", start=60.0, min=1.0, description="time in which all of it melts")
    recovery_factor = Parameter(
        "1",
        start=0.0,
        min=0.0,
        max=1.0,
        description="r, part of the stagnation temperature that the probe shows and the computer takes out",
    )
    temperature_lag_time = Parameter("s", start=0.0, min=0.0, max=60.0, description="time constant of the probe")
    vertical_speed_time = Parameter(
        "s", start=2.0, min=0.1, max=30.0, description="time constant of the vertical speed (own choice)"
    )
    geoid_height = Parameter(
        "m", start=0.0, min=-120.0, max=120.0, description="height of mean sea level above the ellipsoid"
    )
    geoid_by_position = Parameter(
        kind="boolean",
        start=False,
        description="whether the table's geoid height at latitude and longitude is added to geoid_height",
    )
    sample_period = Parameter("s", start=0.1, min=1e-3, max=10.0, description="sampling period")

    sea = Grid(
        axes=(("latitude", "rad", geoid.LATITUDES), ("longitude", "rad", geoid.LONGITUDES)),
        surfaces=(("coefficient", "m", geoid.TABLE),),
    )

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
        mach=Output("1", description="Mach number"),
        indicated_altitude=Output("m", display_unit="ft", description="altitude with the pilot's setting"),
        vertical_speed=Output("m/s", display_unit="ft/min", description="vertical speed, positive up"),
        description="air data",
    )

    sampled = State(kind="boolean", description="there has been a sample, after which the lines lag behind the ports")
    ice = State("1", description="share of the pitot tube's inlet that ice closes")
    static_settled = State("Pa", display_unit="hPa", description="where the static line would have settled")
    total_settled = State("Pa", display_unit="hPa", description="where the pitot line would have settled")
    static_line = State("Pa", display_unit="hPa", description="in the static line")
    total_line = State("Pa", display_unit="hPa", description="in the pitot line")
    static_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="static, past water")
    total_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="total, past water")
    probe_outside = State("K", display_unit="degC", description="temperature that warmed the probe")
    probe = State("K", display_unit="degC", description="temperature of the probe")
    climbed = State("m", description="pressure altitude at the instruments")
    chamber = State("m", description="pressure altitude in the chamber of the vertical speed")
    pitot_gain_error = State("1", description="relative error of the difference of pressures")
    pressure_bias = State("Pa", description="absolute error of the difference of pressures")
    temperature_bias = State("K", description="error of the temperature probe")
    airspeed_error = State("m/s", description="Gauss-Markov error of the airspeed")
    altitude_error = State("m", description="Gauss-Markov error of the altitude")
    altitude_field = State("m", description="Gauss-Markov error of the altitude over the distance flown")
    airspeed_decay = State("1", description="exp(-T/tau) of the airspeed error")
    altitude_decay = State("1", description="exp(-T/tau) of the altitude error")
    airspeed_drive = State("m/s", description="sigma sqrt(1 - phi^2) of the airspeed error")
    altitude_drive = State("m", description="sigma sqrt(1 - phi^2) of the altitude error")

    @start
    def turn_on(self, noise):
        n = noise(6)
        self.pitot_gain_error = self.pitot_coefficient + self.pitot_coefficient_sigma * n[2]
        self.pressure_bias = self.pressure_offset + self.pressure_offset_sigma * n[3]
        self.temperature_bias = self.temperature_error + self.temperature_error_sigma * n[4]
        self.airspeed_error = gauss_markov.stationary(self.airspeed_error_sigma, n[0])
        self.altitude_error = gauss_markov.stationary(self.altitude_error_sigma, n[1])
        self.altitude_field = gauss_markov.stationary(self.altitude_field_sigma, n[5])
        self.airspeed_decay = gauss_markov.decay(self.sample_period, self.airspeed_error_time)
        self.altitude_decay = gauss_markov.decay(self.sample_period, self.altitude_error_time)
        self.airspeed_drive = gauss_markov.drive(self.airspeed_error_sigma, self.airspeed_decay)
        self.altitude_drive = gauss_markov.drive(self.altitude_error_sigma, self.altitude_decay)

    @every("sample_period")
    def sample(self, noise):
        n = noise(5)
        height = self.altitude - self.sea_level()
        self.wander(n, height)

        relative_n = self.velocity_n - self.wind_n
        speed = np.sqrt(np.sum(relative_n * relative_n))
        static, total, temperature = air_data.pressures(
            speed, atmosphere.geopotential(height), self.temperature_deviation, self.sea_level_pressure
        )
        self.fill_lines(static, total, temperature, self.position_error(relative_n))

        shown = np.where(self.lines_swapped, self.total_pressure, self.static_pressure)
        impact = np.where(self.lines_swapped, -1.0, 1.0) * (self.total_pressure - self.static_pressure)
        difference = air_data.sensed(impact, self.pitot_gain_error, self.pressure_bias)
        calibrated = air_data.calibrated_airspeed(difference)
        indicated = np.maximum(calibrated + self.airspeed_error + self.airspeed_noise_sigma * n[2], 0.0)
        mach = air_data.true_mach(indicated, shown)
        measured_temperature = self.take_temperature(temperature, speed, mach) + self.temperature_bias
        true_airspeed = atmosphere.speed_of_sound(measured_temperature) * mach
        sigma = air_data.true_airspeed_sigma(
            indicated,
            shown,
            measured_temperature,
            np.hypot(self.airspeed_error_sigma, self.airspeed_noise_sigma),
            self.pitot_coefficient_sigma,
            self.pressure_offset_sigma,
            self.temperature_error_sigma,
            self.recovery_factor,
        )
        pressure_altitude = atmosphere.pressure_altitude(shown)
        noise_sigma = altimeter.noise_sigma(self.altitude_noise_sigma, self.altitude_noise_slope, height)
        altitude = pressure_altitude + self.altitude_error + self.altitude_field + noise_sigma * n[4]
        indicated_altitude = altimeter.indicated(altitude, self.baro_setting)
        self.follow(pressure_altitude)
        self.sampled = True
        self.air.publish(
            valid=atmosphere.is_known(pressure_altitude)
            & air_data.is_known(mach)
            & np.isfinite(true_airspeed + indicated_altitude),
            calibrated_airspeed=indicated,
            true_airspeed=true_airspeed,
            true_airspeed_sigma=sigma,
            pressure_altitude=altitude,
            temperature=measured_temperature,
            mach=mach,
            indicated_altitude=indicated_altitude,
            vertical_speed=(self.climbed - self.chamber) / self.vertical_speed_time,
        )

    def sea_level(self):
        """Height of mean sea level above the ellipsoid, m."""
        here = geoid.height(self.latitude, self.longitude, self.coefficients)
        return self.geoid_height + np.where(self.geoid_by_position, here, 0.0)

    def coefficients(self, latitude, longitude):
        """Of the geoid, at the ends of a cell of its table."""
        return self.sea.around(latitude=latitude, longitude=longitude).corners[..., 0]

    def wander(self, n, height):
        """The errors of airspeed and altitude a period later."""
        self.airspeed_error = gauss_markov.advance(self.airspeed_error, self.airspeed_decay, self.airspeed_drive, n[0])
        self.altitude_error = gauss_markov.advance(self.altitude_error, self.altitude_decay, self.altitude_drive, n[1])
        over_ground = np.hypot(self.velocity_n[0], self.velocity_n[1])
        phi = altimeter.distance_decay(over_ground, self.sample_period, self.altitude_field_distance)
        drive = gauss_markov.drive(self.altitude_field_sigma, phi)
        self.altitude_field = gauss_markov.advance(self.altitude_field, phi, drive, n[3])

    def position_error(self, relative_n):
        """C_p."""
        attack, sideslip = air_data.flow_angles(relative_n @ attitude.dcm(self.roll, self.pitch, self.heading))
        return air_data.position_coefficient(
            self.static_coefficient,
            self.static_coefficient_attack,
            self.static_coefficient_sideslip,
            attack,
            sideslip,
        )

    def fill_lines(self, static, total, temperature, coefficient):
        """The pressures in both lines and at the instruments a period later, from those of the air (Pa, K)."""
        impact = total - static
        port = static + coefficient * impact
        cabin = np.maximum(static + self.cabin_coefficient * impact, self.cabin_pressure)
        self.ice = pneumatics.grown(self.ice, self.pitot_ice, self.sample_period, self.freezing_time, self.melting_time)
        inlet = (1.0 - self.ice) * ~(self.pitot_blocked | self.pitot_inlet_blocked)
        drain = self.drain_opening * ~(self.pitot_blocked | self.drain_blocked)
        normal = ~(self.static_blocked | self.alternate_static) * 1.0
        # the tube is calibrated with its drain: its inlet has as much more as the drain takes
        total_settled, total_opening = pneumatics.settled(
            total, (self.drain_opening * impact, -impact, cabin - total), (inlet, drain, self.pitot_leak)
        )
        static_settled, static_opening = pneumatics.settled(
            port, (0.0, cabin - port), (normal, self.static_leak + self.alternate_static)
        )
        ratio = pneumatics.lag_time(1.0, static, temperature) / self.sample_period
        total_line = pneumatics.filled(
            self.total_line, self.total_settled, total_settled, total_opening, self.total_lag_time * ratio
        )
        static_line = pneumatics.filled(
            self.static_line, self.static_settled, static_settled, static_opening, self.static_lag_time * ratio
        )
        self.total_line = np.where(self.sampled, total_line, total_settled)
        self.static_line = np.where(self.sampled, static_line, static_settled)
        self.total_settled, self.static_settled = total_settled, static_settled
        total_shown = np.where(self.sampled, self.total_pressure, self.total_line)
        static_shown = np.where(self.sampled, self.static_pressure, self.static_line)
        self.total_pressure = pneumatics.past_water(total_shown, self.total_line, self.pitot_water)
        self.static_pressure = pneumatics.past_water(static_shown, self.static_line, self.static_water)

    def take_temperature(self, temperature, speed, measured_mach):
        """The outside air temperature that the computer makes of the probe's, without the probe's error."""
        mach = speed / atmosphere.speed_of_sound(temperature)
        outside = temperature * air_data.stagnation_ratio(mach, self.recovery_factor)
        ratio = self.temperature_lag_time / self.sample_period
        probe = pneumatics.behind(self.probe, self.probe_outside, outside, ratio)
        self.probe, self.probe_outside = np.where(self.sampled, probe, outside), outside
        return self.probe / air_data.stagnation_ratio(measured_mach, self.recovery_factor)

    def follow(self, pressure_altitude):
        """The chamber of the vertical speed a period later."""
        ratio = self.vertical_speed_time / self.sample_period
        chamber = pneumatics.behind(self.chamber, self.climbed, pressure_altitude, ratio)
        self.chamber = np.where(self.sampled, chamber, pressure_altitude)
        self.climbed = pressure_altitude
