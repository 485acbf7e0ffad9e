"""Recorded air data as an FMU."""

from __future__ import annotations

import numpy as np

from fmus import replay
from fmus.air.air_data import AirData
from models.air import air_data, altimeter, atmosphere, pneumatics
from navfmu.export import Component, Example, State, Table, every

_OTHERS = {"static_pressure": "Pa", "impact_pressure": "Pa"}
_COLUMNS = replay.columns(AirData.air, **_OTHERS, **replay.known(*AirData.air.members, *_OTHERS))
_EXAMPLE = replay.made(
    _COLUMNS,
    0.1,
    calibrated_airspeed=46.3,
    calibrated_airspeed_known=1.0,
    pressure_altitude=lambda t: 1500.0 + 2.5 * t,
    pressure_altitude_known=1.0,
)


class AirDataReplay(replay.face(AirData), Component):
    """Recorded air data, in the place of air_data: what was not recorded is worked out from what was.

    The table resources/samples.npy holds samples: the time at which one comes, the time that its values hold for, its
    number, whether it is valid, the values, and which of these were recorded. Others follow from them by the equations
    of air_data, with p the static pressure, q_c the difference of total and static pressure,

        p    of pressure altitude, or h_p of p          (2.1)
        V_c  of q_c, or of true airspeed                (2.2), compressible
        T    standard temperature of h_p, and the deviation of the day
        M    of V_c and p, or of true airspeed and T
        V    a M

    and the altitude with the pilot's setting, the vertical speed behind its lag, and the sigma of true airspeed. At
    each tick the last sample that has come is published, if that was not done before. `sequence` is its number: where
    two come in one tick it jumps, and who takes the bundle counts what was lost. Behind the last sample nothing comes
    any more.

    The inputs are those of air_data, so that this FMU takes its place in a system; those of the truth do nothing. A
    blocked port keeps the pressure of the last sample before, or of the first one, and what hangs on it follows from
    the pressures as it does in air_data, whatever was recorded. Its other faults need what lines were like, which no
    recording tells. `delay` makes all samples late, and leaves the time that they hold for.

    `navfmu replay air_data FILE --out NAME.fmu` writes this FMU with a recording of yours; as built it holds a minute
    of climb.
    """

    name = "air_data_replay"
    example = Example(
        steps={"pitot_blocked": True},
        text="The built-in samples: a climb at 90 kn and 490 ft/min. When the pitot tube and its drain are blocked the "
        "airspeed rises in the climb, though the aircraft is as fast as before.",
    )

    temperature_deviation = AirData.temperature_deviation
    baro_setting = AirData.baro_setting
    pitot_blocked = AirData.pitot_blocked
    static_blocked = AirData.static_blocked

    vertical_speed_time = AirData.vertical_speed_time
    airspeed_error_sigma = AirData.airspeed_error_sigma
    airspeed_noise_sigma = AirData.airspeed_noise_sigma
    pitot_coefficient_sigma = AirData.pitot_coefficient_sigma
    pressure_offset_sigma = AirData.pressure_offset_sigma
    temperature_error_sigma = AirData.temperature_error_sigma
    delay = replay.delay()
    tick_period = replay.tick_period()

    sampled = State(kind="boolean", description="there has been a sample, whose pressures a blocked port keeps")
    static_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="behind the static port")
    total_pressure = State("Pa", start=atmosphere.PRESSURE, display_unit="hPa", description="behind the pitot tube")
    climbed = State("m", description="pressure altitude at the instruments")
    chamber = State("m", description="pressure altitude in the chamber of the vertical speed")

    samples = Table(columns=_COLUMNS, rows=_EXAMPLE)

    @every("tick_period")
    def play(self):
        sample = replay.latest(self, "samples", self.delay)
        told = replay.announcement(sample, self.air)
        new, interval = told["when"], sample["time_of_validity"] - self.air.time_of_validity

        static, total, altitude, temperature = self.outside(sample)
        frozen = self.sampled & self.static_blocked
        static, altitude = np.where(frozen, self.static_pressure, static), np.where(frozen, self.climbed, altitude)
        total = np.where(self.sampled & self.pitot_blocked, self.total_pressure, total)
        blocked = self.static_blocked | self.pitot_blocked

        def recorded(name, otherwise, spoilt):
            return np.where(spoilt, otherwise, replay.recorded(sample, name, otherwise))

        calibrated = recorded("calibrated_airspeed", air_data.calibrated_airspeed(total - static), blocked)
        sound = atmosphere.speed_of_sound(temperature)
        mach = air_data.true_mach(calibrated, static)
        mach = recorded("mach", recorded("true_airspeed", sound * mach, blocked) / sound, blocked)
        true_airspeed = recorded("true_airspeed", sound * mach, blocked)
        shown = altimeter.indicated(altitude, self.baro_setting)
        shown = recorded("indicated_altitude", shown, self.static_blocked)
        ratio = self.vertical_speed_time / np.maximum(interval, 1e-6)
        chamber = np.where(self.sampled, pneumatics.behind(self.chamber, self.climbed, altitude, ratio), altitude)
        sigma = air_data.true_airspeed_sigma(
            calibrated,
            static,
            temperature,
            np.hypot(self.airspeed_error_sigma, self.airspeed_noise_sigma),
            self.pitot_coefficient_sigma,
            self.pressure_offset_sigma,
            self.temperature_error_sigma,
        )
        told["valid"] = (
            told["valid"]
            & atmosphere.is_known(altitude)
            & air_data.is_known(mach)
            & np.isfinite(true_airspeed + temperature + shown)
        )
        self.air.publish(
            **told,
            true_airspeed=true_airspeed,
            true_airspeed_sigma=recorded("true_airspeed_sigma", sigma, blocked),
            calibrated_airspeed=calibrated,
            pressure_altitude=altitude,
            temperature=temperature,
            mach=mach,
            indicated_altitude=shown,
            vertical_speed=recorded(
                "vertical_speed", (altitude - chamber) / self.vertical_speed_time, self.static_blocked
            ),
        )
        self.static_pressure = np.where(new, static, self.static_pressure)
        self.total_pressure = np.where(new, total, self.total_pressure)
        self.climbed = np.where(new, altitude, self.climbed)
        self.chamber = np.where(new, chamber, self.chamber)
        self.sampled = self.sampled | new

    def outside(self, sample):
        """Static and total pressure (Pa), pressure altitude (m) and temperature (K), of what was recorded."""
        static = replay.recorded(sample, "static_pressure", atmosphere.pressure(sample["pressure_altitude"]))
        altitude = replay.recorded(sample, "pressure_altitude", atmosphere.pressure_altitude(static))
        standard = atmosphere.temperature(altitude, self.temperature_deviation)
        temperature = replay.recorded(sample, "temperature", standard)
        by_speed = static * air_data.impact_ratio(sample["true_airspeed"] / atmosphere.speed_of_sound(temperature))
        impact = replay.recorded(sample, "impact_pressure", by_speed)
        by_calibrated = air_data.impact_pressure(sample["calibrated_airspeed"])
        impact = np.where(sample["calibrated_airspeed_known"] > 0.0, by_calibrated, impact)
        return static, static + impact, altitude, temperature
