"""What is done to a receiver of GPS from outside: jammers, regions without signals, false signals."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from models.earth import earth
from models.processes.known import known
from models.radio import dme
from models.satellite import signal_power
from navfmu.export import Input, Parameter, State
from navfmu.repetition import repeat

JAMMERS = 4


class Jamming:
    """Faults from outside (F34, F39), for receivers of positions and of signals to inherit, so that one file of faults
    serves both. They have `latitude`, `longitude`, `altitude` and `velocity_n`, the truth."""

    jammed = Input(kind="boolean", fault=True, description="fault: interference, no signal is left")
    jammer_power = Input(JAMMERS, "W", fault=True, description="fault: each jammer radiates this, EIRP")
    region_radius = Input("m", fault=True, description="fault: no signal is left within this of the region's middle")
    spoofing_n = Input(3, "m", fault=True, description="fault: all signals are those of a place that is off, n")
    spoofing_rate_n = Input(3, "m/s", fault=True, description="fault: rate at which that place is carried off, n")

    jammer_latitude = Parameter(
        JAMMERS, "rad", start=np.radians(37.7), display_unit="deg", description="of each jammer"
    )
    jammer_longitude = Parameter(
        JAMMERS, "rad", start=np.radians(-122.0), display_unit="deg", description="of each jammer"
    )
    jammer_altitude = Parameter(JAMMERS, "m", start=30.0, description="of each jammer, above the ellipsoid")
    jammer_spread = Parameter("1", start=1.0, min=0.5, max=5.0, description="Q: 1 narrow band, 2 spread as the code")
    region_latitude = Parameter("rad", start=np.radians(37.7), display_unit="deg", description="middle of a region")
    region_longitude = Parameter("rad", start=np.radians(-122.0), display_unit="deg", description="middle of it")

    carried_n = State(3, "m", description="by spoofing_rate_n")

    def _interference(self, c_ne, gain: Callable[[np.ndarray], np.ndarray]):
        """Power of all jammers behind the antenna, W, whose ``gain`` (dB) is that of directions in n, (jammers, 3)."""
        radiated = known(self.jammer_power, 0.0)

        def heard(_):
            position_e = earth.to_ecef(self.latitude, self.longitude, self.altitude)
            line = earth.to_ecef(self.jammer_latitude, self.jammer_longitude, self.jammer_altitude).T - position_e
            distance = np.maximum(np.sqrt(np.sum(line * line, axis=1)), 1.0)
            power = signal_power.of_jammer(radiated, distance)
            power = power + gain((line / distance[:, None]) @ c_ne.T)
            reach = dme.horizon(self.altitude, self.jammer_altitude, 0.0)
            return np.sum(np.where(distance < reach, signal_power.ratio(power), 0.0))

        return repeat(heard, 0.0, np.where(np.any(radiated > 0.0), 1, 0), 1)

    def _within_region(self):
        middle = earth.to_ecef(self.region_latitude, self.region_longitude, known(self.altitude, 0.0))
        away = earth.to_ecef(self.latitude, self.longitude, self.altitude) - middle
        return np.sum(away * away) < known(self.region_radius, 0.0) ** 2

    def _carry_off(self, period):
        """Carry the place whose signals come on for a ``period``, s."""
        rate = known(self.spoofing_rate_n, 0.0)
        self.carried_n = np.where(rate != 0.0, self.carried_n + period * rate, 0.0)

    def _spoofed(self):
        """How far that place is off, n, m, and how fast it goes, m/s."""
        return self.carried_n + known(self.spoofing_n, 0.0), known(self.spoofing_rate_n, 0.0)
