"""What a model keeps outside of its variables: constants that are calculated once are the same in C, the rest is
refused, and nothing of one task or build is found by another one."""

from functools import cache

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.export import Component, Output, Parameter, State, every, require, start
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.tracing.lower import lower

from .slave import OK, Slave, Unzipped

TABLES: dict = {}
LATER = None
COUNT = [0]
LOG: list = []
NUMBERS = np.zeros(3)
TICKS = 0


class Settings:
    """An object of the module."""

    gain = 1.0

    def __init__(self):
        self.calls = 0


SETTINGS = Settings()


def ramp(n):
    if n not in TABLES:
        TABLES[n] = np.zeros(n)
        TABLES[n][1:] = 1.0 / n
    return TABLES[n]


def later():
    global LATER
    if LATER is None:
        LATER = np.ones(3)
    return LATER


def _identities(kept={}):  # noqa: B006
    return kept.setdefault(3, np.eye(3))


class Remembering(Component):
    """Keeps constants in all ways there are."""

    sample_period = Parameter("s", start=1.0, description="sampling period")
    x = Output(3, "1", start=(1.0, -2.0, 0.5), description="something")
    y = State(3, "1", start=1.0, description="something else")

    @staticmethod
    @cache
    def kept(n):
        return np.full(n, 0.75)

    @start
    def begin(self):
        self.y = ramp(3) + 2.0

    @every("sample_period")
    def step(self):
        self.x = 0.5 * self.x + ramp(3) + later() * self.kept(3)

    @every("sample_period")
    def other(self):
        b = ramp(3) * 1.0
        b[0] = self.x[0]
        self.y = _identities() @ self.y + b


def test_constants_that_are_kept_are_the_same_in_c_and_are_no_traced_arrays_afterwards(tmp_path):
    """Wrong: one build hands arrays of objects to the next one, or to NumPy."""
    for folder in ("first", "second"):
        (path,) = build(Remembering, tmp_path / folder, pictures=False)
        kept = [*TABLES.values(), Remembering.kept(3), later(), _identities()]
        assert {(type(array), array.dtype.kind) for array in kept} == {(np.ndarray, "f")}
        _run_side_by_side(Remembering, tmp_path / folder, path)


def _run_side_by_side(component, folder, path=None):
    """Check that the native FMU and the interpreter have the same numbers after three steps."""
    path = path or build(component, folder, pictures=False)[0]
    native, twin = Slave(Unzipped(path, folder / "unzipped")), Interpreter(component)
    assert native.initialise() == OK
    twin.setup_experiment(0.0, None)
    twin.enter_initialization()
    twin.exit_initialization()
    for k in range(3):
        assert native.step(float(k), 1.0) == OK
        twin.do_step(float(k), 1.0)
    indices = [i for v in component.layout.variables if v.causality != "parameter" for i in v.indices]
    assert native.get_references("Real", indices) == (OK, twin.get_values("Real", indices))


TRANSITION = np.array([[1.0, 0.0, 0.0], [0.0, 0.875, 0.0], [0.0, 0.0, 0.75]])


class Filling(Component):
    """Fills what is copied from constants, as one writes a filter, and keeps a table."""

    moved = np.eye(3)
    sample_period = Parameter("s", start=1.0, description="sampling period")
    x = Output(3, "1", start=(1.0, -2.0, 0.5), description="something")
    p = State(3, 3, "1", start=np.eye(3), description="its covariance")

    @every("sample_period")
    def step(self):
        f, g = TRANSITION.copy(), self.moved.copy()
        f[0, 1] = self.period
        np.fill_diagonal(g, np.array([0.5, 0.25, 1.0]) * self.period)
        self.x = f @ self.x
        self.p = f @ self.p @ f.T + g


def test_what_is_filled_is_the_same_in_c(tmp_path):
    """And constants of module and class are NumPy's again, untouched, when the component is built."""
    _run_side_by_side(Filling, tmp_path)
    assert TRANSITION[0, 1] == 0.0
    assert (TRANSITION.dtype, Filling.moved.dtype) == (float, float)
    assert np.array_equal(Filling.moved, np.eye(3))


def _counted(x):
    COUNT[0] += 1
    return x * COUNT[0]


def _ticking(x):
    global TICKS
    TICKS += 1
    return x * TICKS


def _logged(x):
    LOG.append(1.0)
    return x * len(LOG)


def _first(x):
    if not LOG:
        LOG.append(1.0)
        return x + 1.0
    return x


def _summed(x):
    NUMBERS[1] += 1.0
    return x + NUMBERS


def _told(x):
    TABLES["x"] = x * 2.0
    return x


def _set(x):
    SETTINGS.calls += 1
    return x


def _of_the_class(x):
    Settings.gain = 2.0
    return x


def _by_default(x, last=[]):  # noqa: B006
    last.append(x)
    return x


def _forgotten(x):
    TABLES.pop("there")
    return x


CHANGES = {
    "a number in a list": (_counted, "'COUNT' of module"),
    "a variable": (_ticking, "'TICKS' of module"),
    "a list that grows": (_logged, "'LOG' of module .* each time"),
    "the first time only": (_first, "does something else where 'LOG' of module"),
    "an array": (_summed, "'NUMBERS' of module"),
    "a traced value": (_told, "leaves what it calculates in 'TABLES' of module"),
    "an object": (_set, "'calls' of|'SETTINGS' of module"),
    "a class": (_of_the_class, "'gain' of Settings"),
    "a default": (_by_default, "leaves what it calculates in 'last' of _by_default"),
    "what is gone": (_forgotten, "'TABLES' of module"),
}


def _component(function):
    class Changing(Component):
        """Something is kept."""

        sample_period = Parameter("s", start=1.0, description="sampling period")
        x = Output(3, "1", start=1.0, description="something")

        @every("sample_period")
        def step(self):
            self.x = function(self.x)

    return Changing


@pytest.mark.parametrize("name", CHANGES)
def test_what_is_another_one_at_the_next_tick_is_refused_and_is_what_it_was(name):
    """Wrong: the FMU has for ever what stood there when it was built."""
    function, told = CHANGES[name]
    TABLES.clear()
    TABLES["there"] = 1.0
    component = _component(function)
    for _ in range(2):
        with pytest.raises(NavfmuError, match=rf"line \d+: component Changing: task 'step' .*(?:{told}).* as a State"):
            lower(component)
        assert (COUNT, LOG, TICKS, [*TABLES], NUMBERS.tolist()) == ([0], [], 0, ["there"], [0.0, 0.0, 0.0])
        assert (SETTINGS.calls, Settings.gain, _by_default.__defaults__) == (0, 1.0, ([],))
    TABLES.clear()


def _last():
    """Keeps what it was sent, where nobody can look."""
    kept = 0.0
    while True:
        kept, told = (yield kept), kept
        kept = (yield told) if kept is None else kept


SENT = _last()
next(SENT)


class Sending(Component):
    """One task leaves a value, another one takes it."""

    sample_period = Parameter("s", start=1.0, description="sampling period")
    x = Output(3, "1", start=1.0, description="something")
    y = Output(3, "1", start=1.0, description="something else")

    @every("sample_period")
    def step(self):
        SENT.send(self.x * 2.0)
        self.x = self.x + 1.0

    @every("sample_period")
    def other(self):
        self.y = SENT.send(None)


def test_a_value_of_another_task_is_refused_wherever_it_was():
    """Wrong: it has the value that the variable has when the other task runs."""
    with pytest.raises(NavfmuError, match="task 'other' calculates with values that another one has left"):
        lower(Sending)


class Requiring(Component):
    """A requirement that counts."""

    gain = Parameter("1", start=1.0, description="gain")
    y = Output("1", description="something")

    @require("gain is {gain}")
    def holds(self):
        return _counted(self.gain) > 0.0


def test_a_requirement_keeps_nothing_either():
    with pytest.raises(NavfmuError, match="requirement 1 changes 'COUNT' of module"):
        lower(Requiring)
