"""What comes in and is no number: sensors show it while it is there, and nothing of it is kept."""

from __future__ import annotations

import numpy as np
import pytest

from tests.built import components
from tests.models.native import interpret

COMPONENTS = {name: c for name, c in components().items() if any(v.causality == "input" for v in c.layout.variables)}
GIVEN = {"latitude": 0.66, "longitude": -2.1, "altitude": 1500.0, "velocity_n": (46.0, 1.0, 0.5)}


def inputs(component) -> list[str]:
    return [v.name for v in component.layout.variables if v.causality == "input" and v.type == "Real"]


@pytest.mark.parametrize(
    ("name", "given"), [(name, given) for name, component in COMPONENTS.items() for given in inputs(component)]
)
def test_an_input_that_was_no_number_leaves_nothing_behind(name, given):
    """Catches a lag, a sum or a process that keeps it: one sample would spoil the rest of the flight."""
    component = COMPONENTS[name]
    run = interpret(component, **{key: GIVEN[key] for key in GIVEN.keys() & set(inputs(component))})
    run.do_step(0.0, 2.5)
    before = run.get(given)
    run.set(given, np.full_like(np.asarray(before), np.nan))
    run.do_step(run.time, 1.0)
    for bundle in (b for b in component.layout.bundles.values() if b.causality == "output" and not b.shape):
        numbers = [run.get(f"{bundle.name}.{member}") for member in bundle.members]
        if not all(np.all(np.isfinite(np.asarray(number, float))) for number in numbers):
            assert not run.get(f"{bundle.name}.valid"), bundle.name
    run.set(given, before)
    run.do_step(run.time, 10.0)
    shown = [v.name for v in component.layout.variables if v.causality == "output"]
    assert not [output for output in shown if not np.all(np.isfinite(np.asarray(run.get(output), float)))]
