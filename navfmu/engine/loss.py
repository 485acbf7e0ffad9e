"""Steps that components lose: a fault of the co-simulation and not of a signal.

While its trigger acts at t_k a component does not make the step to t_{k+1}: nothing is set or read, its outputs are
held (what other faults do to them goes on). The first step after that is a long one, from where it stands. It gets the
inputs of any other step; a smooth input goes on a straight line from its value where the component stands.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.engine.clock import Clock
from navfmu.engine.component import Component
from navfmu.engine.target import component_of
from navfmu.engine.trigger import Windows
from navfmu.faults.fault import Fault

LOSS = np.dtype([("component", np.int32), ("trigger", np.int32), ("seen", np.int64)], align=True)


@dataclass(frozen=True)
class Loss:
    """What a fault does to one component."""

    fault: Fault
    component: str
    trigger: int


def losses_of(faults: Sequence[Fault], components: Mapping[str, Component]) -> list[Loss]:
    """The lost steps of faults, by component."""
    found = []
    for number, fault in enumerate(faults):
        for target in fault.targets if fault.type == "lost_step" else ():
            component = component_of(fault, target, components)
            if not component.description.can_handle_variable_step:
                raise fault.error(
                    f"component '{target}' cannot make up for lost steps: its FMU takes no steps of another length "
                    "(canHandleVariableCommunicationStepSize)",
                    "target",
                )
            found.append(Loss(fault, target, number))
    places = {name: place for place, name in enumerate(components)}
    return sorted(found, key=lambda loss: places[loss.component])


def table(losses: Sequence[Loss], components: Sequence[str]) -> np.ndarray:
    """A row of ``LOSS`` for each."""
    return np.array([(components.index(loss.component), loss.trigger, -1) for loss in losses], LOSS)


def idle(losses: Sequence[Loss], lists: Sequence[Windows], clock: Clock) -> dict[str, str]:
    """Faults that begin too late to lose a step, by id, and why."""
    return {
        loss.fault.id: f"starts at {lists[loss.trigger][0].start:.9g} s, and no step begins there or later"
        for loss in losses
        if lists[loss.trigger] and lists[loss.trigger][0].first >= clock.steps and "mttf" not in loss.fault.parameters
    }
