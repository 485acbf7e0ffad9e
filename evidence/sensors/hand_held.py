"""``ahrs_velocity`` held by hand: the trials of BROAD, a public benchmark, beside filters of other people.

The environment variable NAVFMU_DATA names a folder with trials in ``sensors/broad/`` (Laidig, Caruso, Cereatti, Seel,
*BROAD, a benchmark for robust inertial orientation estimation*, Data 6(7), 2021, doi:10.3390/data6070072). They are not
part of the project. Their sensors are forward, left, up and their earth is east, north, up; error angles do not depend
on that. One parameter set, ``hand``, flies all trials.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from evidence.section import Section, left_out, recorded
from fmus.attitude.ahrs_velocity import HAND
from navfmu.files.writing import write_file
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import read
from navfmu.recorded.replay.importer import import_samples
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.page import Page
from navfmu.ssp import SystemSource
from navfmu.system import shipped
from navfmu.system.system import System

HEADING = "Held by hand"
PERIOD = 0.0035
"""Of the samples, s: 285.71 Hz."""
AXES = ("x", "-y", "-z")
"""Forward, right, down by the axes of the trials."""
NED_OF_ENU = Rotation.from_matrix([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
FRD_OF_FLU = Rotation.from_matrix(np.diag([1.0, -1.0, -1.0]))
TURN = [f"ahrs.attitude.{name}" for name in ("roll", "pitch", "heading")]
MOST = 3.0
"""Degrees, root mean square, mean of the trials. With their default parameters VQF (``vqf`` 2.1.2) has 2.51 of the six
trials at hand; Madgwick's filter has 5.86 and Mahony's 6.21 with parameters that were tuned on all trials."""
KINDS = ("total", "heading", "inclination")


def run(out: Path) -> Section:
    """Play all trials that there are."""
    folder, lacking = recorded("*.parquet", under="sensors/broad")
    if lacking:
        return left_out(HEADING, lacking)
    with tempfile.TemporaryDirectory(prefix="navfmu-") as made:
        errors = {trial.stem: errors_of(trial, Path(made) / trial.stem) for trial in sorted(folder.glob("*.parquet"))}
    found = section(errors)
    write_file(out / "sensors" / "hand_held.png", picture(errors, found.claims[0]))
    return found


def errors_of(trial: Path, folder: Path) -> np.ndarray:
    """Total, heading and inclination error of one trial, degrees, root mean square where the sensor moves."""
    folder.mkdir(parents=True)
    asked = Asked(axes={"": AXES}, start=-PERIOD)  # the first sample comes at the first tick
    for sensor in ("imu", "magnetometer"):
        import_samples(read(trial), shipped.path(f"{sensor}_replay.fmu"), asked).write(folder / f"{sensor}.fmu")
    (folder / "ahrs_velocity.fmu").write_bytes(Path(shipped.path("ahrs_velocity.fmu")).read_bytes())
    truth = pd.read_parquet(trial)
    system = SystemSource("hand", fmus=folder, stop_time=float(truth["time"].iloc[-1]), step=PERIOD)
    system.component("imu", "imu.fmu").component("magnetometer", "magnetometer.fmu")
    system.component("ahrs", "ahrs_velocity.fmu")
    system.connect("imu.reading", "ahrs.imu").connect("magnetometer.field", "ahrs.field")
    for sensor in ("imu", "magnetometer"):
        system.parameters(sensor, {"tick_period": PERIOD})
    system.parameters("ahrs", {**HAND.values, "sample_period": PERIOD, "declination": 0.0})
    system.write(folder / "system")
    time = truth["time"].to_numpy() + PERIOD
    stop = PERIOD * np.ceil(time[-1] / PERIOD)
    run = System.load(folder / "system").run(stop=stop, step=PERIOD, record=TURN, record_period=PERIOD)
    at = np.clip(np.searchsorted(run.index, time - 0.5 * PERIOD), 0, len(run) - 1)
    ours = Rotation.from_euler("ZYX", run[TURN[::-1]].to_numpy()[at])
    quaternion = truth[["truth_qx", "truth_qy", "truth_qz", "truth_qw"]].to_numpy(float)
    counted = truth["movement"].to_numpy(bool) & np.isfinite(quaternion).all(axis=1)
    return rms(NED_OF_ENU.inv() * ours[counted] * FRD_OF_FLU, Rotation.from_quat(quaternion[counted]))


def rms(estimated: Rotation, true: Rotation) -> np.ndarray:
    """Total, heading and inclination error, degrees, root mean square: the metric of BROAD.

    The heading error is the turn about the vertical that is in the whole one, the inclination what is left of it.
    """
    x, y, z, w = np.abs((estimated * true.inv()).as_quat()).T
    angles = 2.0 * np.arctan2([np.sqrt(x * x + y * y + z * z), z, np.hypot(x, y)], [w, w, np.hypot(w, z)])
    return np.degrees(np.sqrt(np.mean(angles**2, axis=1)))


def section(errors: Mapping[str, np.ndarray]) -> Section:
    """The claim, and a row for each trial."""
    mean = np.mean(list(errors.values()), axis=0)
    claims = [
        Claim(
            f"Held by hand, ahrs_velocity keeps the attitude in {len(errors)} trials of BROAD by one set",
            float(mean[0]), MOST, False, "degrees rms, mean of the trials",
            opposite="Held by hand, ahrs_velocity loses more attitude in the trials of BROAD than it may",
        )
    ]  # fmt: skip

    def write(page: Page) -> None:
        page.heading(HEADING, 3)
        page.picture(picture(errors, claims[0]), "Errors of attitude of each trial")
        rows = [[name, *(f"{x:.2f}" for x in row)] for name, row in [*errors.items(), ("mean", mean)]]
        page.table(["trial", *(f"{kind}, deg" for kind in KINDS)], rows)

    return Section(claims, write)


def picture(errors: Mapping[str, np.ndarray], claim: Claim) -> bytes:
    """Errors of each trial as bars."""
    with figure(1, 1, size=(11.0, 4.4), left=3.2) as (drawing, bars):
        place = np.arange(len(errors))
        for i, (kind, colour) in enumerate(zip(KINDS, COLOURS, strict=False)):
            bars.barh(place + 0.27 * (i - 1), [row[i] for row in errors.values()], 0.25, color=colour, label=kind)
        bars.set_yticks(place, [name.replace("_", " ") for name in errors])
        bars.invert_yaxis()
        bars.set_xlabel("error, degrees rms")
        bars.legend()
        title(drawing, bars, claim.sentence)
        return png(drawing)
