"""What a target does not support is an error, never a fault that silently does nothing."""

import json

import pytest

from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.faults.file import parse_faults
from tests.engine.probe import probe

REAL = "Real outputs and connected inputs"
WHOLE = r"\(types for it: stuck, delay, slow\)"


def plan(target, kind, start=0.0, duration="inf", **parameters):
    lines = [f'id = "x"\ntarget = "{target}"\ntype = "{kind}"\nstart = {start}\nduration = {duration}']
    lines += [f"{key} = {value}" for key, value in parameters.items()]
    faults = parse_faults("[[fault]]\n" + "\n".join(lines), "f.toml")
    system = [probe("a"), probe("b")], [Link("a.y", "b.u")]
    return make_plan(*system, step=0.1, stop=10.0, faults=faults)


@pytest.mark.parametrize(
    ("target", "kind", "parameters", "sentence"),
    [
        ("aa.y", "bias", {"value": 1}, r"f\.toml, line 3: fault 'x': .*no component 'aa'; did you mean 'a'\?"),
        ("a.yy", "bias", {"value": 1}, r"component 'a' has no variable 'yy'; did you mean 'y'\?"),
        ("a.echo", "bias", {"value": 1}, rf"'bias' acts on {REAL}, but 'a\.echo' is an Integer output {WHOLE}"),
        ("a.flag_echo", "drift", {"rate": 1}, rf"acts on {REAL}, but 'a\.flag_echo' is a Boolean output {WHOLE}"),
        ("a.echo", "noise", {"sigma": 1, "period": 1}, f"acts on {REAL}"),
        ("a.echo", "swap", {"order": "[1]"}, f"acts on {REAL}, but 'a.echo' is an Integer output"),
        ("a.u", "stuck", {}, r"but 'a\.u' is an unconnected input \(types for it: input\)"),
        (
            "b.u",
            "input",
            {"value": 1},
            r"'input' acts on unconnected inputs, but 'b\.u' is a connected input \(types for",
        ),
        ("a.y", "input", {"value": 1}, r"but 'a\.y' is an output \(types for it: bias, scale, "),
        ("a.tau", "parameter", {"value": 1}, r"'a\.tau' is a fixed parameter \(no type of fault acts on it\)"),
        ("a.time", "bias", {"value": 1}, r"'a\.time' is a local variable \(no type of fault acts on it\)"),
        ("a.y", "parameter", {"value": 1}, r"'parameter' acts on tunable parameters, but 'a\.y' is an output"),
        (
            "a.data",
            "bias",
            {"value": 1},
            r"'a\.data' is a bundle, type 'bias' acts on members of it: data\.value, data\.t",
        ),
        ("a.gain", "parameter", {"value": 11}, "'value': 'gain' = 11 is out of range: expected -10 to 10"),
        ("a.y", "dropout", {}, r"is not a bundle of outputs or connected inputs .*; bundles of 'a': 'data'"),
        ("a.dat", "dropout", {}, r"is not a bundle of .*; did you mean 'data'\?"),
        ("a.u", "input", {}, "needs the parameter 'value' for a Real or Integer target"),
        ("a.flag", "input", {"value": 2}, "'value' = 2 for 'a.flag': expected true or false"),
        ("a.number", "input", {"value": 1.5}, r"'value' = 1\.5 for 'a.number': expected an integer"),
        ("a.number", "input", {"value": 2**31}, "'value' = 2147483648 for 'a.number': expected an integer"),
        ("a.y", "bias", {"value": "[1, 2]"}, "'value': 2 values given, expected 1"),
        ("a.y", "bias", {"value": "nan"}, "'value' = nan for 'a.y': expected a finite number"),
        ("a.y", "bias", {"value": "true"}, "'value' = true for 'a.y': expected a number"),
        ("a.y", "noise", {"sigma": -1, "period": 1}, "'sigma' = -1 for 'a.y': expected a number that is not negative"),
        ("a.y", "drift", {"rate": '"1 m"'}, "'rate' = 1 m for 'a.y': expected a number"),
        ("a.y", "scale", {"factor": "inf"}, "'factor' = inf for 'a.y': expected a finite number"),
        ("a.y", "scale", {"factor": '"1 m"'}, "'factor' = 1 m for 'a.y': expected a number without a unit"),
        ("a.y", "unit", {"unit": '"ft"'}, "'unit' = ft for 'a.y': the variable has no unit that is known"),
        ("a.y", "unit", {"unit": "1"}, "line 7: fault 'x': 'unit' is 1, expected a text"),
        ("a.y", "saturate", {}, "type 'saturate' needs the parameter 'low' or 'high'"),
        ("a.y", "saturate", {"low": 2, "high": 1}, "'low' is 2 and 'high' 1 for 'a.y'"),
        ("a.y", "quantise", {"step": 0}, "'step' = 0 for 'a.y': expected a positive number"),
        ("a.y", "spike", {"value": 1, "every": 0}, "'every' must be a positive time in s, not 0"),
        ("a.y", "garbage", {"low": 3, "high": 1, "period": 1}, "'low' is 3 and 'high' 1 for 'a.y'"),
        ("a.y", "garbage", {"low": 3, "period": 1}, "type 'garbage' needs the parameter 'high'"),
        ("a.y", "nan", {"value": '"nane"'}, "'value' must be 'nan', 'inf' or '-inf', not 'nane'; did you mean 'nan'"),
        ("a.y", "nan", {"value": 1.5}, "'value' must be 'nan', 'inf' or '-inf', not 1.5"),
        ("a.y", "delay", {"delay": -1}, "'delay' must be a time in s, 0 or longer, not -1"),
        ("a.y", "delay", {"delay": 1, "jiter": 1}, "unknown entry 'jiter'; did you mean 'jitter'"),
        ("a.y", "slow", {"period": '"1 m"'}, "'m' is no unit of time"),
        ("a.y", "swap", {"order": "[2, 1]"}, "'a.y' is one element, which has nothing to change places with"),
        ("a.y", "swap", {"order": "[1, 1]"}, "'order' must have each of the places 1, 2, ... once"),
        ("a.y", "swap", {"order": "[0]"}, "'order' must have each of the places 1, 2, ... once"),
    ],
)
def test_impossible_faults(target, kind, parameters, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan(target, kind, **parameters)


def test_a_window_between_two_communication_points_is_refused():
    with pytest.raises(NavfmuError, match=r"no communication point lies between its start 0\.12 s and its end 0\.17 s"):
        plan("a.y", "bias", start=0.12, duration=0.05, value=1)


def both(*faults):
    return make_plan([probe("a")], [], step=0.1, stop=10.0, faults=parse_faults("".join(faults), "f.toml"))


def fault(name, target, kind, **parameters):
    lines = [f'[[fault]]\nid = "{name}"\ntarget = {json.dumps(target)}\ntype = "{kind}"\n']
    return "".join([*lines, *(f"{key} = {value}\n" for key, value in parameters.items())])


@pytest.mark.parametrize(
    ("target", "kind", "parameters", "why"),
    [
        ("a.y", "bias", {"start": 10.1, "value": 1}, "starts at 10.1 s, the run ends at 10 s"),
        ("a.y", "bias", {"start": 10.0, "value": 1}, None),  # the last row of the recording has it
        ("a.gain", "parameter", {"start": 10.0, "value": 2}, "starts at 10 s, the last communication point"),
        ("a.gain", "parameter", {"start": 9.9, "value": 2}, None),
        ("a.y", "drift", {"start": 10.0, "rate": 1}, "starts at 10 s, the last communication point"),
        ("a.y", "drift", {"start": 9.95, "rate": 1}, None),  # which is 0.05 there
        ("a.y", "drift", {"start": 9.9, "rate": 1}, None),
        ("a.y", "bias", {"value": 0}, "adds 0"),
        ("a.y", "spike", {"value": 0}, "adds 0"),
        ("a.y", "scale", {"factor": 1}, "multiplies by 1"),
        (["a.y", "a.seen"], "swap", {"order": "[1, 2]"}, "leaves every element in its place"),
        ("a.y", "drift", {"rate": 0.0}, "adds 0"),
        ("a.y", "noise", {"sigma": 0, "period": 1}, "adds 0"),
        ("a.gain", "parameter", {"value": 1}, "sets 'a.gain' to 1, which it is anyway"),
        ("a.flag", "input", {"value": "false"}, "sets 'a.flag' to 0, which it is anyway"),
        ("a.flag", "input", {}, None),
        ("a.y", "stuck", {"value": 0}, None),
    ],
)
def test_a_fault_that_cannot_act_is_noted(target, kind, parameters, why):
    made = both(fault("x", target, kind, **parameters))
    assert made.idle == ({} if why is None else {"x": why})
    assert made.notes == (() if why is None else (f"fault 'x' {why}: it cannot act",))


def test_a_fault_that_others_hide_cannot_act_and_one_that_ends_others_can():
    stuck = {"value": 3, "start": 2.0, "duration": 100.0}
    hidden = both(fault("x", "a.y", "bias", value=1, start=5.0), fault("y", "a.y", "stuck", **stuck))
    assert hidden.idle == {"x": "is hidden: all the time another fault sets 'a.y'"}
    assert not both(fault("x", "a.y", "bias", value=1, start=1.9), fault("y", "a.y", "stuck", **stuck)).idle
    assert not both(fault("y", "a.y", "stuck", **stuck), fault("x", "a.y", "bias", value=1, start=5.0)).idle
    assert not both(
        fault("x", "a.gain", "parameter", value=2), fault("y", "a.gain", "parameter", value=1, start=5.0)
    ).idle  # the second one gives back what the first one took


def test_windows_are_counted_in_whole_steps():
    assert plan("a.y", "bias", start=0.3, duration=0.6, value=1).windows.tolist() == [(3, 9, 0.3)]
    assert plan("a.y", "bias", start=0.25, duration=0.1, value=1).windows.tolist() == [(3, 4, 0.25)]
