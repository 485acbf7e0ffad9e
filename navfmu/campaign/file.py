"""Reads campaign files. Every mistake is a sentence with the file and the line.

system = "backup_navigator"          # a path (seen from this file) or a shipped system
stop = 2100.0                        # s; stop and step default to those of the system
variants = ["main", "scanning"]      # "main" is SystemStructure.ssd
seeds = "1-8"                        # or a list

[[case]]                             # what is done to the system; without any: one case "nominal"
name = "gps_lost"
faults = "../faults/gps_lost.toml"   # a file, or the name of one inside the system

[[requirement]]
id = "NAV-1"
signal = "evaluation.horizontal_error"
at_most = "0.5 nmi"                  # or a number in the signal's unit; also at_least
percent = 95                         # of the time, in each run; or quantile = 0.95 (of the runs, at every time)
from = 300.0                         # s, or "5 min"
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from navfmu.campaign.asked import requirement_of
from navfmu.campaign.axes import Axes, axes_of, design_of
from navfmu.campaign.case import Case
from navfmu.campaign.cases import Cases
from navfmu.campaign.definition import Campaign
from navfmu.campaign.rehearsal import Rehearsal, leaves
from navfmu.campaign.requirement import MAIN, Requirement
from navfmu.campaign.schema import CampaignFile
from navfmu.campaign.seeds import parse_seeds
from navfmu.engine.clock import Clock
from navfmu.engine.plan import ALGORITHMS
from navfmu.errors import NavfmuError, nearest
from navfmu.files.reading import located, what_is
from navfmu.files.schema import validated
from navfmu.files.toml import Document
from navfmu.fmi.seconds import seconds
from navfmu.ssp import reader
from navfmu.system import shipped
from navfmu.system.pool import Report
from navfmu.system.system import System

CEILING = 1_000_000  # runs of one campaign


def load_campaign(
    path: str | Path,
    seeds: str | None = None,
    *,
    strict: bool = False,
    allow: Callable[[int], None] | None = None,
    progress: Report | None = None,
) -> Campaign:
    """Read a campaign file and load its systems; ``seeds`` replaces those of the file ("1-100").

    ``strict`` refuses systems and FMUs that are not as SSP and FMI have it. ``allow`` is called with the number of runs
    that it can become, at most, before anything is made of them; it raises what ends it there.
    """
    document = Document.read(path, "campaign file")
    return _Reader(Path(path), document, validated(document, CampaignFile), strict).read(seeds, allow, progress)


class _Reader:
    def __init__(self, path: Path, document: Document, content: CampaignFile, strict: bool) -> None:
        self.path, self.document, self.content, self.strict = path, document, content, strict

    def read(self, seeds: str | None, allow: Callable[[int], None] | None, progress: Report | None) -> Campaign:
        content, error = self.content, self.document.error
        system = self.system(content.system)
        systems = self.variants(system, content.variants)
        main = next(iter(systems.values()))
        stop = self.given("stop", main.structure.stop_time)
        step = self.given("step", main.structure.step)
        clock = self.clock(step, stop)
        period = None if content.record_period is None else self.given("record_period", None)
        if period is not None:
            self.at("record_period", lambda: clock.multiple(period, "recording period"))
        if content.algorithm not in ALGORITHMS:
            have, hint = " and ".join(ALGORITHMS), nearest(content.algorithm, ALGORITHMS)
            raise error(f"unknown algorithm '{content.algorithm}'{hint} (there are {have})", "algorithm")
        numbers = parse_seeds(seeds, lambda s: NavfmuError(f"--seeds: {s}")) if seeds is not None else None
        written = self.cases(main)
        numbers = numbers or parse_seeds(content.seeds, lambda s: error(s, "seeds"))
        requirements = self.requirements(systems, written, stop)
        axes = self.axes(written, requirements)
        self.allowed(sum(axes.runs(case) for case in written) * len(systems) * len(numbers), allow)
        cases = [case for found in written for case in axes.points(found)]
        self.different(cases)
        campaign = Campaign(
            name=self.name(self.path.stem if content.name is None else content.name),
            path=located(self.path),
            description=content.description,
            system=system,
            systems=systems,
            cases=tuple(case for case in cases if not axes.searches(case)),
            seeds=numbers,
            stop=stop,
            step=step,
            algorithm=content.algorithm,
            parameters=self.parameters(content.parameters, "parameters"),
            record=tuple(content.record or ()),
            record_period=period,
            requirements=requirements,
            axes=axes.all,
            searches=tuple(search for case in cases for search in axes.searches(case)),
        )
        Rehearsal(campaign, self.document, content)(progress)
        return campaign

    # -- entries -------------------------------------------------------------------------------------------------

    def at(self, key: str, make: Callable[[], Any]) -> Any:
        """What ``make`` returns; its error gets the line of the key."""
        try:
            return make()
        except NavfmuError as error:
            raise self.document.error(str(error), key) from None

    def given(self, key: str, suggestion: float | None) -> float:
        """A time (s): the file's, or else that of the system."""
        value = getattr(self.content, key)
        if value is not None:
            return self.at(key, lambda: seconds(value, f"'{key}'"))
        if suggestion is None:
            raise self.document.error(f"has no '{key}', and the system suggests none")
        return suggestion

    def clock(self, step: float, stop: float) -> Clock:
        key = "step" if self.content.stop is None or (self.content.step is not None and not step > 0) else "stop"
        return self.at(key, lambda: Clock.of(step, stop))

    def name(self, name: str) -> str:
        """The campaign's name is also that of its folder."""
        if not name.strip() or name in (".", "..") or any(c in name for c in '/\\:*?"<>|') or not name.isprintable():
            raise self.document.error(f"'name' is {name!r}, expected a text that can name a folder", "name")
        return name

    def parameters(self, given: dict[str, Any], *place: str | int) -> dict[str, Any]:
        """Values by "component.parameter"; TOML reads the name without quotes as a table in a table."""
        flat: dict[str, Any] = {}
        for keys, value in leaves(given):
            name = ".".join(keys)
            if name in flat:
                raise self.document.error(f"the parameter '{name}' is given twice", *place, *keys)
            flat[name] = value
        return flat

    def beside(self, name: str) -> Path:
        """A path seen from the campaign file, without the detours that would stand in reports."""
        return located(self.path.parent / name)

    def system(self, name: str) -> Path:

        def found() -> Path:
            beside = self.beside(name)
            return shipped.named(name) if what_is(beside) is None else beside

        return self.at("system", found)

    def variants(self, system: Path, names: Sequence[str]) -> dict[str, System]:
        known = [MAIN] if system.suffix == ".fmu" else [MAIN, *reader.variants(system)]
        for number, name in enumerate(names):
            if name not in known:
                hint = f"{nearest(name, known)} (it has: {', '.join(known)})"
                raise self.document.error(f"the system has no variant '{name}'{hint}", "variants", number)
        return {name: System.load(system, None if name == MAIN else name, strict=self.strict) for name in names}

    def cases(self, system: System) -> tuple[Case, ...]:
        """Those of the file, before the axes."""
        if self.content.case is None:
            return (Case("nominal", "nothing is done to the system"),)
        return Cases(self.document, system, self.beside, self.parameters, CEILING).of(self.content.case)

    def axes(self, cases: Sequence[Case], requirements: Sequence[Requirement]) -> Axes:
        """What varies in the cases."""
        entries = self.content.axis or ()

        def error(table: str) -> Callable[..., NavfmuError]:
            return lambda sentence, *place: self.document.error(sentence, table, *place)

        design = design_of(self.content.design, bool(entries), error("design"))
        return axes_of(
            entries, design, cases, requirements, error("axis"), lambda number: self.document.where("axis", number)
        )

    def allowed(self, runs: int, allow: Callable[[int], None] | None) -> None:
        """Refuse more runs than can be kept; ``allow`` may refuse fewer."""
        if runs > CEILING:
            counts = (f"{count:,}".replace(",", " ") for count in (runs, CEILING))
            raise self.document.error("has {} runs, more than {}".format(*counts))
        if allow is not None:
            allow(runs)

    def different(self, cases: Sequence[Case]) -> None:
        """Refuse names that two cases have, one of the file and one of a pair or a point."""
        written = [entry.name for entry in self.content.case or ()]
        for name, count in Counter(case.name for case in cases).items():
            if count > 1:
                number = next((written.index(case.written) for case in reversed(cases) if case.name == name), 0)
                raise self.document.error(f"there are two cases named '{name}'", "case", number, "name")

    def requirements(self, systems: dict[str, System], written: Sequence[Case], stop: float) -> tuple[Requirement, ...]:
        cases = list(dict.fromkeys(case.written for case in written))
        faults = list(dict.fromkeys(fault.id for case in written for fault in case.faults))
        found: list[Requirement] = []
        for number, entry in enumerate(self.content.requirement or ()):

            def error(sentence: str, *place: str | int, number: int = number) -> NavfmuError:
                return self.document.error(sentence, "requirement", number, *place)

            if entry.id in (requirement.id for requirement in found):
                raise error(f"there are two requirements '{entry.id}'", "id")
            found.append(requirement_of(entry, systems, cases, stop, error, faults))
        return tuple(found)
