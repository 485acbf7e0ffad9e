"""What the benchmarks compare does the same work: every master ends with the same bits."""

from __future__ import annotations

from pathlib import Path

import pytest

import benchmarks
from benchmarks import NAMES, ring
from benchmarks.contest import Contest, compete
from benchmarks.masters import BareLoop, Ours, check_equal
from navfmu import System
from tests.conformance import hosts


@pytest.fixture(scope="module")
def ssp(tmp_path_factory):
    return ring.make(tmp_path_factory.mktemp("ring"))


def plan(ssp, algorithm, stop=2.0**10):
    system = System.load(ssp)
    return system.plan(stop=stop, step=ring.STEP, algorithm=algorithm, record=["lag0.y"], record_period=stop)


def test_all_masters_give_the_same_bits(ssp):
    hosts.ecos_library()  # says what is missing
    check_equal(ssp, plan(ssp, "jacobi"))


def test_bare_loop_does_what_the_engine_does_in_gauss_seidel(ssp):
    ours, bare = Ours(plan(ssp, "gauss_seidel")), BareLoop(plan(ssp, "gauss_seidel"))
    ours.run(300)
    bare.run(100)
    bare.run(200)
    assert bare.outputs() == ours.outputs()
    values = [value for name, value in ours.outputs().items() if name.endswith(".y")]
    assert len(set(values)) == ring.COUNT


def test_contenders_take_turns_and_ratios_are_taken_within_a_round():
    turns: list[str] = []

    def contender(name, seconds):
        def run():
            turns.append(name)
            return seconds

        return run

    contest = compete("race", "lap", {"hare": contender("hare", 1.0), "tortoise": contender("tortoise", 3.0)}, rounds=3)
    assert turns.count("hare") == turns.count("tortoise") == 4  # one of them for warming up
    assert all(set(turns[i : i + 2]) == {"hare", "tortoise"} for i in range(0, 8, 2))
    assert contest.ratio("tortoise", "hare") == 3.0
    noisy = Contest("race", "lap", {"a": [1.0, 10.0, 1.0], "b": [2.0, 20.0, 2.0]})
    assert noisy.ratio("b", "a") == 2.0
    noisy.claim("b / a", 2.5, noisy.ratio("b", "a"))
    noisy.claim("b / a", 2.5, noisy.ratio("b", "a"), at_least=False)
    assert [claim.holds for claim in noisy.claims] == [False, True]


def test_every_benchmark_is_among_those_that_are_run():
    """Wrong: one that stands alone, whose claim nobody measures."""
    folder = Path(benchmarks.__file__).parent
    found = [path.stem for path in folder.glob("*.py") if "\ndef run(" in path.read_text()]
    found += [path.parent.name for path in folder.glob("*/__main__.py")]
    assert sorted(NAMES) == sorted(found)


def test_twenty_faults_are_twenty_of_many_types_in_many_components():
    from benchmarks.faults import faults

    given = faults()
    assert len(given) == 20 and len({fault.type for fault in given}) >= 9
    assert len({fault.targets[0].split(".")[0] for fault in given}) == 10
