"""What does not fit together is told in a sentence."""

from dataclasses import replace

import pytest

from navfmu.engine.link import Link
from navfmu.engine.plan import make_plan
from navfmu.errors import NavfmuError
from tests.engine.probe import chain, probe, ring


def plan(components=None, connections=(), **options):
    return make_plan(components or [probe("a"), probe("b")], connections, **({"step": 0.1, "stop": 1.0} | options))


@pytest.mark.parametrize(
    ("connection", "sentence"),
    [
        (("aa.y", "b.u"), r"connection aa.y -> b.u: there is no component 'aa'; did you mean 'a'\?"),
        (("a.yy", "b.u"), r"component 'a' has no variable 'yy'; did you mean 'y'\?"),
        (("a", "b.u"), "component 'a' has no variable ''"),
        (("a.u", "b.u"), r"'a.u' is not an output \(input\)"),
        (("a.y", "b.seen"), r"'b.seen' is not an input \(output\)"),
        (("a.y", "b.number"), "a Real cannot be connected to a Integer"),
        (("a.flag_echo", "b.u"), "a Boolean cannot be connected to a Real"),
    ],
)
def test_impossible_connections(connection, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan(connections=[Link(*connection)])


def test_an_input_with_two_sources():
    with pytest.raises(NavfmuError, match=r"input 'b.u' has two sources: 'a.y' and 'a.seen'"):
        plan(connections=[Link("a.y", "b.u"), Link("a.seen", "b.u")])


def test_whole_numbers_cannot_be_scaled():
    with pytest.raises(NavfmuError, match="only Real values can be scaled"):
        plan(connections=[Link("a.echo", "b.number", factor=2.0)])


@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        ({"taw": 1.0}, r"component 'a': probe has no parameter 'taw'; did you mean 'tau'\?"),
        ({"tau": 0.0}, r"component 'a': 'tau' = 0 is out of range: expected at least 0.001"),
        ({"gain": 11.0}, r"component 'a': 'gain' = 11 is out of range: expected -10 to 10"),
        ({"gain": float("nan")}, r"component 'a': 'gain' = nan is out of range: expected a finite number"),
        ({"tau": "fast"}, "component 'a': 'tau' = fast: expected a number$"),
        ({"tau": True}, "'tau' = True: expected a number$"),
        ({"number": 1.5}, "'number' = 1.5: expected an integer from -2147483648 to 2147483647"),
        ({"number": 2**31}, "'number' = 2147483648: expected an integer from -2147483648 to 2147483647"),
        ({"number": float("inf")}, "'number' = inf: expected an integer from -2147483648 to 2147483647"),
        ({"flag": "maybe"}, "'flag' = maybe: expected true or false"),
        ({"label": 3}, "'label' = 3: expected a text"),
        ({"y": 1.0}, "'y' cannot be set: it is output, continuous; expected a parameter or an input"),
        ({"tau": [1.0, 2.0]}, "'tau': 2 values given, expected 1"),
        ({"data": 1.0}, "'data' is a bundle; name one of its members: data.value, "),
    ],
)
def test_impossible_start_values(start, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan([probe("a", **start)])


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("a.yy", r"recorded signal 'a.yy': component 'a' has no variable 'yy'; did you mean 'y'\?"),
        ("c.y", "there is no component 'c'"),
        ("x*", "no output matches the pattern"),
        ("a.y@false", "after @ only 'true' is known"),
        ("a.u@true", "only outputs have a true value"),
        ("a.label", "a String cannot be recorded"),
    ],
)
def test_impossible_recordings(name, sentence):
    with pytest.raises(NavfmuError, match=sentence):
        plan(record=[name])


def renamed(**names: str):
    """A probe with other names for some variables."""
    component = probe("a")
    about = component.description
    variables = tuple(replace(v, name=names.get(v.name, v.name)) for v in about.variables)
    return replace(component, fmu=replace(component.fmu, description=replace(about, variables=variables)))


def test_an_output_whose_own_name_ends_in_true_is_not_taken_for_the_value_of_another():
    odd = renamed(seen="y@true")
    with pytest.raises(NavfmuError, match="a variable whose own name ends in '@true' cannot be recorded"):
        plan([odd], record=["a.y@true"])
    made = plan([odd])
    assert "a.y" in [column.name for column in made.recorded]
    assert "a.y@true" not in [column.name for column in made.recorded]
    assert made.notes == ("'a.y@true' is not recorded: so ends the name of a value without faults",)


@pytest.mark.parametrize("name", ["y@2", "y@", "2*y", "y?"])
def test_other_signs_in_the_name_of_an_output_are_its_own(name):
    made = plan([renamed(seen=name)], record=[f"a.{name}"])
    assert [column.name for column in made.recorded] == [f"a.{name}"]
    assert len(plan([renamed(seen=name)]).recorded) == len(plan([probe("a")]).recorded)
    true = plan([renamed(seen=name)], record=[f"a.{name}@true"])
    assert [column.name for column in true.recorded] == [f"a.{name}@true"]


@pytest.mark.parametrize("seed", [-1, 2**31, 1.0, True])
def test_impossible_seeds(seed):
    with pytest.raises(NavfmuError, match="the seed must be a whole number from 0 to 2147483647, not"):
        plan(seed=seed)


def test_unknown_algorithm():
    with pytest.raises(NavfmuError, match=r"unknown algorithm 'jacoby'; did you mean 'jacobi'\?"):
        plan(algorithm="jacoby")


def test_two_components_of_one_name():
    with pytest.raises(NavfmuError, match="two components have the name 'a'"):
        plan([probe("a"), probe("a")])


def test_an_fmu_that_allows_one_instance_only():
    lonely = [probe(name, single=True) for name in "ab"]
    with pytest.raises(NavfmuError, match="allows one instance in a process only"):
        plan(lonely)


def test_a_system_without_components():
    with pytest.raises(NavfmuError, match="the system has no components"):
        make_plan([], [], step=0.1, stop=1.0)


def test_bundles_arrays_and_patterns_name_several_columns():
    names = [c.name for c in plan(record=["a.data", "b.*_echo", "a.y", "a.y@true", "a.data.valid"]).recorded]
    bundle = ["a.data.value", "a.data.time_of_validity", "a.data.sequence", "a.data.valid"]
    assert names == [*bundle, "b.flag_echo", "a.y", "a.y@true"]


def test_only_what_is_needed_is_read():
    needed = make_plan(*chain(2), step=0.1, stop=1.0, record=["lag1.y"])
    assert needed.signals == ("lag0.y", "lag1.y")
    assert make_plan(*ring(), step=0.1, stop=1.0, record=["lag3.time"]).signals.count("lag3.time") == 1
