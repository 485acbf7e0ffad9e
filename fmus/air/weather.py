"""The weather of the day as an FMU: what temperature and pressure have over the standard atmosphere."""

from __future__ import annotations

import numpy as np

from models.processes import gauss_markov
from models.processes.known import known
from navfmu.export import Component, Example, Input, Output, Parameter, State, every, start


class Weather(Component):
    """Temperature and sea-level pressure of the day along the flight, for all that measures the air.

    Each is a mean, a gradient over the ground and a random part,

        dT  = mean + gradient (s_N, s_E) + x_T,    p_0 = mean + gradient (s_N, s_E) + x_p

    with (s_N, s_E) the way from where the flight began. x are first-order Gauss-Markov processes over the distance
    flown over the ground, x <- phi x + sigma sqrt(1 - phi^2) n with phi = exp(-|V| T / distance): AGARD CP-298, paper
    15, p. 15-11 has 10 m and 100 km for the datum of an altimeter, and 10 m at sea level are 120 Pa. They start in
    their stationary distributions. Who stands still, or leaves velocity_n away, keeps the weather that was drawn.

    Both are of the whole column of air: `air_data` and others take them as inputs of the same names. What
    `altitude_field_sigma` of `air_data` does to one altimeter, this does to all alike; one of them is enough.
    """

    name = "weather"
    example = Example(
        {"velocity_n": (46.3, 0.0, 0.0), "pressure_gradient": (-1e-3, 0.0)},
        steps={},
        duration=3600.0,
        text="An hour of flight to the north, 167 km, towards a low: 1 hPa less every 100 km, about which the pressure "
        "wanders by 1.2 hPa, 10 m of pressure altitude, and the temperature by 2 K. Another `seed` gives another day.",
    )

    velocity_n = Input(3, "m/s", display_unit="kn", description="true velocity over ground, north, east, down")

    temperature_mean = Parameter(
        "K", start=0.0, min=-60.0, max=60.0, description="temperature of the day minus the standard one, mean"
    )
    temperature_gradient = Parameter(
        2, "K/m", start=0.0, min=-1e-3, max=1e-3, description="its change over the ground to the north and to the east"
    )
    temperature_sigma = Parameter(
        "K", start=2.0, min=0.0, max=20.0, description="standard deviation of its random part (own choice)"
    )
    temperature_distance = Parameter(
        "m",
        start=100e3,
        min=100.0,
        display_unit="nmi",
        description="correlation distance of its random part, taken as that of the pressure",
    )
    pressure_mean = Parameter(
        "Pa",
        start=101325.0,
        min=85000.0,
        max=108000.0,
        display_unit="hPa",
        description="pressure of the day at mean sea level, mean (standard: 1013.25 hPa)",
    )
    pressure_gradient = Parameter(
        2,
        "Pa/m",
        start=0.0,
        min=-0.1,
        max=0.1,
        description="its change over the ground to the north and to the east; 1e-3 is 1 hPa in 100 km",
    )
    pressure_sigma = Parameter(
        "Pa",
        start=120.0,
        min=0.0,
        max=3000.0,
        display_unit="hPa",
        description="standard deviation of its random part, CP-298 p. 15-11: 10 m",
    )
    pressure_distance = Parameter(
        "m",
        start=100e3,
        min=100.0,
        display_unit="nmi",
        description="correlation distance of its random part, CP-298 p. 15-11: 100 km",
    )
    sample_period = Parameter("s", start=1.0, min=1e-3, max=100.0, description="period at which the weather changes")

    temperature_deviation = Output("K", description="temperature of the day minus the standard one, at all heights")
    sea_level_pressure = Output(
        "Pa", start=101325.0, display_unit="hPa", description="pressure of the day at mean sea level"
    )

    way = State(2, "m", description="from where the flight began, north and east")
    temperature_variation = State("K", description="random part of the temperature")
    pressure_variation = State("Pa", description="random part of the pressure")

    @start
    def draw(self, noise):
        n = noise(2)
        self.temperature_variation = gauss_markov.stationary(self.temperature_sigma, n[0])
        self.pressure_variation = gauss_markov.stationary(self.pressure_sigma, n[1])
        self._publish()

    @every("sample_period")
    def advance(self, noise):
        n = noise(2)
        step = known(self.velocity_n[:2] * self.period, 0.0)
        flown = np.hypot(step[0], step[1])
        self.way = self.way + step
        decay = gauss_markov.decay(flown, self.temperature_distance)
        drive = gauss_markov.drive(self.temperature_sigma, decay)
        self.temperature_variation = gauss_markov.advance(self.temperature_variation, decay, drive, n[0])
        decay = gauss_markov.decay(flown, self.pressure_distance)
        drive = gauss_markov.drive(self.pressure_sigma, decay)
        self.pressure_variation = gauss_markov.advance(self.pressure_variation, decay, drive, n[1])
        self._publish()

    def _publish(self):
        self.temperature_deviation = (
            self.temperature_mean + self.temperature_gradient @ self.way + self.temperature_variation
        )
        self.sea_level_pressure = self.pressure_mean + self.pressure_gradient @ self.way + self.pressure_variation
