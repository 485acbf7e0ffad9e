"""The runs shown in the documentation of the estimators and receivers: what their inputs do, and what to compare.

Each function of a time (s, an array) makes the inputs of a short flight from closed formulas; noise is seeded.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fmus.radio import stations
from models.attitude import attitude
from models.earth import earth
from models.evaluation import evaluation
from models.magnetic import magnetic_field
from models.navigation import inertial, navigator
from models.radio import dme
from navfmu.constants import NAUTICAL_MILE, STANDARD_GRAVITY

SPEED = 46.3
"""90 kn in m/s."""
HERE = (0.659, -2.117, 1500.0)
"""East of Livermore, where the lines to the stations cross well: latitude, longitude (rad) and altitude (m)."""
DEG = np.pi / 180.0
GPS_LOST = 300.0
JAMMED = 40.0


# ---- attitude and heading ----


def _turning_flight(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the north-east with a full circle at 3 deg/s between 60 and 184 s; rolling takes 4 s."""
    turn = 3.0 * DEG * np.clip(np.minimum((time - 60.0) / 4.0, (184.0 - time) / 4.0), 0.0, 1.0)
    step = time[1] - time[0]
    heading = 45.0 * DEG + np.concatenate([[0.0], np.cumsum(0.5 * step * (turn[1:] + turn[:-1]))])
    roll = np.arctan(SPEED * turn / STANDARD_GRAVITY)
    return {"turn": turn, "heading": heading, "roll": roll, "roll_rate": np.gradient(roll, step)}


def ahrs_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Readings of an automotive IMU with biases of 0.15 and -0.1 deg/s, of a magnetometer, airspeed and position.

    There is no GPS attitude.
    """
    flight = _turning_flight(time)
    rng = np.random.default_rng(1)
    sine, cosine = np.sin(flight["roll"]), np.cos(flight["roll"])
    zero = np.zeros_like(time)
    rate = np.stack([flight["roll_rate"], flight["turn"] * sine, flight["turn"] * cosine], axis=1)
    force = np.stack([zero, zero, -STANDARD_GRAVITY / cosine], axis=1)
    field_n = magnetic_field.field(HERE[0], HERE[1], HERE[2], 2026.0)
    matrices = np.moveaxis(attitude.dcm(flight["roll"], zero, flight["heading"]), -1, 0)
    bias = np.array([0.15, 0.0, -0.1]) * DEG
    return {
        "imu.rate": rate + bias + 0.05 * DEG * rng.standard_normal(rate.shape),
        "imu.specific_force": force + 0.01 * rng.standard_normal(force.shape),
        "field.field_b": field_n @ matrices + 2e-7 * rng.standard_normal(rate.shape),
        "air.true_airspeed": np.full_like(time, SPEED),
        **{
            f"position.{n}": np.full_like(time, v)
            for n, v in zip(("latitude", "longitude", "altitude"), HERE, strict=True)
        },
        "gps.valid": zero,
    }


def ahrs_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Estimated and true angles."""
    flight = _turning_flight(outputs["time"])
    known = outputs["attitude.valid"] > 0.0

    def shown(angle):
        return np.where(known, angle, np.nan) / DEG

    def error(name):
        return shown(attitude.wrap(outputs[f"attitude.{name}"] - flight.get(name, 0.0)))

    return {
        "roll (deg)": {"estimate": shown(outputs["attitude.roll"]), "~truth": flight["roll"] / DEG},
        "heading (deg)": {
            "estimate": shown(outputs["attitude.heading"]),
            "~truth": attitude.wrap(flight["heading"]) / DEG,
        },
        "error of the angles (deg)": {name: error(name) for name in ("roll", "pitch", "heading")},
    }


# ---- receivers ----


def _flight(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west at 90 kn over ground."""
    east_west = earth.radii(HERE[0])[1]
    longitude = HERE[1] - SPEED * time / ((east_west + HERE[2]) * np.cos(HERE[0]))
    return {
        "latitude": np.full_like(time, HERE[0]),
        "longitude": longitude,
        "altitude": np.full_like(time, HERE[2]),
        "velocity_n": np.stack([0.0 * time, -SPEED + 0.0 * time, 0.0 * time], axis=1),
    }


def gps_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west; jammed from 40 s on."""
    return {**_flight(time), "heading": np.full_like(time, -np.pi / 2.0), "jammed": time >= JAMMED}


def gps_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Errors of the fixes, at the moment for which they hold."""
    truth = _flight(outputs["fix.time_of_validity"])
    seen = outputs["fix.valid"] > 0.0
    north, east = evaluation.position_error(
        truth["latitude"],
        truth["longitude"],
        truth["altitude"],
        outputs["fix.latitude"],
        outputs["fix.longitude"],
    )
    errors = {"north": north, "east": east, "up": outputs["fix.altitude"] - truth["altitude"]}
    angles = {name: outputs[f"attitude.{name}"] / DEG for name in ("roll", "pitch")}
    clear = outputs["attitude.valid"] > 0.0
    return {
        "error of position while valid (m)": {name: np.where(seen, error, np.nan) for name, error in errors.items()},
        "attitude while valid (deg)": {name: np.where(clear, angle, np.nan) for name, angle in angles.items()},
    }


def dme_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west."""
    return _flight(time)


def _ranges(flight: Mapping[str, np.ndarray]) -> np.ndarray:
    """True slant ranges, shape (times, stations)."""
    table = [stations.DEFAULT[f"station_{name}"] for name in ("latitude", "longitude", "altitude")]
    places = zip(flight["latitude"], flight["longitude"], flight["altitude"], strict=True)
    return np.array([dme.slant_range(*place, *table) for place in places])


def dme_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Ranges shown beside the true ones, and their errors when they were measured."""
    time, shown = outputs["time"], outputs["ranging.slant_range"]
    true = _ranges(_flight(time))
    curves: dict[str, np.ndarray] = {}
    errors = {}
    for i in range(int(stations.DEFAULT["station_count"])):
        seen = shown[:, i] > 0.0
        fresh = np.concatenate([[False], np.diff(shown[:, i]) != 0.0])
        last = np.maximum.accumulate(np.where(fresh, np.arange(len(time)), 0))
        curves[f"station {i + 1}"] = np.where(seen, shown[:, i], np.nan) / NAUTICAL_MILE
        curves["~truth" + " " * i] = true[:, i] / NAUTICAL_MILE
        errors[f"station {i + 1}"] = np.where(seen, shown[last, i] - true[last, i], np.nan)
    return {"slant range (nmi)": curves, "error of the last measurement (m)": errors}


# ---- navigator ----


def navigator_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """Level flight to the west in a wind of 8 m/s; heading wrong by 1 degree, airspeed by 2 m/s; no GPS after 300 s."""
    rng = np.random.default_rng(5)
    flight = _flight(time)
    wind = np.array([6.0, 5.0, 0.0])
    air = flight["velocity_n"] - wind
    noise = rng.standard_normal((3, len(time)))
    latitude, longitude = navigator.advance(
        flight["latitude"], flight["longitude"], HERE[2], 2.0 * noise[:2], np.ones_like(time)
    )
    second = np.floor(time + 1e-9).astype(int)  # fixes and ranges come once a second, and are held
    first = np.searchsorted(time, second - 1e-9)
    phi = float(np.exp(-SPEED / dme.CORRELATION_DISTANCE))
    bias = np.zeros((second[-1] + 1, stations.PLACES))
    for k, normal in enumerate(rng.standard_normal(bias.shape)):
        bias[k] = (
            dme.BIAS_SIGMA * normal if k == 0 else phi * bias[k - 1] + dme.BIAS_SIGMA * np.sqrt(1 - phi**2) * normal
        )
    turns = (np.floor(time / 15.0 + 1e-9) % 2)[:, None] == np.arange(stations.PLACES)
    return {
        "attitude.heading": np.arctan2(air[:, 1], air[:, 0]) + 1.0 * DEG,
        "air.true_airspeed": np.hypot(air[:, 0], air[:, 1]) + 2.0,
        "air.pressure_altitude": flight["altitude"] - 20.0,
        "fix.latitude": latitude[first],
        "fix.longitude": longitude[first],
        "fix.altitude": flight["altitude"],
        "fix.velocity_n": flight["velocity_n"],
        "fix.valid": time < GPS_LOST,
        "ranging.slant_range": _ranges(flight)[first] + bias[second],
        "ranging.measured": turns,
    }


def inertial_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """The same flight by the samples of an inertial unit with biases, noise of automotive grade, and a level that is
    wrong by half a degree at the beginning."""
    rng = np.random.default_rng(7)
    flight = _flight(time)
    position = np.stack([flight["latitude"], flight["longitude"], flight["altitude"]], axis=1)
    C_nb = attitude.dcm(0.0, 0.0, -0.5 * np.pi)
    rates, forces = [], []
    for place, velocity in zip(position, flight["velocity_n"], strict=True):
        _, gained, turning = inertial.rates(place, velocity, np.zeros(3))
        rates.append(C_nb.T @ turning)
        forces.append(C_nb.T @ -gained)
    noise = rng.standard_normal((2, len(time), 3))
    return {
        **navigator_inputs(time),
        "imu.rate": np.array(rates) + np.array([0.02, -0.02, 0.01]) * DEG + 0.05 * DEG * noise[0],
        "imu.specific_force": np.array(forces) + 5e-3 * STANDARD_GRAVITY + 1e-3 * STANDARD_GRAVITY * noise[1],
        "attitude.roll": np.full_like(time, 0.5 * DEG),
        "attitude.pitch": np.full_like(time, -0.3 * DEG),
    }


def navigator_panels(outputs: Mapping[str, np.ndarray]) -> dict[str, dict[str, np.ndarray]]:
    """Position errors with what the filter says of them."""
    truth = _flight(outputs["time"])
    known = outputs["solution.valid"] > 0.0
    errors = evaluation.position_error(
        truth["latitude"],
        truth["longitude"],
        truth["altitude"],
        outputs["solution.latitude"],
        outputs["solution.longitude"],
    )
    panels = {}
    for name, error in zip(("north", "east"), errors, strict=True):
        bound = np.where(known, 3.0 * outputs[f"{name}_sigma"], np.nan)
        panels[f"{name} error (m)"] = {"error": np.where(known, error, np.nan), "~3 sigma": bound, "~": -bound}
    return panels


# ---- evaluation ----


def evaluation_inputs(time: np.ndarray) -> dict[str, np.ndarray]:
    """A solution that drifts to the north faster and faster after a minute, and a sigma that grows evenly."""
    truth = _flight(0.0 * time)
    coasting = np.maximum(time - 60.0, 0.0)
    north_south = earth.radii(HERE[0])[0]
    return {
        **{name: truth[name] for name in ("latitude", "longitude", "altitude")},
        "solution.latitude": truth["latitude"] + (2.0 + 0.004 * coasting**2) / (north_south + HERE[2]),
        "solution.longitude": truth["longitude"],
        "solution.altitude": truth["altitude"] + 10.0,
        "north_sigma": 5.0 + 0.6 * coasting,
        "east_sigma": 5.0 + 0.6 * coasting,
        "mode": np.where(coasting > 0.0, 2, 1),
    }
