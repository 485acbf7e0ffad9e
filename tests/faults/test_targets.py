"""What a target does not support is an error, never a fault that silently does nothing."""

import pytest

from navfmu.engine.plan import Connection, make_plan
from navfmu.errors import NavfmuError
from navfmu.faults.file import parse_faults
from tests.engine.probe import probe


def plan(target, kind, start=0.0, duration="inf", step=0.1, **parameters):
    lines = [f'id = "x"\ntarget = "{target}"\ntype = "{kind}"\nstart = {start}\nduration = {duration}']
    lines += [f"{key} = {value}" for key, value in parameters.items()]
    faults = parse_faults("[[fault]]\n" + "\n".join(lines), "f.toml")
    system = [probe("a"), probe("b")], [Connection("a.y", "b.u")]
    return make_plan(*system, step=step, stop=10.0, faults=faults)


@pytest.mark.parametrize(
    ("target", "kind", "parameters", "sentence"),
    [
        ("aa.y", "bias", {"value": 1}, r"f\.toml, line 1: fault 'x': .*no component 'aa'; did you mean 'a'\?"),
        ("a.yy", "bias", {"value": 1}, r"component 'a' has no variable 'yy'; did you mean 'y'\?"),
        ("a.echo", "bias", {"value": 1}, r"'bias' acts on Real outputs, but 'a\.echo' is an Integer \(use 'stuck'\)"),
        ("a.flag_echo", "drift", {"rate": 1}, r"acts on Real outputs, but 'a\.flag_echo' is a Boolean"),
        ("a.echo", "noise", {"sigma": 1, "period": 1}, "acts on Real outputs"),
        ("b.u", "bias", {"value": 1}, r"acts on outputs, but 'b\.u' is an input"),
        ("a.u", "stuck", {}, "acts on outputs, but 'a.u' is an input; to drive an unconnected input use type 'input'"),
        ("b.u", "input", {"value": 1}, r"input 'b\.u' is connected; only an unconnected input can be driven"),
        ("a.y", "input", {"value": 1}, r"'a\.y' is not an input but an output"),
        ("a.tau", "parameter", {"value": 1}, r"parameter 'a\.tau' is fixed; only a tunable one can change"),
        ("a.y", "parameter", {"value": 1}, r"'a\.y' is not an adjustable \(tunable\) parameter but an output"),
        ("a.gain", "parameter", {"value": 11}, r"'value' = 11 is outside -10 to 10, the range of 'gain'"),
        ("a.y", "dropout", {}, r"not an output bundle .*; bundles of 'a': 'data'"),
        ("a.dat", "dropout", {}, r"not an output bundle .*; did you mean 'data'\?"),
        ("a.u", "input", {}, "needs the parameter 'value' for a Real or Integer target"),
        ("a.flag", "input", {"value": 1}, "'value' must be true or false for 'flag', not 1"),
        ("a.number", "input", {"value": 1.5}, r"'value' must be a whole number for 'number', not 1\.5"),
        ("a.number", "input", {"value": 2**31}, "must be a whole number"),
        ("a.y", "bias", {"value": "[1, 2]"}, "'value' has 2 values, but the target has 1"),
        ("a.y", "bias", {"value": "nan"}, "'value' must be a finite number for 'y', not nan"),
        ("a.y", "bias", {"value": "true"}, "'value' must be a finite number for 'y', not True"),
        ("a.y", "noise", {"sigma": -1, "period": 1}, "'sigma' must not be negative"),
    ],
)
def test_impossible_faults(target, kind, parameters, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan(target, kind, **parameters)


def test_a_window_between_two_communication_points_is_refused():
    with pytest.raises(NavfmuError, match=r"no communication point lies between its start 0\.12 s and its end 0\.17 s"):
        plan("a.y", "bias", start=0.12, duration=0.05, value=1)


def test_a_fault_after_the_end_of_the_run_is_noted():
    assert plan("a.y", "bias", start=20.0, value=1).notes == ("fault 'x' starts after the end of the run",)


def test_windows_are_counted_in_whole_steps():
    effects = plan("a.y", "bias", start=0.3, duration=0.6, value=1).effects
    assert (effects["first"][0], effects["end"][0]) == (3, 9)
    effects = plan("a.y", "bias", start=0.25, duration=0.1, value=1).effects
    assert (effects["first"][0], effects["end"][0]) == (3, 4)
