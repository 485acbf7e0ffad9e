"""What a browser draws of a run is what was recorded, and where something happened is where it happened."""

from __future__ import annotations

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.report.panel import Panel
from navfmu.report.pictures import lines, map, percentiles, sigma
from navfmu.report.scene import Bound, Event, Recorded, Scene

TIME = np.arange(101.0)
DEGREE = np.pi / 180


def scene(signals: dict[str, np.ndarray], **more) -> Scene:
    run = Recorded("seed 1", TIME, signals)
    return Scene("", (run,), run, more.pop("units", {}), **more)


def curves(panel: Panel) -> dict[str, object]:
    return {curve.name: curve for curve in panel.curves}


def test_a_signal_and_its_bounds():
    bounds = (
        Bound("R", "a.x", None, 5.0, "m", 10.0, 20.0),
        Bound("S", "a.x", -3.0, None, "m"),
        Bound("T", "b", 0, 1, ""),
    )
    picture = percentiles.Picture(kind="percentiles", signal="a.x")
    (panel,) = picture.panels(scene({"a.x": 1.0 - TIME}, units={"a.x": "m"}, bounds=bounds))
    found = curves(panel)
    assert panel.title == "a.x: -99 to 1 m" and panel.y == "x, m" and list(found) == ["x", "R: 5 m", "S: -3 m"]
    assert np.array_equal(found["x"].y, 1.0 - TIME) and found["x"].peaks
    assert found["R: 5 m"].x.tolist() == [10.0, 20.0] and found["S: -3 m"].x.tolist() == [0.0, 100.0]


def test_errors_stand_in_a_band_of_as_many_sigmas_as_the_system_says():
    axes = [{"name": "north", "error": "a.e", "sigma": "a.s"}]
    picture = sigma.Picture(kind="sigma", axes=axes, factor=2)
    (panel,) = picture.panels(scene({"a.e": np.full(101, 3.0), "a.s": TIME / 10}))
    found = curves(panel)
    assert found["2 sigma claimed"].y == pytest.approx(0.2 * TIME) and found["2 sigma claimed"].look == "band"
    assert f"inside 2 sigma for {100 * np.mean(3.0 <= 0.2 * TIME):.1f} % of 101 points" in panel.title


def test_counters_and_truth_values_are_held_to_the_next_point():
    picture = lines.Picture(kind="lines", signals=["a.x", "a.n", "a.ok"])
    panels = picture.panels(scene({"a.x": TIME, "a.n": TIME.astype(int), "a.ok": TIME > 3}, units={"a.x": "m"}))
    assert [panel.curves[0].look for panel in panels] == ["line", "steps", "steps"]


ELLIPSES = {"north": "n.north", "east": "n.east"}


def drawn_map(**entry) -> tuple[Panel, dict[str, np.ndarray]]:
    """East along the equator, the estimate 1 nmi to the north."""
    metre = 1.0 / map.EARTH
    signals = {
        "a.lat": np.zeros(101), "a.lon": 1852 * metre * TIME, "b.lat": np.full(101, 1852 * metre),
        "b.lon": 1852 * metre * TIME, "n.north": np.full(101, 100.0), "n.east": np.full(101, 200.0),
    }  # fmt: skip
    units = dict.fromkeys(("a.lat", "a.lon", "b.lat", "b.lon"), "rad") | {"n.north": "m", "n.east": "m"}
    events = (Event("fault", "f", 30.0), Event("notice", "seen", 40.0), Event("violation", "R", 50.0))
    picture = map.Picture(kind="map", truth=["a.lat", "a.lon"], estimate=["b.lat", "b.lon"], **entry)
    (panel,) = picture.panels(scene(signals, units=units, events=events))
    return panel, curves(panel)


def test_ellipses_stand_around_the_estimate_with_the_sigmas_that_are_claimed():
    _, found = drawn_map(ellipses=ELLIPSES | {"factor": 2, "count": 5})
    outline = found["2 sigma claimed"]
    parts = np.split(np.stack([outline.x, outline.y]), 5, axis=1)
    for part, time in zip(parts, (0, 25, 50, 75, 100), strict=True):
        east, north = part[:, :-1]
        assert np.isnan(part[:, -1]).all()  # a gap to the next
        middle = found["estimate"].x[time], found["estimate"].y[time]
        away = np.hypot((east - middle[0]) * 1852 / 400, (north - middle[1]) * 1852 / 200)
        assert away == pytest.approx(1.0, abs=1e-9)
        assert np.ptp(east) == pytest.approx(800 / 1852, rel=1e-2) and np.ptp(north) == pytest.approx(
            400 / 1852, rel=1e-2
        )


def test_what_happened_is_marked_on_the_true_track():
    panel, found = drawn_map()
    for name, time, text in (("fault begins", 30, "f"), ("noticed", 40, "seen"), ("first violated", 50, "R")):
        assert found[name].x == pytest.approx([time - 50.0], rel=1e-3) and found[name].y == pytest.approx(
            [0.0], abs=1e-9
        )
        assert found[name].texts == (f"{text}, t = {time} s",)
    assert panel.equal and not panel.timed and "estimate up to 1 nmi off" in panel.title


@pytest.mark.parametrize(
    ("entry", "units", "sentence"),
    [
        ({"ellipses": ELLIPSES}, {}, "'ellipses' stand around an estimate"),
        ({"ellipses": ELLIPSES}, {"n.north": "rad", "n.east": "rad"}, "'n.north' is in rad, expected m"),
        ({"ellipses": ELLIPSES}, {"n.north": "ft"}, "need the same unit"),
    ],
)
def test_ellipses_that_cannot_be_drawn_are_refused(entry, units, sentence):
    picture = map.Picture(kind="map", truth=["a.lat", "a.lon"], **entry)
    with pytest.raises(NavfmuError, match=sentence):
        picture.check({"a.lat": "rad", "a.lon": "rad", "n.north": "m", "n.east": "m"} | units)
