"""The page in each FMU: self-contained, every variable in it, with a picture of a response."""

import base64
import html
import re
import zipfile

import numpy as np
import pytest

from fmus.attitude.ahrs import Ahrs
from navfmu import NavfmuError
from navfmu.export import Bundle, Component, Example, Input, Output, Parameter, every, on_new, toolchain
from navfmu.export.build import build, library, prepare
from navfmu.export.page.documentation import page
from navfmu.export.page.picture import panels, picture
from navfmu.export.page.response import Response, step_response
from navfmu.export.tracing.lower import lower
from tests import built

from .components import Planned, Searcher, Sensor, Source, TwoRates


def read(path):
    with zipfile.ZipFile(path) as archive:
        return archive.read("documentation/index.html").decode()


@pytest.mark.parametrize("name", sorted(built.components()))
def test_every_page_names_every_variable_and_needs_nothing_else(name, tmp_path_factory):
    text = read(built.fmu(name, tmp_path_factory))
    shown = html.unescape(text)
    for field in built.components()[name].layout.fields:
        assert field in shown, field
    assert not re.search(r'(?:src|href)="(?!data:)', text)
    png = base64.b64decode(re.search(r'src="data:image/png;base64,([^"]+)"', text)[1])
    assert png.startswith(b"\x89PNG")
    assert len(png) > 5000


def test_the_page_tells_ranges_equations_and_requirements(tmp_path):
    (path,) = build(Sensor, tmp_path)
    text = read(path)
    assert "Its reading is s = u + b + w" in text
    assert "sigma {sigma} m must be below a tenth of gain {gain}" in text
    assert "<td><code>sigma</code></td><td>m</td><td>0.1</td><td>0 … 10</td>" in text
    assert "every <code>sample_period</code> (0.1 s unless set)" in text
    assert "(tunable)" in text


def test_the_page_tells_what_tables_hold_how_they_are_searched_and_who_names_them():
    rows = re.findall(r"<tr><td><code>resources/.*?</tr>", page(lower(Planned)), re.DOTALL)
    told = [" ".join(html.unescape(re.sub(r"<[^>]*>", " ", row)).split()) for row in rows]
    assert told == [
        "resources/plan.npy or the file that plan_file names 2 rows time (s), x (m) time",
        "resources/field.npy or the file that field_file names 2 x 2 x (m), y (m), z (m) x and y",
        "resources/own.npy 2 rows time (s), x (m) time",
    ]
    (row,) = re.findall(r"<tr><td><code>resources/profile.*?</tr>", page(lower(Searcher)), re.DOTALL)
    assert "x or index" in row


def test_text_is_escaped():
    model = lower(TwoRates)
    text = page(type(model)(**{**vars(model), "description": "a <script> & more"}))
    assert "a &lt;script&gt; &amp; more" in text


def run(component, example=None):
    sources = prepare(lower(component))
    return step_response(sources.model, sources.guid, library(sources, toolchain.host()), example)


def test_inputs_step_at_a_fifth_of_the_time():
    response = run(TwoRates)
    model = lower(TwoRates)
    column = [model.elements[i].name for i in response.indices].index("sampled")
    sampled = response.values[:, column]
    assert set(sampled[response.time <= response.onset]) == {0.0}
    assert set(sampled[response.time >= response.onset + 0.2]) == {100.0}
    assert np.all(np.diff(response.time) > 0)


def test_the_example_of_a_component_sets_where_it_starts_and_what_steps():
    response = run(TwoRates, Example({"u": 5.0, "fast": 0.5}, steps={"u": -2.0}))
    model = lower(TwoRates)
    column = [model.elements[i].name for i in response.indices].index("sampled")
    assert response.values[-1, column] == 3.0
    with pytest.raises(NavfmuError, match=r"its example sets 'v', which is no input or parameter"):
        run(TwoRates, Example({"v": 1.0}))


def test_an_example_may_move_its_inputs_choose_outputs_and_add_curves():
    example = Example(
        {"fast": 0.5},
        text="A ramp.",
        duration=20.0,
        step=0.5,
        mark=3.0,
        inputs=lambda time: {"u": 2.0 * time},
        shows=("sampled",),
        panels=lambda outputs: {"twice (m)": {"curve": 2.0 * outputs["sampled"], "~truth": outputs["time"]}},
    )
    response = run(TwoRates, example)
    model = lower(TwoRates)
    assert [model.elements[i].name for i in response.indices] == ["sampled"]
    assert response.values[10:, 0] == pytest.approx(2.0 * response.time[10:])  # not one step late
    assert (response.onset, response.stepped) == (3.0, {})
    assert np.array_equal(response.panels["twice (m)"]["curve"], 2.0 * response.values[:, 0])
    text = page(model, response)
    assert "A ramp." in text
    assert "20 s with <code>fast = 0.5 s</code> and otherwise the start values." in text
    with pytest.raises(NavfmuError, match=r"its example shows 'sample', which is no output.*'sampled'"):
        run(TwoRates, Example(shows=("sample",)))


class Marked(Component):
    """Shows what is valid, and which parts of it are marked."""

    interval = Parameter("s", start=1.0, min=0.1)
    told = Bundle(x=Input("m"), wrong=Input(2, kind="boolean"), right=Input(kind="boolean", start=True))
    marks = Output(4, "1")
    tick = "interval"

    @on_new("told")
    def show(self):
        marks = np.stack([self.told.valid, self.told.wrong[0], self.told.wrong[1], self.told.right])
        self.marks = np.where(marks, 1.0, 0.0)


def test_data_that_comes_is_valid_and_otherwise_as_it_is_at_the_start():
    """All switches of a bundle were on: what is tracked, what is corrected."""
    assert run(Marked).values[-1].tolist() == [1.0, 0.0, 0.0, 1.0]
    moved = Example(inputs=lambda time: {"told.wrong": np.tile([False, True], (len(time), 1))})
    assert run(Marked, moved).values[-1].tolist() == [1.0, 0.0, 1.0, 1.0]
    assert run(Marked, Example({"told.wrong": [True, False]})).values[-1].tolist() == [1.0, 1.0, 0.0, 1.0]


def test_an_output_is_not_drawn_before_its_first_data():
    response = run(Sensor, Example(duration=5.0))
    assert np.isnan(response.values[0]).any()
    assert np.isfinite(response.values[-1]).all()


def test_the_page_of_a_python_twin_says_that_it_needs_python():
    model = lower(TwoRates)
    assert "needs a Python 3" in page(model, twin=True)
    assert "Python" not in page(model).replace("Philox", "")


@pytest.mark.parametrize("name", sorted(built.components()))
def test_every_shipped_component_says_what_its_picture_shows(name):
    assert len(built.components()[name].example.text) > 40


def test_the_example_of_the_ahrs_follows_the_truth_as_its_page_says():
    """A field of Livermore and a position on the equator were drawn as an error of 17 degrees below the sentence that
    the angles follow the truth."""
    panels = dict(run(Ahrs, Ahrs.example).panels)
    (error,) = [curves for title, curves in panels.items() if title.startswith("error of the angles")]
    for name, values in error.items():
        assert np.nanmax(np.abs(values[len(values) // 2 :])) < 3.0, name


def test_a_response_that_runs_away_is_drawn():
    """Matplotlib cannot draw an axis whose length is no number."""
    model, time = lower(Source), np.arange(4.0)
    index = next(v.index for v in model.variables if v.name == "x")
    values = np.array([[0.0], [1.7e308], [-1.7e308], [np.inf]])
    response = Response(time, [index], values, None, {}, [], Example(), {})
    assert picture(model, response).startswith(b"\x89PNG")


class Covariant(Component):
    """A covariance of 24 states, and a quotient."""

    interval = Parameter("s", start=1.0, min=0.1)
    covariance = Output((24, 24), "m", start=np.diag(np.arange(24.0)))
    weight = Output(12, "1")
    quotient = Output("1")

    @every("interval")
    def run(self):
        self.quotient = 0.0 * self.weight[0] / self.weight[0]


def test_of_a_large_array_as_many_curves_are_drawn_as_there_are_colours():
    """A legend of 576 covariances covered the picture, and took half a minute to place."""
    response = run(Covariant)
    shown = panels(lower(Covariant), response)
    assert list(shown) == ["covariance (m), 10 of 576", "weight, 10 of 12", "quotient"]
    assert list(shown["covariance (m), 10 of 576"]) == [f"[{i},{i}]" for i in range(1, 11)]
    assert [curve[-1] for curve in shown["covariance (m), 10 of 576"].values()] == list(range(10))
    assert list(shown["weight, 10 of 12"]) == [f"[{i}]" for i in range(1, 11)]


def test_the_page_says_which_curve_ends_without_a_value():
    """0 / 0 left an empty pair of axes and no word."""
    text = page(lower(Covariant), run(Covariant))
    assert "Without a finite value at the end: <code>quotient</code>." in text
    assert "Without a finite value" not in page(lower(TwoRates), run(TwoRates))
