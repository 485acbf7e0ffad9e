"""JSBSim's Cessna 172 in the shipped system: whether its flight agrees with itself, and whether the navigator knows."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pymap3d
from scipy.spatial.transform import Rotation

from evidence import strapdown
from evidence.section import Section, left_out
from fmus.motion.flight_plans import FLIGHT_PLANS
from models.earth import earth
from navfmu.constants import STANDARD_GRAVITY
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system.system import System

HEADING = "A Cessna 172 by JSBSim as the truth"
SEEDS = (1, 2, 3, 4)
STOP, LOST, PERIOD = 900.0, 300.0, 0.01
INTEGRATED = 300.0
"""How long force and rate are integrated, s."""
ROUNDING = 1e-3
"""Of positions, m."""
MOST = 4.4
"""Sigmas. Errors live for a minute or longer: four flights, two axes and ten minutes hold at most 80 independent ones,
of which one is beyond 4.4 sigma with a probability of 0.1 %."""
ALONG = 20.0
"""Largest distance from the planned altitude, m, of a pilot who holds it within 60 ft in rough air."""
GRAVITATION, SECOND_HARMONIC = 3.986004418e14, 1.0826298e-3
"""GM in m3/s2 and J2 of WGS-84, as JSBSim has them."""
VECTORS = ("velocity_n", "specific_force", "rate", "air_velocity_n")
AXES = ("north", "east")


def gravity_difference(latitude, altitude):
    """Gravity to J2, from its potential, minus the normal gravity of models.earth: north and down, m/s2."""
    x, _, z = pymap3d.geodetic2ecef(latitude, 0.0, altitude, deg=False)
    r = np.hypot(x, z)
    oblate = 1.5 * SECOND_HARMONIC * (earth.EQUATORIAL_RADIUS / r) ** 2
    pull = -GRAVITATION / r**3
    outward = pull * x * (1.0 + oblate * (1.0 - 5.0 * (z / r) ** 2)) + earth.EARTH_RATE**2 * x
    upward = pull * z * (1.0 + oblate * (3.0 - 5.0 * (z / r) ** 2))
    s, c = np.sin(latitude), np.cos(latitude)
    return -s * outward + c * upward, -c * outward - s * upward - earth.gravity(latitude, altitude)


def left_over(values: np.ndarray, turning: np.ndarray, period: float) -> np.ndarray:
    """Bound of what two ways of integrating ``values`` (samples, 3) differ by, up to each sample.

    JSBSim's, Adams-Bashforth of two steps, is the trapezoidal rule but for 5/12 T of the last difference: the errors
    5/12 T second difference of all steps add up to that. Simpson's rule, which ``strapdown`` has, is that rule but for
    1/6 T of each other second difference. ``turning`` (rad/s) is how fast the axes turn in which the values are.
    """
    first = np.linalg.norm(np.diff(values, axis=0, prepend=values[:1]), axis=1)
    first += period * turning * np.linalg.norm(values, axis=1)
    other = np.zeros_like(values)
    other[2::2] = np.diff(values, 2, axis=0)[::2]
    return period * (5.0 / 12.0 * first + np.linalg.norm(np.cumsum(other, axis=0), axis=1) / 6.0)


def wrapped(angle):
    """The angle in [-pi, pi)."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


@dataclass(frozen=True)
class Closure:
    """A flight integrated anew minus the flight, and by how much the two ways of integrating can differ."""

    position: np.ndarray  # (samples, 3): north, east, up, m
    position_bound: np.ndarray  # (samples,), m
    attitude: float  # at the end, rad
    attitude_bound: float  # rad


def closure(flown: dict[str, np.ndarray], period: float) -> Closure:
    """Integrate force and rate by ``strapdown`` with normal gravity; what JSBSim's gravity has beside it is added."""
    angles = [flown[name] for name in ("roll", "pitch", "heading")]
    start = [flown[name][0] for name in ("latitude", "longitude", "altitude")]
    latitude, longitude, altitude, c_nb = strapdown.navigate(
        period, flown["specific_force"], flown["rate"], *start, flown["velocity_n"][0], [a[0] for a in angles]
    )
    time = period * np.arange(len(latitude))
    beside_north, beside_down = gravity_difference(start[0], start[2])
    radius = earth.radii(flown["latitude"])[0]
    errors = np.column_stack(
        [
            (latitude - flown["latitude"]) * radius + 0.5 * beside_north * time**2,
            wrapped(longitude - flown["longitude"]) * radius * np.cos(latitude),
            altitude - flown["altitude"] - 0.5 * beside_down * time**2,
        ]
    )
    turning = np.linalg.norm(flown["rate"], axis=1)
    turned = left_over(flown["rate"], 0.5 * turning, period)
    tilt = turned + period * np.cumsum(turning * turned)  # what is left over turns with the axes
    pushed = left_over(flown["specific_force"], turning, period)
    force = np.linalg.norm(flown["specific_force"], axis=1)
    speed = pushed + period * np.cumsum(turning * pushed + force * tilt)
    bound = left_over(flown["velocity_n"], turning, period) + period * np.cumsum(speed)
    theirs = Rotation.from_euler("ZYX", [angle[-1] for angle in angles[::-1]]).as_matrix()
    off = float(Rotation.from_matrix(c_nb.T @ theirs).magnitude())
    return Closure(errors, bound + ROUNDING, off, float(tilt[-1]))


def run(out: Path) -> Section:
    """Fly the backup navigator's system with JSBSim's aircraft; the picture is also written to ``out``/jsbsim.png."""
    if importlib.util.find_spec("jsbsim") is None:
        return left_out(HEADING, "the Python package jsbsim is not installed")
    from interpreted.jsbsim_c172 import JsbsimC172
    from navfmu.testing.twins import with_twins

    system = with_twins(System.load("backup_navigator"), {"aircraft": JsbsimC172})
    faults = [Fault("gps", "gps.jammed", "input", value=True, start=LOST)]
    record = ["aircraft", "evaluation.north_error", "evaluation.east_error", "navigator.north_sigma",
              "navigator.east_sigma"]  # fmt: skip
    flights = [
        system.run(
            stop=STOP, seed=seed, faults=faults, record=record, record_period=PERIOD if seed == SEEDS[0] else 1.0
        )
        for seed in SEEDS
    ]
    found = section(flights, arrays(flights[0]))
    write_file(out / "jsbsim.png", picture(flights, arrays(flights[0]), found.claims))
    return found


def arrays(flight: pd.DataFrame) -> dict[str, np.ndarray]:
    """The aircraft's signals, those with three elements as (samples, 3)."""
    names = ("latitude", "longitude", "altitude", "roll", "pitch", "heading", "true_airspeed", "sideslip")
    found = {name: flight[f"aircraft.{name}"].to_numpy() for name in names}
    for name in VECTORS:
        found[name] = np.column_stack([flight[f"aircraft.{name}[{i}]"].to_numpy() for i in (1, 2, 3)])
    return found | {"time": flight.index.to_numpy()}


def ratios(flight: pd.DataFrame, axis: str) -> pd.Series:
    """Error over sigma since GPS was lost, at whole seconds."""
    ratio = flight[f"evaluation.{axis}_error"] / flight[f"navigator.{axis}_sigma"]
    seconds = np.abs(ratio.index - np.round(ratio.index)) < 0.5 * PERIOD
    return ratio[(ratio.index > LOST) & seconds]


def planned(flown: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The plan at the times of a flight: latitude, longitude, altitude."""
    plan = FLIGHT_PLANS["livermore"].sample(PERIOD, STOP)
    return {name: plan[name][: len(flown["time"])] for name in ("latitude", "longitude", "altitude")}


def make_claims(flights: Sequence[pd.DataFrame], flown: dict[str, np.ndarray]) -> list[Claim]:
    """The flight agrees with itself, follows its plan, and the navigator knows how wrong it is on it."""
    part = {name: values[: round(INTEGRATED / PERIOD) + 1] for name, values in flown.items()}
    closed = closure(part, PERIOD)
    share = float(np.max(np.abs(closed.position) / closed.position_bound[:, None]))
    metres = float(np.max(np.abs(closed.position)))
    largest = max(float(np.max(np.abs(ratios(flight, axis)))) for flight in flights for axis in AXES)
    off = float(np.max(np.abs(flown["altitude"] - planned(flown)["altitude"])))
    minutes = f"{INTEGRATED / 60:g} minutes"
    return [
        Claim(
            f"JSBSim's force and rate, integrated anew for {minutes}, return its flight: {metres:.2g} m are between "
            "them, less than two ways of integrating can differ by",
            share, 1.0, False, "of that",
            f"JSBSim's force and rate, integrated anew for {minutes}, do not return its flight",
        ),
        Claim(
            f"The autopilot holds the planned altitude within {ALONG:g} m", off, ALONG, False, "m",
            f"The autopilot does not hold the planned altitude within {ALONG:g} m",
        ),
        Claim(
            f"Without GPS the navigator stays within {MOST:g} of its own sigmas", largest, MOST, False, "sigma",
            f"Without GPS the navigator goes beyond {MOST:g} of its own sigmas",
        ),
    ]  # fmt: skip


def section(flights: Sequence[pd.DataFrame], flown: dict[str, np.ndarray]) -> Section:
    """What the flights show."""
    claims = make_claims(flights, flown)

    def write(page: Page) -> None:
        page.heading(HEADING)
        page.text(
            f"The file of the aircraft in the system backup_navigator is replaced by jsbsim_c172.fmu; nothing else is. "
            f"{len(flights)} flights of {STOP / 60:g} minutes, seeds {SEEDS[0]} to {SEEDS[-1]}; GPS is jammed at "
            f"{LOST / 60:g} minutes."
        )
        page.items(claim.sentence for claim in claims)
        page.table(["of the first flight", "rms", "largest"], figures(flown))
        page.picture(picture(flights, flown, claims), "Ground track, altitude and airspeed, errors of the navigator")

    return Section(claims, write)


def figures(flown: dict[str, np.ndarray]) -> list[list[str]]:
    """How the aircraft flies: rows of name, root mean square, largest."""
    gravity = np.linalg.norm(flown["specific_force"], axis=1) - STANDARD_GRAVITY
    plan = FLIGHT_PLANS["livermore"]
    rows = {
        "altitude minus plan, m": flown["altitude"] - planned(flown)["altitude"],
        "airspeed minus plan, m/s": flown["true_airspeed"] - plan.speed,
        "sideslip, deg": np.degrees(flown["sideslip"]),
        "bank, deg": np.degrees(flown["roll"]),
        "specific force minus 1 g, m/s2": gravity,
        "wind, m/s": np.linalg.norm(flown["air_velocity_n"], axis=1),
    }
    return [
        [name, f"{np.sqrt(np.mean(values**2)):.2f}", f"{np.max(np.abs(values)):.2f}"] for name, values in rows.items()
    ]


def picture(flights: Sequence[pd.DataFrame], flown: dict[str, np.ndarray], claims: Sequence[Claim]) -> bytes:
    """Ground track; altitude and airspeed beside the plan; errors of the navigator with three sigmas."""
    plan = planned(flown)
    with figure(1, 3, size=(13.0, 4.6), below=0.45, above=0.2) as (drawing, (track, held, errors)):
        for name, values, colour, style in (("plan", plan, GREY, "--"), ("JSBSim, seed 1", flown, COLOURS[0], "-")):
            east = (values["longitude"] - plan["longitude"][0]) * np.cos(plan["latitude"][0])
            north = values["latitude"] - plan["latitude"][0]
            scale = earth.EQUATORIAL_RADIUS / 1000.0
            track.plot(scale * east[::100], scale * north[::100], color=colour, ls=style, label=name)
        track.set_aspect("equal", adjustable="datalim")
        track.set_xlabel("east, km")
        track.set_ylabel("north, km")
        minutes = flown["time"][::100] / 60.0
        held.plot(minutes, (flown["altitude"] - plan["altitude"])[::100], color=COLOURS[0], label="altitude, m")
        speed = FLIGHT_PLANS["livermore"].speed
        held.plot(minutes, (flown["true_airspeed"] - speed)[::100], color=COLOURS[1], label="true airspeed, m/s")
        held.plot(minutes, np.degrees(flown["roll"])[::100], color=COLOURS[2], lw=1, label="bank, deg")
        held.set_xlabel("time, min")
        held.set_ylabel("flown minus planned; bank")
        for colour, (seed, flight) in zip(COLOURS, zip(SEEDS, flights, strict=True), strict=False):
            ratio = ratios(flight, "north"), ratios(flight, "east")
            errors.plot(ratio[0].index / 60.0, ratio[0], color=colour, label=f"seed {seed}")
            errors.plot(ratio[1].index / 60.0, ratio[1], color=colour, ls="--")
        for bound in (-3.0, 3.0):
            errors.axhline(bound, color=GREY, lw=1)
        errors.set_ylim(-5.0, 5.0)
        errors.set_xlabel("time, min")
        errors.set_ylabel("error over its own sigma; north solid, east dashed")
        for axis, columns in ((track, 2), (held, 3), (errors, 4)):
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=columns, fontsize=7)
        shift = np.hypot(*(flown[n][-1] - plan[n][-1] for n in ("latitude", "longitude"))) * 6378.0
        title(
            drawing, track, f"Airspeed is held, not position: the wind\ncarries the flight {shift:.1f} km from the plan"
        )
        title(drawing, held, claims[1].sentence.replace(" within", "\nwithin"))
        title(drawing, errors, claims[2].sentence.replace(" of its", "\nof its"))
        return png(drawing)
