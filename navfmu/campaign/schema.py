"""What may stand in a campaign file. What must exist in the system, or fit the clock, is checked by ``file``."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator

from navfmu.campaign.design import KINDS
from navfmu.files.schema import Field, Number, Table

Time = float | str  # s, or "5 min"
Bound = float | str  # in the unit of the signal, or "0.5 nmi"


def _different(names: list[Any]) -> list[Any]:
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"holds {name!r} twice")
    return names


Some = Annotated[list[str], Field(min_length=1)]
Names = Annotated[Some, AfterValidator(_different), Field(json_schema_extra={"uniqueItems": True})]
Percent = Annotated[float, Field(gt=0, le=100)]


class CaseEntry(Table):
    """One thing that is done to the system."""

    name: str = Field(min_length=1, description="name of the case")
    description: str = Field("", description="what happens, in words")
    faults: str | Names | None = Field(
        None, description="a fault file beside this one, or the name of one inside the system; or a list"
    )
    each: str | Names | None = Field(
        None, description="fault files: one case for each fault in them, beside those of 'faults'"
    )
    pairs: str | Names | None = Field(
        None, description="fault files: one case for every two of the faults in them, beside those of 'faults'"
    )
    parameters: dict[str, Any] = Field({}, description='values by "component.parameter", laid over those of the file')


class AxisEntry(Table):
    """Something that varies from case to case: its values one by one, or from low to high."""

    name: str | None = Field(None, min_length=1, description="heading of its column; default: what it varies")
    vary: str | Names = Field(
        description='"fault.ID.ENTRY", "parameter.COMPONENT.NAME" or "step"; those of a list get the same value'
    )
    values: list[Number | bool | str] | None = Field(None, min_length=1, description="the values, one by one")
    low: Number | str | None = Field(None, description='its least value: a number, or a text such as "0.5 deg/h"')
    high: Number | str | None = Field(None, description="its greatest value, in the unit of 'low'")
    count: int | None = Field(None, ge=2, le=1_000_000, description="how many values from low to high, in a grid")
    scale: Literal["linear", "log"] = Field("linear", description="equal steps, or equal ratios, from low to high")
    search: str | None = Field(
        None, description="a requirement: look for the value between low and high at which it begins to be violated"
    )
    tolerance: Number | str | None = Field(None, description="how near that value is to be found")
    cases: Names | None = Field(None, description="cases that it varies; default: all that have what it varies")


class DesignEntry(Table):
    """Which points of the axes are taken."""

    kind: str = Field(
        "factorial",
        json_schema_extra={"enum": list(KINDS)},
        description="factorial: every value with every other; list: the first of all axes, then the second; "
        "latin_hypercube, sobol: points drawn from the whole of all axes",
    )
    count: int | None = Field(None, ge=1, le=1_000_000, description="how many points are drawn")
    seed: int | None = Field(None, ge=0, lt=2**31, description="of the points that are drawn; default: 1")


class RequirementEntry(Table):
    """A bound on a value, for a share of the time of each run or a quantile of the runs; on a count; or on a time."""

    id: str = Field(min_length=1, description="name of the requirement")
    description: str = Field("", description="the requirement in words")
    severity: str = Field("", description='how bad a violation is, for example "major"')
    signal: str | None = Field(
        None,
        min_length=1,
        description="a signal or an expression over signals; one that is true or false needs no bound",
    )
    events: str | None = Field(
        None, min_length=1, description="instead: an expression; how often it becomes true is at most 'at_most'"
    )
    detects: str | None = Field(
        None,
        min_length=1,
        description="instead: an expression that becomes true 'within' a time of the first onset of a fault",
    )
    recovers: str | None = Field(
        None,
        min_length=1,
        description="instead: an expression that is true again 'within' a time of the end of a fault, and stays so",
    )
    fault: str | None = Field(
        None, description="of 'detects' and 'recovers', the id of the fault; default: all of the case together"
    )
    within: Time | None = Field(None, description="of 'detects' and 'recovers', the longest time")
    at_most: Bound | None = Field(
        None, description='upper bound: a number in the unit of the signal, or "0.5 nmi"; of events: 0 by default'
    )
    at_least: Bound | None = Field(None, description="lower bound")
    when: str = Field("", description="an expression: asked only while it is true")
    tolerance: Time = Field(0.0, description="for how long at a time it may be outside; default: 0")
    percent: Percent | None = Field(None, description="of the communication points of each run; default: 100")
    quantile: float | None = Field(None, gt=0, le=1, description="of the runs, at every time; instead of percent")
    runs: Percent = Field(100.0, description="percent of the runs that must hold")
    begin: Time = Field(0.0, alias="from", description="time from which it is asked")
    end: Time | None = Field(None, alias="to", description="time up to which it is asked; default: to the end")
    expect: Literal["held", "violated"] = Field("held", description="whether the bound should hold, or be broken")
    variants: Names | None = Field(None, description="variants that it is asked of; default: all")
    cases: Names | None = Field(None, description="cases that it is asked of; default: all")


class CampaignFile(Table):
    """A campaign file of navfmu: variants of a system, cases, seeds and requirements."""

    name: str | None = Field(None, description="name of the campaign and of its folder; default: that of the file")
    description: str = Field("", description="what the campaign is about")
    system: str = Field(description="a path or the name of a shipped system")
    variants: Names = Field(["main"], description='variants of the system; "main" is SystemStructure.ssd')
    seeds: str | list[int | str] = Field([1], description='"1-8", or a list')
    stop: Time | None = Field(None, description="end of the runs; default: that of the system")
    step: Time | None = Field(None, description="communication step size; default: that of the system")
    algorithm: str = Field(
        "gauss_seidel", json_schema_extra={"enum": ["gauss_seidel", "jacobi"]}, description="order of the components"
    )
    record: Some | None = Field(None, description="signals beside those that requirements and pictures need")
    record_period: Time | None = Field(None, description="time between recorded points")
    parameters: dict[str, Any] = Field({}, description='values by "component.parameter", for all runs')
    case: list[CaseEntry] | None = Field(
        None, min_length=1, description="what is done to the system; default: one case, nominal"
    )
    axis: list[AxisEntry] | None = Field(None, min_length=1, description="what varies from case to case")
    design: DesignEntry | None = Field(None, description="which points of the axes are taken; default: all")
    requirement: list[RequirementEntry] | None = Field(None, min_length=1, description="what is asked of the runs")
