"""Ground stations: dilution where two and three are heard, and what a real network offers near the ground.

What the thesis prints of both stands in navfmu_figures/thesis, T26 and T33.

The environment variable NAVFMU_DATA names a folder with ``dme_stations.csv``, the stations of a navaid file around six
recorded flights, and the ``flights/``. They are not part of the project.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import navpy
import numpy as np
import pandas as pd

from evidence.section import Section, illustrated, left_out, recorded
from navfmu.constants import FOOT, NAUTICAL_MILE, RADIO_EARTH_RADIUS
from navfmu.files.writing import write_file
from navfmu.navaids import file as station_file
from navfmu.navaids.coverage import Coverage, Points
from navfmu.navaids.picture import counts, dilutions
from navfmu.navaids.sight import ANTENNA, sight
from navfmu.navaids.station import distance
from navfmu.recorded import track
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png
from navfmu_figures.thesis import t26

HEADING = "Ground stations"
HEIGHTS = (500.0, 1500.0)
"""ft above the ground, thesis section 2.6."""
NEAR = 60.0
"""nmi from a flight to an airport: the file has all stations within 120 nmi of the flights."""
DIFFERENT = 0.5
"""Percent of pairs of station and airport: a horizon of roots is not quite that of a ray that touches the sphere."""


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    folder, lacking = recorded("dme_stations.csv", "flights/*.csv")
    if lacking:
        return left_out(HEADING, lacking)
    found = Found.measured(folder)
    write_file(out / "sensors" / "navaids.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was calculated; dilutions are (north, east) maps over SIDE nmi to each side of an airport."""

    sides: np.ndarray
    """nmi to the north, or to the east."""
    three: np.ndarray
    two: np.ndarray
    heard: Mapping[str, np.ndarray]
    """Of each region, how many stations are heard over its airports, (airports, heights)."""
    different: float
    """Percent of pairs of station and airport of which a ray that touches the sphere says otherwise."""
    region: Coverage
    """Around an airport, at both heights."""
    drawn: str

    @classmethod
    def measured(cls, data: Path) -> Found:
        points = t26.around()
        stations = station_file.read(data / "dme_stations.csv").stations
        fields = airports(data / "dme_stations.csv")
        heard, different = {}, []
        for path in sorted((data / "flights").glob("*.csv")):
            flown = track.read(path)
            of = fields[[_near(field, flown) for field in fields.itertuples()]]
            seen = np.array([over(stations, field) for field in of.itertuples()])
            heard[path.stem] = seen.sum(axis=2)
            different.append(
                seen != np.array([[_touching(stations, field, h) for h in HEIGHTS] for field in of.itertuples()])
            )
        drawn = min(heard, key=lambda name: np.mean(heard[name] >= 3))
        field = next(f for f in fields.itertuples() if _near(f, track.read(data / "flights" / f"{drawn}.csv")))
        around = Points.around(
            field.latitude,
            field.longitude,
            NEAR * NAUTICAL_MILE,
            t26.COUNT,
            [h * FOOT for h in HEIGHTS],
            field.elevation,
        )
        return cls(
            points.sides / NAUTICAL_MILE,
            t26.dilution(t26.THREE, points),
            t26.dilution(t26.TWO, points),
            heard,
            100.0 * float(np.mean(np.concatenate([part.ravel() for part in different]))),
            Coverage.of(stations, around),
            f"{drawn}, around {field.Index}",
        )


def airports(path: Path) -> pd.DataFrame:
    """Where a file has transponders of an ILS: latitude, longitude (rad) and elevation (m) by ident of the airport."""
    table = pd.read_csv(path, keep_default_na=False)
    table = table[table["name"].str.contains("ILS")]
    found = table.groupby(table["name"].str[:4])[["latitude_deg", "longitude_deg", "elevation_ft"]].mean()
    found = found.rename(
        columns={"latitude_deg": "latitude", "longitude_deg": "longitude", "elevation_ft": "elevation"}
    )
    return found * [np.pi / 180.0, np.pi / 180.0, FOOT]


def _near(field, flown: track.Recording) -> bool:
    return bool(
        np.min(distance(field.latitude, field.longitude, flown.latitude, flown.longitude)) < NEAR * NAUTICAL_MILE
    )


def over(stations, field) -> np.ndarray:
    """Which stations are heard over an airport, (heights, stations)."""
    place = (np.full(len(HEIGHTS), x) for x in (field.latitude, field.longitude))
    return sight(stations, *place, field.elevation + FOOT * np.array(HEIGHTS), field.elevation).heard.T


def _touching(stations, field, height: float) -> list[bool]:
    """The same at a height (ft), by navpy and a ray that just touches the sphere, whose length is an arc."""
    own = field.elevation + height * FOOT
    heard = []
    for one in stations:
        there = np.degrees(one.latitude), np.degrees(one.longitude), one.elevation
        far = np.linalg.norm(navpy.lla2ned(*there, np.degrees(field.latitude), np.degrees(field.longitude), own))
        antenna = max(one.elevation - field.elevation, 0.0) + ANTENNA
        arcs = (np.arccos(RADIO_EARTH_RADIUS / (RADIO_EARTH_RADIUS + h)) for h in (height * FOOT, antenna))
        heard.append(bool(far <= min(one.range, RADIO_EARTH_RADIUS * sum(arcs))))
    return heard


def shares(heard: np.ndarray) -> list[float]:
    """Percent of airports with two at 500 and 1500 ft, and with three at 500 and 1500 ft."""
    return [100.0 * float(np.mean(heard[:, i] >= least)) for least in (2, 3) for i in range(len(HEIGHTS))]


def make_claims(found: Found) -> list[Claim]:
    """Closed forms of the dilution, and stations by another way."""
    half = t26.COUNT // 2
    middle = abs(found.three[half, half] / (2.0 / np.sqrt(3.0)) - 1.0)
    return [
        Claim(
            "Three stations around an airport dilute by 2 / sqrt(3) in the middle", middle, 1e-3, False, "",
            "Three stations around an airport do not dilute by 2 / sqrt(3) in the middle",
        ),
        Claim(
            "Two dilute by sqrt(2) where their lines cross at right angles",
            abs(float(np.min(found.two)) / np.sqrt(2.0) - 1.0), 1e-3, False, "",
            "Two do not dilute by sqrt(2) where their lines cross at right angles",
        ),
        Claim(
            "Stations are heard as a ray that touches the Earth of 4/3 radius says", found.different, DIFFERENT, False,
            "% of pairs", "Stations are not heard as a ray that touches the Earth of 4/3 radius says",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, coverage by region, and the picture."""
    rows = [[name, str(len(heard)), *(f"{x:.0f}" for x in shares(heard))] for name, heard in found.heard.items()]
    head = ["region", "airports", *(f"{n} at {h:g} ft, %" for n in ("two", "three") for h in HEIGHTS)]
    words = "Dilution with three and with two stations; airports; a region at 500 and 1500 ft"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words, head, rows)


def picture(found: Found) -> bytes:
    """Maps of dilution with three and two stations, airports by region, and a region at both heights."""
    claims = make_claims(found)
    with figure(2, 3, size=(14.5, 8.8)) as (drawing, axes):
        three, two, bars, *maps = axes.ravel()
        for ax, hdop, claim in ((three, found.three, claims[0]), (two, found.two, claims[1])):
            dilutions(drawing, ax, found.sides, hdop)
            ax.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
            ax.set_title(claim.sentence, fontsize=9)
        names = list(found.heard)
        for i, text in enumerate(f"{n} at {h:g} ft" for n in ("two", "three") for h in HEIGHTS):
            bars.barh(
                np.arange(len(names)) + 0.2 * (1.5 - i), [shares(found.heard[n])[i] for n in names], 0.18,
                color=COLOURS[i], label=text,
            )  # fmt: skip
        bars.set_yticks(range(len(names)), [f"{n} ({len(found.heard[n])})" for n in names])
        bars.set_xlabel("airports with so many stations, %")
        bars.set_xlim(0.0, 165.0)
        bars.set_xticks([0, 25, 50, 75, 100])
        bars.legend(fontsize=8, loc="upper right")
        bars.set_title("Airports, whose number is in brackets", fontsize=9)
        layers = found.region.layers()
        sides = found.region.points.sides / NAUTICAL_MILE
        for ax, (height, count, _) in zip(maps, layers, strict=False):
            counts(drawing, ax, sides, count)
            ax.set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
            ax.set_title(f"Stations at {height / FOOT:.0f} ft, {found.drawn}", fontsize=9)
        dilutions(drawing, maps[2], sides, layers[1][2])
        maps[2].set(aspect="equal", xlabel="nmi to the east", ylabel="nmi to the north")
        maps[2].set_title(f"HDOP at {layers[1][0] / FOOT:.0f} ft, {found.drawn}", fontsize=9)
        drawing.subplots_adjust(wspace=0.42, hspace=0.3)
        return png(drawing)
