"""Plans of all that a campaign will fly, so that nothing is found wrong after hours."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from navfmu.campaign.case import Case
from navfmu.campaign.definition import Campaign
from navfmu.campaign.runs import experiment_of
from navfmu.campaign.schema import CampaignFile
from navfmu.campaign.search import Search
from navfmu.engine.plan import Plan
from navfmu.errors import NavfmuError
from navfmu.faults import Fault
from navfmu.files.toml import Document, Place
from navfmu.system.pool import Report


class Rehearsal:
    """Makes the plan of one run of each variant and case, and of the ends and the middle of each search."""

    def __init__(self, campaign: Campaign, document: Document, content: CampaignFile) -> None:
        self.campaign, self.document, self.content = campaign, document, content
        self.periods: set[float] = set()  # s, between recorded points

    def __call__(self, progress: Report | None = None) -> None:
        """Raise what is wrong as a sentence with the line that causes it."""
        campaign = self.campaign
        every = [(variant, thing) for variant in campaign.systems for thing in (*campaign.cases, *campaign.searches)]
        for number, (variant, thing) in enumerate(every):
            if isinstance(thing, Case):
                self.idle(variant, thing, self.plan(variant, thing))
            elif campaign.searched(thing, variant):
                self.search(variant, thing)
            if progress is not None:
                progress(number + 1, len(every), "checking that every case can be flown")
        for period in sorted(self.periods):
            self.windows(period)
        self.verdicts()

    def plan(self, variant: str, case: Case) -> Plan:
        """The plan of a case."""
        try:
            plan = experiment_of(self.campaign, variant, case).plan()
        except NavfmuError as error:
            raise self.error(variant, case, str(error)) from None
        self.periods.add(plan.record_every * plan.clock.step)
        return plan

    def search(self, variant: str, search: Search) -> None:
        """A fault may do nothing at one end of a search, for it may begin at 0, but not at both."""
        span = search.span
        low, high, _ = (
            self.plan(variant, search.at(value)) for value in (span.low, span.high, span.middle(span.low, span.high))
        )
        self.idle(variant, search.at(span.high), high, among=low.idle)

    def idle(self, variant: str, case: Case, plan: Plan, among: dict[str, str] | None = None) -> None:
        """A case must not be certified that does not happen."""
        for fault in case.faults:
            if fault.id in plan.idle and (among is None or fault.id in among):
                place = f"{fault.where}: " if fault.where else ""
                sentence = f"{place}fault '{fault.id}' {plan.idle[fault.id]}: it cannot act"
                raise self.error(variant, case, sentence)

    def error(self, variant: str, case: Case, sentence: str) -> NavfmuError:
        """The sentence, with the line of the entry that it is about, where it is one of this file."""
        place = self.culprit(sentence, case)
        return self.document.error(f"variant '{variant}', case '{case.name}': {sentence}", *place)

    def culprit(self, sentence: str, case: Case) -> Place:
        """The place of the entry that a sentence about a plan quotes."""
        for number, axis in enumerate(self.campaign.axes):
            if axis.name in case.values and any(v.is_quoted(sentence) for v in axis.varied):
                return "axis", number, "vary"
        number = next((n for n, entry in enumerate(self.content.case or ()) if entry.name == case.written), 0)
        for table, place in (
            (self.content.case[number].parameters if self.content.case else {}, ("case", number, "parameters")),
            (self.content.parameters, ("parameters",)),
        ):
            for keys, _ in leaves(table):
                if f"parameter '{'.'.join(keys)}'" in sentence:
                    return *place, *keys
        for place, name in enumerate(self.campaign.record):
            if f"recorded signal '{name}'" in sentence:
                return "record", place
        return self.of_fault(sentence, case.faults, number)

    def of_fault(self, sentence: str, faults: Sequence[Fault], number: int) -> Place:
        """The entry that names the files of the faults of a case."""
        places = [place for fault in faults for place in (fault.where, *fault.lines.values()) if place]
        if not any(place in sentence for place in places):
            return ()
        entry = self.content.case[number]
        return "case", number, next(k for k in ("faults", "each", "pairs") if getattr(entry, k) is not None)

    def verdicts(self) -> None:
        """Refuse a requirement that neither gets a verdict nor is searched."""
        campaign = self.campaign
        goals = {search.requirement for search in campaign.searches}
        for number, requirement in enumerate(campaign.requirements):
            asked = any(requirement.applies(v, case) for v in campaign.systems for case in campaign.cases)
            if not asked and requirement.id not in goals:
                raise self.document.error(
                    f"{requirement.id} is asked in cases only that are searched for another requirement, and runs of "
                    "a search make no verdict",
                    *("requirement", number, "id" if requirement.cases is None else "cases"),
                )

    def windows(self, period: float) -> None:
        """Refuse a quantile that no recorded point can answer; there is one every ``period`` (s)."""
        for number, requirement in enumerate(self.campaign.requirements):
            if requirement.quantile is None:
                continue
            last = min(requirement.end, self.campaign.stop)
            first = math.ceil(requirement.start / period - 1e-9) * period
            if first > last + 1e-9:
                raise self.document.error(
                    f"no point is recorded from {requirement.start:g} s to {last:g} s: "
                    f"the recording period is {period:g} s",
                    "requirement",
                    number,
                    "from" if requirement.start > 0 else "to",
                )


def leaves(tables: dict[str, Any], keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Keys and values of tables in tables."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from leaves(value, (*keys, name))
        else:
            yield (*keys, name), value
