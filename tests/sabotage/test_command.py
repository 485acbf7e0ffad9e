"""``navfmu sabotage``: what it writes and says, and what it refuses."""

from __future__ import annotations

import re
import zipfile

import pytest
from click.testing import CliRunner

from navfmu import Fault, System
from navfmu.cli.main import main
from navfmu.export import Component, Input, Output, Parameter, every
from navfmu.export.build import build
from navfmu.faults.file import parse_faults
from navfmu.ssp.writer import SystemSource
from tests.components import systems

BIAS = 'id = "b", target = "truth.y", type = "bias", start = 2, value = 1.0'


def navfmu(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], env={"COLUMNS": "100"})


def refused(result, *sentences):
    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    assert isinstance(result.exception, SystemExit) and "Traceback" not in result.output
    for sentence in sentences:
        assert sentence in " ".join(result.stderr.split())


def test_it_writes_a_package_that_runs_and_says_what_is_in_it(tmp_path):
    out = tmp_path / "it.ssp"
    done = navfmu("sabotage", systems.tracker(), "stuck", "--fault", BIAS, "--seed", 7, "--out", out)
    assert done.exit_code == 0, done.output
    assert re.search(r"truth_saboteur\s+b\s+y\n", done.stdout)
    assert re.search(r"sensor_saboteur\s+F1\s+reading\.length,", done.stdout)
    assert f"wrote {out}" in done.stdout
    with zipfile.ZipFile(out) as package:
        text = package.read("extra/saboteurs.toml").decode()
    assert text.startswith("# Built into the saboteurs of this package, for step 0.1 s, seed 7.\n")
    assert [fault.id for fault in parse_faults(text)] == ["F1", "b"]
    system = System.load(out)
    assert (system.structure.step, system.structure.stop_time) == (0.1, 20.0)
    assert system.structure.description == "a length is measured Saboteurs do what these faults do: b, F1."
    assert list(system.fmus) == ["truth", "truth_saboteur", "lag", "sensor", "sensor_saboteur", "estimator"]
    assert navfmu("run", out, "--algorithm", "jacobi", "--out", tmp_path / "it.parquet").exit_code == 0
    assert navfmu("info", out).exit_code == 0


def test_the_same_gives_the_same_bytes(tmp_path):
    for name in ("one.ssp", "two.ssp"):
        assert navfmu("sabotage", systems.tracker(), "stuck", "--out", tmp_path / name).exit_code == 0
    assert (tmp_path / "one.ssp").read_bytes() == (tmp_path / "two.ssp").read_bytes()


def test_parameters_of_the_experiment_are_built_in(tmp_path):
    out = tmp_path / "it.ssp"
    done = navfmu("sabotage", systems.tracker(), "stuck", "--variant", "slow", "--set", "lag.tau=3 s", "--out", out)
    assert done.exit_code == 0, done.output
    system = System.load(out)
    assert system.value("lag.tau") == 3.0 and system.value("estimator.gain") == 0.01


REFUSED = {
    "no fault": ((), "there is no fault to build in"),
    "a step": (
        ("--fault", 'id = "F", target = "sensor", type = "lost_step", start = 1, duration = 1'),
        "fault 'F': a step of a component is lost by its master; a saboteur sees values only",
    ),
    "a condition": (
        ("--fault", BIAS.replace("start = 2", 'when = "lag.y > 1 m"')),
        "fault 'b': it waits for a condition, and a saboteur does not see the signals that are asked for",
    ),
    "a file that is not there": (("nothing.toml",), "there is no file 'nothing.toml'"),
    "a step size of nothing": (("stuck", "--step", "0"), "must be a positive number of seconds"),
    "an unknown platform": (
        ("stuck", "--platforms", "linux46"),
        "unknown platform 'linux46'",
        "did you mean 'linux64'",
    ),
    "another system": (("stuck", "--expect", "123"), "--expect 123"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_is_a_sentence(tmp_path, name):
    arguments, *sentences = REFUSED[name]
    refused(navfmu("sabotage", systems.tracker(), *arguments, "--out", tmp_path / "it.ssp"), *sentences)
    assert list(tmp_path.iterdir()) == []


def test_the_package_has_the_ending_of_one(tmp_path):
    refused(navfmu("sabotage", systems.tracker(), "stuck", "--out", tmp_path / "it.fmu"), "expected .ssp")


def test_a_fault_that_cannot_act_is_a_note(tmp_path):
    late = BIAS.replace("start = 2", "start = 90")
    done = navfmu("sabotage", systems.tracker(), "--fault", late, "--out", tmp_path / "it.ssp")
    assert done.exit_code == 0
    assert "fault 'b' starts at 90 s, the run ends at 20 s: it cannot act" in " ".join(done.stderr.split())


TUNABLE = 'id = "F", target = "it.gain", type = "parameter", start = 1, value = 2.0'


class Gain(Component):
    """Multiplies."""

    u = Input("m", description="input")
    y = Output("m", description="gain * u")
    gain = Parameter("1", start=1.0, tunable=True, description="gain")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="time between values")

    @every("sample_period")
    def step(self):
        self.y = self.gain * self.u


@pytest.fixture(scope="module")
def gains(tmp_path_factory):
    """Two in a row."""
    folder = tmp_path_factory.mktemp("gains")
    build([Gain], folder, pictures=False)
    source = SystemSource("gains", fmus=folder, stop_time=2.0, step=0.1)
    source.component("it", "gain.fmu").component("next", "gain.fmu").connect("it.y", "next.u")
    return source


def test_a_parameter_has_no_connection(gains, tmp_path):
    system = gains.pack(tmp_path / "gains.ssp")
    sentence = "fault 'F': 'it.gain' is a parameter, which no connection leads to"
    refused(navfmu("sabotage", system, "--fault", TUNABLE, "--out", tmp_path / "it.ssp"), sentence)


def test_a_conversion_on_the_way_is_done_in_the_saboteur_or_refused(gains, tmp_path):
    """What goes to one receiver has its unit; elsewhere not every master knows conversions."""
    gains.write(tmp_path / "gains")
    ssd = tmp_path / "gains" / "SystemStructure.ssd"
    text = ssd.read_text()
    twice = '><ssc:LinearTransformation factor="2"/></ssd:Connection>'
    changed, count = re.subn(r"(<ssd:Connection start[^>]*)/>", rf"\1{twice}", text)
    assert count == 1
    ssd.write_text(changed)
    out = tmp_path / "it.ssp"
    bias = 'id = "F", target = "it.y", type = "bias", start = 0.5, value = 1.0'
    sentence = "connection it.y -> next.u: converts what it carries, which not every master can"
    refused(navfmu("sabotage", tmp_path / "gains", "--fault", bias, "--out", out), sentence)
    assert not out.exists()
    done = navfmu("sabotage", tmp_path / "gains", "--fault", bias.replace("it.y", "next.u"), "--out", out)
    assert done.exit_code == 0, done.output
    given = {"algorithm": "jacobi", "parameters": {"it.u": 3.0}, "record": ["next.y"], "record_period": 0.1}
    late = Fault("late", "next.u", "delay", delay=0.1)
    fault = Fault("F", "next.u", "bias", 0.5, value=1.0)
    expected = System.load(tmp_path / "gains").run(faults=[late, fault], **given)
    assert System.load(out).run(**given).equals(expected) and expected["next.y"].iloc[-1] == 7.0
