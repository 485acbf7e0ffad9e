"""Recorded flights past a jammer on the ground: where GPS is lost, beside the link budget, and how they coast.

The folder that NAVFMU_DATA names has the flights and stations of ``evidence.real_flights``. Each flight is flown with
GPS as signals of satellites and with GPS as positions, at other hours of the day, so that other satellites are above.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
import pymap3d

from evidence.recorded.flight import NORTH_EAST, Ready, seeds
from evidence.recorded.link import ENOUGH, LEAST, NEEDED, USED, Jammer, Link
from evidence.section import Section, left_out, recorded
from models.satellite import slots
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.navaids import file as station_file
from navfmu.navaids.station import Station
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system.system import System
from navfmu.terminal.progress import Progress

HEADING = "Recorded flights past a jammer"
POWER, BESIDE = 0.25, 5000.0
"""Of the jammer, W, and how far from the middle of the track it stands, m."""
AROUND = 25e3
"""What is shown of the track, m to each side."""
HOURS = (1, 9, 17)
"""Of the day, one for each run."""
LEVELS = {"signals": "gps_signals", "positions": None}
SETTLED = 30
"""From which second on GPS is there, and how long after it is back the navigator has settled."""
TRUTH = ("latitude", "longitude", "altitude", "roll", "pitch", "heading")
VALID = {"signals": "gps_solver.fix.valid", "positions": "gps.fix.valid"}
RECORDED = (
    NORTH_EAST,
    *(f"aircraft.{name}" for name in TRUTH),
    *(f"evaluation.{name}" for name in ("north_error", "east_error", "horizontal_error", "consistent")),
    *(f"navigator.{name}" for name in ("north_sigma", "east_sigma", "mode")),
)
SAME, APART, INSIDE, NEES, BACK = 99.0, 2.0, 95.0, (1.4, 2.6), 20.0
"""Bounds: seconds with and without GPS as foretold, %; distance where it is lost, %; position within 3 sigma, %; mean
normalised squared error of a position; error when GPS is back, m."""
SHOWN = (
    "flight", "GPS as", "times lost", "without GPS, min", "lost at, km", "as foretold within, m", "found at, km",
    "seconds as foretold, %", "error without GPS: median, m", "95 %, m", "largest, m", "inside 3 sigma, %", "NEES (2)",
    "error when back, 95 %, m",
)  # fmt: skip
EXPLAINED = (
    f"A jammer of {POWER:g} W stands {BESIDE / 1e3:g} km beside the middle of the track, on the ground, from beginning "
    "to end. Satellites are lost where the link budget (free space, the antenna's pattern and the aircraft's attitude) "
    f"leaves less than {LEAST:g} dB-Hz, and found when C/N0 has been above {ENOUGH:g} dB-Hz for {NEEDED} s; a fix "
    "needs four above 10 degrees and a PDOP of at most 20. Foretold is what a budget outside of the FMUs says of the "
    f"same second; as positions all satellites are one of 42.5 dB-Hz. {len(HOURS)} runs a flight, at {HOURS[0]}, "
    f"{HOURS[1]} and {HOURS[2]} h of the day of the slots; one DME receiver. Distances are those to the "
    "jammer, the middle of times and the least and the greatest. NEES is 2 for an honest filter."
)


@dataclass(frozen=True)
class Run:
    """A flight with a level of GPS at an hour: values by name, each (seconds,), and what the budget says."""

    values: dict[str, np.ndarray]
    link: Link
    level: str

    @cached_property
    def fix(self) -> np.ndarray:
        return self.values[VALID[self.level]] > 0.0

    @cached_property
    def foretold(self) -> np.ndarray:
        return self.link.fix if self.level == "signals" else self.link.positions

    @cached_property
    def coasting(self) -> np.ndarray:
        return (self.values["navigator.mode"] == 2) & (np.arange(len(self.fix)) > SETTLED)

    @cached_property
    def same(self) -> np.ndarray:
        return (self.fix == self.foretold)[SETTLED:]

    def changes(self, fix: np.ndarray, to: bool) -> np.ndarray:
        """Seconds at which GPS is lost, or found."""
        return np.flatnonzero((fix[1:] == to) & (fix[:-1] != to) & (np.arange(1, len(fix)) > SETTLED)) + 1

    def far(self, to: bool) -> np.ndarray:
        """Distances at which it is lost, or found, m."""
        return self.link.distance[self.changes(self.fix, to)]

    @cached_property
    def apart(self) -> np.ndarray:
        """Of each loss the distance to where the nearest one in time is foretold, m."""
        ours, theirs = self.changes(self.fix, False), self.changes(self.foretold, False)
        if not len(theirs):
            return np.full(len(ours), np.inf)
        nearest = theirs[np.argmin(np.abs(ours[:, None] - theirs), axis=1)]
        return np.abs(self.link.distance[ours] - self.link.distance[nearest])

    @cached_property
    def squares(self) -> np.ndarray:
        """Normalised squared errors of the position, (seconds,)."""
        north, east = self.values["evaluation.north_error"], self.values["evaluation.east_error"]
        a, c = self.values["navigator.north_sigma"] ** 2, self.values["navigator.east_sigma"] ** 2
        b = self.values[NORTH_EAST]
        with np.errstate(divide="ignore", invalid="ignore"):  # before there is a position
            return (c * north**2 - 2.0 * b * north * east + a * east**2) / (a * c - b * b)

    @cached_property
    def outages(self) -> list[tuple[int, int]]:
        """First and last second of each time without GPS, by the navigator."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], self.coasting, [False]]).astype(int)))
        return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]

    @cached_property
    def back(self) -> np.ndarray:
        """Error SETTLED seconds after each outage, where GPS is there until then, m."""
        error = self.values["evaluation.horizontal_error"]
        ends = [last + SETTLED for _, last in self.outages if last + SETTLED < len(error)]
        return np.array([error[k] for k in ends if not np.any(self.coasting[k - SETTLED + 1 : k + 1])])


@dataclass(frozen=True)
class Flight:
    """All runs of a recorded flight, by level."""

    name: str
    jammer: Jammer
    runs: dict[str, list[Run]]

    @property
    def title(self) -> str:
        return self.name.replace("_", " ").capitalize()

    def all(self, level: str, of: Callable[[Run], np.ndarray]) -> np.ndarray:
        """What each run has of something, in one."""
        return np.concatenate([of(run) for run in self.runs[level]])

    def row(self, level: str) -> list[str]:
        """What SHOWN names."""
        error = self.all(level, lambda run: run.values["evaluation.horizontal_error"][run.coasting])
        lost, found = (self.all(level, lambda run, to=to: run.far(to)) for to in (False, True))
        inside = self.all(level, lambda run: run.values["evaluation.consistent"][run.coasting])
        squares = self.all(level, lambda run: run.squares[run.coasting])
        back = self.all(level, lambda run: run.back)
        return [
            self.title, level, str(len(lost)), f"{len(error) / 60 / len(self.runs[level]):.0f}", _span(lost),
            f"{_most(self.all(level, lambda run: run.apart)):.0f}", _span(found),
            f"{100 * np.mean(self.all(level, lambda run: run.same)):.2f}",
            *(f"{np.percentile(error, q):.0f}" if len(error) else "" for q in (50, 95, 100)),
            f"{100 * np.mean(inside):.1f}" if len(inside) else "", f"{np.mean(squares):.2f}" if len(squares) else "",
            f"{np.percentile(back, 95):.1f}" if len(back) else "",
        ]  # fmt: skip


def _span(distances: np.ndarray) -> str:
    if not len(distances):
        return ""
    return f"{np.median(distances) / 1e3:.1f} ({np.min(distances) / 1e3:.1f} to {np.max(distances) / 1e3:.1f})"


def _most(values: np.ndarray) -> float:
    return float(np.max(values, initial=0.0))


def run(out: Path) -> Section:
    """Fly all flights that are there; the page and the picture are also written as OUT/jammed_flights.md and .png."""
    folder, lacking = recorded("dme_stations.csv", "flights/*.csv")
    if lacking:
        return left_out(HEADING, lacking)
    stations = station_file.read(folder / "dme_stations.csv").stations
    files = sorted((folder / "flights").glob("*.csv"))
    each = 1 + len(HOURS) * len(LEVELS)
    with Progress("jammed flights") as progress:
        flights = []
        for n, file in enumerate(files):

            def told(done: int, note: str, n: int = n) -> None:
                progress(n * each + done, len(files) * each, note)

            flights.append(fly(file, stations, out / "jammed" / file.stem, told))
    write_file(out / "jammed_flights.md", document(flights).encode())
    write_file(out / "jammed_flights.png", picture(flights))
    return section(flights)


def fly(file: Path, stations: Sequence[Station], out: Path, progress: Callable[[int, str], None]) -> Flight:
    """Fly a recording past the jammer, with both levels of GPS at each hour."""
    name = file.stem
    progress(0, f"importing {name}")
    ready = Ready.of(name, file, stations, out)
    jammer = beside(ready.track)
    systems = {level: System.load(ready.system, variant) for level, variant in LEVELS.items()}
    parameters = {f"gps.jammer_{key}[1]": getattr(jammer, key) for key in ("latitude", "longitude", "altitude")}
    parameters["gps.acquisition_time"] = float(NEEDED)
    week, second = slots.EPOCH

    def one(k: int, level: str) -> Run:
        begins = second + 3600.0 * HOURS[k]
        own = {"gps.start_seconds": begins} if level == "signals" else {"gps.attitude_period": 1.0}
        recording = systems[level].run(
            stop=float(np.floor(ready.track["time"][-1])),
            step=0.01,
            seed=seeds(name)[k],
            faults=[Fault("jammer", "gps.jammer_power[1]", "input", start=0.0, value=jammer.power)],
            parameters={**parameters, **own},
            record=[*RECORDED, VALID[level]],
            record_period=1.0,
        )
        values = {key: recording[key].to_numpy(float) for key in recording}
        return Run(values, Link.of({key: values[f"aircraft.{key}"] for key in TRUTH}, week, begins, jammer), level)

    cases = [(k, level) for level in LEVELS for k in range(len(HOURS))]
    runs: dict[str, list[Run]] = {level: [] for level in LEVELS}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, flown in enumerate(pool.map(lambda case: one(*case), cases), 1):
            runs[flown.level].append(flown)
            progress(done, f"flying {name}")
    return Flight(name, jammer, runs)


def beside(track: dict[str, np.ndarray]) -> Jammer:
    """To the right of the middle of a track, as high as the flight was at its lowest."""
    latitude, longitude = track["latitude"], track["longitude"]
    middle = len(latitude) // 2
    before, here, after = middle - 1, middle, middle + 1
    north, east, _ = pymap3d.geodetic2ned(
        latitude[after], longitude[after], 0.0, latitude[before], longitude[before], 0.0, deg=False
    )
    right = np.arctan2(east, north) + 0.5 * np.pi
    place = pymap3d.ned2geodetic(
        BESIDE * np.cos(right), BESIDE * np.sin(right), 0.0, latitude[here], longitude[here], 0.0, deg=False
    )
    return Jammer(float(place[0]), float(place[1]), float(np.min(track["altitude"])), POWER)


def claims(flights: Sequence[Flight]) -> list[Claim]:
    """GPS is lost where the budget says, and the navigator carries on and knows how well, with either level."""
    made = []
    for level in LEVELS:
        runs = [run for flight in flights for run in flight.runs[level]]
        who = f"GPS as {level}"

        def all_of(of: Callable[[Run], np.ndarray], runs: Sequence[Run] = runs) -> np.ndarray:
            return np.concatenate([of(run) for run in runs])

        away = 100.0 * _most(all_of(lambda run: run.apart / run.link.distance[run.changes(run.fix, False)]))
        squares = float(np.mean(all_of(lambda run: run.squares[run.coasting])))
        inside = 100.0 * float(np.mean(all_of(lambda run: run.values["evaluation.consistent"][run.coasting])))
        made += [
            Claim(
                f"{who}: it is there and not as the link budget foretells, of the seconds",
                100.0 * float(np.mean(all_of(lambda run: run.same))), SAME, unit="%",
                opposite=f"{who}: it is there or not otherwise than the link budget foretells",
            ),
            Claim(f"{who}: it is lost at the distance that the link budget foretells, within", away, APART, False, "%",
                  f"{who}: it is lost at another distance than the link budget foretells"),
            Claim(f"{who}: without it the position is within the navigator's own 3 sigma", inside, INSIDE, unit="%",
                  opposite=f"{who}: without it the position is outside of the navigator's own 3 sigma too often"),
            Claim(f"{who}: without it the navigator is not overconfident (NEES)", squares, NEES[1], False, "",
                  f"{who}: without it the navigator is overconfident (NEES)"),
            Claim(f"{who}: without it the navigator is not overcautious (NEES)", squares, NEES[0], True, "",
                  f"{who}: without it the navigator is overcautious (NEES)"),
            Claim(f"{who}: {SETTLED} s after it is back the error is that of GPS (95 %)",
                  float(np.percentile(all_of(lambda run: run.back), 95)), BACK, False, "m",
                  f"{who}: {SETTLED} s after it is back the error is not yet that of GPS"),
        ]  # fmt: skip
    return made


def rows(flights: Sequence[Flight]) -> list[list[str]]:
    """What SHOWN names, for each flight and level."""
    return [flight.row(level) for flight in flights for level in LEVELS]


def section(flights: Sequence[Flight]) -> Section:
    """Claims, table and picture."""
    found = claims(flights)

    def write(page: Page) -> None:
        page.heading(HEADING)
        page.text(EXPLAINED)
        page.items(f"{claim.sentence}: {claim.finding}" for claim in found)
        page.table(SHOWN, rows(flights))
        page.picture(picture(flights), titles(found)[0])

    return Section(found, write)


def titles(found: Sequence[Claim]) -> tuple[str, str]:
    """What the picture shows of distances and of errors."""
    foretold = all(claim.holds for claim in found if "foretells" in claim.text)
    honest = all(claim.holds for claim in found if "without it" in claim.text)
    return (
        "GPS is lost where the link budget says" if foretold else "GPS is lost elsewhere than the link budget says",
        "Without GPS: as wrong as it says" if honest else "Without GPS: not as wrong as it says",
    )


def document(flights: Sequence[Flight]) -> str:
    """The page of the last figures in Markdown."""
    found = claims(flights)
    lines = ["| " + " | ".join(row) + " |" for row in [SHOWN, *rows(flights)]]
    return "\n".join(
        [
            f"# {HEADING}",
            "",
            f"{'. '.join(titles(found))}. `python -m evidence jammed_flights` flies {len(flights)} recordings and "
            f"writes this page; they are not part of the project ([tracks](tracks.md)). {EXPLAINED}",
            "",
            "![A flight past a jammer; distances and errors of all](jammed_flights.png)",
            "",
            *(f"- {claim.sentence}: {claim.finding} ({claim.limit})" for claim in found),
            "",
            lines[0],
            "|---" * len(SHOWN) + "|",
            *lines[1:],
            "",
        ]
    )


def picture(flights: Sequence[Flight]) -> bytes:
    """The flight that goes farthest from the jammer at its first hour of the day, and distances and errors of all."""
    shown = max(flights, key=lambda flight: np.max(flight.runs["signals"][0].link.distance))
    one = shown.runs["signals"][0]
    where, what = titles(claims(flights))
    with figure(2, 3, size=(17.0, 9.0)) as (drawing, axes):
        track, strength, count, error, distances, outages = np.ravel(axes)
        _track(track, shown, one)
        minutes = np.arange(len(one.fix)) / 60.0
        fourth = np.sort(np.where(one.link.elevation >= USED, one.link.strength, 0.0), axis=1)[:, -4]
        for state, colour, label in ((True, COLOURS[0], "with GPS"), (False, COLOURS[1], "without")):
            strength.semilogx(one.link.distance[one.fix == state] / 1e3, fourth[one.fix == state], ".", ms=2,
                              color=colour, label=label)  # fmt: skip
        strength.axhline(LEAST, color="black", lw=1, label=f"lost below {LEAST:g}")
        strength.axhline(ENOUGH, color="black", lw=1, ls="--", label=f"found above {ENOUGH:g}")
        strength.set_ylim(0.0, 55.0)
        strength.set_xlabel("distance of the jammer, km")
        strength.set_ylabel("C/N0 of the fourth satellite, dB-Hz")
        strength.legend(fontsize=8)
        title(drawing, strength, "The signals are weak where the jammer is near")
        count.step(minutes, one.link.tracked.sum(axis=1), color=COLOURS[0], lw=1, label="tracked, by the budget")
        count.step(minutes, one.fix * 1.0, color=COLOURS[1], lw=1, label="fix of the solver (0, 1)")
        count.set_ylabel("satellites")
        count.legend(fontsize=8)
        title(drawing, count, "With fewer than four there is no fix")
        values = one.values
        sigma = 3.0 * np.hypot(values["navigator.north_sigma"], values["navigator.east_sigma"])
        error.semilogy(minutes[1:], values["evaluation.horizontal_error"][1:], color=COLOURS[0], lw=0.8, label="error")
        error.semilogy(minutes[1:], sigma[1:], color=COLOURS[1], lw=0.8, label="3 sigma")
        error.axhline(926.0, color=GREY, lw=1)
        for first, last in one.outages:
            error.axvspan(first / 60.0, last / 60.0, color=GREY, alpha=0.15, lw=0)
        error.set_ylim(0.1, None)
        error.set_ylabel("horizontal error, m")
        error.legend(fontsize=8)
        title(drawing, error, what)
        for axis in (count, error):
            axis.set_xlabel(f"time, min ({shown.title})")
        for (level, mark), colour in zip((("positions", "s"), ("signals", "o")), COLOURS, strict=False):
            pairs = np.concatenate([_pairs(run) for flight in flights for run in flight.runs[level]])
            distances.plot(*pairs.T / 1e3, mark, ms=4, mfc="none", color=colour, label=f"GPS as {level}")
            ends = [(last - first + 1, values_of(run, first, last)) for flight in flights for run in flight.runs[level]
                    for first, last in run.outages]  # fmt: skip
            outages.loglog(*np.array(ends).T, mark, ms=4, mfc="none", color=colour, label=f"GPS as {level}")
        most = distances.get_xlim()[1]
        distances.plot([0.0, most], [0.0, most], color=GREY, lw=1)
        distances.set_xlabel("distance of the jammer where GPS is lost, foretold, km")
        distances.set_ylabel("in the flight, km")
        distances.legend(fontsize=8)
        title(drawing, distances, where)
        outages.axhline(926.0, color=GREY, lw=1)
        outages.set_xlabel("time without GPS, s")
        outages.set_ylabel("largest error in it, m")
        outages.legend(fontsize=8)
        title(drawing, outages, "Errors grow with the time without GPS, all flights")
        return png(drawing)


def values_of(run: Run, first: int, last: int) -> float:
    """Largest horizontal error of these seconds, m."""
    return float(np.max(run.values["evaluation.horizontal_error"][first : last + 1]))


def _pairs(run: Run) -> np.ndarray:
    """Distances of each loss, foretold and flown, m."""
    ours, theirs = run.changes(run.fix, False), run.changes(run.foretold, False)
    if not len(ours) or not len(theirs):
        return np.zeros((0, 2))
    nearest = theirs[np.argmin(np.abs(ours[:, None] - theirs), axis=1)]
    return np.stack([run.link.distance[nearest], run.link.distance[ours]], axis=1)


def _track(axis, flight: Flight, run: Run) -> None:
    latitude, longitude = (np.degrees(run.values[f"aircraft.{name}"]) for name in ("latitude", "longitude"))
    for state, colour, label in ((True, COLOURS[0], "with GPS"), (False, COLOURS[1], "without")):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], run.fix == state, [False]]).astype(int)))
        for k, (a, b) in enumerate(list(pairwise(edges))[::2]):
            axis.plot(longitude[a:b], latitude[a:b], color=colour, lw=1, label=label if k == 0 else None)
    axis.plot(np.degrees(flight.jammer.longitude), np.degrees(flight.jammer.latitude), "*", ms=12, color="black",
              label=f"jammer, {flight.jammer.power:g} W")  # fmt: skip
    here, near = (np.degrees(x) for x in (flight.jammer.longitude, flight.jammer.latitude)), AROUND / 111e3
    for limit, middle, side in zip((axis.set_xlim, axis.set_ylim), here, (1.6 * near, near), strict=True):
        limit(middle - side, middle + side)
    axis.set_aspect(1.0 / np.cos(flight.jammer.latitude))
    axis.locator_params(axis="x", nbins=5)
    axis.set_xlabel("longitude, deg")
    axis.set_ylabel("latitude, deg")
    axis.legend(fontsize=8)
    axis.set_title(f"{flight.title}: GPS is lost near the jammer")
