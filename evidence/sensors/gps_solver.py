"""Positions of a recorded day of pseudoranges, beside an independent solution: whole, spoilt, and protected."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.section import Section, left_out
from evidence.sensors.observed import KLOBUCHAR_OFF, TROPOSPHERE_OFF, TRUTH, Signals, Station, errors, rms, velocities
from fmus.satellite.signals import PLACES
from models.earth import earth
from models.satellite import least_squares, sight
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page

HEADING = "GPS from satellites"
NEEDED = (
    "esbc1770.rnx.gz", "esbc1770_nav.rnx.gz", "esbc1770_spp.parquet", "esbc1770_ablation.csv", "esbc1770_fde.csv",
    "esbc1770_hpl.csv",
)  # fmt: skip
AXES = ("east", "north", "up")
ABLATIONS = {
    "full model": ("", {}),
    "no TGD": ("TGD", {}),
    "no relativistic clock": ("relativity", {}),
    "no Sagnac rotation": ("Sagnac", {}),
    "no ionosphere": ("", {"ionosphere": KLOBUCHAR_OFF}),
    "no troposphere": ("", {"troposphere": TROPOSPHERE_OFF}),
    "satellite position at reception time (no transmission time)": ("travel", {}),
    "time tag taken as UTC (18 leap seconds added)": ("leap seconds", {}),
}
"""Names in the independent solution, what is left out, parameters of the solver."""
ON = {"exclusions": 0, "withhold": False}
"""What is spoilt is shown, whatever integrity monitoring says."""


def run(out: Path) -> Section:
    """Solve, spoil, compare and draw."""
    folder = os.environ.get("NAVFMU_DATA")
    if not folder:
        return left_out(HEADING, "the environment variable NAVFMU_DATA does not name a folder with observations")
    gnss = Path(folder) / "gnss"
    if missing := [name for name in NEEDED if not (gnss / name).is_file()]:
        return left_out(HEADING, f"{gnss} has no {missing[0]}")
    day = Day(gnss)
    made = section(day)
    write_file(out / "sensors" / "gps_solver.png", picture(day, made.claims))
    return made


@dataclass(frozen=True)
class Day:
    """A day at a station, each part solved when it is first asked for."""

    folder: Path

    @cached_property
    def station(self) -> Station:
        return Station(self.folder)

    @cached_property
    def independent(self) -> pd.DataFrame:
        return pd.read_parquet(self.folder / "esbc1770_spp.parquet")

    @cached_property
    def whole(self) -> dict[str, np.ndarray]:
        """All epochs."""
        return self.station.solve(range(len(self.station.observations)))

    @cached_property
    def errors(self) -> np.ndarray:
        return errors(self.whole)

    def theirs(self, name: str) -> np.ndarray:
        """Errors of the independent solution, ``err`` or ``verr``."""
        return self.independent[[f"own_{name}_{axis}" for axis in "enu"]].to_numpy()

    @property
    def apart(self) -> float:
        """Half of the positions are nearer to the independent ones, m."""
        return float(np.median(np.linalg.norm(self.errors - self.theirs("err"), axis=1)))

    @property
    def accurate(self) -> list[Claim]:
        """Position and velocity have the errors of the independent solution."""
        claims = []
        for what, ours, name, unit in (
            ("Positions", self.errors, "err", "m"),
            ("Velocities", velocities(self.whole), "verr", "m/s"),
        ):
            found, known = rms(ours), rms(self.theirs(name))
            told = "/".join(f"{value:.2g}" if unit == "m/s" else f"{value:.3f}" for value in found)
            claim = Claim(
                f"{what} of {len(ours)} epochs are off by {told} {unit} east/north/up (rms): as an independent "
                "solution, within",
                100.0 * float(np.max(np.abs(found / known - 1.0))), 10.0, False, "%",
                f"{what} are off by {told} {unit}, otherwise than an independent solution",
            )  # fmt: skip
            claims.append(claim)
        return claims

    @cached_property
    def spoilt(self) -> pd.DataFrame:
        """Rms errors with something left out, ours and theirs, by name."""
        known = pd.read_csv(self.folder / "esbc1770_ablation.csv").set_index("variant")
        rows = self.station.rows(self.protected["tow_s"])
        found = {
            name: rms(errors(self.station.solve(rows, what, **ON, **parameters)))
            for name, (what, parameters) in ABLATIONS.items()
        }
        ours = pd.DataFrame(found, index=[f"ours_{axis}" for axis in "enu"]).T
        return ours.join(known[["rms_e", "rms_n", "rms_u"]])

    @property
    def left_out(self) -> Claim:
        ours, theirs = self.spoilt.to_numpy()[:, :3], self.spoilt.to_numpy()[:, 3:]
        return Claim(
            "Each model left out is missed as much as in the independent solution: errors within",
            100.0 * float(np.max(np.abs(ours / theirs - 1.0))), 20.0, False, "%",
            "A model left out is missed otherwise than in the independent solution",
        )  # fmt: skip

    @property
    def refused(self) -> Claim:
        """Times that are off by leap seconds are no fix."""
        found = self.station.solve(self.station.rows(self.protected["tow_s"]), "leap seconds")
        return Claim(
            f"With times that are off by 18 s nothing is called a fix: epochs of {len(found['fix.valid'])} that are",
            float(np.count_nonzero(found["fix.valid"])), 0.0, False,
            opposite="With times that are off by 18 s there are fixes",
        )  # fmt: skip

    @cached_property
    def cases(self) -> pd.DataFrame:
        """One satellite with a bias: what the independent solution found, and ours."""
        cases = pd.read_csv(self.folder / "esbc1770_fde.csv")
        rows = self.station.rows(cases["tow_s"])
        prn, bias = cases["biased_prn"].to_numpy(), cases["bias_m"].to_numpy()

        def spoil(k: int, signals: Signals) -> None:
            signals["signals.pseudorange"][signals["signals.number"] == prn[k]] += bias[k]

        found = self.station.solve(rows, "", spoil, false_alarm=1e-5)
        numbers = np.array([self.station.signals(int(row))["signals.number"] for row in rows])
        after = errors(found)
        return cases.assign(
            ours=found["squares"],
            ours_threshold=found["threshold"],
            ours_excluded=np.sum(np.where(found["excluded"], numbers, 0.0), axis=1),
            ours_after_h=np.hypot(after[:, 0], after[:, 1]),
            alarm=found["alarm"],
        )

    @property
    def found(self) -> Claim:
        cases = self.cases
        right = (cases["ours_excluded"] == cases["excluded_prn"].fillna(0.0)) & ~cases["alarm"].astype(bool)
        biased = int(np.count_nonzero(cases["bias_m"]))
        return Claim(
            f"Biases of 30, 100 and 1000 m are found, and the satellite ({biased} cases), and {len(cases) - biased} "
            "epochs without one are silent",
            int(right.sum()), len(cases), True, "",
            "A bias of 30 m or more is not found, or an epoch without one is not silent",
        )  # fmt: skip

    @cached_property
    def protected(self) -> pd.DataFrame:
        """Protection levels of the independent solution, every 5 min."""
        return pd.read_csv(self.folder / "esbc1770_hpl.csv")

    @cached_property
    def levels(self) -> pd.DataFrame:
        """Theirs and ours."""
        rows = self.station.rows(self.protected["tow_s"])
        equal = self.station.solve(rows, equal_sigma=33.3)
        off = self.errors[rows]
        return self.protected.assign(
            ours=self.whole["horizontal_protection"][rows],
            ours_vertical=self.whole["vertical_protection"][rows],
            ours_brown=equal["horizontal_protection_slope"],
            off=np.hypot(off[:, 0], off[:, 1]),
            off_vertical=np.abs(off[:, 2]),
        )

    @property
    def bounded(self) -> list[Claim]:
        levels = self.levels
        apart = np.concatenate(
            [
                np.abs(levels["ours"] / levels["hpl_we_wgt"] - 1.0),
                np.abs(levels["ours_vertical"] / levels["vpl_we_wgt"] - 1.0),
                np.abs(levels["ours_brown"] / levels["hpl_brown_33m"] - 1.0),
            ]
        )
        share = max((levels["off"] / levels["ours"]).max(), (levels["off_vertical"] / levels["ours_vertical"]).max())
        return [
            Claim(
                f"Protection levels of {len(levels)} epochs are those of the independent solution: 99 of 100 within",
                100.0 * float(np.quantile(apart, 0.99)), 0.1, False, "%",
                "Protection levels differ from those of the independent solution",
            ),
            Claim(
                "Errors stay below their protection levels: the largest, as a part of it",
                float(share), 1.0, False, opposite="An error is beyond its protection level",
            ),
        ]  # fmt: skip

    @property
    def four(self) -> Claim:
        """A receiver of four channels, AGARD CP-298 (1981), Coriat: 20 m, 90 % of the time, in space."""
        off = errors(self.station.solve(self.station.rows(self.protected["tow_s"]), channels=4))
        half, most = np.quantile(np.linalg.norm(off, axis=1), [0.5, 0.9])
        return Claim(
            f"With four channels half of the positions are within {half:.2g} m, and 90 % within",
            float(most), 20.0, False, "m", "Four channels are not enough for 20 m, 90 % of the time",
        )  # fmt: skip

    @property
    def three(self) -> Claim:
        """Three satellites that lie well and an altitude of 10 m, AGARD CP-298 (1981), Peterson: about 10 m."""
        latitude, longitude, altitude = earth.from_ecef(TRUTH)
        rng = np.random.default_rng(3)

        def few(_: int, signals: Signals) -> None:
            tracked = np.flatnonzero(signals["signals.tracked"])
            unit_n = sight.ranges(TRUTH, signals["signals.satellite_e"][tracked])[1]
            unit_n = unit_n @ earth.north_east_down(latitude, longitude).T
            high = -unit_n[:, 2] > np.sin(np.radians(10.0))
            kept = best_three(unit_n[high])
            signals["signals.tracked"] = np.isin(np.arange(PLACES), tracked[high][list(kept)])
            signals |= {"altitude.height": altitude + 10.0 * rng.standard_normal(), "altitude.valid": True}

        off = errors(self.station.solve(self.station.rows(self.protected["tow_s"]), "", few))
        return Claim(
            "Three satellites and an altitude that is known to 10 m: horizontal error, rms",
            float(np.sqrt(np.mean(off[:, 0] ** 2 + off[:, 1] ** 2))), 10.0, False, "m",
            "Three satellites and an altitude are not enough for 10 m",
        )  # fmt: skip

    @cached_property
    def claims(self) -> list[Claim]:
        return [*self.accurate, self.left_out, self.found, *self.bounded, self.refused, self.four, self.three]


def best_three(unit_n: np.ndarray) -> tuple[int, ...]:
    """Which three of the sight lines have the least dilution together with an altitude."""

    def dilution(three: tuple[int, ...]) -> float:
        q = least_squares.covariance(least_squares.design(unit_n[list(three)]), np.ones(4))
        return float(np.trace(q)) or np.inf

    return min(combinations(range(len(unit_n)), 3), key=dilution)


def section(day: Day) -> Section:
    """What was found."""
    claims = day.claims

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.text(
            f"A day of a station in Denmark ({len(day.errors)} epochs of 30 s): half of the positions are within "
            f"{1e3 * day.apart:.2g} mm of those of an independent solution."
        )
        page.items(f"{claim.sentence}: {claim.finding}" for claim in claims)
        page.picture(picture(day, claims), "Errors over a day, models left out, biased satellites, protection levels")
        page.table(
            ["left out", "rms east, north, up, m", "independent"],
            [
                [str(name), *(" ".join(f"{value:.2f}" for value in part) for part in (row[:3], row[3:]))]
                for name, row in zip(day.spoilt.index, day.spoilt.to_numpy(), strict=True)
            ],
        )

    return Section(claims, write)


def picture(day: Day, claims: Sequence[Claim]) -> bytes:
    """Errors, models left out, biases and protection levels."""
    with figure(2, 2, size=(14.0, 8.6)) as (drawing, axes):
        time, spoilt, biased, level = np.ravel(axes)
        hours = np.mod(day.independent["tow_s"], 86400.0) / 3600.0
        for k, axis in enumerate(AXES):
            time.plot(hours, day.errors[:, k], "-", color=COLOURS[k], lw=0.7, label=axis)
        time.set(xlabel="GPS time of day, h", ylabel="error of position, m", xlim=(0, 24))

        place = np.arange(len(day.spoilt))
        for k, axis in enumerate(AXES):
            values = day.spoilt.to_numpy()
            spoilt.plot(values[:, k], place + 0.2 * (k - 1), "o", ms=5, color=COLOURS[k], label=f"{axis}, gps_solver")
            spoilt.plot(values[:, k + 3], place + 0.2 * (k - 1), "k+", ms=9, label="independent" if k == 0 else None)
        names = [str(name).partition(" (")[0].replace(" position at ", "\nat ") for name in day.spoilt.index]
        spoilt.set(xscale="log", yticks=place, yticklabels=names, xlabel="rms error, m")
        spoilt.invert_yaxis()

        cases = day.cases
        for k, bias in enumerate(sorted(set(cases["bias_m"]))):
            some = cases[cases["bias_m"] == bias]
            number = np.arange(len(some))
            biased.plot(number, some["ours"], "o", ms=5, color=COLOURS[k], label=f"bias {bias:g} m")
            biased.plot(number, some["wsse"], "k+", ms=9, label="independent" if k == 0 else None)
        biased.plot(number, some["ours_threshold"], "_", ms=16, color=GREY, label="threshold, 1e-5")
        biased.set(yscale="log", xlabel="epoch, every 2 h", ylabel="weighted sum of squares", ylim=(0.05, 3e6))

        levels = day.levels
        hours = np.mod(levels["tow_s"], 86400.0) / 3600.0
        for k, (name, label) in enumerate((("", "horizontal"), ("_vertical", "vertical"))):
            level.plot(hours, levels[f"ours{name}"], "-", color=COLOURS[k], lw=1, label=f"{label} protection level")
            level.plot(hours, levels[f"off{name}"], ".", ms=3, color=COLOURS[k], label=f"{label} error")
        level.set(yscale="log", xlabel="GPS time of day, h", ylabel="m", xlim=(0, 24), ylim=(5e-3, 2e2))

        shown = (claims[0], claims[2], claims[3], claims[5])
        for panel, claim in zip((time, spoilt, biased, level), shown, strict=True):
            title(drawing, panel, claim.sentence.partition(":")[0].partition(" (")[0])
            panel.legend(fontsize=8, ncols=2)
        return png(drawing, 80)
