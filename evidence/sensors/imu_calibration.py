"""``navfmu calibrate imu`` on units that ``imu`` makes on a table, on printed covariances, and on recorded rests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy import stats

from evidence.section import Section, illustrated, recorded
from evidence.sensors.turntable import ALTITUDE, LATITUDE, eight_by_three, faces, shown, truth, turns
from fmus.inertial.grades import INERTIAL
from navfmu.calibration.imu.determination import Determination, determine, lacking
from navfmu.calibration.imu.stands import stands
from navfmu.calibration.imu.terms import TERMS, Term
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png
from navfmu.system import shipped

UNITS = 30
"""Simulated units, each with errors of its own."""
ALLOWED = 4.9
"""Standard deviations: probability 1e-6 on both sides."""
SHARE = 0.3
"""Of what an error is in a unit that nobody has calibrated, one sigma of those that are simulated."""
HOLD, MOVE, PERIOD = 14.0, 3.0, 0.05
NOISE = {"gyro_noise_sigma": 1e-3, "accelerometer_noise_sigma": 0.02}
SENSORS = ("gyro", "accelerometer")
QUIET = {
    "misalignment_sigma": 0.0,
    **{f"{s}_{e}_sigma": 0.0 for s in SENSORS for e in ("null_shift", "scale_factor", "drift", "noise")},
}
GRADE = {k: v for k, v in INERTIAL["automotive"].values.items() if "drift" in k or "noise" in k}
Unit = tuple[np.ndarray, Determination]
"""True errors in the order of the covariance, and what was found."""
RECORDED = ("flights/thor75/imu.parquet", "broad/*.parquet")
TABLE = ["roll", "pitch", "heading", "table_rate"]


def run(out: Path) -> Section:
    """Simulate, calibrate, compare and draw."""
    table = Table()
    claims = [table.consistent, table.scattered, table.drifted]
    words = "What each set of stands tells, and errors of 30 units by their sigma"
    head = ["recording at rest", "told", "not told"]
    write_file(out / "sensors" / "imu_calibration.png", picture(table))
    return illustrated("Calibration of inertial units", claims, lambda: picture(table), words, head, rests())


def programme() -> np.ndarray:
    """Roll, pitch, heading and rate of the 24 positions and the 18 turns."""
    still = eight_by_three()
    return np.vstack([np.column_stack([still, np.zeros(len(still))]), turns()])


def calibrated(attitudes: np.ndarray, parameters: dict[str, Any], seed: int, told: bool = True) -> Determination:
    """What the readings of an ``imu`` tell on a table that takes these attitudes."""
    frame = shown(shipped.path("imu.fmu"), truth(attitudes, HOLD, MOVE, PERIOD), parameters, seed)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "stands.parquet"
        (frame if told else frame.drop(columns=TABLE)).to_parquet(file)
        return determine(stands(file, LATITUDE, ALTITUDE))


def errors(seed: int) -> dict[Term, np.ndarray]:
    """Errors of a unit, drawn."""
    rng = np.random.default_rng(seed)
    return {t: SHARE * t.size * rng.standard_normal(len(t.elements)) * t.modelled for t in TERMS}


def parameters(drawn: dict[Term, np.ndarray]) -> dict[str, Any]:
    """The same as parameters of ``imu``."""
    return {t.name: (v if len(v) == 3 else v.reshape(3, 3)).tolist() for t, v in drawn.items() if t.modelled}


@dataclass(frozen=True)
class Table:
    """What is measured, each part when it is first asked for."""

    @cached_property
    def units(self) -> list[Unit]:
        """With white noise."""
        return [unit(programme(), NOISE, seed) for seed in range(1, UNITS + 1)]

    @cached_property
    def drifting(self) -> list[Unit]:
        """With the drift and the noise of the automotive grade, which lasts 100 and 300 s."""
        return [unit(programme(), GRADE, seed) for seed in range(1, UNITS // 3 + 1)]

    @cached_property
    def shuffled(self) -> list[Unit]:
        """The same, with the stands in an order at random."""
        stands_ = programme()
        orders = (np.random.default_rng(seed).permutation(len(stands_)) for seed in range(1, UNITS // 3 + 1))
        return [unit(stands_[order], GRADE, seed) for seed, order in enumerate(orders, 1)]

    @property
    def consistent(self) -> Claim:
        """Squares over the covariance: with an estimated sigma each is F, its mean over p is taken as such."""
        scores = []
        for true, one in self.units:
            off = one.fit.values - true
            square = float(off @ np.linalg.solve(one.fit.covariance, off)) / len(off)
            scores.append(stats.norm.ppf(stats.f.cdf(square, len(off), float(np.min(one.fit.left)))))
        return Claim(
            f"Errors of {UNITS} units are found within their covariance (those of a unit at once, F): score, in sigma",
            float(abs(np.sum(scores)) / np.sqrt(UNITS)), ALLOWED, False,
            opposite="Errors of simulated units are not within the covariance that is said",
        )  # fmt: skip

    @property
    def scattered(self) -> Claim:
        worst = 0.0
        for kind in (0, 1):
            left = sum(one.fit.left[kind] for _, one in self.units)
            expected = [NOISE["gyro_noise_sigma"], NOISE["accelerometer_noise_sigma"]][kind] ** 2
            square = sum(
                one.fit.left[kind] * one.fit.sigma[kind] ** 2 * np.mean(one.stands.seconds) / PERIOD / expected
                for _, one in self.units
            )
            worst = max(worst, abs(float(stats.norm.ppf(stats.chi2.cdf(square, left)))))
        return Claim(
            "The scatter of a stand is that of its samples over the root of their number (chi-square): score, in sigma",
            worst, ALLOWED, False,
            opposite="The scatter that is estimated is not that of the samples",
        )  # fmt: skip

    @property
    def drifted(self) -> Claim:
        off = normalised(self.shuffled)
        return Claim(
            "Errors of units that drift are as large as is said where the order of the stands is at random: rms, sigma",
            float(np.sqrt(np.mean(off**2))), 1.0 + ALLOWED / float(np.sqrt(2.0 * len(off))), False,
            opposite="Errors of units that drift are larger than is said",
        )  # fmt: skip

    @cached_property
    def programmes(self) -> dict[str, Determination]:
        """One unit on different sets of stands."""
        values = {**QUIET, **NOISE, **parameters(errors(1))}
        twice = np.vstack([faces(), faces()])
        return {
            "6 faces, twice": calibrated(twice, values, 1),
            "24 positions": calibrated(eight_by_three(), values, 1),
            "24, attitudes not told": calibrated(eight_by_three(), values, 1, told=False),
            "24 positions and 18 turns": calibrated(programme(), values, 1),
        }


def unit(attitudes: np.ndarray, noise: dict[str, Any], seed: int) -> Unit:
    """A unit whose errors are drawn, and what was found of them."""
    drawn = errors(seed)
    found = calibrated(attitudes, {**QUIET, **noise, **parameters(drawn)}, seed)
    return np.concatenate([drawn[term] for term in found.terms]), found


def normalised(units: Sequence[Unit]) -> np.ndarray:
    """Errors of what was found, by their sigma, but those of null shifts: what has drifted on the way is in them."""
    found = []
    for true, one in units:
        rest = ["null_shift" not in element.term.name for element in one.elements]
        found.append(((one.fit.values - true) / np.sqrt(np.diag(one.fit.covariance)))[rest])
    return np.concatenate(found)


def rests() -> list[list[str]]:
    """A row for each recorded unit at rest: how many stands, what is told, what is not."""
    folder, lack = recorded(*RECORDED, under="sensors")
    if lack:
        return []
    rows = []
    for file in [path for pattern in RECORDED for path in sorted(folder.glob(pattern))]:
        axes = ("x", "-y", "-z") if "broad" in str(file) else ("x", "y", "z")
        name = "thor75" if "thor75" in str(file) else file.stem
        try:
            found = determine(stands(file, np.radians(48.0), axes=axes))
        except NavfmuError as refused:
            rows.append([name, "refused", str(refused).partition(": ")[2]])
            continue
        told = sorted({element.term.name for element in found.elements if element.told})
        rows.append([name, ", ".join(told), ", ".join(line.partition(":")[0] for line in lacking(found))])
    return rows


def picture(table: Table) -> bytes:
    """Two panels: sigma of each error by the stands that told it, and errors by their sigma."""
    with figure(1, 2, size=(13.4, 5.0), left=3.0) as (drawing, (told, spread)):
        drawing.subplots_adjust(wspace=0.2)
        for place, (name, found) in enumerate(table.programmes.items()):
            share, height = [], []
            for row, term in enumerate(TERMS):
                sigmas = [element.sigma / term.size for element in found.elements if element.term is term]
                if sigmas:
                    share.append(float(np.sqrt(np.mean(np.square(sigmas)))))
                    height.append(row + 0.15 * (place - 1.5))
            told.semilogx(share, height, "o", ms=5, color=COLOURS[place], label=name)
        told.axvline(1.0 / 3.0, color="k", lw=0.8, ls="--", label="told: left of this")
        told.set_yticks(range(len(TERMS)), [term.name for term in TERMS])
        told.invert_yaxis()
        told.set_xlabel("sigma that is left, as a share of that of a unit that nobody has calibrated")
        told.set_title("Turns tell scales of gyros, slants tell squares")
        told.set_xlim(1e-5, 2.0)
        told.legend(fontsize=7.5, loc="upper left")
        edges = np.linspace(-5.0, 5.0, 51)
        for units, name, colour in (
            (table.units, f"{UNITS} units with white noise", COLOURS[0]),
            (table.drifting, f"{UNITS // 3} that drift as automotive ones, 45 degrees at a time", COLOURS[1]),
            (table.shuffled, f"{UNITS // 3} that drift, stands in an order at random", COLOURS[2]),
        ):
            off = normalised(units)
            label = f"{name}: rms {np.sqrt(np.mean(off**2)):.2f}"
            spread.hist(off, edges, density=True, histtype="step", color=colour, label=label)
        spread.plot(edges, stats.norm.pdf(edges), "k--", lw=0.8, label="normal")
        spread.set(xlabel="error of what was found, but null shifts, by its sigma", ylabel="density")
        spread.set_title("Errors are as large as is said")
        spread.set_ylim(0.0, 0.8)
        spread.legend(fontsize=8, loc="upper left")
        return png(drawing)
