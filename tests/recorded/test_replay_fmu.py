"""The players of recorded sensors: sample by sample what the file says, when it says, with the face of the sensor."""

from __future__ import annotations

import shutil
from pathlib import Path

import ambiance
import fmpy
import numpy as np
import pandas as pd
import pytest
from fmpy.validation import validate_fmu
from scipy.optimize import brentq

from navfmu import Fault, System
from navfmu.recorded.replay.account import lost
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.file import of
from navfmu.recorded.replay.importer import import_samples
from tests import built
from tests.conformance import hosts
from tests.recorded import samples

SENSORS = {  # made recording, bundle, and the columns of its numbers
    "imu": (
        samples.imu,
        "reading",
        {f"{n}[{i + 1}]": f"{n}_{a}" for n in ("rate", "specific_force") for i, a in enumerate("xyz")},
    ),
    "magnetometer": (samples.field, "field", {f"field_b[{i + 1}]": f"field_{a}" for i, a in enumerate("xyz")}),
    "gps": (
        samples.fixes,
        "fix",
        {n: n for n in ("latitude", "longitude", "altitude")}
        | {f"velocity_n[{i + 1}]": f"velocity_{a}" for i, a in enumerate(("north", "east", "down"))},
    ),
    "air_data": (samples.air, "air", {n: n for n in ("calibrated_airspeed", "pressure_altitude")}),
}


@pytest.fixture(scope="module")
def player(tmp_path_factory):
    return lambda sensor: built.fmu(f"{sensor}_replay", tmp_path_factory)


@pytest.fixture
def made(player, tmp_path):
    """Write an FMU of a frame."""

    def make(sensor, frame, name="made", **asked):
        return import_samples(of("made.csv", frame), player(sensor), Asked(**asked)).write(tmp_path / f"{name}.fmu")

    return make


def play(fmu, stop, step=0.001, **values):
    return fmpy.simulate_fmu(str(fmu), stop_time=stop, output_interval=step, start_values=values)


def fly(fmu, stop, step, fault=None):
    """The same in the compiled engine, with a fault; columns without the component's name."""
    flight = System.load(fmu).run(stop=stop, step=step, faults=fault or [], record_period=step)
    frame = flight.rename(columns=lambda name: name.partition(".")[2]).reset_index()
    return {name: frame[name].to_numpy() for name in frame.columns}


def published(result, bundle):
    """Rows of a result at which something new was published."""
    return np.flatnonzero(np.diff(result[f"{bundle}.sequence"], prepend=0) != 0)


@pytest.mark.parametrize("sensor", SENSORS)
def test_publishes_each_sample_at_the_first_tick_not_before_its_time_with_its_bits(sensor, made):
    """Fails for a player that publishes at the nearest tick, interpolates, or tells a sample twice or not at all."""
    recorded, bundle, columns = SENSORS[sensor]
    time = samples.stamps(300, 0.0055, 0.020)
    frame = recorded(time)
    fmu = made(sensor, frame)
    assert validate_fmu(str(fmu)) == []
    result = play(fmu, time[-1] + 0.1, tick_period=0.001)
    rows = published(result, bundle)
    np.testing.assert_array_equal(result[f"{bundle}.sequence"][rows], np.arange(1, 301))
    ticks = np.ceil(time * 1000.0 - 1e-6)
    np.testing.assert_allclose(result["time"][rows], 0.001 * ticks, rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(result[f"{bundle}.time_of_validity"][rows], time)
    assert result[f"{bundle}.valid"][rows].all() and not result[f"{bundle}.valid"][: rows[0]].any()
    for name, column in columns.items():
        np.testing.assert_array_equal(result[f"{bundle}.{name}"][rows], frame[column])
        np.testing.assert_array_equal(result[f"{bundle}.{name}"][rows[-1] :], frame[column].iloc[-1])  # held


def test_a_sample_with_the_time_of_a_tick_comes_at_that_tick(made):
    """Hundredths of a second less another begin, and multiples of 0.01, differ in the last bits: some would be late."""
    time = np.array([float(f"{100 + k / 100:.2f}") for k in range(1, 3001)])
    assert np.any(time - 100.0 > np.arange(1, 3001) * 0.01)
    result = play(made("imu", samples.imu(time), start=100.0), 30.0, step=0.01)
    np.testing.assert_array_equal(result["reading.sequence"], np.arange(3001))


def test_of_two_samples_in_one_tick_the_later_is_published_and_the_number_tells_the_loss(made, player):
    """Fails for a player that publishes the first of them, queues them, or numbers what it publishes from 1 on."""
    time = samples.stamps(2000, 0.0055, 0.020)
    frame = samples.imu(time)
    imported = import_samples(of("made.csv", frame), player("imu"))
    result = play(made("imu", frame), time[-1] + 0.1, step=0.01)
    rows = published(result, "reading")
    ticks = np.ceil(time / 0.01 - 1e-6).astype(int)
    last = np.flatnonzero(np.append(np.diff(ticks) > 0, True))
    assert 100 < len(time) - len(last) < 1000
    np.testing.assert_array_equal(result["reading.sequence"][rows], last + 1)
    np.testing.assert_array_equal(result["reading.rate[2]"][rows], frame["rate_y"].iloc[last])
    told = next(sentence for sentence in imported.sentences() if "are lost" in sentence)
    assert told.startswith(f"with ticks of 0.01 s {len(time) - len(last)} of 2000 samples")


def test_ticks_begin_behind_the_one_before_and_end_with_their_time(made, player):
    """By hand: 0, 4 and 10 ms come at the tick of 10 ms; 10.1 and 20 ms at the next one; 30 ms at the one after."""
    time = np.array([0.0, 0.004, 0.01, 0.0101, 0.02, 0.03])
    frame = samples.imu(time)

    def count(part):
        (imported,) = import_samples(of("made.csv", part), player("imu")).streams
        return lost(imported, 0.01)

    assert count(frame) == 3
    assert count(frame[3:5]) == 1 and count(frame[4:6]) == 0
    result = play(made("imu", frame), 0.04, step=0.01)
    np.testing.assert_array_equal(result["reading.sequence"], [0, 3, 5, 6, 6])


def test_a_sample_that_is_not_valid_says_so_and_the_next_one_is(made):
    time = np.arange(1.0, 11.0)
    frame = samples.fixes(time).assign(valid=[1, 1, 1, 0, 0, 1, 1, 1, 1, 1])
    result = play(made("gps", frame), 10.5, 0.1)
    at = published(result, "fix")
    np.testing.assert_array_equal(result["fix.valid"][at], frame["valid"] == 1)
    np.testing.assert_array_equal(result["fix.altitude"][at][2:6], frame["altitude"].to_numpy()[[2, 2, 2, 5]])


def test_the_same_at_every_communication_step(made):
    fmu = made("imu", samples.imu(samples.stamps(500, 0.0055, 0.020)))
    fine, coarse = play(fmu, 4.0, 0.01), play(fmu, 4.0, 0.05)
    for name in coarse.dtype.names[1:]:
        np.testing.assert_array_equal(fine[name][::5], coarse[name])


def test_delay_makes_samples_late_and_age_makes_them_old(made):
    """Fails for a delay that moves the time of validity along, or an age that makes samples late."""
    time = samples.stamps(200, 0.1, 0.3)
    frame = samples.fixes(time)
    plain = play(made("gps", frame), 40.0)
    late = play(made("gps", frame, "old", age=0.36), 40.0, delay=0.25)
    at, then = published(plain, "fix"), published(late, "fix")
    np.testing.assert_allclose(late["time"][then][:100] - plain["time"][at][:100], 0.25, atol=0.0101)
    np.testing.assert_allclose(late["fix.time_of_validity"][then], time[: len(then)] - 0.36, atol=1e-12)
    np.testing.assert_array_equal(late["fix.longitude"][then], frame["longitude"].iloc[: len(then)])


@pytest.mark.parametrize("sensor", SENSORS)
def test_has_what_a_system_connects_of_the_sensor_that_it_replaces(sensor, player, tmp_path_factory):
    """Inputs of the truth and outputs of the bundles have the same names, types and units."""

    def face(path):
        variables = fmpy.read_model_description(str(path)).modelVariables
        return {v.name: (v.causality, v.type, v.unit) for v in variables if v.causality in ("input", "output")}

    own, other = face(player(sensor)), face(built.fmu(sensor, tmp_path_factory))
    bundles = {name.partition(".")[0] for name in own if name.endswith(".sequence")}
    faults = built.components()[sensor].layout.fields
    needed = {n for n, v in other.items() if v[0] == "input" and not faults[n.partition("[")[0]].fault}
    needed |= {n for n in other if n.partition(".")[0] in bundles}
    assert {name: own[name] for name in needed} == {name: other[name] for name in needed}
    assert set(own) <= set(other)  # a fault that cannot act on a recording is not there


@pytest.mark.filterwarnings("ignore:has no effect")
def test_recordings_of_all_modelled_sensors_navigate_as_these_did_bit_for_bit(player, tmp_path_factory, tmp_path):
    """The files of four sensors in a shipped system are replaced by replays of what they gave: nothing changes."""
    from system_ssp.backup_navigator.system import FMUS, source

    folder = tmp_path / "modelled"
    for component in FMUS:
        built.fmu(component, tmp_path_factory)
    source(built.folder(tmp_path_factory)).write(folder)
    bundles = {"imu": "reading", "magnetometer": "field", "air_data": "air", "gps": "fix"}
    watched = ["navigator.solution", "ahrs.attitude", "navigator.mode"]
    record = [*(f"{sensor}.{bundle}" for sensor, bundle in bundles.items()), "gps.attitude", *watched]
    faults = Fault("bias", "imu.reading.rate", "bias", start=60.0, value=[0.0, 0.0, 0.002])
    run = {"stop": 120.0, "record": record, "record_period": 0.01}
    flown = System.load(folder).run(**run)
    disturbed = System.load(folder).run(**run, faults=faults)
    for sensor, bundle in bundles.items():
        frame = _recorded(flown, f"{sensor}.{bundle}")
        imported = import_samples(of(f"{sensor}.parquet", frame), player(sensor))
        (folder / "resources" / f"{sensor}.fmu").unlink()
        imported.write(folder / "resources" / f"{sensor}.fmu")
    replayed = System.load(folder)
    again = replayed.run(**run | {"record": watched})
    unused = [note for note in again.attrs["notes"] if "imu_automotive.ssv" in note]
    assert any("'imu' has no variable 'gyro_drift_time'" in note for note in unused)
    assert len(unused) == 11 and sum("'gyro_drift_sigma' of 3 elements" in note for note in unused) == 1  # not 29
    for name in again.columns:
        np.testing.assert_array_equal(again[name], flown[name], err_msg=name)
    failed = replayed.run(**run | {"record": watched}, faults=faults)
    for name in failed.columns:
        np.testing.assert_array_equal(failed[name], disturbed[name], err_msg=name)
    assert not np.array_equal(failed["ahrs.attitude.heading"], again["ahrs.attitude.heading"])


def test_masters_of_others_take_the_file_in_the_place_of_the_sensors_too(player, tmp_path_factory, tmp_path):
    """libcosim and Ecos refuse a system whose FMU lacks what the document connects or lists."""
    from system_ssp.backup_navigator.system import COMPONENTS, FMUS, source

    step, steps = 1.0 / 64.0, 640
    files = {name: built.fmu(name, tmp_path_factory) for name in FMUS}  # also those of variants
    fmus = {name: files[name] for name in COMPONENTS}
    folder = tmp_path / "recorded"
    source(built.folder(tmp_path_factory)).write(folder)
    frame = samples.imu(samples.stamps(600, 0.017, 0.02))
    (folder / "resources" / "imu.fmu").unlink()
    fmus["imu"] = import_samples(of("made.csv", frame), player("imu")).write(folder / "resources" / "imu.fmu")
    package = Path(shutil.make_archive(str(tmp_path / "recorded"), "zip", folder)).rename(tmp_path / "recorded.ssp")
    last = frame[frame["time"] <= step * steps].iloc[-1]
    for values in (
        hosts.libcosim_ssp(folder, fmus, step, steps),
        hosts.ecos_library_ssp(package, fmus, step, steps),
    ):
        assert values["imu"]["reading.sequence"] == last.name + 1
        assert values["imu"]["reading.specific_force[2]"] == last["specific_force_y"]
        assert values["ahrs"]["attitude.sequence"] > 100


def _recorded(frame, bundle):
    """New samples of a bundle in a recording, as a file of them would be."""
    new = np.diff(frame[f"{bundle}.sequence"], prepend=0) > 0
    columns = {name: frame[name][new] for name in frame.columns if name.startswith(f"{bundle}.") and "@" not in name}
    table = pd.DataFrame({name.removeprefix(f"{bundle}."): column for name, column in columns.items()})
    return table.rename(columns={"time_of_validity": "time"}).reset_index(drop=True)


def test_jammed_the_recorded_receiver_says_so_and_recovers_at_once(made):
    """F34: at the next fix `valid` is false, values are held, `sequence` counts on; afterwards it is as recorded."""
    time = np.arange(1.0, 31.0)
    fmu = made("gps", samples.fixes(time))
    plain = fly(fmu, 30.0, 0.1)
    jammed = fly(fmu, 30.0, 0.1, Fault("jam", "gps_replay.jammed", "input", value=True, start=10.0, duration=9.0))
    during = (jammed["time"] > 11.0 - 0.01) & (jammed["time"] < 19.99)
    assert not jammed["fix.valid"][during].any()
    held = plain["fix.latitude"][np.isclose(plain["time"], 10.0)][0]
    np.testing.assert_array_equal(jammed["fix.latitude"][during], held)
    np.testing.assert_array_equal(jammed["fix.sequence"], plain["fix.sequence"])
    other = during | (jammed["time"] > 19.0) & (jammed["time"] < 19.99)
    for name in plain:
        np.testing.assert_array_equal(jammed[name][~other], plain[name][~other], err_msg=name)


def test_hard_iron_is_added_to_the_recorded_field(made):
    """F17 of a recording: from the next sample on, exactly; gone with the next sample after it ends."""
    time = np.arange(0.1, 10.0, 0.1)
    frame = samples.field(time)
    change = [0.0, 5e-6, -2e-6]
    iron = Fault("iron", "magnetometer_replay.hard_iron_change", "input", value=change, start=3.0, duration=3.0)
    result = fly(made("magnetometer", frame), 9.0, 0.1, iron)
    at = published(result, "field")
    acts = (result["time"][at] > 3.05) & (result["time"][at] < 6.05)
    for i, axis in enumerate("xyz"):
        expected = frame[f"field_{axis}"].to_numpy()[: len(at)] + np.where(acts, change[i], 0.0)
        np.testing.assert_array_equal(result[f"field.field_b[{i + 1}]"][at], expected)


def test_air_data_that_was_not_recorded_follows_from_what_was(made):
    """Against ambiance and the isentropic equation solved by a root finder: pressures of a climb from 500 to 8000 m."""
    time = np.arange(1.0, 16.0)
    height = np.linspace(500.0, 8000.0, len(time))
    standard = ambiance.Atmosphere(height)
    impact = np.linspace(1300.0, 9000.0, len(time))
    frame = pd.DataFrame({"time": time, "static_pressure": standard.pressure, "impact_pressure": impact})
    result = play(made("air_data", frame), 15.5, 0.1)
    at = published(result, "air")
    np.testing.assert_allclose(result["air.pressure_altitude"][at], standard.H, atol=0.5)
    np.testing.assert_allclose(result["air.temperature"][at], standard.temperature, atol=0.01)

    def speed(pressure, sound, ratio):
        return brentq(lambda v: pressure * ((1.0 + 0.2 * (v / sound) ** 2) ** 3.5 - 1.0) - ratio, 0.0, sound)

    calibrated = [speed(101325.0, 340.294, q) for q in impact]
    true = [speed(p, a, q) for p, a, q in zip(standard.pressure, standard.speed_of_sound, impact, strict=True)]
    np.testing.assert_allclose(result["air.calibrated_airspeed"][at], calibrated, rtol=1e-5)
    np.testing.assert_allclose(result["air.true_airspeed"][at], true, rtol=1e-4)
    np.testing.assert_allclose(result["air.mach"][at], true / standard.speed_of_sound, rtol=1e-4)
    assert np.all(result["air.true_airspeed_sigma"][at] > 2.5)


def test_recorded_air_data_is_not_worked_out_again(made):
    """Fails for a player that makes true airspeed, temperature or vertical speed of what else was recorded."""
    time = np.arange(0.1, 5.0, 0.1)
    frame = samples.air(time).assign(true_airspeed=51.0 + time, temperature=290.0 - time, vertical_speed=time)
    result = play(made("air_data", frame), 5.0, 0.1)
    at = published(result, "air")
    for name in ("true_airspeed", "temperature", "vertical_speed", "calibrated_airspeed", "pressure_altitude"):
        np.testing.assert_array_equal(result[f"air.{name}"][at], frame[name].iloc[: len(at)])


def test_the_vertical_speed_is_behind_its_lag_by_the_intervals_of_the_samples(made):
    """Closed form for a climb that begins with the first sample: c (1 - exp(-t / tau)), samples two a second."""
    time = np.arange(0.5, 20.0, 0.5)
    frame = samples.air(time).assign(pressure_altitude=1500.0 + 3.0 * time)
    result = play(made("air_data", frame), 20.0, 0.01, vertical_speed_time=2.0)
    at = published(result, "air")
    expected = 3.0 * (1.0 - np.exp(-(time - time[0]) / 2.0))
    np.testing.assert_allclose(result["air.vertical_speed"][at], expected, atol=1e-9)
    held = np.repeat(result["air.vertical_speed"][at], np.diff(np.append(at, len(result))))
    np.testing.assert_array_equal(result["air.vertical_speed"][at[0] :], held)


def test_a_port_that_is_blocked_from_the_beginning_keeps_the_pressure_of_the_first_sample(made):
    time = np.arange(0.1, 10.0, 0.1)
    frame = samples.air(time).assign(pressure_altitude=3000.0 + 5.0 * time)
    result = fly(
        made("air_data", frame), 9.0, 0.1, Fault("port", "air_data_replay.static_blocked", "input", value=True)
    )
    np.testing.assert_allclose(result["air.pressure_altitude"][1:], 3000.5, atol=1e-6)


@pytest.mark.parametrize(("port", "rises"), [("pitot_blocked", True), ("static_blocked", False)])
def test_blocked_ports_show_the_textbook_on_recorded_air_data(port, rises, made):
    """F21, F22: in a climb the airspeed rises with a blocked pitot tube; altitude is frozen and airspeed falls with a
    blocked static port. Afterwards it is as recorded, bit for bit; what does not hang on the port is so all the time,
    also where the recorded static pressure says another altitude than the recorded one."""
    time = np.arange(0.1, 60.0, 0.1)
    frame = samples.air(time).assign(calibrated_airspeed=46.3, pressure_altitude=1500.0 + 5.0 * time)
    standard = 101325.0 * (1.0 - 0.0065 * frame["pressure_altitude"] / 288.15) ** 5.25588
    frame = frame.assign(static_pressure=standard * 0.999)
    fmu = made("air_data", frame)
    plain = fly(fmu, 59.0, 0.1)
    failed = fly(
        fmu, 59.0, 0.1, Fault("port", f"air_data_replay.{port}", "input", value=True, start=20.0, duration=20.0)
    )
    during = (failed["time"] > 20.05) & (failed["time"] < 40.05)
    speed = failed["air.calibrated_airspeed"][during]
    assert np.all(np.diff(speed) > 0.0 if rises else np.diff(speed) < 1e-12)
    standard = 101325.0 * (1.0 - 0.0065 * plain["air.pressure_altitude"] / 288.15) ** 5.25588
    kept = standard[np.isclose(failed["time"], 20.0)][0]
    impact = 101325.0 * ((1.0 + 0.2 * (46.3 / 340.294) ** 2) ** 3.5 - 1.0)
    left = np.maximum(impact + (kept - standard if rises else standard - kept)[during], 0.0)
    expected = 340.294 * np.sqrt(5.0 * ((1.0 + left / 101325.0) ** (2.0 / 7.0) - 1.0))
    seen = expected > 5.0
    np.testing.assert_allclose(speed[seen], expected[seen], rtol=0.01)
    altitude = plain["air.pressure_altitude"]
    expected = altitude[during] if rises else altitude[np.isclose(plain["time"], 20.0)][0]
    np.testing.assert_array_equal(failed["air.pressure_altitude"][during], expected)
    if not rises:
        assert np.all(np.abs(failed["air.vertical_speed"][during][-20:]) < 1e-3)
    after = failed["time"] > 40.05
    for name in (
        "calibrated_airspeed",
        "true_airspeed",
        "pressure_altitude",
        "temperature",
        "mach",
        "sequence",
        "valid",
    ):
        np.testing.assert_array_equal(failed[f"air.{name}"][after], plain[f"air.{name}"][after])
