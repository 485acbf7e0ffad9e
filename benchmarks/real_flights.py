"""The backup navigator on recorded flights, among the real DME stations of their region.

    python -m benchmarks.real_flights FOLDER [OUT]

FOLDER holds flights/NAME.csv (the columns of ``navfmu track``) and dme_stations.csv (region, row_type, ident,
latitude_deg, longitude_deg, elevation_ft, frequency_mhz, range_nmi, bias_nmi, name). GPS is there for five minutes and
then lost for the rest of the flight. For each flight: what the importer found, the stations, how many of them can be
received, the dilution of precision, and the error of each receiver beside what its filter claims.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pymap3d

from fmus.stations import PLACES, Station, StationSet
from models import dme as ranging
from models import magnetic_field
from navfmu import System, shipped
from navfmu.errors import NavfmuError
from navfmu.track.archive import write_fmu
from navfmu.track.importer import Imported, import_track
from navfmu.track.picture import draw
from system_ssp.backup_navigator.system import RECEIVERS, source

FLIGHTS = ("toulouse", "sydney")
VARIANTS = (None, *RECEIVERS, "open_loop")
GPS_LOST = 300.0
DATE = 2026.0
WORST = 20.0
"""Dilution of precision where fewer than two stations answer, for choosing stations only."""


@dataclass(frozen=True)
class Geometry:
    """Over the flight, every ten seconds: number of stations that can be received, and their HDOP (NaN below two)."""

    time: np.ndarray
    usable: np.ndarray
    hdop: np.ndarray


@dataclass(frozen=True)
class Flight:
    """A recorded flight, its stations, and the runs of each receiver: one frame for each seed."""

    name: str
    imported: Imported
    stations: StationSet
    geometry: Geometry
    runs: dict[str, list[pd.DataFrame]]

    def errors(self, variant: str) -> np.ndarray:
        """Horizontal errors after the loss of GPS, m; one row for each seed."""
        lost = self.runs[variant][0].index > GPS_LOST
        return np.stack([run["evaluation.horizontal_error"].to_numpy()[lost] for run in self.runs[variant]])

    def rows(self) -> list[tuple[str, float, float, float, float, float]]:
        """(variant, median, 95th percentile, maximum, claimed 1-sigma, % within 3 sigma), lengths in m."""
        rows = []
        for variant, runs in self.runs.items():
            error = self.errors(variant)
            after = [run[run.index > GPS_LOST] for run in runs]
            sigma = np.sqrt(np.mean([r["navigator.north_sigma"] ** 2 + r["navigator.east_sigma"] ** 2 for r in after]))
            inside = 100.0 * np.mean([r["evaluation.consistent"] for r in after])
            rows.append((variant, np.median(error), np.percentile(error, 95), error.max(), float(sigma), float(inside)))
        return rows


def visible(imported: Imported, table: pd.DataFrame, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each station (row of the table) and time: whether it can be received, and its azimuth in rad."""
    flight = imported.flight
    place = [np.degrees(flight.latitude(time)), np.degrees(flight.longitude(time)), flight.altitude(time)]
    reached, azimuths = [], []
    for station in table.itertuples():
        height = station.elevation_ft * 0.3048
        azimuth, _, distance = pymap3d.geodetic2aer(*place, station.latitude_deg, station.longitude_deg, height)
        horizon = ranging.horizon(flight.altitude(time), height, 2.0)
        reached.append(distance <= np.minimum(horizon, station.range_nmi * 1852.0))
        azimuths.append(np.radians(azimuth))
    return np.array(reached), np.array(azimuths)


def dilution(reached: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """HDOP of two-dimensional ranging for stations (first axis) over time; NaN where there is no fix."""
    c, s = np.cos(azimuth) * reached, np.sin(azimuth) * reached
    a, b, d = (c * c).sum(axis=0), (c * s).sum(axis=0), (s * s).sum(axis=0)
    determinant = a * d - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        hdop = np.sqrt((a + d) / determinant)
    return np.where((reached.sum(axis=0) >= 2) & (determinant > 1e-6), hdop, np.nan)


def choose_stations(imported: Imported, table: pd.DataFrame) -> tuple[StationSet, Geometry]:
    """Up to five stations at different sites that together give the best mean HDOP over the flight."""
    time = np.arange(0.0, imported.flight.duration, 10.0)
    reached, azimuth = visible(imported, table, time)
    order = np.argsort(-reached.mean(axis=1) - 1e-4 * table.range_nmi.to_numpy())
    candidates: list[int] = []
    for i in order:  # a VOR and the TACAN beside it are one site
        site = table.iloc[i]
        apart = [
            np.hypot(site.latitude_deg - o.latitude_deg, site.longitude_deg - o.longitude_deg) > 0.02
            for o in (table.iloc[j] for j in candidates)
        ]
        if reached[i].any() and all(apart):
            candidates.append(int(i))
    chosen: list[int] = []
    for _ in range(min(PLACES, len(candidates))):
        rest = [i for i in candidates if i not in chosen]
        cost = {i: np.nan_to_num(dilution(reached[[*chosen, i]], azimuth[[*chosen, i]]), nan=WORST) for i in rest}
        lonely = {i: np.mean(np.minimum(cost[i], WORST)) - 1e-3 * reached[i].mean() for i in rest}
        chosen.append(min(lonely, key=lonely.__getitem__))
    stations = [
        Station(s.ident, s.name_, s.latitude_deg, s.longitude_deg, s.elevation_ft, s.frequency_mhz, s.range_nmi)
        for s in table.rename(columns={"name": "name_"}).iloc[chosen].itertuples()
    ]
    usable = reached[chosen].sum(axis=0)
    geometry = Geometry(time, usable, dilution(reached[chosen], azimuth[chosen]))
    return StationSet("chosen for the best mean HDOP over the flight", stations), geometry


def fly(
    name: str, data: Path, out: Path, seeds: Sequence[int], progress: Callable[[str], None] = lambda text: None
) -> Flight:
    """Import a flight, make a system of it, and run every variant with every seed."""
    tables = data / "dme_stations.csv"
    if not tables.is_file():
        raise NavfmuError(f"{tables}: there is no such file; expected the DME stations of the regions")
    progress(f"{name}: import")
    imported = import_track(data / "flights" / f"{name}.csv")
    out.mkdir(parents=True, exist_ok=True)
    fmu = write_fmu(imported, shipped.path("track.fmu"), out / f"{name}.fmu")
    draw(imported, out / f"{name}_track.png")
    table = pd.read_csv(tables)
    stations, geometry = choose_stations(imported, table[table.region == name].reset_index(drop=True))

    system = source(shipped.path("imu.fmu").parent, aircraft=str(fmu.resolve()), name=f"backup_navigator_{name}")
    package = system.pack(out / f"{name}.ssp")
    middle = imported.flight.duration / 2.0
    field = magnetic_field.field(
        imported.flight.latitude(middle), imported.flight.longitude(middle), imported.flight.altitude(middle), DATE
    )
    parameters = {"magnetometer.date": DATE, "ahrs.declination": float(magnetic_field.declination(field))}
    for component, values in (
        ("dme", {**stations.parameters(), **stations.ranges()}),
        ("navigator", stations.parameters()),
    ):
        parameters |= {f"{component}.{parameter}": value for parameter, value in values.items()}
    stop = float(np.floor(imported.flight.duration))
    record = ["evaluation.*", "navigator.north_sigma", "navigator.east_sigma", "navigator.hdop", "navigator.mode"]
    runs: dict[str, list[pd.DataFrame]] = {}
    for variant in VARIANTS:
        label = variant or "one_receiver"
        system = System.load(package, variant=variant)
        runs[label] = []
        for seed in seeds:
            progress(f"{name}: {label}, seed {seed}")
            runs[label].append(
                system.run(
                    stop=stop,
                    step=0.01,
                    seed=seed,
                    faults=_gps_lost(),
                    record=record,
                    record_period=1.0,
                    parameters=parameters,
                )
            )
    flight = Flight(name, imported, stations, geometry, runs)
    picture(flight, out / f"{name}_errors.png")
    return flight


def _gps_lost():
    from navfmu.faults import load_faults
    from system_ssp import backup_navigator

    return load_faults(Path(backup_navigator.__file__).parent / "faults" / "gps_lost.toml")


def picture(flight: Flight, path: Path) -> None:
    """Error beside claimed sigma for each receiver, and the geometry below."""
    from navfmu.report.figure import COLOURS, figure, png

    with figure(3, 1, size=(11.0, 10.0)) as (drawing, (error, few, geometry)):
        for colour, (variant, runs) in zip(COLOURS, flight.runs.items(), strict=False):
            minutes = runs[0].index / 60.0
            errors = np.stack([run["evaluation.horizontal_error"] for run in runs])
            axis = few if variant == "open_loop" else error
            axis.plot(minutes, np.median(errors, axis=0), color=colour, lw=1.0, label=f"{variant}: median of the seeds")
            sigma = np.hypot(runs[0]["navigator.north_sigma"], runs[0]["navigator.east_sigma"])
            axis.plot(minutes, sigma, color=colour, lw=0.8, ls=":", label=f"{variant}: 1 sigma of the filter")
        error.axhline(926.0, color="black", lw=0.6)
        error.set(title=f"{flight.name}: horizontal error without GPS from minute 5 on", ylabel="m", ylim=(0, 2000))
        few.set(title="dead reckoning without ranges", ylabel="m")
        time = flight.geometry.time / 60.0
        geometry.plot(time, flight.geometry.usable, color=COLOURS[0], lw=1.0, label="stations that can be received")
        geometry.plot(time, flight.geometry.hdop, color=COLOURS[1], lw=1.0, label="HDOP of these")
        geometry.set(title="geometry", xlabel="min", ylim=(0, 8))
        for axis in (error, few, geometry):
            axis.legend(loc="upper right", fontsize=8, ncols=3)
        path.write_bytes(png(drawing))


def describe(flight: Flight) -> list[str]:
    """Sentences: importer, stations and geometry."""
    geometry = flight.geometry
    fixable = np.isfinite(geometry.hdop)
    names = ", ".join(f"{s.ident} ({s.name})" for s in flight.stations.stations)
    return [
        *flight.imported.sentences(),
        f"stations: {names}",
        f"stations that can be received: {geometry.usable.min()} to {geometry.usable.max()}, mean "
        f"{geometry.usable.mean():.1f}; two or more in {100.0 * np.mean(geometry.usable >= 2):.0f} % of the time",
        f"HDOP where there is one: median {np.median(geometry.hdop[fixable]):.2f}, 95 % below "
        f"{np.percentile(geometry.hdop[fixable], 95):.2f}",
    ]


HEADINGS = ("receiver", "median (m)", "95 % (m)", "largest (m)", "1 sigma claimed (m)", "within 3 sigma (%)")


def main() -> None:
    if len(sys.argv) < 2:
        print(__doc__)
        raise SystemExit(2)
    out = Path(sys.argv[2]) if len(sys.argv) > 2 else Path("results/real_flights")
    for name in FLIGHTS:
        flight = fly(name, Path(sys.argv[1]), out, range(1, 4), progress=print)
        print(*describe(flight), sep="\n")
        print(("{:16}" + "{:>21}" * 5).format(*HEADINGS))
        for row in flight.rows():
            print(("{:16}" + "{:21.1f}" * 5).format(*row))


if __name__ == "__main__":
    main()
