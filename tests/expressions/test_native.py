"""The C evaluator against NumPy's, bit by bit, on random operations and on every special number."""

import ctypes
import math
import random
import struct

import numpy as np
import pytest

from navfmu.engine.library import SOURCE
from navfmu.export.toolchain import compile_shared
from navfmu.expressions.meaning import compile_expression
from navfmu.expressions.program import DEEPEST, Op, Program
from tests.expressions.test_meaning import PLAIN, random_text

SPECIAL = [0.0, -0.0, 1.0, -1.5, 5e-324, 1.7e308, math.inf, -math.inf, math.nan]
WRAPPER = """
#include "expression.h"
__attribute__((visibility("default"))) double evaluate(const Operation *o, int count, const double *signal, double t,
                                                       const int32_t *active, int faults) {
    return value_of(o, count, signal, t, active, faults);
}
__attribute__((visibility("default"))) int deepest(void) { return DEEPEST; }
"""


class Operation(ctypes.Structure):
    _fields_ = [("kind", ctypes.c_int32), ("place", ctypes.c_int32), ("number", ctypes.c_double)]


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("expression")
    source = folder / "wrapper.c"
    source.write_text(WRAPPER)
    library = ctypes.CDLL(str(compile_shared([source], folder / "wrapper.so", include=[SOURCE])))
    library.evaluate.restype = ctypes.c_double
    pointer, number = ctypes.c_void_p, ctypes.c_int
    library.evaluate.argtypes = [pointer, number, pointer, ctypes.c_double, pointer, number]
    return library


def native(library, operations, signals, time, active):
    rows = (Operation * len(operations))(
        *(Operation(op, int(a) if op in (Op.LOAD_SIGNAL, Op.ACTIVE) else 0, a) for op, a in operations)
    )
    values = (ctypes.c_double * max(len(signals), 1))(*signals)
    acts = (ctypes.c_int32 * max(len(active), 1))(*active)
    return library.evaluate(rows, len(rows), values, time, acts, len(active))


def same(a, b):
    return (math.isnan(a) and math.isnan(b)) or struct.pack("d", a) == struct.pack("d", b)


def test_each_operation_on_each_special_number(library):
    for op in Op:
        for left in SPECIAL:
            for right in SPECIAL:
                if op <= Op.ACTIVE:
                    continue
                rows = [(Op.LOAD_SIGNAL, 0.0), *([(Op.LOAD_SIGNAL, 1.0)] if op >= Op.PLUS else []), (op, 0.0)]
                ours = Program("", tuple(rows), (), (), False, None).value([left, right])
                theirs = native(library, rows, [left, right], 0.0, [])
                assert same(float(ours), theirs), (op.name, left, right)


def test_random_expressions(library):
    draw = random.Random(11)
    for _ in range(2000):
        program = compile_expression(random_text(draw, draw.randint(1, 4), draw.random() < 0.5), PLAIN)
        signals = [draw.choice([*SPECIAL, draw.gauss(0.0, 10.0)]) for _ in program.sources]
        ours = float(program.value(signals, 2.5))
        assert same(ours, native(library, program.operations, signals, 2.5, [])), program.text


def test_which_faults_act(library):
    program = compile_expression("active(b) and not active(a) or active()", {})
    assert program.faults == ("b", "a")
    for b in (0, 1):
        for a in (0, 1):
            expected = float(program.value([], 0.0, {"a": a, "b": b, "": a or b}))
            assert native(library, program.operations, [], 0.0, [b, a]) == expected == float(bool(a or b))


def test_values_in_arrays_are_those_one_by_one():
    program = compile_expression("max(p.x, p.y) > 1 and not p.t or p.x * p.y < time", PLAIN)
    columns = np.random.default_rng(1).normal(size=(len(program.sources), 50))
    time = np.arange(50.0)
    whole = program.value(list(columns), time)
    assert whole.tolist() == [float(program.value(list(columns[:, i]), time[i])) for i in range(50)]


def test_both_have_room_for_as_many(library):
    assert library.deepest() == DEEPEST
