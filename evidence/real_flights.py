"""Recorded flights as the truth, with the real DME stations around them.

The environment variable NAVFMU_DATA names a folder with ``flights/NAME.csv`` (as ``navfmu track`` reads them) and
``dme_stations.csv`` (region, row_type, ident, latitude_deg, longitude_deg, elevation_ft, frequency_mhz, range_nmi,
bias_nmi, name). None of this data is part of the project.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pymap3d

from fmus.stations import FOOT, NAUTICAL_MILE, PLACES, Station, StationSet
from models import dme, magnetic_field
from navfmu.faults import Fault
from navfmu.recorded.archive import write_fmu
from navfmu.recorded.importer import import_track
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.system import shipped
from navfmu.system.system import System
from navfmu.terminal.progress import Progress
from system_ssp.backup_navigator.system import source

FLIGHTS = ("toulouse", "sydney")
SEEDS = range(1, 11)
LOST = 300.0
DATE = 2026.0
ANTENNA = 10.0
VARIANTS = {"main": "one receiver", "scanning": "scanning receiver"}


def run(out: Path, page: Page) -> None:
    """Import, choose stations, fly with GPS lost at minute 5 until the end."""
    page.heading("Real flights")
    folder = os.environ.get("NAVFMU_DATA")
    if not folder:
        page.text("Left out: the environment variable NAVFMU_DATA does not name a folder with recorded flights.")
        return
    stations = pd.read_csv(Path(folder) / "dme_stations.csv")
    with Progress("real flights") as progress:
        for number, name in enumerate(FLIGHTS):
            note = f"importing {name}"
            progress(number * (1 + len(SEEDS)), len(FLIGHTS) * (1 + len(SEEDS)), note)
            _fly(name, Path(folder) / "flights" / f"{name}.csv", stations, out / name, page, progress, number)


def _fly(name, file, stations, out, page, progress, number):
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
    flights: dict[str, list[pd.DataFrame]] = {}
    for i, seed in enumerate(SEEDS):
        progress(number * (1 + len(SEEDS)) + 1 + i, len(FLIGHTS) * (1 + len(SEEDS)), f"flying {name}")
        for variant in VARIANTS:
            loaded = System.load(system, None if variant == "main" else variant)
            flights.setdefault(variant, []).append(
                loaded.run(stop=stop, step=0.01, seed=seed, faults=jammed, record=signals, record_period=1.0)
            )

    page.text(f"{name.capitalize()}: {stop / 3600:.1f} h from a recording of {len(imported.recording)} rows.")
    page.items(imported.defects.sentences)
    page.table(
        ["residual", "unit", "rows", "rms", "95 %", "largest"],
        [[n, u, c, *(f"{v:.3g}" for v in rest)] for n, u, c, *rest in imported.residual_table()],
    )
    page.table(
        ["station", "name", "range, n.mi.", "usable, % of the flight"],
        [[s.ident, s.name, f"{s.range:.0f}", f"{100 * share:.0f}"] for s, share in usable.shares(chosen)],
    )
    page.picture(_picture(name, track, usable, chosen, flights), f"{name}: track, usable stations, HDOP and error")
    rows = []
    for variant, label in VARIANTS.items():
        error = np.array([run["evaluation.horizontal_error"].to_numpy()[301:] for run in flights[variant]])
        inside = np.array([run["evaluation.consistent"].to_numpy()[301:] for run in flights[variant]], float)
        shares = (np.mean(error > 926.0), np.mean(inside))
        quantiles = (np.median(error), np.percentile(error, 95), np.max(error))
        rows.append([label, *(f"{q:.0f}" for q in quantiles), *(f"{100 * s:.1f}" for s in shares)])
    page.table(
        [f"{len(SEEDS)} seeds", "median, m", "95th percentile, m", "largest, m", "above 926 m, %", "inside 3 sigma, %"],
        rows,
    )


def _truth(fmu: Path) -> dict[str, np.ndarray]:
    loaded = System.load(fmu)
    component = next(iter(loaded.fmus))
    stop = loaded.fmus[component].description.stop_time
    names = ("latitude", "longitude", "altitude")
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
    system.parameters("magnetometer", {"date": DATE})
    system.parameters("ahrs", {"declination": float(magnetic_field.declination(field_n))})
    return system.pack(fmus / f"{name}.ssp")


def _picture(name, track, usable, chosen, flights) -> bytes:
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

        for colour, (variant, runs) in zip(COLOURS, flights.items(), strict=False):
            values = np.array([run["evaluation.horizontal_error"].to_numpy() for run in runs])
            time = runs[0].index.to_numpy() / 60.0
            error.plot(time, np.median(values, axis=0), color=colour, lw=1, label=f"{VARIANTS[variant]}: median")
            error.plot(time, np.percentile(values, 95, axis=0), color=colour, lw=0.7, ls="--", label="95th percentile")
        error.axhline(926.0, color=GREY, lw=1)
        error.axvline(LOST / 60.0, color=GREY, lw=1, ls=":")
        error.set_title(f"Horizontal error without GPS from minute {LOST / 60:.0f} on, {len(SEEDS)} seeds")
        error.set_xlabel("time, min")
        error.set_ylabel("m")
        error.legend(fontsize=8)
        return png(drawing)
