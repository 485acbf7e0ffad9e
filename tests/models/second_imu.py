"""The inertial unit a second time, from docs/sensors and their sources and not from the models.

Of the component it has the order in which random numbers are drawn. Plain loops, matrices and SciPy's exponential.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.linalg import expm

from navfmu.export.noise import Normals

SENSORS = ("gyro", "accelerometer")
CONSTANT = ("scale_factor_asymmetry", "scale_factor_temperature", "null_shift_temperature", "nonorthogonality")
CONING = {
    1: [],
    2: [1 / 6],
    3: [191 / 720, -71 / 1440],
    4: [20249 / 60480, -3173 / 30240, 841 / 60480],
}
"""docs/sensors/increments.md: numbers for trapezoids."""


def skew(vector) -> np.ndarray:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def clipped(value, largest) -> np.ndarray:
    return np.array([min(max(v, -m), m) if m > 0.0 else v for v, m in zip(value, largest, strict=True)])


def converted(value, largest, step) -> np.ndarray:
    """Nearest whole steps; one step less for as long as the reading is out of range."""
    out = clipped(value, np.where(step > 0.0, 0.0, largest))
    for i in range(3):
        if step[i] > 0.0:
            count = round(value[i] / step[i])
            while largest[i] > 0.0 and abs(count) * step[i] > largest[i] * (1.0 + 1e-11):
                count -= np.sign(count)
            out[i] = count * step[i]
    return out


class Lag:
    """A transfer function and an input that is linear between samples: the exponential of the system with its input."""

    def __init__(self, bandwidth: float, order: int, damping: float, period: float, first) -> None:
        w = 2.0 * np.pi * bandwidth
        a, b = ([[-w]], [w]) if order == 1 else ([[0.0, 1.0], [-w * w, -2.0 * damping * w]], [0.0, w * w])
        n = len(a)
        whole = np.zeros((n + 2, n + 2))
        whole[:n, :n], whole[:n, n], whole[n, n + 1] = np.multiply(a, period), np.multiply(b, period), 1.0
        self.advance, self.input = expm(whole)[:n], np.array(first)
        self.state = np.zeros((n, 3))
        self.state[0] = first

    def __call__(self, value) -> np.ndarray:
        self.state = self.advance @ np.vstack([self.state, self.input, value - self.input])
        self.input = value
        return self.state[0]


class SecondImu:
    """Holds what an instance holds; :meth:`tick` is a sample, whose products are ``readings`` and ``increments``."""

    def __init__(self, parameters: Mapping[str, Any], inputs: Mapping[str, Any], seed: int, stream: int) -> None:
        self.parameters, self.seed, self.stream, self.count = parameters, seed, stream, 0
        self.period = parameters["sample_period"]
        noise = Normals(seed, stream, 0, 0)
        self.drawn: dict[str, np.ndarray] = {}
        for sensor in SENSORS:
            self.draw(f"{sensor}_null_shift", noise)
        self.drift = {s: self.three(f"{s}_drift_sigma") * noise(3) for s in SENSORS}
        mounting = np.eye(3) - skew(self.three("misalignment") + self.three("misalignment_sigma") * noise(3))
        for sensor in SENSORS:
            self.draw(f"{sensor}_scale_factor", noise)
        self.sensitivity = np.array(parameters["gyro_g_sensitivity"], float)
        self.sensitivity = self.sensitivity + parameters["gyro_g_sensitivity_sigma"] * noise(9).reshape(3, 3)
        self.flicker, self.walk, self.axes = {}, {s: np.zeros(3) for s in SENSORS}, {}
        for sensor in SENSORS:
            for error in CONSTANT:
                self.draw(f"{sensor}_{error}", noise)
            self.flicker[sensor] = self.flicker_sigma(sensor) * noise(15).reshape(5, 3)
            yx, zx, zy = self.drawn[f"{sensor}_nonorthogonality"]
            self.axes[sensor] = np.array([[1.0, 0.0, 0.0], [yx, 1.0, 0.0], [zx, zy, 1.0]]) @ mounting
        self.temperature = inputs["temperature"]
        self.rates = [np.array(inputs["rate"], float)] * 2
        first = self.shown(inputs)
        self.lag = {
            s: Lag(
                parameters[f"{s}_bandwidth"],
                parameters[f"{s}_lag_order"],
                parameters[f"{s}_damping"],
                self.period,
                first[s],
            )
            for s in SENSORS
            if parameters[f"{s}_bandwidth"]
        }
        self.sensed = {s: clipped(first[s] + self.bias(s), self.three(f"{s}_range")) for s in SENSORS}
        self.rest, self.past, self.parts = ({s: x() for s in SENSORS} for x in (lambda: np.zeros(3), list, list))
        self.coning, self.sculling = np.zeros(3), np.zeros(3)
        self.readings: list[tuple[float, np.ndarray, np.ndarray]] = []
        self.increments: list[tuple[np.ndarray, np.ndarray]] = []

    def three(self, name: str) -> np.ndarray:
        return np.array(np.broadcast_to(self.parameters[name], 3), float)

    def draw(self, name: str, noise) -> None:
        self.drawn[name] = self.three(name) + self.three(f"{name}_sigma") * noise(3)

    def flicker_sigma(self, sensor: str) -> np.ndarray:
        """B^2 ln 10 / pi for each decade."""
        return self.three(f"{sensor}_flicker") * np.sqrt(np.log(10.0) / np.pi)

    @property
    def warmer(self) -> float:
        return self.temperature - self.parameters["calibration_temperature"]

    def bias(self, sensor: str) -> np.ndarray:
        wander = sum(self.flicker[sensor]) + self.walk[sensor]
        constant = self.drawn[f"{sensor}_null_shift"] + self.drawn[f"{sensor}_null_shift_temperature"] * self.warmer
        return constant + self.drift[sensor] + wander

    def shown(self, inputs: Mapping[str, Any]) -> dict[str, np.ndarray]:
        """Lever arm, vibration, mounting, leaning axes, sensitivity to force, scale factors."""
        rate, force, arm = np.array(inputs["rate"]), np.array(inputs["specific_force"]), self.three("lever_arm")
        turning = (3.0 * rate - 4.0 * self.rates[0] + self.rates[1]) / (2.0 * self.period)
        force = force + np.cross(turning, arm) + np.cross(rate, np.cross(rate, arm))
        if inputs["vibrating"]:
            s, c, p, q = (
                self.three(f"vibration_{x}") for x in ("swing_sine", "swing_cosine", "shake_sine", "shake_cosine")
            )
            w = 2.0 * np.pi * self.parameters["vibration_frequency"]
            turn = w * self.count * self.period
            rate = rate + w * (s * np.cos(turn) - c * np.sin(turn)) + 0.5 * w * np.cross(s, c)
            force = force + p * np.sin(turn) + q * np.cos(turn) - 0.5 * (np.cross(s, p) + np.cross(c, q))
            force = force + 0.5 * self.three("accelerometer_rectification") * (p * p + q * q)
        turned = np.eye(3) - skew(inputs["misalignment_change"])
        felt = self.axes["gyro"] @ turned @ force
        sensitivity = self.sensitivity + np.diag(inputs["gyro_g_sensitivity_change"])
        found = {
            "gyro": self.axes["gyro"] @ turned @ rate + sensitivity @ felt,
            "accelerometer": self.axes["accelerometer"] @ turned @ force,
        }
        for sensor, true in found.items():
            gain = 1.0 + self.drawn[f"{sensor}_scale_factor"] + np.array(inputs[f"{sensor}_scale_factor_change"])
            gain = gain + self.drawn[f"{sensor}_scale_factor_temperature"] * self.warmer
            found[sensor] = gain * true + self.drawn[f"{sensor}_scale_factor_asymmetry"] * np.abs(true)
        return found

    def tick(self, inputs: Mapping[str, Any]) -> None:
        """The next sample: drift and temperature before it, flicker noise and random walk after it."""
        self.count += 1
        if (n := self.due("drift_period")) is not None:
            self.advance_drift(inputs, n)
        shown = self.shown(inputs)
        self.rates = [np.array(inputs["rate"], float), self.rates[0]]
        noise = Normals(self.seed, self.stream, self.count, 2)
        reading, parts = {}, {}
        for sensor in SENSORS:
            value = self.lag[sensor](shown[sensor]) if sensor in self.lag else shown[sensor]
            value = value + self.bias(sensor)
            noisy = value + self.three(f"{sensor}_noise_sigma") * noise(3)
            largest = self.three(f"{sensor}_range")
            reading[sensor] = converted(noisy, largest, self.three(f"{sensor}_resolution"))
            quiet, noisy = clipped(value, largest), clipped(noisy, largest)
            part = self.period * (0.5 * (self.sensed[sensor] + quiet) + noisy - quiet)
            self.sensed[sensor] = quiet
            quantum = self.parameters["angle_quantum" if sensor == "gyro" else "velocity_quantum"]
            if quantum:
                total = part + self.rest[sensor]
                part = quantum * np.round(total / quantum)
                self.rest[sensor] = total - part
            parts[sensor] = part
        self.readings.append((self.count * self.period, *reading.values()))
        self.add(parts)
        if (n := self.due("wander_period")) is not None:
            self.advance_wander(n)

    def due(self, period: str) -> int | None:
        """Which tick of a slower clock comes with this sample."""
        every = round(self.parameters[period] / self.period)
        return self.count // every if self.count % every == 0 else None

    def advance_drift(self, inputs: Mapping[str, Any], n: int) -> None:
        noise, period = Normals(self.seed, self.stream, n, 1), self.parameters["drift_period"]
        for sensor in SENSORS:
            kept = np.exp(-period / self.parameters[f"{sensor}_drift_time"])
            new = self.three(f"{sensor}_drift_sigma") * np.sqrt(1.0 - kept * kept)
            self.drift[sensor] = kept * self.drift[sensor] + new * noise(3)
        end = inputs["temperature"] + self.parameters["self_heating"]
        self.temperature = end + (self.temperature - end) * np.exp(-period / self.parameters["thermal_time"])

    def advance_wander(self, n: int) -> None:
        noise, period = Normals(self.seed, self.stream, n, 3), self.parameters["wander_period"]
        kept = np.exp(-period / (self.parameters["flicker_time"] * np.array([[1.0], [1e1], [1e2], [1e3], [1e4]])))
        for sensor in SENSORS:
            new = self.flicker_sigma(sensor) * np.sqrt(1.0 - kept * kept)
            self.flicker[sensor] = kept * self.flicker[sensor] + new * noise(15).reshape(5, 3)
            self.walk[sensor] = self.walk[sensor] + self.three(f"{sensor}_walk_sigma") * np.sqrt(
                period / 3600.0
            ) * noise(3)

    def add(self, parts: Mapping[str, np.ndarray]) -> None:
        """Coning and sculling: the bracket of docs/sensors/increments.md."""
        numbers = CONING[self.parameters["coning_samples"]]
        angle, velocity = parts.values()
        angles, velocities = (
            0.5 * sum(self.parts[s], np.zeros(3))
            + sum((c * x for c, x in zip(numbers, reversed(self.past[s]), strict=False)), np.zeros(3))
            for s in SENSORS
        )
        self.coning = self.coning + np.cross(angles, angle)
        self.sculling = self.sculling + np.cross(angles, velocity) + np.cross(velocities, angle)
        for sensor in SENSORS:
            self.parts[sensor].append(parts[sensor])
            self.past[sensor].append(parts[sensor])
        if len(self.parts["gyro"]) == self.parameters["increment_samples"]:
            angle, velocity = (sum(self.parts[s]) for s in SENSORS)
            self.increments.append((angle + self.coning, velocity + self.sculling))
            self.parts, self.coning, self.sculling = {s: [] for s in SENSORS}, np.zeros(3), np.zeros(3)
