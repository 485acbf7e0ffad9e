"""VOR, fixes by radar, Doppler radar and LORAN: how far off each is, and by what."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pymap3d
from pymap3d import vincenty
from scipy import stats

from evidence.section import Section, illustrated
from navfmu import System
from navfmu.constants import KNOT, NAUTICAL_MILE
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped

HEADING = "VOR, radar, Doppler radar, LORAN"
DEG = np.pi / 180.0
PROBABILITY = 1e-5
"""That a claim is missed although it is true."""
SEEDS = 300
HERE = (37.7, -121.8, 3000.0)
"""degrees, degrees, m."""
DISTANCES = np.array([5.0, 10.0, 20.0, 40.0, 80.0])
"""nmi, of the five stations of a VOR receiver, to the south."""
VOR_SIGMA = 2.0
"""degrees."""
RADAR = (37.72, -122.22, 20.0)
LOOK, ARRIVAL, TURN = 1.0, 3.0, 4.8
"""s."""
WINDS = np.array([0.0, 5.0, 10.0, 14.0, 18.0, 24.0, 30.0, 40.0, 50.0, 70.0])
TRIALS = {10.0: 3.0, 18.0: 4.0, 30.0: 5.0, 50.0: 6.0}
"""Wind -> movement of the surface, kn (Journal of Navigation, "Doppler correction for surface movement")."""
SPEED = 100.0
"""m/s, of the Doppler radar to the north in a wind from the south."""
ACCURACY = 0.25
"""nmi, 2 drms of LORAN, thesis section 7.3."""


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    found = Found.measured()
    write_file(out / "sensors" / "alternative_aids.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was measured."""

    across: np.ndarray
    """By VOR: metres across the line to each of the stations, (seeds, DISTANCES)."""
    scatter: np.ndarray
    """By radar: metres along and across the line from it, (turns, 2)."""
    far: float
    """Distance to the radar over the ground, m."""
    behind: np.ndarray
    """Metres by which fixes without a time of their own are behind the aircraft when they arrive, (fixes,)."""
    flown: np.ndarray
    """What it flies in the time from look to arrival, (fixes,)."""
    shown: np.ndarray
    """By Doppler radar: forward velocity over a sea in WINDS, m/s."""
    loran: np.ndarray
    """By LORAN: metres to the north and east, (seeds, 2)."""
    along: np.ndarray
    """By LORAN: the same along a flight, (s, 2)."""

    @classmethod
    def measured(cls) -> Found:
        return cls(across(), *by_radar(), *moving(), by_doppler(), *by_loran())


def place(name: str) -> dict[str, float]:
    """HERE as inputs of an FMU."""
    values = (HERE[0] * DEG, HERE[1] * DEG, HERE[2])
    return {f"{name}.{key}": value for key, value in zip(("latitude", "longitude", "altitude"), values, strict=True)}


def across() -> np.ndarray:
    """Radials of five stations to the south, whose distance times the sine of the error counts."""
    receiver = System.load(shipped.path("vor.fmu"))
    places = np.radians([vincenty.vreckon(*HERE[:2], d * NAUTICAL_MILE, 180.0) for d in DISTANCES])
    places[:, 1] -= 2.0 * np.pi  # vreckon counts to the east only
    told = {
        **place("vor"),
        "vor.station_count": 5,
        "vor.station_latitude": places[:, 0],
        "vor.station_longitude": places[:, 1],
        "vor.station_altitude": 0.0,
        "vor.velocity_n": [46.3, 0.0, 0.0],
    }
    true = [np.radians(pymap3d.geodetic2aer(*HERE, *np.degrees(there), 0.0)[0]) for there in places]
    seen = [
        receiver.run(stop=1.0, step=1.0, seed=s, parameters=told, record=["vor.bearing.radial"], record_period=1.0)
        .to_numpy()[-1]
        for s in range(SEEDS)
    ]  # fmt: skip
    return DISTANCES * NAUTICAL_MILE * np.sin(np.array(seen) - true)


def by_radar() -> tuple[np.ndarray, float]:
    """Fixes of an aircraft that stands, without errors of the radar itself."""
    fmu = System.load(shipped.path("radar_fix.fmu"))
    told = {**place("radar_fix"), "radar_fix.range_offset_sigma": 0.0, "radar_fix.azimuth_offset_sigma": 0.0}
    names = ["radar_fix.fix.latitude", "radar_fix.fix.longitude"]
    rows = fmu.run(stop=TURN * (SEEDS + 1), step=TURN, parameters=told, record=names, record_period=TURN).to_numpy()[2:]
    east, north, _ = pymap3d.geodetic2enu(*np.degrees(rows.T), HERE[2], *HERE)
    azimuth, _, _ = pymap3d.geodetic2aer(*RADAR, *HERE)
    outward = np.radians(azimuth) + np.pi
    to_east, to_north, _ = pymap3d.geodetic2enu(*RADAR, *HERE)
    along = north * np.cos(outward) + east * np.sin(outward)
    sideways = east * np.cos(outward) - north * np.sin(outward)
    return np.stack([along, sideways], axis=1), float(np.hypot(to_east, to_north))


def moving() -> tuple[np.ndarray, np.ndarray]:
    """Fixes of the flying ``aircraft`` by a radar without errors, whose messages do not tell their time."""
    step = 0.1
    with tempfile.TemporaryDirectory() as folder:
        source = SystemSource("seen", fmus=shipped.path("aircraft.fmu").parent, stop_time=100.0, step=step)
        source.component("aircraft", "aircraft.fmu").component("radar_fix", shipped.path("radar_fix.fmu"))
        for name in ("latitude", "longitude", "altitude"):
            source.connect(f"aircraft.{name}", f"radar_fix.{name}")
        exact = ("range_offset_sigma", "azimuth_offset_sigma", "range_sigma", "azimuth_sigma")
        source.parameters("radar_fix", {**dict.fromkeys(exact, 0.0), "stamped": False})
        source.write(folder)
        names = ["aircraft.latitude", "aircraft.longitude", "radar_fix.fix.latitude", "radar_fix.fix.longitude"]
        names += ["aircraft.altitude", "radar_fix.fix.sequence"]
        rows = System.load(folder).run(stop=100.0, step=step, record=names, record_period=step)
    new = np.flatnonzero(np.diff(rows["radar_fix.fix.sequence"].to_numpy()) > 0) + 1
    rows = {name: rows[name].to_numpy() for name in names}
    late = round((ARRIVAL - LOOK) / step)

    def apart(one: tuple[str, np.ndarray], other: tuple[str, np.ndarray]) -> np.ndarray:
        (a, i), (b, j) = one, other
        height = rows["aircraft.altitude"][i]
        places = (np.degrees(rows[f"{n}.{c}"][k]) for n, k in ((a, i), (b, j)) for c in ("latitude", "longitude"))
        lat, lon, lat_0, lon_0 = places
        east, north, _ = pymap3d.geodetic2enu(lat, lon, height, lat_0, lon_0, height)
        return np.hypot(east, north)

    return apart(("radar_fix.fix", new), ("aircraft", new)), apart(("aircraft", new), ("aircraft", new - late))


def by_doppler() -> np.ndarray:
    fmu = System.load(shipped.path("doppler_radar.fmu"))
    exact = dict.fromkeys(("scale_factor_sigma", "misalignment_sigma", "bias_sigma", "fluctuation_sigma"), 0.0)
    told = {"velocity_n": [SPEED, 0.0, 0.0], "over_water": True, **exact}
    shown = []
    for wind in WINDS:
        parameters = {f"doppler_radar.{k}": v for k, v in {**told, "wind_n": [wind * KNOT, 0.0, 0.0]}.items()}
        run = fmu.run(stop=1.0, step=0.2, parameters=parameters, record=["doppler_radar.velocity.velocity_b"],
                      record_period=0.2)  # fmt: skip
        shown.append(run.to_numpy()[-1, 0])
    return np.array(shown)


def by_loran() -> tuple[np.ndarray, np.ndarray]:
    """The first fix of many receivers, and half an hour of one at 46.3 m/s."""
    fmu = System.load(shipped.path("loran.fmu"))
    told = {**place("loran"), "loran.velocity_n": [46.3, 0.0, 0.0]}
    names = ["loran.fix.latitude", "loran.fix.longitude"]

    def off(rows: np.ndarray) -> np.ndarray:
        east, north, _ = pymap3d.geodetic2enu(*np.degrees(rows.T), HERE[2], *HERE)
        return np.stack([north, east], axis=-1)

    def flown(stop: float, seed: int) -> np.ndarray:
        run = fmu.run(stop=stop, step=1.0, seed=seed, parameters=told, record=names, record_period=1.0)
        return off(run.to_numpy()[1:])

    return np.array([flown(1.0, seed)[-1] for seed in range(SEEDS)]), flown(1800.0, 2)


def surprise(values: np.ndarray, sigma: np.ndarray | float) -> float:
    """How many standard errors the sum of squares of normal numbers of sigma is off, the largest of the columns."""
    squares = np.sum(np.square(values / sigma), axis=0)
    count = len(values)
    probability = np.minimum(stats.chi2.cdf(squares, count), stats.chi2.sf(squares, count))
    return float(np.max(stats.norm.isf(probability)))


def make_claims(found: Found) -> list[Claim]:
    """Each panel's, in their order."""
    bound = float(stats.norm.isf(0.5 * PROBABILITY))
    sea = 0.99 * (SPEED - np.interp(WINDS, [0.0, *TRIALS], [0.0, *TRIALS.values()]) * KNOT)
    return [
        Claim(
            f"A position by VOR is off by {VOR_SIGMA:g} degrees of the distance",
            surprise(found.across, VOR_SIGMA * DEG * DISTANCES * NAUTICAL_MILE), bound, False, "standard errors",
            f"A position by VOR is not off by {VOR_SIGMA:g} degrees of the distance",
        ),
        Claim(
            "Fixes by radar scatter by 15 m along and 0.08 degrees across",
            surprise(found.scatter, np.array([15.0, 0.08 * DEG * found.far])), bound, False, "standard errors",
            "Fixes by radar do not scatter by 15 m along and 0.08 degrees across",
        ),
        Claim(
            "Without a time of their own they are late",
            float(np.max(np.abs(found.behind - found.flown))), 0.1, False, "m",
            "Without a time of their own they are not where it was",
        ),
        Claim(
            "Over a sea Doppler radar leads upwind as in trials", float(np.max(np.abs(found.shown - sea))), 1e-6, False,
            "m/s", "Over a sea Doppler radar does not lead upwind as in trials",
        ),
        Claim(
            "LORAN has a quarter of a mile of 2 drms",
            surprise(found.loran, ACCURACY * NAUTICAL_MILE / np.sqrt(8.0)), bound, False, "standard errors",
            "LORAN has not a quarter of a mile of 2 drms",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, and the picture."""
    words = "Errors by VOR over distance, by radar, by Doppler radar over a sea, by LORAN"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words)


def picture(found: Found) -> bytes:
    """VOR over distance, the scatter of radar fixes and their delay, Doppler radar in winds, LORAN along a flight."""
    claims = make_claims(found)
    with figure(2, 3, size=(14.0, 8.4)) as (drawing, axes):
        vor, radar, late, sea, loran, track = axes.ravel()
        fine = np.linspace(1.0, 90.0, 200)
        for i, sigma in enumerate((1.0, 2.0, 5.0)):
            vor.plot(fine, fine * np.radians(sigma), color=COLOURS[i], lw=1, label=f"{sigma:g} deg")
        rms = np.sqrt(np.mean(np.square(found.across), axis=0)) / NAUTICAL_MILE
        vor.plot(DISTANCES, rms, "o", color=COLOURS[1], ms=5, label=f"vor, rms of {len(found.across)} receivers")
        vor.axhline(0.5, color=GREY, lw=0.8, ls="--", label="0.5 nmi, the thesis's limit")
        vor.set(xlabel="distance from the station, nmi", ylabel="across the radial, nmi", ylim=(0.0, 6.0))
        radar.plot(found.scatter[:, 1], found.scatter[:, 0], ".", color=COLOURS[0], ms=4)
        turn = np.linspace(0.0, 2 * np.pi, 100)
        for k in (1.0, 2.0):
            radar.plot(k * 0.08 * DEG * found.far * np.cos(turn), k * 15.0 * np.sin(turn), color=COLOURS[1], lw=1)
        radar.set(xlabel="across the line, m", ylabel="along the line from the radar, m", ylim=(-90.0, 90.0))
        when = ARRIVAL + TURN * np.arange(len(found.behind))
        late.plot(when, found.behind, "o", color=COLOURS[0], ms=4, label="fix from the aircraft at arrival")
        late.plot(when, found.flown, color=COLOURS[1], lw=1, label=f"flown in {ARRIVAL - LOOK:g} s")
        late.set(xlabel="time, s", ylabel="m", ylim=(0.0, None))
        sea.plot(WINDS, (SPEED * 0.99 - found.shown) / 0.99 / KNOT, color=COLOURS[0], lw=1, label="doppler_radar")
        sea.plot(list(TRIALS), list(TRIALS.values()), "s", color=COLOURS[1], ms=6, label="trials")
        sea.set(xlabel="wind, kn", ylabel="speed of the surface that is missing, kn")
        north, east = (found.loran / NAUTICAL_MILE).T
        loran.plot(east, north, ".", color=COLOURS[0], ms=4, label=f"first fixes of {len(found.loran)} receivers")
        loran.plot(ACCURACY * np.cos(turn), ACCURACY * np.sin(turn), color=COLOURS[1], lw=1, label="2 drms: 98 %")
        loran.set(xlabel="east, nmi", ylabel="north, nmi", aspect="equal", ylim=(-0.45, 0.6))
        for i, name in enumerate(("north", "east")):
            track.plot(
                np.arange(len(found.along)) / 60.0,
                found.along[:, i] / NAUTICAL_MILE,
                color=COLOURS[i],
                lw=0.8,
                label=name,
            )
        track.set(xlabel="time, min", ylabel="nmi")
        titles = [*(claim.sentence for claim in claims), "LORAN at 90 kn: what the place makes, and noise"]
        for ax, title in zip(axes.ravel(), titles, strict=True):
            ax.set_title(title, fontsize=8.5)
            if ax is not radar:
                ax.legend(fontsize=8, loc="upper left" if ax in (vor, sea, loran) else "best")
        drawing.subplots_adjust(wspace=0.28, hspace=0.32)
        return png(drawing)
