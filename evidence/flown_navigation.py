"""Navigation on recorded sensors of small aircraft whose GPS is taken away in flight, without and with DME.

The environment variable NAVFMU_DATA names a folder whose ``sensors/flights/`` has a folder for each flight, with
``imu``, ``magnetometer``, ``gps`` and ``air.parquet``: each is flown, whatever its name. They are not part of the
project.

Inertial unit, magnetometer, airspeed and GPS are played by FMUs; attitude is that of ``ahrs_velocity``, position that
of ``navigator``, both with the parameter set ``small_aircraft``. GPS is taken away every 10 s, until the end of the
flight; nothing is used that is learned after that, and nothing at all of the log's own filter.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from evidence.recorded_sensors import picture
from evidence.recorded_sensors.flight import FAST, flights
from evidence.recorded_sensors.flown import SEEDS, Cut, Flown, after, fix_sigma, fly
from evidence.section import Section, left_out, recorded
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

HEADING = "Recorded sensors, GPS taken away"
END = float("inf")
TIMES = {60.0: "after 60 s", 180.0: "after 180 s", END: "at the end of the flight"}
MOST, INSIDE = 1.5, 95.0
"""Median error over that of the baseline, and share of positions within 3 sigma, %."""
ENOUGH = 60.0
"""Cuts that are followed for as long count at the end, s."""
CHANCE = 1e-3
HEAD = (
    "flight", "GPS late by, s", "hard iron, uT", "cuts", "60 s: median, largest, m", "180 s", "at the end",
    "first cut, at the end", "inside 3 sigma, %", "NEES (2)",
)  # fmt: skip
OTHERS = ("flight", "navigator", "60 s: median, largest, m", "180 s", "at the end", "inside 3 sigma, %", "NEES (2)")
RANGED = (
    "flight",
    "60 s: median, largest, m",
    "180 s",
    "at the end",
    "at the end, rms, m",
    "inside 3 sigma, %",
    "NEES (2)",
)


def run(out: Path) -> Section:
    """Fly all flights that there are."""
    folder, lacking = recorded("*/imu.parquet", under="sensors/flights")
    if lacking:
        return left_out(HEADING, lacking)
    found, flown, refused = flights(folder), [], []
    with Progress("flying") as progress:
        for done, flight in enumerate(found):
            progress(done, len(found), flight.name)
            try:
                with tempfile.TemporaryDirectory(prefix="navfmu-") as made:
                    flown.append(fly(flight, Path(made)))
            except NavfmuError as error:
                refused.append(f"{flight.name}, because {error}")
                continue
            write_file(out / "flown_navigation" / f"{flight.name}.png", picture.drawn(flown[-1]))
    return section(flown, refused)


def section(flown: Sequence[Flown], refused: Sequence[str] = ()) -> Section:
    """What is claimed of flights whose inertial unit is fast enough, and a picture of each; ``refused`` are others."""
    claims = [claim for one in flown if one.flight.fast for claim in claimed(one)]

    def write(page: Page) -> None:
        page.heading(HEADING)
        page.text(
            f"Errors are to the recorded fixes, at the time at which these were valid. In brackets: reckoning with the "
            f"heading of the log's own filter, which kept GPS. Nothing is claimed of a flight with less than {FAST:g} "
            f"samples of the inertial unit in a second."
        )
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims)
        page.table([*HEAD], [alone(one) for one in flown])
        page.text("All navigators without DME:")
        page.table([*OTHERS], [row for one in flown for row in others(one)])
        page.text(
            f"With ranges to three DME stations at 20 km once a second, errors of 0.17 nmi (3.38), {SEEDS} seeds; a "
            f"fix by one range from each has a sigma of {fix_sigma():.0f} m."
        )
        page.table([*RANGED], [ranged(one) for one in flown])
        page.items(f"Not flown: {one}" for one in refused)
        for one in flown:
            page.picture(
                picture.drawn(one), f"{one.flight.name}: tracks and errors after each cut, without and with DME"
            )

    return Section(claims, write, "; ".join(refused))


def claimed(one: Flown) -> list[Claim]:
    """Of one flight."""
    name, made = one.flight.name, []
    for seconds, when in TIMES.items():
        ours, theirs = after(one.alone, seconds), one.reckoned(seconds)
        if len(ours) and len(theirs):
            made.append(Claim(
                f"{name}: {when} without GPS the median error is that of reckoning with the log's own heading",
                float(np.median(ours) / np.median(theirs)), MOST, False, "times that",
                opposite=f"{name}: {when} without GPS the median error is more than with the log's own heading",
            ))  # fmt: skip
    for words, cuts in (("without GPS", one.alone), ("with DME", one.ranged)):
        made.append(Claim(
            f"{name}: {words} positions are within 3 sigma", inside(cuts), INSIDE, True, "%",
            opposite=f"{name}: {words} positions are not within 3 sigma",
        ))  # fmt: skip
    made.append(Claim(
        f"{name}: with DME the error at the end is that of a fix, however long GPS is away",
        rms_at_end(one), bound(len(one.ranging)), False, "m rms",
        opposite=f"{name}: with DME the error at the end is more than that of a fix",
    ))  # fmt: skip
    return made


def bound(seeds: int) -> float:
    """What the rms of so many independent positions with the sigma of a fix exceeds with CHANCE, m.

    The cuts of one seed share the flight, and count as one.
    """
    from scipy.stats import chi2

    return float(fix_sigma() * np.sqrt(chi2.isf(CHANCE, 2 * seeds) / (2 * seeds)))


def rms_at_end(one: Flown) -> float:
    """Horizontal error with DME at the end, of cuts that are ENOUGH before it, m rms."""
    ends = [cut.after(END) for cut in one.ranged if cut.time <= one.flight.airborne[1] - ENOUGH]
    return float(np.sqrt(np.mean(np.square(ends)))) if ends else np.nan


def inside(cuts: Sequence[Cut]) -> float:
    """Share of positions within 3 sigma, %."""
    return float(100.0 * np.mean(np.concatenate([cut.inside for cut in cuts])))


def squares(cuts: Sequence[Cut]) -> float:
    """Mean of e' P^-1 e."""
    return float(np.mean(np.concatenate([cut.squares for cut in cuts])))


def told(ours: np.ndarray, theirs: np.ndarray | None = None) -> str:
    """Median and largest error, those of the baseline in brackets."""
    if not len(ours):
        return "-"
    beside = f" ({np.median(theirs):.0f}, {np.max(theirs):.0f})" if theirs is not None and len(theirs) else ""
    return f"{np.median(ours):.0f}, {np.max(ours):.0f}{beside}"


def alone(one: Flown) -> list[str]:
    """A row without DME."""
    iron = one.flight.hard_iron
    beside = f" ({one.baseline[0][1][-1]:.0f})" if one.baseline else ""
    return [
        one.flight.name,
        f"{one.late:.2f}",
        "not found" if iron is None else ", ".join(f"{1e6 * x:.0f}" for x in iron),
        str(len(one.alone)),
        *(told(after(one.alone, seconds), one.reckoned(seconds)) for seconds in TIMES),
        f"{one.alone[0].after(END):.0f}{beside}",
        f"{inside(one.alone):.1f}",
        f"{squares(one.alone):.2f}",
    ]


def others(one: Flown) -> list[list[str]]:
    """A row for each navigator without DME."""
    return [
        [
            one.flight.name,
            name,
            *(told(after(cuts, seconds)) for seconds in TIMES),
            f"{inside(cuts):.1f}",
            f"{squares(cuts):.2f}",
        ]
        for name, cuts in one.by.items()
    ]


def ranged(one: Flown) -> list[str]:
    """A row with DME."""
    return [
        one.flight.name,
        *(told(after(one.ranged, seconds)) for seconds in TIMES),
        f"{rms_at_end(one):.0f}",
        f"{inside(one.ranged):.1f}",
        f"{squares(one.ranged):.2f}",
    ]
