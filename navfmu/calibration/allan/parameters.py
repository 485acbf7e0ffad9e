"""What was identified, as the parameters of an FMU that models an inertial unit."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from navfmu.calibration.allan.identification import Identification
from navfmu.calibration.allan.sensor import HOUR, SENSORS, Sensor
from navfmu.calibration.allan.terms import FLICKER, GAUSS_MARKOV, QUANTISATION, RAMP, RANDOM_WALK, WHITE
from navfmu.errors import NavfmuError
from navfmu.fmi.fmu import describe
from navfmu.fmi.values import expand
from navfmu.ssp.writer import values_document

FLOOR = float(np.sqrt(2.0 * np.log(2.0) / np.pi))
"""Allan deviation of flicker noise over B."""
FLAT = 18.0
"""Averaging time from which a sum of processes a decade apart is as flat as flicker noise, in the shortest of them."""
FINE = 50.0
"""Times that a process is advanced in its correlation time, at least."""
SHORTEST = 1.0
"""Shortest correlation time of a drift, s."""


def parameters(found: Mapping[Sensor, Identification], period: float) -> dict[str, Any]:
    """Parameters by name, SI. Errors that a unit at rest does not show, those of turn-on, are not among them."""
    values: dict[str, Any] = {"sample_period": period}
    drift_periods, flicker_times = [10.0], []
    for sensor, one in found.items():
        white, flicker = one.of(WHITE), one.of(FLICKER)
        values |= {
            f"{sensor.prefix}_noise_sigma": white / np.sqrt(period),
            f"{sensor.prefix}_flicker": flicker,
            f"{sensor.prefix}_walk_sigma": one.of(RANDOM_WALK) * np.sqrt(HOUR),
            f"{sensor.prefix}_drift_sigma": one.of(GAUSS_MARKOV) * np.sqrt(min(1.0, _tau(one) / SHORTEST)),
            sensor.pulse: float(np.mean(one.of(QUANTISATION))) * np.sqrt(12.0),
        }
        if one.correlation_time:
            values[f"{sensor.prefix}_drift_time"] = max(SHORTEST, _tau(one))
            drift_periods.append(max(period, _tau(one) / FINE))
        there = flicker > 0.0
        if there.any():
            begins = float(np.min((white[there] / (FLOOR * flicker[there])) ** 2))
            flicker_times.append(float(np.clip(begins / FLAT, max(0.1, period), 3600.0)))
    values["drift_period"] = min(drift_periods)
    if flicker_times:
        values["flicker_time"] = min(flicker_times)
        values["wander_period"] = min(60.0, max(period, 0.1 * min(flicker_times)))
    return values


def _tau(one: Identification) -> float:
    return one.correlation_time[0] if one.correlation_time else np.inf


def remarks(found: Mapping[Sensor, Identification]) -> list[str]:
    """What the parameters do not have of what was identified."""
    said = []
    for sensor, one in found.items():
        if RAMP in one.terms:
            said.append(f"{sensor.quantity}: the ramp is not among the parameters; it is of a temperature, or of age")
        if QUANTISATION in one.terms:
            said.append(f"{sensor.quantity}: whole pulses are those of the increments; readings have none")
        if _tau(one) < SHORTEST:
            said.append(
                f"{sensor.quantity}: the correlation time is taken for {SHORTEST:g} s, the shortest that there is; "
                "averages over much more are the same"
            )
    return said


def document(values: Mapping[str, Any], fmu: str | Path, text: str) -> bytes:
    """The parameter set (.ssv) of an FMU."""
    description = describe(fmu)
    wanted = [f"{sensor.prefix}_{kind}_sigma" for sensor in SENSORS for kind in ("noise", "drift", "walk")]
    if any(f"{name}[1]" not in description.by_name for name in wanted):
        raise NavfmuError(
            f"{fmu}: is no model of an inertial unit; expected an FMU with the parameters {', '.join(wanted)}"
        )
    plain = {name: np.asarray(value).tolist() for name, value in values.items()}
    return values_document(description, expand(description, plain, str(fmu)), text)
