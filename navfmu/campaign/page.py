"""The report of a campaign as one page, from its story: conclusion, matrix, FMEA, worst cases, runs, appendix."""

from __future__ import annotations

import base64
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from navfmu.campaign.conclusion import asked, confidence, not_tested, verdict
from navfmu.campaign.drawn import LIMIT, stretches
from navfmu.campaign.fmea import NONE, by_line
from navfmu.campaign.pictured import Section
from navfmu.campaign.spread import spread, sweeps
from navfmu.campaign.statistics import Found
from navfmu.campaign.story import Story
from navfmu.report import faults
from navfmu.report.packed import ALL
from navfmu.report.page import Link, Page
from navfmu.report.repeat import section
from navfmu.report.scene import Drawn

PAPER = 400  # rows of a table without scripts, and on paper
WORST = 30  # cells in the table of the worst
ROLES = ("tested by", "reviewed by", "approved by")
SCRIPTS = tuple(f"live/{name}.js" for name in ("unpack", "grid", "curves", "tables", "detail", "start"))

CONCLUSION, MATRIX, FMEA, WORST_FIRST = (
    "Conclusion",
    "Verdict matrix",
    "By lines of the FMEA",
    "What was seen, worst first",
)
RUNS, NOTES, APPENDIX = "All runs", "Notes", "Appendix: cases and faults"


def page(
    story: Story,
    tested: Sequence[tuple[str, str]],
    about: Mapping[str, Any],
    numbers: Sequence[Found],
    pictures: Sequence[Section],
) -> Page:
    """The whole report."""
    result = Page(f"Campaign {story['name']}", story["description"], contents=True)
    result.block("live/live.html.j2", look="live/live.css")
    _conclusion(result, story, tested)
    _matrix(result, story)
    _thresholds(result, story)
    _fmea(result, story)
    _worst(result, story)
    _pictures(result, story, pictures)
    _runs(result, story)
    _drawn(result, "Worst values of all runs", spread(story), tall=True)
    _drawn(result, "Along what was varied", sweeps(story))
    _statistics(result, numbers)
    _failures(result, story)
    _notes(result, story)
    _cases(result, story)
    result.text("What each case does is in the table above, and with every fault in all its entries in campaign.json.")
    section(result, {name: value for name, value in about.items() if name not in ("cases", "searches")})
    _live(result, story)
    return result


# ---- conclusion -----------------------------------------------------------------------------------------------------


def _conclusion(result: Page, story: Story, tested: Sequence[tuple[str, str]]) -> None:
    result.heading(CONCLUSION)
    result.block("live/verdict.html.j2", text=verdict(story), good=story["passed"])
    found = [one for one in asked(story) if one.cells]
    if found:
        rows = []
        for one in found:
            place, cell = one.weakest
            requirement = one.requirement
            interval = _interval(cell)
            rows.append(
                [
                    requirement["id"] + (f" ({requirement['severity']})" if requirement["severity"] else ""),
                    _asked(requirement),
                    f"{one.held} of {len(one.cells)}",
                    f"{place}: {cell['held']} of {cell['total']} runs{f' ({interval})' if interval else ''}",
                ]
            )
        result.table(
            ["requirement", "asked", "holds in", "weakest, with the 95 % interval of the share of runs"],
            rows,
            lambda row, column: (
                ("good" if found[row].held == len(found[row].cells) else "bad") if column == 2 else None
            ),
        )
    result.heading("What the number of runs can show", 3)
    result.items(confidence(story))
    result.heading("What was not tested", 3)
    result.items(not_tested(story))
    result.heading("What was tested", 3)
    result.table(["", ""], tested)
    result.heading("Signatures", 3)
    result.block("live/sign.html.j2", roles=ROLES)


def _interval(cell: Mapping[str, Any]) -> str:
    return "" if cell["interval"] is None else f"{cell['interval'][0]:.0f} to {cell['interval'][1]:.0f} %"


# ---- what was seen --------------------------------------------------------------------------------------------------


def _matrix(result: Page, story: Story) -> None:
    result.heading(MATRIX)
    if not any(cell for group in story["groups"] for cell in group["cells"]):
        every = "Every case is searched." if story["requirements"] and not story["cases"] else ""
        result.text(every or "The campaign has no requirements.")
        return
    result.text(
        "Runs that hold of all runs. On a screen a cell opens what was seen and its runs, a run its curves. In the "
        "table the arrow keys go from cell to cell, Enter opens, Escape closes; headings sort."
    )
    result.block("live/table.html.j2", name="matrix")
    groups = sorted(
        story["groups"],
        key=lambda group: min((cell["rank"] for cell in group["cells"] if cell), default=[2.0]),
    )
    groups = story["groups"] if len(groups) <= PAPER else groups[:PAPER]

    def style(row: int, column: int) -> str | None:
        if column < 2:
            return None
        cell = groups[row]["cells"][column - 2]
        return "none" if cell is None else "good" if cell["passed"] else "bad"

    rows = []
    for group in groups:
        case = story["cases"][group["case"]]
        rows.append([group["variant"], case["name"], *(_cell(cell) for cell in group["cells"])])
    headings = ["variant", "case", *(requirement["id"] for requirement in story["requirements"])]
    result.table(headings, rows, style, paper=True)
    _rest(result, len(story["groups"]), len(groups), "verdicts.csv", "the worst")
    result.items(_in_words(requirement) for requirement in story["requirements"])


def _cell(cell: Mapping[str, Any] | None) -> str:
    return "not asked" if cell is None else f"{_verdict(cell)} {cell['held']}/{cell['total']}"


def _verdict(cell: Mapping[str, Any]) -> str:
    """Louder where it does not hold, for those who see no colours."""
    return cell["verdict"] if cell["passed"] else cell["verdict"].upper()


def _in_words(requirement: Mapping[str, Any]) -> str:
    severity = f" ({requirement['severity']})" if requirement["severity"] else ""
    return f"{requirement['id']}{severity}: {_asked(requirement)}"


def _asked(requirement: Mapping[str, Any]) -> str:
    """The requirement in the words of the file, if it has any, and as it is computed."""
    words = f"{requirement['description']}: " if requirement["description"] else ""
    return f"{words}{requirement['sentence']}"


def _rest(result: Page, total: int, shown: int, file: str, which: str = "the first") -> None:
    """Say that a table does not show all."""
    if shown < total:
        result.text(f"On paper, and without scripts, these are {which} {shown} of {total} rows; all are in {file}.")


def _thresholds(result: Page, story: Story) -> None:
    """Where requirements begin to be violated: over all seeds, and of each."""
    thresholds = story["thresholds"]
    if not thresholds:
        return
    result.heading("Where requirements begin to be violated")
    result.text(
        "Found by bisection: of two values that are as near to one another as was asked, one holds and the other "
        "violates. Where it holds, is violated and holds again in between, one of these changes was found."
    )
    summary: dict[tuple[str, ...], list[dict[str, Any]]] = {}
    for row in thresholds:
        varied = f"{row['axis']} ({row['unit']})" if row["unit"] else row["axis"]
        summary.setdefault((row["variant"], row["case"], row["requirement"], varied), []).append(row)
    headings = ["variant", "case", "requirement", "varied", "seeds", "with a bracket", "violated at", "holds at"]
    result.table(headings, [[*place, *_over_seeds(found)] for place, found in summary.items()])
    inner = Page("")
    names = ("variant", "case", "seed", "requirement", "runs", "seen")
    inner.table(names, [[str(row[name]) for name in names] for row in thresholds[:PAPER]])
    _rest(inner, len(thresholds), PAPER, "thresholds.csv")
    result.folded(f"{len(thresholds)} searches, one for each seed", inner)
    if not any(cell for group in story["groups"] for cell in group["cells"]):
        result.items(_in_words(requirement) for requirement in story["requirements"])


def _over_seeds(found: Sequence[Mapping[str, Any]]) -> list[str]:
    """How many seeds, how many of them with a bracket, the values that violate, the values that hold."""
    both = sum(None not in (row["holds_at"], row["violated_at"]) for row in found)
    return [str(len(found)), str(both), *(_range(row[name] for row in found) for name in ("violated_at", "holds_at"))]


def _range(values: Iterable[float | None]) -> str:
    """From the least to the greatest of values, some of which may be missing."""
    there = sorted(value for value in values if value is not None)
    return " to ".join(f"{value:.9g}" for value in dict.fromkeys((*there[:1], *there[-1:]))) or "-"


def _fmea(result: Page, story: Story) -> None:
    lines = by_line(story)
    if not lines:
        return
    result.heading(FMEA)
    result.text(
        "The runs in which a fault of the line acts, alone or together with others of its case; of what is asked of a "
        "percentile, the cells of the matrix. "
        + (
            "Noticed: the system begins to say that something is wrong when the fault has begun, or later; what it can "
            f"say is: {', '.join(story['noticing'])}. It may say so for another reason."
            if story["noticing"]
            else "Whether the system notices is not known: its report file names no signal that says so."
        )
    )
    ids = [requirement["id"] for requirement in story["requirements"]]
    seen = ["noticed in"] if story["noticing"] else []
    written = {case["name"]: case["written"] for case in story["cases"]}
    rows, styles = [], []
    for line in lines:
        what = "; ".join(f"{name}: {words}" if words else name for name, words in line["faults"].items())
        held = [_counted(r, pair) for r, pair in zip(story["requirements"], line["held"], strict=True)]
        told = [f"{line['noticed']} of {line['runs']}"] if story["noticing"] else []
        idle = f"; changed nothing in {line['idle']} runs" if line["idle"] else ""
        rows.append(
            [line["line"], what + idle, _some(_gathered(line["cases"], written)), str(line["runs"]), *told, *held]
        )
        every = ["none" if pair is None else "good" if pair[0] == pair[1] else "bad" for pair in line["held"]]
        styles.append([None, "words", None, None, *(None for _ in seen), *every])
    headings = ["FMEA", "injected", "cases", "runs", *seen, *(f"{name} holds in" for name in ids)]
    result.table(headings, rows, lambda row, column: styles[row][column])
    if any(line["line"] == NONE for line in lines):
        result.text(f"{NONE}: these faults name no line ('fmea' in their file).")


def _counted(requirement: Mapping[str, Any], pair: tuple[int, int] | None) -> str:
    """In how many runs, or variants and cases, it holds."""
    if pair is None:
        return "not asked"
    return f"{pair[0]} of {pair[1]}{'' if requirement['quantile'] is None else ' cells'}"


def _gathered(cases: Sequence[str], written: Mapping[str, str]) -> list[str]:
    """Cases as they are written in the file, and how many each stands for."""
    counts = Counter(written[case] for case in cases)
    return [name if count == 1 else f"{name} ({count} cases)" for name, count in counts.items()]


def _some(names: Sequence[str], most: int = 6) -> str:
    return ", ".join(names) if len(names) <= most else f"{', '.join(names[:most])} and {len(names) - most} more"


def _worst(result: Page, story: Story) -> None:
    found = [
        (number, place, cell)
        for number, group in enumerate(story["groups"])
        for place, cell in enumerate(group["cells"])
        if cell is not None
    ]
    if not found:
        return
    found.sort(key=lambda entry: entry[2]["rank"])
    violated = sum(cell["verdict"] == "violated" for _, _, cell in found)
    result.heading(WORST_FIRST)
    shown = found[:WORST]
    if len(shown) < len(found):
        result.text(
            f"The worst {len(shown)} of {len(found)} cells, of which {violated} are violated; the matrix opens all."
        )
    rows = []
    for number, place, cell in shown:
        group = story["groups"][number]
        rows.append(
            [
                story["requirements"][place]["id"],
                group["variant"],
                story["cases"][group["case"]]["name"],
                _verdict(cell),
                _interval(cell),
                cell["sentence"],
                ""
                if cell["worst"] is None
                else Link(f"seed {story['runs'][cell['worst']]['seed']}", f"#run/{cell['worst']}"),
            ]
        )
    result.table(
        ["requirement", "variant", "case", "verdict", "95 % interval of the share of runs", "seen", "worst run"],
        rows,
        lambda row, column: ("good" if shown[row][2]["passed"] else "bad") if column == 3 else None,
    )


def _pictures(result: Page, story: Story, pictures: Sequence[Section]) -> None:
    if not pictures:
        return
    result.heading("Pictures of the worst")
    if len(pictures) < len(story["groups"]):
        result.text(
            f"Of {len(pictures)} of {len(story['groups'])} combinations of variant and case, the worst first. The "
            "curves of each run open from the matrix and from the list of all runs."
        )
    for one in pictures:
        result.heading(one.name, 3)
        for line in one.lines:
            result.text(line)
        result.code(one.command)
        if one.shown is not None:
            result.link("Open this run", f"#run/{one.shown}")
        for drawn in one.drawn:
            result.picture(drawn.png, drawn.title, drawn.caption)


def _runs(result: Page, story: Story) -> None:
    runs = story["runs"]
    result.heading(RUNS)
    left, count = [run for run in runs if run["recording"] and not run["curves"]], stretches(len(runs))
    result.text(
        f"{len(runs)} runs, the worst first: of each a click or Enter opens its findings, its faults, the command that "
        "repeats it, and its curves. The recordings are in the folder runs/ beside this report, the findings in "
        "runs.csv and runs.parquet. "
        + (
            f"Curves of more than {ALL} points are thinned out: of each of {count} stretches of equal length its "
            "ends are kept, and of errors and of what requirements ask for the least and the greatest value. "
        )
        + (
            f"The curves of the {len(left)} runs that matter least are left out, so that all curves keep to "
            f"{LIMIT / 1e6:g} MB; 'navfmu plot' draws their recordings. "
            if left
            else "No run is left out. "
        )
        + "Shown of each requirement: for which share of its time a run is inside, and its worst value."
    )
    result.block("live/table.html.j2", name="runs")
    inner, rows = Page(""), []
    for number in story["order"][:PAPER]:
        run = runs[number]
        findings = zip(story["requirements"], run["findings"], strict=True)
        told = ", ".join(
            f"{r['id']} {'as asked' if f['held'] else 'NOT as asked'}"
            for r, f in findings
            if f is not None and f["held"] is not None
        )
        rows.append([run["variant"], run["case"], str(run["seed"]), run["error"] or told, run["command"]])
    inner.table(["variant", "case", "seed", "findings", "command that repeats it"], rows)
    _rest(inner, len(runs), len(rows), "runs.csv", "the worst")
    result.folded(f"{len(rows)} runs and their commands", inner, "paper")


# ---- over all runs --------------------------------------------------------------------------------------------------


def _drawn(result: Page, heading: str, pictures: Iterable[Drawn], tall: bool = False) -> None:
    for number, drawn in enumerate(pictures):
        if number == 0:
            result.heading(heading)
        result.picture(drawn.png, drawn.title, drawn.caption, tall)


def _statistics(result: Page, found: Sequence[Found]) -> None:
    for one in found:
        result.heading(one.statistic.heading())
        if one.rows:
            result.text(one.statistic.explanation())
            headings, cells = one.statistic.table(one.rows, one.unit)
            heads = [[row["variant"], row["case"]] for row in one.rows]
            rows = [head + row for head, row in zip(heads, cells, strict=True)]
            result.table(["variant", "case", *headings], rows[:PAPER])
            if rows[PAPER:]:
                result.text(f"These are the first {PAPER} of {len(rows)} rows; all are in {one.file}.")
        if one.remarks:
            result.items(one.remarks[:PAPER])


# ---- notes ----------------------------------------------------------------------------------------------------------


def _failures(result: Page, story: Story) -> None:
    failed = [run for run in story["runs"] if run["error"] is not None]
    if failed:
        result.heading("Runs that ended with an error")
        rows = [[run["variant"], run["case"], str(run["seed"]), run["error"]] for run in failed]
        _some_rows(result, ["variant", "case", "seed", "error"], rows)


def _some_rows(result: Page, headings: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    result.table(headings, rows[:PAPER])
    if rows[PAPER:]:
        result.text(f"These are the first {PAPER} of {len(rows)} rows; all are in runs.csv.")


def _notes(result: Page, story: Story) -> None:
    """What else the reader of a verdict must know: values that are no numbers, and what the runs noted."""
    strange = [run for run in story["runs"] if run["not_finite"]]
    if strange:
        result.heading("Signals that are not finite")
        result.text("NaN and infinity count as outside every bound; a campaign with such a run does not pass.")
        rows = []
        for run in strange:
            where = [run["variant"], run["case"], str(run["seed"])]
            rows += [[*where, name, str(count)] for name, count in run["not_finite"].items()]
        _some_rows(result, ["variant", "case", "seed", "signal", "recorded points"], rows)
    if story["idle"]:
        result.heading("Faults that changed nothing")
        result.text("What they should have done did not happen: such runs count as not held.")
        rows = [list(entry) for entry in story["idle"]]
        _some_rows(result, ["variant", "case", "fault", "seeds", "why"], rows)
    if story["notes"]:
        result.heading(NOTES)
        result.items(f"{note} (in {count} of {len(story['runs'])} runs)" for note, count in story["notes"])


def _cases(result: Page, story: Story) -> None:
    """What each case does to the system."""
    rows = []
    cases = [*story["cases"], *story["searched"]]
    for case in cases:
        head = [case["name"], case["description"]]
        if case["changed"]:
            rows.append([*head, "", "", case["changed"], ""])
        elif not case["faults"]:
            rows.append([*head, "", "", "", ""])
        rows += [[*head, *fault["cells"]] for fault in case["faults"]]
    result.heading(APPENDIX)
    headings = ["case", "description", *faults.HEADINGS]
    if not any(case["description"] for case in cases):
        headings, rows = headings[:1] + headings[2:], [row[:1] + row[2:] for row in rows]
    result.table(headings, rows[:PAPER])
    if rows[PAPER:]:
        result.text(f"These are the first {PAPER} of {len(rows)} rows; all are in campaign.json.")


# ---- what scripts read ----------------------------------------------------------------------------------------------


def _live(result: Page, story: Story) -> None:
    runs = [{name: value for name, value in run.items() if name != "curves"} for run in story["runs"]]
    result.data("story", story | {"runs": runs})
    drawn = {number: run["curves"] for number, run in enumerate(story["runs"]) if run["curves"]}
    for number, text in drawn.items():
        result.packed(f"curves-{number}", text)
    if drawn:
        result.packed("charts", _charts())
    result.run(*SCRIPTS)


@cache
def _charts() -> str:
    """The chart library, deflated."""
    library = files("plotly").joinpath("package_data", "plotly.min.js").read_bytes()
    return base64.b64encode(zlib.compress(library, 9)).decode()
