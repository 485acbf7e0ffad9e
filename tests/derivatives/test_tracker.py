"""The filter of the tutorial, which writes no matrix by hand: native, as twin, and true to its own covariance."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from navfmu import System
from navfmu.derivatives import jacobian
from navfmu.export.build import build
from navfmu.export.twin import build_twin, sources
from navfmu.ssp import SystemSource

from .differences import extrapolated

TEXT = (Path(__file__).parents[2] / "docs" / "tutorial_component.md").read_text(encoding="utf-8")
STATES = range(1, 6)


def block(name):
    return re.search(rf"^```python\n# {name}\n(.*?)^```$", TEXT, re.S | re.M)[1]


@pytest.fixture(scope="module")
def harbour(tmp_path_factory):
    """The tutorial's components, imported."""
    folder = tmp_path_factory.mktemp("harbour")
    for name in ("tracking.py", "harbour.py"):
        (folder / name).write_text(block(name), encoding="utf-8")
    sys.path.insert(0, str(folder))
    try:
        yield importlib.import_module("harbour")
    finally:
        sys.path.remove(str(folder))
        for name in ("tracking", "harbour"):
            sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def systems(harbour, tmp_path_factory):
    """The tutorial's system with a native filter, and with its twin."""
    folder = tmp_path_factory.mktemp("system")
    build([harbour.Boat, harbour.Tracker], folder / "dist")
    build_twin(harbour.Tracker, folder / "dist" / "python")
    made = {}
    for name, file in (("native", "tracker.fmu"), ("twin", "python/tracker.fmu")):
        system = SystemSource(name, fmus=str(folder / "dist"), stop_time=120.0, step=1.0, description="a boat")
        system.component("boat", "boat.fmu")
        system.component("tracker", file)
        system.connect("boat.radar", "tracker.radar")
        system.write(folder / name)
        made[name] = System.load(folder / name)
    return made


def estimates(flight):
    """Errors, shape (times, 5), and covariances, shape (times, 5, 5)."""
    state, truth = (flight[[f"{one}.state[{i}]" for i in STATES]].to_numpy() for one in ("tracker", "boat"))
    covariance = flight[[f"tracker.covariance[{i},{j}]" for i in STATES for j in STATES]].to_numpy()
    return state - truth, covariance.reshape(-1, 5, 5)


def test_the_twin_carries_what_differentiates(harbour):
    carried = sources(harbour.Tracker)
    assert {"navfmu.derivatives.jacobian", "navfmu.derivatives.dual", "navfmu.place", "tracking"} <= set(carried)
    assert not [name for name in carried if name.startswith("navfmu.export.tracing.trace")]


def test_native_and_twin_give_the_same_numbers(systems):
    """Over two minutes of a filter that feeds its estimate back into its derivatives."""
    native, twin = (estimates(systems[name].run(seed=3)) for name in ("native", "twin"))
    for ours, theirs in zip(native, twin, strict=True):
        assert np.ptp(ours[:, 0]).max() > 1.0
        assert np.max(np.abs(ours - theirs)) <= 1e-11 * np.max(np.abs(ours))


def test_the_filter_is_as_wrong_as_it_says(systems):
    """NEES of 100 seeds: e' P^-1 e summed over seeds is chi-square with 500 degrees of freedom at each time.

    Ten times are looked at, so the bounds are those of 1 - 0.01 / 10. With a sign wrong in F or H the error leaves what
    the covariance claims; what is a tenth wrong shows in the next test.
    """
    runs, times = 100, [1, 2, 5, 10, 20, 30, 45, 60, 90, 120]
    total = np.zeros(len(times))
    for seed in range(1, runs + 1):
        error, covariance = (one[times] for one in estimates(systems["native"].run(seed=seed)))
        total += np.sum(error * np.linalg.solve(covariance, error[..., None])[..., 0], axis=-1)
    low, high = chi2.ppf([0.0005, 0.9995], 5 * runs)
    assert np.all((low < total) & (total < high)), total / runs


def test_the_matrices_of_the_filter_are_those_of_its_equations(harbour):
    """By differences of how the boat moves and of what the radar sees, all around the radar."""
    tracking = harbour.tracking
    for bearing in np.linspace(-3.0, 3.0, 7):
        x = np.array([900.0 * np.cos(bearing), 900.0 * np.sin(bearing), 8.0, 2.0 * bearing, 0.02])
        for function in (lambda x: tracking.moved(x, 1.5), tracking.seen):
            truth, bound = extrapolated(function, x)
            assert np.all(np.abs(jacobian(function, x) - truth) <= bound)
