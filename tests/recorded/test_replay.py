"""What is said of a file of samples: each mistake is a sentence that names it, and what is taken is told."""

from __future__ import annotations

import re
import zipfile

import fmpy
import matplotlib.image
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from navfmu.cli.info import show
from navfmu.cli.main import main
from navfmu.errors import NavfmuError
from navfmu.recorded.replay.asked import Asked
from navfmu.recorded.replay.doubts import turn_error
from navfmu.recorded.replay.file import of, read
from navfmu.recorded.replay.importer import import_samples
from navfmu.recorded.replay.picture import draw
from tests import built
from tests.recorded import samples

TIME = samples.stamps(3000, 0.015, 0.025)
SLOW = samples.stamps(200, 0.9, 1.1)


@pytest.fixture(scope="module")
def player(tmp_path_factory):
    return lambda sensor: built.fmu(f"{sensor}_replay", tmp_path_factory)


@pytest.fixture
def take(player):
    def take(sensor, frame, **asked):
        return import_samples(of("made.csv", frame, 2), player(sensor), Asked(**asked))

    return take


def renamed(frame, **columns):
    return frame.rename(columns=columns)


def scaled(frame, factor, *columns):
    return frame.assign(**{c: frame[c] * factor for c in columns})


RATE, FORCE = [[f"{n}_{a}" for a in "xyz"] for n in ("rate", "specific_force")]
FIELD = [f"field_{a}" for a in "xyz"]
VELOCITY = [f"velocity_{a}" for a in ("north", "east", "down")]
IMU, MAG, GPS, AIR = samples.imu(TIME), samples.field(TIME), samples.fixes(SLOW), samples.air(TIME)
BACK = IMU.copy()
BACK.loc[100, "time"] = BACK.loc[98, "time"] - 0.001
HOLE = IMU.copy()
HOLE.loc[41, "rate_y"] = np.nan
LEAP = IMU.assign(time=np.where(TIME > 30.0, TIME + 1e6, TIME))


def one(frame, column, number):
    """A frame with this number in its eighth row."""
    return frame.assign(**{column: np.where(np.arange(len(frame)) == 7, number, frame[column])})


FAR = IMU.assign(time=IMU["time"] + 1e6)
PRESSURE = 101325.0 * (1.0 - 2.25577e-5 * AIR["pressure_altitude"]) ** 5.25588
STATIC = AIR.drop(columns="pressure_altitude").assign(static_pressure=PRESSURE)


@pytest.mark.parametrize(
    ("sensor", "frame", "asked", "sentence"),
    [
        # units
        (
            "imu",
            scaled(IMU, 1 / 9.80665, *FORCE),
            {},
            r"specific_force is (1\.0|0\.99)\d* m/s2 .*in g\? --unit specific_force='g'",
        ),
        ("imu", scaled(IMU, 1e3 / 9.80665, *FORCE), {}, r"specific_force is (1\d|9)\d\d.* .*in mg\?"),
        ("imu", scaled(IMU, 180 / np.pi, *RATE), {}, r"rate turns the specific force .*in deg/s\?"),
        ("imu", IMU, {"units": {"rate": "deg/s"}}, r"rate turns the specific force .*in rad/s\?"),
        ("imu", scaled(IMU, 1e4, *RATE), {}, r"rate is above \d+ rad/s in one sample of a hundred"),
        ("imu", IMU, {"units": {"rate": "degs/s"}}, r"unit 'degs/s' is not known here; .*did you mean 'deg/s'\?"),
        ("imu", IMU, {"units": {"rate": "m/s2"}}, r"rate: 'm/s2' cannot be converted to 'rad/s'"),
        ("imu", IMU, {"units": {"rate": "0 deg/s"}}, r"the unit '0 deg/s' has the factor 0"),
        ("magnetometer", scaled(MAG, 1e6, *FIELD), {}, r"field_b is 48\.?\d* T .*in uT\? --unit field_b='uT'"),
        ("magnetometer", scaled(MAG, 1e7, *FIELD), {}, r"field_b is 48\d T .*in mG\?"),
        (
            "magnetometer",
            scaled(MAG, 1e7, *FIELD),
            {"units": {"field_b": "uT"}},
            r"field_b is 0\.00048 T .*in mG\?|to 0",
        ),
        (
            "gps",
            scaled(GPS, 180 / np.pi, "latitude", "longitude"),
            {},
            r"latitude is as large as 37\.\d* rad.*in deg\?",
        ),
        ("gps", scaled(GPS, 3600 / 1852, *VELOCITY), {}, r"velocity_n carries .*--unit velocity_n=kn they would agree"),
        (
            "air_data",
            scaled(AIR, 0.01, "pressure_altitude").assign(static_pressure=PRESSURE / 100),
            {},
            r"static_pressure is 8\d\d\.?\d* Pa .*in hPa\?",
        ),
        ("air_data", AIR.assign(temperature=5.0), {}, r"temperature is 5 K .*in degC\?"),
        (
            "air_data",
            scaled(AIR, 1 / 0.3048, "pressure_altitude").assign(static_pressure=PRESSURE),
            {},
            r"pressure_altitude is \d+ m above .*in ft\?",
        ),
        (
            "air_data",
            scaled(AIR, 3600 / 1852, "calibrated_airspeed").assign(impact_pressure=0.6125 * 46.3**2),
            {},
            r"calibrated_airspeed is 1\.9\d times .*in kn\?",
        ),
        # axes
        ("imu", IMU, {"axes": {"": ("x", "-y", "-z")}}, r"specific_force points along \+z .*--axes x,-y,-z turns them"),
        ("imu", IMU, {"axes": {"": ("z", "x", "y")}}, r"specific_force points along -x .*the third of --axes is x"),
        ("imu", IMU, {"axes": {"": ("y", "x", "z")}}, r"y,x,z is a mirror image, no turn"),
        ("imu", IMU, {"axes": {"": ("x", "y", "y")}}, r"x,y,y are no three axes"),
        ("imu", IMU, {"axes": {"": ("x", "y")}}, r"x,y are no three axes"),
        (
            "imu",
            IMU,
            {"axes": {"rat": ("x", "y", "z")}},
            r"--axes rat: there is no such quantity; .*did you mean 'rate'\?",
        ),
        ("imu", IMU, {"axes": {"": ("x", "up", "z")}}, r"'up' is no axis; expected x, y or z"),
        ("gps", GPS, {"axes": {"velocity_n": ("y", "x", "z")}}, r"velocity_n carries .*with --axes velocity_n=y,x,z"),
        ("gps", GPS, {"axes": {"velocity_n": ("x", "y", "-z")}}, r"velocity_n points up where the altitude rises"),
        ("gps", GPS, {"axes": {"": ("y", "x", "-z")}}, r"--axes y,x,-z: there is no vector in body axes"),
        (
            "air_data",
            AIR,
            {"units": {"temperature": "degC"}},
            r"--unit temperature: made.csv has no temperature; what is",
        ),
        ("air_data", AIR, {"add": {"impact_pressure": ("20",)}}, r"--add impact_pressure: made.csv has no impact_pr"),
        (
            "imu",
            IMU,
            {"units": {"time_of_validity": "ms"}},
            r"--unit time_of_validity: made.csv has no time_of_validity",
        ),
        # numbers
        ("imu", HOLE, {}, r"made.csv, line 43: rate is empty or no number \(in 1 row"),
        ("imu", IMU.assign(rate_x=["0.1"] * 7 + ["n/a"] + ["0.1"] * 2992), {}, r"made.csv, line 9: 'rate_x' is 'n/a'"),
        ("imu", IMU.assign(rate_x=np.where(TIME > 1.0, np.inf, 0.0)), {}, r"rate is empty or no number"),
        ("imu", IMU.assign(rate_x=np.nan), {"incomplete": "invalid"}, r"no row is complete and valid"),
        # time
        ("imu", BACK, {}, r"made.csv, line 102: the time goes back, from \d+\.\d+ s to"),
        ("imu", IMU.assign(time=np.where(TIME > 1.0, np.nan, TIME)), {}, r"line \d+: 'time' is nan; expected a time"),
        ("imu", FAR, {}, r"the first time is 1000000\.0123 s, .*pass --start 1000000\.012 "),
        ("imu", IMU.assign(time=TIME * 1e3), {}, r"time between samples is \d\d\.?\d* s; .*in ms\? --unit time=ms"),
        ("imu", IMU.assign(time=TIME * 1e6), {}, r"time between samples is \d\S* s; .*in us\? --unit time=us"),
        ("imu", IMU, {"units": {"time": "us"}}, r"time between samples is \d\.?\d*e-08 s; expected 1e-05 to 1 s"),
        ("gps", GPS.assign(time=SLOW * 1e3), {}, r"time between samples is \d+\.?\d* s; .*in ms\?"),
        ("imu", IMU.assign(time=np.floor(TIME)), {}, r"time of 2\d\d\d of 3000 samples is that of the next one"),
        ("imu", IMU.assign(time=1.0), {}, r"time of 2999 of 3000 samples is that of the next one"),
        ("imu", IMU.assign(time=(TIME * 1e9).round()), {}, r"time between samples is \d\S*e\+07 s; .*--unit time=ns"),
        ("imu", IMU.assign(time=(TIME + 1.3e9) * 1e9), {}, r"time between samples is \d\S*e\+07 s; .*--unit time=ns"),
        ("imu", IMU.assign(time=TIME + 1349888224.7), {}, r"the first time is 1349888224\.71.* --start 1349888224\.71"),
        (
            "imu",
            IMU.assign(time=np.append(TIME[:-1], 1e300)),
            {},
            r"time leaps by 1e\+300 s after t = .* a clock was set",
        ),
        ("imu", LEAP, {}, r"time leaps by 1000000\.0\d+ s after t = .* a clock was set"),
        ("imu", BACK.assign(time=BACK["time"] + 1349888220.0), {"start": 1349888220.0}, r"from (\d+\.\d+) s to (?!\1)"),
        (
            "imu",
            IMU.assign(time_of_validity=TIME - 1 + TIME % 1),
            {},
            r"time_of_validity goes back \d\d times, first after",
        ),
        ("imu", IMU, {"start": 1e3}, r"no sample is left; see --start"),
        ("imu", IMU, {"age": -1.0}, r"--age is -1 s: a sample cannot hold for a time to come"),
        ("imu", IMU.assign(made=TIME + 1.0), {"columns": {"time_of_validity": ("made",)}}, r"after the time at which"),
        # columns
        (
            "imu",
            IMU.drop(columns="rate_y"),
            {},
            r"no column for rate: rate_y\. Its columns are time, rate_x",
        ),
        ("imu", renamed(IMU, time="t_s"), {}, r"there is no column 'time'.*name it with --column time="),
        ("imu", IMU, {"columns": {"rate": ("gyro_x", "rate_y", "rate_z")}}, r"has no column 'gyro_x'"),
        (
            "imu",
            IMU,
            {"columns": {"rate": ("rate_x", "rat_y", "rate_z")}},
            r"no column 'rat_y' .*did you mean 'rate_y'\?",
        ),
        ("imu", IMU, {"columns": {"rate": ("rate_x", "rate_x", "rate_z")}}, r"a column is named twice"),
        ("imu", IMU, {"columns": {"rate": ("rate_x",)}}, r"1 column\(s\) are named, rate_x; expected 3"),
        ("imu", IMU, {"columns": {"rates": ("rate_x",)}}, r"there is no such quantity; .*did you mean 'rate'\?"),
        ("imu", renamed(IMU, rate_y="rate_x"), {}, r"has two columns 'rate_x'"),
        ("imu", IMU[:0], {}, r"made.csv: has no rows"),
        ("imu", MAG, {}, r"has no column for any of angle, velocity, interval; rate, specific_force"),
        (
            "air_data",
            AIR.drop(columns="calibrated_airspeed"),
            {},
            r"no column for impact_pressure or calibrated_airspeed or true",
        ),
        (
            "air_data",
            renamed(AIR, calibrated_airspeed="indicated_airspeed"),
            {},
            r"did you mean 'indicated_airspeed'\?",
        ),
        ("imu", IMU, {"values": {"rate": ("1", "2")}}, r"--value rate: 2 numbers are given; expected 3"),
        ("imu", IMU, {"add": {"rate": ("fast",)}}, r"--add rate: 'fast' is no number"),
        ("gps", GPS.assign(latitude=0.0, longitude=0.0), {}, r"latitude and longitude are 0 in all rows"),
        (
            "gps",
            one(one(GPS, "latitude", 0.0), "longitude", 0.0),
            {},
            r"are 0 in 1 of 200 rows: the receiver had no fix",
        ),
        ("gps", scaled(GPS, 1 / 0.3048, "altitude"), {}, r"altitude changes by 3\.\d+ times .*in ft\?"),
        ("gps", scaled(GPS, 180e7 / np.pi, "latitude", "longitude"), {}, r"in 1e-7 deg\? --unit latitude='1e-7 deg'"),
        (
            "gps",
            GPS.drop(columns="velocity_down"),
            {},
            r"--column velocity_n=velocity_north,velocity_east,0 \(a number",
        ),
        # single numbers
        ("magnetometer", one(MAG, "field_y", 999.0), {}, r"field_b is .*999, .* T at t = 0\.\d+ s, and in 1 sample"),
        ("imu", one(IMU, "rate_x", -9999.0), {}, r"rate is -9999, .* rad/s at t = .*does it stand for nothing\?"),
        ("air_data", one(AIR.assign(mach=0.14), "mach", -99.0), {}, r"mach is -99 at t = .* below -0\.5 or above 5;"),
        (
            "air_data",
            one(STATIC, "static_pressure", -5.0),
            {},
            r"line 9: static_pressure or pressure_altitude is empty",
        ),
        ("air_data", AIR.assign(temperature=-5.0), {}, r"temperature is -5 K .*in degC\?"),
        ("air_data", AIR.assign(temperature=328.5), {}, r"temperature is 328\.5 K .*that of the sensor itself\?"),
        ("air_data", AIR.assign(mach=45.0), {}, r"mach is 45 in the middle"),
        (
            "air_data",
            AIR.assign(impact_pressure=-1300.0 + 50.0 * AIR["time"] % 9),
            {},
            r"impact_pressure is -1\d\d\d Pa",
        ),
        (
            "air_data",
            AIR.assign(impact_pressure=-200.0 + AIR["time"] % 9),
            {},
            r"as if total and static were exchanged",
        ),
        ("imu", IMU, {"columns": {"rate": tuple(FORCE)}}, r"'specific_force_x' is taken for rate, too"),
        (
            "air_data",
            renamed(AIR, calibrated_airspeed="dynamic_pressure"),
            {},
            r"did you mean 'dynamic_pressure'\?.*--column impact_pressure=\.\.\.",
        ),
    ],
)
def test_a_mistake_is_a_sentence(sensor, frame, asked, sentence, take):
    """Each would otherwise be an FMU that plays plausible nonsense, or a traceback."""
    with pytest.raises(NavfmuError) as told:
        take(sensor, frame, **asked)
    assert re.search(sentence, str(told.value)), str(told.value)
    assert "\n" not in str(told.value)


def columns(imported, table=None):
    found = (imported.samples[table] if table else imported.streams[0]).table()
    return {name.partition(" ")[0]: column for name, column in found.items()}


def test_units_axes_and_names_lead_to_the_same_samples(take):
    """A log in g, deg/s and ms with axes forward, left, up and names of its own is the same recording."""
    plain = columns(take("imu", IMU))
    other = pd.DataFrame({"stamp (ms)": IMU["time"] * 1e3})
    for name, unit, columns_ in (("gyr", np.pi / 180, RATE), ("acc", 9.80665, FORCE)):
        for axis, column, sign in zip("abc", columns_, (1, -1, -1), strict=True):
            other[f"{name}_{axis}"] = sign * IMU[column] / unit
    asked = {
        "columns": {
            "time": ("stamp",),
            "rate": ("gyr_a", "gyr_b", "gyr_c"),
            "specific_force": ("acc_a", "acc_b", "acc_c"),
        },
        "units": {"rate": "deg/s", "specific_force": "g"},
        "axes": {"": ("x", "-y", "-z")},
    }
    told = columns(take("imu", other, **asked))
    assert set(told) == set(plain)
    for name, column in plain.items():
        np.testing.assert_allclose(told[name], column, rtol=1e-12, atol=1e-15, err_msg=name)


def test_a_unit_may_have_a_factor_and_an_offset(take):
    mavlink = GPS.assign(latitude=np.degrees(GPS["latitude"]) * 1e7, altitude=GPS["altitude"] * 1e3)
    told = columns(take("gps", mavlink, units={"latitude": "1e-7 deg", "altitude": "mm"}), "fixes")
    np.testing.assert_allclose(told["latitude"], GPS["latitude"], rtol=1e-12)
    np.testing.assert_allclose(told["altitude"], GPS["altitude"], rtol=1e-12)
    warm = columns(take("air_data", AIR.assign(temperature=15.0), units={"temperature": "degC"}))
    np.testing.assert_allclose(warm["temperature"], 288.15, rtol=1e-12)


def test_what_is_added_and_what_is_given(take):
    told = columns(take("gps", GPS.drop(columns="altitude"), values={"altitude": ("1000 ft",)}), "fixes")
    np.testing.assert_allclose(told["altitude"], 304.8, rtol=1e-12)
    told = columns(take("gps", GPS, add={"altitude": ("-32.2",)}), "fixes")
    np.testing.assert_allclose(told["altitude"], GPS["altitude"] - 32.2, rtol=1e-12)
    level = take("gps", GPS, columns={"velocity_n": ("velocity_north", "velocity_east", "0")})
    assert not columns(level, "fixes")["velocity_n[3]"].any()


def test_incomplete_rows_are_samples_that_are_not_valid(take):
    told = columns(take("imu", HOLE, incomplete="invalid"))
    assert len(told["time"]) == len(HOLE) and told["valid"].sum() == len(HOLE) - 1 and told["valid"][41] == 0.0
    assert told["rate[2]"][41] == HOLE["rate_y"][40] and told["rate[1]"][41] == HOLE["rate_x"][40]
    assert told["rate[2]"][42] == HOLE["rate_y"][42]


def test_begins_where_it_is_told_and_says_what_is_left_out(take):
    imported = take("imu", IMU, start=10.0)
    told = columns(imported)
    np.testing.assert_allclose(told["time"], TIME[TIME >= 10.0] - 10.0, rtol=0.0, atol=1e-12)
    assert told["sequence"][0] == 1.0 and told["rate[1]"][0] == IMU["rate_x"][TIME >= 10.0].iloc[0]
    assert f"{np.sum(TIME < 10.0)} sample(s) before t = 0 are left out" in imported.sentences()


def test_a_late_receiver_is_told_as_late_or_put_right(take):
    """Stamps 0.36 s late: --age tells it, --start takes it out; both would tell the same thing twice."""
    for asked, late in (({"age": 0.36}, 0.0), ({"start": 0.36}, 0.36)):
        told = columns(take("gps", GPS, **asked), "fixes")
        np.testing.assert_allclose(told["time"], SLOW[-len(told["time"]) :] - late, rtol=0.0, atol=1e-9)
        valid = SLOW[-len(told["time"]) :] - 0.36  # as it was, on the clock of the other sensors
        np.testing.assert_allclose(told["time_of_validity"], valid, rtol=0.0, atol=1e-9)


def test_a_file_may_hold_the_samples_of_two_bundles(take):
    """Angles and velocities of the last interval, beside rates: both are played, with numbers of their own."""
    both = IMU.assign(interval=0.02)
    both = both.assign(**{f"angle_{a}": 0.02 * IMU[f"rate_{a}"] for a in "xyz"})
    both = both.assign(**{f"velocity_{a}": 0.02 * IMU[f"specific_force_{a}"] for a in "xyz"})
    imported = take("imu", both)
    np.testing.assert_array_equal(columns(imported, "increments")["angle[2]"], both["angle_y"])
    np.testing.assert_array_equal(columns(imported, "readings")["rate[2]"], both["rate_y"])
    assert any(s.startswith("increments: 3000 samples") for s in imported.sentences())
    assert "increments: not in the file, so the FMU is silent there" in take("imu", IMU).sentences()
    with pytest.raises(NavfmuError, match=r"velocity by interval is 0\.19\d+ m/s2 where it is quiet; at rest"):
        take("imu", both.assign(interval=1.0))


def test_gaps_repeats_and_equal_times_are_told(take):
    """Counts against what was put in by hand."""
    frame = IMU.drop(index=range(1000, 1030)).reset_index(drop=True)
    frame.loc[501:504, RATE + FORCE] = frame.loc[500, RATE + FORCE].to_numpy()
    frame.loc[700, RATE + FORCE] = frame.loc[699, RATE + FORCE]
    time = frame["time"].to_numpy()
    twice = 2000 + int(np.argmin(time[2001:2901] - time[1999:2899]))  # what it leaves before it is no gap
    frame.loc[twice, "time"] = time[twice + 1]
    imported = take("imu", frame)
    told = " / ".join(imported.sentences())
    lasts = frame["time"][1000] - frame["time"][999]
    assert re.search(
        rf"1 gap\(s\) of more than 0.03\d* s; the longest lasts {lasts:.3g} s from {frame.time[999]:.3f} s", told
    )
    assert "5 sample(s) repeat the values of the one before, up to 4 in a row" in told
    assert "1 sample(s) have the time of the next one; they are lost" in told
    numbers = columns(imported)["sequence"]
    assert len(numbers) == len(frame) - 1 and twice + 1.0 not in numbers and numbers[-1] == len(frame)
    changes = columns(take("imu", frame, changes_only=True))
    assert len(changes["time"]) == len(frame) - 6


def test_a_wild_time_at_the_end_is_a_gap(take):
    """Fails where memory is taken for each second that passes."""
    wild = IMU.assign(time=np.append(TIME[:-1], 1e13))
    assert any(
        "1 gap(s)" in s and "the longest lasts 1e+13 s" in s for s in take("imu", wild, unchecked=True).sentences()
    )


def test_what_is_not_plausible_is_taken_when_told_so(take):
    imported = take("imu", scaled(IMU, 2.0, *FORCE), unchecked=True)
    assert any(s.startswith("not plausible, and taken: specific_force is 19.") for s in imported.sentences())


@pytest.mark.parametrize(
    ("factor", "least", "most"), [(1.0, 0.0, 0.02), (180 / np.pi, 0.5, np.pi), (np.pi / 180, 0.1, 0.5)]
)
def test_the_specific_force_turns_as_the_gyros_say(factor, least, most):
    """Of a made recording that pitches and rolls: right, in deg/s taken for rad/s, and the other way."""
    assert least <= turn_error(TIME, factor * IMU[RATE].to_numpy(), IMU[FORCE].to_numpy()) <= most


def test_the_command_writes_the_fmu_from_csv_and_parquet_and_tells(player, tmp_path, monkeypatch):
    monkeypatch.setattr("navfmu.system.shipped.path", lambda name: player(name.removesuffix("_replay.fmu")))
    names = ["imu_replay.fmu", "gps_replay.fmu", "imu.fmu"]
    monkeypatch.setattr("navfmu.system.shipped.names", lambda suffix="": names)
    IMU.to_csv(tmp_path / "thor.csv", index=False)
    IMU.to_parquet(tmp_path / "thor.parquet")
    for kind in ("csv", "parquet"):
        out = tmp_path / f"{kind}.fmu"
        arguments = ["replay", "imu", str(tmp_path / f"thor.{kind}"), "--out", str(out), "--picture", str(out) + ".png"]
        outcome = CliRunner().invoke(main, arguments, catch_exceptions=False)
        assert outcome.exit_code == 0, outcome.output
        assert "3000 samples from t = 0.012 s" in outcome.output and "wrote" in outcome.output
        description = fmpy.read_model_description(str(out))
        assert description.modelName == "thor" and f"thor.{kind}" in description.description
        assert float(description.defaultExperiment.stopTime) == TIME[-1]
        assert (tmp_path / f"{kind}.fmu.png").read_bytes().startswith(b"\x89PNG")
    wrong = CliRunner().invoke(main, ["replay", "imus", "x.csv", "--out", str(tmp_path / "x.fmu")])
    assert wrong.exit_code == 2 and "there is no sensor 'imus'; expected imu, gps; did you mean 'imu'?" in wrong.output


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_fewest_samples_are_played(count, take, tmp_path):
    imported = take("imu", IMU[:count])
    imported.write(tmp_path / "few.fmu")
    draw(imported, tmp_path / "few.png")
    assert any(s.startswith(f"{count} samples from t = 0.012 s") for s in imported.sentences())
    told = columns(imported)
    assert len(told["time"]) == max(count, 2) and np.ptp(told["sequence"]) == count - 1  # a row twice is told once


def test_a_text_may_end_in_empty_lines(tmp_path):
    IMU.to_csv(tmp_path / "a.csv", index=False)
    (tmp_path / "b.csv").write_text((tmp_path / "a.csv").read_text() + "\n\n")
    pd.testing.assert_frame_equal(read(tmp_path / "b.csv").frame, read(tmp_path / "a.csv").frame)


def test_files_that_are_none(tmp_path):
    for name, content, sentence in (
        ("a.parquet", b"PAR", "this is no Parquet file"),
        ("a.csv", b"", "this is no CSV table with a header line"),
        ("b.csv", b"time,rate_x\n", "has no rows"),
        ("d.csv", b"time,rate_x,rate_x\n0,1,2\n", "has two columns 'rate_x'"),
        ("e.csv", b"time,rate_x\n0,1,2\n1,2,3\n", "rows have more fields than the header"),
        ("f.csv", b"time,rate_x\n0,1\n1,2,3\n", "this is no CSV table"),
        ("g.csv", b"time,rate_x\n0,02,1,5\n0,04,1,5\n", "rows have more fields than the header .*points in numbers"),
        ("c.csv", b"time;rate_x\n0,1;0,2\n", "the columns are separated by ';'; expected commas"),
        ("a.mat", b"", "cannot tell the format from the name"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(NavfmuError, match=sentence):
            read(tmp_path / name)
    with pytest.raises(NavfmuError, match="no such file; expected recorded samples"):
        read(tmp_path / "none.csv")


def test_the_page_and_info_are_those_of_the_recording(take, tmp_path, capsys):
    """The page was that of the player: a minute of rolling, 600 rows, and nothing of gaps and losses."""
    frame = IMU.drop(index=range(1000, 1030)).assign(time=lambda frame: 0.3 * frame["time"])
    fmu = take("imu", frame).write(tmp_path / "flight.fmu", "flight <7>")
    with zipfile.ZipFile(fmu) as archive:
        page = archive.read("documentation/index.html").decode()
    assert "<h1>flight &lt;7&gt;</h1>" in page and "Played by imu_replay" in page
    for told in (
        rf"{len(frame)} samples from t = ",
        r"1 gap\(s\) of more than",
        r"of 2970 samples are lost",
        "<td>2970 rows</td>",
    ):
        assert re.search(told, page), told
    for old in ("<h2>Response</h2>", "minute of rolling", "600 rows", "data:image"):
        assert old not in page, old
    assert "<h2>Parameters</h2>" in page and "<h2>Interface</h2>" in page
    show(str(fmu))
    told = " ".join(capsys.readouterr().out.split())
    assert "recording, as it was imported" in told and "1 gap(s) of more than" in told and "samples are lost" in told


def test_names_of_columns_may_have_any_characters(take, tmp_path):
    """XML has no NUL, and Matplotlib reads what is between two $: the page and the picture were tracebacks."""
    frame = renamed(IMU, rate_x="$\\no{$").assign(**{"a\x00\x1b[2Jb": 1.0})
    imported = take("imu", frame, columns={"rate": ("$\\no{$", "rate_y", "rate_z")})
    draw(imported, tmp_path / "flight.png")
    fmu = imported.write(tmp_path / "flight.fmu")
    with zipfile.ZipFile(fmu) as archive:
        for name in ("index.html", "import.txt"):
            told = archive.read(f"documentation/{name}").decode()
            assert "columns not used: a" in told and "\x00" not in told and "\x1b" not in told


def test_a_short_gap_is_seen_in_the_picture(take, tmp_path):
    """30 ms of 60 s are less than a dot: shaded with their own width alone they were not there."""
    frame = samples.imu(samples.stamps(6000, 0.009, 0.011))

    def orange(name, frame):
        draw(take("imu", frame), tmp_path / name)
        red, green, blue = np.moveaxis(matplotlib.image.imread(tmp_path / name)[40:, :600, :3], 2, 0)
        return np.count_nonzero((red > green + 0.05) & (green > blue + 0.05) & (blue > 0.55))  # not that of the curves

    whole, lacking = orange("whole.png", frame), orange("lacking.png", frame.drop(index=range(3000, 3003)))
    assert lacking - whole > 100  # a line through three panels of 150 dots


def test_what_pandas_writes_by_itself_is_read(tmp_path):
    """An index that has a name, a mark of byte order, and whole numbers that are longer than any float."""
    IMU.set_index("time").to_parquet(tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(read(tmp_path / "a.parquet").frame, IMU)
    IMU.to_csv(tmp_path / "a.csv", index=False, encoding="utf-8-sig")
    assert read(tmp_path / "a.csv").names == list(IMU.columns)
    (tmp_path / "b.csv").write_text("time,rate_x\n0,1" + 400 * "0" + "\n1,0.5\n")
    assert list(read(tmp_path / "b.csv").numbers("rate_x")) == [np.inf, 0.5]


def test_a_number_that_none_can_be_is_worked_out_and_told(take):
    """A pressure or a temperature of 0 and less would become NaN in a valid sample."""
    frame = one(
        one(AIR.assign(static_pressure=PRESSURE, temperature=285.0), "static_pressure", 0.0), "temperature", -1.0
    )
    imported = take("air_data", frame)
    told = columns(imported)
    for name in ("static_pressure", "temperature"):
        assert told[f"{name}_known"][7] == 0.0 and told[f"{name}_known"].sum() == len(frame) - 1
        assert f"{name} is missing in 1 of 3000 samples, where it is worked out of the others" in imported.sentences()


def test_the_tick_of_which_none_is_lost_is_not_longer_than_the_shortest_interval(take):
    """5.4657 ms told as 5.47 ms would lose the second of these samples."""
    frame = IMU[:200].assign(time=0.0054657 * np.arange(1, 201))
    (told,) = [sentence for sentence in take("imu", frame).sentences() if "or less none is lost" in sentence]
    assert "of 0.00546 s or less" in told
