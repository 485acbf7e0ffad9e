"""Where a unit stands or turns steadily, and what is there: against the FMU of the unit on a table."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.sensors.turntable import ALTITUDE, LATITUDE, eight_by_three, shown, truth, turns
from navfmu.calibration.imu.determination import determine
from navfmu.calibration.imu.stands import stands
from navfmu.calibration.imu.terms import TERMS, readings, split
from navfmu.errors import NavfmuError
from tests import built

PERIOD = 0.05
SENSORS = ("gyro", "accelerometer")
QUIET = {
    "misalignment_sigma": 0.0,
    **{f"{s}_{e}_sigma": 0.0 for s in SENSORS for e in ("null_shift", "scale_factor", "drift", "noise")},
}
TRUE = [f"{name}_{axis}" for name in ("true_rate", "true_force") for axis in "xyz"]
FORCE = [f"specific_force_{axis}" for axis in "xyz"]
RATE = [f"rate_{axis}" for axis in "xyz"]
TABLE = ["roll", "pitch", "heading", "table_rate"]


def unit(rng, share):
    """Errors of all terms that the FMU has, in the order of the terms, and as its parameters."""
    values = {t: share * t.size * rng.standard_normal(len(t.elements)) * t.modelled for t in TERMS}
    shaped = {t.name: v if len(v) == 3 else v.reshape(3, 3) for t, v in values.items() if t.modelled}
    return np.concatenate(list(values.values())), {name: value.tolist() for name, value in shaped.items()}


def motion():
    still = eight_by_three()[::3]
    return truth(np.vstack([np.column_stack([still, np.zeros(len(still))]), turns([10.0])]), 14.0, 3.0, PERIOD)


def test_the_model_of_the_errors_is_that_of_the_fmu(tmp_path_factory):
    """A unit without noise, with all errors at once, sample for sample on a table that stands and turns: 1e-12.

    Wrong: N and C_m in the other order, scale factors before misalignments, sensitivity along the axes of the case, an
    asymmetry of the true rate for that of what the gyro feels, elements of G by columns.
    """
    moved = motion()
    errors, parameters = unit(np.random.default_rng(1), 0.3)
    seen = shown(built.fmu("imu", tmp_path_factory), moved, {**QUIET, **parameters}, seed=1)
    rate, force = readings(split(errors, TERMS), *np.split(moved[TRUE].to_numpy(), 2, axis=1))
    found = seen[[f"{name}_{axis}" for name in ("rate", "specific_force") for axis in "xyz"]].to_numpy()
    assert found == pytest.approx(np.hstack([rate, force]), rel=1e-12, abs=1e-12)


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """A noisy unit on the table, and its errors."""
    errors, parameters = unit(np.random.default_rng(2), 0.3)
    noisy = {"gyro_noise_sigma": 1e-3, "accelerometer_noise_sigma": 0.02}
    return shown(built.fmu("imu", tmp_path_factory), motion(), {**QUIET, **parameters, **noisy}, seed=3), errors


def taken(tmp_path, frame, **options):
    file = tmp_path / "table.parquet"
    frame.to_parquet(file)
    return stands(file, LATITUDE, ALTITUDE, **options)


def test_what_is_there_is_that_of_the_table(tmp_path, seen):
    """Eight stands and six turns, each with the means of the true rate and specific force over the same samples; where
    nobody told attitudes the turns are left out, and that is said.

    Wrong: a heading that stays while the table turns (the Earth's rate is 7e-5), attitude of the first sample, a stand
    with a second of the way there.
    """
    frame, _ = seen
    found = taken(tmp_path, frame)
    assert len(found.rate) == 14
    moved, time = motion(), frame["time"].to_numpy()
    for k, (begin, seconds) in enumerate(zip(found.begin, found.seconds, strict=True)):
        rows = (time >= begin - 1e-9) & (time < begin + seconds - 1e-9)
        true = moved.loc[rows, TRUE].mean().to_numpy()
        assert np.concatenate([found.true_rate[k], found.true_force[k]]) == pytest.approx(true, rel=1e-9, abs=1e-10)
    alone = taken(tmp_path, frame.drop(columns=TABLE))
    assert alone.true_rate is None and len(alone.rate) == 8
    assert any(sentence.startswith("6 steady turns are left out") for sentence in alone.sentences)


def test_samples_that_are_no_readings_are_left_out(tmp_path, seen):
    """Ten spikes: the errors that are found differ by less than a tenth of a sigma from those without.

    Wrong: spikes in the means (each is 500 sigma of a mean), a stand that a spike cuts in two.
    """
    frame, _ = seen
    spoilt = frame.copy()
    rows = np.random.default_rng(5).choice(260, 10, replace=False) + 10
    spoilt.loc[rows, ["rate_x", "specific_force_z"]] += [1.0, 100.0]
    clean, dirty = (determine(taken(tmp_path, one)) for one in (frame, spoilt))
    assert len(dirty.stands.rate) == 14
    assert any("samples are left out" in sentence for sentence in dirty.stands.sentences)
    sigma = np.sqrt(np.diag(clean.fit.covariance))
    assert np.max(np.abs(dirty.fit.values - clean.fit.values) / sigma) < 0.3


def test_axes_of_the_file_are_turned(tmp_path, seen):
    """Forward, left, up in the file: the same means. Wrong: the inverse of a turn, one sensor alone."""
    frame, _ = seen
    up = frame.copy()
    for name in ("rate_y", "rate_z", "specific_force_y", "specific_force_z"):
        up[name] *= -1.0
    assert taken(tmp_path, up, axes=("x", "-y", "-z")).rate == pytest.approx(taken(tmp_path, frame).rate, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda f: f.head(20), "has 20 rows only"),
        (lambda f: f.assign(time=0.0), "time does not increase"),
        (lambda f: f.assign(rate_x=np.where(f.index == 7, np.nan, f.rate_x)), "'rate_x' has no number"),
        (lambda f: f.drop(columns=["rate_y"]), "has no column 'rate_y' for rate"),
        (lambda f: f.drop(columns=["pitch"]), "has no column 'pitch' for pitch"),
        (lambda f: f.assign(**{a: f[a] / 9.8 for a in FORCE}), "name the unit"),
        (lambda f: f.assign(specific_force_z=f.specific_force_z.clip(-9.0, 9.0)), "specific_force z does not ch"),
        (lambda f: f.assign(rate_y=np.round(f.rate_y, 1)), "rate y does not change in"),
        (lambda f: f.assign(time=1e3 * f.time), "--unit time=ms"),
        (lambda f: f.assign(**{a: 57.3 * f[a] for a in RATE}), "--unit rate=deg/s"),
        (lambda f: f.assign(roll=np.degrees(f.roll)), "--unit roll=deg"),
        (lambda f: f.assign(**{a: -f[a] for a in FORCE}), "forward, right, down"),
        (lambda f: f.assign(roll=f.roll + 1e-3 * f.time), "nothing is at rest for 10 s"),
    ],
    ids=["short", "time", "nan", "column", "angle", "g", "range", "resolution", "ms", "degrees a second", "degrees",
         "up", "never still"],
)  # fmt: skip
def test_what_is_no_recording_of_stands_is_refused(tmp_path, seen, change, sentence):
    """Each in a sentence that names what is wrong. Wrong: errors of 90 % in a table, a traceback."""
    frame, _ = seen
    with pytest.raises(NavfmuError, match=sentence):
        taken(tmp_path, change(frame))
