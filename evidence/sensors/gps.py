"""GPS as positions and as signals, and three antennas, in the backup navigator: errors and whether they are known."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from evidence.section import Section
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system.system import System

HEADING = "GPS in the backup navigator"
VARIANTS = {"positions": None, "signals": "gps_signals", "three antennas": "three_antennas"}
SEEDS = range(1, 21)
LOST = 300
"""Second at which GPS is lost until the end (faults/gps_lost.toml)."""
SETTLED = 60
NORTH_EAST = "navigator.position_covariance[2]"
SIGNALS = (
    NORTH_EAST,
    *(f"evaluation.{name}" for name in ("north_error", "east_error")),
    *(f"navigator.{name}" for name in ("north_sigma", "east_sigma")),
    *("aircraft.heading", "ahrs.attitude.heading", "ahrs.attitude.heading_sigma"),
)
SHOWN = (
    "GPS as", "with GPS: error, m rms", "NEES (2)", "heading, deg rms", "its sigma, deg", "without: error, m rms",
    "NEES (2)", "heading in the first 30 s, deg rms", "from 5 min on, deg rms", "its sigma, deg",
)  # fmt: skip


@dataclass(frozen=True)
class Flights:
    """Of one variant, values by name, each (seeds, seconds)."""

    values: dict[str, np.ndarray]

    @classmethod
    def of(cls, variant: str | None) -> Flights:
        """Fly."""
        system = System.load("backup_navigator", variant)

        def one(seed: int) -> dict[str, np.ndarray]:
            run = system.run(seed=seed, faults="gps_lost", record=SIGNALS, record_period=1.0)
            return {name: run[name].to_numpy(float) for name in SIGNALS}

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            runs = list(pool.map(one, SEEDS))
        return cls({name: np.array([run[name] for run in runs]) for name in SIGNALS})

    @cached_property
    def error(self) -> np.ndarray:
        """Horizontal, m."""
        return np.hypot(self.values["evaluation.north_error"], self.values["evaluation.east_error"])

    @cached_property
    def squares(self) -> np.ndarray:
        """Normalised squared error of the position."""
        north, east = self.values["evaluation.north_error"], self.values["evaluation.east_error"]
        a, c = self.values["navigator.north_sigma"] ** 2, self.values["navigator.east_sigma"] ** 2
        b = self.values[NORTH_EAST]
        with np.errstate(divide="ignore", invalid="ignore"):  # before there is a position
            return (c * north**2 - 2.0 * b * north * east + a * east**2) / (a * c - b * b)

    @cached_property
    def heading(self) -> np.ndarray:
        """Error, deg."""
        apart = self.values["ahrs.attitude.heading"] - self.values["aircraft.heading"]
        return np.degrees((apart + np.pi) % (2.0 * np.pi) - np.pi)

    @cached_property
    def sigma(self) -> np.ndarray:
        """Of the heading, deg."""
        return np.degrees(self.values["ahrs.attitude.heading_sigma"])

    def row(self) -> list[str]:
        """What SHOWN names but for the variant."""
        calibrating, coasting = slice(SETTLED, LOST), slice(LOST + 1, None)
        late = slice(LOST + 300, None)
        return [
            f"{rms(self.error[:, calibrating]):.2f}", f"{np.mean(self.squares[:, calibrating]):.2f}",
            f"{rms(self.heading[:, calibrating]):.2f}", f"{np.mean(self.sigma[:, calibrating]):.2f}",
            f"{rms(self.error[:, coasting]):.0f}", f"{np.mean(self.squares[:, coasting]):.2f}",
            f"{rms(self.heading[:, LOST + 1 : LOST + 31]):.2f}", f"{rms(self.heading[:, late]):.2f}",
            f"{np.mean(self.sigma[:, late]):.2f}",
        ]  # fmt: skip


def rms(values: np.ndarray) -> float:
    """Root of the mean of squares."""
    return float(np.sqrt(np.mean(values**2)))


def run(out: Path) -> Section:
    """Fly and draw."""
    flights = {name: Flights.of(variant) for name, variant in VARIANTS.items()}
    write_file(out / "sensors" / "gps.png", picture(flights))
    return section(flights)


def claims(flights: dict[str, Flights]) -> list[Claim]:
    """Both levels do the same to the navigator, and three antennas what the thesis says."""
    positions, signals, antennas = flights.values()
    without = slice(LOST + 1, None)
    apart = 100.0 * abs(rms(signals.error[:, without]) / rms(positions.error[:, without]) - 1.0)
    made = [
        Claim("After GPS as signals the navigator errs as after GPS as positions, within", apart, 5.0, False, "%",
              "After GPS as signals the navigator errs otherwise than after GPS as positions"),
        Claim("With three antennas heading is better than they are themselves, rms",
              rms(antennas.heading[:, SETTLED:LOST]), 0.25, False, "deg",
              "With three antennas heading is no better than they are themselves"),
    ]  # fmt: skip
    for name, flown in flights.items():
        inside = 100.0 * float(np.mean(np.abs(flown.heading[:, SETTLED:]) < 3.0 * flown.sigma[:, SETTLED:]))
        squares = float(np.mean(flown.squares[:, without]))
        made += [
            Claim(f"GPS as {name}: heading is within its own 3 sigma", inside, 98.5, unit="%",
                  opposite=f"GPS as {name}: heading is outside of its own 3 sigma too often"),
            Claim(f"GPS as {name}: after it the navigator is not overconfident (NEES)", squares, 2.6, False, "",
                  f"GPS as {name}: after it the navigator is overconfident (NEES)"),
            Claim(f"GPS as {name}: after it the navigator is not overcautious (NEES)", squares, 1.4, True, "",
                  f"GPS as {name}: after it the navigator is overcautious (NEES)"),
        ]  # fmt: skip
    return made


def section(flights: dict[str, Flights]) -> Section:
    """What was found."""
    found = claims(flights)

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.text(
            f"{len(SEEDS)} flights of 35 minutes for each; GPS is lost at minute {LOST // 60} until the end. With GPS "
            f"is from second {SETTLED} on. NEES is 2 for an honest filter."
        )
        page.items(f"{claim.sentence}: {claim.finding}" for claim in found)
        page.table(SHOWN, [[name, *flown.row()] for name, flown in flights.items()])
        page.picture(picture(flights), "Horizontal error and heading, before and after GPS is lost")

    return Section(found, write)


def picture(flights: dict[str, Flights]) -> bytes:
    """Errors and sigmas against time."""
    found = claims(flights)
    with figure(1, 2, size=(13.0, 4.6)) as (drawing, (position, heading)):
        for (name, flown), colour in zip(flights.items(), COLOURS, strict=False):
            minutes = np.arange(flown.error.shape[1]) / 60.0
            error, wide = np.sqrt(np.mean(flown.error**2, axis=0)), 3.0 if name == "positions" else 1.0
            if name != "three antennas":  # whose positions are those of positions
                position.semilogy(minutes[5:], error[5:], color=colour, lw=wide, label=f"GPS as {name}, rms")
            if name == "signals":  # whose heading is that of positions
                continue
            label = "three antennas" if name == "three antennas" else "without antennas"
            turned = np.sqrt(np.mean(flown.heading**2, axis=0))
            heading.plot(minutes[SETTLED:], turned[SETTLED:], color=colour, lw=1, label=f"{label}, rms")
            sigma = np.sqrt(np.mean(flown.sigma**2, axis=0))
            heading.plot(minutes[SETTLED:], sigma[SETTLED:], color=colour, lw=1, ls="--", label="sigma")
        for axis in (position, heading):
            axis.axvline(LOST / 60.0, color=GREY, lw=1, ls=":")
            axis.set_xlabel("time, min; GPS is lost at the dotted line")
        position.axhline(926.0, color=GREY, lw=1)
        position.set_ylabel("horizontal error, m")
        heading.set_ylabel("error of heading, deg")
        heading.set_xlim(0.0, 15.0)
        heading.set_ylim(0.0, None)
        for axis in (position, heading):
            axis.legend(fontsize=8, loc="lower right")
        for axis, claim in zip((position, heading), found, strict=False):
            title(drawing, axis, claim.sentence.partition(", ")[0])
        return png(drawing)
