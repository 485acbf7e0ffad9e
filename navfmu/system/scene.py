"""From an experiment and its recordings to what a picture or a statistic of the report file is made from."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from navfmu.report.kind import Kind
from navfmu.report.scene import Bound, Recorded, Scene, Window
from navfmu.system.experiment import Experiment
from navfmu.system.report_file import constants, units


def scene_of(
    entry: Kind,
    experiment: Experiment,
    runs: Sequence[Recorded],
    shown: Recorded,
    label: str = "",
    bounds: Sequence[Bound] = (),
) -> Scene:
    """The scene of ``runs``, all of them of one variant in one case; ``experiment`` is that of the run ``shown``."""
    return Scene(
        label=label,
        runs=tuple(runs),
        shown=shown,
        units=units(entry, experiment.system.fmus),
        windows=windows([fault.describe() for fault in experiment.faults]),
        bounds=tuple(bounds),
        constants=constants(entry, experiment.system.fmus, experiment.start_values()),
    )


def windows(faults: Sequence[Mapping[str, Any]]) -> tuple[Window, ...]:
    """When faults act, from their descriptions in a recording's provenance."""
    return tuple(
        Window(fault["id"], fault["start"], fault["start"] + fault.get("duration", math.inf)) for fault in faults
    )
