"""Recorded sensors as FMUs: what comes out beside what is in the files, and the attitude filter on a recorded flight.

The environment variable NAVFMU_DATA names a folder with recordings in ``sensors/flights/``: thor75 (a small unmanned
aircraft with regular stamps), swisslog1 (one whose stamps are irregular) and alfa_engine_failure (10 Hz, of telemetry).
They are not part of the project.
"""

from __future__ import annotations

import itertools
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from evidence.section import Section, left_out, recorded
from navfmu import System
from navfmu.errors import NavfmuWarning
from navfmu.files.writing import write_file
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import Imported, import_samples
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system import shipped
from system_ssp.backup_navigator.system import source

HEADING = "Recorded sensors"
AIRSPEED = {"columns": {"calibrated_airspeed": ("indicated_airspeed",)}}
STREAMS: dict[tuple[str, str], dict[str, Any]] = {
    ("thor75", "imu"): {},
    ("thor75", "magnetometer"): {},
    ("thor75", "gps"): {},
    ("thor75", "air"): AIRSPEED,
    ("swisslog1", "imu"): {},
    ("swisslog1", "magnetometer"): {},
    ("swisslog1", "gps"): {},
    ("swisslog1", "air"): AIRSPEED,
    ("alfa_engine_failure", "imu"): {},
    ("alfa_engine_failure", "magnetometer"): {},
    ("alfa_engine_failure", "gps"): {"columns": {"velocity_n": ("velocity_north", "velocity_east", "0")}},
    ("alfa_engine_failure", "pressure"): {  # whose temperature, 55 degC, is that of the sensor
        "columns": {"impact_pressure": ("dynamic_pressure",)},
        "unchecked": True,
    },
}
"""Files of flights, and what is said of them."""
SENSORS = {"air": "air_data", "pressure": "air_data"}
TICK = 0.001
TICKS = (0.002, 0.004, 0.006, 0.008, 0.01, 0.014, 0.02)
"""s, at which lost samples are counted."""
IRREGULAR = "swisslog1"
FLOWN, AIRBORNE, REST, FLIGHT_DATE = "thor75", (225.0, 570.0), (25.0, 80.0), 2012.78
LEVEL, NORTH = 3.0, 5.05
"""Degrees, root mean square, to the log's own solution: of roll and pitch; of heading what the magnetometer gives with
the roll and the pitch of that solution and the same hard iron taken out."""


@dataclass(frozen=True)
class Played:
    """A file, and what its FMU gave out, once by each tick of 1 ms."""

    flight: str
    imported: Imported
    result: pd.DataFrame

    @property
    def sensor(self) -> str:
        return Path(self.imported.player).stem.removesuffix("_replay")

    @cached_property
    def published(self) -> pd.DataFrame:
        """Rows with something new of the recorded bundle, by the names of its members."""
        (bundle,) = {c.split(".")[1] for c in self.result if c.endswith(".sequence") and self.result[c].iloc[-1] > 0}
        prefix = f"{self.sensor}_replay.{bundle}."
        own = self.result[[c for c in self.result if c.startswith(prefix)]]
        own = own.rename(columns=lambda name: name.removeprefix(prefix))
        return own[own["sequence"].diff().fillna(own["sequence"]) > 0]

    @cached_property
    def differing(self) -> int:
        """Samples of the file that neither came out with their bits nor are told as lost."""
        (samples,) = self.imported.streams
        number = self.published["sequence"].to_numpy() - 1
        same = self.published["time_of_validity"].to_numpy() == samples.time_of_validity[number]
        for quantity in samples.wanted.quantities:
            if quantity.name in samples.values:
                value = samples.values[quantity.name].reshape(len(samples), -1)
                for label, column in zip(quantity.labels, value.T, strict=True):
                    name = label.partition(" ")[0]
                    if name in self.published:
                        same &= self.published[name].to_numpy() == column[number]
        lost = lost_by_counting(samples.time, TICK)
        return int(np.count_nonzero(~same)) + abs(len(samples) - lost - len(number))

    @cached_property
    def late(self) -> np.ndarray:
        """Time from the stamp to the tick at which a sample came out, ms."""
        (samples,) = self.imported.streams
        number = self.published["sequence"].to_numpy() - 1
        return 1e3 * (self.published.index.to_numpy() - samples.time[number])


def lost_by_counting(time: np.ndarray, tick: float) -> int:
    """How many samples are followed by another one within the same tick, of which the first is at one period."""
    ticks = np.maximum(np.ceil(time / tick - 1e-6), 1.0)
    return sum(a == b for a, b in itertools.pairwise(ticks))


def run(out: Path) -> Section:
    """Play all files, count what is lost, and let the attitude filter fly on one of them."""
    flights, lacking = recorded(*(flight for flight, _ in STREAMS), under="sensors/flights")
    if lacking:
        return left_out(HEADING, lacking)
    with tempfile.TemporaryDirectory(prefix="navfmu-") as folder:
        played = [
            _play(flights / flight / f"{file}.parquet", asked, folder) for (flight, file), asked in STREAMS.items()
        ]
        lost = {one.sensor: _lost(one, folder) for one in played if one.flight == IRREGULAR}
        attitude = _fly(flights / FLOWN, Path(folder) / "system")
    made = section(played, lost, attitude)
    write_file(out / "sensors" / "replay.png", picture(played, lost, attitude, made.claims))
    return made


def _import(path: Path, **asked: Any) -> Imported:
    sensor = SENSORS.get(path.stem, path.stem)
    return import_samples(read(path), shipped.path(f"{sensor}_replay.fmu"), Asked(**asked))


def _play(path: Path, asked: Mapping[str, Any], folder: str) -> Played:
    imported = _import(path, **asked)
    fmu = imported.write(Path(folder) / f"{path.parent.name}_{path.stem}.fmu")
    return Played(path.parent.name, imported, _run(fmu, imported, TICK))


def _run(fmu: Path, imported: Imported, tick: float) -> pd.DataFrame:
    name = Path(imported.player).stem
    stop = tick * np.ceil(imported.duration / tick + 1.0)
    parameters = {f"{name}.tick_period": tick}
    return System.load(fmu).run(stop=stop, step=tick, record_period=tick, parameters=parameters)


def _lost(one: Played, folder: str) -> dict[float, tuple[int, int]]:
    """By tick: samples that the FMU's numbers say are lost, and those that are counted; of how many."""
    fmu = one.imported.write(Path(folder) / "again.fmu")
    (samples,) = one.imported.streams
    found = {}
    for tick in TICKS:
        again = Played(one.flight, one.imported, _run(fmu, one.imported, tick))
        jumps = np.diff(again.published["sequence"], prepend=0) - 1
        found[tick] = int(jumps.sum()), lost_by_counting(samples.time, tick)
    return found


def _fly(flight: Path, folder: Path) -> pd.DataFrame:
    """Attitude of ``ahrs`` on the recorded sensors in the shipped system, beside the log's own, degrees by time."""
    source(shipped.path("imu.fmu").parent).write(folder)
    field, imu = (pd.read_parquet(flight / f"{name}.parquet") for name in ("magnetometer", "imu"))
    iron = hard_iron(field[field["time"].between(*AIRBORNE)][["field_x", "field_y", "field_z"]].to_numpy())
    null = imu[imu["time"].between(*REST)][["rate_x", "rate_y", "rate_z"]].mean().to_numpy()
    asked = {
        "imu": {"add": {"rate": tuple(f"{-x:.17g}" for x in null)}},
        "magnetometer": {"add": {"field_b": tuple(f"{-x:.17g}" for x in iron)}},
        "gps": {},
        "air": AIRSPEED,
    }
    for name, said in asked.items():
        sensor = SENSORS.get(name, name)
        _import(flight / f"{name}.parquet", **said).write(folder / "resources" / f"{sensor}.fmu")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "has no effect", NavfmuWarning)  # parameters of the modelled sensors
        result = System.load(folder).run(
            stop=AIRBORNE[1],
            record=["ahrs.attitude"],
            record_period=0.1,
            parameters={"ahrs.date": FLIGHT_DATE},
        )
    own = pd.read_parquet(flight / "reference.parquet")
    result = result[result.index >= AIRBORNE[0]]
    found = {}
    for name, other in (("roll", "roll"), ("pitch", "pitch"), ("heading", "yaw")):
        log = np.degrees(np.interp(result.index, own["time"], np.unwrap(own[other])))
        ours = np.degrees(np.unwrap(result[f"ahrs.attitude.{name}"]))
        turns = 360.0 * np.round(np.median(ours - log) / 360.0)
        found |= {f"{name} of the log": log, name: ours - turns}
    return pd.DataFrame(found, index=result.index)


def hard_iron(field: np.ndarray) -> np.ndarray:
    """Middle of the sphere on which a field (n, 3) lies, by least squares."""
    rows = np.column_stack([2e6 * field, np.ones(len(field))])
    return np.linalg.lstsq(rows, np.sum((1e6 * field) ** 2, axis=1), rcond=None)[0][:3] * 1e-6


def _apart(attitude: pd.DataFrame, name: str) -> float:
    return float(np.sqrt(np.mean((attitude[name] - attitude[f"{name} of the log"]) ** 2)))


def section(
    played: list[Played], lost: Mapping[str, Mapping[float, tuple[int, int]]], attitude: pd.DataFrame
) -> Section:
    """Claims, the picture, and a row for each file."""
    total = sum(len(one.imported.streams[0]) for one in played)
    claims = [
        Claim(
            f"Of {total} samples in {len(played)} files each comes out with the bits of the file, or is told as lost",
            sum(one.differing for one in played), 0.0, False, "samples that do not",
        ),
        Claim(
            "Samples come out at the first tick that is not before their time",
            max(float(one.late.max()) for one in played), 1e3 * TICK, False, "ms",
            opposite="Samples come out later than at the first tick that is not before their time",
        ),
        Claim(
            "What the numbers of samples say is lost between ticks is what is lost",
            max(abs(a - b) for ticks in lost.values() for a, b in ticks.values()), 0.0, False, "samples of difference",
        ),
        Claim(
            f"On the recorded sensors of {FLOWN} ahrs has the level of the log's own filter with GPS",
            max(_apart(attitude, "roll"), _apart(attitude, "pitch")), LEVEL, False, "degrees rms",
        ),
        Claim(
            "and its heading",
            _apart(attitude, "heading"), NORTH, False, "degrees rms",
            opposite=f"On the recorded sensors of {FLOWN} ahrs misses the heading of the log's own filter",
        ),
    ]  # fmt: skip

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.picture(
            picture(played, lost, attitude, claims), "Recorded sensors: when samples come, what is lost, attitude"
        )
        page.table(
            ["flight", "sensor", "samples", "a second", "gaps", "repeats", "lost in ticks of 10 ms"], [*_rows(played)]
        )

    return Section(claims, write)


def _rows(played: list[Played]) -> list[list[str]]:
    from navfmu.recorded.replay.account import gaps, lost, usual_interval

    rows = []
    for one in played:
        (samples,) = one.imported.streams
        counts = len(gaps(samples)), int(samples.repeated().sum()), lost(samples, 0.01)
        rows.append(
            [one.flight, one.sensor, str(len(samples)), f"{1.0 / usual_interval(samples):.4g}", *map(str, counts)]
        )
    return rows


def picture(
    played: list[Played],
    lost: Mapping[str, Mapping[float, tuple[int, int]]],
    attitude: pd.DataFrame,
    claims: Any,
) -> bytes:
    """Lateness, losses, and the heading and errors of attitude on a recorded flight."""
    with figure(2, 2, size=(11.0, 7.6), left=0.8) as (drawing, ((late, gone), (heading, error))):
        for one, colour in zip([p for p in played if p.flight == IRREGULAR], COLOURS, strict=False):
            label = f"{one.sensor}, {len(one.late)}"
            bins = np.linspace(0.0, 1e3 * TICK, 21)
            late.hist(one.late, bins=bins, histtype="step", color=colour, density=True, label=label)
            count = len(one.imported.streams[0])
            told, counted = (100.0 * np.array([n[i] for n in lost[one.sensor].values()]) / count for i in (0, 1))
            ticks = 1e3 * np.array(list(lost[one.sensor]))
            gone.plot(ticks, counted, "-", color=colour, lw=1, label=one.sensor)
            gone.plot(ticks, told, "o", color=colour, ms=4)
        words = "" if claims[1].holds else ", but not all"
        title(drawing, late, f"{IRREGULAR}: samples come at the next tick{words}")
        late.set_xlabel("from the stamp to the tick at which it comes, ms")
        late.set_ylabel("density, 1/ms")
        late.set_ylim(0.0, 2.4)
        late.legend(title="samples", ncols=2)
        words = "the numbers tell what is lost" if claims[2].holds else "the numbers do not tell what is lost"
        title(drawing, gone, f"{IRREGULAR}: {words}")
        gone.set_xlabel("tick and step, ms")
        gone.set_ylabel("samples lost, %")
        gone.legend(title="line: counted, dots: FMU")
        heading.plot(
            attitude.index, attitude["heading of the log"], color=GREY, lw=3, alpha=0.5, label="the log's own filter"
        )
        heading.plot(
            attitude.index, attitude["heading"], color=COLOURS[0], lw=0.8, label="ahrs on the replayed sensors"
        )
        words = "as" if claims[4].holds else "other than"
        title(drawing, heading, f"{FLOWN}: heading {words} that of the log's own filter")
        heading.set_xlabel("time, s")
        heading.set_ylabel("heading, continuous, degrees")
        heading.legend()
        for name, colour in zip(("roll", "pitch", "heading"), COLOURS, strict=False):
            error.plot(attitude.index, attitude[name] - attitude[f"{name} of the log"], color=colour, lw=0.8,
                       label=f"{name}, {_apart(attitude, name):.1f} degrees rms")  # fmt: skip
        title(drawing, error, f"{FLOWN}: ahrs less the log's own filter")
        error.set_ylim(-8.0, 12.0)
        error.set_xlabel("time, s")
        error.set_ylabel("degrees")
        error.legend()
        return png(drawing)
