"""The life of an instance: its states, what may be called and set in which of them, and what is said when it may not.

This is the one specification of native FMUs and of the interpreter (and so of the Python twins). The interpreter works
from these tables; :func:`header` writes them as ``life.h``, from which the C runtime works. The rules are those of
sections 2.1.6, 2.2.7 and 4.2.4 of FMI 2.0, with one addition: values may be read before initialisation.

A call that is refused changes nothing. A step that fails on its way leaves the instance FAILED: its values can be
looked at, and fmi2Reset or fmi2SetFMUstate bring it back.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntFlag


class State(IntFlag):
    """States of an instance; the bits below are the types of a variable (``model.h`` keeps both in one number)."""

    INSTANTIATED = 8
    INITIALIZATION = 16
    STEPPING = 32
    TERMINATED = 64
    FAILED = 128


_NEVER, _ALWAYS = State(0), State(sum(State))
_INITIALISED = State.INSTANTIATED | State.INITIALIZATION
_SETTING = _INITIALISED | State.STEPPING

#: When it is, in the middle of a sentence.
WHEN = {
    State.INSTANTIATED: "before initialisation",
    State.INITIALIZATION: "in initialisation mode",
    State.STEPPING: "after initialisation",
    State.TERMINATED: "after fmi2Terminate",
    State.FAILED: "after a step that failed",
}

#: The states in which a function may be called; what is not named may be called always.
CALLS = {
    "fmi2SetupExperiment": State.INSTANTIATED,
    "fmi2EnterInitializationMode": State.INSTANTIATED,
    "fmi2ExitInitializationMode": State.INITIALIZATION,
    "fmi2SetReal": _SETTING,
    "fmi2SetInteger": _SETTING,
    "fmi2SetBoolean": _SETTING,
    "fmi2SetString": _SETTING,
    "fmi2SetRealInputDerivatives": _SETTING,
    "fmi2DoStep": State.STEPPING,
    "fmi2Terminate": State.STEPPING,
}


@dataclass(frozen=True)
class Rule:
    """When a kind of variable may be set; None stands for any."""

    causality: str | None
    variability: str | None
    initial: str | None
    states: State


#: The first rule that fits counts.
RULES = (
    Rule("input", None, None, _SETTING),
    Rule("parameter", "tunable", None, _SETTING),
    Rule(None, None, "calculated", _NEVER),
    Rule(None, None, "exact", _INITIALISED),
)
#: Why a variable cannot be set that could be set earlier, and one that never can.
FIXED, CALCULATED = "it is fixed once initialisation has ended", "it is calculated"


@dataclass(frozen=True)
class Category:
    """A log category, and the status that its messages carry."""

    name: str
    status: int  # fmi2Status
    unasked: bool  # whether it is logged also when logging is off
    description: str


CATEGORIES = {
    "EVENT": Category("logEvents", 0, False, "What happens inside, such as lost samples"),
    "WARNING": Category("logStatusWarning", 1, True, "Warnings"),
    "ERROR": Category("logStatusError", 3, True, "Why a call was refused; logged even when logging is off"),
}
#: The category that stands for all of them.
ALL = ("logAll", "All of these")


@dataclass(frozen=True)
class Message:
    """Something that is said: its category, and its sentence as printf and Python's % understand it."""

    category: str
    sentence: str


def _error(sentence: str) -> Message:
    return Message("ERROR", sentence)


_PARAMETER = "Parameter '%s' is %.9g%s%s; expected a value"
MESSAGES = {
    "NOT_ALLOWED": _error("%s is not allowed %s."),
    "NO_INTERVAL": _error("The experiment from %.15g s to %.15g s is not an interval of time."),
    "NO_VARIABLE": _error("There is no variable with value reference %u; expected a value below %d."),
    "OTHER_TYPE": _error("Variable '%s' (value reference %u) is %s, not %s."),
    "NOT_SETTABLE": _error("Variable '%s' cannot be set %s: %s."),
    "NO_SLOPE": _error("A derivative of order %d was set for '%s'; expected order 1 and a continuous Real input."),
    "NOT_WHOLE": _error("'%s' is an Integer and is assigned %.9g."),
    "NO_TEXT": _error("'%s' is a String and is set to no text."),
    "NO_CHARACTER": _error("'%s' is set to a text whose byte %.0f begins no character; expected UTF-8."),
    "ELSEWHERE": _error("The table '%s' is not in the resources; expected the name of a file there."),
    "TOO_LONG": _error("'%s' is set to a text of %.0f bytes; expected at most %d bytes of UTF-8."),
    "NO_ITEM": _error("'%s' is an Enumeration from %.9g to %.9g and is assigned %.9g."),
    "BETWEEN": _error(f"{_PARAMETER} from %.9g to %.9g%s%s."),
    "AT_LEAST": _error(f"{_PARAMETER} of at least %.9g%s%s."),
    "AT_MOST": _error(f"{_PARAMETER} of at most %.9g%s%s."),
    "NO_NUMBER": _error("Parameter '%s' is not a number."),
    "NO_PERIOD": _error("Parameter '%s' is %.9g s; expected a period longer than 0 s."),
    "NO_OFFSET": _error("Parameter '%s' is %.9g s; expected an offset of at least 0 s."),
    "NO_STEP": _error("The communication step size is %.9g s at %.15g s; expected a positive number."),
    "OTHER_STEP": _error(
        "The communication step size is %.9g s at %.15g s; this instance counts communication points of %.9g s."
    ),
    "OTHER_TIME": _error(
        "A step from %.15g s was asked for, but this instance is at %.15g s; to go back, restore a saved state."
    ),
    "PAST_STOP": _error("A step to %.15g s was asked for, but the experiment ends at %.15g s."),
    "OTHER_STATE": _error("This is not a saved state of this build of '%s', tables included."),
    "LOST": Message(
        "EVENT",
        "At %.15g s %.0f samples of '%s' were lost: the communication step is longer than their period.",
    ),
}


def settable(causality: str, variability: str, initial: str | None) -> State:
    """Return the states in which a variable may be set."""
    for rule in RULES:
        wanted = ((rule.causality, causality), (rule.variability, variability), (rule.initial, initial))
        if all(expected in (None, found) for expected, found in wanted):
            return rule.states
    return _NEVER


def categories() -> dict[str, str]:
    """Return the log categories, name to description."""
    return {kind.name: kind.description for kind in CATEGORIES.values()} | dict([ALL])


def why_not(states: State) -> str:
    """Return why a variable cannot be set now that can be set in ``states``."""
    return FIXED if states else CALCULATED


def sentence(name: str, *values: object) -> str:
    """Return the sentence of a message."""
    return MESSAGES[name].sentence % values


def header() -> str:
    """Return ``life.h``: these tables for the C runtime."""
    return "\n".join(_header()) + "\n"


def _header() -> Iterable[str]:
    yield "/* The life of an instance: states, calls, categories and messages. Written from navfmu/export/life.py. */"
    yield "#ifndef NAVFMU_LIFE_H"
    yield "#define NAVFMU_LIFE_H"
    yield ""
    yield f"typedef enum {{ {', '.join(f'{state.name} = {state.value}' for state in State)} }} Phase;"
    yield f"enum {{ PHASES = {int(_ALWAYS)} }}; /* all of them */"
    yield ""
    yield "static inline const char *phase_name(long long phase) {"
    yield "    switch (phase) {"
    yield from (f"        case {state.name}: return {json.dumps(text)};" for state, text in WHEN.items())
    yield '        default: return "now";'
    yield "    }"
    yield "}"
    yield ""
    yield "/* The phases in which a function may be called. */"
    yield from (f"#define IN_{name} {int(states)}" for name, states in CALLS.items())
    yield ""
    yield "/* Why a variable cannot be set that could be set earlier, and one that never can. */"
    yield f"#define WHY_FIXED {json.dumps(FIXED)}"
    yield f"#define WHY_CALCULATED {json.dumps(CALCULATED)}"
    yield ""
    yield "/* Log categories: name, bit, fmi2Status; the last stands for all. */"
    yield f"typedef enum {{ {', '.join(CATEGORIES)} }} Severity;"
    yield "static const struct {"
    yield "    const char *name;"
    yield "    int bits, status;"
    yield "} categories[] = {"
    kinds = list(CATEGORIES.values())
    yield from (f"    {{{json.dumps(kind.name)}, {1 << i}, {kind.status}}}," for i, kind in enumerate(kinds))
    yield f"    {{{json.dumps(ALL[0])}, {(1 << len(kinds)) - 1}, 0}},"
    yield "};"
    unasked = sum(1 << i for i, kind in enumerate(kinds) if kind.unasked)
    yield f"enum {{ LOG_EVENTS = 1, LOG_UNASKED = {unasked}, LOG_ALL = {(1 << len(kinds)) - 1} }};"
    names = [kind.name for kind in kinds]
    yield f"#define CATEGORY_NAMES {json.dumps(', '.join(names) + f' or {ALL[0]}')}"
    yield ""
    yield "/* Messages: severity and sentence, the second and third argument of instance_say. */"
    yield from (f"#define SAY_{name} {said.category}, {json.dumps(said.sentence)}" for name, said in MESSAGES.items())
    yield ""
    yield "#endif"
