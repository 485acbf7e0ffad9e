"""Pictures say what is in their data: bounds, faults, and numbers that are none."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib import image
from matplotlib.colors import to_rgba

from navfmu.constants import NAUTICAL_MILE
from navfmu.errors import NavfmuError
from navfmu.report.pictures import lines, map, percentiles, sigma
from navfmu.report.scene import Bound, Recorded, Scene, Window

TIME = np.arange(100.0)
DEGREE = np.pi / 180


def scene(runs: list[dict[str, np.ndarray]], **more) -> Scene:
    made = tuple(Recorded(f"seed {i + 1}", TIME, signals) for i, signals in enumerate(runs))
    return Scene("main, x", made, made[0], more.pop("units", {}), **more)


@pytest.fixture
def drawing(monkeypatch):
    """What was drawn last, before it became a PNG."""
    kept = []
    for kind in (lines, map, percentiles, sigma):
        monkeypatch.setattr(kind, "png", lambda figure: kept.append(figure) or b"PNG")
    return kept


def curves(axis) -> dict[str, np.ndarray]:
    return {line.get_label(): line.get_ydata() for line in axis.lines}


def legend(axis) -> list[str]:
    return [text.get_text() for text in axis.get_legend().get_texts()]


# ---- percentiles ----------------------------------------------------------------------------------------------------


def draw_percentiles(values, **more):
    return percentiles.Picture(kind="percentiles", signal="a.x").draw(scene([{"a.x": v} for v in values], **more))


def test_percentiles_are_runs_at_or_beyond_the_share(drawing):
    draw_percentiles([np.full(100, float(i)) for i in range(1, 22)])
    (axis,) = drawing[0].axes
    band = axis.collections[0].get_paths()[0].vertices[:, 1]
    assert curves(axis)["median"][0] == 11.0 and (band.min(), band.max()) == (2.0, 20.0)
    draw_percentiles([np.full(100, float(i)) for i in range(1, 5)])  # of four runs no one is between
    band = drawing[1].axes[0].collections[0].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == (1.0, 4.0)


def test_what_is_not_finite_is_said_marked_and_does_not_hide_the_other_runs(drawing):
    values = [np.full(100, 1.0), np.full(100, 2.0), np.full(100, 3.0)]
    values[1][10:20], values[2][15] = np.nan, np.inf
    drawn = draw_percentiles(values)
    assert "NOT FINITE AT 11 OF 300 POINTS" in drawn.title and "not finite at 11 of 300" in drawn.caption
    found = curves(drawing[0].axes[0])
    assert list(found["median"][[0, 12, 15]]) == [2.0, 3.0, 1.0]
    assert len(found["not finite in a run"]) == 10


def test_the_title_has_the_range_and_the_caption_the_run_of_the_greatest(drawing):
    values = [np.full(100, 1.0), np.linspace(-5.0, 1234.5, 100)]
    drawn = draw_percentiles(values, units={"a.x": "m"})
    assert drawn.title == "main, x: a.x, 2 runs, -5 to 1234 m"
    assert "greatest: 1234 m at t = 99 s, seed 2" in drawn.caption


def test_equal_bounds_share_a_line_and_none_is_left_out(drawing):
    bounds = [Bound(f"R-{i}", "a.x", None, float(i // 2), "m") for i in range(20)]
    draw_percentiles([TIME, TIME], bounds=(*bounds, Bound("R-0", "a.y", None, 3.0, "m")))
    texts = legend(drawing[0].axes[0])
    assert [text for text in texts if text.startswith("R-")] == [
        f"R-{i}, R-{i + 1}: {i // 2} m" for i in range(0, 20, 2)
    ]
    assert len(texts) == len(set(texts))


def test_each_fault_is_named_once_above_the_panels_and_not_in_the_legend(drawing):
    windows = (Window("jam", ((10.0, np.inf),)), *(Window(name, ((20.0, 30.0),)) for name in ("off", "off", "stuck")))
    windows += tuple(Window(f"f{i}", ((40.0 + i, 60.0 + i),)) for i in range(8))
    draw_percentiles([TIME, TIME], windows=windows)
    (axis,) = drawing[0].axes
    named = [text.get_text().strip() for text in axis.texts]
    assert named == ["jam", "off, stuck", *(f"f{i}" for i in range(8))]
    places = [text.get_position()[1] for text in axis.texts]
    assert len(set(places)) == len(places) and min(places) > 1.0  # of the panel's height: above it, below each other
    assert not any(name in text for name in named for text in legend(axis))


# ---- sigma ----------------------------------------------------------------------------------------------------------


def draw_sigma(error, claimed, valid=None, **more):
    axes = [{"name": "x", "error": "a.e", "sigma": "a.s"}]
    signals = {"a.e": error, "a.s": claimed} | ({} if valid is None else {"a.v": valid})
    entry = sigma.Picture(kind="sigma", axes=axes, valid=None if valid is None else "a.v", **more)
    return entry.draw(scene([signals]))


def test_the_share_counts_what_is_no_number_as_outside():
    error, claimed = np.zeros(100), np.ones(100)
    error[:10], error[10:15], claimed[20:25], claimed[30] = 4.0, np.nan, np.nan, np.inf
    title = draw_sigma(error, claimed).title
    assert "x error inside 3 sigma for 79.0 % of 100 points of seed 1, NOT FINITE AT 11 OF 100 POINTS" in title


def test_only_valid_points_count_and_a_validity_that_is_no_number_does_not_excuse():
    error, valid = np.where(TIME < 50, 9.0, 0.0), np.where(TIME < 50, 0.0, 1.0)
    assert "for 100.0 % of 50 points" in draw_sigma(error, np.ones(100), valid).title
    valid[:10] = np.nan
    assert "for 83.3 % of 60 points" in draw_sigma(error, np.ones(100), valid).title
    assert "no valid point in seed 1" in draw_sigma(error, np.ones(100), np.zeros(100)).title


def test_the_factor_is_used_and_named(drawing):
    assert "inside 1 sigma for 0.0 %" in draw_sigma(np.full(100, 2.0), np.ones(100), factor=1).title
    assert legend(drawing[0].axes[0]) == ["1 sigma claimed", "x error"]


def test_small_errors_fill_their_panel(drawing):
    """Errors of micrometres or microradians are as visible as those of metres."""
    draw_sigma(1e-6 * np.sin(TIME), np.full(100, 1e-7))
    assert drawing[0].axes[0].get_ylim()[1] < 2e-6


# ---- map ------------------------------------------------------------------------------------------------------------


def along(latitude: float, longitude: float, heading: float, metres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A great circle on a sphere of the radius of the picture; rad."""
    arc = metres / map.EARTH
    lat = np.arcsin(np.sin(latitude) * np.cos(arc) + np.cos(latitude) * np.sin(arc) * np.cos(heading))
    east = np.sin(heading) * np.sin(arc) * np.cos(latitude)
    lon = longitude + np.arctan2(east, np.cos(arc) - np.sin(latitude) * np.sin(lat))
    return lat, np.angle(np.exp(1j * lon))


@pytest.mark.parametrize(
    ("latitude", "longitude", "heading"),
    [(10.0, 179.9, 90.0), (-40.0, -179.9, 270.0), (89.9, 30.0, 5.0), (90.0, 0.0, 7.0)],
)
def test_distances_are_true_over_the_date_line_and_the_poles(latitude, longitude, heading):
    metres = np.linspace(0.0, 100_000.0, 201)
    east, north = map.Ground(*(p := along(latitude * DEGREE, longitude * DEGREE, heading * DEGREE, metres))).local(*p)
    steps = np.hypot(np.diff(east), np.diff(north)) * NAUTICAL_MILE
    assert steps == pytest.approx(500.0, rel=1e-3)  # no jump, no stretch
    assert np.hypot(east[0], north[0]) == pytest.approx(27.0, rel=1e-2)  # nmi, the middle of the track is the origin


def test_east_and_north_are_where_they_belong():
    ground = map.Ground(np.array([0.5, 0.5]), np.array([np.pi - 1e-3, 1e-3 - np.pi]))
    assert abs(abs(ground.longitude) - np.pi) < 1e-9
    east, north = ground.local(np.array([0.501, 0.5]), np.array([np.pi, 0.001 - np.pi]))
    assert north[0] == pytest.approx(0.001 * map.EARTH / 1852, rel=1e-3) and abs(east[0]) < 1e-6 and east[1] > 2.9


def draw_map(latitude, longitude, found, **more):
    units = dict.fromkeys(("a.lat", "a.lon", "b.lat", "b.lon", "c.lat", "c.lon"), "rad") | more.pop("units", {})
    entry = map.Picture(kind="map", truth=["a.lat", "a.lon"], estimate=["b.lat", "b.lon"], **more.pop("entry", {}))
    signals = {"a.lat": latitude, "a.lon": longitude, "b.lat": found, "b.lon": longitude, "b.v": TIME > 50}
    return entry.draw(scene([signals], units=units, **more))


def test_the_map_says_how_far_off_the_estimate_is_and_what_is_missing(drawing):
    latitude, longitude = np.full(100, 0.5), 1e-4 * TIME
    found = latitude + np.where(TIME < 50, 1.0, 1e-4)
    found[60:63] = np.nan
    title = draw_map(latitude, longitude, found, entry={"valid": "b.v"}).title
    assert f"estimate up to {1e-4 * map.EARTH / 1852:.3g} nmi off" in title  # the far points are not valid
    assert "ESTIMATE NOT FINITE AT 3 OF 49 POINTS" in title
    assert len(legend(drawing[0].axes[0])) == 3


def test_marks_are_as_many_as_the_count_says_and_degrees_are_degrees(drawing):
    marks = [{"label": "beacon", "latitude": "c.lat", "longitude": "c.lon", "count": "c.n"}]
    constants = {"c.lat": [30.0, 30.0, 0.0], "c.lon": [0.0, 1.0, 0.0], "c.n": 2}
    draw_map(
        np.full(100, 30 * DEGREE), TIME * 0.0, np.full(100, 30 * DEGREE), entry={"marks": marks}, constants=constants,
        units={"c.lat": "deg", "c.lon": "deg"},
    )  # fmt: skip
    east = next(line for line in drawing[0].axes[0].lines if line.get_label() == "beacon").get_xdata()
    assert east == pytest.approx([0.0, 60 * np.cos(30 * DEGREE)], rel=2e-3)


# ---- lines ----------------------------------------------------------------------------------------------------------


def draw_lines(signals, **more):
    return lines.Picture(kind="lines", signals=list(signals)).draw(scene([signals], **more))


def test_each_unit_has_a_panel_and_each_curve_a_name_and_a_look_of_its_own(drawing):
    signals = {f"a.m{i}": TIME + i for i in range(30)} | {"a.rad": TIME, "a.ok": TIME > 5, "a.n": TIME.astype(np.int64)}
    draw_lines(signals, units={f"a.m{i}": "m" for i in range(30)} | {"a.rad": "rad"})
    panels = drawing[0].axes
    assert [axis.get_ylabel() for axis in panels] == ["m", "m", "m", "rad", "", "whole number"]
    assert [text.get_text() for text in panels[4].get_yticklabels()] == ["false", "true"]
    assert sorted(name for axis in panels for name in legend(axis)) == sorted(signals)
    for axis in panels:
        looks = [(to_rgba(line.get_color()), line.get_linestyle()) for line in axis.lines if len(line.get_xdata())]
        assert len(looks) == len(set(looks))


def test_a_curve_that_is_flat_or_not_all_there_says_so(drawing):
    broken = np.where(TIME < 4, np.nan, TIME)
    drawn = draw_lines({"a.flat": np.full(100, 2.5), "a.broken": broken}, units={"a.flat": "m", "a.broken": "m"})
    assert legend(drawing[0].axes[0]) == ["a.flat (always 2.5 m)", "a.broken\nNOT FINITE AT 4 OF 100 POINTS"]
    assert "a.broken" in drawn.caption


def test_too_many_units_are_refused_in_a_sentence():
    with pytest.raises(NavfmuError, match="50 signals need 50 panels, expected at most 40; name fewer"):
        draw_lines({f"a.s{i}": TIME for i in range(50)}, units={f"a.s{i}": f"u{i}" for i in range(50)})


def test_legends_stand_beside_the_curves_and_inside_the_picture():
    name = "a_component.a_bundle_of_values.a_signal_with_a_rather_long_name[1,2]"
    png = draw_lines({name: TIME, "a.b": -TIME}).png
    pixels = image.imread(io.BytesIO(png))[:, :, :3]
    assert np.all(pixels[:, -3:] == 1.0) and np.all(pixels[:3] == 1.0)  # nothing is cut off at the edges


def test_runs_that_ended_early_count_up_to_there_and_are_said(drawing):
    """They were stacked as if all had one length."""
    runs = [Recorded(f"seed {k}", TIME[:end], {"a.y": TIME[:end] + k}, TIME) for k, end in ((1, 30), (2, 60), (3, 100))]
    made = percentiles.Picture(kind="percentiles", signal="a.y").draw(Scene("", tuple(runs), runs[0], {"a.y": "m"}))
    median = curves(drawing[0].axes[0])["median"]
    assert median[29] == 31.0 and median[59] == 62.0 and median[60] == 63.0 and len(median) == 100
    assert "2 OF 3 RUNS ENDED EARLY, THE FIRST AT T = 29 S" in made.title and "not finite" not in made.caption


def test_pictures_of_one_run_reach_to_its_planned_end(drawing):
    run = Recorded("seed 1", TIME[:1], {"a.y": TIME[:1]}, TIME)
    windows = (Window("late", ((50.0, np.inf),)),)
    bounds = (Bound("R", "a.y", None, 2.0, "m", 50.0),)
    scenes = Scene("", (run,), run, {"a.y": "m"}, windows, bounds)
    for picture in (
        percentiles.Picture(kind="percentiles", signal="a.y"),
        lines.Picture(kind="lines", signals=["a.y"]),
        sigma.Picture(kind="sigma", axes=[{"name": "a", "error": "a.y", "sigma": "a.y"}]),
    ):
        made = picture.draw(scenes)
        assert "ended early, at t = 0 s" in made.caption
        assert drawing[-1].axes[0].get_xlim() == (0.0, 99.0)


@pytest.mark.filterwarnings("ignore:overflow")
@pytest.mark.parametrize("last", [2.0**1023, -(2.0**1023), np.finfo(float).max])
def test_a_signal_that_runs_away_up_to_the_last_number_that_there_is_is_drawn(last):
    """Matplotlib cannot draw an axis whose length is no number."""
    values = np.sign(last) * np.minimum(2.0 ** np.arange(924.0, 1024.0), np.abs(last))
    values = np.concatenate([values[:-4], [last, -last, last, np.inf]])
    runs = [{"a.y": values, "a.x": np.ones(100)}, {"a.y": -values, "a.x": np.ones(100)}]
    for picture in (
        lines.Picture(kind="lines", signals=["a.y", "a.x"]),
        percentiles.Picture(kind="percentiles", signal="a.y"),
        sigma.Picture(kind="sigma", axes=[{"name": "a", "error": "a.y", "sigma": "a.x"}]),
        sigma.Picture(kind="sigma", axes=[{"name": "a", "error": "a.x", "sigma": "a.y"}]),
    ):
        for shown in (runs, runs[:1]):
            assert picture.draw(scene(shown)).png.startswith(b"\x89PNG")
