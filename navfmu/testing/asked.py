"""What a test requires of a run: a requirement as in a campaign file, and the sentence where it is violated."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

from navfmu.campaign.asked import requirement_of
from navfmu.campaign.finding import Finding
from navfmu.campaign.requirement import MAIN, Requirement
from navfmu.campaign.schema import RequirementEntry
from navfmu.engine.monitor import Monitor, Observed
from navfmu.errors import NavfmuError, nearest
from navfmu.expressions.meaning import compile_expression
from navfmu.files.schema import validated
from navfmu.system.system import System
from navfmu.testing.keywords import Keywords

OF_MANY = {  # entries of a campaign's requirement that need more than one run
    "quantile": "'percent' is the share of the time in a run",
    "runs": "run the test with each seed: @pytest.mark.seeds",
    "variants": "name the variant where the system is loaded",
    "cases": "the faults of the run are those that the test gives",
}


@dataclass(frozen=True)
class Asked:
    """A requirement, with the name that the test gives it, or none."""

    requirement: Requirement
    id: str
    faults: tuple[str, ...]  # of which it asks whether they act

    @classmethod
    def of(cls, signal: str | None, given: Mapping[str, Any], system: System) -> Asked:
        """The requirement that keywords describe: they are the entries of ``[[requirement]]`` in a campaign file."""
        content = ({} if signal is None else {"signal": signal}) | {k: v for k, v in given.items() if v is not None}
        keywords = Keywords(f"require({'' if signal is None else repr(signal)})", content)
        for name, instead in OF_MANY.items():
            if name in keywords.content:
                raise keywords.error(f"'{name}' is about many runs, and this is one; {instead}")
        id = keywords.content.setdefault("id", str(signal))
        entry = validated(keywords, RequirementEntry)
        requirement = requirement_of(
            entry, {system.variant or MAIN: system}, ["nominal"], math.inf, lambda text, *place: keywords.error(text)
        )
        named = requirement.program.faults
        if entry.when:
            named += compile_expression(entry.when, system.descriptions, named=system.phases).faults
        return cls(requirement, id if "id" in given else "", tuple(dict.fromkeys(named)))

    @property
    def monitor(self) -> Monitor:
        """What is asked at every communication point; requirements without a name differ in what they ask."""
        return replace(self.requirement.monitor, id=self.key)

    @property
    def key(self) -> str:
        """What names it among those of a run."""
        return f"{self.id} {self.requirement.sentence}"

    @property
    def words(self) -> str:
        """The requirement with its name: "NAV-1 (evaluation.horizontal_error <= 926 m always)"."""
        sentence = self.requirement.sentence
        return f"{self.id} ({sentence})" if self.id else f"({sentence})"

    def check_fault(self, faults: Collection[str]) -> None:
        """Refuse the name of a fault that the run does not have; ``faults`` are their ids."""
        fault = self.requirement.fault
        if fault and fault not in faults:
            have = f" (faults: {', '.join(faults) or 'none'})"
            raise NavfmuError(f"requirement {self.words}: the run has no fault '{fault}'{nearest(fault, faults)}{have}")

    def unknown(self, faults: Collection[str]) -> list[str]:
        """Sentences on faults of which it asks whether they act, and which the run does not have."""
        return [
            f"requirement {self.words} asks whether fault '{fault}' acts, and the run has none of that name"
            f"{nearest(fault, faults)}"
            for fault in self.faults
            if fault not in faults
        ]

    def judge(self, seen: Mapping[str, Any]) -> str:
        """Why a run does not hold it, or ""; ``seen`` is what the run says of its monitors."""
        finding = self.requirement.question.judge(self.requirement, Observed.restored(seen[self.key]))
        if finding is None:
            raise NavfmuError(f"requirement {self.words}: {self.requirement.question.silent}")
        held = finding.held != self.requirement.expect_violated
        return "" if held else f"requirement {self.words} {self._violated(finding)}"

    def _violated(self, finding: Finding) -> str:
        text = "is held, where it should be violated: " if self.requirement.expect_violated else "violated: "
        return text + self.requirement.question.seen(self.requirement, finding)
