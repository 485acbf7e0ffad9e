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

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from navfmu.campaign.asked import requirement_of
from navfmu.campaign.definition import Campaign, Case
from navfmu.campaign.requirement import MAIN, Requirement
from navfmu.campaign.runs import experiment_of
from navfmu.campaign.schema import CampaignFile, CaseEntry
from navfmu.campaign.seeds import parse_seeds
from navfmu.engine.clock import Clock
from navfmu.engine.plan import ALGORITHMS, Plan
from navfmu.errors import NavfmuError, nearest
from navfmu.faults import Fault, load_faults
from navfmu.files.reading import located, what_is
from navfmu.files.schema import validated
from navfmu.files.toml import Document, Place
from navfmu.fmi.seconds import seconds
from navfmu.ssp import reader
from navfmu.system import shipped
from navfmu.system.system import System


def load_campaign(path: str | Path, seeds: str | None = None, *, strict: bool = False) -> Campaign:
    """Read a campaign file and load its systems; ``seeds`` replaces those of the file ("1-100").

    ``strict`` refuses systems and FMUs that are not as SSP and FMI have it.
    """
    document = Document.read(path, "campaign file")
    return _Reader(Path(path), document, validated(document, CampaignFile), strict).read(seeds)


class _Reader:
    def __init__(self, path: Path, document: Document, content: CampaignFile, strict: bool) -> None:
        self.path, self.document, self.content, self.strict = path, document, content, strict

    def read(self, seeds: str | None) -> Campaign:
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
        cases = self.cases(main)
        campaign = Campaign(
            name=self.name(self.path.stem if content.name is None else content.name),
            path=located(self.path),
            description=content.description,
            system=system,
            systems=systems,
            cases=cases,
            seeds=numbers or parse_seeds(content.seeds, lambda s: error(s, "seeds")),
            stop=stop,
            step=step,
            algorithm=content.algorithm,
            parameters=self.parameters(content.parameters, "parameters"),
            record=tuple(content.record or ()),
            record_period=period,
            requirements=self.requirements(systems, cases, stop),
        )
        self.dry_run(campaign)
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
        for keys, value in _leaves(given):
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
        if self.content.case is None:
            return (Case("nominal", "nothing is done to the system"),)
        cases: list[Case] = []
        for number, entry in enumerate(self.content.case):
            if entry.name in (case.name for case in cases):
                raise self.document.error(f"there are two cases named '{entry.name}'", "case", number, "name")
            faults = self.faults(system, entry, number)
            parameters = self.parameters(entry.parameters, "case", number, "parameters")
            cases.append(Case(entry.name, entry.description, faults, parameters))
        return tuple(cases)

    def faults(self, system: System, entry: CaseEntry, number: int) -> tuple[Fault, ...]:
        """The faults of a case; each knows the file that it is from."""
        names = [entry.faults] if isinstance(entry.faults, str) else entry.faults or []
        found: list[Fault] = []
        for place, name in enumerate(names):
            where = "case", number, "faults", place
            try:
                beside = self.beside(name)
                here = what_is(beside) not in (None, "a folder")
                path = beside if here else system.own_attachment("faults", name)
            except NavfmuError as error:
                raise self.document.error(str(error), *where) from None
            if not here and path == Path(name):  # not in the system either; the current folder does not matter
                raise self.document.error(f"there is no fault file '{name}'", *where)
            found += [replace(fault, file=str(path if here else name)) for fault in load_faults(path)]
        try:
            return system.faults(found)
        except NavfmuError as error:
            raise self.document.error(str(error), "case", number, "faults") from None

    def requirements(self, systems: dict[str, System], cases: Sequence[Case], stop: float) -> tuple[Requirement, ...]:
        found: list[Requirement] = []
        for number, entry in enumerate(self.content.requirement or ()):

            def error(sentence: str, *place: str | int, number: int = number) -> NavfmuError:
                return self.document.error(sentence, "requirement", number, *place)

            if entry.id in (requirement.id for requirement in found):
                raise error(f"there are two requirements '{entry.id}'", "id")
            found.append(requirement_of(entry, systems, [case.name for case in cases], stop, error))
        return tuple(found)

    # -- the dry run ---------------------------------------------------------------------------------------------

    def dry_run(self, campaign: Campaign) -> None:
        """Make the plan of one run of each variant and case, so that nothing is found wrong after hours."""
        for variant in campaign.systems:
            for number, case in enumerate(campaign.cases):
                try:
                    plan = experiment_of(campaign, variant, case).plan()
                    _refuse_idle(plan, case.faults)
                except NavfmuError as error:
                    place = self.culprit(str(error), campaign, case, number)
                    sentence = f"variant '{variant}', case '{case.name}': {error}"
                    raise self.document.error(sentence, *place) from None
        self.windows(campaign, plan.record_every * plan.clock.step)

    def culprit(self, sentence: str, campaign: Campaign, case: Case, number: int) -> Place:
        """The place of the entry that a sentence about a plan quotes, where it is one of this file."""
        for table, place in (
            (self.content.case[number].parameters if self.content.case else {}, ("case", number, "parameters")),
            (self.content.parameters, ("parameters",)),
        ):
            for keys, _ in _leaves(table):
                if f"parameter '{'.'.join(keys)}'" in sentence:
                    return *place, *keys
        for place, name in enumerate(campaign.record):
            if f"recorded signal '{name}'" in sentence:
                return "record", place
        if any(fault.where and fault.where in sentence for fault in case.faults):
            return "case", number, "faults"
        return ()

    def windows(self, campaign: Campaign, period: float) -> None:
        """Refuse a requirement that no recorded point can answer."""
        for number, requirement in enumerate(campaign.requirements):
            last = min(requirement.end, campaign.stop)
            first = math.ceil(requirement.start / period - 1e-9) * period
            if first > last + 1e-9:
                raise self.document.error(
                    f"no point is recorded from {requirement.start:g} s to {last:g} s: "
                    f"the recording period is {period:g} s",
                    "requirement",
                    number,
                    "from" if requirement.start > 0 else "to",
                )


def _refuse_idle(plan: Plan, faults: Sequence[Fault]) -> None:
    """A case must not be certified that does not happen."""
    for fault in faults:
        if fault.id in plan.idle:
            place = f"{fault.where}: " if fault.where else ""
            raise NavfmuError(f"{place}fault '{fault.id}' {plan.idle[fault.id]}: it cannot act")


def _leaves(tables: dict[str, Any], keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Keys and values of tables in tables."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from _leaves(value, (*keys, name))
        else:
            yield (*keys, name), value
