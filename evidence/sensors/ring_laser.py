"""Ring-laser gyros: the dead zone, what dither makes of it, and what is seen when the dither fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from evidence.section import Section
from models.inertial import ring_laser
from navfmu import System
from navfmu.faults import Fault
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system import shipped

HOUR, ARCSEC = 3600.0, float(np.pi / 648000.0)
PULSE, LOCK_IN, DITHER = 2.0 * ARCSEC, 300.0 * ARCSEC, float(np.radians(100.0))
"""Start values of the FMU: rad, rad/s, rad/s."""
RATES = np.linspace(-3.0, 3.0, 61)
"""Of the lock-in rate."""
SPAN = 100.0
"""Time over which pulses are counted for a point, s."""
SEEDS = 40
SHOWN = np.array([0.5, 1.05, 2.0])
"""Rates of the three axes while the dither fails, of the lock-in rate."""
OFF, ON, END = 60.0, 180.0, 240.0


def run(out: Path) -> Section:
    """Turn, count and draw."""
    rings = Rings()
    made = section(rings)
    write_file(out / "sensors" / "ring_laser.png", picture(rings, made.claims))
    return made


def section(rings: Rings) -> Section:
    """What was found."""
    claims = [rings.dead, rings.walked, rings.failed]

    def write(page: Page) -> None:
        page.heading("Ring-laser gyros", 3)
        page.items(claim.sentence for claim in claims)
        page.picture(picture(rings, claims), "Dead zone, random walk of the dither, and a dither that fails")

    return Section(claims, write)


def angles(stop: float, step: float, every: float, faults: Sequence[Fault] = (), **given: Any) -> np.ndarray:
    """Increments of the FMU between rows that are ``every`` s apart, rad, (rows, 3)."""
    seed = given.pop("seed", 1)
    names = [f"ring_laser.increment.angle[{i}]" for i in (1, 2, 3)]
    recorded = System.load(shipped.path("ring_laser.fmu")).run(
        stop=stop,
        step=step,
        seed=seed,
        faults=faults,
        parameters={f"ring_laser.{name}": value for name, value in ({"sample_period": step} | given).items()},
        record=["ring_laser.increment.angle"],
        record_period=step,
    )
    return recorded[names].to_numpy()[1:].reshape(round(stop / every), -1, 3).sum(axis=1)


@dataclass(frozen=True)
class Rings:
    """What is measured, each part when it is first asked for."""

    @cached_property
    def shown(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean rates that RATES show over SPAN without and with dither, of the lock-in rate."""
        padded = np.append(RATES, np.zeros(-len(RATES) % 3)).reshape(-1, 3) * LOCK_IN
        without, dithered = (
            np.ravel([angles(SPAN, 0.1, SPAN, rate=[*rates], dither_off=off)[0] for rates in padded])[: len(RATES)]
            for off in (True, False)
        )
        return without / SPAN / LOCK_IN, dithered / SPAN / LOCK_IN

    @property
    def dead(self) -> Claim:
        off = np.abs(self.shown[0] * LOCK_IN - ring_laser.beat(RATES * LOCK_IN, LOCK_IN)) * SPAN / PULSE
        return Claim(
            "Without dither slow turning is not seen, and fast turning as sqrt(w² - w_L²): off it in 100 s, in pulses",
            float(np.max(off)), 2.0, False, opposite="Without dither rates are not those of Adler's equation",
        )  # fmt: skip

    @cached_property
    def walks(self) -> np.ndarray:
        """Angles of rings at rest every minute of an hour, arcsec: (minutes, rings)."""
        found = [angles(HOUR, 1.0, 60.0, seed=seed) for seed in range(1, SEEDS + 1)]
        return np.cumsum(np.concatenate(found, axis=1), axis=0) / ARCSEC

    @property
    def sigma(self) -> float:
        """Angle random walk, arcsec per root second."""
        return float(ring_laser.random_walk(LOCK_IN, PULSE, DITHER, 0.0)) / ARCSEC

    @property
    def walked(self) -> Claim:
        rings = self.walks.shape[1]
        ratio = float(np.mean(self.walks[-1] ** 2) / (self.sigma**2 * HOUR))
        tail = stats.chi2.ppf(1.0 - 5e-7, rings) / rings - 1.0
        walk = np.degrees(self.sigma * ARCSEC) * 60.0
        return Claim(
            f"Dither leaves a walk of {walk:.2g} deg/√h: mean square of {rings} rings after an hour, off the formula",
            100.0 * abs(ratio - 1.0), 100.0 * tail, False, "%", "Dither leaves another walk than the formula's",
        )  # fmt: skip

    @cached_property
    def failing(self) -> np.ndarray:
        """Rates of the three axes, second by second, while the dither is off from OFF to ON, of the lock-in rate."""
        fault = Fault("dither", "ring_laser.dither_off", "input", OFF, ON - OFF, {"value": True})
        return angles(END, 0.1, 1.0, [fault], rate=[*(SHOWN * LOCK_IN)]) / LOCK_IN

    @cached_property
    def sound(self) -> np.ndarray:
        """The same without the fault."""
        return angles(END, 0.1, 1.0, rate=[*(SHOWN * LOCK_IN)]) / LOCK_IN

    @property
    def failed(self) -> Claim:
        first, last = round(OFF), round(ON)
        before = np.array_equal(self.sound[:first], self.failing[:first])
        after = np.max(np.abs(np.cumsum(self.failing[last:] - self.sound[last:], axis=0))) * LOCK_IN / PULSE
        silent = np.all(self.failing[first + 1 : last, 0] == 0.0)
        return Claim(
            "A failed dither is silence below the lock-in rate, and then over: off a sound ring after it, in pulses",
            float(after) if before and silent else np.inf, 1.0 + 1e-6, False,
            opposite="A failed dither is not silence, or not over with the fault",
        )  # fmt: skip


def picture(rings: Rings, claims: Sequence[Claim]) -> bytes:
    """A panel for each claim."""
    with figure(1, 3, size=(14.0, 4.4)) as (drawing, (zone, walk, failure)):
        smooth = np.linspace(RATES[0], RATES[-1], 1201)
        without, dithered = rings.shown
        zone.plot(smooth, ring_laser.beat(smooth, 1.0), "-", color=COLOURS[1], lw=0.8, label="sign(w) √(w² - w_L²)")
        zone.plot(RATES, without, "o", ms=3, color=COLOURS[1], label="ring_laser.fmu, dither off")
        zone.plot(RATES, dithered, ".", ms=4, color=COLOURS[0], label="ring_laser.fmu")
        zone.set(xlabel="rate w, of the lock-in rate of 300 deg/h", ylabel="mean rate of the pulses in 100 s")

        minutes = np.arange(1, len(rings.walks) + 1)
        for row in rings.walks.T:
            walk.plot(minutes, row, color=COLOURS[0], lw=0.5, alpha=0.4)
        for k, style in ((1, "k-"), (2, "k--")):
            for sign in (-1.0, 1.0):
                label = f"{k} sigma of w_L √(K t / 2π w_D)" if sign > 0 else None
                walk.plot(minutes, sign * k * rings.sigma * np.sqrt(60.0 * minutes), style, lw=1, label=label)
        walk.set(xlabel="time at rest, min", ylabel="angle, arcsec")

        seconds = np.arange(1, len(rings.failing) + 1)
        failure.axvspan(OFF, ON, color=GREY, alpha=0.15, lw=0, label="dither off")
        for i, rate in enumerate(SHOWN):
            failure.plot(seconds, rings.failing[:, i], color=COLOURS[i], lw=1, label=f"w = {rate:g} w_L")
        failure.set(xlabel="time, s", ylabel="rate of the pulses in a second, of w_L")

        for panel, claim in zip((zone, walk, failure), claims, strict=True):
            title(drawing, panel, claim.sentence.partition(":")[0].partition(",")[0])
            panel.legend(fontsize=8)
        return png(drawing, 80)
