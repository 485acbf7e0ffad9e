"""What a test requires of a run: a requirement as in a campaign file, and the sentence where it is violated."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from navfmu.campaign.asked import requirement_of
from navfmu.campaign.outcome import percent, told
from navfmu.campaign.requirement import MAIN, Finding, Requirement, judge
from navfmu.campaign.schema import RequirementEntry
from navfmu.errors import NavfmuError, nearest
from navfmu.files.schema import validated
from navfmu.fmi.names import short
from navfmu.system.system import System
from navfmu.testing.keywords import Keywords

if TYPE_CHECKING:
    import pandas

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
        return cls(requirement, id if "id" in given else "")

    @property
    def words(self) -> str:
        """The requirement with its name: "NAV-1 (evaluation.horizontal_error <= 926 m always)"."""
        sentence = self.requirement.sentence
        return f"{self.id} ({sentence})" if self.id else f"({sentence})"

    def judge(self, frame: pandas.DataFrame, points: np.ndarray) -> str:
        """Why a run does not hold it, or ""; ``points`` (s) were to be recorded."""
        signal = self.requirement.signal
        if signal not in frame:
            hint = nearest(signal, short(frame.columns))
            raise NavfmuError(
                f"require('{signal}'): it was not recorded in this run{hint}; name it in run(record=...), or require "
                "it before the run"
            )
        finding = judge(self.requirement, points, frame[signal].to_numpy())
        if finding is None:
            raise NavfmuError(
                f"requirement {self.words}: no point is recorded in that time; those of the run are from "
                f"{points[0]:g} s to {points[-1]:g} s, {len(points)} of them"
            )
        held = finding.held != self.requirement.expect_violated
        return "" if held else f"requirement {self.words} {self._violated(finding)}"

    def _violated(self, finding: Finding) -> str:
        requirement = self.requirement
        text = "is held, where it should be violated" if requirement.expect_violated else "violated"
        text += f": inside for {percent(finding.percent)} of the time"
        if finding.first_violation is not None:
            text += f", first outside at t = {finding.first_violation:.9g} s"
        if requirement.unit and finding.reached:
            number = math.isfinite(finding.worst)
            text += f", {f'worst {told(requirement, finding.worst)}' if number else 'not finite'}"
            text += f" at t = {finding.worst_time:.9g} s"
        return text + (f", {finding.missing} points not reached" if finding.missing else "")
