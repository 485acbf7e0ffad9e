"""24 satellites are what the benchmark says: each is measured and solved, or less work would be timed."""

from __future__ import annotations

import pytest

from benchmarks import overhead
from benchmarks.everything_on import EVERYTHING
from benchmarks.masters import BareLoop
from navfmu import System


@pytest.mark.parametrize("every_error", [False, True])
def test_all_satellites_are_measured_and_solved_from_the_third_step_on(tmp_path, every_error):
    """With errors a range that is 30 m too long is the same for all, and no satellite is excluded."""
    told = {f"gps_signals.{name}": value for name, value in EVERYTHING["gps_signals"].items()}
    loop = BareLoop(
        System.load(overhead.system(tmp_path, solved=True)).plan(
            stop=overhead.STAY,
            step=overhead.PERIOD,
            record_period=overhead.STAY,
            parameters=told if every_error else overhead.MOTION,
        )
    )
    loop.run(5)
    first = loop.outputs()
    loop.run(100)
    then = loop.outputs()
    for outputs in (first, then):
        assert [outputs[f"{name}.satellites"] for name in ("gps_signals", "gps_solver")] == [24.0, 24.0]
        assert outputs["gps_solver.fix.valid"] == 1.0
    assert then["gps_solver.fix.sequence"] - first["gps_solver.fix.sequence"] == 100.0
