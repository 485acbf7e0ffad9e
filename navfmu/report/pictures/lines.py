"""Signals of one run over time: a panel for each unit, every curve named."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.files.schema import Field
from navfmu.report import shading
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.finite import drawn, remark
from navfmu.report.kind import Picture as Base
from navfmu.report.panel import Curve, Panel
from navfmu.report.scene import Drawn, Scene, early, with_unit

STYLES = ("-", "--")
CURVES = len(STYLES) * len(COLOURS)  # in a panel; more would look alike
PANELS = 40
BOOLEAN = "false or true"
WHOLE = "whole number"  # counters and modes keep apart from shares
ENTRY = 0.165  # inch for each line of a legend
LETTER = 0.062  # inch, in a legend


class Picture(Base):
    """Signals of one run over time, one panel for each unit."""

    kind: Literal["lines"]
    signals: list[str] = Field(min_length=1, description="the signals")

    def needs(self) -> list[str]:
        return list(self.signals)

    def draw(self, scene: Scene) -> Drawn:
        text = ", ".join(self.signals) if len(self.signals) <= 3 else f"{len(self.signals)} signals"
        heading = scene.titled(f"{text}, {scene.shown.name}" if scene.shown.name else text)
        missing = [name for name in self.signals if not np.isfinite(scene.shown[name]).all()]
        said = [f"Not finite at some points: {', '.join(missing)}."] if missing else []
        said += [f"The run {ended}."] if (ended := early([scene.shown])) else []
        return Drawn(draw(scene, self.signals, heading), heading, " ".join(said))

    def panels(self, scene: Scene) -> list[Panel]:
        run, found = scene.shown, []
        for unit, names in arrange(scene, self.signals):
            curves = tuple(
                Curve(
                    _label(scene, name).replace("\n", ", "),
                    run.time,
                    run[name],
                    "line" if run.signals[name].dtype.kind == "f" else "steps",
                    COLOURS[number % len(COLOURS)],
                )
                for number, name in enumerate(names)
            )
            title = ", ".join(names) if len(names) <= 3 else f"{len(names)} signals"
            found.append(Panel(title, "time, s", unit, curves))
        return found


def draw(scene: Scene, signals: Sequence[str], heading: str) -> bytes:
    """The picture of the shown run as PNG."""
    run, panels = scene.shown, arrange(scene, signals)
    labels = {name: _label(scene, name) for name in signals}
    rows = [sum(1 + labels[name].count("\n") for name in names) for _, names in panels]
    heights = [
        max(0.7 if unit == BOOLEAN else 1.7, 0.2 + ENTRY * count) for (unit, _), count in zip(panels, rows, strict=True)
    ]
    right = 0.75 + LETTER * max(len(line) for label in labels.values() for line in label.split("\n"))
    above = shading.height(scene.windows)
    size = (7.9 + right, 0.85 + above + sum(heights) + 0.3 * (len(heights) - 1))
    options = {"sharex": True, "squeeze": False, "gridspec_kw": {"height_ratios": heights}}
    with figure(len(panels), 1, size=size, above=above, left=0.95, right=right, **options) as (drawing, grid):
        axes = list(grid[:, 0])
        for axis, (unit, names) in zip(axes, panels, strict=True):
            for number, name in enumerate(names):
                style = STYLES[number // len(COLOURS)]
                draws = "default" if run.signals[name].dtype.kind == "f" else "steps-post"
                colour = COLOURS[number % len(COLOURS)]
                width = 1.0 + (2.0 if unit == BOOLEAN else 1.0) * (len(names) - 1 - number) / len(names)  # none hides
                axis.plot(
                    run.time, drawn(run[name]), style, color=colour, lw=width, drawstyle=draws, label=labels[name]
                )
                bad = run.time[~np.isfinite(run[name])]
                axis.plot(bad, np.zeros(bad.size), "|", color="red", transform=axis.get_xaxis_transform())
            if unit == BOOLEAN:
                axis.set_yticks([0, 1], ["false", "true"])
            else:
                axis.set_ylabel(unit)
            axis.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.005, 1.03), borderaxespad=0.0)
        pad = shading.shade(drawing, axes, scene.windows, run.points[0], run.points[-1])
        title(drawing, axes[0], heading, pad)
        axes[-1].set_xlabel("time, s")
        if run.points[-1] > run.points[0]:
            axes[-1].set_xlim(run.points[0], run.points[-1])
        return png(drawing)


def arrange(scene: Scene, signals: Sequence[str]) -> list[tuple[str, list[str]]]:
    """The text on the axis and the signals of each panel: by unit, in the order in which they are named."""
    units: dict[str, list[str]] = {}
    for name in dict.fromkeys(signals):
        kind = scene.shown.signals[name].dtype.kind
        unit = scene.unit(name) or (WHOLE if kind in "iu" else "1")
        units.setdefault(BOOLEAN if kind == "b" else unit, []).append(name)
    panels = []
    for unit, names in units.items():
        size = math.ceil(len(names) / math.ceil(len(names) / CURVES))
        panels += [(unit, names[at : at + size]) for at in range(0, len(names), size)]
    if len(panels) > PANELS:
        raise NavfmuError(f"{len(signals)} signals need {len(panels)} panels, expected at most {PANELS}; name fewer")
    return panels


def _label(scene: Scene, name: str) -> str:
    """The entry of a legend; of a curve that is flat, or not all there, it says so."""
    values, missing = scene.shown[name], remark([scene.shown[name]])
    if missing:
        return f"{name}\n{missing.upper()}"
    if scene.shown.signals[name].dtype.kind != "b" and values.size and np.all(values == values[0]):
        return f"{name} (always {with_unit(f'{values[0]:.6g}', scene.unit(name))})"
    return name
