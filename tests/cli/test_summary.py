"""What ``navfmu run`` says of a recording: no mean of what has none, nothing skipped, units as people read them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from click.testing import CliRunner

from navfmu.cli.main import main
from navfmu.export import Bundle, Component, Output, Parameter, every
from navfmu.export.build import build


class Sampler(Component):
    """One output of every kind."""

    heading = Output("rad", display_unit="deg", description="turns through north")
    drift = Output("rad", description="an angle without a display unit")
    speed = Output("m/s", display_unit="kn", description="grows")
    broken = Output("m", description="not a number after a second")
    plain = Output("m", description="falls")
    flag = Output(kind="boolean", description="true for a quarter of the time")
    count = Bundle(y=Output("m", description="a value"), description="counts")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="period")

    @every("sample_period")
    def step(self):
        self.heading = 2.0 * np.pi * np.where(self.time < 2.0, 359.0, 1.0) / 360.0
        self.drift = 0.25 + 0.0 * self.time
        self.speed = 1852.0 / 3600.0 * self.time
        self.broken = np.sqrt(1.0 - self.time)
        self.plain = 100.0 - self.time
        self.flag = self.time >= 3.0
        self.count.publish(y=self.time, valid=True)


@pytest.fixture(scope="module")
def lines(tmp_path_factory):
    (file,) = build([Sampler], tmp_path_factory.mktemp("sampler"))
    run = CliRunner().invoke(main, ["run", str(file), "--stop", "4", "--step", "0.1"])
    assert run.exit_code == 0, run.output
    words = (re.split(r"  +", line.strip()) for line in run.output.splitlines())
    return {row[0].removeprefix("sampler."): row[1:] for row in words}


def test_an_angle_has_no_mean_and_is_shown_in_its_display_unit(lines):
    """The mean of 359 and 1 degrees is not 180."""
    assert lines["heading"] == ["deg", "0", "0", "-", "359", "1", "0 of 41"]
    assert lines["drift"] == ["rad", "0", "0", "-", "0.25", "0.25", "0 of 41"]


def test_other_values_keep_their_mean_in_their_display_unit(lines):
    assert lines["speed"] == ["kn", "0", "0", "2", "4", "4", "0 of 41"]
    assert lines["plain"][0] == "m" and float(lines["plain"][3]) == pytest.approx((0 + sum(
        100.0 - 0.1 * k for k in range(1, 41))) / 41, abs=1e-3)  # fmt: skip


def test_nan_is_counted_and_takes_the_mean_away(lines):
    """pandas skips NaN: the mean of the first second once stood for the whole run."""
    unit, _, least, mean, _, last, missing = lines["broken"]
    assert (unit, least, mean, last, missing) == ("m", "0", "-", "nan", "30 of 41")


def test_a_counter_has_first_least_greatest_and_last_but_no_mean(lines):
    assert lines["count.sequence"] == ["0", "0", "40", "40"]


def test_a_boolean_has_its_share_of_time_and_its_changes(lines):
    assert lines["flag"] == ["false", "true", "25.0", "1"]
    assert lines["count.valid"] == ["false", "true", "97.5", "1"]
