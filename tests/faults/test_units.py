"""Values with units, and several targets: what arrives in the fault table."""

import pytest

from navfmu.engine import compiled
from navfmu.engine.component import Component
from navfmu.engine.effect import fault_stream
from navfmu.engine.philox import STREAM_BASE, normal
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from navfmu.faults import Fault, parse_fault
from navfmu.fmi.fmu import load
from tests.engine.probe import probe
from tests.ssp import fmus

VARIABLES = {"height": "m", "rate[1]": "rad/s", "rate[2]": "rad/s", "temperature": "K", "share": "1"}


@pytest.fixture(scope="module")
def component(tmp_path_factory):
    rows = [
        fmus.variable(name, "output", reference=number, unit=unit)
        for number, (name, unit) in enumerate(VARIABLES.items(), 1)
    ]
    text = fmus.describe("meter", rows)
    text = text.replace("</UnitDefinitions>", '<Unit name="1"><BaseUnit/></Unit></UnitDefinitions>')
    return Component("a", load(fmus.write(tmp_path_factory.mktemp("units") / "meter.fmu", text)))


def amounts(component, target, kind, **given):
    plan = make_plan([component], [], step=0.1, stop=10.0, faults=[Fault("x", target, kind, **given)])
    return plan.effects["amount"].tolist()


DEGREE = 0.017453292519943295


@pytest.mark.parametrize(
    ("target", "kind", "given", "expected"),
    [
        ("height", "bias", {"value": "0.5 nmi"}, [926.0]),
        ("height", "bias", {"value": "100 ft"}, [30.48]),
        ("height", "stuck", {"value": "1 km"}, [1000.0]),
        ("height", "noise", {"sigma": "1 mm", "period": "1 s"}, [0.001]),
        ("height", "drift", {"rate": "30 ft/min"}, [0.1524]),
        ("height", "drift", {"rate": "3.6 km/h"}, [1.0]),
        ("height", "drift", {"rate": "36 kn"}, [18.52]),
        ("height", "drift", {"rate": 0.5}, [0.5]),
        ("rate", "drift", {"rate": ["1 rad/s2", 0.25]}, [1.0, 0.25]),
        ("rate", "bias", {"value": "1 deg/h"}, [DEGREE / 3600] * 2),
        ("rate", "bias", {"value": ["1 deg/s", 0.25]}, [DEGREE, 0.25]),
        ("rate", "drift", {"rate": ["1 deg/h/s", "0.5 rad/s/min"]}, [DEGREE / 3600, 0.5 / 60]),
        ("temperature", "stuck", {"value": "20 degC"}, [293.15]),
        ("temperature", "bias", {"value": "5 degC"}, [5.0]),  # a difference has no origin
        ("temperature", "drift", {"rate": "60 degC/min"}, [1.0]),
        ("temperature", "noise", {"sigma": "0.5 degC", "period": 1.0}, [0.5]),
        ("share", "bias", {"value": "3 %"}, [0.03]),
    ],
)
def test_values_are_converted_to_the_unit_of_the_target(component, target, kind, given, expected):
    assert amounts(component, f"a.{target}", kind, **given) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("target", "kind", "given", "sentence"),
    [
        ("a.height", "bias", {"value": "3 s"}, r"'value' = 3 s for 'a\.height': 's' cannot be converted to 'm'"),
        ("a.height", "bias", {"value": "1 m/s"}, "first is m.s-1, the second m; expected m, nmi, mm, km or ft$"),
        ("a.height", "bias", {"value": "3 furlongs"}, "'furlongs' is not known here; expected m, nmi, mm, km or ft$"),
        (
            "a.height",
            "drift",
            {"rate": "3 m"},
            r"'rate' = 3 m for 'a\.height': 'm' cannot be converted to 'm/s': the first is m, the second m\.s-1; "
            "expected m/s, kn, km/h or ft/min$",
        ),
        ("a.height", "drift", {"rate": "3 knots"}, "'knots' is not known here; expected m/s, kn, km/h or ft/min"),
        ("a.rate", "drift", {"rate": "3 deg/s"}, "'deg' cannot be converted to 'rad/s'"),
        ("a.rate", "bias", {"value": ["1 deg/s"]}, "'value': 1 values given, expected 2"),
        (["a.height", "a.rate"], "bias", {"value": [1, 2]}, "2 values given, expected 3"),
        (["a.height", "a.rate"], "bias", {"value": "1 ft"}, "'ft' cannot be converted to 'rad/s'"),
        (["a.rate", "a.rate[2]"], "bias", {"value": 1}, r"'target' names 'a\.rate\[2\]' twice"),
        (["a.height", "a.heigth"], "bias", {"value": 1}, "target 'a.heigth': .*did you mean 'height'"),
        (["a.height", "b.height"], "bias", {"value": 1}, "target 'b.height': there is no component 'b'"),
    ],
)
def test_what_does_not_fit_is_a_sentence(component, target, kind, given, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        amounts(component, target, kind, **given)


def test_a_list_has_a_value_for_each_element_of_all_targets(component):
    targets = ["a.rate", "a.height"]
    assert amounts(component, targets, "bias", value=["1 deg/s", 0.5, "1 ft"]) == [DEGREE, 0.5, 0.3048]
    assert amounts(component, targets, "stuck", value=2) == [2.0] * 3
    plan = make_plan([component], [], step=0.1, stop=10.0, faults=[Fault("x", targets, "stuck", start=1.0)])
    assert [plan.signals[slot] for slot in plan.effects["slot"]] == ["a.rate[1]", "a.rate[2]", "a.height"]


def test_bundles_fail_together():
    fault = parse_fault('id = "x", target = ["a.data", "b.data"], type = "dropout", start = "1 s"')
    plan = make_plan([probe("a"), probe("b")], [], step=0.1, stop=10.0, faults=[fault])
    changed = {plan.signals[slot] for slot in plan.effects["slot"]}
    assert changed == {f"{c}.data.{m}" for c in "ab" for m in ("value", "time_of_validity", "sequence", "valid")}


def test_inputs_of_one_fault_may_be_numbers_and_switches():
    fault = Fault("x", ["a.flag", "a.number"], "input", value=[True, 3])
    plan = make_plan([probe("a")], [], step=0.1, stop=1.0, faults=[fault])
    assert plan.effects["amount"].tolist() == [1.0, 3.0]
    with pytest.raises(NavfmuError, match="needs the parameter 'value' for a Real or Integer target"):
        make_plan([probe("a")], [], step=0.1, stop=1.0, faults=[Fault("x", ["a.flag", "a.number"], "input")])


def test_several_targets_have_noise_of_their_own_and_one_has_that_of_before():
    """The numbers of the first target are those that it has alone."""

    def run(target):
        fault = Fault("x", target, "noise", sigma=2.0, period=0.1)
        plan = make_plan([probe("a"), probe("b")], [], step=0.1, stop=20.0, faults=[fault], seed=3, record=["*.y"])
        return compiled.run(plan)

    alone, both = run("a.y"), run(["a.y", "b.y"])
    stream = STREAM_BASE + fault_stream(Fault("x", "a.y", "noise", sigma=2.0, period=0.1))
    expected = [[2.0 * normal(3, stream, lane, j) for j in range(201)] for lane in (0, 1)]
    assert alone["a.y"].tolist() == both["a.y"].tolist() == expected[0]
    assert both["b.y"].tolist() == expected[1]
