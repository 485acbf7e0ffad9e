"""Orbits and clocks of satellites of GPS: an independent solution's states, precise orbits, an almanac, nominal slots.

The environment variable NAVFMU_DATA names a folder with ``gnss/``: the broadcast ephemerides of the station Esbjerg of
25 June 2020 (Danish agency SDFE; repository georust/rinex), the precise orbits of that day (CNES/CLS for the IGS), a
YUMA almanac of 2006 (US Government), and states and dilutions that others calculated of them. They are not part of the
project.
"""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.section import Section, illustrated, left_out, recorded
from models.earth import earth
from models.satellite import orbit, satellite_clock, selection, slots
from models.satellite.ephemeris import Ephemeris
from navfmu.constants import SPEED_OF_LIGHT
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.satellite.file import read_orbits

HEADING = "Satellites"
ALMANAC = (date(2006, 11, 15), 1401)
PRECISE = {"radial": 1.06, "along": 0.85, "cross": 0.38, "clock": 0.65}
"""Root mean square of broadcast minus precise that others found for this day and station, m."""
WITHIN = 0.05
"""Share of it that ours may differ by."""
DIGIT = 6e-4
"""Dilutions are printed with three digits."""
LONGITUDES, STEP = np.radians(30.0 * np.arange(12)), 600.0


def run(out: Path) -> Section:
    """Calculate, compare, and draw the picture."""
    folder, lacking = recorded("esbc1770_sats.csv", under="gnss")
    if lacking:
        return left_out(HEADING, lacking)
    found = Found.measured(folder)
    write_file(out / "sensors" / "satellites.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was calculated, and by how much it differs."""

    states: pd.DataFrame
    """Of each satellite and time of the independent solution: position (mm), velocity (mm/s), clock (mm)."""
    almanac: float
    """Largest difference of a coordinate of the almanac's states, mm."""
    precise: pd.DataFrame
    """Broadcast minus precise: hour, prn, radial, along, cross, clock (m; of that the median of the epoch is off)."""
    heard: pd.DataFrame
    """The same with what had been sent by then."""
    dilutions: pd.DataFrame
    """latitude, mask (deg), ours and theirs of HDOP, VDOP, PDOP (median and 95 %) and TDOP (median)."""
    day: np.ndarray
    """Hours, HDOP and VDOP at 45 degrees north, 5 degrees mask, (3, n)."""

    @classmethod
    def measured(cls, folder: Path) -> Found:
        broadcast = read_orbits(folder / "esbc1770_nav.rnx.gz").rows
        return cls(
            states(broadcast, folder),
            almanac(folder),
            *(precise(broadcast, folder, future) for future in (True, False)),
            dilutions((folder / "design_checks.txt").read_text()),
            day(),
        )

    def rms(self, name: str) -> float:
        return float(np.sqrt(np.mean(self.precise[name] ** 2)))


def used(rows: np.ndarray, prn, week, second, future: bool = True) -> tuple[Ephemeris, np.ndarray]:
    """The ephemeris that is chosen for each, and whether it is usable."""
    one = selection.nearest(selection.around(selection.finder(rows), prn, week, second), prn, week, second, future)
    return one, selection.usable(one, prn, week, second, future)


def states(rows: np.ndarray, folder: Path) -> pd.DataFrame:
    """Differences from the states of the independent solution.

    Its clocks are printed to 15 mm; to a millimetre they are in its residuals, which are what the pseudorange has over
    distance, receiver clock, ionosphere and troposphere.
    """
    told = pd.read_csv(folder / "esbc1770_sats.csv")
    receiver = pd.read_parquet(folder / "esbc1770_spp.parquet").set_index("tow_s")["own_cdt"]
    week, sent = told["week"].to_numpy(float), told["tx_tow_s"].to_numpy()
    one, usable = used(rows, told["prn"].to_numpy(float), week, sent)
    position, velocity = orbit.state(one, week, sent)
    clock = SPEED_OF_LIGHT * satellite_clock.on_l1(one, satellite_clock.error(one, week, sent)[0])
    theirs = told["range_rot_m"] + told["tow_s"].map(receiver) + told["iono_m"] + told["tropo_m"] + told["res_m"]
    return pd.DataFrame(
        {
            "usable": usable & (one.issue == told["iode"]),
            "position": 1e3 * np.max(np.abs(position - told[["sat_x", "sat_y", "sat_z"]].to_numpy()), axis=1),
            "velocity": 1e3 * np.max(np.abs(velocity - told[["sat_vx", "sat_vy", "sat_vz"]].to_numpy()), axis=1),
            "clock": 1e3 * np.abs(clock - (theirs - told["c1c_m"])),
        }
    )


def almanac(folder: Path) -> float:
    """Largest difference of a coordinate from the almanac's states, mm."""
    near, week = ALMANAC
    rows = read_orbits(folder / "yuma_week1401.txt", near).rows
    told = pd.read_csv(folder / "yuma1401_states.csv")
    second = told["tow_s"].to_numpy(float)
    one, _ = used(rows, told["prn"].to_numpy(float), week, second)
    position, _ = orbit.state(one, week, second)
    return 1e3 * float(np.max(np.abs(position - told[["x_m", "y_m", "z_m"]].to_numpy())))


def precise(rows: np.ndarray, folder: Path, future: bool) -> pd.DataFrame:
    """Broadcast minus precise, in the frame of the orbit."""
    found = []
    for second, prn, position, clock in read_precise(folder / "GRG0MGXFIN_20201770000_01D_15M_ORB.SP3.gz"):
        one, usable = used(rows, prn, 2111.0, second, future)
        ours, velocity = orbit.state(one, 2111.0, second)
        radial = _unit(position)
        cross = _unit(np.cross(position, velocity + np.cross([0.0, 0.0, orbit.EARTH_RATE], position)))
        axes = {"radial": radial, "along": np.cross(cross, radial), "cross": cross}
        told, _ = satellite_clock.polynomial(one, 2111.0, second)  # both leave the relativistic term to the receiver
        off = SPEED_OF_LIGHT * (told - clock)
        table = pd.DataFrame({"hour": (second - 345600.0) / 3600.0, "prn": prn})
        for name, axis in axes.items():
            table[name] = np.sum((ours - position) * axis, axis=1)
        table["clock"] = off - np.median(off[usable])
        found.append(table[usable])
    return pd.concat(found, ignore_index=True)


def read_precise(path: Path) -> list[tuple[float, np.ndarray, np.ndarray, np.ndarray]]:
    """Second of the week, satellites of GPS, positions (n, 3) in m and clocks (s) of a file of format SP3."""
    found = []
    for line in gzip.decompress(path.read_bytes()).decode().splitlines():
        if line.startswith("*"):
            _, _, _, hour, minute, _ = map(float, line[1:].split())
            found.append((345600.0 + 3600.0 * hour + 60.0 * minute, []))
        elif line.startswith("PG"):
            x, y, z, clock = (float(line[4 + 14 * k :][:14]) for k in range(4))
            if clock < 999999.0:
                found[-1][1].append((float(line[2:4]), 1e3 * x, 1e3 * y, 1e3 * z, 1e-6 * clock))
    return [(second, *_columns(np.array(rows))) for second, rows in found]


def _columns(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return rows[:, 0], rows[:, 1:4], rows[:, 4]


def dilutions(text: str) -> pd.DataFrame:
    """Dilutions of a day of the nominal slots beside those of a file of others."""
    number = r"([\d.]+)"
    lines = re.findall(
        rf"24-slot lat (\d+) mask (\d+):.* median HDOP {number} VDOP {number} PDOP {number} TDOP {number} \| "
        rf"p95 HDOP {number} VDOP {number} PDOP {number}",
        text,
    )
    rows = []
    for line in lines:
        latitude, mask, *theirs = map(float, line)
        h, v, p, t = dilution(np.radians(latitude), LONGITUDES, np.radians(mask), STEP)
        ours = [*(np.median(x) for x in (h, v, p, t)), *(np.quantile(x, 0.95) for x in (h, v, p))]
        rows.append({"latitude": latitude, "mask": mask, "ours": np.array(ours), "theirs": np.array(theirs)})
    return pd.DataFrame(rows)


def dilution(latitude: float, longitudes: np.ndarray, mask: float, step: float) -> np.ndarray:
    """HDOP, VDOP, PDOP, TDOP (4, n) at places of one latitude, every ``step`` s of a day of the nominal slots."""
    one = Ephemeris.of(slots.constellation())
    week, second = slots.EPOCH
    found = []
    for longitude in longitudes:
        up, east, north = _axes(latitude, longitude)
        place = earth.to_ecef(latitude, longitude, 0.0)
        for t in np.arange(0.0, 86400.0, step):
            sight = _unit(orbit.state(one, week, second + t)[0] - place)
            sight = sight[sight @ up > np.sin(mask)]
            rows = np.stack([sight @ east, sight @ north, sight @ up, np.ones(len(sight))], -1)
            e, n, u, time = np.diag(np.linalg.inv(rows.T @ rows))
            found.append(np.sqrt([e + n, u, e + n + u, time]))
    return np.array(found).T


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def _axes(latitude: float, longitude: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Up, east and north in e."""
    s, c = np.sin(latitude), np.cos(latitude)
    out = np.array([np.cos(longitude), np.sin(longitude), 0.0])
    pole = np.array([0.0, 0.0, 1.0])
    return c * out + s * pole, np.array([-out[1], out[0], 0.0]), c * pole - s * out


def day() -> np.ndarray:
    h, v, _, _ = dilution(np.radians(45.0), np.array([0.0]), np.radians(5.0), 120.0)
    return np.array([np.arange(len(h)) / 30.0, h, v])


def make_claims(found: Found) -> list[Claim]:
    """What is to hold."""
    states = found.states
    worst = {name: abs(found.rms(name) / theirs - 1.0) for name, theirs in PRECISE.items()}
    off = max(float(np.max(np.abs(row.ours - row.theirs))) for row in found.dilutions.itertuples())
    return [
        Claim(
            "Satellites are where the independent solution has them, by the same ephemerides",
            float(states["position"].max()) if states["usable"].all() else np.inf, 1.0, False, "mm",
            "Satellites are not where the independent solution has them",
        ),
        Claim(
            "They move as there", float(states["velocity"].max()), 0.1, False, "mm/s", "They do not move as there",
        ),
        Claim(
            "Their clocks are those of the independent solution", float(states["clock"].max()), 1.0, False, "mm",
            "Their clocks are not those of the independent solution",
        ),
        Claim(
            "An almanac puts them where others have them", found.almanac, 1.0, False, "mm",
            "An almanac does not put them where others have them",
        ),
        Claim(
            "Broadcast minus precise is what others found, orbit and clock", 100.0 * max(worst.values()),
            100.0 * WITHIN, False, "%", "Broadcast minus precise is not what others found",
        ),
        Claim(
            "Dilutions of a day of the 24 slots are those of others", off, DIGIT, False, "",
            "Dilutions of a day of the 24 slots are not those of others",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, figures and the picture."""
    rows = []
    for table, name in ((found.precise, "nearest in the file"), (found.heard, "nearest of those sent by then")):
        rms = [f"{np.sqrt(np.mean(table[axis] ** 2)):.2f}" for axis in PRECISE]
        rows.append([name, str(len(table)), *rms, f"{table['radial'].mean():.2f}"])
    head = ["ephemerides", "points", *(f"{axis}, m rms" for axis in PRECISE), "radial, mean, m"]
    words = "Broadcast minus precise orbits and clocks; dilution over a day of the 24 slots"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words, head, rows)


def picture(found: Found) -> bytes:
    """Broadcast minus precise over the day, and dilutions of the nominal slots."""
    claims = make_claims(found)
    with figure(2, 2, size=(12.0, 7.6)) as (drawing, axes):
        orbits, clocks, one_day, latitudes = axes.ravel()
        for name, colour in zip(("along", "cross", "radial"), COLOURS, strict=False):
            orbits.plot(found.precise["hour"], found.precise[name], ".", ms=2.5, color=colour, label=name)
        orbits.set(xlabel="h of 25 June 2020", ylabel="broadcast minus precise, m", ylim=(-5.0, 5.0))
        orbits.legend(markerscale=4, ncols=3, loc="lower left")
        orbits.set_title(claims[4].sentence, fontsize=9)
        clocks.plot(found.precise["hour"], found.precise["clock"], ".", ms=2.5, color=COLOURS[3])
        clocks.set(xlabel="h of 25 June 2020", ylabel="clock less the median, m", ylim=(-5.0, 5.0))
        clocks.set_title(f"Clocks: {found.rms('clock'):.2f} m rms", fontsize=9)
        hours, h, v = found.day
        one_day.plot(hours, v, color=COLOURS[1], label="VDOP")
        one_day.plot(hours, h, color=COLOURS[0], label="HDOP")
        one_day.set(xlabel="h", ylabel="dilution", ylim=(0.0, 4.0), xlim=(0.0, 24.0))
        one_day.legend(ncols=2)
        one_day.set_title("24 slots at 45 degrees north, 5 degrees mask", fontsize=9)
        for k, name in enumerate(("HDOP", "VDOP")):
            for mask, style in ((5.0, "-"), (10.0, "--")):
                table = found.dilutions[found.dilutions["mask"] == mask]
                ours, theirs = (np.array(table[who].tolist())[:, k] for who in ("ours", "theirs"))
                latitudes.plot(table["latitude"], ours, style, color=COLOURS[k], label=f"{name}, mask {mask:.0f} deg")
                latitudes.plot(table["latitude"], theirs, "o", color=GREY, mfc="none", ms=7)
        latitudes.plot([], [], "o", color=GREY, mfc="none", ms=7, label="others")
        latitudes.set(xlabel="latitude, deg", ylabel="median of a day", ylim=(0.0, 3.2))
        latitudes.legend(fontsize=8, ncols=2)
        latitudes.set_title(claims[5].sentence, fontsize=9)
        drawing.subplots_adjust(hspace=0.35)
        return png(drawing)
