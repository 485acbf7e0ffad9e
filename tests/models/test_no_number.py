"""What comes in and is no number: sensors show it while it is there, and nothing of it is kept."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.constants import STANDARD_GRAVITY
from tests.built import components
from tests.models.made_signals import Place, signals
from tests.models.native import interpret

COMPONENTS = {name: c for name, c in components().items() if any(v.causality == "input" for v in c.layout.variables)}
GIVEN = {"latitude": 0.66, "longitude": -2.1, "altitude": 1500.0, "velocity_n": (46.0, 1.0, 0.5)}


def inputs(component) -> list[str]:
    return [v.name for v in component.layout.variables if v.causality == "input" and v.type == "Real"]


def bundles(component, causality) -> list:
    return [b for b in component.layout.bundles.values() if b.causality == causality and not b.shape]


def finite(numbers) -> bool:
    return bool(np.all(np.isfinite(np.asarray(numbers, float))))


def all_finite(run, component) -> bool:
    """Whether all outputs are numbers."""
    return all(finite(run.get(v.name)) for v in component.layout.variables if v.causality == "output")


def said_valid(run, component) -> set[str]:
    """Bundles that say they are valid; a valid one has numbers only, or this fails."""
    valid = {bundle.name for bundle in bundles(component, "output") if run.get(f"{bundle.name}.valid")}
    for name in valid:
        assert all(finite(run.get(f"{name}.{member}")) for member in component.layout.bundles[name].members), name
    return valid


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
    said_valid(run, component)
    run.set(given, before)
    run.do_step(run.time, 10.0)
    assert all_finite(run, component)


# --- samples that say they are valid ---------------------------------------------------------------------------------

STEP = 0.5
"""A new sample of each bundle comes after so many seconds."""
SAMPLES = {
    "rate": np.zeros(3),
    "specific_force": np.array([0.0, 0.0, -STANDARD_GRAVITY]),
    "field_b": np.array([2.2e-5, 0.5e-5, 4.2e-5]),
    "true_airspeed": 46.0,
    "true_airspeed_sigma": 2.0,
    "pressure_altitude": 1500.0,
    "heading_sigma": 0.02,
    "slant_range": 3.0e4,
    "measured": True,
    "height": 1500.0,
    **GIVEN,
    **{name.removeprefix("signals."): value for name, value in signals(Place(), 10).items() if "." in name},
}
"""What a member is in level flight, the same for all bundles; 0 if it is not here."""
JUDGES = {"evaluation"}
"""They show what they judge: an error that is no number is one."""
MEMBERS = [
    (name, f"{bundle.name}.{member}")
    for name, component in COMPONENTS.items()
    if name not in JUDGES
    for bundle in bundles(component, "input")
    for member in bundle.members
    if component.layout.fields[f"{bundle.name}.{member}"].type == "Real"
]


class Fed:
    """A component whose bundles all have a new, valid sample in each step."""

    def __init__(self, component) -> None:
        self.component, self.count = component, 0
        quick = {"sample_period", "update_period", "tick_period"} & component.layout.fields.keys()
        self.run = interpret(component, **dict.fromkeys(quick, 0.1))

    def step(self, spoilt: str = "", value: float = 0.0) -> set[str]:
        """One step, in which the first element of ``spoilt`` is ``value``; returns which bundles say they are valid."""
        time = self.count * STEP
        self.count += 1
        for bundle in bundles(self.component, "input"):
            for member in bundle.members:
                name = f"{bundle.name}.{member}"
                numbers = np.array(np.broadcast_to(SAMPLES.get(member, 0.0), np.shape(self.run.get(name))))
                if member == "seconds":
                    numbers = numbers + time
                if name == spoilt:
                    numbers.flat[0] = value
                self.run.set(name, numbers if numbers.shape else numbers.item())
            self.run.set(f"{bundle.name}.valid", True)
            self.run.set(f"{bundle.name}.sequence", self.count)
            self.run.set(f"{bundle.name}.time_of_validity", time)
        with np.errstate(invalid="ignore"):
            self.run.do_step(time, STEP)
        return said_valid(self.run, self.component)


@pytest.mark.parametrize(("name", "member"), MEMBERS)
def test_a_valid_sample_that_is_no_number_is_none(name, member):
    """What was valid is so again with the next sample, and all outputs are numbers.

    Catches a filter that takes the sample in and loses what it has learned, or its solution for the rest of the flight,
    and one that passes it on and calls it valid.
    """
    fed = Fed(COMPONENTS[name])
    for _ in range(6):
        before = fed.step()
    for value in (np.nan, np.inf):
        fed.step(member, value)
    assert fed.step() >= before
    for _ in range(9):
        after = fed.step()
    assert after >= before
    assert all_finite(fed.run, fed.component)


def test_samples_are_such_that_components_have_something_to_lose():
    """All that the test above feeds are valid by then, but those that wait for more than three seconds."""
    dull = set()
    for name in {name for name, _ in MEMBERS}:
        fed = Fed(COMPONENTS[name])
        valid = [fed.step() for _ in range(6)][-1]
        if not valid:
            dull.add(name)
    assert dull <= {"gps_sequencer"}
