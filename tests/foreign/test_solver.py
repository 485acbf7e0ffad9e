"""Solvers of other makers get what they need to give the numbers that they give elsewhere."""

from __future__ import annotations

import fmpy
import pytest

from navfmu import System
from navfmu.fmi import fmu

from .solver import solver


@pytest.fixture(autouse=True)
def private_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("NAVFMU_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(fmu, "_memory", {})


@pytest.mark.parametrize("engine", ["compiled", "reference"])
@pytest.mark.parametrize("tolerance", [None, 0.25])
def test_a_solver_gets_the_tolerance_that_its_fmu_suggests(tmp_path, engine, tolerance):
    """In the first step, over which no other habit acts."""
    file = solver(tmp_path, tolerance)
    flight = System.load(file).run(stop=0.5, step=0.5, engine=engine)
    theirs = fmpy.simulate_fmu(str(file), stop_time=0.5, output_interval=0.5)
    assert flight["solver.y"].iloc[-1] == theirs["y"][-1] == 0.5 * (1.0 + (1.0 if tolerance is None else tolerance))
