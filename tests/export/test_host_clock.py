"""Samples are due by the host's clock, kept as k * h or as t += h, from 0 or from a time of the calendar."""

import ctypes
import math
from fractions import Fraction

import pytest

from navfmu.errors import NavfmuError
from navfmu.export.interpreter import Interpreter
from navfmu.export.twin import build_twin

from .components import Sensor, TwoRates
from .slave import ERROR, OK, Slave, Unzipped

HALF_AN_HOUR = 1800.0


class Native:
    """A native FMU that counts its samples."""

    def __init__(self, fmu, start, **values):
        self.slave = Slave(fmu)
        assert self.slave.initialise(start, **values) == OK
        names = [fmu.reference(name) for name in ("count[1]", "times[1]")]
        self.read = fmu.library.fmi2GetReal
        self.values = (ctypes.c_double * 2)()
        self.wanted = self.slave.component, (ctypes.c_uint * 2)(*names), ctypes.c_size_t(2), self.values

    def step(self, t, h):
        """Step; return the number of samples and the time of the last one."""
        assert self.slave.step(t, h) == OK, self.slave.said
        self.read(*self.wanted)
        return tuple(self.values)


class Floats:
    """The interpreter, which the twin carries."""

    def __init__(self, fmu, start, **values):
        self.run = Interpreter(TwoRates)
        for name, value in values.items():
            self.run.set(name, value)
        self.run.setup(start)
        self.at = [self.run.layout.fields[name].index for name in ("count", "times")]

    def step(self, t, h):
        self.run.do_step(t, h)
        return tuple(self.run.values[self.at])


def accumulated(start, h, count):
    """Times of a host that adds up its steps."""
    t = start
    for _ in range(count):
        yield t
        t += h


def multiplied(start, h, count):
    """Times of a host that counts its steps."""
    return (start + k * h for k in range(count))


@pytest.mark.parametrize(
    ("kind", "clock", "h", "period"),
    [
        (Native, accumulated, "0.01", "0.1"),
        (Native, multiplied, "0.01", "0.1"),
        (Native, accumulated, "0.03", "0.07"),
        (Floats, accumulated, "0.01", "0.1"),
        (Floats, accumulated, "0.1", "0.1"),
    ],
)
def test_no_sample_is_late_or_early_when_time_starts_at_0(kind, clock, h, period, unzipped):
    one = kind(unzipped["two_rates"], 0.0, fast=float(period), slow=1000.0)
    step, each = Fraction(h), Fraction(period)
    wrong, count = 0, round(HALF_AN_HOUR / step)
    for k, t in enumerate(clock(0.0, float(h), count), 1):
        due = k * step.numerator * each.denominator // (step.denominator * each.numerator)
        wrong += one.step(t, float(h))[0] != due
    assert wrong == 0, f"{wrong} of {count} communication points"


@pytest.mark.parametrize(
    ("kind", "clock", "start"),
    [
        (Native, accumulated, 1.7e9),
        (Native, multiplied, 1.7e9),
        (Native, accumulated, 2e9),
        (Floats, accumulated, 1.7e9),
    ],
)
def test_a_sample_is_at_most_one_step_late_when_time_is_of_the_calendar(kind, clock, start, unzipped):
    h, period = 0.01, 0.1
    one = kind(unzipped["two_rates"], start, fast=period, slow=1000.0)
    rounding = 10 * math.ulp(start)  # 2.4 us
    count, last, before = 0, -math.inf, 0
    for t in clock(start, h, round(HALF_AN_HOUR / h)):
        samples, at = one.step(t, h)
        elapsed = (t + h) - start
        assert before <= samples <= math.floor((elapsed + rounding) / period), "one step late at most, never early"
        assert samples - count in (0, 1), "never twice"
        assert at >= last, "time never runs backwards"
        count, last, before = samples, at, math.floor(elapsed / period)


def test_an_accumulating_host_gets_from_the_twin_what_it_gets_from_the_native_fmu(unzipped, tmp_path):
    fmu = Unzipped(build_twin(TwoRates, tmp_path), tmp_path / "twin")
    for start in (0.0, 1.7e9):
        twin, native = Native(fmu, start), Native(unzipped["two_rates"], start)
        for t in accumulated(start, 0.05, round(HALF_AN_HOUR / 0.05)):
            assert twin.step(t, 0.05) == native.step(t, 0.05)
        twin.slave.free()


@pytest.mark.parametrize("start", [0.0, 1.7e9, 2e9])
def test_a_step_from_another_time_is_refused_at_every_start(start, unzipped):
    slave, floats = Slave(unzipped["sensor"]), Interpreter(Sensor)
    slave.initialise(start)
    floats.setup(start)
    for wrong in (-1.0, -0.01, 0.01, 1.0):
        assert slave.step(start + wrong, 0.1) == ERROR
        assert slave.said == (
            f"A step from {start + wrong:.15g} s was asked for, but this instance is at {start:.15g} s; "
            "to go back, restore a saved state."
        )
        with pytest.raises(NavfmuError, match="to go back"):
            floats.do_step(start + wrong, 0.1)
    assert slave.step(start, 0.1) == OK
    slave.free()


@pytest.mark.parametrize("kind", [Native, Floats])
def test_a_short_step_does_not_lose_what_was_added_up(kind, unzipped):
    """A host that accumulates, with a tiny step now and then (an event, say), still gets each sample in time."""
    one = kind(unzipped["two_rates"], 0.0, fast=0.1, slow=1000.0)
    t, exact, wrong = 0.0, Fraction(0), 0
    for k in range(20_000):
        for h in (1e-6, 0.01 - 1e-6) if k % 7 == 3 else (0.01,):
            samples, _ = one.step(t, h)
            t, exact = t + h, exact + Fraction(h)
            wrong += samples != math.floor(exact * 10 + Fraction(1, 10**9))
    assert wrong == 0
