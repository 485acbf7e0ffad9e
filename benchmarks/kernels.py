"""A scalar measurement by each kernel of ``models/filters``: operations, and time of the code that is made of it.

The operations of 12 states stand beside those of AGARD CP-298 (1981), p. 15-6, Table 4-1. Nothing is claimed of the
order of the times: it is what one pays for a covariance that stays one. And a prediction of the 15 error states of an
inertial navigator, by a transition that is given, and with the work to make it of position, velocity and attitude,
which ``navigator_inertial`` does ten times a second. Goals: 0.5 us for that prediction, 0.3 us for a measurement.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.contest import Contest, compete, main
from benchmarks.counted import operations
from benchmarks.exporter.contests import AGREE, flat
from benchmarks.exporter.loops import Loops
from benchmarks.exporter.translated import Translated
from models.attitude import attitude
from models.earth import earth
from models.filters import kalman, kalman_carlson, kalman_joseph, kalman_ud
from models.navigation import inertial

STATES = (12, 15)
GIVEN = "transition given"
KERNELS: dict[str, tuple] = {
    "conventional": (kalman, kalman.pack, kalman.unpack),
    "Joseph": (kalman_joseph, kalman_joseph.pack, kalman_joseph.unpack),
    "Carlson": (kalman_carlson, kalman_carlson.factors, kalman_carlson.covariance),
    "U-D": (kalman_ud, kalman_ud.factors, kalman_ud.covariance),
}
"""By name: module, what makes its form of a covariance, and what gives the covariance back."""


def given(states: int, packing: Callable) -> tuple:
    """Arguments of an update, of ordinary size."""
    rng = np.random.default_rng(states)
    root = rng.standard_normal((states, states + 3)) / np.sqrt(states)
    packed = packing(root @ root.T)
    return 0.1 * rng.standard_normal(states), packed, rng.standard_normal(states), 0.5, 0.3


def without_verdict(update: Callable, *arguments: np.ndarray) -> tuple:
    """What an update changes."""
    return update(*arguments)[:2]


def counts(states: int) -> dict[str, dict[str, int]]:
    """Operations of each kernel by kind."""
    return {
        name: dict(operations(module.update, given(states, packing))) for name, (module, packing, _) in KERNELS.items()
    }


def run(rounds: int = 7) -> list[Contest]:
    """Return a contest for each number of states."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        updates = [_contest(states, Path(scratch), rounds) for states in STATES]
        predictions = _predictions(Path(scratch), rounds)
    spent = 1e6 * updates[-1].median("conventional")
    updates[-1].claim("15 states: scalar measurement", 0.3, spent, at_least=False, unit="us")
    spent = 1e6 * predictions.median(GIVEN)
    predictions.claim("15 states of an inertial navigator: prediction", 0.5, spent, at_least=False, unit="us")
    return [*updates, predictions]


def with_dynamics(upper, position, velocity_n, force_n, C_nb, time, decay, noise):
    """A prediction of ``navigator_inertial``, without the states of pressure altitude and ranges."""
    matrix = inertial.dynamics(position, velocity_n, force_n, C_nb)
    return kalman.propagate(upper, inertial.transition(matrix, time), decay, noise)


def _predictions(folder: Path, rounds: int) -> Contest:
    states, driven = inertial.STATES, inertial.DRIVEN
    upper, rest = given(states, kalman.pack)[1], states - driven
    motion = (np.array([0.7, -2.1, 1e3]), np.array([50.0, 10.0, 0.0]), np.array([0.1, 0.2, -9.8]), np.eye(3), 0.1)
    rows = inertial.transition(inertial.dynamics(*motion[:-1]), motion[-1])
    own = (np.full(rest, 0.99), np.full(states, 1e-3))
    loops = Loops(states, driven, folder)
    watches, results = {}, []
    for name, function, arguments in (
        (GIVEN, kalman.propagate, (upper, rows, *own)),
        ("with its dynamics", with_dynamics, (upper, *motion, *own)),
    ):
        made = Translated(flat(function), arguments, (kalman, inertial, earth, attitude), folder)
        numbers = np.concatenate([np.ravel(np.asarray(argument, float)) for argument in arguments])
        watches[name] = loops.stopwatch(made.address, numbers, upper.size)
        results.append(watches[name].result)
    if not np.max(np.abs(results[1] - results[0])) <= AGREE * np.max(np.abs(results[0])):
        raise AssertionError("a transition that is given and one that is made give different predictions")
    return compete(
        "inertial navigator, 15 states: prediction", "call", watches, rounds, "Both give the same covariance."
    )


def _contest(states: int, folder: Path, rounds: int) -> Contest:
    watches, covariances = {}, []
    loops = Loops(states, states, folder)
    for name, (module, packing, back) in KERNELS.items():
        arguments = given(states, packing)
        function = flat(partial(without_verdict, module.update))
        made = Translated(function, arguments, (module, kalman, kalman_ud), folder)
        numbers = np.concatenate([np.ravel(np.asarray(argument, float)) for argument in arguments])
        watches[name] = loops.stopwatch(made.address, numbers, function(*arguments).size)
        covariances.append(np.append(watches[name].result[:states], back(watches[name].result[states:])))
    apart = max(np.max(np.abs(one - covariances[0])) for one in covariances)
    if not apart <= AGREE * np.max(np.abs(covariances[0])):
        raise AssertionError(f"kernels of {states} states differ by {apart:.1e}; expected the same covariance")
    told = "; ".join(
        f"{name}: " + ", ".join(f"{number} {kind}" for kind, number in sorted(count.items()))
        for name, count in counts(states).items()
    )
    work = f"All give the same correction and covariance, which is checked. Operations with constants folded: {told}."
    return compete(f"kernels, {states} states: scalar update", "call", watches, rounds, work)


if __name__ == "__main__":
    main(run)
