"""Vector matching of random attitudes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats
from scipy.spatial.transform import Rotation

from navfmu import System
from navfmu.constants import STANDARD_GRAVITY
from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import import_samples
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.ssp import SystemSource

RUNS = 10_000
SETS = 40
"""Of RUNS attitudes each; the thesis has one."""
RARE = 1e-3
"""Of a verdict that is wrong, of a count."""
GAINS = (0.01, 1.0, 2.0)
"""1 / N, 1 and 2: "robust within 1 / N to 2", p. 118."""
GAUSS = 1.0e-4
"""T."""
DIP, DECLINATION, STRENGTH = np.radians(61.2), np.radians(12.74), 0.475 * GAUSS
"""The field of the Earth at Livermore, WMM2025."""
NOISE = 1e-3
"""Of a field sample in gauss and of a specific force in g, each axis."""
LOST = 10.0
"""Error of yaw in degrees of an attitude that was not found."""
ANGLES = ("heading", "pitch", "roll")
PARAMETERS = {
    "sample_period": 1.0,
    "level_start": False,
    "airspeed": 0.0,
    "first_dip": DIP,
    "declination": DECLINATION,
    "field_sigma": NOISE * GAUSS / STRENGTH,
    "hard_iron_sigma": 0.0,
    "blind_tilt_sigma": NOISE,
    "level_sigma": 0.0,
    "mounting_sigma": 0.0,
    "declination_sigma": 0.0,
}
"""What begins at (1, 0, 0, 0) and knows of no error but noise: section 4.9."""


@dataclass(frozen=True)
class Drawn:
    """Attitudes (runs, 3), heading, pitch and roll in rad, and a system that is shown their field and gravity."""

    angles: np.ndarray
    system: Path

    def errors(self, **parameters: Any) -> np.ndarray:
        """Errors of the attitudes that are found, degrees, (runs, 3)."""
        run = System.load(self.system).run(
            stop=float(len(self.angles)),
            step=1.0,
            record_period=1.0,
            record=[f"matching.attitude.{name}" for name in ANGLES],
            parameters={f"matching.{name}": value for name, value in (PARAMETERS | parameters).items()},
        )
        off = run.to_numpy()[1:] - self.angles
        return np.degrees((off + np.pi) % (2.0 * np.pi) - np.pi)


def drawn(task: Task, number: int = 0) -> Drawn:
    """RUNS attitudes of normal flight, p. 117, one a second, as recordings of a unit and of a magnetometer."""
    rng = np.random.default_rng([task.seed, number])
    angles = np.radians(rng.uniform([-180.0, -20.0, -60.0], [180.0, 20.0, 60.0], (RUNS, 3)))
    matrices = Rotation.from_euler("ZYX", angles).as_matrix()
    level = np.array([np.cos(DECLINATION), np.sin(DECLINATION)]) * np.cos(DIP)
    field_n = STRENGTH / GAUSS * np.array([*level, np.sin(DIP)])
    noise = NOISE * rng.standard_normal((2, RUNS, 3))
    shown = {
        "imu": {"rate": np.zeros((RUNS, 3)), "specific_force": STANDARD_GRAVITY * (-matrices[:, 2] + noise[0])},
        "magnetometer": {"field": GAUSS * (field_n @ matrices + noise[1])},
    }
    folder = task.folder / str(number)
    folder.mkdir()
    system = SystemSource("attitudes", fmus=folder, stop_time=float(RUNS), step=1.0)
    for sensor, vectors in shown.items():
        columns = {f"{name}_{axis}": values[:, i] for name, values in vectors.items() for i, axis in enumerate("xyz")}
        pd.DataFrame({"time": np.arange(1.0, RUNS + 1.0), **columns}).to_parquet(folder / f"{sensor}.parquet")
        asked = Asked(start=0.0, unchecked=True)  # attitudes that follow no motion
        player = import_samples(read(folder / f"{sensor}.parquet"), task.fmu(f"{sensor}_replay"), asked)
        player.write(folder / f"{sensor}.fmu")
        system.component(sensor, f"{sensor}.fmu").parameters(sensor, {"tick_period": 1.0})
    (folder / "ahrs_vectors.fmu").write_bytes(task.fmu("ahrs_vectors").read_bytes())
    system.component("matching", "ahrs_vectors.fmu")
    system.connect("imu.reading", "matching.imu").connect("magnetometer.field", "matching.field")
    system.write(folder / "system")
    return Drawn(angles, folder / "system")


@row(
    "Of 10 000 attitudes vector matching finds all but a handful",
    "thesis section 4.9, (4.10)-(4.31), pp. 117-118, Fig 4.5",
    fmus=["ahrs_vectors", "imu_replay", "magnetometer_replay"],
)
def t13(task: Task) -> Found:
    """Many sets of attitudes, of which the thesis's is one; the first of them also with other gains."""
    sets = []
    for number in range(SETS):
        attitudes = drawn(task, number)
        sets.append(attitudes.errors())
        task.progress(number, SETS)
    errors = np.abs(np.array(sets))
    lost = {gain: int(np.sum(np.abs(attitudes.errors(gain=gain)[:, 0]) > LOST)) for gain in GAINS}
    words = "Errors of the first set, and the largest ones of each of the sets beside the printed ones"
    return Found([*not_found(errors), *largest(errors), *by_gain(lost)], picture(sets[0], errors), words, NOTES)


NOTES = (
    "(4.15) prints r3 s + s3 r in the product of quaternions; r0 s + s0 r is taken.",
    "(4.26), (4.28) and (4.31) leave out C_nb: with vectors in n the correction q_e is one in n, and step 6 must be "
    "q = q_e q^. As printed, four attitudes of ten are not found.",
    "Attitudes that are not found are starts close to half a turn; from level and needle all are found.",
)


def not_found(errors: np.ndarray) -> list[Comparison]:
    """The mean count of the sets, (sets, runs, 3), as an exact interval of Poisson's distribution around 3 has it."""
    low, high = 0.5 * stats.chi2.ppf(0.5 * RARE, 2 * 3), 0.5 * stats.chi2.isf(0.5 * RARE, 2 * 3 + 2)
    why = f"outside of this a count of 3 comes once in {1 / RARE:,.0f} times (Poisson)"
    mean = float(np.mean(np.sum(errors[:, :, 0] > LOST, axis=1)))
    return [Comparison(f"errors of yaw above {LOST:g} deg, of 10 000", "3", mean, low, high, why)]


def largest(errors: np.ndarray) -> list[Comparison]:
    """How many percent of the sets have a larger error than the printed one."""
    most = errors.max(axis=1)
    edge = 100.0 / SETS
    why = f"the thesis's set is one of many: its figure is among those of our {SETS} sets unless all lie on one side"
    return [
        Comparison(f"sets whose largest error of {angle} is above {printed:g} deg", f"{printed:g} deg",
                   100.0 * float(np.mean(most[:, ANGLES.index(angle)] > printed)), edge, 100.0 - edge, why, "%")
        for angle, printed in (("pitch", 1.8), ("roll", 2.3))
    ]  # fmt: skip


def by_gain(lost: dict[float, int]) -> list[Comparison]:
    """Attitudes that are not found by the gain alpha; none, if it is robust."""
    handful = float(np.ceil(0.5 * stats.chi2.isf(0.5 * RARE, 2 * 3 + 2)))
    alone = 1.0 - 2.0 / np.pi * np.arctan(np.e * np.tan(0.5 * np.radians(LOST)))
    known = Difference(
        RUNS * alone - 4.0 * np.sqrt(RUNS * alone * (1.0 - alone)),
        float(RUNS),
        f"after N steps of 1 / N the last correction is still 1 / e of the first, and a heading alone stays beyond "
        f"{LOST:g} deg in {100.0 * alone:.1f} % of all directions; tilt adds to them",
    )
    return [
        Comparison(f"errors of yaw above {LOST:g} deg with alpha {gain:g}, of 10 000", "converges", count, 0.0, handful,
                   "no more than may be with alpha 0.1", difference=known if gain == min(lost) else None)
        for gain, count in lost.items()
    ]  # fmt: skip


def picture(first: np.ndarray, errors: np.ndarray) -> bytes:
    """Histograms of the first set as Fig 4.5 has them, and the largest errors of all."""
    with figure(1, 3, size=(13.0, 4.2)) as (drawing, (histogram, pitch, roll)):
        bins = np.linspace(-10.0, 10.0, 161)
        for name, colour, values in zip(ANGLES, COLOURS, first.T, strict=False):
            histogram.hist(np.clip(values, -10.0, 10.0), bins, histtype="step", log=True, color=colour, label=name)
        histogram.set(xlabel="error, deg (beyond 10: at the edge)", ylabel=f"attitudes, of {RUNS}")
        histogram.legend()
        title(drawing, histogram, "One set of 10 000, as Fig 4.5")
        for axis, angle, printed in ((pitch, "pitch", 1.8), (roll, "roll", 2.3)):
            most = np.sort(errors.max(axis=1)[:, ANGLES.index(angle)])
            axis.plot(most, np.arange(1, len(most) + 1), "o", ms=4, color=COLOURS[0], label="ours")
            axis.axvline(printed, color=COLOURS[1], label="thesis")
            axis.set(xlabel=f"largest error of {angle} in 10 000, deg", ylabel="sets with less")
            axis.legend()
            title(drawing, axis, f"Largest errors of {angle}, {len(most)} sets")
        return png(drawing)
