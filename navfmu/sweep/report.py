"""Report of a step-size sweep."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from navfmu.files.writing import write_file
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.repeat import section
from navfmu.report.rows import as_csv
from navfmu.sweep.recommendation import findings, recommendation
from navfmu.sweep.result import ALGORITHMS, Row, Sweep
from navfmu.system.results_folder import check_results

SHOWN = 6  # signals in the picture
FILES = ("sweep.csv", "sweep.json", "sweep.png", "report.html")


def write_report(result: Sweep, folder: str | Path) -> Path:
    """Write ``sweep.csv``, ``sweep.json``, ``sweep.png`` and ``report.html``; return the path of the report.

    A folder with the results of something else is refused.
    """
    check_results(folder, "a sweep", *FILES)
    folder = Path(folder)
    rows = table(result)
    about = {
        "recommendation": recommendation(result),
        "algorithms_apart": {name: _number(value) for name, value in result.apart.items()},
        "valid_in_no_run": list(result.idle),
        "not_real": list(result.not_real),
        "notes": list(result.notes),
        "provenance": result.provenance,
        "lost": {
            name: [{"algorithm": a, "step": s, "lost": n} for (a, s), n in counts.items()]
            for name, counts in result.lost.items()
        },
        "errors": rows,
    }
    image = picture(result)
    write_file(folder / "sweep.csv", as_csv(rows))
    write_file(folder / "sweep.json", json.dumps(about, indent=2) + "\n")
    write_file(folder / "sweep.png", image)
    return write_file(folder / "report.html", page(result, image).html())


def table(result: Sweep) -> list[dict[str, Any]]:
    """All numbers, one row for each run and signal; None where there is no number."""
    orders = {(a, signal): result.order(a, signal) for a in ALGORITHMS for signal in result.signals}
    rows = []
    for row in result.rows:
        order = orders[row.algorithm, row.signal]
        rows.append(
            {
                "algorithm": row.algorithm,
                "step": row.step,
                "signal": row.signal,
                "unit": row.unit,
                "rms_error": _number(row.rms),
                "largest_error": _number(row.largest),
                "reference_span": _number(row.span),
                "order": None if order is None else order.value,
                "order_deviation": None if order is None else order.deviation,
                "order_points": None if order is None else order.points,
                "lost_samples": result.lost_at(row.algorithm, row.step),
                "problem": row.problem,
            }
        )
    return rows


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def picture(result: Sweep) -> bytes:
    """rms error over step size, log-log: one line for each signal, one panel for each algorithm.

    Each is thinner than the one before: where two are the same, both are seen.
    """
    drawn, _ = _drawn(result)
    with figure(1, 2, size=(10.5, 5.2), below=0.7, sharex=True, sharey=True) as (drawing, axes):
        for axis, algorithm in zip(axes, ALGORITHMS, strict=True):
            for number, (colour, signal) in enumerate(zip(COLOURS, drawn, strict=False)):
                rows = _points(result, algorithm, signal)
                if not rows:
                    continue
                order = result.order(algorithm, signal)
                label = signal if order is None else f"{signal}  ({order.value:.1f})"
                size = {"markersize": 10.0 - number, "linewidth": 3.5 - 0.5 * number}
                errors = [100 * row.relative for row in rows]
                axis.loglog([row.step for row in rows], errors, "o-", color=colour, label=label, **size)
            axis.axhline(100 * result.tolerance, color=GREY, linestyle="--", linewidth=1)
            axis.set_title(_title(algorithm) + "  (order of the error in brackets)")
            axis.set_xlabel("communication step, s")
            if axis.get_legend_handles_labels()[0]:
                axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
            else:
                told = "what cannot be compared" if findings(result) else "no error above rounding"
                axis.annotate(told, (0.5, 0.5), xycoords="axes fraction", ha="center", color=GREY)
        axes[0].set_ylabel("rms error, % of the signal's range")
        axes[0].annotate(
            "tolerance", (0.99, 100 * result.tolerance), xycoords=("axes fraction", "data"), ha="right", va="bottom",
            color=GREY, fontsize=8,
        )  # fmt: skip
        return png(drawing)


def _points(result: Sweep, algorithm: str, signal: str) -> list[Row]:
    """The errors of a signal that have a place on a logarithmic axis."""
    return [row for row in result.of(algorithm, signal) if row.counts and row.span > 0]


def _title(algorithm: str) -> str:
    return algorithm.replace("_", "-").title()


def _drawn(result: Sweep) -> tuple[list[str], int]:
    """The signals in the picture, the greatest relative error first; and how many have an error to draw."""
    sizes = {
        signal: max((row.relative for a in ALGORITHMS for row in _points(result, a, signal)), default=0.0)
        for signal in result.signals
    }
    ordered = sorted((signal for signal, size in sizes.items() if size > 0.0), key=lambda s: sizes[s], reverse=True)
    return ordered[:SHOWN], len(ordered)


def caption(result: Sweep) -> str:
    """What the picture shows and what it leaves out."""
    drawn, count = _drawn(result)
    if not drawn:
        return "No signal has an error that can be drawn."
    which = "all signals with an error" if len(drawn) == count else f"the {len(drawn)} of {count} signals that err most"
    told = f"Each line is a signal, its slope is the order of the error; {which} are drawn."
    for algorithm in ALGORITHMS:
        missing = [signal for signal in drawn if not _points(result, algorithm, signal)]
        told += f" {_title(algorithm)} has no error to draw in {', '.join(missing)}." if missing else ""
    return told


def page(result: Sweep, image: bytes) -> Page:
    """The whole report."""
    made = Page(
        f"Communication step size of {result.system}",
        f"{result.stop:g} s with the same seed in every run ({result.seeded}); errors are differences from the same "
        f"algorithm at {result.steps[0]:g} s, every {result.period:g} s",
    )
    made.text(recommendation(result))
    made.picture(image, "rms error over communication step", caption(result))
    made.heading("Errors")
    made.text(
        f"rms errors; 'algorithms apart' is the rms difference of Gauss-Seidel and Jacobi at {result.steps[0]:g} s, "
        "which does not vanish with the step where components are sampled: Jacobi delivers each value one sample late. "
        "An order is found by least squares over all errors above rounding, with its standard deviation; two errors "
        "fit exactly, whatever they are; '-' means that the errors have no order."
    )
    others = [f"Not compared, because not Real: {', '.join(result.not_real)}."] if result.not_real else []
    if not_compared := [*findings(result), *others]:
        made.items(not_compared)
    made.table(
        ["signal", "unit", "algorithm", *(f"{step:g} s" for step in result.steps), "order", "algorithms apart"],
        [
            [
                signal,
                rows[0].unit,
                algorithm,
                *(row.problem or f"{row.rms:.3g}" for row in rows),
                "-" if (order := result.order(algorithm, signal)) is None else str(order),
                f"{result.apart[signal]:.3g}" if math.isfinite(result.apart[signal]) else "-",
            ]
            for signal in result.signals
            for algorithm in ALGORITHMS
            for rows in [result.of(algorithm, signal)]
        ],
    )
    made.heading("Samples lost between components")
    if not result.lost:
        made.text("No component of this system counts samples.")
    elif not any(any(counts.values()) for counts in result.lost.values()):
        made.text("None at any step.")
    else:
        made.text("A measurement is lost when a newer one replaces it before the next communication point.")
        made.table(
            ["counter", "algorithm", *(f"{step:g} s" for step in result.steps)],
            [
                [name, algorithm, *(counts[algorithm, step] for step in result.steps)]
                for name, counts in result.lost.items()
                for algorithm in ALGORITHMS
            ],
        )
    if result.notes:
        made.heading("Notes of the runs")
        made.items(result.notes)
    section(made, result.provenance)
    return made
