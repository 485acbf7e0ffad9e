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
from = 300.0                         # s
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from navfmu.campaign.definition import Campaign, Case
from navfmu.campaign.requirement import MAIN, Requirement
from navfmu.campaign.runs import experiment_of
from navfmu.engine.clock import Clock
from navfmu.engine.plan import ALGORITHMS
from navfmu.errors import NavfmuError, nearest
from navfmu.faults import Fault, load_faults
from navfmu.fmi.values import quantity
from navfmu.ssp import reader
from navfmu.system import shipped
from navfmu.system.system import System

TOP = {
    "name": str,
    "description": str,
    "system": str,
    "variants": list,
    "seeds": (str, list),
    "stop": (int, float),
    "step": (int, float),
    "algorithm": str,
    "record": list,
    "record_period": (int, float),
    "parameters": dict,
    "case": list,
    "requirement": list,
}
CASE = {"name": str, "description": str, "faults": (str, list), "parameters": dict}
REQUIREMENT = {
    "id": str,
    "description": str,
    "severity": str,
    "signal": str,
    "at_most": (int, float, str),
    "at_least": (int, float, str),
    "percent": (int, float),
    "quantile": (int, float),
    "runs": (int, float),
    "from": (int, float),
    "to": (int, float),
    "expect": str,
    "variants": list,
    "cases": list,
}


def load_campaign(path: str | Path, seeds: str | None = None) -> Campaign:
    """Read a campaign file and load its systems; ``seeds`` replaces those of the file ("1-100")."""
    return _File(Path(path)).read(seeds)


class _File:
    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.text = path.read_text(encoding="utf-8")
        except FileNotFoundError:
            raise NavfmuError(f"{path}: no such campaign file") from None
        except UnicodeDecodeError:
            raise NavfmuError(f"{path}: the campaign file cannot be read: it is not text in UTF-8") from None
        except OSError as error:
            raise NavfmuError(f"{path}: the campaign file cannot be read: {error.strerror or error}") from None
        try:
            self.content = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            found = re.fullmatch(r"(.*) \(at (.*)\)", str(error))
            sentence, place = found.groups() if found else (str(error), "TOML")
            raise NavfmuError(f"{path}, {place}: {sentence[:1].lower()}{sentence[1:]}") from None

    # -- places --------------------------------------------------------------------------------------------------

    def line(self, key: str, table: str | None = None, index: int = 0) -> int:
        """The line of a key at the top, or in the index-th table of a kind; that of the table's head if not found."""
        lines = self.text.splitlines()
        heads = [n for n, line in enumerate(lines) if re.match(r"\s*\[", line)]
        first, last = 0, heads[0] if heads else len(lines)
        if table is not None:
            starts = [n for n in heads if re.match(rf"\s*\[+\s*{re.escape(table)}\s*\]+", lines[n])]
            if index >= len(starts):
                return self.line(table)
            first = starts[index]
            last = next((n for n in heads if n > first and not re.match(rf"\s*\[+\s*{table}\.", lines[n])), len(lines))
        pattern = re.compile(rf"""\s*["']?{re.escape(key)}["']?\s*[=.]""")
        for number in range(first, last):
            if pattern.match(lines[number]):
                return number + 1
        if table is None:
            pattern = re.compile(rf"\s*\[+\s*{re.escape(key)}\s*\]+")
            return next((n + 1 for n in heads if pattern.match(lines[n])), 1)
        return first + 1

    def error(self, sentence: str, key: str, table: str | None = None, index: int = 0) -> NavfmuError:
        """A sentence with file and line."""
        return NavfmuError(f"{self.path}, line {self.line(key, table, index)}: {sentence}")

    def checked(self, entries: dict[str, Any], known: dict[str, Any], table: str | None = None, index: int = 0) -> None:
        """Refuse unknown keys and values of the wrong type."""
        for key, value in entries.items():
            if key not in known:
                raise self.error(f"unknown entry '{key}'{nearest(key, known)}", key, table, index)
            kinds = known[key] if isinstance(known[key], tuple) else (known[key],)
            if kinds == (list,) and isinstance(value, dict):
                raise self.error(f"'{key}' is written as tables: [[{key}]]", key, table, index)
            if not isinstance(value, kinds) or isinstance(value, bool):
                expected = " or ".join(dict.fromkeys(_NAMES[kind] for kind in kinds))
                raise self.error(f"'{key}' is {value!r}, expected {expected}", key, table, index)

    # -- contents ------------------------------------------------------------------------------------------------

    def read(self, seeds: str | None) -> Campaign:
        content = self.content
        self.checked(content, TOP)
        if "system" not in content:
            raise NavfmuError(f"{self.path}: has no 'system'; expected a path or the name of a shipped system")
        system = self.system(content["system"])
        systems = self.variants(system, content.get("variants", [MAIN]))
        main = next(iter(systems.values()))
        stop = content.get("stop", main.structure.stop_time)
        step = content.get("step", main.structure.step)
        for key, value in (("stop", stop), ("step", step)):
            if value is None:
                raise NavfmuError(f"{self.path}: has no '{key}', and the system suggests none")
        clock = self.clock(step, stop)
        period = content.get("record_period")
        if period is not None:
            self.at("record_period", lambda: clock.multiple(period, "recording period"))
        algorithm = content.get("algorithm", ALGORITHMS[-1])
        if algorithm not in ALGORITHMS:
            have = " and ".join(ALGORITHMS)
            raise self.error(
                f"unknown algorithm '{algorithm}'{nearest(algorithm, ALGORITHMS)} (there are {have})", "algorithm"
            )
        chosen = content.get("seeds", [1])
        numbers = parse_seeds(seeds, lambda s: NavfmuError(f"--seeds: {s}")) if seeds else None
        cases = self.cases(main)
        campaign = Campaign(
            name=self.name(content.get("name", self.path.stem)),
            path=self.path,
            description=content.get("description", ""),
            system=system,
            systems=systems,
            cases=cases,
            seeds=numbers or parse_seeds(chosen, lambda s: self.error(s, "seeds")),
            stop=stop,
            step=step,
            algorithm=algorithm,
            parameters=self.parameters(content.get("parameters", {}), "parameters"),
            record=self.names("record", content.get("record", [])),
            record_period=period,
            requirements=self.requirements(main, tuple(systems), cases, stop),
        )
        self.dry_run(campaign)
        return campaign

    def at(self, key: str, make: Callable[[], Any]) -> Any:
        """What ``make`` returns; its error gets the line of the key."""
        try:
            return make()
        except NavfmuError as error:
            raise self.error(str(error), key) from None

    def clock(self, step: float, stop: float) -> Clock:
        key = "stop" if "stop" in self.content else "step"
        return self.at("step" if "step" in self.content and not step > 0 else key, lambda: Clock.of(step, stop))

    def name(self, name: str) -> str:
        """The campaign's name is also that of its folder."""
        if not name.strip() or name in (".", "..") or any(c in name for c in '/\\:*?"<>|') or not name.isprintable():
            raise self.error(f"'name' is {name!r}, expected a text that can name a folder", "name")
        return name

    def parameters(self, given: dict[str, Any], key: str, table: str | None = None, index: int = 0) -> dict[str, Any]:
        """Values by "component.parameter"; TOML reads the name without quotes as a table in a table."""
        flat: dict[str, Any] = {}
        for name, value in _leaves(given):
            if name in flat:
                raise self.error(f"the parameter '{name}' is given twice", key, table, index)
            flat[name] = value
        return flat

    def beside(self, name: str) -> Path:
        """A path seen from the campaign file, without the detours that would stand in reports."""
        return Path(os.path.normpath(self.path.parent / name))

    def system(self, name: str) -> Path:
        beside = self.beside(name)
        if beside.exists():
            return beside
        try:
            return shipped.system(name)
        except NavfmuError as error:
            raise self.error(f"'system': {error}", "system") from None

    def variants(self, system: Path, names: list[Any]) -> dict[str, System]:
        known = [] if system.suffix == ".fmu" else reader.variants(system)
        systems: dict[str, System] = {}
        for name in self.names("variants", names):
            if name != MAIN and name not in known:
                have = ", ".join([MAIN, *known])
                hint = nearest(name, [MAIN, *known])
                raise self.error(f"the system has no variant '{name}'{hint} (it has: {have})", "variants")
            if name in systems:
                raise self.error(f"variant '{name}' is listed twice", "variants")
            systems[name] = System.load(system, None if name == MAIN else name)
        if not systems:
            raise self.error("'variants' is empty", "variants")
        return systems

    def names(self, key: str, values: list[Any], table: str | None = None, index: int = 0) -> tuple[str, ...]:
        for value in values:
            if not isinstance(value, str):
                raise self.error(f"'{key}' holds {value!r}, expected texts", key, table, index)
        return tuple(values)

    def cases(self, system: System) -> tuple[Case, ...]:
        entries = self.tables("case")
        if not entries:
            return (Case("nominal", "nothing is done to the system"),)
        cases: list[Case] = []
        for index, entry in enumerate(entries):
            self.checked(entry, CASE, "case", index)
            name = entry.get("name")
            if not name:
                raise self.error("this case has no 'name'", "name", "case", index)
            if name in (case.name for case in cases):
                raise self.error(f"there are two cases named '{name}'", "name", "case", index)
            faults = self.faults(system, entry.get("faults", []), index)
            parameters = self.parameters(entry.get("parameters", {}), "parameters", "case", index)
            cases.append(Case(name, entry.get("description", ""), faults, parameters))
        return tuple(cases)

    def tables(self, key: str) -> list[dict[str, Any]]:
        entries = self.content.get(key, [])
        if not all(isinstance(entry, dict) for entry in entries):
            raise self.error(f"'{key}' is written as tables: [[{key}]]", key)
        return entries

    def faults(self, system: System, given: str | list[Any], index: int) -> tuple[Fault, ...]:
        """The faults of a case; each knows the file that it is from."""
        files: list[str | Path] = []
        for name in self.names("faults", [given] if isinstance(given, str) else given, "case", index):
            beside = self.beside(name)
            try:
                path = beside if beside.is_file() else system.attachment("faults", name)
            except NavfmuError as error:
                raise self.error(str(error), "faults", "case", index) from None
            if not path.is_file():
                raise self.error(f"there is no fault file '{name}'", "faults", "case", index)
            load_faults(path)  # a mistake in it has its own place
            files.append(beside if beside.is_file() else name)
        try:
            return system.faults(files)
        except NavfmuError as error:
            raise self.error(str(error), "faults", "case", index) from None

    def requirements(
        self, system: System, variants: tuple[str, ...], cases: tuple[Case, ...], stop: float
    ) -> tuple[Requirement, ...]:
        found: list[Requirement] = []
        for index, entry in enumerate(self.tables("requirement")):
            self.checked(entry, REQUIREMENT, "requirement", index)

            def error(sentence: str, key: str, index: int = index) -> NavfmuError:
                return self.error(sentence, key, "requirement", index)

            for key in ("id", "signal"):
                if not entry.get(key):
                    raise error(f"this requirement has no '{key}'", key)
            if entry["id"] in (requirement.id for requirement in found):
                raise error(f"there are two requirements '{entry['id']}'", "id")
            found.append(self.requirement(entry, system, variants, tuple(case.name for case in cases), stop, error))
        return tuple(found)

    def requirement(
        self,
        entry: dict[str, Any],
        system: System,
        variants: tuple[str, ...],
        cases: tuple[str, ...],
        stop: float,
        error: Callable[[str, str], NavfmuError],
    ) -> Requirement:
        signal = entry["signal"]
        try:
            variable = system.variable(signal.removesuffix("@true"))
        except NavfmuError as problem:
            raise error(str(problem), "signal") from None
        if variable.causality != "output" or variable.type == "String":
            raise error(f"'{signal}' is {variable.causality} of type {variable.type}, expected an output", "signal")
        description = system.fmus[signal.partition(".")[0]].description
        bounds = {}
        for key in ("at_most", "at_least"):
            value = entry.get(key)
            try:
                bounds[key] = (
                    None if value is None else float(quantity(description, variable, value, f"'{key}' = {value}"))
                )
            except NavfmuError as problem:
                raise error(str(problem), key) from None
            if bounds[key] is not None and not math.isfinite(bounds[key]):
                raise error(f"'{key}' is {value}, expected a finite number", key)
        if bounds == {"at_most": None, "at_least": None}:
            raise error("this requirement has neither 'at_most' nor 'at_least'", "id")
        if None not in bounds.values() and bounds["at_least"] > bounds["at_most"]:
            raise error("'at_least' is above 'at_most': nothing can hold this requirement", "at_least")
        if "percent" in entry and "quantile" in entry:
            raise error("'percent' and 'quantile' exclude each other", "quantile")
        percent = None if "quantile" in entry else entry.get("percent", 100)
        for key, value, high in (
            ("percent", percent, 100),
            ("quantile", entry.get("quantile"), 1),
            ("runs", entry.get("runs", 100), 100),
        ):
            if value is not None and not 0 < value <= high:
                raise error(f"'{key}' is {value}, expected more than 0 and at most {high}", key)
        if entry.get("expect", "held") not in ("held", "violated"):
            raise error(f"'expect' is '{entry['expect']}', expected 'held' or 'violated'", "expect")
        if entry.get("expect") == "violated" and "quantile" in entry:
            raise error("'expect' = 'violated' goes with 'percent', not with 'quantile'", "expect")
        begin, end = entry.get("from", 0.0), entry.get("to", math.inf)
        if math.isnan(end):
            raise error("'to' is nan, expected a time in s", "to")
        if not 0 <= begin < min(end, stop):
            raise error(f"'from' is {begin} s, expected a time from 0 to before {min(end, stop):g} s", "from")
        for key, known in (("variants", variants), ("cases", cases)):
            for name in entry.get(key, []):
                if name not in known:
                    raise error(f"'{key}': there is no '{name}' in this campaign{nearest(str(name), known)}", key)
        return Requirement(
            id=entry["id"],
            signal=signal,
            most=bounds["at_most"],
            least=bounds["at_least"],
            unit=variable.unit or "",
            percent=percent,
            quantile=entry.get("quantile"),
            runs=entry.get("runs", 100),
            start=begin,
            end=end,
            expect_violated=entry.get("expect") == "violated",
            severity=entry.get("severity", ""),
            description=entry.get("description", ""),
            variants=tuple(entry["variants"]) if "variants" in entry else None,
            cases=tuple(entry["cases"]) if "cases" in entry else None,
        )

    def dry_run(self, campaign: Campaign) -> None:
        """Make the plan of one run of each variant and case, so that nothing is found wrong after hours."""
        for variant in campaign.systems:
            for index, case in enumerate(campaign.cases):
                try:
                    plan = experiment_of(campaign, variant, case).plan()
                except NavfmuError as error:
                    line = self.culprit(str(error), campaign, case, index)
                    where = f"variant '{variant}', case '{case.name}'"
                    raise NavfmuError(f"{self.path}{line}: {where}: {error}") from None
        self.windows(campaign, plan.record_every * plan.clock.step)

    def culprit(self, sentence: str, campaign: Campaign, case: Case, index: int) -> str:
        """The line of the entry that a sentence about a plan quotes, where it is one of this file."""
        for name in case.parameters:
            if f"parameter '{name}'" in sentence:
                return f", line {self.line('parameters', 'case', index)}"
        for name in campaign.parameters:
            if f"parameter '{name}'" in sentence:
                line = self.line(name, "parameters")
                return f", line {line}"
        if any(f"recorded signal '{name}'" in sentence for name in campaign.record):
            return f", line {self.line('record')}"
        return ""

    def windows(self, campaign: Campaign, period: float) -> None:
        """Refuse a requirement that no recorded point can answer."""
        for index, requirement in enumerate(campaign.requirements):
            last = min(requirement.end, campaign.stop)
            first = math.ceil(requirement.start / period - 1e-9) * period
            if first > last + 1e-9:
                raise self.error(
                    f"no point is recorded from {requirement.start:g} s to {last:g} s: "
                    f"the recording period is {period:g} s",
                    "from" if requirement.start > 0 else "to",
                    "requirement",
                    index,
                )


def _leaves(tables: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Names with dots, and values, of tables in tables."""
    for name, value in tables.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


_NAMES = {str: "a text", list: "a list", dict: "a table", int: "a number", float: "a number"}


def parse_seeds(value: str | list[Any], error: Callable[[str], NavfmuError]) -> tuple[int, ...]:
    """Seeds from a list of numbers or a text such as "1-8" or "1-4,10"."""
    seeds: list[int] = []
    for part in value.split(",") if isinstance(value, str) else value:
        if isinstance(part, int) and not isinstance(part, bool):
            seeds.append(part)
            continue
        found = re.fullmatch(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", part) if isinstance(part, str) else None
        if found is None:
            raise error(f"'{part}' is not a seed; expected, for example, [1, 2, 3] or \"1-8\"")
        first, last = int(found[1]), int(found[2] or found[1])
        if last < first or last - first > 1_000_000:
            raise error(f"'{part.strip()}' is not a range of seeds")
        seeds += range(first, last + 1)
    if not seeds:
        raise error("no seeds are given")
    if len(set(seeds)) < len(seeds):
        raise error("a seed is given twice")
    for seed in seeds:
        if not 0 <= seed < 2**31:
            raise error(f"the seed {seed} is out of range: expected 0 to 2147483647")
    return tuple(seeds)
