"""A magnetometer calibrated from recorded flights, judged on the rest of them; the thesis's two estimators on strips.

The environment variable NAVFMU_DATA names a folder with flights in ``sensors/flights/``: ``magnetometer.parquet``
(``time``, s; ``field_x``, ``_y``, ``_z``, T) and ``reference.parquet`` (``time``, ``roll``, ``pitch``, ``yaw``, rad),
the attitude that the aircraft's own navigator had, of thor75 without a magnetometer. None of this data is part of the
project.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from evidence.section import Section, left_out, recorded
from navfmu.calibration.magnetometer.choice import AUTOMATIC, Chosen, choose
from navfmu.calibration.magnetometer.locus import HARD_IRON, SPHERE, Locus, fit
from navfmu.calibration.magnetometer.recording import recording
from navfmu.calibration.magnetometer.strips import GAUSS, Runs, table
from navfmu.calibration.magnetometer.swinging import wrap
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page

HEADING = "Calibration of a magnetometer"
FLOWN, AIRBORNE = "thor75", (217.0, 578.0)
"""It passes 8 m/s at 212 s."""
STRENGTH, DECLINATION = 55.95e-6, np.radians(0.47)
"""WMM2010 at that place and date."""
LEARNED = (60.0, 120.0)
"""Seconds of flight from which the hard iron is learned."""
OTHERS = {"swisslog1": ((18.0, 143.0), 47.82e-6), "alfa_engine_failure": ((0.0, 132.0), 52.36e-6)}
LEVEL = np.radians(20.0)
MOST = 5.05
"""Degrees, rms: what a sphere that was fitted to the whole flight has on that same flight."""
PARTS = 6
"""Of the flight, each with a calibration of its own: do they agree as their covariances say?"""
CHANCE = 1e-3
RUNS = 200
HELD = 0.5
"""mG: errors of x and y of the thesis's two steps (Fig 3.24)."""


@dataclass(frozen=True)
class Learned:
    """``chosen`` from the first ``seconds`` of flight; ``error`` (rows,) of the heading, rad, over ``time`` after them,
    and where roll is less than LEVEL."""

    seconds: float
    chosen: Chosen
    time: np.ndarray
    error: np.ndarray
    level: np.ndarray

    @property
    def rms(self) -> tuple[float, float]:
        """Degrees, of all rows and of those with less than 20 degrees of roll."""
        return tuple(float(np.degrees(np.sqrt(np.mean(e**2)))) for e in (self.error, self.error[self.level]))


def run(out: Path) -> Section:
    """Learn, judge, and draw; the strips of Table 3.3 need no recording, but are shown beside it."""
    names = (FLOWN, *OTHERS)
    needed = [f"{name}/magnetometer.parquet" for name in names]
    folder, lacking = recorded(*needed, f"{FLOWN}/reference.parquet", under="sensors/flights")
    if lacking:
        return left_out(HEADING, lacking)
    learned = [learn(folder / FLOWN, seconds) for seconds in LEARNED]
    others = {name: asked(folder / name, *OTHERS[name]) for name in OTHERS}
    strips = table(RUNS)
    found = section(learned, others, strips, parts(folder / FLOWN))
    write_file(out / "sensors" / "magnetometer_calibration.png", picture(learned, strips, found.claims[0]))
    return found


def learn(flight: Path, seconds: float) -> Learned:
    """Calibrate from the begin of a flight, and compare headings after it."""
    begin, end = AIRBORNE
    file = flight / "magnetometer.parquet"
    taken = recording(file, {}, {}, begin=begin, end=begin + seconds)
    chosen = choose(taken.measured, STRENGTH, None, AUTOMATIC, taken.source)
    rows, reference = pd.read_parquet(file), pd.read_parquet(flight / "reference.parquet")
    rows = rows[(rows["time"] > begin + seconds) & (rows["time"] <= end)]
    time = rows["time"].to_numpy()
    roll, pitch, yaw = (
        np.interp(time, reference["time"], np.unwrap(reference[angle])) for angle in ("roll", "pitch", "yaw")
    )
    corrected = chosen.locus.corrected(rows[["field_x", "field_y", "field_z"]].to_numpy())
    error = wrap(heading(corrected, roll, pitch) + DECLINATION - yaw)
    return Learned(seconds, chosen, time, error, np.abs(roll) < LEVEL)


def heading(field: np.ndarray, roll: np.ndarray, pitch: np.ndarray) -> np.ndarray:
    """Magnetic heading, rad, of fields (rows, 3) in b: turned level, (2.3)."""
    x, y, z = field.T
    across = np.cos(roll) * y - np.sin(roll) * z
    below = np.sin(roll) * y + np.cos(roll) * z
    return np.arctan2(-across, np.cos(pitch) * x + np.sin(pitch) * below)


def asked(flight: Path, airborne: tuple[float, float], strength: float) -> tuple[str, str]:
    """The method that a flight allows, or "none", and what is said of an ellipsoid."""
    taken = recording(flight / "magnetometer.parquet", {}, {}, begin=airborne[0], end=airborne[1])
    try:
        chosen = choose(taken.measured, strength, None, AUTOMATIC, flight.name)
    except NavfmuError as problem:
        return "none", str(problem).partition("ellipsoid: ")[2].partition("; axes: ")[0]
    return chosen.method, chosen.refused[0].removeprefix("ellipsoid: ") if chosen.refused else ""


def parts(flight: Path) -> Mapping[str, float]:
    """Probability that calibrations of parts of a flight, by family, differ as much as they do, or more."""
    edges = np.linspace(*AIRBORNE, PARTS + 1)
    taken = [
        recording(flight / "magnetometer.parquet", {}, {}, begin=begin, end=end).measured
        for begin, end in pairwise(edges)
    ]
    return {
        family.name: agreement([fit(family, fields, STRENGTH) for fields in taken]) for family in (HARD_IRON, SPHERE)
    }


def agreement(loci: Sequence[Locus]) -> float:
    """Probability by chi-square, of all unknowns, about the mean that is best by the covariances."""
    found = [np.concatenate([one.centre, one.family.unknowns(one.matrix)]) for one in loci]
    weights = [np.linalg.inv(one.covariance) for one in loci]
    mean = np.linalg.solve(sum(weights), sum(w @ x for w, x in zip(weights, found, strict=True)))
    distance = sum((x - mean) @ w @ (x - mean) for w, x in zip(weights, found, strict=True))
    return float(stats.chi2.sf(distance, (len(loci) - 1) * len(mean)))


def section(
    learned: Sequence[Learned],
    others: Mapping[str, tuple[str, str]],
    strips: Sequence[Runs],
    agree: Mapping[str, float],
) -> Section:
    """Four claims, and tables."""
    last = learned[-1]
    held = max(float(np.max(one.largest()[:2])) for one in strips) / (1e-3 * GAUSS)
    thin = min(strips, key=lambda one: one.case.strip / one.case.noise)
    rest = max(one.diverged[1] for one in strips if one is not thin)
    learning = f"The hard iron of {last.seconds:.0f} s of flight"
    many = f"{len(strips)} cases of {len(strips[0].batch)} runs"
    claims = [
        Claim(
            f"{learning} gives the heading of the rest", last.rms[0], MOST, False, "degrees rms",
            f"{learning} does not give the heading of the rest",
        ),
        Claim(
            f"The thesis's two steps hold the hard iron of x and y, {many}", held, HELD, False, "mG, the largest error",
            "The thesis's two steps err by more than the thesis says",
        ),
        Claim(
            f"Calibrations of {PARTS} parts of the flight differ by what their covariances say", min(agree.values()),
            CHANCE, True, "probability", f"Calibrations of {PARTS} parts of the flight differ by more than they say",
        ),
        Claim(
            "The batch diverges most in the thin strip with noise, by this much of its runs more than elsewhere",
            100.0 * (thin.diverged[1] - rest), 10.0, True, "%", "The batch diverges elsewhere, too",
        ),
    ]  # fmt: skip

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims)
        page.picture(picture(learned, strips, claims[0]), "Headings after learning, and errors of two estimators")
        head = ["thor75, learned from", "method", "hard iron, uT", "heading of the rest, deg rms", "level"]
        page.table(head, [_row(one) for one in learned])
        page.table(["flight", "method", "an ellipsoid"], [[name, *told] for name, told in others.items()])
        head = ["case", "strip, deg", "noise, mG", "two steps: x, y, z, mG at most", "batch diverges, %"]
        page.table(head, [_case(one) for one in strips])

    return Section(claims, write)


def _row(one: Learned) -> list[str]:
    iron = ", ".join(f"{1e6 * x:.1f}" for x in one.chosen.locus.centre)
    return [f"{one.seconds:.0f} s", one.chosen.method, iron, *(f"{x:.2f}" for x in one.rms)]


def _case(one: Runs) -> list[str]:
    largest = ", ".join(f"{x:.2f}" for x in one.largest() / (1e-3 * GAUSS))
    return [one.case.name, f"{one.case.strip:g}", f"{one.case.noise:g}", largest, f"{100.0 * one.diverged[1]:.0f}"]


def picture(learned: Sequence[Learned], strips: Sequence[Runs], claim: Claim) -> bytes:
    """Heading errors over time, and errors of the two steps in z beside the batch that diverges."""
    with figure(1, 2, size=(12.5, 4.8), below=0.35) as (drawing, (over_time, cases)):
        for one, colour in zip(learned, COLOURS, strict=False):
            label = f"{one.chosen.method} of the first {one.seconds:.0f} s, {one.rms[0]:.1f} deg rms after it"
            over_time.plot(one.time, np.degrees(one.error), color=colour, lw=0.7, label=label)
        over_time.set(xlabel="time, s", ylabel="error of the heading, deg", ylim=(-25.0, 25.0))
        over_time.legend()
        title(drawing, over_time, claim.sentence)
        place = np.arange(len(strips))
        for i, (name, colour) in enumerate(zip("xyz", COLOURS, strict=False)):
            largest = [one.largest()[i] / (1e-3 * GAUSS) for one in strips]
            cases.bar(place + 0.2 * (i - 1), largest, 0.18, color=colour, label=f"two steps, {name}")
        cases.axhline(HELD, color=GREY, lw=1, ls="--")
        labels = [f"{one.case.strip:g} deg\n{one.case.noise:g} mG\n{_case(one)[-1]} %" for one in strips]
        cases.set_xticks(place, labels)
        cases.set_xlabel("strip of the sphere; noise; runs in which the batch diverges")
        cases.set_ylabel("largest error of the hard iron, mG")
        cases.legend()
        title(drawing, cases, f"Table 3.3, {len(strips[0].batch)} runs a case")
        return png(drawing)
