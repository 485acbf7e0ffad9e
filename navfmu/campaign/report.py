"""Report of a campaign: verdict matrix, pictures, worst cases first, and how to repeat each run."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from navfmu.campaign.definition import Case
from navfmu.campaign.navigation import statistics
from navfmu.campaign.outcome import Judged, Outcome
from navfmu.campaign.requirement import Requirement
from navfmu.errors import NavfmuError
from navfmu.files.writing import replacing, write_file
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.repeat import section
from navfmu.report.rows import as_csv

Note = Callable[[int, int], None]  # sections drawn, sections to draw
TRUTH = ("aircraft.latitude", "aircraft.longitude")
ESTIMATE = ("navigator.solution.latitude", "navigator.solution.longitude")
NAUTICAL_MILE = 1852.0
EARTH = 6_371_000.0  # m, for pictures only
PICTURED = 12  # cells of the matrix with pictures; the tables have all of them


def write_report(outcome: Outcome, folder: Path, note: Note | None = None) -> Path:
    """Write ``runs.csv``, ``runs.parquet``, ``verdicts.csv``, ``campaign.json`` and ``report.html``."""
    about = provenance(outcome)
    rows = outcome.table()
    write_file(folder / "runs.csv", as_csv(rows))
    _write_parquet(rows, folder / "runs.parquet", about)
    write_file(folder / "verdicts.csv", as_csv(_verdicts(outcome)))
    write_file(folder / "statistics.csv", as_csv([asdict(row) for row in statistics(outcome)]))
    write_file(folder / "campaign.json", json.dumps(about, indent=2) + "\n")
    return write_file(folder / "report.html", page(outcome, about, note).html())


def provenance(outcome: Outcome) -> dict[str, Any]:
    """What is needed to repeat the campaign. Nothing in it depends on how it was run."""
    from navfmu.system.provenance import versions

    campaign = outcome.campaign
    return {
        "campaign": str(campaign.path),
        "system": str(campaign.system),
        "digests": {name: system.digest for name, system in campaign.systems.items()},
        "fmus": {name: system.hashes() for name, system in campaign.systems.items()},
        "seeds": list(campaign.seeds),
        "stop": campaign.stop,
        "step": campaign.step,
        "algorithm": campaign.algorithm,
        "parameters": campaign.parameters,
        "versions": versions(),
        "command": f"navfmu campaign {campaign.path}",
    }


def _verdicts(outcome: Outcome) -> list[dict[str, Any]]:
    return [
        {
            "requirement": cell.requirement.id,
            "sentence": cell.requirement.sentence,
            "variant": cell.variant,
            "case": cell.case,
            "verdict": "holds" if cell.passed else "violated",
            "runs_held": cell.held,
            "runs": cell.total,
            "interval_low_percent": round(cell.interval[0], 2),
            "interval_high_percent": round(cell.interval[1], 2),
            "seen": cell.sentence,
        }
        for cell in outcome.cells
    ]


def _write_parquet(rows: list[dict[str, Any]], path: Path, about: dict[str, Any]) -> None:
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.Table.from_pylist(rows).replace_schema_metadata({"navfmu": json.dumps(about)})
    with replacing(path) as temporary:
        parquet.write_table(table, temporary, compression="zstd")


# ---- the page --------------------------------------------------------------------------------------------------------


def pictured(outcome: Outcome) -> list[tuple[str, Case]]:
    """The cells that get pictures: every variant in the first case, then the worst ones, in the order of the file."""
    campaign = outcome.campaign
    every = [(variant, case) for case in campaign.cases for variant in campaign.systems]

    def badness(pair: tuple[str, Case]) -> float:
        cells = [c for c in outcome.cells if (c.variant, c.case) == (pair[0], pair[1].name)]
        return sum((not c.passed) + (1.0 - c.held / max(c.total, 1)) for c in cells)

    first = len(campaign.systems)
    chosen = every[:first] + sorted(every[first:], key=badness, reverse=True)
    return [pair for pair in every if pair in chosen[:PICTURED]]


def page(outcome: Outcome, about: dict[str, Any], note: Note | None = None) -> Page:
    """The whole report."""
    campaign = outcome.campaign
    sizes = f"{len(campaign.systems)} variants x {len(campaign.cases)} cases x {len(campaign.seeds)} seeds"
    result = Page(
        f"Campaign {campaign.name}",
        f"{campaign.description + '. ' if campaign.description else ''}{len(outcome.runs)} runs ({sizes}) of "
        f"{campaign.stop:g} s in steps of {campaign.step:g} s, {campaign.algorithm}",
    )
    _verdict_section(result, outcome)
    _statistics_section(result, outcome)
    _case_section(result, outcome)
    _failures(result, outcome)
    chosen, count = pictured(outcome), len(campaign.systems) * len(campaign.cases)
    if count > len(chosen):
        result.text(
            f"Pictures follow for {len(chosen)} of {count} combinations: those of the first case, then the worst."
        )
    for number, (variant, case) in enumerate(chosen):
        if note is not None:
            note(number, len(chosen))
        _cell_section(result, outcome, variant, case)
    _runs_section(result, outcome)
    section(result, about)
    return result


def _verdict_section(result: Page, outcome: Outcome) -> None:
    result.heading("Verdicts")
    if not outcome.cells:
        result.text("The campaign has no requirements.")
        return
    campaign = outcome.campaign
    ids = [requirement.id for requirement in campaign.requirements]
    cells = {(cell.variant, cell.case, cell.requirement.id): cell for cell in outcome.cells}
    groups = [(variant, case.name) for variant in campaign.systems for case in campaign.cases]

    def text(key: tuple[str, str, str]) -> str:
        cell = cells.get(key)
        if cell is None:
            return "not asked"
        return f"{'holds' if cell.passed else 'VIOLATED'} {cell.held}/{cell.total}"

    def style(row: int, column: int) -> str | None:
        if column < 2:
            return None
        cell = cells.get((*groups[row], ids[column - 2]))
        return "none" if cell is None else "good" if cell.passed else "bad"

    rows = [[*group, *(text((*group, name)) for name in ids)] for group in groups]
    result.table(["variant", "case", *ids], rows, style)
    result.items(_in_words(requirement) for requirement in campaign.requirements)
    result.heading("What was seen, worst first")
    ordered = sorted(outcome.cells, key=lambda cell: cell.rank)
    result.table(
        ["requirement", "variant", "case", "verdict", "95 % interval of the share of runs", "seen"],
        [
            [
                cell.requirement.id,
                cell.variant,
                cell.case,
                "holds" if cell.passed else "VIOLATED",
                "" if cell.requirement.quantile is not None else f"{cell.interval[0]:.0f} to {cell.interval[1]:.0f} %",
                cell.sentence,
            ]
            for cell in ordered
        ],
        lambda row, column: ("good" if ordered[row].passed else "bad") if column == 3 else None,
    )


def _in_words(requirement: Requirement) -> str:
    severity = f" ({requirement.severity})" if requirement.severity else ""
    more = f". {requirement.description}" if requirement.description else ""
    return f"{requirement.id}{severity}: {requirement.sentence}{more}"


def _statistics_section(result: Page, outcome: Outcome) -> None:
    """Error, bound and what the filter itself predicts, for navigation systems."""
    rows = statistics(outcome)
    if not rows:
        return
    result.heading("Horizontal error over all runs")
    result.text(
        "Median and 95th percentile are taken over the runs at each time; shown is the worst time. 'Predicted' is the "
        "share of time beyond the limit that the filter's own covariance gives; an honest filter predicts what happens."
    )
    result.table(
        [
            "variant", "case", "runs", "median, m", "at s", "95th percentile, m", "at s", "limit, m",
            "time beyond, %", "predicted, %", "runs ever beyond", "inside 3 sigma, %",
        ],
        [
            [
                s.variant, s.case, s.runs, f"{s.median:.0f}", f"{s.median_time:g}", f"{s.high:.0f}", f"{s.high_time:g}",
                f"{s.limit:.0f}", f"{s.above:.1f}", f"{s.predicted:.1f}", f"{s.ever} of {s.runs}", f"{s.inside:.1f}",
            ]
            for s in rows
        ],
    )  # fmt: skip


def _case_section(result: Page, outcome: Outcome) -> None:
    """What each case does to the system."""
    rows = []
    for case in outcome.campaign.cases:
        if not case.faults:
            rows.append([case.name, case.description, "", "", "", ""])
        for fault in case.faults:
            values = ", ".join(f"{key} = {value}" for key, value in fault.parameters.items())
            end = fault.start + fault.duration
            when = f"{fault.start:g} to {end:g}" if np.isfinite(end) else f"from {fault.start:g}"
            kind = f"{fault.type}{' (' + values + ')' if values else ''}"
            rows.append([case.name, case.description, fault.id, fault.target, kind, when])
    result.heading("Cases")
    headings = ["case", "description", "fault", "target", "type", "time, s"]
    if not any(case.description for case in outcome.campaign.cases):
        headings, rows = headings[:1] + headings[2:], [row[:1] + row[2:] for row in rows]
    result.table(headings, rows)


def _failures(result: Page, outcome: Outcome) -> None:
    failed = [judged for judged in outcome.runs if judged.error is not None]
    if failed:
        result.heading("Runs that ended with an error")
        result.table(
            ["variant", "case", "seed", "error"],
            [[j.run.variant, j.run.case.name, str(j.run.seed), j.error] for j in failed],
        )


def _cell_section(result: Page, outcome: Outcome, variant: str, case: Case) -> None:
    """Pictures of one variant in one case."""
    runs = [judged for judged in outcome.of(variant, case.name) if judged.error is None]
    if not runs:
        return
    shown = _worst(outcome, variant, case.name) or runs[0]
    label = f"{variant}, {case.name}"
    result.heading(label)
    for signal in _signals(outcome):
        image = percentiles(outcome, runs, signal, case, label)
        if image is not None:
            many = f"{len(runs)} runs: median, 5th to 95th percentile, and the greatest"
            text = f"{signal} of {many if len(runs) > 1 else 'one run'}."
            result.picture(image, f"{label}: {signal} over time", text)
    image = three_sigma(outcome, runs, shown, case, label)
    if image is not None:
        result.picture(
            image, f"{label}: errors against three sigma", "Shown is the worst run; the share counts all runs."
        )
    image = ground_track(outcome, shown, variant, label)
    if image is not None:
        result.picture(image, f"{label}: ground track", f"Worst run: {shown.run.experiment.command()}")


def _signals(outcome: Outcome) -> list[str]:
    """The signals of requirements that are worth a curve, the error first."""
    names = [requirement.signal for requirement in outcome.campaign.requirements]
    found = dict.fromkeys(["evaluation.horizontal_error", *names] if names else names)
    system = next(iter(outcome.campaign.systems.values()))
    kept = []
    for name in found:
        try:
            if system.variable(name.removesuffix("@true")).type == "Real":
                kept.append(name)
        except NavfmuError:
            continue
    return kept


def _worst(outcome: Outcome, variant: str, case: str) -> Judged | None:
    cells = [c for c in outcome.cells if (c.variant, c.case) == (variant, case) and c.worst is not None]
    return min(cells, key=lambda cell: (cell.passed, cell.held)).worst if cells else None


def _runs_section(result: Page, outcome: Outcome) -> None:
    inner = Page("")
    rows = []
    for judged in outcome.runs:
        verdicts = ", ".join(f"{name} {'holds' if f.held else 'violated'}" for name, f in judged.findings.items())
        command = judged.run.experiment.command()
        rows.append([judged.run.variant, judged.run.case.name, str(judged.run.seed), judged.error or verdicts, command])
    inner.table(["variant", "case", "seed", "findings", "command that repeats it"], rows)
    result.heading("All runs")
    result.text("The recordings are in the folder runs/ beside this report, the findings in runs.csv and runs.parquet.")
    result.folded(f"{len(rows)} runs and their commands", inner)


# ---- pictures --------------------------------------------------------------------------------------------------------


def percentiles(outcome: Outcome, runs: list[Judged], signal: str, case: Case, label: str) -> bytes | None:
    """A signal over time in all runs, with the bounds that requirements put on it."""
    series = [outcome.series(judged, [signal]) for judged in runs]
    series = [one for one in series if signal in one]
    if not series:
        return None
    time = series[0]["time"]
    values = np.stack([one[signal].astype(np.float64) for one in series])
    unit = outcome.campaign.systems[runs[0].run.variant].variable(signal.removesuffix("@true")).unit
    with figure(size=(9.0, 4.2), below=0.45) as (drawing, axis):
        if len(series) > 1:
            low, middle, high = np.quantile(values, (0.05, 0.5, 0.95), axis=0, method="higher")
            axis.fill_between(
                time, low, high, color=COLOURS[0], alpha=0.25, linewidth=0, label="5th to 95th percentile"
            )
            axis.plot(time, middle, color=COLOURS[0], label="median")
            axis.plot(time, values.max(axis=0), color=COLOURS[0], linewidth=0.7, linestyle=":", label="greatest")
        else:
            axis.plot(time, values[0], color=COLOURS[0], label=f"seed {runs[0].run.seed}")
        for colour, requirement in zip(COLOURS[1:], _bounds(outcome, signal, label), strict=False):
            for bound in (requirement.most, requirement.least):
                if bound is not None:
                    end = min(requirement.end, time[-1])
                    text = f"{requirement.id}: {bound:g} {requirement.unit}"
                    axis.plot([requirement.start, end], [bound, bound], "--", color=colour, linewidth=1.2, label=text)
        _shade(axis, case, time[-1])
        axis.set_title(f"{label}: {signal}, {len(series)} runs")
        axis.set_xlabel("time, s")
        axis.set_ylabel(f"{signal.rpartition('.')[2].replace('_', ' ')}, {unit or '1'}")
        axis.set_xlim(time[0], time[-1])
        axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=4)
        return png(drawing)


def _bounds(outcome: Outcome, signal: str, label: str) -> list[Requirement]:
    variant, _, case = label.partition(", ")
    return [r for r in outcome.campaign.requirements if r.signal == signal and r.applies(variant, case)]


def _shade(axis: Any, case: Case, end: float) -> None:
    """Grey where a fault is present."""
    windows = sorted({(fault.start, min(fault.start + fault.duration, end)) for fault in case.faults})
    for number, (first, last) in enumerate(windows):
        names = ", ".join(f.id for f in case.faults if (f.start, min(f.start + f.duration, end)) == (first, last))
        axis.axvspan(first, last, color=GREY, alpha=0.10, linewidth=0, label=f"fault: {names}" if number < 4 else None)


def three_sigma(outcome: Outcome, runs: list[Judged], shown: Judged, case: Case, label: str) -> bytes | None:
    """North and east error of the shown run inside (or outside) three times the filter's own sigma."""
    pairs = [(f"evaluation.{axis}_error", f"navigator.{axis}_sigma") for axis in ("north", "east")]
    names = [name for pair in pairs for name in pair]
    series = outcome.series(shown, [*names, "navigator.mode"])
    if not all(name in series for name in names):
        return None
    counts = {axis: [0, 0] for axis in ("north", "east")}
    for judged in runs:
        one = outcome.series(judged, [*names, "navigator.mode"])
        known = one.get("navigator.mode", np.ones(len(one["time"]))) > 0
        for axis, (error, sigma) in zip(counts, pairs, strict=True):
            counts[axis][0] += int(np.count_nonzero((np.abs(one[error]) <= 3 * one[sigma]) & known))
            counts[axis][1] += int(np.count_nonzero(known))
    time = series["time"]
    with figure(2, 1, size=(9.0, 5.0), sharex=True) as (drawing, axes):
        for axis, name, (error, sigma) in zip(axes, counts, pairs, strict=True):
            inside, total = counts[name]
            bound = 3 * series[sigma]
            axis.fill_between(
                time, -bound, bound, color=COLOURS[2], alpha=0.2, linewidth=0, label="3 sigma of the filter"
            )
            axis.plot(time, series[error], color=COLOURS[1], linewidth=1.0, label=f"{name} error")
            _shade(axis, case, time[-1])
            share = 100 * inside / max(total, 1)
            axis.set_title(
                f"{label}: {name} error inside 3 sigma for {share:.1f} % of {total} points of {len(runs)} runs"
            )
            axis.set_ylabel(f"{name} error, m")
            axis.legend(fontsize=8, loc="upper left", ncols=3)
            reach = max(float(np.nanmax(np.abs(series[error]))), float(np.nanquantile(bound, 0.98)), 1.0)
            axis.set_ylim(-1.15 * reach, 1.35 * reach)
        axes[1].set_xlabel(f"time, s   (seed {shown.run.seed})")
        axes[1].set_xlim(time[0], time[-1])
        return png(drawing)


def ground_track(outcome: Outcome, shown: Judged, variant: str, label: str) -> bytes | None:
    """Truth and estimate over ground, with the stations near them."""
    series = outcome.series(shown, [*TRUTH, *ESTIMATE, "navigator.mode"])
    if not all(name in series for name in (*TRUTH, *ESTIMATE)):
        return None
    latitude, longitude = series[TRUTH[0]], series[TRUTH[1]]
    origin = float(latitude.mean()), float(longitude.mean())
    scale = EARTH / NAUTICAL_MILE

    def local(lat: Any, lon: Any) -> tuple[Any, Any]:
        return (lon - origin[1]) * np.cos(origin[0]) * scale, (lat - origin[0]) * scale

    with figure(size=(7.0, 6.2)) as (drawing, axis):
        east, north = local(latitude, longitude)
        axis.plot(east, north, color="#000000", linewidth=1.4, label="truth")
        axis.plot(east[0], north[0], "o", color="#000000", markersize=6, label="start")
        known = series["navigator.mode"] > 0 if "navigator.mode" in series else np.ones(len(east), bool)
        e, n = local(series[ESTIMATE[0]], series[ESTIMATE[1]])
        axis.plot(
            np.where(known, e, np.nan), np.where(known, n, np.nan), color=COLOURS[1], linewidth=1.0, label="estimate"
        )
        stations = _stations(outcome.campaign.systems[variant])
        if stations:
            x, y = local(*np.array(stations).T)
            axis.plot(x, y, "^", color=COLOURS[0], markersize=9, label="DME station")
        axis.set_aspect("equal", adjustable="datalim")
        axis.set_title(f"{label}: ground track, seed {shown.run.seed}")
        axis.set_xlabel(f"east of {np.degrees(origin[1]):.3f} deg, n.mi.")
        axis.set_ylabel(f"north of {np.degrees(origin[0]):.3f} deg, n.mi.")
        axis.legend(fontsize=8, loc="best")
        return png(drawing)


def _stations(system: Any) -> list[tuple[float, float]]:
    """Latitude and longitude (rad) of the stations that the component ``dme`` knows."""
    try:
        count = int(system.value("dme.station_count"))
        return [
            (float(system.value(f"dme.station_latitude[{i}]")), float(system.value(f"dme.station_longitude[{i}]")))
            for i in range(1, count + 1)
        ]
    except NavfmuError:
        return []
