"""Declared differences: 10 degC of one are 10 K, in the FMU, on its page and in all that reads it."""

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from navfmu import NavfmuError, System
from navfmu.export import Bundle, Component, Input, Output, Parameter, State, every
from navfmu.export.build import build
from navfmu.export.description import describe
from navfmu.export.page.documentation import page
from navfmu.export.tracing.lower import lower
from navfmu.fmi.fmu import describe as read
from navfmu.fmi.values import expand, quantity


class Oven(Component):
    """An oven, its temperatures and their differences."""

    outside = Input("K", start=293.15, min=200.0, display_unit="degC", description="temperature outside")
    gradient = Input(2, "K", difference=True, display_unit="degC", description="warmer than outside, by place")
    set_point = Parameter("K", start=453.15, display_unit="degC", description="temperature that is wanted")
    band = Parameter("K", start=2.0, max=5.0, difference=True, display_unit="degC", description="error that is allowed")
    update_period = Parameter("s", start=0.1, min=1e-3, description="period of the control")
    before = State((2, 2), "K", difference=True, description="last errors")
    error = Output("K", difference=True, display_unit="degC", description="temperature minus set point")
    probe = Bundle(warmer=Output("K", difference=True, description="measured difference"), description="a probe")

    @every("update_period")
    def control(self):
        self.error = self.outside - self.set_point + self.gradient[0]
        self.before = np.array([[1.0, 2.0], [3.0, 4.0]]) * self.error
        self.probe.publish(warmer=self.error)


DIFFERENCES = {"gradient[1]", "gradient[2]", "band", "error", "probe.warmer"} | {
    f"before[{i},{j}]" for i in (1, 2) for j in (1, 2)
}


@pytest.fixture(scope="module")
def oven(tmp_path_factory):
    (path,) = build(Oven, tmp_path_factory.mktemp("oven"))
    return path


def test_an_fmu_says_which_of_its_variables_are_differences(oven):
    assert validate_fmu(str(oven)) == []
    assert {v.name for v in read(oven).variables if v.relative} == DIFFERENCES
    assert read(oven).lenient == ()
    assert fmpy.read_model_description(str(oven)).modelVariables


def test_a_limit_and_a_value_in_degrees_have_no_origin(oven):
    about = read(oven)
    assert quantity(about, about.by_name["error"], "0.5 degC", "at_most") == 0.5
    given = expand(about, {"band": "1.5 degC", "gradient": "1 degC", "outside": "20 degC"}, "here")
    assert given == {"band": 1.5, "gradient[1]": 1.0, "gradient[2]": 1.0, "outside": 293.15}
    flight = System.load(oven).run(stop=1.0, step=0.1, parameters={"oven.outside": "180 degC"}, record=["oven.error"])
    assert flight["oven.error"].iloc[-1] == 0.0


def test_the_page_shows_them_without_an_origin():
    text = page(lower(Oven))
    assert "2 (2 degC)" in text and "5 (5 degC)" in text and "453.15 (180 degC)" in text
    assert "error that is allowed (a difference)" in text


def test_nothing_else_says_it():
    class Plain(Component):
        """None."""

        x = Parameter("K", start=1.0, description="a temperature")
        n = State(kind="integer", description="a number")

    assert "relativeQuantity" not in describe(lower(Plain), "g")


@pytest.mark.parametrize("kind", ["integer", "boolean"])
def test_only_a_real_can_be_one(kind):
    with pytest.raises(NavfmuError, match="difference=True is for real variables, which have a unit"):
        Output(kind=kind, difference=True)
