"""Samples of a PX4 log: a log written here by the ULog file format (docs.px4.io, "ULog File Format") comes back."""

from __future__ import annotations

import struct
import sys

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.recorded.replay import px4
from navfmu.recorded.replay.importer import import_samples
from tests import built
from tests.recorded import samples

BOOT = 123_456_789  # us: when the log starts
FORMATS = {
    "sensor_combined": "uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_dt;float[3] accelerometer_m_s2",
    "vehicle_magnetometer": "uint64_t timestamp;float[3] magnetometer_ga",
    "vehicle_gps_position": "uint64_t timestamp;int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;"
    "float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;uint8_t fix_type",
    "airspeed": "uint64_t timestamp;float indicated_airspeed_m_s;float true_airspeed_m_s;float air_temperature_celsius",
    "vehicle_air_data": "uint64_t timestamp;float baro_pressure_pa",
}
PACKED = {
    "sensor_combined": "<Q3fI3f",
    "vehicle_magnetometer": "<Q3f",
    "vehicle_gps_position": "<Q4i3fB",
    "airspeed": "<Q3f",
    "vehicle_air_data": "<Qf",
}


def log(path, **topics):
    """Write rows (seconds since the start of the log, values ...) of topics."""

    def message(kind, body):
        return struct.pack("<HB", len(body), ord(kind)) + body

    data = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", BOOT) + message("B", bytes(40))
    data += b"".join(message("F", f"{name}:{FORMATS[name]};".encode()) for name in topics)
    for number, name in enumerate(topics):
        data += message("A", struct.pack("<BH", 0, number) + name.encode())
    rows = [(row[0], number, name, row) for number, (name, rows) in enumerate(topics.items()) for row in rows]
    for time, number, name, row in sorted(rows, key=lambda r: r[:2]):
        body = struct.pack(PACKED[name], BOOT + round(1e6 * time), *row[1:])
        data += message("D", struct.pack("<H", number) + body)
    path.write_bytes(data)
    return path


@pytest.fixture(scope="module")
def player(tmp_path_factory):
    return lambda sensor: built.fmu(f"{sensor}_replay", tmp_path_factory)


def table(imported):
    (samples,) = imported.streams
    return {key.partition(" ")[0]: column for key, column in samples.table().items()}


def test_inertial_samples_come_back(player, tmp_path):
    frame = samples.imu(samples.stamps(500, 0.003, 0.006))
    values = frame.drop(columns="time").to_numpy().astype(np.float32)
    rows = [(t, *v[:3], 4000, *v[3:]) for t, v in zip(frame["time"], values, strict=True)]
    told = table(import_samples(px4.read(log(tmp_path / "a.ulg", sensor_combined=rows), "imu"), player("imu")))
    np.testing.assert_allclose(told["time"], frame["time"], rtol=0.0, atol=1e-6)
    for column, name in enumerate(n for n in told if n.startswith(("rate[", "specific_force["))):
        np.testing.assert_array_equal(told[name], values[:, column])


def test_field_fixes_and_air_data_come_back_in_si_units(player, tmp_path):
    """Gauss, 1e-7 deg, mm above the ellipsoid, degC; a fix in two dimensions is not valid; no temperature is none."""
    seconds = np.arange(1.0, 61.0)
    field, fixes = samples.field(seconds), samples.fixes(seconds)
    fields = [(t, *(1e4 * row)) for t, row in zip(seconds, field.drop(columns="time").to_numpy(), strict=True)]
    degrees = np.round(1e7 * np.degrees(fixes[["latitude", "longitude"]].to_numpy())).astype(int)
    heights = np.round(1e3 * fixes["altitude"].to_numpy()).astype(int)
    velocities = fixes[["velocity_north", "velocity_east", "velocity_down"]].to_numpy()
    positions = [
        (t, *place, height + 32000, height, *velocity, 2 if t < 3.0 else 3)
        for t, place, height, velocity in zip(seconds, degrees, heights, velocities, strict=True)
    ]
    speeds = [(t, 20.0 + 0.01 * t, 21.0, -1000.0 if t < 3.0 else 12.0) for t in seconds]
    pressures = [(t + 0.4, 9.5e4 - t) for t in seconds]
    path = log(
        tmp_path / "b.ulg",
        vehicle_magnetometer=fields,
        vehicle_gps_position=positions,
        airspeed=speeds,
        vehicle_air_data=pressures,
    )
    told = table(import_samples(px4.read(path, "magnetometer"), player("magnetometer")))
    np.testing.assert_allclose(told["field_b[1]"], field["field_x"], rtol=1e-6)
    told = table(import_samples(px4.read(path, "gps"), player("gps")))
    np.testing.assert_allclose(told["latitude"][2:], fixes["latitude"][2:], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(told["altitude"][2:], fixes["altitude"][2:], rtol=0.0, atol=1e-3)
    np.testing.assert_array_equal(told["valid"], seconds >= 3.0)
    told = table(import_samples(px4.read(path, "air_data"), player("air_data")))
    np.testing.assert_allclose(told["time"], seconds[1:], atol=1e-6)  # the first is older than the first pressure
    np.testing.assert_allclose(told["static_pressure"], 9.5e4 - seconds[:-1], rtol=1e-6)
    np.testing.assert_array_equal(told["temperature_known"], seconds[1:] >= 3.0)
    np.testing.assert_allclose(told["temperature"][2:], 285.15, rtol=1e-6)


def test_what_the_log_lacks_is_told(player, tmp_path, capsys):
    """A damaged record, and a stretch of 250 ms that the logger says it lost, were passed over in silence."""
    frame = samples.imu(samples.stamps(500, 0.003, 0.006))
    rows = [
        (t, *v[:3], 4000, *v[3:]) for t, v in zip(frame["time"], frame.drop(columns="time").to_numpy(), strict=True)
    ]
    path = log(tmp_path / "a.ulg", sensor_combined=rows)
    assert import_samples(px4.read(path, "imu"), player("imu")).told == ()
    data = path.read_bytes()
    dropout = struct.pack("<HBH", 2, ord("O"), 250)
    path.write_bytes(data + dropout)
    (told,) = import_samples(px4.read(path, "imu"), player("imu")).told
    assert told == "the logger lost data 1 time(s), for up to 250 ms and 250 ms in all"
    stray = struct.pack("<HBH", 34, ord("D"), 77) + bytes(32)  # of a topic that there is not
    path.write_bytes(data + stray)
    assert (
        "the log is damaged; what could not be read is missing"
        in import_samples(px4.read(path, "imu"), player("imu")).sentences()
    )
    assert capsys.readouterr().out == ""


def test_the_topic_that_is_missing_is_the_one_that_is_named(tmp_path):
    """A log with a barometer and no airspeed was said to have no vehicle_air_data."""
    path = log(tmp_path / "c.ulg", vehicle_air_data=[(1.0, 9.5e4)])
    with pytest.raises(NavfmuError, match=r"has no airspeed and no airspeed_validated, so nothing of 'air_data'"):
        px4.read(path, "air_data")


def test_what_cannot_be_read_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "no.ulg").write_bytes(b"nothing of it")
    with pytest.raises(NavfmuError, match=r"no\.ulg: this is no log of PX4"):
        px4.read(tmp_path / "no.ulg", "imu")
    path = log(tmp_path / "c.ulg", sensor_combined=[(1.0, *[0.0] * 3, 4000, *[0.0] * 3)])
    path.write_bytes(path.read_bytes().replace(b"timestamp", b"timestump"))
    with pytest.raises(NavfmuError, match=r"has no sensor_combined, so nothing of 'imu'"):
        px4.read(path, "imu")
    path = log(tmp_path / "c.ulg", vehicle_air_data=[(1.0, 9.5e4)])
    with pytest.raises(NavfmuError, match=r"has no sensor_combined, so nothing of 'imu'"):
        px4.read(path, "imu")
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(NavfmuError, match=r"pyulog, which is not installed: pip install 'navfmu\[px4\]'"):
        px4.read(path, "imu")
