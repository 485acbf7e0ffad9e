"""Attitude references in the place of each other: errors, and whether they are known, in the same flights."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evidence.section import Section
from fmus.grades import GRADES, ahrs_parameters
from navfmu import System
from navfmu.errors import NavfmuWarning
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from system_ssp.backup_navigator.system import ATTITUDES, BASE_GRADE

HEADING = "Attitude references in the backup navigator"
REFERENCES = {"ahrs": None, **{name: name for name in ATTITUDES}}
"""Variants of the backup navigator, by the FMU that tells attitude."""
HONEST = ("ahrs", "ahrs_velocity", "ahrs_vectors")
"""Those that model what the simulation does. The filters of the thesis know of no change of the wind in the specific
force, and of no error of the dip; what comes of it is in the table."""
CASES = {
    "GPS lost at minute 5": "gps_lost",
    "GPS, and air data from minute 15 to 17": "airspeed_dropout",
    "GPS, and the pitot tube blocked at minute 15": "pitot_blocked",
    "GPS, and 40 mG of hard iron at minute 15": "hard_iron",
}
"""Files of faults, by what they do."""
SEEDS = range(1, 11)
SETTLED, FAILED = 60, 900
"""Seconds from which errors are looked at: in a flight without and in one with a second failure."""
ANGLES = ("roll", "pitch", "heading")
POSITION = ("evaluation.north_error", "evaluation.east_error")
SIGNALS = (*(f"aircraft.{angle}" for angle in ANGLES), "ahrs.attitude", *POSITION)


@dataclass(frozen=True)
class Flights:
    """Of one reference: errors and sigmas of the angles, deg, (seeds, angles, seconds), NaN where attitude is not
    valid; horizontal errors of the navigator, m, (seeds, seconds)."""

    error: np.ndarray
    sigma: np.ndarray
    astray: np.ndarray

    @classmethod
    def of(cls, variant: str | None, faults: str, grade: str = BASE_GRADE) -> Flights:
        """Fly, with an inertial unit of a grade and the parameters for it."""
        system = System.load("backup_navigator", variant)
        known = system.descriptions["ahrs"].by_name
        told = {f"imu.{name}": value for name, value in GRADES[grade].items()}
        told |= {f"ahrs.{name}": value for name, value in ahrs_parameters(grade).items() if name in known}

        def one(seed: int) -> tuple[np.ndarray, ...]:
            run = system.run(seed=seed, faults=faults, parameters=told, record=SIGNALS, record_period=1.0)
            lacking = np.where(run["ahrs.attitude.valid"] > 0.0, 0.0, np.nan)
            off = np.array([run[f"ahrs.attitude.{angle}"] - run[f"aircraft.{angle}"] for angle in ANGLES])
            sigma = np.array([run[f"ahrs.attitude.{angle}_sigma"] for angle in ANGLES])
            off = np.degrees((off + np.pi) % (2.0 * np.pi) - np.pi) + lacking
            return off, np.degrees(sigma) + lacking, np.hypot(*(run[name].to_numpy(float) for name in POSITION))

        with warnings.catch_warnings(), ThreadPoolExecutor(os.cpu_count()) as pool:
            warnings.simplefilter("ignore", NavfmuWarning)  # that a dropout loses samples
            runs = list(pool.map(one, SEEDS))
        return cls(*(np.array(values) for values in zip(*runs, strict=True)))

    def squares(self, start: int = SETTLED) -> np.ndarray:
        """Mean squares of errors over sigmas, (seeds, angles); 1 if sigmas are those of the errors."""
        return np.nanmean((self.error / self.sigma)[:, :, start:] ** 2, axis=2)

    def overconfident(self, start: int = SETTLED) -> float:
        """The largest of these, mean of all flights, less three of its standard errors."""
        squares = self.squares(start)
        scatter = np.std(squares, axis=0, ddof=1) / np.sqrt(len(squares))
        return float(np.max(np.mean(squares, axis=0) - 3.0 * scatter))

    def row(self, start: int = SETTLED) -> list[str]:
        """What SHOWN names."""
        error, sigma = (rms(values[:, :, start:]) for values in (self.error, self.sigma))
        return [
            *(f"{one:.2f} ({said:.2f})" for one, said in zip(error, sigma, strict=True)),
            *(f"{square:.2f}" for square in np.mean(self.squares(start), axis=0)),
            f"{100.0 * np.mean(np.isfinite(self.error[:, 2, start:])):.1f}",
            f"{np.sqrt(np.mean(self.astray[:, max(start, 301) :] ** 2)):.0f}",
        ]


SHOWN = (
    *(f"{angle}, deg rms (sigma)" for angle in ANGLES), *(f"its square (1), {angle}" for angle in ANGLES),
    "valid, %", "position without GPS, m rms",
)  # fmt: skip


def rms(values: np.ndarray) -> np.ndarray:
    """Root of the mean of squares over flights and time, (angles,)."""
    return np.sqrt(np.nanmean(values**2, axis=(0, 2)))


@dataclass(frozen=True)
class Found:
    """Flights by case and by grade, each by reference."""

    cases: Mapping[str, Mapping[str, Flights]]
    grades: Mapping[str, Mapping[str, Flights]]

    @classmethod
    def flown(cls) -> Found:
        def each(**what: Any) -> dict[str, Flights]:
            return {name: Flights.of(variant, **what) for name, variant in REFERENCES.items()}

        cases = {words: each(faults=faults) for words, faults in CASES.items()}
        others = GRADES.keys() - {BASE_GRADE}
        return cls(cases, {grade: each(faults="gps_lost", grade=grade) for grade in sorted(others)})

    @property
    def usual(self) -> Mapping[str, Flights]:
        """Without a second failure, with the grade of the system."""
        return next(iter(self.cases.values()))


def run(out: Path) -> Section:
    """Fly and draw."""
    found = Found.flown()
    write_file(out / "sensors" / "attitude.png", picture(found))
    return section(found)


def make_claims(found: Found) -> list[Claim]:
    """Of each reference, whether its sigmas are not too small."""
    return [
        Claim(f"{name}: errors are not larger than its sigmas say", flown.overconfident(), 1.0, False,
              "of the worst angle's square, less 3 standard errors", f"{name}: errors are larger than its sigmas say")
        for name, flown in found.usual.items() if name in HONEST
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, tables and the picture."""
    claims = make_claims(found)

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims)
        for words, flights in found.cases.items():
            page.text(f"{words}:")
            start = SETTLED if flights is found.usual else FAILED
            page.table(["attitude by", *SHOWN], [[name, *flown.row(start)] for name, flown in flights.items()])
        for grade, flights in found.grades.items():
            page.text(f"Unit of {grade} grade, GPS lost at minute 5:")
            page.table(["attitude by", *SHOWN], [[name, *flown.row()] for name, flown in flights.items()])
        page.picture(picture(found), "Errors and sigmas of pitch and heading against time")

    return Section(claims, write)


def picture(found: Found) -> bytes:
    """Errors and sigmas of pitch and heading against time, and of heading with air data lost and with hard iron."""
    usual, _, pitot, iron = found.cases
    panels = (("pitch", usual), ("heading", usual), ("heading", pitot), ("heading", iron))
    with figure(2, 2, size=(13.0, 8.6)) as (drawing, axes):
        for axis, (angle, case) in zip(axes.flat, panels, strict=True):
            for (name, flown), colour in zip(found.cases[case].items(), COLOURS, strict=False):
                minutes = np.arange(flown.error.shape[2]) / 60.0
                of = ANGLES.index(angle)
                for values, style, label in ((flown.error, "-", f"{name}, rms"), (flown.sigma, "--", "its sigma")):
                    shown = np.sqrt(np.nanmean(values[:, of, SETTLED:] ** 2, axis=0))
                    smooth = np.convolve(shown**2, np.ones(30) / 30.0, "valid") ** 0.5
                    axis.plot(minutes[SETTLED + 29 :], smooth, style, color=colour, lw=1, label=label)
            axis.axvline(5.0, color=GREY, lw=1, ls=":")
            if case != usual:
                axis.axvline(FAILED / 60.0, color=GREY, lw=1, ls=":")
            axis.set_ylim(0.0, None)
            axis.set_xlabel(f"time, min; {len(SEEDS)} flights, means of 30 s; failures begin at dotted lines")
            axis.set_ylabel(f"error of {angle}, deg")
            title(drawing, axis, f"{angle.capitalize()}: {case}")
        top = axes[0, 0]
        top.set_ylim(0.0, 1.5 * top.get_ylim()[1])
        top.legend(fontsize=8, ncols=2, loc="upper left")
        return png(drawing)
