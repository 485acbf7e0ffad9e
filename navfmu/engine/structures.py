"""The structures of the C engine (source/master.h) as ctypes sees them, compared field by field with the binary."""

from __future__ import annotations

from collections.abc import Iterator
from ctypes import (
    CDLL,
    POINTER,
    Structure,
    byref,
    c_char,
    c_char_p,
    c_double,
    c_int,
    c_int32,
    c_int64,
    c_void_p,
    sizeof,
)

from navfmu.engine import effect, initial, loss, monitor, operations, trigger
from navfmu.errors import NavfmuError, quoted
from navfmu.expressions.program import Op

#: The enumeration Call, in its order: what each is called in FMI. The loop's own come first.
CALLS = {
    "SET_REAL": "fmi2SetReal",
    "SET_INTEGER": "fmi2SetInteger",
    "SET_BOOLEAN": "fmi2SetBoolean",
    "SET_DERIVATIVES": "fmi2SetRealInputDerivatives",
    "GET_REAL": "fmi2GetReal",
    "GET_INTEGER": "fmi2GetInteger",
    "GET_BOOLEAN": "fmi2GetBoolean",
    "DO_STEP": "fmi2DoStep",
    "EXIT_INITIALIZATION": "fmi2ExitInitializationMode",
    "GET_BOOLEAN_STATUS": "fmi2GetBooleanStatus",
    "GET_REAL_STATUS": "fmi2GetRealStatus",
    "LOAD": "the loading of its binary",
    "INSTANTIATE": "fmi2Instantiate",
    "SETUP_EXPERIMENT": "fmi2SetupExperiment",
    "ENTER_INITIALIZATION": "fmi2EnterInitializationMode",
    "SET_STRING": "fmi2SetString",
    "GET_STATE": "fmi2GetFMUstate",
    "SET_STATE": "fmi2SetFMUstate",
    "FREE_STATE": "fmi2FreeFMUstate",
    "TERMINATE": "fmi2Terminate",
    "FREE_INSTANCE": "fmi2FreeInstance",
}
NAMES = tuple(CALLS.values())
#: The functions that the loop calls: the field of Component that points to each, and its name in FMI.
LOOP = {name.lower(): function for name, function in list(CALLS.items())[: list(CALLS).index("LOAD")]}
#: Those of them that are called only after a step was discarded; an FMU may lack them.
ASKED = (LOOP["get_boolean_status"], LOOP["get_real_status"])
#: The enumeration Stray: what an FMU can change of how its thread calculates; each with its number, and in words.
STRAYS = {
    "ROUNDING": (1, "how numbers are rounded"),
    "SUBNORMALS": (2, "what becomes of subnormal numbers"),
    "TRAPS": (4, "which calculations end the process"),
}
DONE, FAILED, INTERRUPTED = range(3)
OK, WARNING, DISCARD = range(3)
GOES_ON = (OK, WARNING)  # after any other status, also one that FMI does not have, a run does not go on
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3  # fmi2StatusKind: what can be asked after a step was discarded


class Place(Structure):
    """How far a run is and which call it is in, written before each call to an FMU."""

    _fields_ = [
        ("k", c_int64),  # communication points reached
        ("rows", c_int64),  # recorded so far; 0 until initialisation is complete
        ("component", c_int32),  # whose function is being called, -1: nobody's
        ("call", c_int32),  # which function, place in NAMES
    ]


class Log(Structure):
    """What an instance has said: all errors and the last warning."""

    _fields_ = [
        ("error", c_char * 2048),
        ("warning", c_char * 2048),
        ("errors", c_int64),
        ("warnings", c_int64),
        ("error_more", c_int64),  # characters that had no room
        ("warning_more", c_int64),
    ]

    def refused(self) -> str:
        """The errors; empty if there are none."""
        return quoted(self.error.decode("utf-8", "replace"), self.error_more)

    def warned(self) -> str:
        """The last warning; empty if there is none."""
        return quoted(self.warning.decode("utf-8", "replace"), self.warning_more)

    def complaint(self) -> str:
        """The errors, or else the last warning; empty if there is none."""
        return self.refused() or self.warned()


class Callbacks(Structure):
    """fmi2CallbackFunctions."""

    _fields_ = [(name, c_void_p) for name in ("logger", "allocate", "free", "step_finished", "environment")]


class Inputs(Structure):
    _fields_ = [
        ("count", c_int32),
        ("scaled", c_int32),
        *((name, c_void_p) for name in ("references", "source", "factor", "offset")),
    ]


class Component(Structure):
    _fields_ = [
        ("instance", c_void_p),
        *((name, c_void_p) for name in LOOP),
        ("never_back", c_int),
        *((name, Inputs) for name in ("smooth", "real", "integer", "boolean")),
        *((name, c_void_p) for name in ("ahead", "first_order", "start", "slope")),
        *((name, c_void_p) for name in ("real_value", "integer_value", "boolean_value")),
        *((name, c_int32) for name in ("reals", "integers", "booleans", "first_signal")),
        *((name, c_void_p) for name in ("real_reference", "integer_reference", "boolean_reference", "whole")),
        *((name, c_int32) for name in ("first_effect", "effects", "exposures")),
        ("exposed", c_void_p),
        *((name, c_int32) for name in ("foreseen", "copied", "searched", "first_loss", "losses")),
        ("warnings", c_int64),
        ("strayed", c_int32),
        ("look", c_int32),
    ]


class Master(Structure):
    _fields_ = [
        *((name, c_void_p) for name in ("place", "component", "order", "move", "trigger", "acting", "acted")),
        *((name, c_void_p) for name in ("window", "span", "effect", "echo")),
        *((name, c_void_p) for name in ("loss", "behind", "reach", "readers", "memory", "without", "turned")),
        *((name, c_void_p) for name in ("monitor", "operation", "signal")),
        *((name, c_int32) for name in ("components", "moves", "signals", "monitors", "triggers", "faults")),
        *((name, c_int32) for name in ("first_driven", "driven")),
        *((name, c_int32) for name in ("first_driven_effect", "driven_effects", "algorithm", "columns")),
        *((name, c_void_p) for name in ("column", "rows")),
        ("record_every", c_int64),
        ("calm", c_int64),
        *((name, c_double) for name in ("step", "numerator", "denominator")),
        *((name, c_int32) for name in ("interrupt", "status", "ended", "turn")),
        ("last", c_double),
    ]


class _Field(Structure):
    """A row of the table that the binary carries."""

    _fields_ = [("structure", c_char_p), ("field", c_char_p), ("offset", c_int32), ("size", c_int32)]


Row = tuple[str, str, int, int]  # structure, field ("": the whole), offset and size in bytes


def here() -> Iterator[Row]:
    """The table as this file and the fault table mean it."""
    tables = {
        "Window": trigger.WINDOW,
        "Moment": trigger.MOMENT,
        "Trigger": trigger.TRIGGER,
        "Span": trigger.SPAN,
        "Effect": effect.EFFECT,
        "Echo": effect.ECHO,
        "Loss": loss.LOSS,
        "Monitor": monitor.MONITOR,
        "Operation": operations.OPERATION,
        "Move": initial.MOVE,
    }
    for table, rows in tables.items():
        yield table, "", 0, rows.itemsize
        for name in rows.names or ():
            kind, offset = rows.fields[name][:2]  # type: ignore[index]
            yield table, name, offset, kind.itemsize
    for structure in (Inputs, Component, Place, Log, Master):
        yield structure.__name__, "", 0, sizeof(structure)
        for name, *_ in structure._fields_:
            place = getattr(structure, name)
            yield structure.__name__, name, place.offset, place.size
    for name in trigger.KINDS:
        yield "TriggerKind", name, getattr(trigger, name), 0
    for number, name in enumerate(monitor.ORIGINS):
        yield "Origin", name.upper(), number, 0
    for name in effect.KINDS:
        yield "EffectKind", name, getattr(effect, name), 0
    for name in ("NOW", "NEXT", "AHEAD", "RECORDED", "OBSERVED"):
        yield "Reader", name, getattr(effect, name), 0
    for op in Op:
        yield "OperationKind", op.name, op, 0
    for name in ("READ", "GIVE", "LEAVE"):
        yield "MoveKind", name, getattr(initial, name), 0
    for name, (number, _) in STRAYS.items():
        yield "Stray", name, number, 0
    for number, name in enumerate(CALLS):
        yield "Call", name, number, 0


def there(library: CDLL) -> Iterator[Row]:
    """The table of a binary."""
    count = c_int32()
    library.layout.argtypes, library.layout.restype = [POINTER(c_int32)], POINTER(_Field)
    table = library.layout(byref(count))
    for row in table[: count.value]:
        yield row.structure.decode(), row.field.decode(), row.offset, row.size


def check(library: CDLL, what: str) -> None:
    """Refuse a binary whose structures are not those of this file; ``what`` begins the sentence."""
    try:
        theirs = list(there(library))
    except AttributeError:
        theirs = []
    ours = list(here())
    if ours == theirs:
        return
    different = next((f"{a}.{b}" for a, b, *_ in (set(ours) ^ set(theirs)) if b), "the order of fields")
    raise NavfmuError(f"{what} does not fit this version of navfmu: {different} lies elsewhere (rebuild it)")
