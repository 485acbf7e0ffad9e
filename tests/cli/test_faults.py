"""What ``navfmu faults`` lists can be failed as it says, and nothing else can."""

from __future__ import annotations

import re
import tomllib

import pytest
from click.testing import CliRunner

from navfmu import System
from navfmu.cli.main import main
from navfmu.cli.skeleton import skeleton
from navfmu.engine.catalogue import catalogue
from navfmu.engine.component import Component
from navfmu.errors import NavfmuError
from navfmu.faults import TYPES, Fault
from navfmu.faults.file import parse_faults
from navfmu.fmi import names
from tests.components import systems


def output(*arguments, width=80, code=0):
    run = CliRunner().invoke(main, ["faults", *map(str, arguments)], env={"COLUMNS": str(width)})
    assert run.exit_code == code, run.output
    return run.output if code == 0 else run.stderr


@pytest.fixture(scope="module")
def system():
    return System.load(systems.tracker())


@pytest.fixture(scope="module")
def targets(system):
    components = [Component(name, fmu) for name, fmu in system.fmus.items()]
    return catalogue(components, {names.split(link.target): link.source for link in system.links})


def plan(system, *faults):
    return system.plan(faults=faults, stop=60.0, step=0.1, record=["*"])


@pytest.mark.parametrize("width", [60, 80, 160])
def test_every_target_is_listed_in_lines_that_fit(width, targets):
    text = output(systems.tracker(), width=width)
    lines = [line for line in text.splitlines() if "/" not in line]
    assert max(map(len, lines)) <= width and "…" not in text
    said = re.sub(r"\s+", "", text)
    assert all(target.name in said for target in targets)
    assert len(targets) > 20


def test_what_is_listed_makes_a_plan_and_what_is_not_is_refused(system, targets):
    """Every type at every target; wrong: a list kept by hand beside what the engine can do."""
    tried = 0
    for target in targets:
        made = {fault.type: fault for fault in parse_faults(skeleton(target))}
        assert tuple(made) == target.types
        for fault in made.values():
            assert not plan(system, fault).idle, fault
        for name, kind in TYPES.items():
            if name not in made and name != "lost_step" and "." in target.name:
                examples = {"order": [1], "unit": "ft", "stream": 1, "delay": 1.0, "time": 1.0}
                given = {p.name: examples.get(p.sort, 1.0) for p in kind.parameters if p.required}
                if name == "saturate":
                    given = {"high": 1.0}
                with pytest.raises(NavfmuError):
                    plan(system, Fault("x", target.name, name, **given))
                tried += 1
    assert tried > 100


def test_what_may_be_left_out_of_a_skeleton_may_be_given(system, targets):
    for target in targets:
        text = re.sub(r"^# (\w+ = )", r"\1", skeleton(target), flags=re.MULTILINE)
        for fault in parse_faults(text):
            required = set(TYPES[fault.type].required + TYPES[fault.type].optional)
            assert set(fault.parameters) == required and fault.duration == 60.0
            if fault.type == "stuck" and target.what.startswith("bundle"):
                continue  # one value for all members of a bundle is none
            plan(system, fault)


def test_every_variable_that_can_fail_is_a_target(system, targets):
    covered = {e.key for target in targets for e in target.elements}
    for name, fmu in system.fmus.items():
        for variable in fmu.description.variables:
            able = variable.causality in ("input", "output") or variable.variability == "tunable"
            able = able and variable.type != "String"
            assert ((name, variable.name) in covered) == able, variable.name


def test_names_and_patterns_narrow_the_list():
    text = output(systems.tracker(), "lag", "sensor.*")
    found = {line.split()[0] for line in text.splitlines() if "." in line.split()[0]}
    assert found and all(name.startswith(("lag.", "sensor.")) for name in found)
    assert output(systems.tracker(), "lag.*") != output(systems.tracker())


def test_one_target_is_a_fault_file():
    content = tomllib.loads(output(systems.tracker(), "lag.y"))
    assert {fault["target"] for fault in content["fault"]} == {"lag.y"}
    assert [fault["type"] for fault in content["fault"]][:2] == ["bias", "scale"]


def test_one_type_at_one_target_is_a_fault_file():
    content = tomllib.loads(output(systems.tracker(), "lag.y", "--type", "noise"))
    assert [(fault["target"], fault["type"]) for fault in content["fault"]] == [("lag.y", "noise")]


def test_a_component_whose_steps_are_lost_has_a_fault_file(system):
    """Wrong: a list of its signals, whatever is asked."""
    text = output(systems.tracker(), "lag", "--type", "lost_step")
    (fault,) = parse_faults(text)
    assert (fault.type, fault.target) == ("lost_step", "lag") and not plan(system, fault).idle
    assert "lag.y" in output(systems.tracker(), "lag")


def test_a_type_narrows_the_list():
    text = output(systems.tracker(), "--type", "dropout")
    assert "sensor.reading" in text and "lag.y" not in text and "2 bundle outputs: dropout" in text
    said = " ".join(output(systems.tracker(), "--type", "dropuot", code=2).split())
    assert "unknown type 'dropuot'; did you mean 'dropout'? (types: bias" in said
    said = " ".join(output(systems.tracker(), "lag.y", "--type", "dropout", code=2).split())
    assert "no target of these supports the type 'dropout', which acts on bundles" in said


def test_a_name_that_is_none_is_a_sentence():
    assert "nothing that can fail has the name 'lga.y'; did you mean 'lag.y'?" in output(
        systems.tracker(), "lga.y", code=2
    )


@pytest.mark.parametrize("kind", ["stuck", "delay", "dropout"])
def test_a_bundle_that_arrives_leaves_what_its_receiver_counts_alone(system, targets, kind):
    """'estimator.reading.lost' is an output of the estimator, whose name begins like the bundle at its input."""
    target = next(target for target in targets if target.name == "estimator.reading")
    members = ["length", "sequence", "time_of_validity", "valid"]
    assert sorted(element.variable.name for element in target.elements) == [f"reading.{name}" for name in members]
    parameters = {"delay": 1.0} if kind == "delay" else {}
    made = plan(system, Fault("x", "estimator.reading", kind, parameters=parameters))
    assert "estimator.reading.lost" not in {made.signals[slot] for slot in made.effects["slot"]}
