"""From an experiment and its recordings to what a picture or a statistic of the report file is made from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from navfmu.report.kind import Kind
from navfmu.report.scene import Bound, Recorded, Scene, Window
from navfmu.system.experiment import Experiment
from navfmu.system.report_file import constants, units

Acted = Mapping[str, Sequence[Sequence[float]]]  # by the id of a fault, from when to when it acted (s)


def scene_of(
    entry: Kind,
    experiment: Experiment,
    runs: Sequence[Recorded],
    shown: Recorded,
    acted: Sequence[Acted],
    label: str = "",
    bounds: Sequence[Bound] = (),
) -> Scene:
    """The scene of ``runs``, all of them of one variant in one case; ``experiment`` is that of the run ``shown``.

    ``acted`` has for each run from when to when each fault acted (s).
    """
    return Scene(
        label=label,
        runs=tuple(runs),
        shown=shown,
        units=units(entry, experiment.system.fmus),
        windows=windows(acted),
        bounds=tuple(bounds),
        constants=constants(entry, experiment.system.fmus, experiment.start_values()),
    )


def windows(acted: Sequence[Acted]) -> tuple[Window, ...]:
    """When faults acted in some runs: where that differs, the times at which they did in any of them."""
    found = []
    for fault in dict.fromkeys(name for one in acted for name in one):
        spans = {tuple((begin, end) for begin, end in one.get(fault, ())) for one in acted}
        if len(spans) == 1:
            found.append(Window(fault, *spans))
            continue
        every = _joined(span for one in spans for span in one)
        found.append(Window(f"{fault} (in each run at another time)", every))
    return tuple(found)


def _joined(spans: Iterable[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The times that lie in any of some spans."""
    found: list[tuple[float, float]] = []
    for begin, end in sorted(spans):
        if found and begin <= found[-1][1]:
            begin, end = found[-1][0], max(found.pop()[1], end)
        found.append((begin, end))
    return tuple(found)
