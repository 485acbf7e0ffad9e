"""FMUs that others have published, in our master and in FMPy.

The environment variable NAVFMU_PUBLIC_FMUS names a folder that is searched for FMI 2.0 co-simulation FMUs with a binary
for this machine, for instance checkouts of FMPy, libcosim, Ecos and OMSimulator. None of them is part of the project.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from evidence.one_fmu import Answer, Start
from evidence.section import Section, left_out
from navfmu.errors import NavfmuError
from navfmu.files.digest import content_hash
from navfmu.fmi.description import Description
from navfmu.fmi.fmu import binaries, describe, platforms
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

HEADING = "Public FMUs"
VARIABLE = "NAVFMU_PUBLIC_FMUS"
STEPS = 200  # at most
STEP, STOP = 0.01, 1.0  # s, of FMUs that suggest none
FURTHER, MORE = 0.25, 1.01  # what start values of inputs are raised by, those of parameters multiplied with
TIMEOUT = 120.0  # s, for one FMU in one host
EQUAL = 1e-9
"""Up to this part of a signal's range two numbers are the same: times of FMPy and ours differ in the last place."""


@dataclass(frozen=True)
class Outcome:
    """One FMU in both hosts: what each recorded, or a sentence why it did not."""

    name: str
    tool: str
    step: float  # s
    fmpy: Answer | str
    here: Answer | str

    @cached_property
    def difference(self) -> tuple[float, str]:
        """The largest difference as a part of the signal's range, and the signal."""
        if isinstance(self.fmpy, str) or isinstance(self.here, str):
            return 0.0, ""
        worst = 0.0, ""
        for name, values in self.fmpy.items():
            theirs, ours = np.array(values, float), np.array(self.here.get(name, ()), float)
            if theirs.shape != ours.shape:
                return math.inf, f"{name}: {len(ours)} values instead of {len(theirs)}"
            spread = np.ptp(theirs[np.isfinite(theirs)]) if np.isfinite(theirs).any() else 0.0
            apart = np.abs(theirs - ours)[~((theirs == ours) | (np.isnan(theirs) & np.isnan(ours)))]
            part = 0.0 if not apart.size else float(np.max(apart) / (spread or np.max(np.abs(theirs)) or 1.0))
            if not part <= worst[0]:  # also when it is no number
                worst = math.inf if math.isnan(part) else part, name
        return worst

    @property
    def verdict(self) -> str:
        """What became of it in a few words."""
        if isinstance(self.fmpy, str) and isinstance(self.here, str):
            return "refused by both"
        if isinstance(self.fmpy, str):
            return "refused by FMPy"
        if isinstance(self.here, str):
            return "refused here"
        return "equal" if self.difference[0] <= EQUAL else "differs"

    @property
    def reason(self) -> str:
        """Why it was refused, or in which signal it differs."""
        if isinstance(self.here, str):
            return self.here
        if isinstance(self.fmpy, str):
            return self.fmpy
        part, signal = self.difference
        return f"{signal}: {part:.2g} of its range" if part > EQUAL else ""


def run(out: Path) -> Section:
    """Every FMU of the folder in both hosts, each time in a process of its own."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        return left_out(HEADING, f"the environment variable {VARIABLE} does not name a folder with FMUs")
    found = candidates(Path(folder))
    if not found:
        return left_out(HEADING, f"{folder} has no FMI 2.0 co-simulation FMU with a binary for this machine")
    outcomes = []
    with tempfile.TemporaryDirectory() as place, Progress("public FMUs") as progress:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            for outcome in pool.map(lambda entry: both(*entry, Path(place)), found):
                outcomes.append(outcome)
                progress(len(outcomes), len(found), outcome.name)
    return section(outcomes)


def candidates(folder: Path) -> list[tuple[str, Path, Description]]:
    """FMUs that can be tried, by their paths in the folder; of those with the same content the first."""
    found: dict[str, tuple[str, Path, Description]] = {}
    for path in sorted(path for path in folder.rglob("*") if path.suffix.lower() == ".fmu"):
        try:
            about = describe(path)
        except NavfmuError as error:
            if "expected FMI 2.0" in str(error) or "model exchange only" in str(error):
                continue
            about = Description(path.stem, "", path.stem, ())  # FMPy may read it
        try:
            here = set(platforms()) & set(binaries(path))
        except NavfmuError:  # not even an archive
            continue
        if here:
            found.setdefault(content_hash(path), (str(path.relative_to(folder)), path, about))
    return list(found.values())


def experiment(about: Description) -> tuple[float, float]:
    """Stop and step (s) of an FMU's default experiment, at most ``STEPS`` steps.

    Where any step will do it is a power of two, because hosts add up times in different ways.
    """
    step = about.step_size or STEP
    if about.step_size is None or about.can_handle_variable_step:
        step = 2.0 ** math.floor(math.log2(step))
    return step * max(1, min(STEPS, round((about.stop_time or STOP) / step))), step


def other_start(about: Description) -> Start:
    """Start values of Real inputs and parameters that are not the FMU's own, to see whether a host sets them."""
    chosen = {}
    for variable in about.variables:
        if variable.type == "Real" and variable.causality in ("input", "parameter"):
            own = variable.start or 0.0
            value = own + FURTHER if variable.causality == "input" else own * MORE
            least = -math.inf if variable.min is None else variable.min
            greatest = math.inf if variable.max is None else variable.max
            if value != own and least <= value <= greatest:
                chosen[variable.name] = value
    return chosen


def both(name: str, path: Path, about: Description, place: Path) -> Outcome:
    """Run one FMU in both hosts, with other start values than its own where it runs with them."""
    stop, step = experiment(about)
    start = other_start(about)
    fmpy = answer("fmpy", path, stop, step, start, place)
    if start and isinstance(fmpy, str):
        start = {}
        fmpy = answer("fmpy", path, stop, step, start, place)
    return Outcome(name, about.generation_tool, step, fmpy, answer("navfmu", path, stop, step, start, place))


def answer(host: str, path: Path, stop: float, step: float, start: Start, place: Path) -> Answer | str:
    """What one FMU gives in one host, or how its process ended."""
    folder = Path(tempfile.mkdtemp(dir=place))  # FMUs of others write into the working folder
    words = [sys.executable, "-m", "evidence.one_fmu", host, str(path.resolve()), repr(stop), repr(step)]
    paths = [str(Path(__file__).resolve().parents[1]), os.environ.get("PYTHONPATH", "")]
    try:
        ended = subprocess.run(
            [*words, json.dumps(start), "answer"],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))},
            capture_output=True,
            timeout=TIMEOUT,
        )
    except subprocess.TimeoutExpired:
        return f"took longer than {TIMEOUT:g} s"
    if not (folder / "answer").is_file():
        return f"ended its process with code {ended.returncode}"
    content = json.loads((folder / "answer").read_text(encoding="utf-8"))
    return content.get("values", content.get("error"))


def section(outcomes: Sequence[Outcome]) -> Section:
    """The claims, and a table of all FMUs."""
    runs = [outcome for outcome in outcomes if not isinstance(outcome.fmpy, str)]
    refused = sum(isinstance(outcome.here, str) for outcome in runs)
    different = sum(outcome.verdict == "differs" for outcome in outcomes)
    claims = [
        Claim(
            f"Every one of {len(runs)} public FMUs that FMPy runs, runs here",
            refused, 0, at_least=False, unit="refused",
            opposite="There are public FMUs that FMPy runs and that do not run here",
        ),
        Claim(
            "Every public FMU that runs in both gives the same numbers here and in FMPy",
            different, 0, at_least=False, unit="different",
            opposite="There are public FMUs that give other numbers here than in FMPy",
        ),
    ]  # fmt: skip

    def write(page: Page) -> None:
        page.heading(HEADING)
        kinds = ("equal", "differs", "refused here", "refused by FMPy", "refused by both")
        counts = {kind: sum(outcome.verdict == kind for outcome in outcomes) for kind in kinds}
        page.text(
            f"{len(outcomes)} FMUs: " + ", ".join(f"{count} {kind}" for kind, count in counts.items() if count) + ". "
            f"Where that runs, Real inputs start {FURTHER:g} higher and Real parameters {MORE - 1:.0%} higher than the "
            "FMU says. "
            f"Equal: all outputs within {EQUAL:g} of their range at every communication point."
        )
        page.table(
            ["FMU", "made by", "step, s", "verdict", "why"],
            [[o.name, o.tool, f"{o.step:g}", o.verdict, o.reason] for o in outcomes],
            lambda row, column: None if column != 3 else "good" if outcomes[row].verdict == "equal" else "bad",
        )

    return Section(claims, write)
