"""A triad of inertial sensors of one kind: what the gyros have and, in other units, the accelerometers.

``triad("gyro", ...)`` is a class with the variables ``gyro_null_shift``, ``gyro_drift`` and so on, from which a
component inherits; ``Triad(component, "gyro").drift`` is that component's ``gyro_drift``, so that what is done with
both is written once. Errors that are constant after turn-on have a given part, and one that is drawn at turn-on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from models.inertial import axes, bandwidth, flicker, inertial, latency, quantiser, random_walk
from models.processes import gauss_markov
from models.processes.known import known
from navfmu.export import Component, Input, Parameter, State

CONSTANT = {
    "null_shift": ("bias", "{unit}", "{display}", None, "null shift, b_0 of thesis (3.3)"),
    "scale_factor": ("gain_error", "1", None, 0.5, "scale factor error, s_f of thesis (3.2)"),
    "scale_factor_asymmetry": ("asymmetry", "1", None, 0.5, "half of what the gain is more where s > 0"),
    "scale_factor_temperature": ("gain_warming", "1/K", None, 0.1, "change of the scale factor with temperature"),
    "null_shift_temperature": ("warming", "{unit}/K", None, None, "change of the null shift with temperature"),
    "nonorthogonality": ("leaning", "rad", "deg", 0.2, "angles by which y leans toward x, z toward x, z toward y"),
}
"""Errors that are constant after turn-on: the state that holds them, unit, display unit, largest size, what it is.

In the order in which they are drawn.
"""


def triad(sensor: str, plural: str, unit: str, displays: tuple[str, str], grade: Mapping[str, float]) -> type:
    """A class with the variables of a triad, to inherit from.

    ``displays`` are the display units of slow errors and of noise, ``grade`` holds start values under the names of the
    variables.
    """
    slow, fast = displays

    def parameter(name: str, *shape_and_unit: Any, **options: Any) -> Parameter:
        description = f"{plural}, {options.pop('description')}"
        start = grade.get(f"{sensor}_{name}", options.pop("start", 0.0))
        return Parameter(*shape_and_unit, start=start, description=description, **options)

    def each(name: str, description: str, display: str = slow) -> Parameter:
        return parameter(name, 3, unit, min=0.0, display_unit=display, description=description)

    def state(*shape_and_unit: Any, description: str) -> State:
        return State(*shape_and_unit, description=f"{plural}, {description}")

    declared: dict[str, Any] = {}
    for name, (held, own, shown, most, what) in CONSTANT.items():
        own = own.format(unit=unit)
        shown = shown and shown.format(display=slow)
        low, some = (None, None) if most is None else (-most, most / 5.0)
        declared |= {
            name: parameter(name, 3, own, min=low, max=most, display_unit=shown, description=f"{what}: given part"),
            f"{name}_sigma": parameter(
                f"{name}_sigma",
                3,
                own,
                min=0.0,
                max=some,
                display_unit=shown,
                description=f"{what}: standard deviation of the part drawn at turn-on",
            ),
            held: state(3, own, description=f"{what}, after turn-on"),
        }
    declared |= {
        "drift_sigma": each(
            "drift_sigma", "standard deviation of the drift b_1, thesis (3.4)-(3.5); starts as Table 3.2, automotive"
        ),
        "drift_time": parameter(
            "drift_time", "s", min=1.0, description="correlation time of the drift b_1; starts as Table 3.2, automotive"
        ),
        "noise_sigma": each(
            "noise_sigma", "wide-band noise b_w of a sample, standard deviation; starts as Table 3.2, automotive", fast
        ),
        "flicker": each("flicker", "bias instability B: the Allan deviation has a floor of 0.664 B"),
        "walk_sigma": each("walk_sigma", "rate random walk: standard deviation of its change in an hour, K sqrt(1 h)"),
        "bandwidth": parameter(
            "bandwidth", "Hz", min=0.0, max=1e6, description="bandwidth of the sensors' lag; 0: no lag"
        ),
        "lag_order": parameter(
            "lag_order", kind="integer", start=2, min=1, max=2, description="order of the sensors' lag"
        ),
        "damping": parameter(
            "damping", "1", start=float(np.sqrt(0.5)), min=0.1, max=0.99, description="damping of a lag of order 2"
        ),
        "range": each("range", "largest reading to both sides; 0: no limit", fast),
        "resolution": each("resolution", "step of the reading, which is rounded; 0: none", fast),
        "scale_factor_change": Input(
            3, "1", fault=True, description=f"fault F13: change of the scale factor of the {plural}"
        ),
    }
    declared |= {
        "axes": state(3, 3, "1", description="N C_m"),
        "drift": state(3, unit, description="drift b_1"),
        "decay": state("1", description="exp(-T/tau) of the drift"),
        "drive": state(3, unit, description="sigma sqrt(1 - phi^2) of the drift"),
        "flickers": state(flicker.DECADES, 3, unit, description="the processes whose sum is flicker noise"),
        "walk": state(3, unit, description="rate random walk"),
        "wander": state(3, unit, description="b_2: flicker noise and rate random walk"),
        "transition": state(2, 2, "1", description="Phi of the lag"),
        "delay": state("s", description="delay d of the lag"),
        "inverse": state("s", description="1 / w of the lag"),
        "before": state(3, unit, description="input of the lag one sample ago"),
        "lagged": state(2, 3, unit, description="(y, y' / w) of the lag"),
        "line": state(latency.LONGEST, 3, unit, description="samples that are under way"),
    }
    return type(sensor.capitalize(), (), {f"{sensor}_{name}": variable for name, variable in declared.items()})


class Triad:
    """The triad of a component, at one tick: ``triad.drift`` is ``component.gyro_drift``."""

    def __init__(self, component: Component, sensor: str) -> None:
        self.__dict__.update(component=component, sensor=sensor)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.component, f"{self.sensor}_{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self.component, f"{self.sensor}_{name}", value)

    def draw(self, error: str, noise) -> None:
        """Draw what is constant after turn-on: the given part plus one of the given sigma."""
        given, sigma = getattr(self, error), getattr(self, f"{error}_sigma")
        setattr(self, CONSTANT[error][0], given + sigma * noise(3))

    def begin_drift(self, period, noise) -> None:
        """Begin the drift in its long-run distribution, and keep what advances it by ``period``, s."""
        self.drift = gauss_markov.stationary(self.drift_sigma, noise(3))
        self.decay = gauss_markov.decay(period, self.drift_time)
        self.drive = gauss_markov.drive(self.drift_sigma, self.decay)

    def advance_drift(self, noise) -> None:
        """Drift, one period later."""
        self.drift = gauss_markov.advance(self.drift, self.decay, self.drive, noise(3))

    def begin_wander(self, noise) -> None:
        """Begin the flicker noise in its long-run distribution."""
        self.flickers = flicker.stationary(self.flicker, np.reshape(noise(3 * flicker.DECADES), (flicker.DECADES, 3)))
        self.wander = np.sum(self.flickers, axis=0)

    def advance_wander(self, period, decay, noise) -> None:
        """Flicker noise and rate random walk, one period later."""
        normals = np.reshape(noise(3 * flicker.DECADES), (flicker.DECADES, 3))
        self.flickers = flicker.advance(self.flickers, self.flicker, decay, normals)
        self.walk = random_walk.advance(self.walk, self.walk_sigma, period, noise(3))
        self.wander = np.sum(self.flickers, axis=0) + self.walk

    def begin_lag(self, mounting, period) -> None:
        """Keep N C_m, and what advances the lag by ``period``, s."""
        self.axes = axes.leaning(self.leaning) @ mounting
        self.transition = bandwidth.transition(self.bandwidth, self.lag_order, self.damping, period)
        self.delay, self.inverse = bandwidth.times(self.bandwidth, self.lag_order, self.damping)

    def scaled(self, true, warmer):
        """What the sensors show of what acts on their axes, at a temperature that is ``warmer`` by some K."""
        gain = self.gain_error + self.gain_warming * warmer + self.scale_factor_change
        return inertial.scaled(true, gain, self.asymmetry)

    def settle(self, scaled) -> None:
        """Let the lag be at rest in what the sensors show at turn-on."""
        self.before = known(scaled, 0.0)
        self.lagged = np.stack([self.before, np.zeros(3)])

    def follow(self, scaled, period):
        """What the sensors show behind their lag, one sample later."""
        times = (self.delay, self.inverse)
        self.lagged = bandwidth.follow(self.lagged, self.before, scaled, period, self.transition, times)
        self.before = scaled
        return self.lagged[0]

    def sensed(self, seen, warmer):
        """What is sensed, without wide-band noise."""
        return inertial.sense(seen, self.bias, self.drift, self.wander, self.warming * warmer)

    def within(self, sensed):
        """What is sensed, within the range."""
        return quantiser.within(sensed, self.range)

    def read(self, sensed):
        """The reading of what is sensed with its noise: in whole steps, in range."""
        return quantiser.reading(sensed, self.range, self.resolution)

    def leave(self, reading, late):
        """The reading that leaves the unit, ``late`` samples old."""
        leaving = latency.leave(self.line, reading, late)
        self.line = latency.enter(self.line, reading)
        return leaving
