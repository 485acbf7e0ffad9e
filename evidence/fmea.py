"""The failure modes and effects analysis of the backup navigator: what is injected, what is seen, who notices it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from evidence.failures.injection import FROM, Injection, injections, itself, signs_of
from evidence.failures.lines import Line, Lines, load_lines
from evidence.failures.picture import picture
from evidence.failures.sizes import campaign_of, load_sizes, row, sized
from evidence.section import Section
from navfmu.campaign import Outcome, load_campaign, run_campaign
from navfmu.campaign.requirement import wilson
from navfmu.files.writing import write_file
from navfmu.report import faults
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

SYSTEM = Path(__file__).parents[1] / "system_ssp" / "backup_navigator"
CAMPAIGNS = (SYSTEM / "campaigns" / "fmea.toml", SYSTEM / "campaigns" / "fmea_signals.toml")
LINES, SIZES = SYSTEM / "fmea" / "lines.toml", SYSTEM / "fmea" / "sizes.toml"
FALSE = 10.0
"""Share of the flights without a failure that may show a sign, percent."""
TABLE = ["line", "failure", "injected", "observed", "noticed"]
UNSEEN = ["failure", "line", "what happens", "harm in", "harm and no sign in", "outside 3 sigma with no sign, s"]
EVERY = [
    "failure", "line", "injected as", "95 % of the error, m", "largest, m", "inside 3 sigma, %", "NEES (2)",
    "noticed in", "of it by the navigator", "after, s", "first sign", "outside with no sign, s",
]  # fmt: skip
OF_SIZES = [
    "failure",
    "sizes",
    "flights of each",
    "harm in",
    "a sign in",
    "harm and no sign in",
    "harm from",
    "noticed from",
]
SIGNS = ["sign", "what it says", "expression", "by", "without a failure"]


def run(out: Path) -> Section:
    """Fly and tabulate; the page is also written as OUT/fmea.md and OUT/fmea.png."""
    lines, sizes, outcomes, rows = load_lines(LINES), load_sizes(SIZES), [], []
    for path in CAMPAIGNS:
        campaign = load_campaign(path)
        with Progress(path.stem) as progress:
            outcomes.append(run_campaign(campaign, out / path.stem, None, progress))
        failures = sized(outcomes[-1], lines, sizes)
        with Progress(f"{path.stem}, sizes") as progress:
            several = campaign_of(campaign, lines, failures, sizes.seeds)
            flown = injections(run_campaign(several, out / f"{path.stem}_sizes", None, progress), lines)
        rows += [row(each, flown) for each in failures]
    found = Analysis.of(outcomes, lines, rows)
    write_file(out / "fmea.md", found.document().encode())
    write_file(out / "fmea.png", found.picture())
    return found.section()


@dataclass(frozen=True)
class Analysis:
    """The lines, and what was injected for them."""

    lines: Lines
    references: Sequence[Injection]
    injected: Sequence[Injection]
    signs: Sequence[Sequence[str]]  # what SIGNS names
    false: Sequence[int]  # runs of each reference with a sign
    idle: int  # runs in which a fault changed nothing
    sizes: Sequence[Sequence[str]] = ()  # what OF_SIZES names

    @classmethod
    def of(cls, outcomes: Sequence[Outcome], lines: Lines, sizes: Sequence[Sequence[str]] = ()) -> Analysis:
        """From campaigns that were flown, of which a sign is the same in all; ``sizes`` are the rows of OF_SIZES."""
        every = [each for outcome in outcomes for each in injections(outcome, lines)]
        references = [each for each in every if each.case.name in lines.references]
        asked = {n: s for outcome in outcomes for n, s in signs_of(outcome.campaign.requirements).items()}
        signs = [
            [
                name,
                sign.description,
                f"`{sign.signal}`" + (f" while `{sign.when}`" if sign.when else ""),
                "navigator" if itself(sign) else "instruments",
                ", ".join(_of(each.showing(name), each.runs) for each in references if name in each.asked),
            ]
            for name, sign in asked.items()
        ]
        return cls(
            lines,
            references,
            sorted((each for each in every if each not in references), key=lambda each: _number(each.lines[0])),
            signs,
            [each.noticed for each in references],
            sum(bool(judged.answer.idle) for outcome in outcomes for judged in outcome.runs),
            sizes,
        )

    # ---- in words ----------------------------------------------------------------------------------------------------

    @cached_property
    def always(self) -> list[Injection]:
        """Failures that were noticed in every run."""
        return [each for each in self.injected if each.noticed == each.runs]

    @cached_property
    def never(self) -> list[Injection]:
        """Failures that were noticed in none."""
        return [each for each in self.injected if not each.noticed]

    @cached_property
    def unseen(self) -> list[Injection]:
        """Failures that did harm in some run with no sign, the worst first."""
        found = [each for each in self.injected if each.harmed_unseen]
        return sorted(found, key=lambda each: (-each.harmed_unseen, -float(np.median(each.misled))))

    def reference(self, injection: Injection) -> Injection:
        """The flights without the failure."""
        return next(each for each in self.references if each.case.name == injection.reference)

    @property
    def title(self) -> str:
        """What was found."""
        return (
            f"Of {len(self.injected)} failures {len(self.always)} are noticed in every run, {len(self.never)} in none; "
            f"{len(self.unseen)} do harm in some run with no sign"
        )

    def picture(self) -> bytes:
        """Error and time to notice of every failure, as PNG."""
        return picture(self.injected, self.unseen, self.title)

    def sentences(self) -> list[str]:
        """How it was done, and what it can show."""
        runs = self.references[0].runs
        every = [line for line in self.lines.line if self.of_line(line)]
        partly = [line for line in every if line.lacking]
        harmless = [each for each in self.never if each not in self.unseen]
        return [
            f"{self.title}. `python -m evidence fmea` flies {sum(each.runs for each in self.injected)} flights with a "
            f"failure and {sum(each.runs for each in self.references)} without, and writes this page.",
            f"{len(every)} of {len(self.lines.line)} lines are injected, {len(partly)} of these in part; the others "
            "need physics that no component has yet, and say which.",
            f"Each failure is flown with {runs} seeds, the same for all, so that each flight has a twin without the "
            "failure. The base system is flown: one DME receiver, two stations. GPS is lost at minute 5 and the "
            "failure begins at minute 15, unless the line says otherwise; failures of GPS begin while there is "
            "GPS, and are flown with a receiver of positions and, where (gps_signals) stands, with one of signals and "
            "a solver. "
            f"Errors are those from minute {FROM / 60:.0f} to the end, at whole seconds. Harm: in a run the error is "
            "beyond 0.5 nmi, or outside of the navigator's own 3 sigma, for more than 5 % of that time, and its twin's "
            "is not.",
            "Noticed: a sign comes up that the twin does not show. Of the navigator's outputs `doubted` and "
            "`solution.valid` are made to say so; the other signs are what an integrator would wire, from outputs of "
            "the navigator or of the instruments. They are the requirements with the severity 'sign' in "
            "`campaigns/fmea.toml` and `fmea_signals.toml`, asked at every communication point. A sign may come up "
            "because of the failure and still name another cause.",
            f"What {runs} runs can show: {_of(runs, runs)}, {_of(0, runs)}, {_of(runs // 2, runs)} of all such "
            "flights, with 95 % confidence; one size and one onset say nothing about others. Some are flown in several "
            "sizes.",
            f"Without a failure of its own a sign came up in {_of(*self.false_alarms)} flights: "
            f"{', '.join(f'{n} of {each.name}' for n, each in zip(self.false, self.references, strict=True))}. "
            f"Harm as above was found in {sum(each.harmed for each in self.references)} of them.",
            f"Failures after which no number comes out: {_names([i for i in self.injected if np.isinf(i.largest)])}. "
            f"Signs that no failure brought up: {', '.join(self.silent) or 'none'}.",
            f"Not noticed, and not harmful here: {_names(harmless)}.",
        ]

    @property
    def silent(self) -> list[str]:
        """Signs that came up in no run with a failure."""
        came = {sign for each in self.injected for sighting in each.sightings for sign in sighting.signs}
        return [sign[0] for sign in self.signs if sign[0] not in came]

    @property
    def false_alarms(self) -> tuple[int, int]:
        """Flights without a failure and with a sign, of how many."""
        return sum(self.false), sum(each.runs for each in self.references)

    def of_line(self, line: Line) -> list[Injection]:
        """What was injected for a line."""
        return [each for each in self.injected if line.number in each.lines]

    # ---- tables ------------------------------------------------------------------------------------------------------

    def row(self, line: Line) -> list[str]:
        """What TABLE names."""
        found = self.of_line(line)
        lacking = f"not injected: {line.lacking}" if line.lacking else ""
        if not found:
            return [line.number, line.failure, lacking, "", ""]
        injected = [f"{each.name}: {each.words}" for each in found]
        return [
            line.number,
            line.failure,
            "; ".join([*injected, *([lacking] if lacking else [])]),
            self._observed(found),
            self._noticed(found),
        ]

    def _observed(self, found: Sequence[Injection]) -> str:
        """Errors of all that was injected, beside those without a failure."""
        numbers = [each for each in found if np.isfinite(each.percentile)]
        lost = [each for each in found if each not in numbers]
        said = []
        if numbers:
            without = dict.fromkeys(f"{self.reference(each).percentile:.0f} m" for each in numbers)
            said.append(
                f"95 % of the error within {_range([each.percentile for each in numbers])} m (without "
                f"{', '.join(without)}), inside 3 sigma for {_range([each.inside for each in numbers])} %"
            )
        if lost:
            said.append(f"the solution is no number: {_names(lost)}")
        return "; ".join(said)

    def _noticed(self, found: Sequence[Injection]) -> str:
        groups = {
            "HARM AND NO SIGN": [f"{e.name} in {e.harmed_unseen} of {e.runs}" for e in found if e.harmed_unseen],
            "in every run": [f"{e.name} after {_middle(e.delays)} s" for e in found if e.noticed == e.runs],
            "at times": [f"{e.name} {_of(e.noticed, e.runs)}" for e in found if 0 < e.noticed < e.runs],
            "not noticed": [e.name for e in found if not e.noticed],
        }
        return "; ".join(f"{words}: {', '.join(names)}" for words, names in groups.items() if names)

    def every_row(self, each: Injection) -> list[str]:
        """What EVERY names."""
        return [
            each.name, ", ".join(each.lines), _injected_as(each), _metres(each.percentile), _metres(each.largest),
            f"{each.inside:.1f}", "-" if np.isnan(each.nees) else f"{each.nees:.2f}", _of(each.noticed, each.runs),
            f"{each.noticed_itself}",
            f"{_middle(each.delays)} ({_range(each.delays)})" if each.delays.size else "",
            ", ".join(each.firsts),
            f"{_middle(each.misled)} ({_range(each.misled)})" if np.any(each.misled) else "0",
        ]  # fmt: skip

    def unseen_row(self, each: Injection) -> list[str]:
        """What UNSEEN names."""
        return [
            each.name, ", ".join(each.lines), each.words, _of(each.harmed, each.runs),
            _of(each.harmed_unseen, each.runs), f"{_middle(each.misled)} (at most {np.max(each.misled):.0f})",
        ]  # fmt: skip

    def tables(self) -> list[tuple[str, str, list[str], list[list[str]]]]:
        """Heading, a sentence, headings and rows of each table."""
        return [
            (
                "What does harm and is not noticed",
                "The worst first.",
                UNSEEN,
                [self.unseen_row(e) for e in self.unseen],
            ),
            (
                "How large a failure must be",
                "Some of the failures in several sizes: in how many flights there is harm, a sign, harm with no sign, "
                "and the first of the sizes at which there is harm, and a sign, in most of them.",
                OF_SIZES,
                [list(row) for row in self.sizes],
            ),
            ("Every line", "", TABLE, [self.row(line) for line in self.lines.line]),
            (
                "Every failure",
                "The first rows are flights without one. Times are the median and, in brackets, the least and the "
                "greatest; those to a sign count from the onset. The last column: how long the error is outside of the "
                "navigator's own 3 sigma before any sign.",
                EVERY,
                [self.every_row(each) for each in (*self.references, *self.injected)],
            ),
            (
                "The signs",
                "The last column: flights without a failure that show the sign, "
                f"{', '.join(each.name for each in self.references)}, of those that are asked for it.",
                SIGNS,
                list(map(list, self.signs)),
            ),
        ]

    # ---- pages -------------------------------------------------------------------------------------------------------

    def document(self) -> str:
        """The page in Markdown."""
        parts = ["# What can fail in the backup navigator, and who notices it", "", *_paragraphs(self.sentences())]
        parts += ["![Error and time to notice of every failure](fmea.png)", ""]
        for heading, sentence, headings, rows in self.tables():
            parts += [f"## {heading}", "", *([sentence, ""] if sentence else []), *_table(headings, rows)]
        return "\n".join(parts)

    def section(self) -> Section:
        """The same as a part of the evidence."""

        def write(page: Page) -> None:
            page.heading("Failure modes and effects")
            for sentence in self.sentences():
                page.text(sentence.replace("`", ""))
            page.picture(self.picture(), "Error and time to notice of every failure")
            for heading, sentence, headings, rows in self.tables():
                page.heading(heading, 3)
                if sentence:
                    page.text(sentence)
                page.table(headings, [[cell.replace("`", "") for cell in row] for row in rows])

        false, flights = self.false_alarms
        failed = sum(each.failed for each in (*self.references, *self.injected))
        return Section(
            [
                Claim(
                    "Without a failure hardly any flight shows a sign that something is wrong", 100.0 * false / flights,
                    FALSE, False, "%", "Flights without a failure show signs that something is wrong",
                ),
                Claim("Every flight of the analysis ends", failed, 0, False),
                Claim("Every failure that is injected changes something in every flight", self.idle, 0, False),
            ],
            write,
        )  # fmt: skip


def _injected_as(injection: Injection) -> str:
    """Type, target and values of the faults; or the parameters of the case."""
    parts = []
    for fault in injection.faults:
        _, target, what, when = faults.cells(fault.describe())
        parts.append(f"{what} at {target}, {when} s")
    values = ", ".join(f"{name} = {value}" for name, value in injection.case.parameters.items())
    return "; ".join([*parts, *([values] if values else [])])


def _of(count: int, total: int) -> str:
    """A number of runs, and the share of all such flights that it shows with 95 % confidence."""
    if not total:
        return "no runs"
    if count in (0, total):
        share = 100.0 * 0.05 ** (1.0 / total)
        bound = f"at least {share:.0f} %" if count else f"at most {100.0 - share:.0f} %"
    else:
        low, high = wilson(count, total)
        bound = f"{low:.0f} to {high:.0f} %"
    return f"{count} of {total} ({bound})"


def _middle(values: np.ndarray) -> str:
    return f"{np.median(values):.0f}"


def _range(values: Sequence[float] | np.ndarray) -> str:
    low, high = f"{min(values):.0f}", f"{max(values):.0f}"
    return low if low == high else f"{low} to {high}"


def _metres(value: float) -> str:
    return f"{value:.0f}" if np.isfinite(value) else "no number"


def _names(injections: Sequence[Injection]) -> str:
    return ", ".join(each.name for each in injections) or "none"


def _number(line: str) -> int:
    return int(line[1:])


def _paragraphs(sentences: Sequence[str]) -> list[str]:
    return [line for sentence in sentences for line in (sentence, "")]


def _table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    lines = ["| " + " | ".join(row) + " |" for row in [headings, *rows]]
    return [lines[0], "|---" * len(headings) + "|", *lines[1:], ""]
