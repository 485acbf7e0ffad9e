"""Phases: conditions that have a name in the report file of a system, for its faults and requirements."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

from navfmu import Fault, System
from navfmu.campaign import load_campaign, run_campaign
from navfmu.errors import NavfmuError
from navfmu.system.experiment import Experiment
from tests.second_system.system import REPORT, pack

PHASES = """
[[phase]]
id = "far"
when = "judge.distance > 25 m and not parked"

[[phase]]
id = "parked"
when = "time < 3"
"""


@pytest.fixture(scope="module")
def rover(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rover")
    (folder / "report.toml").write_text(REPORT.read_text() + PHASES)
    return pack(folder, folder / "report.toml")


def test_a_fault_acts_in_a_phase_that_the_system_has(rover):
    system = System.load(rover)
    record = ["judge.distance", "judge.distance@true"]
    fault = Fault("x", "judge.distance", "bias", value=-1000.0, during="parked")
    frame = system.run(stop=10.0, faults=[fault], record=record)
    acts = frame["judge.distance"] != frame["judge.distance@true"]
    step = frame.index[1]
    assert np.array_equal(acts, (frame.index > 0.5 * step) & (frame.index < 3.0 + 0.5 * step))
    assert frame.attrs["acted"] == {"x": [[step, 3.0 + step]]}


def test_what_a_phase_says_belongs_to_the_key_of_those_who_use_it(rover, tmp_path):
    (tmp_path / "report.toml").write_text(REPORT.read_text() + PHASES.replace("time < 3", "time < 4"))
    other = pack(tmp_path, tmp_path / "report.toml")
    fault = Fault("x", "judge.distance", "bias", value=-1000.0, during="parked")
    one, two = (System.load(file).experiment(stop=10.0, faults=[fault]) for file in (rover, other))
    assert one.key != two.key
    one, two = (System.load(file).experiment(stop=10.0) for file in (rover, other))
    assert one.key == two.key


def test_what_a_phase_says_belongs_to_nobody_else(rover, tmp_path):
    """The phase "far" names "parked", and not the other way. Wrong: whatever asks something is flown anew."""
    (tmp_path / "report.toml").write_text(REPORT.read_text() + PHASES.replace("> 25 m", "> 26 m"))
    other = pack(tmp_path, tmp_path / "report.toml")
    for during, same in (("parked", True), ("far", False), ("not far", False), ("time > 3", True)):
        fault = Fault("x", "judge.distance", "bias", value=-1000.0, during=during)
        one, two = (System.load(file).experiment(stop=10.0, faults=[fault]) for file in (rover, other))
        assert (one.key == two.key) is same, during
        with raises_unless(same, "the system in .* is not what the command was written for"):
            words = one.command().split()
            two.expect(words[words.index("--expect") + 1])
        with raises_unless(same, "its phases are not those that were asked"):
            Experiment.restored(one.describe(), two.system)


def raises_unless(same, sentence):
    return nullcontext() if same else pytest.raises(NavfmuError, match=sentence)


def test_a_campaign_asks_in_a_phase(rover, tmp_path):
    (tmp_path / "c.toml").write_text(f"""
system = "{rover}"
stop = 10.0
record_period = 0.5
[[requirement]]
id = "R"
signal = "judge.distance"
at_most = 0.0
when = "far"
""")
    outcome = run_campaign(load_campaign(tmp_path / "c.toml"), tmp_path / "out", workers="thread")
    (judged,) = outcome.runs
    series = outcome.series(judged, ["judge.distance"])
    far = (series["judge.distance"] > 25.0) & (series["time"] > 3.0 - 1e-9)
    points = judged.answer.observed["R"]["points"]
    assert points == far.sum() > 0


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('[[phase]]\nid = "a b"\nwhen = "time < 3"', "'id' is 'a b', expected letters, digits and '_'"),
        ('[[phase]]\nid = "time"\nwhen = "time < 3"', "and no word that expressions have"),
        ('[[phase]]\nid = "a"\nwhen = "time < 3"\n[[phase]]\nid = "a"\nwhen = "true"', "there are two phases 'a'"),
        (
            '[[phase]]\nid = "a"\nwhen = "judge.distnce < 3"',
            "phase 'a': in 'judge.distnce < 3', character 1: component",
        ),
        ('[[phase]]\nid = "a"\nwhen = "time"', "phase 'a': in 'time', character 1: expected a truth value"),
        ('[[phase]]\nid = "a"\nwhen = "b"\n[[phase]]\nid = "b"\nwhen = "not a"', "is explained by itself"),
        ('[[phase]]\nid = "a"', "line"),
        ('[[phase]]\nid = "a"\nwen = "time < 3"', "unknown entry 'wen'; did you mean 'when'?"),
        ('phase = "a"', "phase"),
    ],
)
def test_a_wrong_phase_is_told_with_its_line(tmp_path, text, sentence):
    content = text + "\n" + REPORT.read_text() if text.startswith("phase") else REPORT.read_text() + text
    (tmp_path / "report.toml").write_text(content)
    system = System.load(pack(tmp_path, tmp_path / "report.toml"))
    fault = Fault("x", "judge.distance", "bias", value=1.0, during="a")
    for ask in (lambda: system.run(stop=1.0, faults=[fault]), lambda: system.report):
        with pytest.raises(NavfmuError) as caught:
            ask()
        assert sentence in str(caught.value) and "report.toml, line" in str(caught.value)


def test_a_name_that_is_no_phase_is_told_with_the_nearest_one(rover):
    fault = Fault("x", "judge.distance", "bias", value=1.0, during="parkd")
    with pytest.raises(NavfmuError, match="there is no signal 'parkd'; did you mean 'parked'"):
        System.load(rover).run(stop=1.0, faults=[fault])
