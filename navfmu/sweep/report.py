"""Report of a step-size sweep."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from navfmu.files.writing import write_file
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.repeat import section
from navfmu.report.rows import as_csv
from navfmu.sweep.sweep import ALGORITHMS, Sweep

SHOWN = 6  # signals in the picture


def write_report(result: Sweep, folder: str | Path) -> Path:
    """Write ``sweep.csv``, ``sweep.json``, ``sweep.png`` and ``report.html``; return the path of the report."""
    folder = Path(folder)
    rows = table(result)
    about = {
        "recommendation": result.recommendation(),
        "algorithms_apart": result.apart,
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
    """All numbers, one row for each run and signal."""
    return [
        {
            "algorithm": row.algorithm,
            "step": row.step,
            "signal": row.signal,
            "unit": row.unit,
            "rms_error": row.rms,
            "largest_error": row.largest,
            "reference_span": row.span,
            "slope": result.slope(row.algorithm, row.signal),
            "lost_samples": sum(counts[row.algorithm, row.step] for counts in result.lost.values()),
        }
        for row in result.rows
    ]


def picture(result: Sweep) -> bytes:
    """rms error over step size, log-log: one line for each signal, one panel for each algorithm."""
    signals = _most_affected(result)
    with figure(1, 2, size=(10.5, 5.2), below=0.7, sharex=True, sharey=True) as (drawing, axes):
        for axis, algorithm in zip(axes, ALGORITHMS, strict=True):
            for colour, signal in zip(COLOURS, signals, strict=False):
                rows = [row for row in result.of(algorithm, signal) if row.counts and row.span > 0]
                slope = result.slope(algorithm, signal)
                label = signal if slope is None else f"{signal}  ({slope:.1f})"
                axis.loglog([r.step for r in rows], [100 * r.relative for r in rows], "o-", color=colour, label=label)
            axis.axhline(100 * result.tolerance, color=GREY, linestyle="--", linewidth=1)
            axis.set_title(algorithm.replace("_", "-").title() + "  (order of the error in brackets)")
            axis.set_xlabel("communication step, s")
            axis.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
        axes[0].set_ylabel("rms error, % of the signal's range")
        axes[0].annotate(
            "tolerance", (0.99, 100 * result.tolerance), xycoords=("axes fraction", "data"), ha="right", va="bottom",
            color=GREY, fontsize=8,
        )  # fmt: skip
        return png(drawing)


def _most_affected(result: Sweep) -> list[str]:
    """The signals with the greatest relative error at the largest step, arrays and bundles spread out."""

    def size(signal: str) -> float:
        rows = [row for row in result.rows if row.signal == signal and row.step == result.steps[-1] and row.span > 0]
        return max((row.relative for row in rows), default=0.0)

    ordered = sorted(result.signals, key=size, reverse=True)
    return ordered[:SHOWN]


def page(result: Sweep, image: bytes) -> Page:
    """The whole report."""
    made = Page(
        f"Communication step size of {result.system}",
        f"{result.stop:g} s, the same noise in every run; errors are differences from the same algorithm at "
        f"{result.steps[0]:g} s, every {result.period:g} s",
    )
    made.text(result.recommendation())
    made.picture(
        image, "rms error over communication step", "Each line is a signal; its slope is the order of the error."
    )
    made.heading("Errors")
    made.text(
        f"rms errors; 'algorithms apart' is the rms difference of Gauss-Seidel and Jacobi at {result.steps[0]:g} s. "
        "Where components are sampled it does not vanish with the step: Jacobi delivers each value one sample late."
    )
    made.table(
        ["signal", "unit", "algorithm", *(f"{step:g} s" for step in result.steps), "slope", "algorithms apart"],
        [
            [
                signal,
                result.of(algorithm, signal)[0].unit,
                algorithm,
                *(f"{row.rms:.3g}" for row in result.of(algorithm, signal)),
                "-" if (slope := result.slope(algorithm, signal)) is None else f"{slope:.2f}",
                f"{result.apart[signal]:.3g}",
            ]
            for signal in result.signals
            for algorithm in ALGORITHMS
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
    section(made, result.provenance)
    return made
