"""What is exported, and what it is measured against: filters of 15, 24 and 42 states, and a fix from 24 satellites."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from benchmarks.exporter import by_elements, error_states, satellites
from models.filters import kalman, kalman_ud

STATES_DRIVEN = {15: 9, 24: 9, 42: 10}
"""How many of the states are driven by others; the rest are Gauss-Markov processes."""


@dataclass(frozen=True)
class Case:
    """A function in one or two ways of writing, arguments for it, and the function of loops.c that does the same."""

    name: str
    forms: dict[str, Callable]
    arguments: tuple[Any, ...]
    loops: str
    states: int = 15
    seconds: float | None = None  # what one call may take
    modules: tuple = field(default=(kalman, kalman_ud, by_elements, error_states, satellites))


def cases() -> Iterator[Case]:
    """All cases, the small ones first."""
    yield inertial(15)
    yield _bank()
    yield from _satellites()
    for states in (15, 24, 42):
        yield from _matrix(states)
        yield from _factors(states)


def _without_verdict(update: Callable, *arguments: Any) -> Any:
    return update(*arguments)[:-1]


def _filter(states: int) -> dict[str, Any]:
    """Numbers of ordinary size for a filter."""
    rng, driven = np.random.default_rng(states), STATES_DRIVEN[states]
    root = rng.standard_normal((states, states + 3)) / np.sqrt(states)
    return {
        "covariance": root @ root.T,
        "rows": np.eye(driven, states) + 0.01 * rng.standard_normal((driven, states)),
        "factor": rng.uniform(0.9, 1.0, states - driven),
        "noise": rng.uniform(0.001, 0.01, states),
        "row": rng.standard_normal(states),
        "correction": 0.1 * rng.standard_normal(states),
    }


def _matrix(states: int) -> Iterator[Case]:
    given = _filter(states)
    upper = kalman.pack(given["covariance"])
    move = (given["rows"], given["factor"], given["noise"])
    yield Case(
        f"covariance matrix, {states} states: predict",
        {"vectorised": kalman.propagate},
        (upper, *move),
        "ekf_predict",
        states,
    )
    yield Case(
        f"covariance matrix, {states} states: scalar update",
        {"vectorised": partial(_without_verdict, kalman.update)},
        (given["correction"], upper, given["row"], 0.5, 0.3),
        "ekf_update",
        states,
        0.3e-6 if states == 15 else None,
    )


def _factors(states: int) -> Iterator[Case]:
    given = _filter(states)
    columns = kalman_ud.factors(given["covariance"])
    move = (given["rows"], given["factor"], given["noise"])
    yield Case(
        f"U-D factors, {states} states: predict",
        {"vectorised": kalman_ud.propagate, "by elements": by_elements.propagate},
        (columns, *move),
        "ud_predict",
        states,
    )
    yield Case(
        f"U-D factors, {states} states: scalar update",
        {"vectorised": partial(_without_verdict, kalman_ud.update), "by elements": by_elements.update},
        (given["correction"], columns, given["row"], 0.5, 0.3),
        "ud_update",
        states,
    )


def _motion() -> tuple[Any, ...]:
    """Period (s), specific force (m/s^2), C_nb, factors of the null shifts."""
    c, s = np.cos(0.3), np.sin(0.3)
    return 0.01, np.array([0.5, -0.3, -9.8]), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), 0.999, 0.998


def inertial(states: int) -> Case:
    """The error states of an inertial navigator, with its matrix written in blocks."""
    given = _filter(states)
    arguments = (kalman.pack(given["covariance"]), given["noise"], *_motion())
    name = f"inertial navigator, {states} error states in blocks: predict"
    return Case(name, {"vectorised": error_states.predict}, arguments, "inertial_predict", states, 0.5e-6)


def _bank() -> Case:
    given = _filter(15)
    upper = kalman.pack(given["covariance"])
    arguments = (
        np.outer([1.0, 0.5, -0.5, -1.0], given["correction"]),
        np.outer([1.0, 2.0, 4.0, 8.0], upper),
        np.outer([1.0, 10.0, 0.1, 2.0], given["noise"]),
        given["row"],
        np.array([0.5, 1.0, 2.0, 4.0]),
        0.3,
        *_motion(),
    )
    name = "bank of four filters of 15 states: predict and update"
    return Case(name, {"vectorised": error_states.bank}, arguments, "bank")


def _satellites() -> Iterator[Case]:
    rng = np.random.default_rng(24)
    elevation, azimuth = rng.uniform(0.1, 1.5, 24), rng.uniform(0.0, 2 * np.pi, 24)
    up, across = np.sin(elevation), np.cos(elevation)
    towards = np.stack([across * np.cos(azimuth), across * np.sin(azimuth), up], axis=1)
    positions = 2.2e7 * towards
    true = np.array([300.0, -200.0, 100.0])
    ranges = np.linalg.norm(positions - true, axis=1) + 1000.0 + rng.normal(0.0, 3.0, 24)
    arguments = (np.zeros(4), positions, ranges, np.sin(elevation) ** 2)
    forms = {
        "np.linalg.solve": partial(satellites.fix, solve=satellites.solve_by_library),
        "written out": partial(satellites.fix, solve=satellites.solve_written_out),
    }
    yield Case("24 satellites, four iterations of least squares", forms, arguments, "satellites", seconds=10e-6)
