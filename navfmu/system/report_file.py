"""What a system says about its report: ``report.toml``, beside its documents or under ``extra/`` of its package.

record = ["evaluation", "navigator"]        # recorded when nothing is named

[[picture]]
kind = "percentiles"                        # the kinds are the files in navfmu/report/pictures
signal = "evaluation.horizontal_error"

[[statistic]]                               # ... and in navfmu/report/statistics
...
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Annotated, Any

from navfmu.errors import NavfmuError, nearest
from navfmu.files.schema import Field, Table, Texts, validated
from navfmu.files.toml import Document
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.report import pictures, statistics
from navfmu.report.kind import Kind, Picture, Statistic, kinds
from navfmu.report.notice import Notice
from navfmu.system.analysed import Analysis
from navfmu.system.default_record import Fmus, default_record, unknown
from navfmu.system.phase import Phase, phases_of

PICTURES: dict[str, type[Picture]] = kinds(pictures, "Picture")
STATISTICS: dict[str, type[Statistic]] = kinds(statistics, "Statistic")


def _one_of(classes: Mapping[str, type[Kind]]) -> Any:
    several = reduce(or_, classes.values())
    return Annotated[several, Field(discriminator="kind")] if len(classes) > 1 else several


class Content(Table):
    """What may stand in a report file."""

    record: Texts = Field([], description="components, bundles or signals that are recorded when nothing is named")
    picture: list[_one_of(PICTURES)] = Field([], description="pictures, in the order of the report")
    statistic: list[_one_of(STATISTICS)] = Field([], description="statistics of campaigns")
    notice: list[Notice] = Field([], description="signals that say that the system has noticed something")
    phase: list[Phase] = Field([], description="conditions with a name, for faults and requirements")
    analysis: Analysis | None = Field(None, description="what analyses compare: errors, what is claimed, sources")


@dataclass(frozen=True)
class ReportFile:
    """A report file that fits its system."""

    pictures: tuple[Picture, ...]
    statistics: tuple[Statistic, ...]
    notices: tuple[Notice, ...] = ()
    analysis: Analysis | None = None

    @classmethod
    def of(cls, document: Document, fmus: Fmus, others: Callable[[], Sequence[Fmus]] = tuple) -> ReportFile:
        """What a file says, with all its names checked against a system.

        What ``fmus`` do not have, one of the ``others`` (the other variants, opened only then) must have.
        """
        for entry, classes in (("picture", PICTURES), ("statistic", STATISTICS)):
            _check_kinds(document, entry, classes)
        content = validated(document, Content)
        default_record(document, fmus, others)
        phases_of(document, fmus, others)
        made = cls(tuple(content.picture), tuple(content.statistic), tuple(content.notice), content.analysis)
        made._check(document, fmus, others)
        if content.analysis is not None:
            content.analysis.check(document, fmus, others)
        return made

    def signals(self, fmus: Fmus) -> list[str]:
        """What pictures, statistics and notices need that can be made of the variant with these FMUs."""
        entries = (*self.pictures, *self.statistics, *self.notices)
        return list(dict.fromkeys(name for e in entries if not missing(e, fmus) for name in e.needs()))

    def _check(self, document: Document, fmus: Fmus, others: Callable[[], Sequence[Fmus]]) -> None:
        every = (("picture", self.pictures), ("statistic", self.statistics), ("notice", self.notices))
        for kind, entries in every:
            for number, entry in enumerate(entries):
                for name in missing(entry, fmus):
                    if not any(_found(name, other, name in entry.constants()) for other in others()):
                        place = _place(document.content[kind][number], name, (kind, number))
                        raise document.error(f"{kind} '{entry.called}': {unknown(name, fmus)}", *place)
                if not missing(entry, fmus):
                    try:
                        entry.check(units(entry, fmus))
                    except NavfmuError as error:
                        raise document.error(f"{kind} '{entry.called}': {error}", kind, number) from None
        titles = [statistic.name for statistic in self.statistics]
        for number, name in enumerate(titles):
            if titles.count(name) > 1:
                what = f"two statistics are named '{name}'" if name else "of several statistics each needs a 'name'"
                raise document.error(f"{what}; their files are named after it", "statistic", number)


def missing(entry: Kind, fmus: Fmus) -> list[str]:
    """The signals and parameters of a picture or statistic that a variant with these FMUs does not have."""
    lacking = [name for name in entry.needs() if not _found(name, fmus, False)]
    return lacking + [name for name in entry.constants() if not _found(name, fmus, True)]


def units(entry: Kind, fmus: Fmus) -> dict[str, str]:
    """The units of all signals and parameters of a picture or statistic."""
    found = {name: _found(name, fmus, False)[0] for name in entry.needs()}
    found |= {name: _found(name, fmus, True)[0] for name in entry.constants()}
    return {name: variable.unit or "" for name, variable in found.items()}


def constants(entry: Kind, fmus: Fmus, values: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The parameters that a picture needs, lists for arrays; ``values`` are those given, by component and variable."""
    found = {}
    for name in entry.constants():
        given = values[names.split(name)[0]]
        variables = _found(name, fmus, True)
        numbers = [given.get(variable.name, variable.start) for variable in variables]
        found[name] = numbers[0] if name.endswith(f".{variables[0].name}") else numbers
    return found


def _found(name: str, fmus: Fmus, array: bool) -> list[Variable]:
    """The variable that a name stands for, or the elements of its array; empty when there is none."""
    component, rest = names.split(name.removesuffix("@true"))
    found = names.elements(fmus[component].description, rest) if component in fmus else []
    return [variable for variable in found if variable.type != "String" and (array or variable.name == rest)]


def _check_kinds(document: Document, entry: str, classes: Mapping[str, type[Kind]]) -> None:
    """Every table must say its kind before anything else in it can be judged."""
    tables = document.content.get(entry, [])
    for number, table in enumerate(tables if isinstance(tables, list) else []):
        if not isinstance(table, dict):
            continue
        kind, listed = table.get("kind"), ", ".join(classes)
        if kind is None:
            raise document.error(f"this {entry} has no 'kind' (there are: {listed})", entry, number)
        if not isinstance(kind, str) or kind not in classes:
            hint = nearest(str(kind), classes)
            raise document.error(
                f"there is no {entry} of the kind {kind!r}{hint} (there are: {listed})", entry, number, "kind"
            )


def _place(value: Any, name: str, place: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """Where in a table a name is written."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            found = _place(inner, name, (*place, key))
            if found:
                return found
        return ()
    return place if value == name else ()
