"""Phases of a flight, or whatever else has a name in a system: the tables ``[[phase]]`` of its report file.

[[phase]]
id = "approach"
when = "aircraft.altitude < 3000 ft and time > 10 min"

They are read by themselves: only faults that wait for something and requirements need them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pydantic import ConfigDict

from navfmu.errors import NavfmuError
from navfmu.expressions.meaning import compile_expression
from navfmu.files.schema import Field, Table, validated
from navfmu.files.toml import Document
from navfmu.system.default_record import Fmus


class Phase(Table):
    """A condition with a name, which faults and requirements use in their expressions."""

    id: str = Field(min_length=1, description="its name: letters, digits and _")
    when: str = Field(min_length=1, description="an expression over signals: it is this phase while that is true")


class _Phases(Table):
    model_config = ConfigDict(extra="ignore")

    phase: list[Phase] = Field([], description="phases")


def phases_of(document: Document, fmus: Fmus, others: Callable[[], Sequence[Fmus]] = tuple) -> dict[str, str]:
    """The conditions by name, of those that the variant with these FMUs has.

    What it does not have, one of the ``others`` (the other variants, opened only then) must have.
    """
    entries = validated(document, _Phases).phase
    found: dict[str, str] = {}
    for number, phase in enumerate(entries):
        if not re.fullmatch(r"(?!(?:and|or|not|true|false|time)$)[^\W\d]\w*", phase.id):
            raise document.error(
                f"'id' is '{phase.id}', expected letters, digits and '_', and no word that expressions have",
                *("phase", number, "id"),
            )
        if phase.id in found:
            raise document.error(f"there are two phases '{phase.id}'", "phase", number, "id")
        found[phase.id] = phase.when
    known = {}
    for number, name in enumerate(found):
        problem = _problem(found, name, fmus)
        if problem is None:
            known[name] = found[name]
        elif all(_problem(found, name, other) for other in others()):
            raise document.error(f"phase '{name}': {problem}", "phase", number, "when")
    return known


def named_in(phases: Mapping[str, str], texts: Iterable[str]) -> dict[str, str]:
    """Those of the phases that expressions name, or phases that they name."""
    found: dict[str, str] = {}
    waiting = list(texts)
    while waiting:
        words = set(re.findall(r"\w+", waiting.pop()))
        new = {name: text for name, text in phases.items() if name in words and name not in found}
        found |= new
        waiting += new.values()
    return dict(sorted(found.items()))


def _problem(phases: Mapping[str, str], name: str, fmus: Mapping[str, Any]) -> str | None:
    """Why a phase cannot be in the variant with these FMUs."""
    try:
        system = {component: fmu.description for component, fmu in fmus.items()}
        compile_expression(phases[name], system, named=phases, boolean=True)
    except NavfmuError as error:
        return str(error)
    return None
