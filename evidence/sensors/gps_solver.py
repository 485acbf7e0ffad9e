"""Positions of a recorded day of pseudoranges, beside an independent solution: whole, spoilt, and protected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path

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
from evidence.sensors.observed import KLOBUCHAR_OFF, TROPOSPHERE_OFF, TRUTH, Signals, Station, errors
from fmus.satellite.signals import PLACES
from models.earth import earth
from models.satellite import least_squares, sight
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.page import Page

HEADING = "GPS from satellites"
BOUNDS = {"ours": "hpl_we_wgt", "ours_vertical": "vpl_we_wgt", "ours_brown": "hpl_brown_33m"}
"""Protection levels, ours and theirs."""
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


def run(out: Path) -> Section:
    """Solve, spoil, compare and draw."""
    gnss, lacking = recorded(*NEEDED, under="gnss")
    if lacking:
        return left_out(HEADING, lacking)
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
    def independent(self) -> Independent:
        return Independent(self.folder)

    @cached_property
    def whole(self) -> dict[str, np.ndarray]:
        """All epochs."""
        return self.station.solve(range(len(self.station.observations)))

    @cached_property
    def errors(self) -> np.ndarray:
        return errors(self.whole)

    @property
    def apart(self) -> float:
        """Half of the positions are nearer to the independent ones, m."""
        return float(np.median(np.linalg.norm(self.errors - self.independent.errors(), axis=1)))

    @cached_property
    def spoilt(self) -> pd.DataFrame:
        """Rms errors with something left out, ours and theirs, by name."""
        rows = self.station.rows(self.independent.protected["tow_s"])
        return self.independent.beside(
            {
                name: errors(self.station.solve(rows, what, **ON, **parameters))
                for name, (what, parameters) in ABLATIONS.items()
            }
        )

    @property
    def refused(self) -> Claim:
        """Times that are off by leap seconds are no fix."""
        found = self.station.solve(self.station.rows(self.independent.protected["tow_s"]), "leap seconds")
        return Claim(
            f"With times that are off by 18 s nothing is called a fix: epochs of {len(found['fix.valid'])} that are",
            float(np.count_nonzero(found["fix.valid"])), 0.0, False,
            opposite="With times that are off by 18 s there are fixes",
        )  # fmt: skip

    @cached_property
    def cases(self) -> pd.DataFrame:
        """One satellite with a bias: what the independent solution found, and ours."""
        cases = self.independent.biased
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
            ours_excluded=excluded(found["excluded"], numbers),
            ours_after_h=np.hypot(after[:, 0], after[:, 1]),
            alarm=found["alarm"],
        )

    @cached_property
    def levels(self) -> pd.DataFrame:
        """Theirs and ours."""
        rows = self.station.rows(self.independent.protected["tow_s"])
        equal = self.station.solve(rows, equal_sigma=33.3)
        found = levels(self.whole, rows, self.independent.protected)
        return found.assign(ours_brown=equal["horizontal_protection_slope"])

    @property
    def beyond(self) -> Claim:
        levels = self.levels
        share = max((levels["off"] / levels["ours"]).max(), (levels["off_vertical"] / levels["ours_vertical"]).max())
        return Claim(
            "Errors stay below their protection levels: the largest, as a part of it",
            float(share), 1.0, False, opposite="An error is beyond its protection level",
        )  # fmt: skip

    @property
    def four(self) -> Claim:
        """A receiver of four channels, AGARD CP-298 (1981), Coriat: 20 m, 90 % of the time, in space."""
        off = errors(self.station.solve(self.station.rows(self.independent.protected["tow_s"]), channels=4))
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

        off = errors(self.station.solve(self.station.rows(self.independent.protected["tow_s"]), "", few))
        return Claim(
            "Three satellites and an altitude that is known to 10 m: horizontal error, rms",
            float(np.sqrt(np.mean(off[:, 0] ** 2 + off[:, 1] ** 2))), 10.0, False, "m",
            "Three satellites and an altitude are not enough for 10 m",
        )  # fmt: skip

    @cached_property
    def claims(self) -> list[Claim]:
        return [
            *accurate(self.whole, self.independent.errors),
            missed(self.spoilt, "Each model left out"),
            discovered(self.cases, "Biases"),
            protected(self.levels, BOUNDS),
            self.beyond,
            self.refused,
            self.four,
            self.three,
        ]


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
        independent.table(page, day.spoilt)

    return Section(claims, write)


def picture(day: Day, claims: Sequence[Claim]) -> bytes:
    """Errors, models left out, biases and protection levels."""
    shown = (claims[0], claims[2], claims[3], claims[5])
    return independent.picture(
        day.independent.hours, day.errors, day.spoilt, day.cases, day.levels, shown, "gps_solver", "bias"
    )
