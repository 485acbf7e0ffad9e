"""The magnetometer: the field of the date, what turns the needle, and what is left at a height."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pygeomag
from scipy import integrate, special

from evidence.section import Section, illustrated
from navfmu import System
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.system import shipped

HEADING = "Magnetometer"
PLACES = {
    "Livermore": (37.7, -121.8),
    "Minnesota": (45.3, -93.2),
    "Switzerland": (47.4, 8.0),
    "Tromsø": (69.7, 18.9),
}
"""Latitude and longitude, degrees."""
DATES = np.linspace(2010.0, 2030.0, 41)
CHARTS = {2010: "2010", 2015: "2015v2", 2020: "2020", 2025: "2025"}
"""pygeomag's file of each epoch."""
EXACT = (
    "crustal_level", "hard_iron_sigma", "soft_iron_sigma", "scale_factor_sigma", "misalignment_sigma", "noise_sigma"
)  # fmt: skip
"""Parameters that are zero for a triad without errors."""
ALTITUDE = 1000.0
HEADINGS = np.arange(0.0, 360.0, 15.0)
MILLIGAUSS, AMPERE = 1e-7, 3.0
SOFT = np.array([[0.04, 0.03, 0.0], [-0.01, -0.04, 0.0], [0.0, 0.0, 0.0]])
FAULTS: dict[str, tuple[str, Any]] = {
    "hard iron, 10 mG forward (F16)": ("hard_iron_change", [10 * MILLIGAUSS, 0.0, 0.0]),
    f"{AMPERE:g} A in a wire 0.5 m below (F16)": ("wire_current", AMPERE),
    "soft iron of some percent (F17)": ("soft_iron_change", SOFT),
}
LENGTH, DEPTH = 10e3, 50.0
HEIGHTS = np.array([0.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10000.0])
"""Above the ground, m."""
ON, OFF, STOP = 10.0, 20.0, 30.0


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    found = Found.measured()
    write_file(out / "sensors" / "magnetometer.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was measured; fields in T, angles in degrees."""

    field: Mapping[str, np.ndarray]
    """North, east, down at each place and date, (dates, 3)."""
    charted: Mapping[str, np.ndarray]
    """The same by pygeomag."""
    turned: Mapping[str, np.ndarray]
    """Error of the magnetic heading at HEADINGS, by fault."""
    expected: Mapping[str, np.ndarray]
    """The same by thesis (3.48) to (3.52)."""
    dipole: np.ndarray
    """Share of an anomaly on the ground that is left at HEIGHTS."""
    crust: np.ndarray
    """Share of the crustal anomaly that is left at HEIGHTS."""
    time: np.ndarray
    sound: np.ndarray
    """Error of the heading of an ordinary triad without a current, against time."""
    faulty: np.ndarray
    """The same while AMPERE flow from ON to OFF."""

    @classmethod
    def measured(cls) -> Found:
        triad = System.load(shipped.path("magnetometer.fmu"))
        field = {name: np.array([_exact(triad, place, date=date) for date in DATES]) for name, place in PLACES.items()}
        models = {epoch: pygeomag.GeoMag(coefficients_file=f"wmm/WMM_{name}.COF") for epoch, name in CHARTS.items()}
        charted = {
            name: np.array([_charted(models[min(int(date // 5) * 5, 2025)], place, date) for date in DATES])
            for name, place in PLACES.items()
        }
        sound = _exact(triad, PLACES["Livermore"])
        turned = {name: _swing(triad, sound, fault) for name, fault in FAULTS.items()}
        expected = {name: _deviation(sound, fault) for name, fault in FAULTS.items()}
        dipole = _left(triad, anomaly_n=[0.0, 0.0, 100 * MILLIGAUSS])
        crust = _left(triad, crustal_level=1.0, crust_decays=True, crustal_length=LENGTH)
        flights = [_flight(triad, faults) for faults in ((), [Fault("current", "magnetometer.wire_current", "input",
                   ON, OFF - ON, {"value": AMPERE})])]  # fmt: skip
        return cls(field, charted, turned, expected, dipole, crust, *flights[0], flights[1][1])


def _triad(triad: System, place: Sequence[float], stop: float = 1.0, **given: Any) -> dict[str, Any]:
    parameters = {"latitude": np.radians(place[0]), "longitude": np.radians(place[1]), "altitude": ALTITUDE, **given}
    return {"stop": stop, "step": 0.05, "parameters": {f"magnetometer.{n}": v for n, v in parameters.items()}}


def _exact(triad: System, place: Sequence[float], **given: Any) -> np.ndarray:
    """What a triad without errors measures after a second, T."""
    given = {**dict.fromkeys(EXACT, 0.0), **given}
    run = triad.run(**_triad(triad, place, **given), record=["magnetometer.field.field_b"], record_period=1.0)
    return run.to_numpy()[-1]


def _charted(model: pygeomag.GeoMag, place: Sequence[float], date: float) -> np.ndarray:
    r = model.calculate(glat=place[0], glon=place[1], alt=ALTITUDE / 1e3, time=float(date))
    return np.array([r.x, r.y, r.z]) * 1e-9


def _heading_error(field_b: np.ndarray, sound: np.ndarray, heading: np.ndarray | float) -> np.ndarray:
    """Of a level aircraft, degrees: magnetic heading by thesis (2.3) and the declination of ``sound``, less heading."""
    declination = np.arctan2(sound[1], sound[0])
    error = np.arctan2(-field_b[..., 1], field_b[..., 0]) + declination - np.radians(heading)
    return np.degrees((error + np.pi) % (2 * np.pi) - np.pi)


def _swing(triad: System, sound: np.ndarray, fault: tuple[str, Any]) -> np.ndarray:
    seen = [_exact(triad, PLACES["Livermore"], heading=np.radians(h), **{fault[0]: fault[1]}) for h in HEADINGS]
    return _heading_error(np.array(seen), sound, HEADINGS)


def _deviation(sound: np.ndarray, fault: tuple[str, Any]) -> np.ndarray:
    """A + B sin + C cos + D sin 2 + E cos 2 of the magnetic heading, thesis (3.52), degrees."""
    horizontal = np.hypot(sound[0], sound[1])
    psi = np.radians(HEADINGS) - np.arctan2(sound[1], sound[0])
    iron = {"hard_iron_change": lambda: np.array(fault[1]), "wire_current": lambda: _wire(fault[1])}
    x, y, _ = iron[fault[0]]() if fault[0] in iron else np.zeros(3)
    alpha = np.array(fault[1]) if fault[0] == "soft_iron_change" else np.zeros((3, 3))
    terms = (
        0.5 * (alpha[0, 1] - alpha[1, 0]),
        -x / horizontal * np.sin(psi),
        -y / horizontal * np.cos(psi),
        0.5 * (alpha[1, 1] - alpha[0, 0]) * np.sin(2 * psi),
        -0.5 * (alpha[0, 1] + alpha[1, 0]) * np.cos(2 * psi),
    )
    return np.degrees(sum(terms))


def _wire(current: float) -> np.ndarray:
    """Of 2 m of wire along the fuselage, 0.5 m below: Biot and Savart's integral, T."""
    below = 0.5
    integral, _ = integrate.quad(lambda x: below / (x * x + below * below) ** 1.5, -1.0, 1.0)
    return np.array([0.0, 1e-7 * current * integral, 0.0])


def _left(triad: System, **given: Any) -> np.ndarray:
    """What an addition to the field downward is at HEIGHTS, of what it is on the ground."""
    place = PLACES["Livermore"]
    added = [(_exact(triad, place, altitude=h, **given) - _exact(triad, place, altitude=h))[2] for h in HEIGHTS]
    return np.array(added) / added[0]


def _flight(triad: System, faults: Sequence[Fault]) -> tuple[np.ndarray, np.ndarray]:
    heading = 60.0
    given = _triad(triad, PLACES["Livermore"], STOP, heading=np.radians(heading), crustal_level=0.0)
    run = triad.run(**given, seed=3, faults=faults, record=["magnetometer.field.field_b"], record_period=0.05)
    sound = _exact(triad, PLACES["Livermore"])
    run = run[run.index >= 1.0]
    return run.index.to_numpy(), _heading_error(run.to_numpy(), sound, heading)


def waves_left(height: np.ndarray) -> np.ndarray:
    """Root of 1 - pi x / 2 (H_0(x) - Y_0(x)), x = 2 h / L: of waves with the correlation exp(-d / L)."""
    x = np.maximum(2.0 * np.asarray(height) / LENGTH, 1e-12)
    return np.sqrt(1.0 - 0.5 * np.pi * x * (special.struve(0, x) - special.y0(x)))


def dipole_left(height: np.ndarray) -> np.ndarray:
    """Third power of the distance from DEPTH below the ground."""
    return (DEPTH / (DEPTH + height)) ** 3


def make_claims(found: Found) -> list[Claim]:
    """Each panel's, in their order."""
    apart = max(np.max(np.abs(found.field[name] - found.charted[name])) for name in PLACES) * 1e9
    turned = max(np.max(np.abs(found.turned[name] - found.expected[name])) for name in FAULTS)
    left = max(np.max(np.abs(found.dipole - dipole_left(HEIGHTS))), np.max(np.abs(found.crust - waves_left(HEIGHTS))))
    inside = (found.time > ON + 1e-9) & (found.time < OFF + 1e-9)
    change = np.abs(found.faulty - found.sound)
    outside = np.max(change[~inside]) if np.all(change[inside] > 0.0) else np.inf
    return [
        Claim(
            "Every date has the field of its model, as pygeomag has it", apart, 0.1, False, "nT",
            "Not every date has the field of its model",
        ),
        Claim(
            "Hard iron and currents turn the needle once in a circle, soft iron twice, as (3.48) says",
            turned, 0.1, False, "deg", "The needle turns otherwise than (3.48) says",
        ),
        Claim(
            "What lies on the ground and in the crust falls with the height as potential theory says",
            100 * left, 0.3, False, "%", "Fields of the ground fall with the height in another way",
        ),
        Claim(
            "A current acts while it flows and leaves nothing behind", outside, 0.0, False, "deg",
            "A current does not act, or acts when it does not flow",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, and the picture."""
    words = "Declination by date, heading errors of faults, decay with height, a current"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words)


def _means(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Over each second of 20 samples."""
    count = len(values) // 20 * 20
    return time[:count].reshape(-1, 20).mean(axis=1), values[:count].reshape(-1, 20).mean(axis=1)


def picture(found: Found) -> bytes:
    """Declination by date; heading errors over a circle; shares over the height; a current in a flight."""
    claims = make_claims(found)
    with figure(2, 2, size=(11.0, 7.6)) as (drawing, axes):
        (dates, circle), (heights, flight) = axes
        for (name, field), colour in zip(found.field.items(), COLOURS, strict=False):
            charted = found.charted[name]
            dates.plot(DATES, np.degrees(np.arctan2(field[:, 1], field[:, 0])), color=colour, label=name)
            dates.plot(DATES[::4], np.degrees(np.arctan2(charted[::4, 1], charted[::4, 0])), "o", color=colour, ms=4)
        for epoch in list(CHARTS)[1:]:
            dates.axvline(epoch, color=GREY, lw=0.8, ls=":")
        dates.set_xticks(np.arange(2010, 2031, 5))
        dates.set_xlabel("date (dotted: a new model begins); points: pygeomag")
        dates.set_ylabel("declination, deg east")
        for (name, turned), colour in zip(found.turned.items(), COLOURS, strict=False):
            circle.plot(HEADINGS, turned, "o", color=colour, ms=4, label=name)
            circle.plot(HEADINGS, found.expected[name], color=colour, lw=1)
        circle.set_xticks(np.arange(0, 361, 60))
        circle.set_ylim(None, 1.9 * circle.get_ylim()[1])
        circle.set_xlabel("true heading, deg; lines: A ... E of (3.52)")
        circle.set_ylabel("error of the heading, deg")
        fine = np.geomspace(1.0, HEIGHTS[-1], 200)
        for name, points, line, colour in (
            (f"anomaly of a dipole {DEPTH:g} m below the ground (F18)", found.dipole, dipole_left, COLOURS[0]),
            (f"crust, correlated over {LENGTH / 1e3:g} km on the ground", found.crust, waves_left, COLOURS[1]),
        ):
            heights.semilogx(HEIGHTS[1:], 100 * points[1:], "o", color=colour, ms=4, label=name)
            heights.semilogx(fine, 100 * line(fine), color=colour, lw=1)
        heights.set_ylim(0.0, 130.0)
        heights.set_xlabel("height above the ground, m; lines: closed forms")
        heights.set_ylabel("left of the field on the ground, %")
        flight.plot(found.time, found.sound, ".", color=GREY, ms=2, label="no current")
        flight.plot(
            found.time, found.faulty, ".", color=COLOURS[1], ms=2, label=f"{AMPERE:g} A from {ON:g} to {OFF:g} s"
        )
        flight.plot(*_means(found.time, found.faulty), color=COLOURS[6], lw=1.5, label="its means over 1 s")
        flight.set_xlabel("time, s (heading 60 deg, default errors and noise)")
        flight.set_ylabel("error of the heading, deg")
        flight.set_ylim(None, flight.get_ylim()[1] + 2.0)
        titles = (
            f"{claims[0].sentence.split(',')[0]}\n(within {claims[0].measured:.0e} nT of pygeomag)",
            claims[1].sentence.replace(" in a circle, ", ",\n"),
            claims[2].sentence.replace(" falls with", "\nfalls with"),
            claims[3].sentence,
        )
        for ax, title in zip(axes.flat, titles, strict=True):
            ax.set_title(title, fontsize=10)
            ax.legend(fontsize=8, loc="upper right" if ax is not dates else "center right")
        drawing.subplots_adjust(hspace=0.42, wspace=0.2, top=0.93)
        return png(drawing)
