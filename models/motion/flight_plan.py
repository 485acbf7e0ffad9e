"""Flight plans: segments, their times, the ground track, and plans that end where they should.

A plan holds at most 24 segments, as the aircraft's parameters do. ``FlightPlan.parameters`` gives the parameter values,
``FlightPlan.sample`` the trajectory without running anything, with the same equations (``models.motion.aircraft``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from models.earth import earth
from models.motion import aircraft

SEGMENTS = 24
GRID = 0.1
"""Segments begin at multiples of this time, s."""
LIMITS = (np.radians(5.0), 0.5, 0.5)
"""Largest roll rate (rad/s), acceleration and vertical acceleration (m/s2) of the transitions."""


@dataclass(frozen=True)
class Segment:
    """A piece of flight: how long, and the values it goes to from those of the segment before."""

    duration: float  # s
    speed: float  # over ground, m/s
    turn_rate: float = 0.0  # of the ground track, rad/s, positive to the right
    vertical_speed: float = 0.0  # m/s, positive up


def straight(duration: float, speed: float, vertical_speed: float = 0.0) -> Segment:
    """A segment without a turn."""
    return Segment(round(duration / GRID) * GRID, speed, 0.0, vertical_speed)


def turn(angle: float, rate: float, speed: float, vertical_speed: float = 0.0) -> Segment:
    """A segment that turns the track by ``angle`` (rad, positive to the right) at about ``rate`` (rad/s).

    What the roll-in takes away at its begin, the roll-out returns at the begin of the next segment, so the whole turn
    is ``angle`` when the next segment is straight and the speed does not change.
    """
    duration = max(round(abs(angle / rate) / GRID), 1) * GRID
    return Segment(duration, speed, angle / duration, vertical_speed)


@dataclass(frozen=True)
class FlightPlan:
    """Initial state (level, straight flight) and segments."""

    latitude: float  # rad
    longitude: float  # rad
    altitude: float  # above the ellipsoid, m
    track: float  # rad
    speed: float  # over ground, m/s
    segments: Sequence[Segment]

    def __post_init__(self) -> None:
        if not 1 <= len(self.segments) <= SEGMENTS:
            raise ValueError(f"a flight plan has 1 to {SEGMENTS} segments, this one has {len(self.segments)}")
        too_short = np.flatnonzero(~aircraft.fits(*self._arguments()))
        if len(too_short):
            i = int(too_short[0])
            raise ValueError(
                f"segment {i + 1} of the flight plan lasts {self.segments[i].duration:g} s, less than "
                "the transition to its speed, turn rate or vertical speed needs"
            )

    @property
    def duration(self) -> float:
        """Sum of the segments' durations, s."""
        return sum(s.duration for s in self.segments)

    def columns(self) -> dict[str, np.ndarray]:
        """The segments as arrays of 24, zero where there is none."""
        empty = [0.0] * (SEGMENTS - len(self.segments))
        return {
            name: np.array([getattr(s, name) for s in self.segments] + empty)
            for name in ("duration", "turn_rate", "vertical_speed", "speed")
        }

    def parameters(self) -> dict[str, float | np.ndarray]:
        """Values of the aircraft's parameters, by name."""
        return {
            "initial_latitude": self.latitude,
            "initial_longitude": self.longitude,
            "initial_altitude": self.altitude,
            "initial_track": self.track,
            "initial_speed": self.speed,
            **{f"segment_{name}": values for name, values in self.columns().items()},
        }

    def _arguments(self) -> tuple:
        c = self.columns()
        initial = (self.track, self.altitude, self.speed)
        return c["duration"], c["turn_rate"], c["vertical_speed"], c["speed"], initial, LIMITS, GRID

    def sample(self, period: float = 1.0, duration: float | None = None) -> dict[str, np.ndarray]:
        """The ground trajectory at 0, period, ...: time, latitude, longitude, altitude, velocity_n (3 columns), track.

        Its positions differ from the aircraft's by less than a centimetre at a period of 1 s.
        """
        count = round((self.duration if duration is None else duration) / period)
        half = np.arange(2 * count + 1) * (0.5 * period)
        plan = aircraft.schedule(*self._arguments())
        begins = plan["begin"][: len(self.segments)]
        at = {name: values[np.searchsorted(begins, half, side="right") - 1] for name, values in plan.items()}
        elapsed = half - at["begin"]
        speed = aircraft.change(elapsed, at["speed_before"], at["speed_step"], at["speed_time"])[0]
        turned = aircraft.change(elapsed, at["turn_rate_before"], at["turn_rate_step"], at["roll_time"])[3]
        climb = aircraft.change(elapsed, at["vertical_speed_before"], at["vertical_speed_step"], at["climb_time"])
        track = at["track"] + turned
        altitude = at["altitude"] + climb[3]
        velocity = np.column_stack([speed * np.cos(track), speed * np.sin(track), -climb[0]])
        latitude = np.full(len(half), self.latitude)
        for _ in range(3):
            north_south, east_west = earth.radii(latitude)
            latitude = self.latitude + _integral(velocity[:, 0] / (north_south + altitude), period)
        _, east_west = earth.radii(latitude)
        longitude = self.longitude + _integral(velocity[:, 1] / ((east_west + altitude) * np.cos(latitude)), period)
        whole = slice(None, None, 2)
        return {
            "time": half[whole],
            "latitude": latitude[whole],
            "longitude": longitude[whole],
            "altitude": altitude[whole],
            "velocity_n": velocity[whole],
            "track": track[whole],
        }

    def ending_at(self, latitude: float, longitude: float) -> FlightPlan:
        """The same plan, moved so that it ends at this position."""
        plan = self
        for _ in range(4):
            end = plan.sample()
            plan = replace(
                plan,
                latitude=plan.latitude + latitude - float(end["latitude"][-1]),
                longitude=plan.longitude + longitude - float(end["longitude"][-1]),
            )
        return plan


def _integral(rate: np.ndarray, period: float) -> np.ndarray:
    """Integral from the first point at points half a period apart: Simpson's rule, the same parabola at the middles."""
    left, middle, right = rate[:-2:2], rate[1:-1:2], rate[2::2]
    result = np.zeros(len(rate))
    ends = np.cumsum(period / 6.0 * (left + 4.0 * middle + right))
    result[2::2] = ends
    result[1::2] = np.concatenate([[0.0], ends[:-1]]) + period / 24.0 * (5.0 * left + 8.0 * middle - right)
    return result


def asked(plan: dict[str, np.ndarray], time: float) -> dict[str, float]:
    """What a plan (``models.motion.aircraft.schedule``) asks for at a time (s).

    By name: track (rad), turn_rate (rad/s), altitude (m), vertical_speed (m/s upward) and speed (m/s).
    """
    at = {name: values[np.searchsorted(plan["begin"], time, side="right") - 1] for name, values in plan.items()}
    elapsed = time - at["begin"]
    turn = aircraft.change(elapsed, at["turn_rate_before"], at["turn_rate_step"], at["roll_time"])
    climb = aircraft.change(elapsed, at["vertical_speed_before"], at["vertical_speed_step"], at["climb_time"])
    return {
        "track": at["track"] + turn[3],
        "turn_rate": turn[0],
        "altitude": at["altitude"] + climb[3],
        "vertical_speed": climb[0],
        "speed": aircraft.change(elapsed, at["speed_before"], at["speed_step"], at["speed_time"])[0],
    }
