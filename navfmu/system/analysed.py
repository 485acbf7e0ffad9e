"""What analyses of a system compare, and what makes its errors: the table ``[analysis]`` of its report file.

[analysis]
errors = ["evaluation.north_error", "evaluation.east_error"]
covariance = "navigator.position_covariance"    # of these errors as claimed: nn, ne, ee
valid = "navigator.mode"
period = 1                                      # s

[[analysis.source]]
name = "wind"
errors = ["wind.sigma", "aircraft.gust_sigma"]  # parameters that are 0 where this source makes no error
claims = ["navigator.wind_sigma"]               # ... and what the estimator is told of it
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from typing import Annotated

from pydantic import AfterValidator

from navfmu.errors import NavfmuError
from navfmu.files.schema import Field, Number, Table, Texts
from navfmu.files.toml import Document
from navfmu.fmi import names
from navfmu.fmi.description import Variable
from navfmu.report.kind import pair
from navfmu.system.default_record import Fmus

SILENT = ("parameter", "input")  # what can be made 0, by a value or where it arrives


class Source(Table):
    """Something that makes errors."""

    name: str = Field(min_length=1, description="what tables call it")
    errors: Texts = Field([], description="parameters, or patterns of them, that are 0 where it makes no error")
    claims: Texts = Field([], description="what the estimator knows of it: parameters and inputs that are then 0")


class Analysis(Table):
    """Errors, their covariance as it is claimed, and where errors come from."""

    errors: Annotated[Texts, AfterValidator(pair)] = Field(description="the signals of the error along two axes")
    covariance: str = Field(description="the array of its three covariances as claimed: first, both, second")
    valid: str | None = Field(None, description="points count where this signal is not 0; default: all")
    period: Number | None = Field(
        None, gt=0, allow_inf_nan=False, description="time between points (s) at which both are of the same moment"
    )
    source: list[Source] = Field([], description="what makes errors")

    def check(self, document: Document, fmus: Fmus, others: Callable[[], Sequence[Fmus]] = tuple) -> None:
        """Refuse names that no variant has; what the variant with these ``fmus`` lacks, one of the others has."""
        for place, name in self._signals():
            if len(signals(name, fmus)) != self._wanted(place) and not any(
                len(signals(name, other)) == self._wanted(place) for other in others()
            ):
                raise document.error(f"analysis: {self._problem(place, name, fmus)}", *place)
        titles = [source.name for source in self.source]
        for number, source in enumerate(self.source):
            if titles.count(source.name) > 1:
                raise document.error(f"there are two sources '{source.name}'", "analysis", "source", number)
            for entry in ("errors", "claims"):
                for at, name in enumerate(getattr(source, entry)):
                    if not any(knobs(name, known) for known in (fmus, *others())):
                        place = ("analysis", "source", number, entry, at)
                        raise document.error(f"source '{source.name}': {unknown_knob(name, fmus)}", *place)

    def _signals(self) -> list[tuple[tuple[str | int, ...], str]]:
        found = [(("analysis", "errors", number), name) for number, name in enumerate(self.errors)]
        found.append((("analysis", "covariance"), self.covariance))
        return [*found, (("analysis", "valid"), self.valid)] if self.valid else found

    @staticmethod
    def _wanted(place: tuple[str | int, ...]) -> int:
        return 3 if place[1] == "covariance" else 1

    def _problem(self, place: tuple[str | int, ...], name: str, fmus: Fmus) -> str:
        found, wanted = signals(name, fmus), self._wanted(place)
        if found:
            return f"'{name}' stands for {len(found)} signals, expected {wanted}"
        try:
            names.find({component: fmu.description for component, fmu in fmus.items()}, name, f"'{name}'")
        except NavfmuError as error:
            return str(error)
        return f"'{name}' is no output"


def signals(name: str, fmus: Fmus) -> list[str]:
    """The outputs that a name stands for: itself or the elements of its array."""
    component, rest = names.split(name)
    found = names.elements(fmus[component].description, rest) if component in fmus else []
    return [f"{component}.{variable.name}" for variable in found if variable.causality == "output"]


def knobs(name: str, fmus: Fmus) -> dict[str, list[Variable]]:
    """The parameters and inputs that a name or pattern stands for: their elements by "component.variable".

    A pattern stands for parameters only: what is not written out whole should be of one kind.
    """
    component, rest = names.split(name)
    if component not in fmus or not rest:
        return {}
    causalities = SILENT[:1] if names.is_pattern(rest) else SILENT
    found: dict[str, list[Variable]] = {}
    for variable in fmus[component].description.variables:
        array = names.array(variable.name)
        if variable.type == "Real" and variable.causality in causalities and fnmatchcase(array, rest):
            found.setdefault(f"{component}.{array}", []).append(variable)
    return found


def unknown_knob(name: str, fmus: Fmus) -> str:
    """What is wrong with a name that stands for no parameter and no input."""
    if names.is_pattern(name):
        return f"no parameter matches '{name}'"
    try:
        found = names.find({c: fmu.description for c, fmu in fmus.items()}, name, f"'{name}'").variable
    except NavfmuError as error:
        return str(error)
    return f"'{name}' is a {found.type} {found.causality}, expected a Real parameter or input"
