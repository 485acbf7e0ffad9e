"""Simulated observations of a station beside those that were recorded there on the same day."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from evidence.section import Section, left_out, recorded
from evidence.sensors.observed import FILES, Station, errors, rms, velocities
from evidence.sensors.simulated import Simulated
from models.satellite import signal_power, tracking
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page

HEADING = "GPS as signals"
SEEDS = (1, 2, 3, 4)
BANDS = np.array([10.0, 20.0, 30.0, 45.0, 60.0, 90.0])
"""Of elevation, degrees."""


def run(out: Path) -> Section:
    """Measure, solve, compare and draw."""
    gnss, lacking = recorded(*FILES, under="gnss")
    if lacking:
        return left_out(HEADING, lacking)
    both = Both(Solved(Station(gnss)), [Solved(Simulated(gnss, seed)) for seed in SEEDS])
    write_file(out / "sensors" / "gps_signals.png", picture(both))
    return section(both)


@dataclass(frozen=True)
class Solved:
    """A day of observations, and what the solver makes of them."""

    station: Station

    @cached_property
    def rows(self) -> range:
        return range(len(self.station.observations))

    @cached_property
    def found(self) -> dict[str, np.ndarray]:
        return self.station.solve(self.rows)

    @cached_property
    def errors(self) -> np.ndarray:
        return errors(self.found)

    @cached_property
    def strengths(self) -> np.ndarray:
        """C/N0 of what is used, dB-Hz, NaN elsewhere."""
        strength = np.array([self.station.signals(row)["signals.signal_to_noise"] for row in self.rows])
        return np.where(self.used, strength, np.nan)

    @property
    def used(self) -> np.ndarray:
        return self.found["used"] > 0.0

    def by_band(self, values: np.ndarray, statistic) -> np.ndarray:
        """A statistic of what is used in each of BANDS."""
        band = np.digitize(np.degrees(self.found["elevation"]), BANDS)
        return np.array([statistic(values[self.used & (band == k)]) for k in range(1, len(BANDS))])

    @cached_property
    def residuals(self) -> np.ndarray:
        """Standard deviation in each of BANDS, m."""
        return self.by_band(self.found["residual"], np.std)

    @cached_property
    def strength(self) -> np.ndarray:
        """Mean C/N0 in each of BANDS, dB-Hz."""
        return self.by_band(self.strengths, np.mean)


@dataclass(frozen=True)
class Both:
    recorded: Solved
    simulated: Sequence[Solved]

    def mean(self, of) -> np.ndarray:
        """The root of the mean of squares of the simulated days."""
        return rms(np.array([of(day) for day in self.simulated]))

    def apart(self, of) -> float:
        """Largest difference of a size between the simulated days and the recorded one, %."""
        return 100.0 * float(np.max(np.abs(self.mean(of) / of(self.recorded) - 1.0)))

    @cached_property
    def claims(self) -> list[Claim]:
        pairs = (
            ("As many satellites are used, within", lambda day: np.array([day.found["satellites"].mean()]), 1.0),
            ("Residuals of pseudoranges spread alike in each of five bands of elevation, within",
             lambda day: day.residuals, 20.0),
            ("Velocities east, north, up are off alike (rms), within", lambda day: rms(velocities(day.found)), 20.0),
            ("Positions east, north, up are off alike (rms), within", lambda day: rms(day.errors), 40.0),
        )  # fmt: skip
        made = [
            Claim(text, self.apart(of), bound, False, "%", text.partition(", within")[0].replace("alike", "otherwise"))
            for text, of, bound in pairs
        ]
        strength = np.max(np.abs(self.mean(lambda day: day.strength) - self.recorded.strength))
        text = "C/N0 is that of the recorded signals in each band, within"
        return [*made, Claim(text, float(strength), 2.0, False, "dB", "C/N0 is another one than that recorded")]


def section(both: Both) -> Section:
    """What was found."""

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.text(
            f"A station's day as a receiver's model measures it ({len(SEEDS)} seeds), solved as the recorded "
            f"observations are. Errors of ranges are forgotten in an hour, so the rms of a day is known to 14 % (1 "
            "sigma), that of positions to 40 % at 3 sigma."
        )
        page.items(f"{claim.sentence}: {claim.finding}" for claim in both.claims)
        page.picture(picture(both), "Strength, residuals and positions, recorded and simulated; reach of jammers")

    return Section(both.claims, write)


def picture(both: Both) -> bytes:
    """Strength, residuals and errors of positions of both, and how far jammers reach."""
    with figure(2, 2, size=(14.0, 8.6)) as (drawing, axes):
        strength, spread, position, jammed = np.ravel(axes)
        middle = 0.5 * (BANDS[1:] + BANDS[:-1])
        for day, label, colour in ((both.recorded, "recorded", "black"), (both.simulated[0], "simulated", COLOURS[0])):
            some = np.s_[::20]
            elevation = np.degrees(day.found["elevation"][some])
            strength.plot(elevation.ravel(), day.strengths[some].ravel(), ".", ms=2, color=colour, label=label)
            spread.plot(middle, day.residuals, "o-", color=colour, label=label)
            off = np.sort(np.linalg.norm(day.errors, axis=1))
            position.plot(off, np.linspace(0.0, 100.0, len(off)), color=colour, label=label)
        for day in both.simulated[1:]:
            spread.plot(middle, day.residuals, "-", lw=0.7, color=COLOURS[0])
            off = np.sort(np.linalg.norm(day.errors, axis=1))
            position.plot(off, np.linspace(0.0, 100.0, len(off)), lw=0.7, color=COLOURS[0])
        strength.set(xlabel="elevation, deg", ylabel="C/N0, dB-Hz", xlim=(10, 90))
        spread.set(xlabel="elevation, deg", ylabel="residuals, m (1 sigma)", ylim=(0, 1.2))
        position.set(xlabel="error of position, m", ylabel="positions within, %", xlim=(0, 5), ylim=(0, 100))

        distance = np.geomspace(1e2, 1e6, 200)
        signal = signal_power.of_satellite(22e6, 2.0)
        for k, power in enumerate((0.01, 1.0, 100.0)):
            noise = signal_power.ratio(signal_power.of_jammer(power, distance))
            ratio = signal_power.carrier_to_noise(signal, noise, signal_power.NOISE_DENSITY, 1.0)
            jammed.plot(distance / 1e3, signal_power.decibel(ratio), color=COLOURS[k], label=f"jammer of {power:g} W")
        least = signal_power.decibel(tracking.threshold(3.0, 1.0, 50.0))
        for level, what in ((33.0, "found"), (25.0, "carrier lost"), (least, "code lost")):
            jammed.axhline(level, color=GREY, ls=":")
            jammed.text(0.11, level + 0.6, what, fontsize=8)
        jammed.set(xscale="log", xlabel="distance of a jammer, km, equal gains", ylabel="C/N0, dB-Hz", ylim=(0, 50))

        panels = {
            strength: "Strength of a day at a station",
            spread: "Residuals are as large as the recorded ones",
            position: "So are errors of positions",
            jammed: "A jammer reaches as far as free space lets it",
        }
        for panel, text in panels.items():
            title(drawing, panel, text)
            panel.legend(fontsize=8)
        return png(drawing, 80)
