"""A flight flown by FMUs on its recorded sensors, with a navigator for each cut, and one more that has DME."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from evidence.recorded_sensors.baseline import distances
from evidence.recorded_sensors.flight import Flight, vectors
from fmus.attitude.ahrs_velocity import SMALL_AIRCRAFT as ATTITUDE
from fmus.navigation.small_aircraft import INERTIAL
from fmus.navigation.small_aircraft import SMALL_AIRCRAFT as NAVIGATOR
from models.earth import earth
from models.navigation import navigator
from models.radio import dme
from navfmu.faults import Fault
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import import_samples
from navfmu.ssp import SystemSource
from navfmu.system import shipped
from navfmu.system.system import System

ANGLES = ("heading", "pitch", "roll")
PLACE = ("latitude", "longitude")
COVARIANCE = ("nn", "ne", "ee")
RECORDED = (*(f"solution.{name}" for name in PLACE), *(f"position_covariance[{i}]" for i in (1, 2, 3)))
PERIOD = 0.2
"""At which the solution is recorded, s."""
DELAYS = np.arange(0.0, 1.001, 0.02)
"""By which GPS may come late, s."""
TRACK_PERIOD, BEFORE = 0.05, 10.0
"""Between points of the track that DME has, and for how long before the flight it begins, s."""
UNKNOWN_IRON = 0.2
"""Hard iron over the field where none could be calibrated: 10 of 50 microtesla (own choice)."""
STATIONS = {"north": 0.0, "east": 0.5 * np.pi, "south-west": 1.25 * np.pi}
DISTANCE, HEIGHT = 20e3, 200.0
"""Of the stations from the begin of the track, m, in these directions, and above it: they stand on hills."""
OURS, STRAPDOWN = "navigator", "navigator_inertial"
NAVIGATORS = {
    OURS: NAVIGATOR.values,
    "navigator_full": NAVIGATOR.values,
    "navigator_reduced": NAVIGATOR.values,
    "navigator_reckoning": NAVIGATOR.values,
    STRAPDOWN: INERTIAL.values,
}
"""Which FMUs are flown without DME, with these parameters; OURS with DME, too."""
SEEDS = 10
"""Of the noise of DME; nothing else is drawn."""


def fix_sigma() -> float:
    """Of a position by one range from each station, horizontally, m."""
    azimuths = np.array(list(STATIONS.values()))
    used = np.ones(len(azimuths), bool)
    return float(dme.dilution(np.cos(azimuths), np.sin(azimuths), used) * np.hypot(dme.BIAS_SIGMA, dme.NOISE_SIGMA))


def attitude(flight: Flight, folder: Path, stop: float) -> pd.DataFrame:
    """Heading, pitch and roll, rad, by the time of the log, of ``ahrs_velocity`` on the recorded sensors."""
    sensors(flight, folder, stop).write(folder / "attitude")
    names = [f"ahrs.attitude.{name}" for name in ANGLES]
    run = System.load(folder / "attitude").run(step=flight.tick, record=names, record_period=flight.tick)
    return run.rename(columns=lambda name: name.removeprefix("ahrs.attitude."))


def sensors(flight: Flight, folder: Path, stop: float) -> SystemSource:
    """A system of players and ``ahrs_velocity``; the other FMUs that it may need lie in its ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("ahrs_velocity", "dme", *NAVIGATORS):
        (folder / f"{name}.fmu").write_bytes(shipped.path(f"{name}.fmu").read_bytes())
    known = flight.hard_iron is not None
    iron = {"add": {"field_b": tuple(f"{-x:.17g}" for x in flight.hard_iron)}} if known else {}
    system = SystemSource("flown", fmus=folder, stop_time=stop, step=flight.tick)
    players = {"imu": ("imu", {}), "magnetometer": ("magnetometer", iron), "air_data": flight.air}
    for player, (name, said) in players.items():
        asked = Asked(start=0.0, incomplete="invalid", unchecked=True, **said)
        play(flight.folder / f"{name}.parquet", player, folder / f"{player}.fmu", asked)
        system.component(player, f"{player}.fmu").parameters(player, {"tick_period": flight.tick})
    told = {"sample_period": flight.tick, "declination": flight.declination, **ATTITUDE.values}
    told |= {} if known else {"hard_iron_sigma": UNKNOWN_IRON}
    system.component("ahrs", "ahrs_velocity.fmu").parameters("ahrs", told)
    system.connect("imu.reading", "ahrs.imu").connect("magnetometer.field", "ahrs.field")
    return system.connect("air_data.air", "ahrs.air")


def play(file: Path, player: str, out: Path, asked: Asked) -> None:
    """Write the FMU that plays a file."""
    import_samples(read(file), shipped.path(f"{player}_replay.fmu"), asked).write(out)


def delay(flight: Flight, angles: pd.DataFrame) -> float:
    """By how much GPS comes late, s: then its velocity changes as specific force and attitude say.

    What comes after the first cut does not count. ``angles``: heading, pitch and roll, rad, by the time of the log.
    """
    imu = flight.stream("imu").dropna()
    imu = imu[imu["time"].between(max(angles.index[0], flight.airborne[0] - 5.0), flight.learned)]
    time = imu["time"].to_numpy()
    turns = Rotation.from_euler("ZYX", angles[list(ANGLES)].to_numpy())
    gained = Slerp(angles.index.to_numpy(), turns)(np.clip(time, angles.index[0], angles.index[-1]))
    force = gained.apply(vectors(imu, "specific_force"))[:, :2]
    gained = np.vstack([np.zeros(2), np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(time)[:, None], axis=0)])
    told = flight.gps[["velocity_north", "velocity_east"]].to_numpy()
    begins = np.arange(flight.airborne[0], flight.learned - 2.0, 0.2)
    felt = np.stack([np.interp(begins + 1.0, time, one) - np.interp(begins, time, one) for one in gained.T])

    def left(late: float) -> float:
        at = flight.gps["time"].to_numpy() - late
        seen = np.stack([np.interp(begins + 1.0, at, one) - np.interp(begins, at, one) for one in told.T])
        return float(np.mean((seen - felt) ** 2))

    return float(DELAYS[np.argmin([left(late) for late in DELAYS])])


@dataclass(frozen=True)
class Cut:
    """A navigator without GPS from ``time`` on: latitude, longitude (rad) and covariance of position (nn, ne, ee; m2)
    by the time of the log, and the same with its error north and east (m) at each fix after the cut."""

    time: float
    solution: pd.DataFrame
    errors: pd.DataFrame

    @cached_property
    def distance(self) -> pd.Series:
        """Horizontal error, m."""
        return np.hypot(self.errors["north"], self.errors["east"])

    @cached_property
    def inside(self) -> pd.Series:
        """Whether north and east are within three of their standard deviations, as ``evaluation`` has it."""
        return (self.errors["north"] ** 2 <= 9.0 * self.errors["nn"]) & (
            self.errors["east"] ** 2 <= 9.0 * self.errors["ee"]
        )

    @cached_property
    def squares(self) -> pd.Series:
        """e' P^-1 e: 2 of an honest filter in the mean."""
        n, e, nn, ne, ee = (self.errors[name] for name in ("north", "east", *COVARIANCE))
        return (ee * n * n - 2.0 * ne * n * e + nn * e * e) / (nn * ee - ne * ne)

    def after(self, seconds: float) -> float:
        """Horizontal error so long after the cut, m, infinite: at the end; nan where the flight ends before."""
        return at(self.distance.index.to_numpy(), self.distance.to_numpy(), self.time + seconds)


def at(times: np.ndarray, values: np.ndarray, time: float) -> float:
    """A value between others; the last one at infinity, and nan behind it."""
    if np.isinf(time):
        return float(values[-1])
    return float(np.interp(time, times, values)) if time <= times[-1] else np.nan


@dataclass(frozen=True)
class Flown:
    """A flight, by how much its GPS comes late (s), its cuts by each navigator, those of OURS with DME for each seed,
    and what reckoning with the log's own heading has for each cut: times (s) and horizontal errors (m)."""

    flight: Flight
    late: float
    by: dict[str, list[Cut]]
    ranging: list[list[Cut]]
    baseline: list[tuple[np.ndarray, np.ndarray]]

    @property
    def alone(self) -> list[Cut]:
        """Cuts of OURS without DME."""
        return self.by[OURS]

    @cached_property
    def ranged(self) -> list[Cut]:
        """Cuts with DME of all seeds."""
        return [cut for cuts in self.ranging for cut in cuts]

    def reckoned(self, seconds: float) -> np.ndarray:
        """Errors of the baseline so long after each cut that the flight is long enough for, m."""
        pairs = zip(self.flight.cuts, self.baseline, strict=False)
        found = np.array([at(times, errors, cut + seconds) for cut, (times, errors) in pairs])
        return found[np.isfinite(found)]


def after(cuts: Sequence[Cut], seconds: float) -> np.ndarray:
    """Horizontal errors so long after each cut that the flight is long enough for, m."""
    found = np.array([cut.after(seconds) for cut in cuts])
    return found[np.isfinite(found)]


def fly(flight: Flight, folder: Path, seeds: int = SEEDS) -> Flown:
    """All cuts of a flight in one run, and in one for each seed of DME: they share the sensors and the attitude."""
    late = delay(flight, attitude(flight, folder / "first", flight.learned))
    cuts, navigators = flight.cuts, family(flight)
    faults = [Fault(f"cut_{i}", f"gps_{i}.jammed", "input", start=float(cut)) for i, cut in enumerate(cuts, 1)]

    def run(kinds: Sequence[str], loaded: System, seed: int) -> list[list[Cut]]:
        names = [f"{kind}_{i}.{one}" for kind in kinds for i in range(1, len(cuts) + 1) for one in RECORDED]
        rows = loaded.run(step=flight.tick, seed=seed, faults=faults, record=names, record_period=PERIOD)
        return [
            [judged(flight, late, rows, f"{kind}_{i}", float(cut)) for i, cut in enumerate(cuts, 1)] for kind in kinds
        ]

    alone = run(navigators, system(flight, late, folder / "alone", navigators, ranging=False), 1)
    ranging = system(flight, late, folder / "ranging", [OURS], ranging=True)
    ranged = [run([OURS], ranging, seed)[0] for seed in range(1, seeds + 1)]
    return Flown(flight, late, dict(zip(navigators, alone, strict=True)), ranged, distances(flight, late))


def family(flight: Flight) -> list[str]:
    """Which of NAVIGATORS a flight can have: none integrates samples that are too far apart."""
    return [name for name in NAVIGATORS if flight.fast or name != STRAPDOWN]


def system(flight: Flight, late: float, folder: Path, navigators: Sequence[str], ranging: bool) -> System:
    """A system with a receiver of GPS and navigators for each cut, and DME if they are ``ranging``.

    The navigators begin in flight: on the ground airspeed says nothing of the wind.
    """
    made, truth = sensors(flight, folder, flight.airborne[1]), path(flight, late)
    truth.to_parquet(folder / "truth.parquet")
    flight.gps[flight.gps["time"] > flight.airborne[0]].to_parquet(folder / "fixes.parquet")
    play(folder / "fixes.parquet", "gps", folder / "gps.fmu", Asked(start=0.0, age=late, unchecked=True))
    play(folder / "truth.parquet", "gps", folder / "truth.fmu", Asked(start=0.0, unchecked=True))
    made.component("truth", "truth.fmu").parameters("truth", {"tick_period": TRACK_PERIOD})
    stations = around(*truth.iloc[0][[*PLACE, "altitude"]])
    for i in range(1, len(flight.cuts) + 1):
        made.component(f"gps_{i}", "gps.fmu").parameters(f"gps_{i}", {"tick_period": flight.tick})
        if ranging:
            made.component(f"dme_{i}", "dme.fmu").parameters(f"dme_{i}", {**stations, "mode": 3, "stream": i})
            for one in (*PLACE, "altitude", "velocity_n"):
                made.connect(f"truth.fix.{one}", f"dme_{i}.{one}")
        for kind in navigators:
            name, clock = f"{kind}_{i}", {"sample_period": flight.tick} if kind == STRAPDOWN else {}
            made.component(name, f"{kind}.fmu").parameters(name, {**NAVIGATORS[kind], **stations, **clock})
            made.connect(f"gps_{i}.fix", f"{name}.fix")
            made.connect("ahrs.attitude", f"{name}.attitude").connect("air_data.air", f"{name}.air")
            if kind == STRAPDOWN:
                made.connect("imu.reading", f"{name}.imu")
            if ranging:
                made.connect(f"dme_{i}.ranging", f"{name}.ranging")
    made.write(folder / "system")
    return System.load(folder / "system")


def judged(flight: Flight, late: float, run: pd.DataFrame, name: str, cut: float) -> Cut:
    """Of a navigator, its errors to each recorded fix after the cut, at the time that this was valid."""
    solution = run[[f"{name}.{one}" for one in RECORDED]].set_axis([*PLACE, *COVARIANCE], axis=1)
    fixes = flight.gps[flight.gps["time"].between(cut + late, flight.airborne[1])]
    times = fixes["time"].to_numpy() - late
    then = pd.DataFrame({key: np.interp(times, solution.index, solution[key]) for key in solution}, index=times)
    place = (fixes[key].to_numpy() for key in (*PLACE, "altitude"))
    north, east = navigator.offset(*place, then["latitude"].to_numpy(), then["longitude"].to_numpy())
    return Cut(cut, solution[solution.index >= cut], then.assign(north=north, east=east))


def path(flight: Flight, late: float) -> pd.DataFrame:
    """The recorded track as the truth for DME: cubic between fixes, by when these were valid."""
    fixes = flight.gps
    time = fixes["time"].to_numpy() - late
    meridian, normal = earth.radii(fixes["latitude"].to_numpy())
    turning = {
        "latitude": fixes["velocity_north"] / (meridian + fixes["altitude"]),
        "longitude": fixes["velocity_east"] / ((normal + fixes["altitude"]) * np.cos(fixes["latitude"])),
    }
    begin = max(np.ceil(time[0]), flight.airborne[0] - BEFORE)
    moments = begin + TRACK_PERIOD * np.arange(int((time[-1] - begin) / TRACK_PERIOD))
    made = {"time": moments, "altitude": np.interp(moments, time, fixes["altitude"])}
    made |= {name: CubicHermiteSpline(time, fixes[name], rate)(moments) for name, rate in turning.items()}
    velocities = (f"velocity_{one}" for one in ("north", "east", "down"))
    return pd.DataFrame(made | {name: np.interp(moments, time, fixes[name]) for name in velocities})


def around(latitude: float, longitude: float, altitude: float) -> dict[str, Any]:
    """Parameters of the stations around a place."""
    azimuths = np.array(list(STATIONS.values()))
    way = DISTANCE * np.stack([np.cos(azimuths), np.sin(azimuths)])
    spare = np.zeros(5 - len(azimuths))
    latitudes, longitudes = navigator.advance(latitude, longitude, altitude, way, 1.0)
    return {
        "station_count": len(azimuths),
        "station_latitude": np.concatenate([latitudes, spare]),
        "station_longitude": np.concatenate([longitudes, spare]),
        "station_altitude": np.concatenate([np.full(len(azimuths), altitude + HEIGHT), spare]),
    }
