"""Errors against the standard deviation that an estimator claims for them, one panel each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np

from navfmu.files.schema import Field, Number, Table
from navfmu.report import shading
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.finite import drawn, remark
from navfmu.report.kind import Picture as Base
from navfmu.report.kind import same_unit
from navfmu.report.panel import Curve, Panel
from navfmu.report.scene import Drawn, Recorded, Scene, early

PANEL = 2.25  # inch


class Axis(Table):
    """An error and the standard deviation that is claimed for it."""

    name: str = Field(description="what the error is of, for example 'north'")
    error: str = Field(description="the signal of the error")
    sigma: str = Field(description="the signal of its claimed standard deviation, in the same unit")

    def inside(self, run: Recorded, factor: float) -> np.ndarray:
        """At which points the error is within ``factor`` sigma; what is not finite is not inside."""
        error, sigma = run[self.error], run[self.sigma]
        return np.isfinite(error) & np.isfinite(sigma) & (np.abs(error) <= factor * sigma)


class Picture(Base):
    """Errors over time against k times the sigma that is claimed, with the share of all runs that is inside."""

    many: ClassVar[bool] = True
    kind: Literal["sigma"]
    axes: list[Axis] = Field(min_length=1, description="errors and their sigmas, one panel each")
    valid: str | None = Field(None, description="points count where this signal is not 0; default: all")
    factor: Number = Field(3, gt=0, allow_inf_nan=False, description="how many sigmas are drawn; default 3")

    def needs(self) -> list[str]:
        names = [name for axis in self.axes for name in (axis.error, axis.sigma)]
        return names + ([self.valid] if self.valid else [])

    def check(self, units: Mapping[str, str]) -> None:
        for axis in self.axes:
            same_unit(units, axis.error, axis.sigma)

    def draw(self, scene: Scene) -> Drawn:
        time, points, count = scene.shown.time, scene.shown.points, len(self.axes)
        above = shading.height(scene.windows)
        size = (9.0, 0.85 + PANEL * count + above)
        sentences = []
        with figure(count, 1, size=size, above=above, left=0.95, sharex=True, squeeze=False) as (drawing, grid):
            panels = list(grid[:, 0])
            pad = shading.shade(drawing, panels, scene.windows, points[0], points[-1])
            for panel, axis in zip(panels, self.axes, strict=True):
                error, bound = drawn(scene.shown[axis.error]), drawn(self.factor * scene.shown[axis.sigma])
                claimed = f"{self.factor:g} sigma claimed"
                panel.fill_between(time, -bound, bound, color=COLOURS[2], alpha=0.2, linewidth=0, label=claimed)
                panel.plot(time, error, color=COLOURS[1], linewidth=1.0, label=f"{axis.name} error")
                sentences.append(self._sentence(axis, scene.runs))
                title(drawing, panel, scene.titled(sentences[-1]), pad if panel is panels[0] else 6.0)
                panel.set_ylabel(f"{axis.name} error, {scene.unit(axis.error) or '1'}")
                panel.legend(fontsize=8, loc="upper left", ncols=2)
                reach = _reach(error, bound)
                panel.set_ylim(-1.15 * reach, 1.4 * reach)
            panels[-1].set_xlabel(f"time, s   ({scene.shown.name})")
            if points[-1] > points[0]:
                panels[-1].set_xlim(points[0], points[-1])
            text = "; ".join(sentences)
            image = png(drawing)
        shown = f"Curves of {scene.shown.name}; the shares count all runs. " if len(scene.runs) > 1 else ""
        left_out = f" Points count where {self.valid} is not 0." if self.valid else ""
        if ended := early(scene.runs):
            left_out += f" {ended if len(scene.runs) > 1 else f'The run {ended}'}; what was not reached does not count."
        return Drawn(image, scene.titled(text), f"{shown}What is not a finite number counts as outside.{left_out}")

    def panels(self, scene: Scene) -> list[Panel]:
        run = scene.shown
        ended = f"; {said.upper()}" if (said := early([run])) else ""
        return [
            Panel(
                self._sentence(axis, [run]) + ended,
                "time, s",
                f"{axis.name} error, {scene.unit(axis.error) or '1'}",
                (
                    Curve(
                        f"{self.factor:g} sigma claimed", run.time, self.factor * run[axis.sigma], "band", COLOURS[2]
                    ),
                    Curve(f"{axis.name} error", run.time, run[axis.error], "line", COLOURS[1], peaks=True),
                ),
            )
            for axis in self.axes
        ]

    def _sentence(self, axis: Axis, runs: Sequence[Recorded]) -> str:
        """What the data says: "north error inside 3 sigma for 99.8 % of 8400 points of 4 runs"."""
        counted = [run[self.valid] != 0 if self.valid else np.ones(run.time.size, bool) for run in runs]
        total = sum(int(np.count_nonzero(points)) for points in counted)
        of = f"{len(runs)} runs" if len(runs) > 1 else runs[0].name
        if total == 0:
            return f"{axis.name} error: no valid point in {of}"
        inside = sum(
            int(np.count_nonzero(axis.inside(run, self.factor) & points))
            for run, points in zip(runs, counted, strict=True)
        )
        missing = remark(
            np.where(np.isfinite(run[axis.sigma]), run[axis.error], np.nan)[points]
            for run, points in zip(runs, counted, strict=True)
        )
        share = f"inside {self.factor:g} sigma for {100 * inside / total:.1f} % of {total} points of {of}"
        return f"{axis.name} error {share}{f', {missing.upper()}' if missing else ''}"


def _reach(error: np.ndarray, bound: np.ndarray) -> float:
    """Half the height of a panel: all finite errors, and the bound but for its highest 2 %."""
    errors, bounds = np.abs(error[np.isfinite(error)]), bound[np.isfinite(bound)]
    reach = max(float(errors.max()) if errors.size else 0.0, float(np.quantile(bounds, 0.98)) if bounds.size else 0.0)
    return reach if reach > 0.0 else 1.0
