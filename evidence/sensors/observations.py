"""A recorded day of observations as an FMU, solved by ``gps_solver`` in the master, beside an independent solution."""

from __future__ import annotations

import dataclasses
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from evidence.section import Section, left_out, recorded
from evidence.sensors import independent
from evidence.sensors.independent import (
    NEEDED,
    ON,
    Independent,
    accurate,
    discovered,
    excluded,
    levels,
    missed,
    protected,
)
from evidence.sensors.observed import FILES, KLOBUCHAR_OFF, TROPOSPHERE_OFF, errors, rms
from navfmu import Fault, System
from navfmu.files.writing import write_file
from navfmu.recorded.observations.imported import Imported
from navfmu.recorded.observations.importer import import_observations
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.satellite.orbits import COLUMNS
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped

HEADING = "Recorded observations as an FMU"
BOUNDS = {"ours": "hpl_we_wgt", "ours_vertical": "vpl_we_wgt"}
"""Protection levels, ours and theirs."""
TICK = 1.0
"""s, of the FMUs and the master; epochs come every 30 s."""
ROUNDED = 2e-3
"""m: how the independent solution's places are rounded, in three axes."""
RECORD = ["solver", "observations.satellites", "observations.signals.number"]


def run(out: Path) -> Section:
    """Fly the day, spoil it, compare and draw."""
    gnss, lacking = recorded(*NEEDED, under="gnss")
    if lacking:
        return left_out(HEADING, lacking)
    with tempfile.TemporaryDirectory(prefix="navfmu-") as scratch:
        day = Day(gnss, Path(scratch))
        made = section(day)
        write_file(out / "sensors" / "observations.png", picture(day, made.claims))
    return made


@dataclass(frozen=True)
class Day:
    """A day of a station, each part flown when it is first asked for; FMUs are written to ``scratch``."""

    folder: Path
    scratch: Path

    @cached_property
    def imported(self) -> Imported:
        files = [self.folder / name for name in FILES]
        return import_observations(files[0], [files[1]], shipped.path("observations_replay.fmu"))

    def fly(
        self, imported: Imported | None = None, faults: Sequence[Fault] = (), future: bool = True, **solver: Any
    ) -> dict[str, np.ndarray]:
        """Outputs of both FMUs by name, a row for each epoch that was solved."""
        found = imported or self.imported
        parts, system = self.scratch / "parts", self.scratch / "system"
        parts.mkdir(exist_ok=True)
        found.write(parts / "observations.fmu")
        (parts / "gps_solver.fmu").write_bytes(shipped.path("gps_solver.fmu").read_bytes())
        source = SystemSource("day", fmus=parts, stop_time=TICK * np.ceil(found.duration / TICK + 1.0), step=TICK)
        source.component("observations", "observations.fmu").component("solver", "gps_solver.fmu")
        source.connect("observations.signals", "solver.signals")
        alpha, beta = found.orbits.ionosphere
        given = {"ionosphere_alpha": alpha.tolist(), "ionosphere_beta": beta.tolist(), "tick_period": TICK} | solver
        source.parameters("solver", given).parameters("observations", {"tick_period": TICK, "future": future})
        source.write(system)
        result = System.load(system).run(record=RECORD, record_period=TICK, faults=list(faults))
        result = result[np.diff(result["solver.fix.sequence"], prepend=0) > 0]
        return {name.removeprefix("solver."): values for name, values in _gathered(result).items()}

    @cached_property
    def independent(self) -> Independent:
        return Independent(self.folder)

    @cached_property
    def whole(self) -> dict[str, np.ndarray]:
        return self.fly()

    @cached_property
    def errors(self) -> np.ndarray:
        return errors(self.whole)

    def rows(self, seconds: Any) -> np.ndarray:
        """Which epochs have these seconds of the week."""
        return np.searchsorted(self.imported.epochs.second, np.asarray(seconds, float) - 1e-3)

    @property
    def apart(self) -> np.ndarray:
        """How far each position is from the independent one, m."""
        return np.linalg.norm(self.errors - self.independent.errors(), axis=1)

    @property
    def same(self) -> Claim:
        """But where the two pick satellites at the mask differently."""
        return Claim(
            "99 of 100 positions are those of the independent solution, which is rounded to 1 mm, within",
            1e3 * float(np.quantile(self.apart, 0.99)), 1e3 * ROUNDED, False, "mm",
            "Positions are not those of the independent solution",
        )  # fmt: skip

    @cached_property
    def spoilt(self) -> pd.DataFrame:
        """Rms errors with something left out of the tables or of the solver, every 5 min; ours and theirs."""
        o, e = self.imported.orbits, self.imported.epochs
        delay = np.array([name != "group_delay" for name, _ in COLUMNS])
        no_delay = dataclasses.replace(self.imported, orbits=dataclasses.replace(o, rows=o.rows * delay))
        late = dataclasses.replace(self.imported, epochs=dataclasses.replace(e, second=e.second + 18.0))
        flights = {
            "full model": {},
            "no TGD": {"imported": no_delay},
            "no ionosphere": {"ionosphere": KLOBUCHAR_OFF},
            "no troposphere": {"troposphere": TROPOSPHERE_OFF},
            "time tag taken as UTC (18 leap seconds added)": {"imported": late},
        }
        rows = self.rows(self.independent.protected["tow_s"])
        return self.independent.beside({name: errors(self.fly(**given, **ON))[rows] for name, given in flights.items()})

    @cached_property
    def cases(self) -> pd.DataFrame:
        """One satellite with a bias, as a fault of the FMU: a flight for each size."""
        cases = self.independent.biased
        parts = []
        for bias, some in cases.groupby("bias_m"):
            faults = [
                Fault(
                    f"case_{k}", "observations.range_step", "input",
                    value=(bias * (np.arange(1, 33) == case.biased_prn)).tolist(),
                    start=case.tow_s - self.imported.epochs.second[0], duration=2.0 * TICK,
                )
                for k, case in enumerate(some.itertuples())
            ]  # fmt: skip
            # the fault of t = 0 acts on the step from there on, in which that epoch comes; others begin a step before
            faults = [dataclasses.replace(f, start=max(f.start - TICK, 0.0)) for f in faults] if bias else []
            found, rows = self.fly(faults=faults, false_alarm=1e-5), self.rows(some["tow_s"])
            number = found["observations.signals.number"][rows]
            parts.append(
                some.assign(
                    ours=found["squares"][rows],
                    ours_excluded=excluded(found["excluded"][rows] > 0, number),
                    ours_threshold=found["threshold"][rows],
                    alarm=found["alarm"][rows] > 0,
                )
            )
        return pd.concat(parts)

    @cached_property
    def levels(self) -> pd.DataFrame:
        known = self.independent.protected
        return levels(self.whole, self.rows(known["tow_s"]), known)

    @cached_property
    def heard(self) -> np.ndarray:
        """Errors with orbits only from when they were sent, which a receiver has."""
        found = self.fly(future=False)
        return errors(found)[found["fix.valid"] > 0]

    @cached_property
    def duration(self) -> float:
        """Of a flight of the day, s: making of the system, running and recording."""
        begin = time.perf_counter()
        self.fly()
        return time.perf_counter() - begin

    @cached_property
    def claims(self) -> list[Claim]:
        return [
            *accurate(self.whole, self.independent.errors, "Flown as FMUs"),
            self.same,
            missed(self.spoilt, "What is left out of the FMUs"),
            discovered(self.cases, "Faults of satellites in flight"),
            protected(self.levels, BOUNDS),
        ]


def _gathered(result: pd.DataFrame) -> dict[str, np.ndarray]:
    """Columns by name; those of an array (name[1], name[2] ...) in one, (rows, places)."""
    found: dict[str, list[np.ndarray]] = {}
    for name in result.columns:
        found.setdefault(name.partition("[")[0], []).append(result[name].to_numpy())
    return {name: np.stack(values, 1) if len(values) > 1 else values[0] for name, values in found.items()}


def section(day: Day) -> Section:
    """What was found; all is flown before it is written down, while there is a scratch folder."""
    claims, duration = day.claims, day.duration
    heard = "/".join(f"{value:.3f}" for value in rms(day.heard))

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.text(
            f"A day of a station, an FMU by navfmu replay, is flown with gps_solver in {duration:.1f} s. "
            f"With orbits from when they were sent on, {len(day.heard)} epochs have a fix, off by {heard} m."
        )
        page.items(f"{claim.sentence}: {claim.finding}" for claim in claims)
        page.picture(picture(day, claims), "Errors over a day, what is left out, faults, protection levels")
        independent.table(page, day.spoilt)

    return Section(claims, write)


def picture(day: Day, claims: Sequence[Claim]) -> bytes:
    """Errors, what is left out, faults and protection levels."""
    shown = (claims[0], claims[3], claims[4], claims[5])
    return independent.picture(
        day.independent.hours, day.errors, day.spoilt, day.cases, day.levels, shown, "as FMUs", "range step"
    )
