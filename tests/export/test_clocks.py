"""Clocks: offsets of ticks, and periods that change while an instance runs, against ticks in exact fractions."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from navfmu import System
from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, every
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.noise import Normals
from navfmu.export.twin import build_twin
from navfmu.faults import Fault
from navfmu.ssp.writer import SystemSource

from .components import MOST, Ticking
from .slave import ERROR, OK, Slave, Unzipped

UNIT = Fraction(1, 1024)  # s: multiples of it, and their sums here, have no rounding as floats


def oracle(phase, period, steps):
    """Number and time of each tick, in exact fractions; ``steps`` has each step's length and the period before it."""
    now, last, k, ticks = Fraction(0), None, (-1 if phase > 0 else 0), []
    if phase == 0:
        last = Fraction(0)
    due = phase if phase > 0 else period
    for h, changed in steps:
        if changed != period:
            period = changed
            if last is not None:
                due = max(last + period, now)
        now += h
        while due <= now:
            k, last = k + 1, due
            ticks.append((k, due, period))
            due = due + period
    return ticks


def noises(ticks, component=Ticking, seed=1):
    stream = int(component.layout.fields["stream"].start[0])
    return [Normals(seed, stream, k, 0)(1)[0] for k, _, _ in ticks]


@pytest.fixture
def ticking(unzipped):
    return unzipped["ticking"]


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    folder = tmp_path_factory.mktemp("twin")
    return Unzipped(build_twin(Ticking, folder), folder / "ticking")


class _Floats:
    """The interpreter with the calls of a slave that are needed here."""

    def __init__(self, component):
        self.run = Interpreter(component)
        self.get = self.run.get

    def initialise(self, **values):
        for name, value in values.items():
            self.run.set(name, value)
        self.run.setup()
        return OK

    def set(self, name, value):
        self.run.set(name, value)
        return OK

    def step(self, t, h):
        self.run.do_step(t, h)
        return OK

    def free(self):
        """Nothing is held."""


def told(instance):
    """Times, periods and noises of the ticks so far."""
    count = instance.get("ticks")
    return [list(instance.get(name))[:count] for name in ("times", "periods", "noises")]


def drive(instance, steps):
    now = Fraction(0)
    for h, period in steps:
        assert instance.set("period_", float(period)) == OK
        assert instance.step(float(now), float(h)) == OK
        now += h


def cases(count, seed):
    """Random phases, and steps between which the period sometimes changes; no more ticks than can be told."""
    random = np.random.default_rng([20, seed])
    while count:
        phase = UNIT * int(random.choice([0, 1, 100, 256, 700]))
        period = first = UNIT * int(random.choice([64, 100, 256, 257, 512]))
        steps = []
        for _ in range(12):
            if random.random() < 0.4:
                period = UNIT * int(random.choice([16, 64, 100, 256, 300, 1000]))
            steps.append((UNIT * int(random.choice([32, 100, 128, 256, 600])), period))
        if len(oracle(phase, first, steps)) <= MOST:
            count -= 1
            yield phase, first, steps


@pytest.mark.parametrize("form", ["native", "floats", "twin"])
def test_ticks_come_when_exact_fractions_say_and_their_noise_is_that_of_their_number(form, request):
    """Catches a change that restarts the count, an offset that shifts the noise, and ticks in the past."""
    late = 0
    for phase, first, steps in cases(60 if form == "native" else 15, 1):
        fmu = None if form == "floats" else request.getfixturevalue({"native": "ticking", "twin": "twin"}[form])
        instance = _Floats(Ticking) if form == "floats" else Slave(fmu)
        instance.initialise(period_=float(first), phase=float(phase))
        drive(instance, steps)
        expected = oracle(phase, first, steps)
        times, periods, drawn = told(instance)
        assert times == [float(t) for _, t, _ in expected], (phase, first, steps)
        assert periods == [float(p) for _, _, p in expected]
        assert np.allclose(drawn, noises(expected), rtol=1e-12)
        gaps = [b - a for (_, a, _), (_, b, _) in pairwise(expected)]
        late += any(gap != p for gap, (_, _, p) in zip(gaps, expected[1:], strict=True))
        instance.free()
    assert late > 3, "some periods were shortened so far that the tick had passed"


def test_ticks_do_not_depend_on_the_communication_step_where_the_period_stands(ticking):
    """With decimals, whose sums round."""
    for phase, period in ((0.0, 0.1), (0.07, 0.1), (0.25, 0.1), (1e-9, 0.3)):
        runs = []
        for count in (300, 60, 4, 1):
            slave = Slave(ticking)
            slave.initialise(period_=period, phase=phase)
            for i in range(count):
                assert slave.step(i * (3.0 / count), 3.0 / count) == OK
            runs.append(told(slave))
            slave.free()
        assert all(run == runs[0] for run in runs[1:])
        first = 0 if phase > 0 else 1
        assert np.array_equal(runs[0][0], [phase + k * period for k in range(first, first + len(runs[0][0]))])


def test_an_offset_of_0_is_as_none_at_all(ticking, tmp_path):
    class Plain(Ticking):
        """The same without an offset."""

        name = "ticking"

        tell = every("period_")(Ticking.tell.__wrapped__)

    with_offset, without = _Floats(Ticking), _Floats(Plain)
    for instance in (with_offset, without):
        instance.initialise(period_=0.3)
        drive(instance, [(Fraction(3), Fraction(3, 10))])
    assert told(with_offset) == told(without)


def test_a_period_that_changes_and_changes_back_between_two_steps_has_not_changed(ticking):
    """Bits, too: a new count from the last tick would round otherwise."""
    slaves = [Slave(ticking), Slave(ticking)]
    for slave in slaves:
        slave.initialise(period_=0.1)
    for k in range(20):
        slaves[1].set("period_", 0.7)
        slaves[1].set("period_", 0.1)
        assert [slave.step(k * 0.15, 0.15) for slave in slaves] == [OK, OK]
    assert told(slaves[0]) == told(slaves[1])
    for slave in slaves:
        slave.free()


def test_saved_states_know_the_clocks(ticking):
    """A run that goes back, and one that goes on from bytes in another instance, tick as the one that went through."""
    for phase, first, steps in cases(20, 3):
        slave, floats = Slave(ticking), _Floats(Ticking)
        for instance in (slave, floats):
            instance.initialise(period_=float(first), phase=float(phase))
            drive(instance, steps[:6])
        now = sum(h for h, _ in steps[:6])
        saved, kept = slave.serialise(slave.save()), floats.run.get_state()

        def go_on(instance, now=now, steps=steps):
            time = now
            for h, period in steps[6:]:
                instance.set("period_", float(period))
                assert instance.step(float(time), float(h)) == OK
                time += h
            return told(instance)

        once, plain = go_on(slave), go_on(floats)
        other = Slave(ticking)
        status, state = other.deserialise(saved)
        assert status == OK and other.call("SetFMUstate", state) == OK
        assert go_on(other) == once
        again = _Floats(Ticking)
        again.run.set_state(kept)
        assert go_on(again) == plain
        for instance in (slave, other):
            instance.free()


def test_a_reset_starts_the_clocks_anew(ticking):
    slave = Slave(ticking)
    slave.initialise(phase=0.125)
    drive(slave, [(Fraction(1), Fraction(1, 2)), (Fraction(1), Fraction(1, 8))])
    slave.call("Reset")
    slave.initialise(phase=0.5)
    drive(slave, [(Fraction(1), Fraction(1, 4))])
    assert told(slave)[0] == [0.5, 0.75, 1.0]
    slave.free()


@pytest.mark.parametrize("value", [0.0, -1.0, math.inf, math.nan, 200.0])
def test_a_running_period_stays_a_period(ticking, value):
    slave, floats = Slave(ticking), Interpreter(Ticking)
    slave.initialise()
    floats.setup()
    assert slave.set("period_", value) == ERROR
    assert slave.get("period_") == 0.25
    with pytest.raises(NavfmuError) as refused:
        floats.set("period_", value)
    assert slave.said == str(refused.value)
    if value in (0.0, -1.0):
        assert slave.said == f"Parameter 'period_' is {value:g} s; expected a period longer than 0 s."
    slave.free()


@pytest.mark.parametrize("value", [-0.5, -math.inf, math.nan])
def test_an_offset_is_not_before_the_start(ticking, value):
    slave, floats = Slave(ticking), Interpreter(Ticking)
    assert slave.initialise(phase=value) == ERROR
    floats.set("phase", value)
    with pytest.raises(NavfmuError) as refused:
        floats.setup()
    assert str(refused.value).startswith(slave.messages[0][2])
    if value == -0.5:
        assert slave.said == "Parameter 'phase' is -0.5 s; expected an offset of at least 0 s."
    slave.free()


def test_what_cannot_be_a_clock_is_refused_with_a_sentence():
    def declare(task=None, **members):
        plain = {"sample_period": Parameter("s", start=0.1), "y": Output("1")}
        return type("Wrong", (Component,), {"__doc__": "Wrong.", **plain, **members, "step": task(lambda self: None)})

    with pytest.raises(NavfmuError, match=r'every\(0\.1\) needs the name of a Parameter in s, for example "period"'):
        every(0.1)
    with pytest.raises(NavfmuError, match=r"every\(\.\.\., offset=0\.05\) needs the name of a Parameter in s"):
        every("sample_period", offset=0.05)
    with pytest.raises(NavfmuError, match=r"the offset 'phas' is no scalar Parameter in s; did you mean 'phase'"):
        declare(every("sample_period", offset="phas"), phase=Parameter("s"))
    with pytest.raises(NavfmuError, match=r"the period 'rows' is no scalar Parameter in s$"):
        declare(every("rows"), rows=Parameter(2, "s"))
    with pytest.raises(NavfmuError, match="the offset 'phase' must not be tunable: it says when the first tick comes"):
        declare(every("sample_period", offset="phase"), phase=Parameter("s", tunable=True))
    with pytest.raises(NavfmuError, match="the period 'length' is in m, expected a Parameter in s"):
        declare(every("length"), length=Parameter("m"))


@pytest.mark.parametrize("engine", ["compiled", "reference"])
def test_a_fault_tunes_a_period_and_gives_it_back(engine, tmp_path):
    """In a system: one tick each 0.25 s, from 1 s to 2 s each 0.125 s, counted from the tick at 1 s, then as before."""
    build([Ticking], tmp_path, pictures=False)
    source = SystemSource("ticking", fmus=tmp_path, stop_time=3.0, step=0.25).component("a", "ticking.fmu")
    system = System.load(source.pack(tmp_path / "ticking.ssp"))
    fault = Fault("fast", "a.period_", "parameter", value=0.125, start=1.0, duration=1.0)
    result = system.run(faults=[fault], engine=engine, record=["a.ticks", "a.times"])
    assert list(result["a.ticks"]) == [0, 1, 2, 3, 4, 6, 8, 10, 12, 13, 14, 15, 16]
    times = [result[f"a.times[{k}]"].iloc[-1] for k in range(1, 17)]
    assert times == [0.25, 0.5, 0.75, 1.0, *np.arange(1.125, 2.01, 0.125), 2.25, 2.5, 2.75, 3.0]
