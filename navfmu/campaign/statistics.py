"""The statistics that the system's report file asks for, of every variant and case: the numbers beside the verdicts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from navfmu.campaign.outcome import Outcome
from navfmu.campaign.scenes import bounds_of, recorded
from navfmu.report.kind import Statistic
from navfmu.system.report_file import missing, units


@dataclass(frozen=True)
class Found:
    """One statistic of the report file with its rows."""

    statistic: Statistic
    rows: list[dict[str, Any]]  # with variant and case in front
    unit: str
    remarks: list[str]  # what is left out, and what is not finite

    @property
    def file(self) -> str:
        """The name of its CSV file."""
        return f"statistics_{self.statistic.name}.csv" if self.statistic.name else "statistics.csv"


def statistics(outcome: Outcome) -> Iterator[Found]:
    """Each statistic of the report file, over the runs that ended well."""
    report = next(iter(outcome.campaign.systems.values())).report
    for statistic in report.statistics if report else ():
        yield _of(outcome, statistic)


def _of(outcome: Outcome, statistic: Statistic) -> Found:
    rows: list[dict[str, Any]] = []
    remarks: list[str] = []
    unit = ""
    for variant, system in outcome.campaign.systems.items():
        lacking = missing(statistic, system.fmus)
        if lacking:
            remarks.append(f"{variant} is left out: it has no {', '.join(lacking)}")
            continue
        unit = units(statistic, system.fmus)[statistic.asked()]
        silent = []
        for case in outcome.campaign.cases:
            runs = [recorded(outcome, j, statistic.needs()) for j in outcome.of(variant, case.name) if j.error is None]
            bounds = [b for b in bounds_of(outcome, variant, case) if b.signal == statistic.asked()]
            row = statistic.row(runs, bounds) if runs else None
            if row is None:
                silent.append(case.name)
                continue
            rows.append({"variant": variant, "case": case.name} | row)
            remark = statistic.remark(runs, bounds)
            remarks += [f"{variant}, {case.name}: {remark}"] if remark else []
        if silent:
            why = f"no requirement bounds {statistic.asked()} there, or no run ended well"
            remarks.append(f"{variant} is left out in {', '.join(silent)}: {why}")
    return Found(statistic, rows, unit, remarks)
