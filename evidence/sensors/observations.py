"""A recorded day of observations as an FMU, solved by ``gps_solver`` in the master, beside an independent solution."""

from __future__ import annotations

import dataclasses
import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from evidence.section import Section, left_out
from evidence.sensors.observed import FILES, KLOBUCHAR_OFF, TROPOSPHERE_OFF, errors, rms, velocities
from navfmu import Fault, System
from navfmu.files.writing import write_file
from navfmu.recorded.observations.imported import Imported
from navfmu.recorded.observations.importer import import_observations
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.satellite.orbits import COLUMNS
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped

HEADING = "Recorded observations as an FMU"
NEEDED = (*FILES, "esbc1770_spp.parquet", "esbc1770_ablation.csv", "esbc1770_fde.csv", "esbc1770_hpl.csv")
AXES = ("east", "north", "up")
TICK = 1.0
"""s, of the FMUs and the master; epochs come every 30 s."""
ROUNDED = 2e-3
"""m: how the independent solution's places are rounded, in three axes."""
RECORD = ["solver", "observations.satellites", "observations.signals.number"]
ON = {"exclusions": 0, "withhold": False}
"""What is spoilt is shown, whatever integrity monitoring says."""


def run(out: Path) -> Section:
    """Fly the day, spoil it, compare and draw."""
    folder = os.environ.get("NAVFMU_DATA")
    if not folder:
        return left_out(HEADING, "the environment variable NAVFMU_DATA does not name a folder with observations")
    gnss = Path(folder) / "gnss"
    if missing := [name for name in NEEDED if not (gnss / name).is_file()]:
        return left_out(HEADING, f"{gnss} has no {missing[0]}")
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
    def independent(self) -> pd.DataFrame:
        return pd.read_parquet(self.folder / "esbc1770_spp.parquet")

    @cached_property
    def whole(self) -> dict[str, np.ndarray]:
        return self.fly()

    @cached_property
    def errors(self) -> np.ndarray:
        return errors(self.whole)

    def rows(self, seconds: Any) -> np.ndarray:
        """Which epochs have these seconds of the week."""
        return np.searchsorted(self.imported.epochs.second, np.asarray(seconds, float) - 1e-3)

    def theirs(self, name: str) -> np.ndarray:
        """Errors of the independent solution, ``err`` or ``verr``."""
        return self.independent[[f"own_{name}_{axis}" for axis in "enu"]].to_numpy()

    @property
    def apart(self) -> np.ndarray:
        """How far each position is from the independent one, m."""
        return np.linalg.norm(self.errors - self.theirs("err"), axis=1)

    @property
    def accurate(self) -> list[Claim]:
        claims = []
        for what, ours, name, unit in (
            ("positions", self.errors, "err", "m"),
            ("velocities", velocities(self.whole), "verr", "m/s"),
        ):
            found, known = rms(ours), rms(self.theirs(name))
            told = "/".join(f"{value:.2g}" if unit == "m/s" else f"{value:.3f}" for value in found)
            claims.append(
                Claim(
                    f"Flown as FMUs, {what} of {len(ours)} epochs are off by {told} {unit} east/north/up (rms): as an "
                    "independent solution, within",
                    100.0 * float(np.max(np.abs(found / known - 1.0))), 10.0, False, "%",
                    f"Flown as FMUs, {what} are off by {told} {unit}, otherwise than an independent solution",
                )
            )  # fmt: skip
        return claims

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
        known = pd.read_csv(self.folder / "esbc1770_ablation.csv").set_index("variant")
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
        rows = self.rows(self.protected["tow_s"])
        found = {name: rms(errors(self.fly(**given, **ON))[rows]) for name, given in flights.items()}
        ours = pd.DataFrame(found, index=[f"ours_{axis}" for axis in "enu"]).T
        return ours.join(known[["rms_e", "rms_n", "rms_u"]])

    @property
    def missed(self) -> Claim:
        ours, theirs = self.spoilt.to_numpy()[:, :3], self.spoilt.to_numpy()[:, 3:]
        return Claim(
            "What is left out of the FMUs is missed as much as in the independent solution: errors within",
            100.0 * float(np.max(np.abs(ours / theirs - 1.0))), 20.0, False, "%",
            "What is left out of the FMUs is missed otherwise than in the independent solution",
        )  # fmt: skip

    @cached_property
    def cases(self) -> pd.DataFrame:
        """One satellite with a bias, as a fault of the FMU: a flight for each size."""
        cases = pd.read_csv(self.folder / "esbc1770_fde.csv")
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
                    ours_excluded=np.sum(np.where(found["excluded"][rows] > 0, number, 0.0), axis=1),
                    ours_threshold=found["threshold"][rows],
                    alarm=found["alarm"][rows] > 0,
                )
            )
        return pd.concat(parts)

    @property
    def found(self) -> Claim:
        cases = self.cases
        right = (cases["ours_excluded"] == cases["excluded_prn"].fillna(0.0)) & ~cases["alarm"]
        biased = int(np.count_nonzero(cases["bias_m"]))
        return Claim(
            f"Faults of 30, 100 and 1000 m of a satellite in flight are found, and the satellite ({biased} cases), and "
            f"{len(cases) - biased} epochs without one are silent",
            int(right.sum()), len(cases), True, "",
            "A fault of 30 m or more is not found, or an epoch without one is not silent",
        )  # fmt: skip

    @cached_property
    def protected(self) -> pd.DataFrame:
        return pd.read_csv(self.folder / "esbc1770_hpl.csv")

    @cached_property
    def levels(self) -> pd.DataFrame:
        rows = self.rows(self.protected["tow_s"])
        off = self.errors[rows]
        return self.protected.assign(
            ours=self.whole["horizontal_protection"][rows],
            ours_vertical=self.whole["vertical_protection"][rows],
            off=np.hypot(off[:, 0], off[:, 1]),
            off_vertical=np.abs(off[:, 2]),
        )

    @property
    def bounded(self) -> Claim:
        levels = self.levels
        pairs = (("ours", "hpl_we_wgt"), ("ours_vertical", "vpl_we_wgt"))
        apart = np.concatenate([np.abs(levels[ours] / levels[theirs] - 1.0) for ours, theirs in pairs])
        return Claim(
            f"Protection levels of {len(levels)} epochs are those of the independent solution: 99 of 100 within",
            100.0 * float(np.quantile(apart, 0.99)), 0.1, False, "%",
            "Protection levels of the FMU differ from those of the independent solution",
        )  # fmt: skip

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
        return [*self.accurate, self.same, self.missed, self.found, self.bounded]


def _gathered(result: pd.DataFrame) -> dict[str, np.ndarray]:
    """Columns by name; those of an array (name[1], name[2] ...) in one, (rows, places)."""
    found: dict[str, list[np.ndarray]] = {}
    for name in result.columns:
        found.setdefault(name.partition("[")[0], []).append(result[name].to_numpy())
    return {name: np.stack(values, 1) if len(values) > 1 else values[0] for name, values in found.items()}


def section(day: Day) -> Section:
    """What was found."""
    claims = day.claims

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        heard = "/".join(f"{value:.3f}" for value in rms(day.heard))
        page.text(
            f"A day of a station, an FMU by navfmu replay, is flown with gps_solver in {day.duration:.1f} s. "
            f"With orbits from when they were sent on, {len(day.heard)} epochs have a fix, off by {heard} m."
        )
        page.items(f"{claim.sentence}: {claim.finding}" for claim in claims)
        page.picture(picture(day, claims), "Errors over a day, what is left out, faults, protection levels")
        page.table(
            ["left out", "rms east, north, up, m", "independent"],
            [
                [str(name), *(" ".join(f"{value:.2f}" for value in part) for part in (row[:3], row[3:]))]
                for name, row in zip(day.spoilt.index, day.spoilt.to_numpy(), strict=True)
            ],
        )

    return Section(claims, write)


def picture(day: Day, claims: Sequence[Claim]) -> bytes:
    """Errors, what is left out, faults and protection levels."""
    with figure(2, 2, size=(14.0, 8.6)) as (drawing, axes):
        over, spoilt, biased, level = np.ravel(axes)
        hours = day.imported.epochs.time / 3600.0
        for k, axis in enumerate(AXES):
            over.plot(hours, day.errors[:, k], "-", color=COLOURS[k], lw=0.7, label=axis)
        over.set(xlabel="GPS time of day, h", ylabel="error of position, m", xlim=(0, 24))

        values, place = day.spoilt.to_numpy(), np.arange(len(day.spoilt))
        for k, axis in enumerate(AXES):
            spoilt.plot(values[:, k], place + 0.2 * (k - 1), "o", ms=5, color=COLOURS[k], label=f"{axis}, as FMUs")
            spoilt.plot(values[:, k + 3], place + 0.2 * (k - 1), "k+", ms=9, label="independent" if k == 0 else None)
        names = [str(name).partition(" (")[0] for name in day.spoilt.index]
        spoilt.set(xscale="log", yticks=place, yticklabels=names, xlabel="rms error, m")
        spoilt.invert_yaxis()

        cases = day.cases
        for k, bias in enumerate(sorted(set(cases["bias_m"]))):
            some = cases[cases["bias_m"] == bias]
            number = np.arange(len(some))
            biased.plot(number, some["ours"], "o", ms=5, color=COLOURS[k], label=f"range step {bias:g} m")
            biased.plot(number, some["wsse"], "k+", ms=9, label="independent" if k == 0 else None)
        biased.plot(number, some["ours_threshold"], "_", ms=16, color=GREY, label="threshold, 1e-5")
        biased.set(yscale="log", xlabel="epoch, every 2 h", ylabel="weighted sum of squares", ylim=(0.05, 3e6))

        levels = day.levels
        hours = np.mod(levels["tow_s"], 86400.0) / 3600.0
        for k, (name, theirs, label) in enumerate(
            (("", "hpl_we_wgt", "horizontal"), ("_vertical", "vpl_we_wgt", "vertical"))
        ):
            level.plot(hours, levels[theirs], "-", color=GREY, lw=3, alpha=0.5, label="independent" if k == 0 else None)
            level.plot(hours, levels[f"ours{name}"], "-", color=COLOURS[k], lw=1, label=f"{label} protection level")
            level.plot(hours, levels[f"off{name}"], ".", ms=3, color=COLOURS[k], label=f"{label} error")
        level.set(yscale="log", xlabel="GPS time of day, h", ylabel="m", xlim=(0, 24), ylim=(5e-3, 2e2))

        shown = (claims[0], claims[3], claims[4], claims[5])
        for panel, claim in zip((over, spoilt, biased, level), shown, strict=True):
            title(drawing, panel, claim.sentence.partition(":")[0].partition(" (")[0])
            panel.legend(fontsize=8, ncols=2)
        return png(drawing, 80)
