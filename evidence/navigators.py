"""Navigators in the place of each other: errors and what is claimed of them, in the same flights."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from evidence.section import Section
from navfmu import System
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from system_ssp.backup_navigator.system import NAVIGATORS

HEADING = "Navigators in the backup navigator"
AS_PRINTED = {"navigator.bias_sigma": 0.0, "navigator.innovation_gate": 0.0}
FLOWN: dict[str, tuple[str | None, dict[str, Any]]] = {
    "navigator": (None, {}),
    **{name: (name, {}) for name in NAVIGATORS},
    "navigator_reduced, R (6.40)": ("navigator_reduced", AS_PRINTED),
}
"""Variants of the backup navigator and parameters, by what is shown of them."""
HONEST = ("navigator_reckoning", "navigator_full")
"""The navigators of the thesis that model what the simulation does, where the mean of the wind is known."""
MEAN_SIGMA = 8.0
"""Of a mean wind that nobody told, m/s on each axis, as `navigator` supposes it."""
CASES: dict[str, tuple[int, float]] = {
    "one receiver": (1, 0.0),
    "two receivers": (2, 0.0),
    "scanning": (3, 0.0),
    "one receiver, a mean wind of 8 m/s that nobody told": (1, MEAN_SIGMA),
}
"""Mode of the receiver and sigma of the mean wind, by what they are."""
SEEDS = range(1, 21)
LOST, APART = 300, 180
"""Seconds: when GPS is lost, and how far apart errors are nearly independent of each other where there are ranges."""
PROBABILITY = 1.0e-3
WINDOW = 30
"""Of which a picture shows means, s: an error by ranges in turn is a saw."""
SIGNALS = (
    "evaluation.north_error",
    "evaluation.east_error",
    *(f"navigator.position_covariance[{i}]" for i in (1, 2, 3)),
)
TRACK = ("aircraft.latitude", "aircraft.longitude", "navigator.solution.latitude", "navigator.solution.longitude")
MILE = 1852.0


@dataclass(frozen=True)
class Flights:
    """Of one navigator: errors north and east, m, (seeds, seconds, 2), what it says of them, m2, (seeds, seconds, 2,
    2), and of the first flight TRACK, deg, (seconds, 4)."""

    errors: np.ndarray
    covariances: np.ndarray
    track: np.ndarray

    @classmethod
    def of(cls, variant: str | None, given: Mapping[str, Any], mode: int, mean_sigma: float) -> Flights:
        """Fly half an hour without GPS."""
        system = System.load("backup_navigator", variant)
        means = mean_sigma * np.random.default_rng(7).standard_normal((len(SEEDS), 2))

        def one(seed: int, mean: np.ndarray) -> np.ndarray:
            told = {"wind.mean_n": [*mean, 0.0], "dme.mode": mode, **given}
            run = system.run(
                seed=seed, faults="gps_lost", parameters=told, record=[*SIGNALS, *TRACK], record_period=1.0
            )
            return run[[*SIGNALS, *TRACK]].to_numpy(float)

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            runs = np.array(list(pool.map(one, SEEDS, means)))
        elements = runs[:, LOST + 1 :, 2:5]
        covariances = elements[..., [0, 1, 1, 2]].reshape(*elements.shape[:2], 2, 2)
        return cls(runs[:, LOST + 1 :, :2], covariances, np.degrees(runs[0, :, 5:]))

    @property
    def squares(self) -> np.ndarray:
        """Squares of errors over what is said of them (NEES), (seeds, moments); 2 if it is right."""
        errors, covariances = self.errors[:, APART - 1 :: APART], self.covariances[:, APART - 1 :: APART]
        return np.einsum("smi,smij,smj->sm", errors, np.linalg.inv(covariances), errors)

    @property
    def sizes(self) -> np.ndarray:
        """Horizontal errors, m, (seeds, seconds)."""
        return np.hypot(self.errors[..., 0], self.errors[..., 1])

    @property
    def said(self) -> np.ndarray:
        """What the navigator says that they are, rms, m, (seconds)."""
        return np.sqrt(np.mean(np.trace(self.covariances, axis1=2, axis2=3), axis=0))

    @property
    def inside(self) -> float:
        """Share of the time within 3 sigma on both axes."""
        sigma = np.sqrt(np.diagonal(self.covariances, axis1=2, axis2=3))
        return float(np.mean(np.all(np.abs(self.errors) <= 3.0 * sigma, axis=-1)))

    def row(self) -> list[str]:
        """What SHOWN names."""
        means = np.mean(self.squares, axis=0)
        return [
            f"{rms(self.sizes):.0f} ({np.sqrt(np.mean(self.said**2)):.0f})",
            f"{rms(self.sizes[:, -1]):.0f} ({self.said[-1]:.0f})",
            f"{100.0 * np.mean(np.max(self.sizes, axis=1) <= 0.5 * MILE):.0f}",
            f"{100.0 * self.inside:.1f}",
            f"{np.mean(self.squares):.2f}",
            f"{np.min(means):.2f} to {np.max(means):.2f}",
        ]


SHOWN = (
    "error, m rms (said)", "after 30 min (said)", "flights within 0.5 nmi, %", "inside 3 sigma, %", "NEES (2)",
    "at single moments",
)  # fmt: skip


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def run(out: Path) -> Section:
    """Fly and draw."""
    found = {case: {name: Flights.of(*of, *how) for name, of in FLOWN.items()} for case, how in CASES.items()}
    write_file(out / "navigators.png", picture(found))
    return section(found)


def make_claims(found: Mapping[str, Mapping[str, Flights]]) -> list[Claim]:
    """Of each that models what happens: NEES at its worst moment, within the interval of chi-square of as many
    flights, PROBABILITY divided among the moments."""
    claims = []
    for case in list(CASES)[:3]:
        for name in HONEST:
            if name == "navigator_reckoning" and case != "one receiver":
                continue  # it takes no ranges
            means = np.mean(found[case][name].squares, axis=0)
            alone = 0.5 * PROBABILITY / len(means)
            low, high = stats.chi2.ppf([alone, 1.0 - alone], 2 * len(SEEDS)) / len(SEEDS)
            away = np.max(np.where(means > 2.0, (means - 2.0) / (high - 2.0), (2.0 - means) / (2.0 - low)))
            claims.append(
                Claim(f"{name}, {case}: errors are what it says", float(away), 1.0, False,
                      "of the way from 2 to the bound of chi-square, at the worst moment",
                      f"{name}, {case}: errors are not what it says")
            )  # fmt: skip
    return claims


def section(found: Mapping[str, Mapping[str, Flights]]) -> Section:
    """Claims, tables and the picture."""
    claims = make_claims(found)

    def write(page: Page) -> None:
        page.heading(HEADING, 2)
        page.items(f"{claim.sentence}: {claim.finding} ({claim.limit})" for claim in claims)
        for case, flights in found.items():
            page.text(f"{case.capitalize()}, {len(SEEDS)} flights:")
            page.table(["navigator", *SHOWN], [[name, *flown.row()] for name, flown in flights.items()])
        page.picture(picture(found), "The same flight by each navigator, errors and what is said of them")

    return Section(claims, write)


def picture(found: Mapping[str, Mapping[str, Flights]]) -> bytes:
    """One flight by each, and errors and what is said of them against time."""
    usual, *_, windy = found
    colours = dict(zip(FLOWN, COLOURS, strict=False))
    with figure(2, 2, size=(13.0, 9.6)) as (drawing, axes):
        track, *others = axes.flat
        truth, _ = np.split(next(iter(found[usual].values())).track, 2, axis=1)
        end = truth[-1]
        track.plot(*_miles(truth, end), color=GREY, lw=4, alpha=0.6, label="flown")
        for name, flown in found[usual].items():
            track.plot(*_miles(flown.track[LOST:, 2:], end), color=colours[name], lw=1, label=name)
        track.set_aspect("equal", adjustable="datalim")
        track.set_xlabel(f"east of the end, nmi; seed {SEEDS[0]}, {usual}")
        track.set_ylabel("north of it, nmi")
        track.legend(fontsize=8, loc="upper left")
        title(drawing, track, "One flight from where GPS is lost")
        aided = [name for name in FLOWN if name != "navigator_reckoning"]
        for axis, case, names, most in (
            (others[0], usual, aided, 1000.0),
            (others[1], windy, list(FLOWN)[:-1], 3000.0),
            (others[2], "scanning", aided, 1000.0),
        ):
            for name in names:
                flown = found[case][name]
                for squares, style in ((np.mean(flown.sizes**2, axis=0), "-"), (flown.said**2, "--")):
                    smooth = np.convolve(squares, np.ones(WINDOW) / WINDOW, "valid") ** 0.5
                    minutes = (LOST + WINDOW + np.arange(len(smooth))) / 60.0
                    axis.plot(minutes, smooth, style, color=colours[name], lw=1)
            axis.axhline(0.5 * MILE, color=GREY, lw=1, ls=":")
            axis.set_ylim(0.0, most)
            axis.set_xlabel(f"time, min; {len(SEEDS)} flights, means of {WINDOW} s; dashed: what is said")
            axis.set_ylabel("horizontal error, m rms")
            title(drawing, axis, case.capitalize())
        return png(drawing)


def _miles(track: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """East and north of an end, nmi, of latitude and longitude, deg."""
    return 60.0 * (track[:, 1] - end[1]) * np.cos(np.radians(end[0])), 60.0 * (track[:, 0] - end[0])
