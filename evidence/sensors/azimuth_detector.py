"""The magnetic azimuth detector: its errors in turns, while it accelerates, and over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pygeomag
from scipy import stats

from evidence.section import Section, illustrated
from navfmu import System
from navfmu.constants import STANDARD_GRAVITY
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.system import shipped

HEADING = "Magnetic azimuth detector"
PLACE = (37.7, -121.8, 1000.0)
"""Livermore: latitude and longitude, degrees, and altitude, m."""
DATE = 2026.0
HEADINGS = np.arange(0.0, 360.0, 15.0)
BANKS = (0.0, 7.5, -15.0)
SIGMA, TIME = 2.5, 120.0
"""Thesis (3.84), (3.85): degrees, s."""
SEEDS, LONG = 200, 3600.0
LAGS = np.arange(0.0, 601.0, 30.0)
PROBABILITY = 1e-6
"""That a process as told is beyond the bound at one lag."""
SHOWN = 900.0


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    found = Found.measured()
    write_file(out / "sensors" / "azimuth_detector.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was measured, degrees."""

    turning: Mapping[float, np.ndarray]
    """Error of the magnetic heading at HEADINGS (magnetic), by bank."""
    field: tuple[float, float]
    """Horizontal and downward field by pygeomag, nT."""
    slow: np.ndarray
    """The slow error, (SEEDS, seconds)."""
    time: np.ndarray
    seen: np.ndarray
    """Error of the heading in level flight with noise, against time."""

    @classmethod
    def measured(cls) -> Found:
        detector = System.load(shipped.path("azimuth_detector.fmu"))
        chart = pygeomag.GeoMag(coefficients_file="wmm/WMM_2025.COF")
        at = chart.calculate(glat=PLACE[0], glon=PLACE[1], alt=PLACE[2] / 1e3, time=DATE)
        exact = {"drift_sigma": 0.0, "noise_sigma": 0.0}
        turning = {}
        for bank in BANKS:
            force = [0.0, 0.0, -STANDARD_GRAVITY / np.cos(np.radians(bank))]
            shown = [
                _run(detector, 1.0, 0.05, heading=np.radians(psi + at.d), roll=np.radians(bank), specific_force=force,
                     **exact)[1][-1] - psi
                for psi in HEADINGS
            ]  # fmt: skip
            turning[bank] = wrapped(np.array(shown))
        slowly = {"noise_sigma": 0.0, "sample_period": 1.0, "heading": np.radians(at.d)}
        slow = [_run(detector, LONG, 1.0, seed=seed, **slowly)[1] for seed in range(1, SEEDS + 1)]
        time, seen = _run(detector, SHOWN, 0.05, seed=1, heading=np.radians(at.d))
        return cls(turning, (at.h, at.z), np.array(slow), time, seen)

    @property
    def correlation(self) -> np.ndarray:
        """Covariance of the slow error over SIGMA^2 at LAGS by run, (SEEDS, lags)."""
        count = self.slow.shape[1]
        lags = LAGS.astype(int)
        return np.stack(
            [np.mean(self.slow[:, : count - k] * self.slow[:, k:], axis=1) / SIGMA**2 for k in lags], axis=1
        )


def _run(detector: System, stop: float, step: float, seed: int = 1, **given: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times and magnetic headings, degrees, from the first sample on."""
    parameters = {"latitude": np.radians(PLACE[0]), "longitude": np.radians(PLACE[1]), "altitude": PLACE[2]}
    parameters |= {"date": DATE, **given}
    frame = detector.run(
        stop=stop, step=step, seed=seed, record=["azimuth_detector.azimuth.magnetic_heading"], record_period=step,
        parameters={f"azimuth_detector.{name}": value for name, value in parameters.items()},
    )  # fmt: skip
    frame = frame[frame.index >= 1.0]
    return frame.index.to_numpy(), np.degrees(frame.to_numpy()[:, 0])


def wrapped(angle: np.ndarray) -> np.ndarray:
    """The angle from -180 to 180 degrees."""
    return (angle + 180.0) % 360.0 - 180.0


def turning_error(psi: np.ndarray, bank: float, field: tuple[float, float]) -> np.ndarray:
    """Of what hangs across the aircraft's own vertical in a coordinated turn, degrees."""
    horizontal, down = field
    psi, bank = np.radians(psi), np.radians(bank)
    right = horizontal * np.sin(psi) * np.cos(bank) - down * np.sin(bank)
    return wrapped(np.degrees(np.arctan2(right, horizontal * np.cos(psi)) - psi))


def make_claims(found: Found) -> list[Claim]:
    """Each panel's, in their order."""
    off = max(
        np.max(np.abs(wrapped(found.turning[b] - turning_error(HEADINGS, b, found.field)))) for b in found.turning
    )
    runs = found.correlation
    error = runs.std(axis=0, ddof=1) / np.sqrt(len(runs))
    beyond = np.max(np.abs(runs.mean(axis=0) - np.exp(-LAGS / TIME)) / error)
    bound = float(stats.norm.isf(0.5 * PROBABILITY))
    count = len(found.seen) // 20 * 20
    means = found.seen[:count].reshape(-1, 20).mean(axis=1)
    white = np.std(np.diff(means)) / np.sqrt(2.0)
    return [
        Claim(
            "In a turn it measures of the steep field", off, 1e-3, False, "deg",
            "In a turn it does not measure what hangs askew does",
        ),
        Claim(
            f"Its slow error has {SIGMA:g} degrees and {TIME:g} s", beyond, bound, False, "standard errors",
            f"Its slow error has not {SIGMA:g} degrees and {TIME:g} s",
        ),
        Claim(
            "Its noise is 0.8 degrees over a second", abs(white - 0.8), 0.1, False, "deg",
            "Its noise is not 0.8 degrees over a second",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, and the picture."""
    words = "Errors in turns by heading, correlation of the slow error, noise against time"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words)


def picture(found: Found) -> bytes:
    """Error in turns by heading; correlation of the slow error; noise against time."""
    claims = make_claims(found)
    with figure(1, 3, size=(12.0, 3.9)) as (drawing, (turn, slow, time)):
        fine = np.linspace(0.0, 360.0, 721)
        for (bank, error), colour in zip(found.turning.items(), COLOURS, strict=False):
            side = "level" if bank == 0.0 else f"{abs(bank):g} deg to the {'right' if bank > 0.0 else 'left'}"
            turn.plot(HEADINGS, error, "o", color=colour, ms=4, label=f"bank: {side}")
            turn.plot(fine, turning_error(fine, bank, found.field), color=colour, lw=1)
        turn.set_xticks(np.arange(0, 361, 90))
        turn.set_ylim(None, 1.7 * turn.get_ylim()[1])
        turn.set_xlabel("magnetic heading, deg; lines: closed form")
        turn.set_ylabel("error of the heading, deg")
        mean = found.correlation.mean(axis=0)
        error = stats.norm.isf(0.5 * PROBABILITY) * found.correlation.std(axis=0, ddof=1) / np.sqrt(len(found.slow))
        slow.errorbar(LAGS, mean, error, fmt="o", color=COLOURS[0], ms=4, lw=1,
                      label=f"{len(found.slow)} h of flight, bars: 1 - {PROBABILITY:.0e}")  # fmt: skip
        slow.plot(LAGS, np.exp(-LAGS / TIME), color=COLOURS[1], lw=1, label=f"exp(-t / {TIME:g} s)")
        slow.set_xlabel("lag, s")
        slow.set_ylabel(f"covariance over ({SIGMA:g} deg)^2")
        count = len(found.seen) // 20 * 20
        seconds, means = (x[:count].reshape(-1, 20).mean(axis=1) for x in (found.time, found.seen))
        time.plot(found.time[::10], found.seen[::10], ".", color=GREY, ms=1.5, label="samples (every tenth)")
        time.plot(seconds, means, color=COLOURS[0], lw=0.7, label="means over 1 s")
        time.set_ylim(None, 1.4 * np.max(found.seen))
        time.set_xlabel("time, s")
        time.set_ylabel("error of the heading, deg")
        for ax, claim in zip((turn, slow, time), claims, strict=True):
            ax.set_title(claim.sentence, fontsize=9)
            ax.legend(fontsize=8, loc="upper right")
        drawing.subplots_adjust(wspace=0.28)
        return png(drawing)
