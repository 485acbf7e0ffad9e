"""Recorded flights as the truth, with the real DME stations around them.

The environment variable NAVFMU_DATA names a folder with ``flights/NAME.csv`` (as ``navfmu track`` reads them) and
``dme_stations.csv`` (region, row_type, ident, latitude_deg, longitude_deg, elevation_ft, frequency_mhz, range_nmi,
bias_nmi, name). None of this data is part of the project.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pymap3d

from evidence.section import Section, left_out
from fmus.stations import FOOT, NAUTICAL_MILE, PLACES, Station, StationSet
from models import dme, magnetic_field
from navfmu.faults import Fault
from navfmu.recorded.archive import write_fmu
from navfmu.recorded.importer import Imported, import_track
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.system import shipped
from navfmu.system.system import System
from navfmu.terminal.progress import Progress
from system_ssp.backup_navigator.system import source

HEADING = "Real flights"
FLIGHTS = ("toulouse", "sydney")
SEEDS = range(1, 11)
USUAL_LIFT, DENSITY = 0.5, 1.1
"""Lift coefficient at a flight's usual speed, from which its wing loading is guessed, and density of air, kg/m3."""
LOST = 300.0
DATE = 2026.0
ANTENNA = 10.0
VARIANTS = {"main": "one receiver", "scanning": "scanning receiver"}


SHARE = 95.0
"""Of the time, in percent, that the errors shall be within the navigator's own three sigma."""


def run(out: Path) -> Section:
    """Import, choose stations, fly with GPS lost at minute 5 until the end."""
    folder = os.environ.get("NAVFMU_DATA")
    if not folder:
        return left_out(HEADING, "the environment variable NAVFMU_DATA does not name a folder with recorded flights")
    files = {name: Path(folder) / "flights" / f"{name}.csv" for name in FLIGHTS}
    stations = Path(folder) / "dme_stations.csv"
    missing = [file for file in (stations, *files.values()) if not file.is_file()]
    if missing:
        return left_out(HEADING, f"there is no file {missing[0]}")
    table = pd.read_csv(stations)
    total = len(FLIGHTS) * (1 + len(SEEDS))
    with Progress("real flights") as progress:
        flown = [
            _fly(
                name,
                file,
                table,
                out / name,
                lambda done, note, n=number: progress(n * (1 + len(SEEDS)) + done, total, note),
            )
            for number, (name, file) in enumerate(files.items())
        ]
    return section(flown)


def section(flown: Sequence[Flown]) -> Section:
    """The claims on recorded flights, and for each its own account."""

    def write(page: Page) -> None:
        page.heading(HEADING)
        for flight in flown:
            flight.write(page)

    return Section([claim for flight in flown for claim in flight.claims()], write)


@dataclass(frozen=True)
class Flown:
    """One recorded flight, flown by every variant with every seed; GPS is lost at ``LOST``."""

    name: str
    imported: Imported
    track: dict[str, np.ndarray]
    usable: Usable
    chosen: list[int]
    runs: dict[str, list[pd.DataFrame]]  # by variant

    def coasting(self, variant: str, signal: str) -> np.ndarray:
        """A signal after the loss of GPS, one row for each seed."""
        return np.array([run[signal].to_numpy()[run.index > LOST] for run in self.runs[variant]], float)

    def claims(self) -> list[Claim]:
        """The navigator knows how wrong it is, on flights that nobody made for it."""
        return [
            Claim(
                f"{self.name.capitalize()}, {label}: the errors are within the navigator's own 3 sigma "
                f"for at least {SHARE:g} % of the time",
                100 * np.mean(self.coasting(variant, "evaluation.consistent")), SHARE, unit="%",
                opposite=f"{self.name.capitalize()}, {label}: the errors are outside the navigator's own 3 sigma "
                f"for more than {100 - SHARE:g} % of the time",
            )
            for variant, label in VARIANTS.items()
        ]  # fmt: skip

    def write(self, page: Page) -> None:
        """What was found in the recording, the stations, and how the navigator did."""
        imported, hours = self.imported, self.track["time"][-1] / 3600
        page.text(f"{self.name.capitalize()}: {hours:.1f} h from a recording of {len(imported.recording)} rows.")
        page.items([*imported.defects.sentences, *(claim.sentence for claim in self.claims())])
        page.table(
            ["residual", "unit", "rows", "rms", "95 %", "largest"],
            [[n, u, c, *(f"{v:.3g}" for v in rest)] for n, u, c, *rest in imported.residual_table()],
        )
        page.table(
            ["station", "name", "range, nmi", "usable, % of the flight"],
            [[s.ident, s.name, f"{s.range:.0f}", f"{100 * share:.0f}"] for s, share in self.usable.shares(self.chosen)],
        )
        page.picture(_picture(self), f"{self.name}: track, usable stations, HDOP and error")
        headings = ["median, m", "95th percentile, m", "largest, m", "above 926 m, %", "inside 3 sigma, %"]
        page.table([f"{len(SEEDS)} seeds", *headings], self.rows())

    def rows(self) -> list[list[str]]:
        """Quantiles and shares over all seeds and seconds without GPS; what is not finite is above every limit."""
        rows = []
        for variant, label in VARIANTS.items():
            error, inside = (self.coasting(variant, f"evaluation.{n}") for n in ("horizontal_error", "consistent"))
            quantiles = (np.median(error), np.percentile(error, 95, method="higher"), np.max(error))
            shares = (np.mean(~(error <= 926.0)), np.mean(inside))
            rows.append([label, *(f"{q:.0f}" for q in quantiles), *(f"{100 * s:.1f}" for s in shares)])
        return rows


def _fly(name: str, file: Path, stations: pd.DataFrame, out: Path, progress: Callable[[int, str], None]) -> Flown:
    progress(0, f"importing {name}")
    out.mkdir(parents=True, exist_ok=True)
    imported = import_track(file)
    for fmu in Path(shipped.path("imu.fmu")).parent.glob("*.fmu"):
        (out / fmu.name).write_bytes(fmu.read_bytes())
    write_fmu(imported, shipped.path("track.fmu"), out / f"{name}.fmu", name)
    track = _truth(out / f"{name}.fmu")
    usable = Usable(track, stations[stations["region"] == name])
    chosen = usable.choose()
    fixed = StationSet(f"around the flight {name}", tuple(usable.stations[i] for i in chosen))
    system = _system(name, out, fixed, track)
    stop = float(np.floor(track["time"][-1]))
    jammed = [Fault("gps", "gps.jammed", "input", start=LOST)]
    signals = ["evaluation.horizontal_error", "evaluation.consistent", "navigator.hdop"]
    runs: dict[str, list[pd.DataFrame]] = {variant: [] for variant in VARIANTS}
    for i, seed in enumerate(SEEDS):
        progress(1 + i, f"flying {name}")
        for variant, flown in runs.items():
            loaded = System.load(system, None if variant == "main" else variant)
            flown.append(loaded.run(stop=stop, step=0.01, seed=seed, faults=jammed, record=signals, record_period=1.0))
    return Flown(name, imported, track, usable, chosen, runs)


def _truth(fmu: Path) -> dict[str, np.ndarray]:
    loaded = System.load(fmu)
    component = next(iter(loaded.fmus))
    stop = loaded.fmus[component].description.stop_time
    names = ("latitude", "longitude", "altitude", "true_airspeed")
    signals = [f"{component}.{name}" for name in names]
    run = loaded.run(stop=float(np.floor(stop)), step=1.0, record=signals, record_period=10.0)
    return {"time": run.index.to_numpy()} | {name: run[f"{component}.{name}"].to_numpy() for name in names}


class Usable:
    """Which stations of a region can be received along a track, and what geometry they give."""

    def __init__(self, track: dict[str, np.ndarray], table: pd.DataFrame) -> None:
        table = table[table["bias_nmi"] == 0.0].drop_duplicates("ident")
        self.stations = [
            Station(r.ident, r.name_, r.latitude_deg, r.longitude_deg, r.elevation_ft, r.frequency_mhz, r.range_nmi)
            for r in table.rename(columns={"name": "name_"}).itertuples()
        ]
        self.north, self.east, self.inside = [], [], []
        for station in self.stations:
            height = station.elevation * FOOT
            azimuth, _, distance = pymap3d.geodetic2aer(
                track["latitude"], track["longitude"], track["altitude"],
                np.radians(station.latitude), np.radians(station.longitude), height, deg=False,
            )  # fmt: skip
            reach = np.minimum(dme.horizon(track["altitude"], height, ANTENNA), station.range * NAUTICAL_MILE)
            self.north.append(np.cos(azimuth))
            self.east.append(np.sin(azimuth))
            self.inside.append(distance <= reach)
        self.north, self.east, self.inside = (np.array(a) for a in (self.north, self.east, self.inside))

    def hdop(self, chosen) -> np.ndarray:
        """Dilution of precision along the track with these stations; 99 where two lines do not cross."""
        weights = self.inside[chosen]
        return np.array(
            [
                dme.dilution(n, e, w)
                for n, e, w in zip(self.north[chosen].T, self.east[chosen].T, weights.T, strict=True)
            ]
        )

    def choose(self) -> list[int]:
        """Up to five stations, each in turn the one that makes the mean of min(HDOP, 10) least; best pair first."""
        chosen: list[int] = []
        while len(chosen) < min(PLACES, len(self.stations)):
            left = [i for i in range(len(self.stations)) if i not in chosen and self.inside[i].any()]
            if not left:
                break
            if not chosen:
                pairs = [(self._cost([i, j]), i, j) for i in left for j in left if i < j]
                chosen = list(min(pairs)[1:]) if pairs else left[:1]
                continue
            cost, best = min((self._cost([*chosen, i]), i) for i in left)
            if cost >= self._cost(chosen) - 1e-3:
                break
            chosen.append(best)
        return chosen

    def _cost(self, chosen: list[int]) -> float:
        return float(np.mean(np.minimum(self.hdop(chosen), 10.0)))

    def shares(self, chosen: list[int]) -> list[tuple[Station, float]]:
        """The chosen stations and the share of the flight in which each can be received."""
        return [(self.stations[i], float(np.mean(self.inside[i]))) for i in chosen]


def _system(name: str, fmus: Path, stations: StationSet, track: dict[str, np.ndarray]) -> Path:
    system = source(fmus, aircraft=f"{name}.fmu", name=name)
    system.parameters("dme", {**stations.parameters(), **stations.ranges()})
    system.parameters("navigator", stations.parameters())
    middle = len(track["time"]) // 2
    field_n = magnetic_field.field(*(track[n][middle] for n in ("latitude", "longitude", "altitude")), DATE)
    cruise = float(np.median(track["true_airspeed"]))
    system.parameters("aircraft", {"wing_loading": USUAL_LIFT * 0.5 * DENSITY * cruise**2})
    system.parameters("magnetometer", {"date": DATE})
    system.parameters("ahrs", {"declination": float(magnetic_field.declination(field_n))})
    return system.pack(fmus / f"{name}.ssp")


def _picture(flown: Flown) -> bytes:
    name, track, usable, chosen = flown.name, flown.track, flown.usable, flown.chosen
    minutes = track["time"] / 60.0
    with figure(2, 2, size=(12.0, 8.0)) as (drawing, ((where, count), (dilution, error))):
        where.plot(np.degrees(track["longitude"]), np.degrees(track["latitude"]), color=COLOURS[0], lw=1, label="track")
        for i in chosen:
            station = usable.stations[i]
            where.plot(station.longitude, station.latitude, "^", color=COLOURS[1])
            where.annotate(station.ident, (station.longitude, station.latitude), xytext=(4, 4),
                           textcoords="offset points")  # fmt: skip
        where.set_aspect(1.0 / np.cos(np.mean(track["latitude"])))
        where.set_title(f"{name.capitalize()}: the flight and its DME stations")
        where.set_xlabel("longitude, deg")
        where.set_ylabel("latitude, deg")
        where.legend()

        count.step(minutes, usable.inside.sum(axis=0), color=GREY, label="in reach")
        count.step(minutes, usable.inside[chosen].sum(axis=0), color=COLOURS[0], label="of those chosen")
        count.set_title("Usable stations")
        count.set_xlabel("time, min")
        count.set_ylabel("number")
        count.legend()

        dilution.plot(minutes, np.minimum(usable.hdop(chosen), 10.0), color=COLOURS[0])
        dilution.set_title("Geometry: HDOP of the usable chosen stations (cut at 10)")
        dilution.set_xlabel("time, min")
        dilution.set_ylabel("HDOP")

        for colour, (variant, runs) in zip(COLOURS, flown.runs.items(), strict=False):
            values = np.array([run["evaluation.horizontal_error"].to_numpy() for run in runs])
            time = runs[0].index.to_numpy() / 60.0
            error.plot(time, np.median(values, axis=0), color=colour, lw=1, label=f"{VARIANTS[variant]}: median")
            error.plot(
                time,
                np.percentile(values, 95, axis=0, method="higher"),
                color=colour,
                lw=0.7,
                ls="--",
                label="95th percentile",
            )
        error.axhline(926.0, color=GREY, lw=1)
        error.axvline(LOST / 60.0, color=GREY, lw=1, ls=":")
        error.set_title(f"Horizontal error without GPS from minute {LOST / 60:.0f} on, {len(SEEDS)} seeds")
        error.set_xlabel("time, min")
        error.set_ylabel("m")
        error.legend(fontsize=8)
        return png(drawing)
