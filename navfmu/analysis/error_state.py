"""Errors of dead reckoning and of distances as states, thesis section 6.3 and (6.24)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.constants import NAUTICAL_MILE

DISTANCE_NOISE = 0.004 * NAUTICAL_MILE
DISTANCE_BIAS = 0.17 * NAUTICAL_MILE
"""Of a distance, one sigma, m; thesis Table 6.1."""
BIAS_DISTANCE = 0.5 * NAUTICAL_MILE
"""Over which the bias of a distance changes, m; Table 6.1 prints 5 miles."""


@dataclass(frozen=True)
class State:
    """An error of ``sigma`` (in SI) that is known of beforehand, and decays within ``time`` (s).

    In words it is so many ``per`` of SI: ``unit``.
    """

    name: str
    sigma: float
    time: float
    unit: str
    per: float = 1.0


FOREVER = np.inf
HALF_MILE = 0.5 * NAUTICAL_MILE
POSITION = (State("position to north", HALF_MILE, FOREVER, "m"), State("position to east", HALF_MILE, FOREVER, "m"))
WIND = (State("wind to north", 5.0, 400.0, "m/s"), State("wind to east", 5.0, 400.0, "m/s"))
AIR = (
    State("heading", np.radians(2.5), 120.0, "deg", 180.0 / np.pi),
    State("airspeed", 2.6, 400.0, "m/s"),
)
ALTITUDE = State("altitude", 23.0, 400.0, "m")


def bias(ident: str, speed: float) -> State:
    """The bias of a station's distance at a speed over ground, m/s."""
    return State(f"distance of {ident}", DISTANCE_BIAS, BIAS_DISTANCE / max(speed, 1.0), "m")


MODELS = {
    "position": "position alone, (6.1) to (6.6)",
    "reduced": "position and a constant wind, (6.12) to (6.14): the reduced order",
    "sensors": "position, wind, heading and airspeed, all constant, (6.15) to (6.20)",
    "full": "position, altitude, wind, heading, airspeed and the bias of each distance, which decay, (6.24) to (6.26)",
}


def states(model: str, idents: list[str], speed: float) -> tuple[State, ...]:
    """The states of a model in the order of (6.18) or (6.24); in section 6.3 all are constant."""
    if model == "full":
        return (*POSITION, ALTITUDE, *WIND, *AIR, *(bias(ident, speed) for ident in idents))
    found = {"position": POSITION, "reduced": POSITION + WIND, "sensors": POSITION + WIND + AIR}[model]
    return tuple(State(one.name, one.sigma, FOREVER, one.unit, one.per) for one in found)


def noise(model: str) -> float:
    """Of a distance, one sigma, m: its bias is noise where it is no state."""
    return DISTANCE_NOISE if model == "full" else float(np.hypot(DISTANCE_NOISE, DISTANCE_BIAS))
