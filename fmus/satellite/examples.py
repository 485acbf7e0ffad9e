"""The run shown in the documentation of the solver: eight satellites that stand in the sky, one of which goes wrong."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fmus.examples import gps_inputs
from fmus.satellite.signals import PLACES
from models.earth import earth
from models.evaluation import evaluation
from models.satellite import klobuchar, saastamoinen, sight

FAULT = 40.0
STEP = 100.0
"""m."""
WRONG = 3
"""The satellite that goes wrong, counted from 0."""
SKY = np.radians([(15, 70), (75, 30), (130, 55), (180, 20), (215, 40), (265, 15), (300, 65), (340, 25)])
"""Azimuth and elevation of the satellites where the flight begins."""
ALPHA, BETA = (3.82e-8, 1.49e-8, -1.79e-7, 0.0), (1.43e5, 0.0, -3.28e5, 1.13e5)
_BEGIN = gps_inputs(np.zeros(1))
STATION = tuple(float(_BEGIN[name][0]) for name in ("latitude", "longitude", "altitude"))
"""Where the flight begins: latitude, longitude, rad, and altitude, m; there a reference station stands."""
CLOCK = 3.0e4
"""Of the receiver, m."""


def _satellites(latitude: float, longitude: float, altitude: float) -> np.ndarray:
    azimuth, elevation = SKY.T
    across = np.cos(elevation)
    unit_n = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), -np.sin(elevation)], axis=1)
    radius, place = 26.56e6, earth.to_ecef(latitude, longitude, altitude)
    unit_e = unit_n @ earth.north_east_down(latitude, longitude)
    up = unit_e @ place
    distance = np.sqrt(up * up + radius * radius - place @ place) - up
    return place + distance[:, None] * unit_e


def _seen(time: np.ndarray, flight: Mapping[str, np.ndarray], seed: int) -> dict[str, np.ndarray]:
    """Members of the bundle of a receiver on a flight below satellites that stand still above STATION."""
    rng = np.random.default_rng(seed)
    satellite_e = np.zeros((PLACES, 3))
    satellite_e[: len(SKY)] = _satellites(*STATION)
    pseudorange, rate = np.zeros((2, len(time), PLACES))
    for k, now in enumerate(time):
        place = flight["latitude"][k], flight["longitude"][k], flight["altitude"][k]
        position_e = earth.to_ecef(*place)
        distance, unit_e = sight.ranges(position_e, satellite_e[: len(SKY)])
        c_ne = earth.north_east_down(*place[:2])
        sine, azimuth = sight.sky(unit_e @ c_ne.T)
        velocity_e = flight["velocity_n"][k] @ c_ne
        delay = klobuchar.delay(*place[:2], np.arcsin(sine), azimuth, now, ALPHA, BETA)
        delay = delay + saastamoinen.slant(sum(saastamoinen.zenith(place[0], place[2])), sine)
        pseudorange[k, : len(SKY)] = distance + delay + CLOCK + 0.5 * rng.standard_normal(len(SKY))
        rate[k, : len(SKY)] = -unit_e @ velocity_e + 0.02 * rng.standard_normal(len(SKY))
    return {
        "seconds": time,
        "tracked": np.tile(np.arange(PLACES) < len(SKY), (len(time), 1)),
        "number": np.tile(np.where(np.arange(PLACES) < len(SKY), np.arange(1, PLACES + 1), 0), (len(time), 1)),
        "pseudorange": pseudorange,
        "range_rate": rate,
        "signal_to_noise": np.full((len(time), PLACES), 45.0),
        "accuracy": np.full((len(time), PLACES), 2.4),
        "satellite_e": np.tile(satellite_e, (len(time), 1, 1)),
    }


def signals_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west below satellites that stand still; one is STEP too far from FAULT on."""
    seen = _seen(time, gps_inputs(time), 8)
    seen["pseudorange"][time >= FAULT, WRONG] += STEP
    return {f"signals.{name}": values for name, values in seen.items()}


def differential_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """The same flight and satellites, and a receiver at STATION, whose link is lost from FAULT on."""
    flight = gps_inputs(time)
    still = {name: np.repeat(values[:1], len(time), axis=0) for name, values in flight.items()}
    still["velocity_n"] = 0.0 * flight["velocity_n"]
    both = (("signals", _seen(time, flight, 8)), ("reference", _seen(time, still, 9)))
    seen = {f"{bundle}.{name}": values for bundle, members in both for name, values in members.items()}
    return {**seen, "link_lost": time >= FAULT}


def attitude_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """The same flight and satellites, of which three are left from FAULT on."""
    few = (time >= FAULT)[:, None] & (np.arange(PLACES) >= 3)
    flight, signals = gps_inputs(time), signals_inputs(time)
    truth = {name: flight[name] for name in ("latitude", "longitude", "altitude", "heading")}
    return {**truth, **signals, "signals.tracked": signals["signals.tracked"] & ~few}


def solver_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Errors of the position, and which satellites are used."""
    truth = gps_inputs(outputs["fix.time_of_validity"])
    seen = outputs["fix.valid"] > 0.0
    north, east = evaluation.position_error(
        truth["latitude"], truth["longitude"], truth["altitude"], outputs["fix.latitude"], outputs["fix.longitude"]
    )
    errors = {"north": north, "east": east, "up": outputs["fix.altitude"] - truth["altitude"]}
    return {
        "error of position while valid (m)": {name: np.where(seen, error, np.nan) for name, error in errors.items()},
        "protection level (m)": {
            name: np.where(seen, outputs[f"{name}_protection"], np.nan) for name in ("horizontal", "vertical")
        },
        "above its number while used": {
            f"satellite {i + 1}": i + 1 + 0.8 * outputs["used"][:, i] for i in (WRONG - 1, WRONG, WRONG + 1)
        },
    }


def jammed_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west; a jammer is on the air from FAULT on for 20 s."""
    flight = gps_inputs(time)
    flight.pop("jammed")
    power = np.zeros((len(time), 4))
    power[(time >= FAULT) & (time < FAULT + 20.0), 0] = 100.0
    return {**flight, "jammer_power": power}


def receiver_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """C/N0 of the satellites that are tracked."""
    tracked, number = outputs["signals.tracked"] > 0.0, outputs["signals.number"]
    seen = [i for i in range(tracked.shape[1]) if tracked[:, i].any()]
    ratio = np.where(tracked, outputs["signals.signal_to_noise"], np.nan)
    return {"C/N0 (dB-Hz)": {f"PRN {int(number[:, i].max())}": ratio[:, i] for i in seen}}
