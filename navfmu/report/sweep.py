"""Report of a step-size sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.provenance import section

if TYPE_CHECKING:
    from navfmu.sweep import Sweep

SHOWN = 6  # signals in the picture


def picture(result: Sweep) -> bytes:
    """rms error over step size, log-log: one line for each signal, one panel for each algorithm."""
    from navfmu.sweep import ALGORITHMS

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


def report(result: Sweep, image: bytes) -> str:
    """The page."""
    from navfmu.sweep import ALGORITHMS

    page = Page(
        f"Communication step size of {result.system}",
        f"{result.stop:g} s, the same noise in every run; errors are differences from the same algorithm at "
        f"{result.steps[0]:g} s, every {result.period:g} s",
    )
    page.text(result.recommendation())
    page.picture(
        image, "rms error over communication step", "Each line is a signal; its slope is the order of the error."
    )
    page.heading("Errors")
    page.text(
        f"rms errors; 'algorithms apart' is the rms difference of Gauss-Seidel and Jacobi at {result.steps[0]:g} s. "
        "Where components are sampled it does not vanish with the step: Jacobi delivers each value one sample late."
    )
    page.table(
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
    page.heading("Samples lost between components")
    if not result.lost:
        page.text("No component of this system counts samples.")
    elif not any(any(counts.values()) for counts in result.lost.values()):
        page.text("None at any step.")
    else:
        page.text("A measurement is lost when a newer one replaces it before the next communication point.")
        page.table(
            ["counter", "algorithm", *(f"{step:g} s" for step in result.steps)],
            [
                [name, algorithm, *(counts[algorithm, step] for step in result.steps)]
                for name, counts in result.lost.items()
                for algorithm in ALGORITHMS
            ],
        )
    section(page, result.provenance)
    return page.html()
