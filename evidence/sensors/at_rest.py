"""Recorded inertial units at rest beside the ``imu`` whose parameters are made of the recording.

The environment variable NAVFMU_DATA names a folder with recordings in ``sensors/``: ``flights/thor75/imu.parquet`` of a
small unmanned aircraft (50 Hz; it stands in the wind), and ``broad/*.parquet``, a hand-held unit (286 Hz; data set
BROAD, doi:10.3390/data6070072). Columns are time (s), rate_x, _y, _z (rad/s), specific_force_x, _y, _z (m/s2). They
are not part of the project.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.section import Section, left_out, recorded
from evidence.sensors.rest import COLUMNS, Rest
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page

HEADING = "Inertial units at rest"
UNITS = {"thor75": "flights/thor75/imu.parquet", "BROAD": "broad/*.parquet"}
MODELLED = 100
"""Runs of the model: an honest point is outside of all of them with a probability of 2/101."""
CLOSE = 1.1
"""Factor by which the Allan deviation of the recording may be beyond the extremes of the runs of its model."""
ROCKING = {"thor75": 0.3}
"""Averaging times below this tell of the airframe, s: in the wind it rocks about the roll axis at 7 Hz."""
TRIADS = (("gyros", slice(0, 3), "rad/s"), ("accelerometers", slice(3, 6), "m/s2"))


def run(out: Path) -> Section:
    """Find the quiet stretches, make the models, let them lie as long."""
    folder, lacking = recorded(*UNITS.values(), under="sensors")
    if lacking:
        return left_out(HEADING, lacking)
    found = {name: sorted(folder.glob(pattern)) for name, pattern in UNITS.items()}
    units = {
        name: Unit(Rest.of(name, [pd.read_parquet(file) for file in files], ROCKING.get(name, 0.0)))
        for name, files in found.items()
    }
    made = section(units)
    write_file(out / "sensors" / "at_rest.png", picture(units))
    return made


@dataclass(frozen=True)
class Unit:
    """A recording at rest, and as many runs of its model, or of that of another recording."""

    recorded: Rest
    other: Rest | None = None

    @cached_property
    def modelled(self) -> np.ndarray:
        """Allan deviations of the model's runs, (runs, times, 6)."""
        parameters = (self.other or self.recorded).parameters
        return np.array([self.recorded.modelled(seed, parameters).deviation for seed in range(1, MODELLED + 1)])

    @property
    def halves(self) -> tuple[Unit, Unit]:
        """Either half of the stretches with the model of the other half."""
        one, two = self.recorded.halves
        return Unit(one, two), Unit(two, one)

    @property
    def inside(self) -> np.ndarray:
        """Where the recording is within the extremes of the model's runs, (times, 6)."""
        recorded = self.recorded.deviation
        return (recorded >= self.modelled.min(axis=0)) & (recorded <= self.modelled.max(axis=0))

    @property
    def missed(self) -> np.ndarray:
        """The factor by which the recording is beyond the extremes of the model's runs, where it tells of the unit."""
        recorded = self.recorded.deviation
        beyond = np.maximum(recorded / self.modelled.max(axis=0), self.modelled.min(axis=0) / recorded)
        return np.maximum(beyond, 1.0)[self.recorded.told]

    @property
    def claim(self) -> Claim:
        """That the model is close wherever chance does not explain the difference."""
        name, times = self.recorded.name, self.recorded.times[self.recorded.told]
        return Claim(
            f"{name}: the model has the Allan deviation of the recording, {times[0]:.2g} to {times[-1]:.2g} s, "
            f"within a factor of the extremes of {MODELLED} runs",
            float(self.missed.max()), CLOSE, False,
            opposite=f"{name}: the model misses the Allan deviation of the recording",
        )  # fmt: skip


def section(units: Mapping[str, Unit]) -> Section:
    """Claims, the picture, and the parameters that were found."""
    claims = [unit.claim for unit in units.values()]

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        for unit in units.values():
            rest, inside = unit.recorded, 100 * np.mean(unit.inside[unit.recorded.told])
            page.text(
                f"{rest.name}: {len(rest.stretches)} quiet stretches, {rest.seconds:.0f} s in all, at "
                f"{1.0 / rest.period:.4g} Hz. {inside:.0f} % of the points lie within the extremes of "
                f"{MODELLED} runs of the model (of an honest model 98 %). {elsewhere(unit)}"
            )
        page.picture(picture(units), "Allan deviations of recorded units at rest and of their models")
        page.table(
            ["unit", "axis", "noise per sample", "per root second", "drift, 1 sigma", "correlation time, s", "unit of"],
            [row for unit in units.values() for row in _rows(unit.recorded)],
        )
        page.text("What navfmu allan tells of the same stretches, with intervals of 95 %:")
        page.table(
            ["unit", "sensor", "term", "x", "y", "z", "unit of"],
            [row for unit in units.values() for row in _identified(unit.recorded)],
        )

    return Section(claims, write)


def elsewhere(unit: Unit) -> str:
    """What a model made of half of the stretches is worth for the other half."""
    halves = unit.halves
    inside = [100.0 * np.mean(half.inside[half.recorded.told]) for half in halves]
    missed = 100.0 * (max(half.missed.max() for half in halves) - 1.0)
    return (
        f"Of models made of one half of the stretches, the runs contain {min(inside):.0f} and {max(inside):.0f} % of "
        f"the points of the other half, which are {missed:.0f} % beyond the extremes at most."
    )


def picture(units: Mapping[str, Unit]) -> bytes:
    """A row for each unit: gyros and accelerometers."""
    from matplotlib.ticker import NullFormatter

    with figure(len(units), 2, size=(11.0, 3.9 * len(units)), left=0.85) as (drawing, axes):
        for row, (name, unit) in zip(np.atleast_2d(axes), units.items(), strict=True):
            times = unit.recorded.times
            for ax, (triad, columns, symbol) in zip(row, TRIADS, strict=True):
                for number, colour in zip(range(columns.start, columns.stop), COLOURS, strict=False):
                    band = unit.modelled[:, :, number]
                    ax.fill_between(times, band.min(axis=0), band.max(axis=0), color=colour, alpha=0.25, lw=0)
                    ax.loglog(times, unit.recorded.deviation[:, number], "o-", color=colour, ms=3, lw=1,
                              label=COLUMNS[number].rsplit("_", 1)[1])  # fmt: skip
                if unit.recorded.shortest:
                    ax.axvspan(times[0], unit.recorded.shortest, color=GREY, alpha=0.15, lw=0, label="airframe rocks")
                ax.set_title(f"{name}, {triad}: {title(unit, columns)}")
                ax.yaxis.set_minor_formatter(NullFormatter())
                ax.set_xlabel("averaging time, s")
                ax.set_ylabel(f"Allan deviation, {symbol}")
                ax.legend(title=f"recorded; shaded: {MODELLED} runs of imu", ncols=4)
        return png(drawing)


def title(unit: Unit, columns: slice) -> str:
    """What to see in one panel."""
    if np.mean(unit.inside[unit.recorded.told, columns]) >= 0.9:
        return "as its model"
    missed = float(unit.missed[:, columns].max())
    if missed <= CLOSE:
        return f"within a factor of {missed:.3g} of its model"
    return f"its model is off by a factor of {missed:.3g}"


def _rows(rest: Rest) -> list[list[str]]:
    rows = []
    for name, (_, columns, symbol) in zip(("gyro", "accelerometer"), TRIADS, strict=True):
        noise, drift = (np.broadcast_to(rest.parameters[f"{name}_{kind}_sigma"], 3) for kind in ("noise", "drift"))
        time = rest.parameters[f"{name}_drift_time"]
        for axis, n, d in zip(COLUMNS[columns], noise, drift, strict=True):
            root = n * np.sqrt(rest.period)
            rows.append([rest.name, axis, f"{n:.3g}", f"{root:.3g}", f"{d:.2g}", f"{time:.2g}", symbol])
    return rows


def _identified(rest: Rest) -> list[list[str]]:
    rows = []
    for sensor, one in rest.identified.items():
        for term, *numbers in zip(one.terms, one.coefficients, one.low, one.high, strict=True):
            unit, factor = sensor.shown[term]
            cells = [
                f"{factor * v:.3g} ({factor * a:.3g} to {factor * b:.3g})" for v, a, b in zip(*numbers, strict=True)
            ]
            rows.append([rest.name, sensor.quantity, term.name, *cells, unit])
    return rows
