"""One recorded flight, flown by every variant of the navigator with every seed."""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from models.magnetic import magnetic_field
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.navaids import parameters
from navfmu.navaids.choice import choose
from navfmu.navaids.coverage import Coverage, Points
from navfmu.navaids.station import Station
from navfmu.recorded.archive import write_fmu
from navfmu.recorded.importer import Imported, import_track
from navfmu.system import shipped
from navfmu.system.system import System
from system_ssp.backup_navigator.system import source

SEEDS = 10
"""Seeds for each flight."""
LOST = 300.0
"""Time at which GPS is lost, s, for the rest of the flight."""
VARIANTS = {"main": "one receiver", "two_receivers": "two receivers", "scanning": "scanning receiver"}
ANGLES = ("roll", "pitch", "heading")
DATE = 2026.0
USUAL_LIFT, DENSITY = 0.5, 1.1
"""Lift coefficient at a flight's usual speed, from which its wing loading is guessed, and density of air, kg/m3."""
NORTH_EAST = "navigator.position_covariance[2]"
"""Covariance of north and east position: the second element of the first row."""
SIGNALS = [
    NORTH_EAST,
    *(f"evaluation.{name}" for name in ("north_error", "east_error", "horizontal_error", "consistent")),
    *(f"navigator.{name}" for name in ("north_sigma", "east_sigma", "hdop", "rejected", "used")),
    *(f"aircraft.{angle}" for angle in ANGLES),
    *(f"ahrs.attitude.{angle}" for angle in ANGLES),
    *(f"ahrs.attitude.{angle}_sigma" for angle in ANGLES),
]


@dataclass(frozen=True)
class Flown:
    """One recorded flight; GPS is lost at ``LOST``. ``runs`` are by variant, one table of SIGNALS for each seed."""

    name: str
    imported: Imported
    track: dict[str, np.ndarray]
    heard: Coverage
    """By all stations of the file."""
    chosen: Coverage
    """By those that the navigator has."""
    runs: dict[str, list[pd.DataFrame]]

    @property
    def seeds(self) -> range:
        """With which it was flown, in the order of ``runs``."""
        return seeds(self.name)

    @property
    def title(self) -> str:
        return self.name.replace("_", " ").capitalize()

    @property
    def has_stations(self) -> bool:
        """Whether there are any ranges to navigate with."""
        return bool(self.chosen.stations)


def seeds(name: str) -> range:
    """Those of a flight follow from its name: each flight has errors of its own at turn-on, so that the figures of two
    flights are independent, and they do not depend on which others are flown."""
    first = SEEDS * (zlib.crc32(name.encode()) % 100_000) + 1
    return range(first, first + SEEDS)


@dataclass(frozen=True)
class Ready:
    """A recorded flight as a system: its truth every 10 s, and the stations that the navigator has."""

    imported: Imported
    track: dict[str, np.ndarray]
    points: Points
    chosen: Sequence[Station]
    system: Path

    @classmethod
    def of(cls, name: str, file: Path, stations: Sequence[Station], out: Path) -> Ready:
        """Import a recording, choose its stations and write a system, with its FMUs, into a folder."""
        out.mkdir(parents=True, exist_ok=True)
        imported = import_track(file)
        for fmu in Path(shipped.path("imu.fmu")).parent.glob("*.fmu"):
            (out / fmu.name).write_bytes(fmu.read_bytes())
        write_fmu(imported, shipped.path("track.fmu"), out / f"{name}.fmu", name)
        track = _truth(out / f"{name}.fmu")
        points = Points(track["latitude"], track["longitude"], track["altitude"], time=track["time"])
        chosen = choose(stations, points, parameters.places(shipped.path("dme.fmu")))
        return cls(imported, track, points, chosen, _system(name, out, chosen, track))


def fly(name: str, file: Path, stations: Sequence[Station], out: Path, progress: Callable[[int, str], None]) -> Flown:
    """Import a recording, choose its stations, and fly; ``progress`` is told of each seed."""
    progress(0, f"importing {name}")
    ready = Ready.of(name, file, stations, out)
    imported, track, chosen, system = ready.imported, ready.track, ready.chosen, ready.system
    variants = VARIANTS if chosen else dict(list(VARIANTS.items())[:1])
    loaded = {variant: System.load(system, None if variant == "main" else variant) for variant in variants}
    stop = float(np.floor(track["time"][-1]))
    jammed = [Fault("gps", "gps.jammed", "input", start=LOST)]

    def one(seed: int) -> list[pd.DataFrame]:
        return [
            each.run(stop=stop, step=0.01, seed=seed, faults=jammed, record=SIGNALS, record_period=1.0)
            for each in loaded.values()
        ]

    flown = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, runs in enumerate(pool.map(one, seeds(name)), 1):
            flown.append(runs)
            progress(done, f"flying {name}")
    by_variant = dict(zip(loaded, map(list, zip(*flown, strict=True)), strict=True))
    heard, by_chosen = Coverage.of(stations, ready.points), Coverage.of(chosen, ready.points)
    return Flown(name, imported, track, heard, by_chosen, by_variant)


def moved(file: Path, latitude: float, out: Path) -> Path:
    """Write a recording that begins at another latitude, deg: the same distances flown, in another magnetic field."""
    table = pd.read_csv(file)
    north = table["latitude_deg"] - table["latitude_deg"].iloc[0]
    first = table["longitude_deg"].iloc[0]
    east = _wrap(table["longitude_deg"] - first)
    scale = np.cos(np.radians(table["latitude_deg"])) / np.cos(np.radians(latitude + north))
    table["latitude_deg"], table["longitude_deg"] = latitude + north, _wrap(first + east * scale)
    out.parent.mkdir(parents=True, exist_ok=True)
    table.to_csv(out, index=False)
    return out


def _wrap(degrees):
    """Degrees from -180 to 180."""
    return (degrees + 180.0) % 360.0 - 180.0


def dip(track: dict[str, np.ndarray]) -> float:
    """The dip of the magnetic field in the middle of a flight, deg."""
    north, east, down = _field(track)
    return float(np.degrees(np.arctan2(down, np.hypot(north, east))))


def _field(track: dict[str, np.ndarray]) -> np.ndarray:
    middle = len(track["time"]) // 2
    return magnetic_field.field(*(track[n][middle] for n in ("latitude", "longitude", "altitude")), DATE)


def _truth(fmu: Path) -> dict[str, np.ndarray]:
    loaded = System.load(fmu)
    component = next(iter(loaded.fmus))
    stop = loaded.fmus[component].description.stop_time
    names = ("latitude", "longitude", "altitude", "true_airspeed")
    signals = [f"{component}.{name}" for name in names]
    run = loaded.run(stop=float(np.floor(stop)), step=1.0, record=signals, record_period=10.0)
    return {"time": run.index.to_numpy()} | {name: run[f"{component}.{name}"].to_numpy() for name in names}


def _system(name: str, fmus: Path, stations: Sequence[Station], track: dict[str, np.ndarray]) -> Path:
    system = source(fmus, aircraft=f"{name}.fmu", name=name)
    for who in ("dme", "navigator") if stations else ():  # else those of the shipped system, which are out of reach
        file = fmus / f"{who}.ssv"
        write_file(file, parameters.document(stations, fmus / f"{who}.fmu", f"Stations around {name}"))
        system.parameters(who, file)
    cruise = float(np.median(track["true_airspeed"]))
    system.parameters("aircraft", {"wing_loading": USUAL_LIFT * 0.5 * DENSITY * cruise**2})
    system.parameters("magnetometer", {"date": DATE})
    system.parameters("ahrs", {"date": DATE, "declination": float(magnetic_field.declination(_field(track)))})
    return system.pack(fmus / f"{name}.ssp")
