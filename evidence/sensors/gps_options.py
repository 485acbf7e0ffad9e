"""GPS as signals with what a receiver may have besides: WAAS, three antennas, few channels, a reference station."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from evidence.section import Section
from evidence.sensors.reference_station import Station
from models.earth import earth
from models.satellite import baselines, sight
from navfmu import Fault, System
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped

HEADING = "GPS with WAAS, three antennas, few channels, a reference station"
PLACE = {"latitude": float(np.radians(37.7)), "longitude": float(np.radians(-121.8)), "altitude": 1000.0}
TIMES, SKIES = 60, 48
"""Of a day at which it is measured, and at which channels are chosen."""
STOP, LOST, BACK, TIMEOUT = 150, 50, 100, 12
"""s."""
SIZES = (0.5, 1.0, 2.0, 4.0)
"""Of the baselines, over those of the thesis."""
SMOOTHED = 0.005
"""Hz of a code loop that stands for smoothing by the carrier over 100 s."""
CHANNELS = 4
THESIS = {"north": 2.0, "east": 2.0, "down": 5.0}
"""Thesis section 3.10, m."""
QUARTER = 0.25
"""The same, degrees."""


@dataclass(frozen=True)
class Found:
    """What was measured."""

    errors: np.ndarray
    """North, east, down, m, each second, WAAS being lost from LOST to BACK: (TIMES, STOP, 3)."""
    attitude: np.ndarray
    """Root of the mean of squares of roll, pitch and heading by SIZES, degrees."""
    dilution: np.ndarray
    """GDOP over a day of all satellites, of those CHANNELS take, of the best, of the first by number: (SKIES, 4)."""
    station: Station

    @classmethod
    def measured(cls) -> Found:
        with tempfile.TemporaryDirectory() as folder:
            system = System.load(_system(Path(folder)))
            errors, squares = [], []
            for k in range(TIMES):
                there, turned = _flown(system, k)
                errors.append(there)
                squares.append(turned)
            skies = np.array([_sky(system, k) for k in range(SKIES)])
        return cls(np.array(errors), np.sqrt(np.mean(squares, axis=0)), skies, Station.measured())

    def rms(self, begin: int, end: int) -> np.ndarray:
        """North, east, down from ``begin`` to ``end``, s."""
        return np.sqrt(np.mean(self.errors[:, begin:end] ** 2, axis=(0, 1)))


def _system(folder: Path) -> Path:
    source = SystemSource("options", fmus=shipped.path("gps_signals.fmu").parent)
    source.component("gps", "gps_signals.fmu").component("gps_solver", "gps_solver.fmu")
    source.connect("gps.signals", "gps_solver.signals")
    for k in range(len(SIZES)):
        source.component(f"attitude_{k + 1}", "gps_attitude.fmu").connect("gps.signals", f"attitude_{k + 1}.signals")
    return source.pack(folder / "options.ssp")


def _run(system: System, stop: float, record: Sequence[str], second: float, **given) -> np.ndarray:
    parameters = {f"gps.{name}": value for name, value in {"start_seconds": 345609.0 + second, **given}.items()}
    for k, size in enumerate(SIZES):
        parameters[f"attitude_{k + 1}.antennas"] = size * baselines.ANTENNAS
    for name, value in PLACE.items():
        parameters |= {f"{component}.{name}": value for component in ("gps", *_attitudes())}
    lost = Fault("waas", "gps.waas_lost", "input", float(LOST), float(BACK - LOST), {"value": True})
    frame = system.run(
        stop=stop, step=1.0, seed=int(second) + 1, record=record, record_period=1.0, parameters=parameters,
        faults=[lost] if stop > BACK else [],
    )  # fmt: skip
    return frame.to_numpy(float)[1:]


def _attitudes() -> list[str]:
    return [f"attitude_{k + 1}" for k in range(len(SIZES))]


def _flown(system: System, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors of positions, m, and mean squares of angles by SIZES, degrees^2."""
    names = [f"gps_solver.fix.{name}" for name in ("latitude", "longitude", "altitude")]
    angles = [f"{one}.attitude.{name}" for one in _attitudes() for name in ("roll", "pitch", "heading")]
    found = _run(system, float(STOP), [*names, *angles], 86400.0 * k / TIMES, waas=True, loop_bandwidth=SMOOTHED)
    place = earth.to_ecef(*found[:, :3].T).T - earth.to_ecef(*PLACE.values())
    turned = np.degrees(found[5:, 3:].reshape(-1, len(SIZES), 3))
    away = place @ earth.north_east_down(PLACE["latitude"], PLACE["longitude"]).T
    return away, np.mean(turned**2, axis=(0, 2))


def _sky(system: System, k: int) -> list[float]:
    names = [f"gps.signals.{name}" for name in ("number", "satellite_e")]
    all_of_them, few = (_run(system, 2.0, names, 86400.0 * k / SKIES, channels=count)[-1] for count in (24, CHANNELS))
    number, chosen = all_of_them[:24], few[:24]
    seen = number > 0.0
    _, unit = sight.ranges(earth.to_ecef(*PLACE.values()), all_of_them[24:].reshape(24, 3)[seen])
    best = min(gdop(unit[list(some)]) for some in combinations(range(len(unit)), CHANNELS))
    return [gdop(unit), gdop(unit[np.isin(number[seen], chosen)]), best, gdop(unit[:CHANNELS])]


def gdop(unit: np.ndarray) -> float:
    """Of unit vectors in rows, 1e3 at most."""
    h = np.column_stack([unit, np.ones(len(unit))])
    normal = h.T @ h
    return float(min(np.sqrt(np.trace(np.linalg.inv(normal))), 1e3)) if np.linalg.matrix_rank(h) == 4 else 1e3


def make_claims(found: Found) -> list[Claim]:
    """Each panel's, in their order."""
    with_it, without = found.rms(5, LOST), found.rms(LOST + TIMEOUT, BACK)
    again = found.rms(BACK + 1, STOP)
    over = float(np.max(with_it / np.array([*THESIS.values()])))
    back = float(np.max(np.abs(again / with_it - 1.0)))
    turned = float(found.attitude[SIZES.index(1.0)])
    scaled = found.attitude * np.array(SIZES) / turned
    worse = float(np.max(found.dilution[:, 1] / found.dilution[:, 2]))
    return [
        Claim(
            "With WAAS errors are below 2 m and 5 m (rms)", over, 1.0, False, "of that",
            "With WAAS errors are not below 2 m and 5 m",
        ),
        Claim(
            "Without it the height is worse", float(without[2] / with_it[2]), 1.5, True, "times",
            "Without WAAS the height is as good as with it",
        ),
        Claim(
            "When it is back errors are as before", back, 0.3, False, "", "When WAAS is back errors are not as before"
        ),
        Claim(
            "Three antennas have the thesis's 0.25 degrees, within", abs(turned / QUARTER - 1.0), 0.15, False, "",
            "Three antennas do not have the thesis's 0.25 degrees",
        ),
        Claim(
            "Errors of attitude fall with the baselines, within", float(np.max(np.abs(scaled - 1.0))), 0.05, False, "",
            "Errors of attitude do not fall with the baselines",
        ),
        Claim(
            "Four channels take four that are as good as the best, within", worse, 1.25, False, "times",
            "Four channels take worse satellites than the best four, by",
        ),
        *found.station.claims,
    ]  # fmt: skip


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    found = Found.measured()
    write_file(out / "sensors" / "gps_options.png", picture(found))
    return section(found)


def section(found: Found) -> Section:
    """Claims, and the picture."""
    claims = make_claims(found)

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.items([*(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims), *found.station.told])
        page.picture(picture(found), "Errors while WAAS is lost, attitude, dilution of four channels, old corrections")

    return Section(claims, write)


def picture(found: Found) -> bytes:
    """Errors while WAAS is lost; attitude by baselines; dilution of four channels over a day; old corrections."""
    claims = make_claims(found)
    with figure(2, 2, size=(10.0, 8.4)) as (drawing, ((waas, attitude), (channels, station))):
        second = np.arange(1, STOP + 1)
        for axis, (name, bar) in enumerate(THESIS.items()):
            colour = COLOURS[axis]
            waas.plot(second, np.sqrt(np.mean(found.errors[..., axis] ** 2, axis=0)), color=colour, label=name)
            if name != "east":
                waas.axhline(bar, color=colour, ls=":", lw=1)
        for at in (LOST, LOST + TIMEOUT, BACK):
            waas.axvline(at, color=GREY, lw=1, ls="--")
        waas.set(xlabel="time, s; lost at 50, unused from 62, back at 100", ylabel="error, m, rms")
        waas.set_ylim(0.0)

        size = np.geomspace(SIZES[0], SIZES[-1], 50)
        attitude.loglog(SIZES, found.attitude, "o", color=COLOURS[0], label="roll, pitch and heading, rms of a day")
        attitude.loglog(size, QUARTER / size, color=COLOURS[1], lw=1, label="0.25 degrees over the size")
        attitude.set_xticks(SIZES, [f"{one:g}" for one in SIZES])
        attitude.set_yticks([QUARTER / one for one in SIZES], [f"{QUARTER / one:g}" for one in SIZES])
        attitude.minorticks_off()
        attitude.set(xlabel="baselines over 36 and 50 cm", ylabel="error, degrees")

        hour = 24.0 * np.arange(SKIES) / SKIES
        rows = ((3, "first four by number", GREY), (2, "best four", COLOURS[1]), (0, "all", COLOURS[2]))
        for column, label, colour in rows:
            channels.semilogy(hour, found.dilution[:, column], "-", lw=1, color=colour, label=label)
        channels.semilogy(hour, found.dilution[:, 1], "o", ms=3, color=COLOURS[0], label="four channels")
        channels.set(xlabel="time of the day, h", ylabel="GDOP", ylim=(1.0, 100.0))
        titles = (
            claims[0].sentence,
            claims[3].sentence.partition(", within")[0],
            claims[5].sentence.partition(", within")[0],
            claims[8].sentence,
        )
        found.station.draw(station)
        for panel, text in zip((waas, attitude, channels, station), titles, strict=True):
            title(drawing, panel, text)
            panel.legend(fontsize=7)
        drawing.subplots_adjust(wspace=0.24, hspace=0.34)
        return png(drawing)
