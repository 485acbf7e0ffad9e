"""A signal over time in all runs: median, 5th to 95th percentile, extremes, and the bounds of requirements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import cycle
from typing import Any, ClassVar, Literal

import numpy as np

from navfmu.files.schema import Field
from navfmu.report import shading
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.finite import drawn, extremes, remark
from navfmu.report.kind import Picture as Base
from navfmu.report.panel import Curve, Panel, constant
from navfmu.report.scene import Bound, Drawn, Scene, early, readable, whole, with_unit, words

LEGEND = 0.19  # inch for each row of the legend
COLUMNS = 4


class Picture(Base):
    """A signal over time in all runs, with the bounds that requirements put on it."""

    many: ClassVar[bool] = True
    kind: Literal["percentiles"]
    signal: str = Field(description="the signal")

    def needs(self) -> list[str]:
        return [self.signal]

    def words(self) -> str:
        """What the curve and the axis are called."""
        return words(self.signal)

    def draw(self, scene: Scene) -> Drawn:
        runs = whole(scene.runs)
        time, values = runs[0].time, np.stack([run[self.signal] for run in runs])
        unit, missing = scene.unit(self.signal), remark(run[self.signal] for run in scene.runs)
        least, greatest = extremes(values)
        many = len(scene.runs) > 1
        text = f"{self.signal}, {f'{len(scene.runs)} runs' if many else scene.runs[0].name}"
        text += f", {with_unit(f'{readable(least)} to {readable(greatest)}', unit)}" if math.isfinite(least) else ""
        ended = early(scene.runs)
        heading = scene.titled(text + "".join(f"; {said.upper()}" for said in (missing, ended) if said))
        bounds = _distinct([bound for bound in scene.bounds if bound.signal == self.signal])
        entries = (4 if many else 1) + len(bounds)
        below = 0.1 + LEGEND * math.ceil(entries / COLUMNS)
        above = shading.height(scene.windows)
        with figure(size=(9.0, 3.75 + below + above), below=below, above=above, left=0.9) as (drawing, axis):
            if many:
                self._spread(axis, time, drawn(values))
            else:
                axis.plot(time, drawn(values[0]), color=COLOURS[0], label=scene.runs[0].name)
            if missing:
                bad = np.unique(np.concatenate([run.time[~np.isfinite(run[self.signal])] for run in scene.runs]))
                label = "not finite in a run" if many else "not finite"
                axis.plot(bad, np.zeros(bad.size), "|", color="red", transform=axis.get_xaxis_transform(), label=label)
            for colour, (text, level, start, end) in zip(cycle(COLOURS[1:]), bounds, strict=False):
                span = [max(start, time[0]), min(end, time[-1])] if start <= time[-1] else [math.nan] * 2
                axis.plot(span, [level, level], "--", color=colour, linewidth=1.2, label=text)
            pad = shading.shade(drawing, [axis], scene.windows, time[0], time[-1])
            title(drawing, axis, heading, pad)
            axis.set_xlabel("time, s")
            axis.set_ylabel(f"{self.words()}, {unit or '1'}")
            if time[-1] > time[0]:
                axis.set_xlim(time[0], time[-1])
            axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=COLUMNS)
            return Drawn(png(drawing), heading, self._caption(scene, values, unit, missing, ended))

    def panels(self, scene: Scene) -> list[Panel]:
        run, unit = scene.shown, scene.unit(self.signal)
        least, greatest = extremes(run[self.signal])
        range_ = f": {with_unit(f'{readable(least)} to {readable(greatest)}', unit)}" if math.isfinite(least) else ""
        said = "".join(f"; {text.upper()}" for text in (remark([run[self.signal]]), early([run])) if text)
        look = "line" if run.signals[self.signal].dtype.kind == "f" else "steps"
        curves = [Curve(self.words(), run.time, run[self.signal], look, COLOURS[0], peaks=True)]
        bounds = _distinct([bound for bound in scene.bounds if bound.signal == self.signal])
        for colour, (text, level, start, end) in zip(cycle(COLOURS[1:]), bounds, strict=False):
            if start <= run.points[-1]:
                curves.append(constant(text, level, max(start, run.points[0]), min(end, run.points[-1]), colour))
        axis = f"{self.words()}, {unit or '1'}"
        return [Panel(f"{self.signal}{range_}{said}", "time, s", axis, tuple(curves))]

    def _spread(self, axis: Any, time: np.ndarray, values: np.ndarray) -> None:
        """Percentiles are runs that were flown, at or beyond the share: nothing between two runs is made up."""
        low, middle, high = (
            quantile(values, q, method) for q, method in ((0.05, "lower"), (0.5, "higher"), (0.95, "higher"))
        )
        axis.fill_between(time, low, high, color=COLOURS[0], alpha=0.25, linewidth=0, label="5th to 95th percentile")
        axis.plot(time, middle, color=COLOURS[0], label="median")
        for q, name in ((0.0, "least and greatest"), (1.0, None)):
            axis.plot(time, quantile(values, q, "higher"), color=COLOURS[0], linewidth=0.7, linestyle=":", label=name)

    def _caption(self, scene: Scene, values: np.ndarray, unit: str, missing: str, ended: str) -> str:
        text = f"{self.signal} of {'one run' if len(scene.runs) == 1 else f'{len(scene.runs)} runs'}"
        if len(scene.runs) > 1:
            text += ": median, 5th to 95th percentile, the least and the greatest at each time"
        finite = np.where(np.isfinite(values), values, -np.inf)
        run, point = np.unravel_index(np.argmax(finite), finite.shape)
        if np.isfinite(finite[run, point]):
            value = with_unit(readable(values[run, point]), unit)
            text += f"; greatest: {value} at t = {scene.runs[run].time[point]:g} s, {scene.runs[run].name}"
        text += f". The signal is {missing}; these are left out of the curves" if missing else ""
        if ended:
            text += f". {ended}: it counts up to there" if len(scene.runs) > 1 else f". The run {ended}"
        return f"{text}."


def quantile(values: np.ndarray, q: float, method: str) -> np.ndarray:
    """Over the runs (axis 0) at each time, of the finite values; NaN where there is none."""
    if np.isfinite(values).all():
        return np.quantile(values, q, axis=0, method=method)
    found = np.full(values.shape[1], np.nan)
    for count in range(1, len(values) + 1):  # times at which as many runs are finite have their finite values on top
        times = np.isfinite(values).sum(axis=0) == count
        ordered = np.sort(np.where(np.isfinite(values[:, times]), values[:, times], np.inf), axis=0)[:count]
        found[times] = np.quantile(ordered, q, axis=0, method=method) if times.any() else np.nan
    return found


def _distinct(bounds: Sequence[Bound]) -> list[tuple[str, float, float, float]]:
    """Lines to draw, each once: text, level, start and end; requirements with the same line share it."""
    lines: dict[tuple[float, float, float, str], list[str]] = {}
    for bound in bounds:
        for level in (bound.most, bound.least):
            if level is not None:
                names = lines.setdefault((level, bound.start, bound.end, bound.unit), [])
                names += [bound.name] if bound.name not in names else []
    return [
        (f"{', '.join(names)}: {with_unit(readable(level), unit)}", level, start, end)
        for (level, start, end, unit), names in lines.items()
    ]
