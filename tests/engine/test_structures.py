"""The structures of the C engine and their mirrors in Python must be the same, field by field."""

import ctypes

import pytest

from navfmu.engine import effect, structures
from navfmu.engine.loading import engine_library
from navfmu.errors import NavfmuError


def test_every_structure_is_compared():
    rows = list(structures.there(engine_library()))
    assert {structure for structure, *_ in rows} == {
        *(
            "Window",
            "Moment",
            "Trigger",
            "TriggerKind",
            "Span",
            "Origin",
            "Effect",
            "Echo",
            "Loss",
            "Move",
            "Inputs",
            "Component",
            "Place",
            "Log",
            "Master",
            "Monitor",
            "Operation",
        ),
        *("EffectKind", "OperationKind", "Reader", "MoveKind", "Stray", "Call"),
    }
    assert ("Place", "rows", 8, 8) in rows
    assert ("Call", "DO_STEP", 7, 0) in rows


@pytest.mark.parametrize(
    ("name", "first", "second"),
    [
        ("Master", "numerator", "denominator"),
        ("Component", "get_real", "get_integer"),
        ("Inputs", "factor", "offset"),
        ("Place", "component", "call"),
        ("Log", "error", "warning"),
    ],
)
def test_a_mirror_with_two_swapped_fields_of_equal_size_is_refused(monkeypatch, name, first, second):
    fields = [(field, kind) for field, kind in getattr(structures, name)._fields_]
    places = [field for field, _ in fields]
    a, b = places.index(first), places.index(second)
    fields[a], fields[b] = fields[b], fields[a]
    swapped = type(name, (ctypes.Structure,), {"_fields_": fields})
    assert ctypes.sizeof(swapped) == ctypes.sizeof(getattr(structures, name))
    monkeypatch.setattr(structures, name, swapped)
    with pytest.raises(NavfmuError, match=rf"binary does not fit this version of navfmu: {name}\.\w+ lies elsewhere"):
        structures.check(engine_library(), "binary")


def test_swapped_columns_of_the_fault_table_are_refused(monkeypatch):
    names = ["kind", "trigger", "slot", *effect.EFFECT.names[3:]]
    swapped = [(name, effect.EFFECT.fields[name][0]) for name in names]
    monkeypatch.setattr(effect, "EFFECT", effect.np.dtype(swapped, align=True))
    with pytest.raises(NavfmuError, match=r"Effect\.(slot|trigger) lies elsewhere"):
        structures.check(engine_library(), "binary")


def test_another_order_of_calls_and_of_kinds_is_refused(monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(structures, "CALLS", dict(reversed(structures.CALLS.items())))
        with pytest.raises(NavfmuError, match=r"Call\.\w+ lies elsewhere"):
            structures.check(engine_library(), "binary")
    monkeypatch.setattr(effect, "ADD", 1)
    with pytest.raises(NavfmuError, match=r"EffectKind\.ADD lies elsewhere"):
        structures.check(engine_library(), "binary")


def test_a_binary_without_a_table_is_refused():
    with pytest.raises(NavfmuError, match=r"old\.so does not fit this version of navfmu"):
        structures.check(object(), "old.so")  # type: ignore[arg-type]
