"""The air data system in a climb and a descent: what each fault of its lines shows, and the sigmas of its errors.

Expected readings are the textbook's formulas with the pressures of the package ``ambiance``.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import ambiance
import numpy as np
import pandas as pd
from scipy import stats

from evidence.section import Section
from models.motion.flight_plan import FlightPlan, straight
from navfmu.faults.fault import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped
from navfmu.system.system import System

HEADING = "Air data"
SPEED, SLOPE = 50.0, 5.0
PLAN = FlightPlan(
    0.66, -2.12, 1000.0, 0.0, SPEED,
    (straight(60.0, SPEED), straight(60.0, SPEED, SLOPE), straight(60.0, SPEED),
     straight(120.0, SPEED, -SLOPE), straight(60.0, SPEED)),
)  # fmt: skip
"""Level, up 300 m, level, down 600 m, level."""
STOP, PERIOD = 360.0, 0.1
FROM, UNTIL = 40.0, 330.0
"""Of the faults, s."""
PERFECT = dict.fromkeys(
    ("airspeed_error_sigma", "altitude_error_sigma", "pitot_coefficient_sigma", "pressure_offset_sigma",
     "temperature_error_sigma"),
    0.0,
)  # fmt: skip
DRAIN, LAG = 0.02, 0.1
"""Opening of the drain, and time constant of the pitot line, s: so a line with the drain alone takes 5 s."""
FAULTS: Mapping[str, tuple[Mapping[str, float | bool], Mapping[str, float]]] = {
    "none": ({}, {}),
    "pitot tube and drain blocked": ({"pitot_blocked": True}, {}),
    "pitot tube blocked, drain open": ({"pitot_inlet_blocked": True}, {"total_lag_time": LAG}),
    "ice, drain open": ({"pitot_ice": 1.0}, {"freezing_time": 200.0, "melting_time": 20.0}),
    "static port blocked": ({"static_blocked": True}, {}),
    "alternate static source": ({"alternate_static": True}, {}),
    "20 mm of water in the static line": ({"static_water": 0.02}, {}),
    "lines swapped": ({"lines_swapped": True}, {}),
    "static line of 1 s": ({}, {"static_lag_time": 1.0}),
}
"""Inputs and parameters."""
FIELD = {"altitude_field_sigma": 10.0, "altitude_noise_sigma": 2.7, "altitude_noise_slope": 0.0035}
SEEDS = range(1, 301)
CLOSE, SLOW = 0.02, 1.0
"""Bounds: of airspeeds by the closed form, m/s, and of a time constant, %."""
DOUBT = 1e-6


def run(out: Path) -> Section:
    """Fly with each fault, then with many seeds."""
    with tempfile.TemporaryDirectory() as scratch:
        system = flight(Path(scratch))
        flights = {name: fly(system, *what) for name, what in FAULTS.items()}
        errors = [fly(system, parameters=FIELD, seed=seed, perfect=False) for seed in SEEDS]
    squares = spread(flights["none"], errors)
    write_file(out / "sensors" / "air_data.png", picture(flights, make_claims(flights, squares), squares))
    return section(flights, squares)


def flight(folder: Path) -> System:
    """An aircraft in calm air and its air data."""
    source = SystemSource("air", fmus=shipped.path("air_data.fmu").parent, stop_time=STOP, step=PERIOD)
    source.component("aircraft", "aircraft.fmu").component("air_data", "air_data.fmu")
    for output in ("altitude", "velocity_n", "roll", "pitch", "heading"):
        source.connect(f"aircraft.{output}", f"air_data.{output}")
    source.connect("aircraft.air_velocity_n", "air_data.wind_n")
    source.parameters("aircraft", {**PLAN.parameters(), "gust_sigma": np.zeros(3), "wander_sigma": np.zeros(3)})
    source.write(folder)
    return System.load(folder)


def fly(
    system: System,
    inputs: Mapping[str, float | bool] | None = None,
    parameters: Mapping[str, float] | None = None,
    seed: int = 1,
    perfect: bool = True,
) -> pd.DataFrame:
    """Readings, without the name of their bundle, and the true altitude."""
    given = {**(PERFECT if perfect else {}), "drain_opening": DRAIN, **(parameters or {})}
    found = system.run(
        stop=STOP,
        step=PERIOD,
        seed=seed,
        parameters={f"air_data.{name}": value for name, value in given.items()},
        faults=[
            Fault(name, f"air_data.{name}", "input", start=FROM, duration=UNTIL - FROM, value=value)
            for name, value in (inputs or {}).items()
        ],
        record=["air_data.air", "aircraft.altitude"],
        record_period=PERIOD,
    )
    found.columns = [name.rsplit(".", 1)[1] for name in found.columns]
    return found.iloc[1:]  # the first row stands before the first sample


def impact(airspeed: np.ndarray) -> np.ndarray:
    """Difference of pressures of a calibrated airspeed, Pa."""
    return 101325.0 * ((1.0 + (airspeed / 340.294) ** 2 / 5.0) ** 3.5 - 1.0)


def airspeed(difference: np.ndarray) -> np.ndarray:
    """Calibrated airspeed of a difference of pressures, m/s."""
    return 340.294 * np.sqrt(5.0 * ((1.0 + np.maximum(difference, 0.0) / 101325.0) ** (2.0 / 7.0) - 1.0))


def pressure(height: pd.Series) -> np.ndarray:
    """Of the standard day, Pa."""
    return ambiance.Atmosphere(height.to_numpy()).pressure


def viscosity(height: float | pd.Series | np.ndarray) -> np.ndarray:
    """By that at sea level."""
    sea_level, *others = ambiance.Atmosphere([0.0, *np.atleast_1d(height)]).dynamic_viscosity
    return np.array(others) / sea_level


def spread(true: pd.DataFrame, flights: Sequence[pd.DataFrame]) -> dict[str, np.ndarray]:
    """Mean squares of errors over the flights every 10 s, by the variances that the parameters give."""
    every = slice(99, None, 100)
    height, shown = (true[name].to_numpy()[every] for name in ("altitude", "calibrated_airspeed"))
    slope = 1.4 * 101325.0 / 340.294 * (shown / 340.294) * (1.0 + (shown / 340.294) ** 2 / 5.0) ** 2.5
    variances = {
        "calibrated_airspeed": 2.6**2 + ((0.02 * impact(shown)) ** 2 + 10.0**2) / slope**2,
        "pressure_altitude": 23.0**2 + 10.0**2 + 2.7**2 + (0.0035 * height) ** 2,
    }
    found = {"time": true.index.to_numpy()[every]}
    for name, variance in variances.items():
        errors = np.stack([(one[name] - true[name]).to_numpy()[every] for one in flights])
        found[name] = np.mean(errors**2, axis=0) / variance
    return found


def make_claims(flights: Mapping[str, pd.DataFrame], squares: Mapping[str, np.ndarray]) -> dict[str, Claim]:
    """By panel."""
    clean = flights["none"]
    time = clean.index.to_numpy()
    blocked = (time > FROM) & (time <= UNTIL)
    later = time[blocked] - FROM
    outside = pressure(clean["altitude"])
    before = impact(clean["calibrated_airspeed"].to_numpy())
    start = np.flatnonzero(blocked)[0] - 1

    pitot = flights["pitot tube and drain blocked"]["calibrated_airspeed"].to_numpy()
    trapped = airspeed(outside[start] + before[start] - outside)
    static = flights["static port blocked"]
    deaf = airspeed(outside + before - outside[start])
    closed = max(
        np.max(np.abs((pitot - trapped)[blocked])),
        np.max(np.abs((static["calibrated_airspeed"].to_numpy() - deaf)[blocked])),
    )
    left = impact(flights["pitot tube blocked, drain open"]["calibrated_airspeed"].to_numpy())[blocked]
    level = (later > 1.0) & (later < 15.0)
    tau = -1.0 / np.polyfit(later[level], np.log(left[level]), 1)[0]
    expected = LAG / DRAIN * 101325.0 / outside[start] * viscosity(clean["altitude"].iloc[start])[0]
    frozen = float(np.ptp(static["pressure_altitude"].to_numpy()[blocked]))
    behind = (clean["pressure_altitude"] - flights["static line of 1 s"]["pressure_altitude"]).to_numpy()
    climbing = (time > 90.0) & (time < 119.0)
    lag = SLOPE * 101325.0 / outside * viscosity(clean["altitude"])
    bounds = stats.chi2.ppf([DOUBT / 2, 1 - DOUBT / 2], len(SEEDS)) / len(SEEDS)
    found = np.concatenate([squares["calibrated_airspeed"], squares["pressure_altitude"]])
    beyond = float(max(found.max() / bounds[1], bounds[0] / found.min()))
    still = np.abs(static["vertical_speed"].to_numpy()[blocked][round(20.0 / PERIOD) :])
    return {
        "blocked": Claim(
            "Airspeed follows the pressure that is trapped", float(closed), CLOSE, False, "m/s",
            "Airspeed does not follow the pressure that is trapped",
        ),
        "drain": Claim(
            "Drain open: to zero with its time constant", float(100.0 * abs(tau / expected - 1.0)), SLOW, False, "%",
            "Drain open: not with its time constant",
        ),
        "static": Claim(
            "A blocked static port freezes the altitude", frozen, 0.0, False, "m",
            "A blocked static port moves the altitude",
        ),
        "late": Claim(
            "A long line is late by its time constant",
            float(100.0 * np.max(np.abs(behind / lag - 1.0)[climbing])), SLOW, False, "%",
            "A long line is not late by its time constant",
        ),
        "climb": Claim(
            "A blocked static port shows no vertical speed", float(np.max(still)), 0.01, False, "m/s",
            "A blocked static port shows a vertical speed",
        ),
        "sigma": Claim(
            f"Errors have their sigmas ({len(SEEDS)} flights)", beyond, 1.0, False, "of chi-square's bounds at 1e-6",
            f"Errors do not have their sigmas ({len(SEEDS)} flights)",
        ),
        "recovery": Claim(
            "Airspeed and altitude have every bit of a flight without the fault 20 s after it",
            float(recovering(flights, UNTIL + 20.0)), 0.0, False, "samples", "Faults leave something behind",
        ),
    }  # fmt: skip


def recovering(flights: Mapping[str, pd.DataFrame], time: float) -> int:
    """Samples after this time that still differ; lines with a lag forget their fault by and by and are left out."""
    count = 0
    for name, (inputs, parameters) in FAULTS.items():
        if inputs and "total_lag_time" not in parameters:
            for reading in ("calibrated_airspeed", "pressure_altitude"):
                late = slice(time, None)
                count += int(np.sum(flights[name][reading].loc[late] != flights["none"][reading].loc[late]))
    return count


def section(flights: Mapping[str, pd.DataFrame], squares: Mapping[str, np.ndarray]) -> Section:
    """Claims and the picture."""
    claims = make_claims(flights, squares)

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.text(
            f"Level, 300 m up, level, 600 m down, level, at {SPEED:g} m/s; faults act from {FROM:g} to {UNTIL:g} s. "
            "What is expected is the textbook's, with the pressures and viscosities of the package ambiance."
        )
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims.values())
        page.picture(picture(flights, claims, squares), "Air data with faults of their lines")

    return Section(list(claims.values()), write)


def picture(
    flights: Mapping[str, pd.DataFrame], claims: Mapping[str, Claim], squares: Mapping[str, np.ndarray]
) -> bytes:
    """Six panels over time."""
    clean = flights["none"]
    panels = {
        "blocked": ("calibrated_airspeed", "airspeed, m/s", ["pitot tube and drain blocked", "static port blocked"]),
        "drain": ("calibrated_airspeed", "airspeed, m/s", ["pitot tube blocked, drain open", "ice, drain open"]),
        "static": ("pressure_altitude", "pressure altitude, m", ["static port blocked", "lines swapped"]),
        "late": (
            "pressure_altitude", "altitude less that without a fault, m",
            ["alternate static source", "20 mm of water in the static line", "static line of 1 s"],
        ),
        "climb": ("vertical_speed", "vertical speed, m/s", ["static port blocked", "alternate static source"]),
    }  # fmt: skip
    with figure(3, 2, size=(11.0, 9.6), sharex=True) as (drawing, axes):
        drawing.subplots_adjust(hspace=0.3, wspace=0.2)
        for ax, (name, (reading, label, shown)) in zip(axes.flat, panels.items(), strict=False):
            less = clean[reading] if name == "late" else 0.0
            if name != "late":
                ax.plot(clean.index, clean[reading], color=GREY, lw=3.0, alpha=0.5, label="without a fault")
            for fault, colour in zip(shown, COLOURS, strict=False):
                ax.plot(clean.index, flights[fault][reading] - less, color=colour, lw=1.2, label=fault)
            ax.axvspan(FROM, UNTIL, color=GREY, alpha=0.08, lw=0)
            ax.set_ylabel(label)
            ax.legend(fontsize=8)
        ax = axes.flat[-1]
        bounds = stats.chi2.ppf([DOUBT / 2, 1 - DOUBT / 2], len(SEEDS)) / len(SEEDS)
        ax.axhspan(*bounds, color=GREY, alpha=0.2, lw=0, label="bounds at 1e-6")
        for (name, label), colour in zip(
            {"calibrated_airspeed": "airspeed", "pressure_altitude": "altitude"}.items(), COLOURS, strict=False
        ):
            ax.plot(squares["time"], squares[name], "o-", ms=3, lw=1, color=colour, label=label)
        ax.set_ylim(0.0, 2.0)
        ax.set_ylabel("mean square of the error by its variance")
        ax.legend()
        axes.flat[-2].set_ylim(-12.0, 12.0)
        for ax, name in zip(axes.flat, claims, strict=False):
            title(drawing, ax, claims[name].sentence)
        for ax in axes[-1]:
            ax.set_xlabel("time, s (shaded: the fault)")
        return png(drawing, 90)
