"""An inertial unit that is silent while the aircraft turns: nobody knows how, so the attitude is aligned anew."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmus.attitude.ahrs import Ahrs
from fmus.attitude.ahrs_euler import AhrsEuler
from fmus.attitude.ahrs_quaternion import AhrsQuaternion
from fmus.attitude.ahrs_velocity import AhrsVelocity
from tests.models.native import Native
from tests.models.test_ahrs_thesis import DECLINATION, FIELD_N, STEP, fly

ANGLES = [f"attitude.{name}" for name in ("roll", "pitch", "heading")]
FROM, TO, TURNED = 60.0, 90.0, 130.0
PLAIN = {"sample_period": STEP, "declination": DECLINATION}


@pytest.mark.parametrize(
    ("component", "parameters"),
    [(Ahrs, {}), (AhrsVelocity, {}), (AhrsEuler, {"compensated": True}), (AhrsQuaternion, {"compensated": True})],
)
def test_a_turn_without_inertial_samples_is_no_lasting_error(tmp_path, component, parameters):
    """130 degrees in 30 s. Carried over the gap, heading is wrong by 130 degrees with a sigma of 3, and stays so; what
    the field shows in the gap must not be learned as hard iron either."""
    time = np.arange(round(150.0 / STEP) + 2) * STEP
    heading = np.radians(30.0 + np.interp(time, [FROM + 5.0, TO - 5.0], [0.0, TURNED]))
    turns = Rotation.from_euler("ZYX", np.column_stack([heading, 0.02 + 0.0 * time, 0.0 * time]))
    silent = round(FROM / STEP)

    def lacking(k):
        return {"imu.sequence": silent, "imu.time_of_validity": FROM} if FROM < k * STEP < TO else {}

    native = Native(component, tmp_path)
    got, left = fly(
        native, turns, {**PLAIN, **parameters}, gps=-1.0, field=True, speed=60.0, bias=0.0, gyro=0.0, more=lacking,
        names=ANGLES,
    )  # fmt: skip
    assert np.abs(left[round(FROM / STEP) - 100 : round(FROM / STEP)]).max() < 1.0
    assert np.abs(left[got["time"] > TO + 1.0]).max() < 1.0
    assert native.fmu.getBoolean([native.fields["attitude.valid"].index])[0]


def test_a_short_gap_is_bridged(tmp_path):
    """2 s of a steady turn: the mean of the rates before and after, without an alignment."""
    time = np.arange(round(80.0 / STEP) + 2) * STEP
    rate = np.radians(3.0)
    roll = np.arctan(60.0 * rate / 9.80665)
    turns = Rotation.from_euler("ZYX", np.column_stack([rate * time, 0.0 * time, roll + 0.0 * time]))

    def lacking(k):
        return {"imu.sequence": 1200, "imu.time_of_validity": FROM} if FROM < k * STEP < FROM + 2.0 else {}

    got, left = fly(
        Native(AhrsVelocity, tmp_path), turns, PLAIN, gps=-1.0, field=True, speed=60.0, bias=0.0, gyro=0.0,
        more=lacking, names=[*ANGLES, "attitude.heading_sigma"],
    )  # fmt: skip
    after = got["time"] > FROM + 2.0
    assert np.abs(left[after]).max() < 1.0
    assert np.degrees(got["attitude.heading_sigma"][after]).max() < 4.0


@pytest.mark.parametrize("component", [Ahrs, AhrsVelocity, AhrsEuler, AhrsQuaternion])
def test_a_simulation_may_begin_before_0(component, tmp_path):
    """At -100 s: where no sample counted whose time was not above 0, gyros were left out until then."""
    native = Native(component, tmp_path)

    def flown(begin):
        fmu, count = native.fmu, 600
        fmu.reset()
        fmu.setupExperiment(startTime=begin)
        for name, value in PLAIN.items():
            native._set(fmu, name, value)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        turns = Rotation.from_rotvec(np.outer(0.1 * STEP * np.arange(count), [0.0, 0.0, 1.0]))
        fields = turns.inv().apply(FIELD_N)
        for k in range(1, count):
            native._set(fmu, "imu.rate", [0.0, 0.0, 0.1])
            native._set(fmu, "field.field_b", fields[k])
            for bundle in ("imu", "field"):
                native._set(fmu, f"{bundle}.valid", True)
                native._set(fmu, f"{bundle}.sequence", k)
                native._set(fmu, f"{bundle}.time_of_validity", begin + k * STEP)
            fmu.doStep(begin + (k - 1) * STEP, STEP)
        return fmu.getReal([native.fields["attitude.heading"].index])[0]

    assert flown(-100.0) == pytest.approx(flown(0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("component", "parameters"),
    [(Ahrs, {}), (AhrsVelocity, {}), (AhrsEuler, {"compensated": True}), (AhrsQuaternion, {"compensated": True})],
)
def test_a_field_from_before_the_gap_aligns_nothing(tmp_path, component, parameters):
    """Inertial unit and magnetometer are silent while the aircraft turns by 130 degrees, and the last field, from the
    begin of it, was not used yet when the first of them is back. Aligned by that, heading is off by 130 degrees with a
    sigma of 4, and fields that come later on are taken for hard iron."""
    time = np.arange(round(130.0 / STEP) + 2) * STEP
    heading = np.radians(30.0 + np.interp(time, [FROM + 5.0, TO - 5.0], [0.0, TURNED]))
    turns = Rotation.from_euler("ZYX", np.column_stack([heading, 0.02 + 0.0 * time, 0.0 * time]))
    silent, last, back = round(FROM / STEP), round(FROM / STEP) + 4, TO + 1.2

    def lacking(k):
        values = {}
        if FROM < k * STEP < TO:
            values |= {"imu.sequence": silent, "imu.time_of_validity": FROM}
        if last < k < back / STEP:
            values |= {"field.sequence": last, "field.time_of_validity": last * STEP}
            values |= {"field.field_b": turns[last].inv().apply(FIELD_N)}
        return values

    native = Native(component, tmp_path)
    got, left = fly(
        native, turns, {**PLAIN, **parameters}, gps=-1.0, field=True, speed=60.0, bias=0.0, gyro=0.0, more=lacking,
        names=ANGLES,
    )  # fmt: skip
    assert np.abs(left[silent - 100 : silent]).max() < 1.0
    assert np.abs(left[got["time"] > back + 1.0]).max() < 1.0
    assert native.fmu.getBoolean([native.fields["attitude.valid"].index])[0]


@pytest.mark.parametrize(
    ("component", "parameters"),
    [(Ahrs, {}), (AhrsVelocity, {}), (AhrsEuler, {"compensated": True}), (AhrsQuaternion, {"compensated": True})],
)
def test_gps_attitude_in_a_gap_that_is_bridged_turns_it_once(tmp_path, component, parameters):
    """4 s of a turn of 6 deg/s, with GPS attitude up to the last second of them. Taken in the gap it has the turn until
    then, and the rates over the whole gap are added to that: up to 23 degrees in ahrs, 8 in ahrs_velocity."""
    time = np.arange(round(70.0 / STEP) + 2) * STEP
    rate = np.radians(6.0)
    roll = np.arctan(60.0 * rate / 9.80665)
    turns = Rotation.from_euler("ZYX", np.column_stack([rate * time, 0.0 * time, roll + 0.0 * time]))

    def lacking(k):
        return {"imu.sequence": 1200, "imu.time_of_validity": FROM} if FROM < k * STEP < FROM + 4.0 else {}

    got, left = fly(
        Native(component, tmp_path), turns, {**PLAIN, **parameters}, gps=FROM + 3.9, field=True, speed=60.0, bias=0.0,
        gyro=0.0, more=lacking, names=ANGLES,
    )  # fmt: skip
    assert np.abs(left[got["time"] > FROM + 4.0]).max() < 1.0
