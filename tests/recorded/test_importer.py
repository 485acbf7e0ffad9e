"""The importer against a made flight whose truth is known, spoilt in the ways that real recordings are."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.recorded.importer import import_track
from tests.recorded.made import KNOT, flight, hole, recorded


@pytest.fixture(scope="module")
def truth():
    return flight()


@pytest.fixture
def fly(tmp_path):
    def write_and_import(frame, **options):
        path = tmp_path / "made.csv"
        frame.to_csv(path, index=False)
        return import_track(path, **options)

    return write_and_import


def errors(imported, truth):
    """Horizontal and vertical distance from the truth in m and the error of velocity in m/s, twice a second."""
    time = np.arange(0.0, imported.flight.duration, 0.5)
    true = truth.at(time + imported.flight.start)
    north = 6.37e6 * (imported.flight.latitude(time) - true["latitude"])
    east = 6.37e6 * np.cos(true["latitude"]) * (imported.flight.longitude(time) - true["longitude"])
    vertical = imported.flight.altitude(time) - true["altitude"]
    vn, ve, _ = imported.flight.velocity(time)
    dv = np.hypot(
        vn - true["speed"] * np.cos(true["track"]),
        ve - true["speed"] * np.sin(true["track"]),
    )
    return np.hypot(north, east), np.abs(vertical), dv


def test_clean_recording_is_followed_within_metres(fly, truth):
    imported = fly(recorded(truth))
    horizontal, vertical, velocity = errors(imported, truth)
    assert np.percentile(horizontal, 95) < 5.0
    assert np.percentile(vertical, 95) < 6.0  # altitudes come in steps of 25 ft
    assert np.percentile(velocity, 95) < 1.5
    assert imported.defects.jitter < 0.1


def test_positions_alone_suffice(fly, truth):
    frame = recorded(truth, on_ground=False)[["time_s", "latitude_deg", "longitude_deg", "altitude_ft"]]
    imported = fly(frame)
    horizontal, _, velocity = errors(imported, truth)
    assert np.percentile(horizontal, 95) < 5.0
    assert np.percentile(velocity, 95) < 2.0


def test_timing_jitter_is_found_and_mostly_removed(fly, truth):
    imported = fly(recorded(truth, jitter=1.0))
    horizontal, _, _ = errors(imported, truth)
    assert 0.6 < imported.defects.jitter < 1.4
    ascribed = imported.residuals.timing[imported.measured]
    assert np.std(ascribed) > 0.6
    assert np.sqrt(np.mean(horizontal**2)) < 30.0  # a second of jitter moves a position by 60 m


def test_airborne_part_is_cut_out(fly, truth):
    imported = fly(recorded(truth))
    speed_at_ends = truth.at(imported.flight.start + np.array([0.0, imported.flight.duration]))["speed"]
    assert np.all(speed_at_ends >= 60.0 * KNOT - 1.0)
    assert imported.flight.start > 60.0
    assert imported.flight.start + imported.flight.duration < truth.time[-1] - 60.0
    assert any("airborne part" in s for s in imported.sentences())


@pytest.mark.parametrize("how", ["repeat", "freeze", "interpolated", "missing"])
def test_hole_in_a_turn_is_bridged_along_the_turn(fly, truth, how):
    """From 330 s on the aircraft turns by 3 deg/s: a chord over 40 s would cut the circle of 1.1 km radius deeply."""
    imported = fly(hole(recorded(truth), 370.0, 410.0, how))
    horizontal, _, velocity = errors(imported, truth)
    assert len(imported.defects.holes) == 1
    assert imported.defects.holes[0].end - imported.defects.holes[0].start == pytest.approx(40.0, abs=5.1)
    assert horizontal.max() < 150.0  # the chord is 550 m off
    assert velocity.max() < 20.0
    assert imported.defects.repeated == (7 if how in ("repeat", "freeze") else 0)


def test_long_hole_with_living_speed_and_track_is_bridged_by_them(fly, truth):
    """Six minutes of one repeated position while speed and track go on, through two turns and back."""
    imported = fly(hole(recorded(truth), 300.0, 660.0, "repeat"))
    horizontal, _, _ = errors(imported, truth)
    assert imported.defects.repeated == 71
    assert "recorded speed and track" in imported.sentences()[-2]
    assert horizontal.max() < 150.0


def test_echoes_at_the_end_are_cut_off(fly, truth):
    frame = recorded(truth)
    frame = frame[frame.time_s < 1000.0]
    imported = fly(hole(frame, 900.0, 2000.0, "freeze"))
    assert imported.flight.start + imported.flight.duration == pytest.approx(900.0)


def test_direction_in_one_byte_is_repaired(fly, truth):
    frame = recorded(truth)
    clean = fly(frame)
    frame["track_deg"] = frame.track_deg.astype(int).astype("uint8").astype("int8")
    assert frame.track_deg.min() < 0
    imported = fly(frame)
    assert any("one signed byte" in s for s in imported.sentences())
    difference = imported.flight.latitude(600.0) - clean.flight.latitude(600.0)
    assert abs(difference) * 6.37e6 < 1.0


def test_track_column_that_contradicts_the_positions_is_not_used(fly, truth):
    frame = recorded(truth)
    frame["track_deg"] = (frame.track_deg + 90.0) % 360.0
    imported = fly(frame)
    assert any("the column is not used" in s for s in imported.sentences())
    assert np.percentile(errors(imported, truth)[0], 95) < 5.0


def test_single_wrong_positions_lose_their_say(fly, truth):
    frame = recorded(truth)
    rows = [60, 110, 170]
    frame.loc[rows, "latitude_deg"] += 0.02  # 2.2 km
    horizontal, _, _ = errors(fly(frame), truth)
    assert horizontal.max() < 60.0


def test_flight_over_the_date_line_is_continuous(fly):
    truth = flight(latitude=-17.0, longitude=179.99)
    frame = recorded(truth)
    frame["longitude_deg"] = (frame.longitude_deg + 180.0) % 360.0 - 180.0
    assert frame.longitude_deg.min() < -179 < 179 < frame.longitude_deg.max()
    assert np.percentile(errors(fly(frame), truth)[0], 95) < 5.0


def test_smoothed_flight_does_not_lead_underground(fly, truth):
    """A hole around the lowest point of a low pass: the smoothest way through it would dip below the runway."""
    frame = recorded(truth)
    t = frame.time_s.to_numpy()
    frame["altitude_ft"] = np.maximum(np.abs(t - 700.0) * 1200.0 / 60.0, 50.0).clip(max=3000.0)
    frame["vertical_rate_ft_min"] = np.gradient(frame.altitude_ft, t) * 60.0
    imported = fly(hole(frame, 675.0, 725.0, "interpolated"))
    time = np.arange(0.0, imported.flight.duration, 0.5)
    lowest = imported.recording.altitude[imported.measured].min()
    assert imported.flight.altitude(time).min() > lowest - 5.0


def change(frame, column, row, value):
    frame[column] = frame[column].astype(object)
    frame.loc[row, column] = value
    return frame


BAD = {
    "unknown name": (lambda f: f.rename(columns={"track_deg": "trak_deg"}), "trak_deg.*did you mean 'track_deg'"),
    "misspelt": (lambda f: f.rename(columns={"latitude_deg": "lattitude_deg"}), "'latitude_deg'.*'lattitude_deg'"),
    "missing": (lambda f: f.drop(columns="altitude_ft"), "no column 'altitude_ft'"),
    "backwards": (lambda f: change(f, "time_s", 20, 3.0), "line 22.*3 after 95"),
    "empty cell": (lambda f: change(f, "latitude_deg", 20, None), "line 22.*'latitude_deg' is empty"),
    "word": (lambda f: change(f, "altitude_ft", 20, "high"), "line 22.*altitude_ft is 'high'"),
    "impossible": (lambda f: change(f, "latitude_deg", 20, 137.4), "line 22.*137.4.*expected -89 to 89"),
    "two rows": (lambda f: f.head(2), "2 complete row"),
    "on the ground": (lambda f: f.assign(groundspeed_kt=15.0), "on the ground"),
    "short": (lambda f: f[f.time_s.between(200, 245)], "at least"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_a_sentence(fly, truth, name):
    spoil, expected = BAD[name]
    with pytest.raises(NavfmuError, match=expected) as caught:
        fly(spoil(recorded(truth)))
    assert "made.csv" in str(caught.value)


def test_incomplete_rows_can_be_left_out(fly, truth):
    frame = change(recorded(truth), "latitude_deg", 60, None)
    imported = fly(frame, skip_incomplete=True)
    assert "1 incomplete row(s) left out" in imported.sentences()


def test_missing_file_and_file_without_table(tmp_path):
    with pytest.raises(NavfmuError, match="no such file"):
        import_track(tmp_path / "nothing.csv")
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(NavfmuError, match="not a CSV table"):
        import_track(tmp_path / "empty.csv")


def test_unused_columns_are_named(fly, truth):
    imported = fly(recorded(truth).assign(squawk=7000))
    assert "columns not used: squawk" in imported.sentences()
