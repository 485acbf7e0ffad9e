"""The value of a requirement's expression over time: it is not recorded, but made from the signals that are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from navfmu.files.schema import Field
from navfmu.report.panel import Panel
from navfmu.report.pictures import percentiles
from navfmu.report.scene import Drawn, Recorded, Scene


class Picture(percentiles.Picture):
    """The value in all runs, with the bounds that requirements put on it; ``signal`` is the expression."""

    requirement: Any = Field(exclude=True, description="one of those that ask for it")

    def needs(self) -> list[str]:
        return self.requirement.signals

    def words(self) -> str:
        return "value"

    def draw(self, scene: Scene) -> Drawn:
        return super().draw(self._valued(scene))

    def panels(self, scene: Scene) -> list[Panel]:
        return super().panels(self._valued(scene))

    def _valued(self, scene: Scene) -> Scene:
        """With a signal that is called like the expression."""
        runs = {id(run): self._with_value(run) for run in (*scene.runs, scene.shown)}
        return replace(
            scene,
            runs=tuple(runs[id(run)] for run in scene.runs),
            shown=runs[id(scene.shown)],
            units={**scene.units, self.signal: self.requirement.unit},
        )

    def _with_value(self, run: Recorded) -> Recorded:
        series = {name: run[name] for name in self.needs()}
        value = self.requirement.values({**series, "time": run.time})
        return replace(run, signals={**run.signals, self.signal: value})
