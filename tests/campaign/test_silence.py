"""A campaign does not certify what did not happen: silenced requirements and faults that cannot act are errors."""

from __future__ import annotations

from pathlib import Path

import pytest

from navfmu.campaign import load_campaign
from navfmu.errors import NavfmuError
from navfmu.ssp.writer import SystemSource
from tests.components import systems
from tests.ssp import fmus

CAMPAIGN = """system = "{system}"
stop = 10.0
variants = ["main", "slow"]

[[case]]
name = "broken"
faults = "f.toml"

[[requirement]]
id = "R-1"
signal = "lag.y"
at_most = "8 m"
"""
FAULT = '[[fault]]\nid = "F"\ntarget = "lag.bias"\ntype = "input"\nvalue = 1.0\n'


def write(folder: Path, campaign: str = CAMPAIGN, fault: str = FAULT) -> Path:
    (folder / "f.toml").write_text(fault)
    (folder / "c.toml").write_text(campaign.replace("{system}", str(systems.tracker())))
    return folder / "c.toml"


def test_what_can_act_is_accepted(tmp_path):
    assert load_campaign(write(tmp_path)).size == 2


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (('"8 m"', '"8 m"\nvariants = []'), "line 13: 'variants' is an empty list, expected at least one"),
        (('"8 m"', '"8 m"\ncases = []'), "line 13: 'cases' is an empty list"),
        (('"8 m"', '"8 m"\ncases = ["broken", "broken"]'), "line 13: 'cases' holds 'broken' twice"),
        (('["main", "slow"]', "[]"), "line 3: 'variants' is an empty list"),
        (('["main", "slow"]', '["main", "main"]'), "line 3: 'variants' holds 'main' twice"),
        (('"f.toml"', "[]"), "line 7: 'faults' is an empty list"),
        (('"f.toml"', '["f.toml", "f.toml"]'), "line 7: 'faults' holds 'f.toml' twice"),
        (("stop = 10.0", "record = []"), "line 2: 'record' is an empty list"),
        (("stop = 10.0", "seeds = []"), "line 2: no seeds are given"),
    ],
)
def test_a_list_that_silences_is_refused(tmp_path, change, sentence):
    assert change[0] in CAMPAIGN
    with pytest.raises(NavfmuError) as caught:
        load_campaign(write(tmp_path, CAMPAIGN.replace(*change)))
    assert sentence in str(caught.value)


@pytest.mark.parametrize("key", ["case", "requirement"])
def test_a_list_without_tables_is_refused(tmp_path, key):
    head, *_ = CAMPAIGN.split(f"[[{key}]]")
    with pytest.raises(NavfmuError, match=f"line 4: '{key}' is an empty list"):
        load_campaign(write(tmp_path, head.replace("\n\n", f"\n{key} = []\n\n", 1)))


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (FAULT + "start = 300.0\n", "starts at 300 s, the run ends at 10 s"),
        (FAULT + "start = 10.0\n", "starts at 10 s, the last communication point"),
        (FAULT.replace("1.0", "0.0"), "sets 'lag.bias' to 0, which it is anyway"),
        (FAULT.replace("bias", "y").replace("input", "bias").replace("1.0", "0"), "adds 0"),
    ],
)
def test_a_fault_that_cannot_act_is_refused_with_both_places(tmp_path, fault, sentence):
    file = write(tmp_path, fault=fault)
    with pytest.raises(NavfmuError) as caught:
        load_campaign(file)
    assert str(caught.value) == (
        f"{file}, line 7: variant 'main', case 'broken': "
        f"{tmp_path / 'f.toml'}, line 1: fault 'F' {sentence}: it cannot act"
    )


def test_a_fault_is_measured_by_the_value_that_the_case_sets(tmp_path):
    """0 is what the bias is anyway, unless a parameter of the case says otherwise."""
    case = CAMPAIGN.replace('faults = "f', 'parameters = { "lag.bias" = 2.0 }\nfaults = "f')
    assert load_campaign(write(tmp_path, case, FAULT.replace("1.0", "0.0"))).size == 2
    with pytest.raises(NavfmuError, match=r"sets 'lag.bias' to 2, which it is anyway"):
        load_campaign(write(tmp_path, case, FAULT.replace("1.0", "2.0")))


def test_times_may_have_units(tmp_path):
    text = CAMPAIGN.replace("stop = 10.0", 'stop = "0.5 min"\nrecord_period = "200 ms"')
    campaign = load_campaign(write(tmp_path, text + 'from = "0.1 min"\nto = "20 s"\n'))
    assert (campaign.stop, campaign.record_period) == (30.0, 0.2)
    assert (campaign.requirements[0].start, campaign.requirements[0].end) == (6.0, 20.0)
    with pytest.raises(NavfmuError, match=r"line 2: 'stop' is '5 mni': 'mni' is no unit of time; did you mean 'min'"):
        load_campaign(write(tmp_path, CAMPAIGN.replace("10.0", '"5 mni"')))


# ---- requirements in every variant -----------------------------------------------------------------------------------


def two(folder: Path, other: str) -> Path:
    """A system of one sensor, whose variant "other" has another FMU in its place."""
    outputs = {"y": fmus.variable("y", "output", reference=1, unit="m")}
    outputs["feet"] = fmus.variable("y", "output", reference=1, unit="ft")
    outputs["none"] = fmus.variable("z", "output", reference=1, unit="m")
    outputs["parameter"] = fmus.variable("y", "parameter", reference=1, unit="m")
    for name in ("y", other):
        fmus.write(folder / f"{name}.fmu", fmus.describe(name, [outputs[name]]))
    source = SystemSource("two", fmus=folder, stop_time=10.0, step=0.1).component("a", "y.fmu")
    source.variant("other", components={"a": f"{other}.fmu"})
    return source.pack(folder / "two.ssp")


ASKED = """system = "two.ssp"
variants = ["main", "other"]

[[requirement]]
id = "R-1"
signal = "a.y"
at_most = 8.0
"""


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        ("none", r"line 6: variant 'other': .*has no variable 'y'"),
        (
            "parameter",
            r"line 6: variant 'other': in 'a.y', character 1: 'a.y' is a parameter, expected an output or an input",
        ),
        ("feet", r"line 6: 'a.y' has ft in variant 'other' and m in 'main': one bound cannot hold both"),
    ],
)
def test_a_signal_is_looked_up_in_every_variant_that_is_asked(tmp_path, other, sentence):
    two(tmp_path, other)
    file = write(tmp_path, ASKED)
    with pytest.raises(NavfmuError, match=sentence):
        load_campaign(file)
    assert load_campaign(write(tmp_path, ASKED + 'variants = ["main"]\n')).requirements[0].variants == ("main",)
