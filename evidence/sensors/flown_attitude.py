"""Attitude references on recorded flights of small aircraft, beside the logs' own filters, GPS and filters of others.

The environment variable NAVFMU_DATA names a folder with recordings in ``sensors/flights/``: thor75, whose log has a
good filter, with GPS and no magnetometer; swisslog1, whose log has a poor one, so that GPS judges; alfa_engine_failure
(10 Hz, of telemetry), of which nothing is claimed. They are not part of the project.

The hard iron is learned in the first minute of flight, and errors count after it.
"""

from __future__ import annotations

import contextlib
import importlib.util
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation, Slerp

from evidence.section import Section, illustrated, left_out, recorded
from evidence.sensors.hand_held import rms
from evidence.sensors.others import FILTERS
from fmus.attitude.ahrs_velocity import SMALL_AIRCRAFT
from models.magnetic import magnetic_field
from navfmu.calibration.magnetometer.choice import choose
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import import_samples
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.ssp import SystemSource
from navfmu.system import shipped
from navfmu.system.system import System

HEADING = "Attitude in recorded flights"
LEARNING, METHOD = 60.0, "hard-iron"
"""s of flight in which the hard iron is learned, and the calibration."""
ANGLES = ("roll", "pitch", "heading")
LOGGED = ("roll", "pitch", "yaw")
AXES = ("x", "y", "z")
REFERENCES: dict[str, tuple[str, Mapping[str, Any]]] = {
    "ahrs_velocity, small_aircraft": ("ahrs_velocity", SMALL_AIRCRAFT.values),
    "ahrs_velocity": ("ahrs_velocity", {}),
    "ahrs": ("ahrs", {}),
    "ahrs_quaternion, compensated": ("ahrs_quaternion", {"compensated": True}),
}
"""By what they are called: FMU and parameters."""
OURS = "ahrs_velocity, small_aircraft"
LOG = "the log's own"
INCLINATION, NORTH, CHANGE = 2.2, 3.5, 0.56
"""VQF with a time constant of 30 s: degrees to the filter of thor75's log, where the hard iron was learned in the whole
flight; of swisslog1 m/s in a second (:func:`unexplained`), on the same samples."""


@dataclass(frozen=True)
class Flight:
    """A recording in ``folder``; times in s of its log."""

    folder: Path
    tick: float  # at which all samples come
    airborne: tuple[float, float]
    date: float
    gps_delay: float  # of velocities
    air: tuple[str, Mapping[str, Any]]  # file, and what is said of it

    @property
    def name(self) -> str:
        return self.folder.name

    def stream(self, name: str) -> pd.DataFrame:
        return pd.read_parquet(self.folder / f"{name}.parquet")

    @property
    def judged(self) -> tuple[float, float]:
        """When errors count."""
        return self.airborne[0] + LEARNING, self.airborne[1]

    @cached_property
    def field_n(self) -> np.ndarray:
        """Earth's field, T, where the flight begins, by the World Magnetic Model."""
        first = self.stream("gps").iloc[0]
        return np.asarray(magnetic_field.field(first["latitude"], first["longitude"], first["altitude"], self.date))

    @property
    def declination(self) -> float:
        return float(np.arctan2(self.field_n[1], self.field_n[0]))

    @cached_property
    def hard_iron(self) -> np.ndarray:
        """What a calibration of the first minute finds, T: none where it is refused."""
        samples = self.stream("magnetometer")
        learned = samples[samples["time"].between(self.airborne[0], self.airborne[0] + LEARNING)]
        strength, horizontal = (float(np.linalg.norm(self.field_n[:n])) for n in (3, 2))
        found = np.zeros(3)
        with contextlib.suppress(NavfmuError):
            centre = choose(columns(learned, "field"), strength, horizontal, METHOD, self.name).locus.centre
            found[: len(centre)] = centre  # in a level turn of x and y alone
        return found


def flights(folder: Path) -> list[Flight]:
    """Those that are told of."""
    airspeed = "air", {"columns": {"calibrated_airspeed": ("indicated_airspeed",)}}
    pressures = "pressure", {"columns": {"impact_pressure": ("dynamic_pressure",)}, "unchecked": True}
    return [
        Flight(folder / "thor75", 0.01, (217.0, 575.0), 2012.78, 0.0, airspeed),
        Flight(folder / "swisslog1", 0.004, (23.0, 143.0), 2014.0, 0.36, airspeed),
        Flight(folder / "alfa_engine_failure", 0.02, (5.0, 130.0), 2018.55, 0.16, pressures),
    ]


def columns(samples: pd.DataFrame, name: str) -> np.ndarray:
    """A vector's columns, (n, 3)."""
    return samples[[f"{name}_{axis}" for axis in AXES]].to_numpy(float).copy()


def fly(flight: Flight, reference: str, parameters: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Roll, pitch, heading and their sigmas, rad, by the time of the log, of an FMU on the recorded sensors."""
    folder.mkdir(parents=True)
    iron = {"add": {"field_b": tuple(f"{-x:.17g}" for x in flight.hard_iron)}}
    players = {"imu": ("imu", {}), "magnetometer": ("magnetometer", iron), "air_data": flight.air}
    system = SystemSource("flown", fmus=folder, stop_time=flight.airborne[1], step=flight.tick)
    for player, (name, said) in players.items():
        samples = read(flight.folder / f"{name}.parquet")
        asked = Asked(start=0.0, **said)
        import_samples(samples, shipped.path(f"{player}_replay.fmu"), asked).write(folder / f"{player}.fmu")
        system.component(player, f"{player}.fmu").parameters(player, {"tick_period": flight.tick})
    (folder / "reference.fmu").write_bytes(Path(shipped.path(f"{reference}.fmu")).read_bytes())
    system.component("ahrs", "reference.fmu").connect("imu.reading", "ahrs.imu")
    system.connect("magnetometer.field", "ahrs.field").connect("air_data.air", "ahrs.air")
    told = {"sample_period": flight.tick, "declination": flight.declination, **parameters}
    system.parameters("ahrs", told).write(folder / "system")
    names = [f"ahrs.attitude.{name}{more}" for more in ("", "_sigma") for name in ANGLES]
    run = System.load(folder / "system").run(step=flight.tick, record=names, record_period=flight.tick)
    return run.rename(columns=lambda name: name.removeprefix("ahrs.attitude."))


def foreign(flight: Flight, filter_: Callable[..., Rotation]) -> pd.DataFrame:
    """Roll, pitch, heading, rad, by the time of the log, of a filter that takes samples of one period."""
    imu, magnetometer = flight.stream("imu"), flight.stream("magnetometer")
    period = float(np.median(np.diff(imu["time"])))
    time = np.arange(0.0, flight.airborne[1], period)
    rate, force, field = (
        np.column_stack([np.interp(time, stream["time"], column) for column in columns(stream, name).T])
        for stream, name in ((imu, "rate"), (imu, "specific_force"), (magnetometer, "field"))
    )
    turns = filter_(rate, force, field - flight.hard_iron, period)
    angles = (Rotation.from_euler("z", flight.declination) * turns).as_euler("ZYX")[:, ::-1]
    return pd.DataFrame(angles, columns=list(ANGLES), index=time)


def logged(flight: Flight) -> pd.DataFrame:
    """Roll, pitch, heading of the log, rad, by its time."""
    own = flight.stream("reference").set_index("time")[list(LOGGED)]
    return own.rename(columns=dict(zip(LOGGED, ANGLES, strict=True)))


def turns(angles: pd.DataFrame) -> Rotation:
    """Of b to n."""
    return Rotation.from_euler("ZYX", angles[list(ANGLES[::-1])].to_numpy())


def apart(flight: Flight, angles: pd.DataFrame) -> tuple[pd.DataFrame, np.ndarray]:
    """Angles less those of the log, deg, by time while errors count; and heading error and inclination, deg rms."""
    own = logged(flight)
    own = own[(own.index > flight.judged[0]) & (own.index < flight.judged[1])]
    known = angles.index[np.clip(np.searchsorted(angles.index, own.index + 1e-9) - 1, 0, None)]
    ours = angles.loc[known]
    less = np.degrees((ours[list(ANGLES)].to_numpy() - own.to_numpy() + np.pi) % (2.0 * np.pi) - np.pi)
    return pd.DataFrame(less, columns=list(ANGLES), index=own.index), rms(turns(ours), turns(own))[1:]


def squares(flight: Flight, angles: pd.DataFrame) -> np.ndarray | None:
    """Mean squares of errors to the log over the filter's variances, of roll, pitch and heading."""
    if "roll_sigma" not in angles:
        return None
    less, _ = apart(flight, angles)
    sigmas = angles[[f"{name}_sigma" for name in ANGLES]]
    return np.mean([np.interp(less.index, sigmas.index, np.degrees(sigmas[s])) ** -2.0 * less[a] ** 2
                    for a, s in zip(ANGLES, sigmas, strict=True)], axis=1)  # fmt: skip


def unexplained(flight: Flight, angles: pd.DataFrame) -> float:
    """By how much GPS velocity changes otherwise in a second than specific force and attitude say, m/s.

    Root mean square of north and east. A level that is wrong by an angle adds g times that, a heading turns the change.
    """
    imu, gps = flight.stream("imu"), flight.stream("gps")
    imu = imu[(imu["time"] >= angles.index[0]) & (imu["time"] <= angles.index[-1])]
    time = imu["time"].to_numpy()
    gained = Slerp(angles.index.to_numpy(), turns(angles))(time).apply(columns(imu, "specific_force"))
    gained = np.column_stack([np.zeros((2, 1)), (0.5 * (gained[1:] + gained[:-1]) * np.diff(time)[:, None]).T[:2]])
    seconds = np.arange(flight.judged[0], flight.judged[1] - 1.5)
    told = gps[["velocity_north", "velocity_east"]].to_numpy().T
    felt = [np.diff(np.interp([seconds, seconds + 1.0], time, np.cumsum(one)), axis=0) for one in gained]
    seen = [
        np.diff(np.interp([seconds, seconds + 1.0], gps["time"] - flight.gps_delay, one), axis=0) for one in told
    ]  # fmt: skip
    return float(np.sqrt(np.mean((np.array(felt) - np.array(seen)) ** 2)))


@dataclass(frozen=True)
class Flown:
    """A filter on a flight."""

    flight: Flight
    by: str
    angles: pd.DataFrame

    @cached_property
    def unexplained(self) -> float:
        return unexplained(self.flight, self.angles)

    @cached_property
    def less(self) -> pd.DataFrame:
        return apart(self.flight, self.angles)[0]

    @cached_property
    def errors(self) -> np.ndarray:
        """Heading error and inclination to the log, deg rms."""
        return apart(self.flight, self.angles)[1]


def run(out: Path) -> Section:
    """Fly all filters on all flights."""
    folder, lacking = recorded("thor75", "swisslog1", "alfa_engine_failure", under="sensors/flights")
    if lacking:
        return left_out(HEADING, lacking)
    flown = []
    for flight in flights(folder):
        with tempfile.TemporaryDirectory(prefix="navfmu-") as made:
            for number, (by, (reference, parameters)) in enumerate(REFERENCES.items()):
                flown.append(Flown(flight, by, fly(flight, reference, parameters, Path(made) / str(number))))
        for by, (package, filter_) in FILTERS.items():
            if importlib.util.find_spec(package):
                flown.append(Flown(flight, by, foreign(flight, filter_)))
        flown.append(Flown(flight, LOG, logged(flight)))
    made = section(flown)
    write_file(out / "sensors" / "flown_attitude.png", picture(flown, made.claims))
    return made


def of(flown: Sequence[Flown], flight: str, by: str = OURS) -> Flown:
    """That filter on that flight."""
    return next(one for one in flown if one.flight.name == flight and one.by == by)


def section(flown: Sequence[Flown]) -> Section:
    """What is claimed, and a row for each filter and flight."""
    heading, inclination = of(flown, "thor75").errors
    claims = [
        Claim(
            "On thor75 ahrs_velocity holds level as the log's own filter with GPS does, after one minute to learn",
            float(inclination), INCLINATION, False, "degrees rms",
            opposite="On thor75 ahrs_velocity does not hold level as the log's own filter with GPS does",
        ),
        Claim(
            "and its heading", float(heading), NORTH, False, "degrees rms",
            opposite="On thor75 ahrs_velocity misses the heading of the log's own filter with GPS",
        ),
        Claim(
            "On swisslog1 its attitude and the specific force say how GPS velocity changes in a second",
            of(flown, "swisslog1").unexplained, CHANGE, False, "m/s",
            opposite="On swisslog1 its attitude and the specific force do not say how GPS velocity changes",
        ),
    ]  # fmt: skip
    head = ["flight", "filter", "inclination, deg", "heading, deg", "squares over variances of roll, pitch, heading"]
    rows = [_row(one) for one in flown]
    words = "Errors of attitude on a recorded flight, and what GPS velocity leaves unexplained"
    return illustrated(HEADING, claims, lambda: picture(flown, claims), words, [*head, "unexplained, m/s"], rows)


def _row(one: Flown) -> list[str]:
    nees = squares(one.flight, one.angles)
    told = "-" if nees is None else ", ".join(f"{x:.2g}" for x in nees)
    heading, inclination = one.errors
    errors = ["-", "-"] if one.by == LOG else [f"{inclination:.2f}", f"{heading:.2f}"]
    return [one.flight.name, one.by, *errors, told, f"{one.unexplained:.2f}"]


def picture(flown: Sequence[Flown], claims: Sequence[Claim]) -> bytes:
    """Errors on thor75 by time, its errors by filter, and of all flights what GPS velocity leaves unexplained."""
    names = list(dict.fromkeys(one.flight.name for one in flown))
    filters = list(dict.fromkeys(one.by for one in flown))
    colours = {by: GREY if by == LOG else COLOURS[i % len(COLOURS)] for i, by in enumerate(filters)}
    with figure(2, 2, size=(12.0, 8.2), left=1.35, right=0.1) as (drawing, ((level, north), (sizes, gps))):
        ours = of(flown, "thor75")
        shown = ours.angles.loc[ours.less.index[0] : ours.less.index[-1]]
        for axis, parts, most in ((level, ANGLES[:2], 12.0), (north, ANGLES[2:], 9.0)):
            for name, colour in zip(parts, COLOURS, strict=False):
                sigma = np.degrees(shown[f"{name}_sigma"])
                axis.fill_between(sigma.index, -sigma, sigma, color=colour, alpha=0.12, lw=0)
                axis.plot(ours.less[name], color=colour, lw=0.8, label=name)
            axis.set_ylim(-most, most)
            axis.set_xlabel("time, s")
            axis.set_ylabel("less the log's own filter, degrees")
            axis.legend(title="shaded: one sigma", ncols=2)
        title(drawing, level, f"thor75, level: {'as' if claims[0].holds else 'other than'} the log's own filter")
        title(drawing, north, f"thor75, heading: {'as' if claims[1].holds else 'other than'} the log's own filter")
        compared = [one for one in flown if one.flight.name == "thor75" and one.by != LOG]
        place = np.arange(len(compared))
        for i, (kind, colour) in enumerate((("heading", COLOURS[2]), ("inclination", COLOURS[0]))):
            sizes.barh(place + 0.2 - 0.4 * i, [one.errors[i] for one in compared], 0.38, color=colour, label=kind)
        sizes.set_yticks(place, ["\n".join(one.by.split(", ")) for one in compared])
        sizes.invert_yaxis()
        sizes.set_xlim(0.0, 12.0)
        sizes.set_xlabel("thor75, degrees rms (12 and more)")
        sizes.legend(loc="upper right")
        title(drawing, sizes, "thor75: errors to the log's own filter")
        for i, by in enumerate(filters):
            values = [of(flown, name, by).unexplained for name in names]
            gps.bar(np.arange(len(names)) + (i - 0.5 * len(filters)) * 0.11, values, 0.1, color=colours[by], label=by)
        gps.set_xticks(np.arange(len(names)), names)
        gps.set_ylim(0.0, 3.6)
        gps.set_ylabel("unexplained in a second, m/s")
        gps.legend(fontsize=8, ncols=2, loc="upper center")
        title(drawing, gps, "What GPS velocity does that attitude and specific force do not tell")
        return png(drawing)
