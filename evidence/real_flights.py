"""Recorded flights as the truth, with the real DME stations around them.

The environment variable NAVFMU_DATA names a folder with ``flights/NAME.csv`` (as ``navfmu track`` reads them) and
``dme_stations.csv`` (as ``navfmu stations`` reads it, which chooses the same stations). None of this data is part of
the project. All flights that are there are flown, and the first once more far in the north, where the magnetic field is
steep.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from evidence.recorded import picture
from evidence.recorded.figures import GONE, LIMIT, SETTLED, Angle, Position, angles, position
from evidence.recorded.flight import LOST, SEEDS, VARIANTS, Flown, dip, fly, moved
from evidence.section import Section, left_out, recorded
from navfmu.constants import NAUTICAL_MILE
from navfmu.files.writing import write_file
from navfmu.navaids import file as station_file
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

HEADING = "Real flights"
NORTH = 69.0
"""Latitude at which the moved flight begins, deg: dip 78 degrees."""
HONEST = {"heading": (0.7, 1.3), "roll": (0.5, 1.5), "pitch": (0.5, 1.5)}
"""Bounds of the mean normalised squared error of an angle."""
NEES = (1.4, 2.6)
"""The same of a position, which has two components."""
INSIDE, WITHIN = 98.5, 95.0
"""Of the time, in percent, that heading and position shall be within their own three sigma."""
HEADING_RMS, STEEP = 1.6, 2.6 * np.cos(np.radians(78.0))
"""Bounds of the heading's error, deg: the first, or the second over cos(dip) where that is more, which is from a dip of
70 degrees on (2.6 degrees at 78, 3.5 at 81). What turns the needle, an error of the level or a field of the aircraft,
has only the horizontal part of Earth's field against it, and that goes with cos(dip)."""
CHANCE = 1.0e-3
"""Probability with which an honest navigator has a run beyond the bound of a worst run."""

SHOWN = [
    "flight", "seeds", "dip, deg", "heading, deg rms", "heading NEES", "worst run", "inside 3 sigma, %",
    "roll NEES", "worst run", "pitch NEES", "worst run",
]  # fmt: skip
NAVIGATED = [
    "flight", "navigator", "median, m", "95 %, m", "largest, m", "above 926 m, %", "NEES (2)", "worst run",
    "inside 3 sigma, %", "ranges used", "rejected", "lost, min", "longest, min",
]  # fmt: skip
EXPLAINED = (
    f"{SEEDS} seeds for each flight and navigator, which follow from the flight's name; GPS is lost at minute "
    f"{LOST / 60:.0f} until the end. NEES is the mean normalised squared error: of an honest filter 1 for an angle and "
    "2 for a position. ± is half of the 95 % interval over the seeds. The worst run stands beside what the worst of as "
    f"many honest ones exceeds with a probability of {100 * CHANCE:g} %, by the chi-square of as many degrees of "
    "freedom as the correlation of the errors leaves a run. A navigator is lost while it is outside of its "
    f"own 3 sigma for longer than {GONE:.0f} s at a stretch; minutes and ranges are means over the seeds, the longest "
    f"is of any. The attitude is judged after {SETTLED:.0f} s and is the same for every navigator."
)


def run(out: Path) -> Section:
    """Import, choose stations, fly; the tables and the picture are also written as OUT/recorded_flights.md and .png."""
    folder, lacking = recorded("dme_stations.csv", "flights/*.csv")
    if lacking:
        return left_out(HEADING, lacking)
    files = {file.stem: file for file in sorted((folder / "flights").glob("*.csv"))}
    first = next(iter(files))
    files[f"{first}_in_the_north"] = moved(files[first], NORTH, out / "moved.csv")
    stations = station_file.read(folder / "dme_stations.csv").stations
    each = 1 + SEEDS
    with Progress("real flights") as progress:
        flown = [
            fly(
                name,
                file,
                stations,
                out / name,
                lambda done, note, n=n: progress(n * each + done, len(files) * each, note),
            )
            for n, (name, file) in enumerate(files.items())
        ]
    judged = [Judged(flight) for flight in flown]
    write_file(out / "recorded_flights.md", document(judged).encode())
    write_file(out / "recorded_flights.png", sigmas(judged))
    return section(judged)


@dataclass(frozen=True)
class Judged:
    """A flight and how its navigators did."""

    flown: Flown

    @cached_property
    def angles(self) -> dict[str, Angle]:
        """The attitude's errors by angle."""
        return angles(self.flown)

    @cached_property
    def positions(self) -> dict[str, Position]:
        """The position's errors by variant; none where there are no stations."""
        return {v: position(runs) for v, runs in self.flown.runs.items()} if self.flown.has_stations else {}

    def claims(self) -> list[Claim]:
        """The navigator knows how wrong it is, on flights that nobody made for it."""
        title, heading = self.flown.title, self.angles["heading"]
        claims = [
            Claim(
                f"{title}: the heading is within its own 3 sigma", heading.inside.value, INSIDE, unit="%",
                opposite=f"{title}: the heading is outside of its own 3 sigma too often",
            ),
            Claim(
                f"{title}: the heading's error, rms", heading.rms, heading_bound(dip(self.flown.track)), False, "deg",
                f"{title}: the heading's error is too large",
            ),
        ]  # fmt: skip
        for name, (least, most) in HONEST.items():
            nees = self.angles[name].nees.value
            claims += [
                Claim(f"{title}: the {name} is not overconfident (NEES)", nees, most, False, "",
                      f"{title}: the {name} is overconfident (NEES)"),
                Claim(f"{title}: the {name} is not overcautious (NEES)", nees, least, True, "",
                      f"{title}: the {name} is overcautious (NEES)"),
                self.worst(f"{title}: the {name}", self.angles[name]),
            ]  # fmt: skip
        for v, p in self.positions.items():
            who = f"{title}, {VARIANTS[v]}: the position"
            claims += [
                Claim(f"{who} is within the navigator's own 3 sigma", p.inside.value, WITHIN, unit="%",
                      opposite=f"{who} is outside of the navigator's own 3 sigma too often"),
                Claim(f"{who} is not overconfident (NEES)", p.nees.value, NEES[1], False, "",
                      f"{who} is overconfident (NEES)"),
                Claim(f"{who} is not overcautious (NEES)", p.nees.value, NEES[0], True, "",
                      f"{who} is overcautious (NEES)"),
                self.worst(who, p),
            ]  # fmt: skip
        return claims

    @staticmethod
    def worst(who: str, of: Angle | Position) -> Claim:
        """No single run is further off than chance makes one of so many."""
        return Claim(
            f"{who} is not overconfident in any single run (NEES)", of.nees.most, of.worst(CHANCE), False, "",
            f"{who} is overconfident in a single run (NEES)",
        )  # fmt: skip

    def attitude_row(self) -> list[str]:
        """What SHOWN names."""
        heading, seeds = self.angles["heading"], self.flown.seeds
        return [
            self.flown.title, f"{seeds[0]} to {seeds[-1]}", f"{abs(dip(self.flown.track)):.0f}",
            f"{heading.rms:.2f}", str(heading.nees), single(heading), f"{heading.inside.value:.1f}",
            *(text for name in ("roll", "pitch") for text in (str(self.angles[name].nees), single(self.angles[name]))),
        ]  # fmt: skip

    def position_rows(self) -> list[list[str]]:
        """What NAVIGATED names, for each variant."""
        return [
            [
                self.flown.title, VARIANTS[v], f"{p.median:.0f}", f"{p.percentile:.0f}", f"{p.largest:.0f}",
                f"{p.above:.1f}", str(p.nees), single(p), f"{p.inside.value:.1f}", f"{p.used:.0f}", f"{p.rejected:.0f}",
                f"{p.lost:.1f}", f"{p.longest:.1f}",
            ]
            for v, p in self.positions.items()
        ]  # fmt: skip

    def write(self, page: Page) -> None:
        """What was found in the recording, and the stations."""
        flown = self.flown
        hours = flown.track["time"][-1] / 3600
        page.text(f"{flown.title}: {hours:.1f} h from a recording of {len(flown.imported.recording)} rows.")
        page.items([*flown.imported.defects.sentences, *(claim.sentence for claim in self.claims())])
        page.table(
            ["residual", "unit", "rows", "rms", "95 %", "largest"],
            [[n, u, c, *(f"{v:.3g}" for v in rest)] for n, u, c, *rest in flown.imported.residual_table()],
        )
        if not flown.has_stations:
            return
        page.table(
            ["station", "name", "range, nmi", "usable, % of the flight"],
            [
                [s.ident, s.name, f"{s.range / NAUTICAL_MILE:.0f}", f"{100 * share:.0f}"]
                for s, share in zip(flown.chosen.stations, flown.chosen.share, strict=True)
            ],
        )
        page.picture(picture.of_flight(flown), f"{flown.title}: track, usable stations, HDOP and error")


def single(of: Angle | Position) -> str:
    """The worst run's normalised squared error, and its bound."""
    return f"{of.nees.most:.2f} of {of.worst(CHANCE):.2f}"


def heading_bound(dip: float) -> float:
    """Of the heading's error at a dip (deg), deg rms."""
    return max(HEADING_RMS, STEEP / np.cos(np.radians(dip)))


def section(judged: Sequence[Judged]) -> Section:
    """The claims on recorded flights, the figures of all, and for each its own account."""

    def write(page: Page) -> None:
        page.heading(HEADING)
        page.text(EXPLAINED)
        page.table(SHOWN, [each.attitude_row() for each in judged])
        page.table(NAVIGATED, [row for each in judged for row in each.position_rows()])
        page.picture(sigmas(judged), ". ".join(titles(judged)))
        for each in judged:
            each.write(page)

    return Section([claim for each in judged for claim in each.claims()], write)


def sigmas(judged: Sequence[Judged]) -> bytes:
    """The picture of how honest the sigmas are."""
    return picture.of_sigmas(
        {each.flown.name: each.angles for each in judged},
        {each.flown.name: each.positions for each in judged if each.positions},
        titles(judged),
    )


def titles(judged: Sequence[Judged]) -> tuple[str, str]:
    """What the two halves of the picture show."""
    claims = [claim for each in judged for claim in each.claims() if "NEES" in claim.text or "sigma" in claim.text]
    attitude = [claim for claim in claims if "position" not in claim.text]
    position = [claim for claim in claims if "position" in claim.text]
    return _title("Attitude", attitude), _title("Position without GPS", position)


def _title(what: str, claims: Sequence[Claim]) -> str:
    if not claims:
        return f"{what}: not judged on any flight"
    held = sum(claim.holds for claim in claims)
    return (
        f"{what}: as wrong as it says on every flight"
        if held == len(claims)
        else (f"{what}: {held} of {len(claims)} claims on its sigmas hold")
    )


def document(judged: Sequence[Judged]) -> str:
    """The page of the last figures in Markdown."""

    def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
        lines = ["| " + " | ".join(row) + " |" for row in [headings, *rows]]
        return [lines[0], "|---" * len(headings) + "|", *lines[1:], ""]

    hours = sum(each.flown.track["time"][-1] for each in judged) / 3600.0
    return "\n".join(
        [
            "# Recorded flights",
            "",
            f"{'. '.join(titles(judged))}. `python -m evidence real_flights` flies {len(judged)} of them, "
            f"{hours:.0f} h, and writes this page. The recordings are not part of the project ([tracks](tracks.md)). "
            f"{EXPLAINED} Where GPS is lost by the distance of a jammer: [flights past a jammer](jammed_flights.md).",
            "",
            "![Normalised squared errors of attitude and position on recorded flights](recorded_flights.png)",
            "",
            "## Attitude",
            "",
            *table(SHOWN, [each.attitude_row() for each in judged]),
            f"## Position, with an error above {LIMIT:.0f} m counted as above the requirement",
            "",
            *table(NAVIGATED, [row for each in judged for row in each.position_rows()]),
        ]
    )
