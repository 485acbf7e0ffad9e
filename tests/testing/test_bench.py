"""What a test can do to a system: faults, parameters, marks, and what is refused in a sentence."""

from __future__ import annotations

import re

import pytest

GOOD = """
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest

from navfmu import Fault, System

HERE = Path(__file__).parent


def test_the_answer_is_that_of_system_run(system):
    with system("tracker.ssp", variant="slow") as s:
        r = s.run(5, seed=3)
    assert type(r) is pandas.DataFrame
    other = System.load(HERE / "tracker.ssp", variant="slow").run(stop=5, seed=3)
    pandas.testing.assert_frame_equal(r, other, check_exact=True)


def test_an_unconnected_input_gets_its_value_and_a_lag_answers_with_the_closed_form(system):
    with system("tracker.ssp", step=0.1) as s:
        s.parameters["truth.amplitude"] = 0.0
        s.fault("lag.bias", at=1.0, duration="2 s", value=1.0)
        r = s.run(5)
    steps = np.round(r.index / 0.1).astype(int)
    rise = 1 - 0.9 ** np.clip(steps - 10, 0, 20)
    fall = np.where(steps > 30, 0.9 ** (steps - 30.0), 1.0)
    np.testing.assert_allclose(r["lag.y"], rise * fall, atol=1e-12)


def test_a_bundle_drops_out(system):
    with system("tracker.ssp") as s:
        s.fault("sensor.reading", at=2, duration=1)
        r = s.run(5)
    away = (r.index >= 2 - 1e-9) & (r.index < 3 - 1e-9)
    assert not r["sensor.reading.valid"][away].any() and r["sensor.reading.valid"][~away][1:].all()


def test_one_receiver_of_a_bundle_loses_it(system):
    with system("tracker.ssp") as s:
        s.fault("estimator.reading", at=2, duration=1)
        r = s.run(5)
    assert r["sensor.reading.valid"][1:].all()
    away = (r.index >= 2.15) & (r.index < 2.95)
    assert r["estimator.solution.length"][away].nunique() == 1 and r["estimator.solution.length"].nunique() > 30


def test_one_receiver_of_a_signal_gets_another(system):
    with system("tracker.ssp") as s:
        s.fault("lag.u", "scale", factor=0)
        r = s.run(5)
    assert (r["lag.y"] == 0.0).all() and r["truth.y"].abs().max() > 5


def test_a_component_loses_steps(system):
    with system("tracker.ssp") as s:
        s.fault("lag", "lost_step", at=3, duration=1)
        r = s.run(5)
    assert r["lag.y"][3.05:3.95].nunique() == 1 < r["lag.y"][4.05:].nunique()


def test_types_of_a_fault_file_and_its_entries(system):
    with system("tracker.ssp") as s:
        s.fault("sensor.reading.length", "bias", at=2, value="1 ft", id="B", fmea="F1")
        biased = s.run(5, seed=1)
    with system("tracker.ssp") as s:
        plain = s.run(5, seed=1)
    apart = (biased - plain.astype(float))["sensor.reading.length"]
    np.testing.assert_allclose(apart, np.where(plain.index >= 2 - 1e-9, 0.3048, 0.0), atol=1e-12)


def test_several_faults_on_one_target_have_different_names(system):
    with system("tracker.ssp") as s:
        one = s.fault("lag.bias", at=1, duration=1, value=1.0)
        two = s.fault("lag.bias", at=3, duration=1, value=1.0)
        assert one.id == "lag.bias" != two.id
        s.run(5)


def test_files_of_faults(system):
    (HERE / "mine.toml").write_text('[[fault]]\\nid = "F"\\ntarget = "lag.bias"\\ntype = "input"\\nvalue = 1.0\\n')
    with system("tracker.ssp") as s:
        s.faults("stuck", "mine.toml", Fault("G", "sensor.reading.length", "bias", start=12, value=1.0))
        r = s.run(15)
    assert [fault["id"] for fault in r.attrs["provenance"]["faults"]] == ["F1", "F", "G"]
    assert (r["sensor.reading.length"][(r.index > 5.05) & (r.index < 9.95)] == 3.0).all()


def test_arguments_of_a_run_are_laid_over_those_of_the_system(system):
    with system("tracker.ssp", seed=5, step=0.2, parameters={"lag.y0": 2.0}) as s:
        one, two = s.run(2), s.run(1, seed=6, record=["lag"])
    about = [r.attrs["provenance"] for r in (one, two)]
    assert [(a["seed"], a["step"], a["stop"]) for a in about] == [(5, 0.2, 2.0), (6, 0.2, 1.0)]
    assert list(two) == ["lag.y"] and one["lag.y"].iloc[0] == 2.0


def test_what_is_required_is_recorded(system):
    with system("tracker.ssp") as s:
        s.require("estimator.sigma", at_most=10)
        assert list(s.run(1, record=["lag.y"])) == ["lag.y", "estimator.sigma"]


def test_main_is_the_name_of_the_main_variant(system):
    with system("tracker.ssp", variant="main") as s:
        assert s.run(1).attrs["provenance"]["variant"] is None


def test_a_single_fmu_and_a_whole_path(system):
    with system(HERE / "probe.fmu", step=0.1) as s:
        s.require("probe.y", at_most=1.0)
        s.run(1)


def test_without_with(system):
    s = system("tracker.ssp")
    s.fault("lag.bias", value=1.0)
    s.run(1)


@pytest.mark.seeds("2-3,7")
def test_seeds(system):
    with system("tracker.ssp") as s:
        print("SEED", s.run(1).attrs["provenance"]["seed"])


@pytest.mark.seeds(4, 5)
@pytest.mark.algorithm("jacobi", "gauss_seidel")
@pytest.mark.step(0.1, "200 ms")
def test_all(system):
    with system("tracker.ssp") as s:
        about = s.run(1).attrs["provenance"]
    print("ALL", about["seed"], about["algorithm"], about["step"])


@pytest.fixture
def flown(system):
    with system("tracker.ssp") as s:
        return s.run(1)


@pytest.mark.seeds(8)
def test_marks_reach_fixtures(flown):
    assert flown.attrs["provenance"]["seed"] == 8


@pytest.mark.seeds("3")
def test_the_same_seed_twice_is_no_contradiction(system):
    with system("tracker.ssp") as s:
        s.run(1, seed=3)


def test_what_a_test_wants_may_be(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", value=0.0, at=1)
        s.run(2, allow="idle")
    with system("probe.fmu", step=0.1, parameters={"probe.tau": 0.0}) as s:
        s.run(1, allow=["idle", "not_finite"])
    with system("stepper.fmu", step=0.1, parameters={"stepper.u": 1.0, "stepper.ends_at": 0.5}) as s:
        assert len(s.run(1, allow="early_end")) == 6
"""

BAD = """
import pytest

def test_component(system):
    with system("tracker.ssp") as s:
        s.fault("lagg.bias", at=1)

def test_variable(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bais", at=1)

def test_whole(system):
    with system("tracker.ssp") as s:
        s.fault("lag", at=1)

def test_output(system):
    with system("tracker.ssp") as s:
        s.fault("lag.y", at=1)

def test_connected(system):
    with system("tracker.ssp") as s:
        s.fault("lag.u", at=1)

def test_fixed(system):
    with system("tracker.ssp") as s:
        s.fault("lag.y0", value=1)

def test_explicit_typo(system):
    with system("tracker.ssp") as s:
        s.fault("lag.z", "bias", value=1)

def test_different(system):
    with system("tracker.ssp") as s:
        s.fault(["lag.bias", "sensor.reading"])

def test_start(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", start=3, value=1)

def test_entry(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", vale=1)

def test_system(system):
    system("trakcer.ssp")

def test_shipped(system):
    system("nothing_of_that_name")

def test_variant(system):
    system("tracker.ssp", variant="slwo")

def test_argument(system):
    system("tracker.ssp", sed=3)

def test_argument_of_run(system):
    system("tracker.ssp").run(1, algoritm="jacobi")

def test_faults_of_run(system):
    system("tracker.ssp").run(1, faults="stuck")

def test_parameter(system):
    with system("tracker.ssp") as s:
        s.parameters["lag.tua"] = 2
        s.run(1)

def test_signal(system):
    with system("tracker.ssp") as s:
        s.require("lag.yy", at_most=1)

def test_bound(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_mots=1)

def test_unit(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most="1 s")

def test_quantile(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=1, quantile=0.5)

def test_window(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=1, from_=5, to=6)
        s.run(3)

def test_detects(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", at=1, value=1.0, id="push")
        s.require(detects="lag.y > 1", within="1 s", fault="psuh")
        s.run(3)

def test_never_flown(system):
    with system("tracker.ssp") as s:
        s.run(1)
        s.fault("lag.bias", value=1.0)

def test_never_asked(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=1, id="R")

def test_cannot_act(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", value=1.0, at=10)
        s.run(5)

def test_changes_nothing(system):
    with system("tracker.ssp") as s:
        s.fault("lag.y", "bias", value=1e-300, at=2)
        s.run(5)

def test_nan(system):
    with system("probe.fmu", step=0.1, parameters={"probe.tau": 0.0}) as s:
        s.run(1)

def test_ended(system):
    with system("stepper.fmu", step=0.1, parameters={"stepper.u": 1.0, "stepper.ends_at": 0.5}) as s:
        s.run(1)

def test_refused(system):
    with system("probe.fmu", step=0.1, parameters={"probe.fail_status": 3, "probe.fail_at": 0.5}) as s:
        s.run(1)

def test_allow(system):
    system("tracker.ssp").run(1, allow="idel")

@pytest.mark.seeds("1-2")
def test_contradiction(system):
    with system("tracker.ssp", seed=2) as s:
        s.run(1)

@pytest.mark.algorithm("jacoby")
def test_algorithm(system):
    system("tracker.ssp").run(1)

def test_expected(system):
    with system("tracker.ssp") as s:
        s.require("lag.y", at_most=1e6, expect="violated", id="X")
        s.run(1)

def test_of_their_own(system):
    with system("tracker.ssp") as s:
        s.fault("lag.bias", value=1.0)
        raise KeyError("mine")

def test_that_fails_first(system):
    s = system("tracker.ssp")
    s.fault("lag.bias", value=1.0)
    assert False

def test_without_with(system):
    s = system("tracker.ssp")
    s.fault("lag.bias", value=1.0)
"""

SENTENCES = {
    "component": "there is no component 'lagg'; did you mean 'lag'?",
    "variable": "fault('lag.bais'): component 'lag' has no variable 'bais'; did you mean 'bias'?",
    "whole": "fault('lag'): it is a component; say what happens to it",
    "output": "fault('lag.y'): it is an output; say what happens to it",
    "connected": "fault('lag.u'): it is an input, connected to 'truth.y'",
    "fixed": "fault('lag.y0'): a fixed parameter keeps its value during a run; give it another from the start: ",
    "explicit_typo": "component 'lag' has no variable 'z'",
    "different": "these targets fail in different ways ('lag.bias': input, 'sensor.reading': dropout); give one type",
    "start": "the start of a fault is at=3 here",
    "entry": "'vale'; did you mean 'value'?",
    "system": "trakcer.ssp: no such file",
    "shipped": "no shipped system named 'nothing_of_that_name'",
    "variant": "did you mean 'slow'?",
    "argument": "an experiment has no 'sed'; did you mean 'seed'?",
    "argument_of_run": "did you mean 'algorithm'?",
    "faults_of_run": "'faults' are given with s.fault and s.faults here",
    "parameter": "did you mean 'tau'?",
    "signal": "has no variable 'yy'",
    "bound": "require('lag.y'): unknown entry 'at_mots'; did you mean 'at_most'?",
    "unit": "'s'",
    "quantile": "require('lag.y'): 'quantile' is about many runs, and this is one; 'percent' is",
    "window": "was asked at no point of the run",
    "detects": "the run has no fault 'psuh'; did you mean 'push'? (faults: push)",
    "never_flown": "fault 'lag.bias': no run came after it, so nothing was tested; call s.run",
    "never_asked": "requirement R (lag.y <= 1 m always): no run came after it",
    "cannot_act": "fault 'lag.bias' starts",
    "changes_nothing": "fault 'lag.y' changed nothing",
    "nan": "'probe.y' is not finite at 10 of 11 recorded points (allow='not_finite')",
    "ended": "an FMU ended the run early: the last recorded point is at t = 0.5 s, 1 s were asked for",
    "refused": "component 'probe': probe gave up at 0.5 s after 42 (fmi2DoStep returned Error at t = 0.4 s)",
    "allow": "allow: there is no 'idel'; did you mean 'idle'?",
    "contradiction[seed1]": "the seed is 2 here, and 1 by the test's mark 'seeds'; leave one out",
    "algorithm[jacoby]": "unknown algorithm 'jacoby'; did you mean 'jacobi'?",
    "expected": "requirement X (VIOLATED as expected: lag.y <= 1e+06 m always) is held, where it should be violated",
}


def test_what_passes(folder):
    ended = folder.pytest(GOOD, "-rP", cwd=folder.path.parent)
    count = GOOD.count("\ndef test_") + 2 + 7  # three seeds, and eight settings
    assert ended.code == 0 and ended.counts == {"passed": count}, ended.out
    assert re.findall(r"^SEED (\d)$", ended.out, re.M) == ["2", "3", "7"]
    every = {(s, a, h) for s in "45" for a in ("jacobi", "gauss_seidel") for h in ("0.1", "0.2")}
    assert set(re.findall(r"^ALL (\d) (\w+) ([\d.]+)$", ended.out, re.M)) == every
    assert "test_all[seed4-jacobi-step200ms]" in ended.out


@pytest.fixture(scope="module")
def refused(tmp_path_factory):
    from tests.testing.inner import Folder

    return Folder(tmp_path_factory.mktemp("bad") / "a folder").pytest(BAD, "-p", "xdist", "-n", "2")


def test_every_mistake_fails_once(refused):
    """Seed 2 is no contradiction; what is never run is found after a test without ``with``, unless that has failed."""
    count = BAD.count("\ndef test_")
    assert refused.counts == {"failed": count - 1, "passed": 2, "error": 1}, refused.out
    assert "fault 'lag.bias': no run came after it" in refused.of("test_without_with")
    assert "plugin.py" not in refused.out


@pytest.mark.parametrize("test", SENTENCES)
def test_a_mistake_is_a_sentence_at_the_line_of_the_test(test, refused):
    told = refused.of(f"test_{test}")
    errors = re.findall(r"^E +(.*)$", told, re.M)
    assert SENTENCES[test] in " ".join(errors), told
    assert re.search(r"^>.*(system|s\.|with)", told, re.M)
    assert not re.search(r"^\S*navfmu\S*\.py:\d+", told, re.M) and "Traceback" not in told


def test_what_an_fmu_had_done_before_it_refused_is_kept(refused):
    from navfmu.system import result

    assert len(result.read(refused.row("test_refused", "recording"))) == 5  # the step from 0.4 s was refused


def test_an_exception_of_the_test_itself_is_not_covered_up(refused):
    told = refused.of("test_of_their_own")
    assert "KeyError: 'mine'" in told and "no run came after it" not in told


@pytest.mark.parametrize(
    ("mark", "sentence"),
    [
        ('seeds("1-x")', "the mark 'seeds': '1-x' is not a seed"),
        ("seeds()", "the mark 'seeds': no seeds are given"),
        ("seeds(1, 1)", "the mark 'seeds': a seed is given twice"),
        ("step()", "the mark 'step' says nothing; expected, for example, step("),
    ],
)
def test_a_wrong_mark_is_a_sentence(mark, sentence, folder):
    ended = folder.pytest(f"import pytest\n\n@pytest.mark.{mark}\ndef test_it(system):\n    pass\n")
    assert sentence in ended.out and "Traceback" not in ended.out and ended.counts == {"error": 1}, ended.out


def test_marks_are_known_and_the_option_explains_itself(folder):
    ended = folder.pytest(
        "import pytest\n\n@pytest.mark.seeds('1')\ndef test_it(system):\n    pass\n", "--strict-markers"
    )
    assert ended.code == 0, ended.out
    assert "--navfmu-artifacts=DIR" in folder.pytest("", "--help").out
    assert '@pytest.mark.seeds("1-5"): run the test with each of these seeds' in folder.pytest("", "--markers").out


def test_a_warning_of_a_run_is_one_of_the_test(folder):
    text = """
        def test_it(system):
            with system("tracker.ssp", step=0.3) as s:
                s.run(3)
        """
    shown = folder.pytest(text)
    assert re.search(r"test_it\.py:4: NavfmuWarning: .* were lost", shown.out), shown.out
    ended = folder.pytest(text, "-W", "error")
    assert ended.counts == {"failed": 1} and "bench.py" not in ended.out


def test_a_fault_that_a_requirement_asks_of_and_the_run_has_not_is_a_warning(folder):
    """Wrong: it never acts, and a requirement on it holds without a word."""
    shown = folder.pytest("""
        def test_it(system):
            with system("tracker.ssp") as s:
                s.fault("lag.bias", at=1, value=1.0, id="push")
                s.require(events="active(push) and lag.y > 1e6", id="KNOWN")
                s.require(events="active(psuh)", id="TYPO")
                s.require("lag.y", at_most=1e6, when="not active(shove)", id="ELSE")
                s.run(3)
    """)
    assert shown.code == 0 and "KNOWN" not in shown.out, shown.out
    for id, fault, hint in (("TYPO", "psuh", "; did you mean 'push'?"), ("ELSE", "shove", "")):
        sentence = (
            rf"test_it\.py:\d+: NavfmuWarning: requirement {id} .* asks whether fault '{fault}' acts, and the run "
        )
        assert re.search(rf"{sentence}has none of that name{re.escape(hint)}", shown.out), shown.out
