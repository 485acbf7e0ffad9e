"""Covariance analysis: what a navigator claims along a trajectory, beside the errors of many runs along it."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import stats

from navfmu.analysis.circle import radius
from navfmu.analysis.consistency import CONFIDENCE, Verdict, bounds, judge, normalised_squares
from navfmu.analysis.ensemble import Ensemble, Window, recorded, rows_of, together, with_seeds
from navfmu.analysis.finding import Finding
from navfmu.campaign.seeds import seeds_text
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.system.experiment import Experiment, number
from navfmu.system.pool import fly_all

SHARE = 0.95  # of the errors, in the circle
MOMENTS = 10  # rows of the table
WHOLE = Window()


@dataclass(frozen=True)
class CovarianceAnalysis:
    """Claims and errors over time, and whether they agree."""

    ensemble: Ensemble
    verdict: Verdict
    experiment: Experiment
    seeds: tuple[int, ...]
    window: Window

    @property
    def claimed(self) -> np.ndarray:
        """Root of the mean claimed variances, (points, 2)."""
        return np.sqrt(self.ensemble.claimed[:, ::2])

    @property
    def observed(self) -> np.ndarray:
        """Root mean squares of the errors over the runs, (points, 2)."""
        return np.sqrt(self.ensemble.squares[:, ::2])


def covariance(
    experiment: Experiment,
    seeds: Sequence[int] = (1,),
    window: Window = WHOLE,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> CovarianceAnalysis:
    """Run the experiment with each of the ``seeds`` and compare its errors with the covariance that is claimed.

    What is an error and what is claimed says the table ``[analysis]`` of the system's report file; points in the
    ``window`` count. The answer does not depend on ``jobs``.
    """
    asked = recorded(experiment)
    runs = fly_all(with_seeds(asked, seeds), jobs, progress, rows_of)
    ensemble = together(asked, runs, window)
    return CovarianceAnalysis(ensemble, judge(ensemble), asked, tuple(seeds), window)


def finding(result: CovarianceAnalysis) -> Finding:
    """The analysis for people and for files."""
    ensemble, runs = result.ensemble, result.ensemble.runs
    rows = _rows(result)
    unit = ensemble.unit
    first, second = ensemble.axes
    headings = [
        "time, s", f"{first}: claimed, {unit}", f"rms, {unit}", f"{second}: claimed, {unit}", f"rms, {unit}",
        f"{100 * SHARE:g} % circle: claimed, {unit}", f"observed, {unit}", "normalised square",
    ]  # fmt: skip
    shown = [rows[at] for at in moments(len(rows))]
    low, high = bounds(runs)
    sentences = [result.verdict.sentence, *_ratios(result), result.verdict.peak]
    return Finding(
        kind="covariance",
        title=f"Covariance analysis of {named(result.experiment)}",
        lead=f"{runs} {'runs' if runs > 1 else 'run'} (seeds {seeds_text(result.seeds)}), {len(rows)} points from "
        f"{rows[0]['time']:g} s to {rows[-1]['time']:g} s",
        sentences=sentences,
        headings=headings,
        table=[[f"{row['time']:g}", *(_text(row[key]) for key in list(row)[1:8])] for row in shown],
        rows=rows,
        image=picture(result),
        caption="Bands: where the rms of so many runs lies with 95 % if the claim is honest (chi-square); below, the "
        f"mean normalised square of the runs, which is then between {low:.2f} and {high:.2f} at 95 % of the points.",
        provenance=provenance(result.experiment, "covariance", result.seeds, result.window),
        explanation="Claimed is the root of the mean variance of the runs, rms that of their errors about 0. The "
        f"circle holds {100 * SHARE:g} % of a normal error with the claimed covariance; observed is the quantile of "
        "the runs (from 20 on). The normalised square e' P^-1 e of an honest claim is 2 in the mean.",
        numbers={
            "word": result.verdict.word,
            "normalised_square": {
                "mean": result.verdict.mean,
                "low": _finite(result.verdict.low),
                "high": _finite(result.verdict.high),
            },
            "greatest": {
                "mean": result.verdict.greatest,
                "time": result.verdict.time,
                "chance": result.verdict.chance,
            },
        },
    )


def _rows(result: CovarianceAnalysis) -> list[dict[str, Any]]:
    ensemble = result.ensemble
    first, second = (name.replace(" ", "_") for name in ensemble.axes)
    claimed, observed = result.claimed, result.observed
    circle = radius(ensemble.claimed, SHARE)
    lengths = np.hypot(ensemble.error[..., 0], ensemble.error[..., 1])
    seen = np.quantile(lengths, SHARE, axis=0) if ensemble.runs >= 20 else np.full(len(circle), np.nan)
    squares = normalised_squares(ensemble).mean(axis=0)
    low, high = bounds(ensemble.runs)
    return [
        {
            "time": float(ensemble.time[at]),
            f"{first}_claimed": float(claimed[at, 0]),
            f"{first}_rms": float(observed[at, 0]),
            f"{second}_claimed": float(claimed[at, 1]),
            f"{second}_rms": float(observed[at, 1]),
            "circle_claimed": float(circle[at]),
            "circle_observed": _finite(float(seen[at])),
            "normalised_square": float(squares[at]),
            "normalised_low": low,
            "normalised_high": high,
        }
        for at in range(len(ensemble.time))
    ]


def _ratios(result: CovarianceAnalysis) -> list[str]:
    """Over the whole time: how great errors are in the measure of the claim."""
    ensemble = result.ensemble
    if ensemble.runs < 2:
        return []
    told = []
    for axis, name in enumerate(ensemble.axes):
        ratios = np.mean(ensemble.error[..., axis] ** 2 / ensemble.covariance[..., 2 * axis], axis=1)
        mean = float(ratios.mean())
        reach = float(stats.t.ppf(0.5 * (1 + CONFIDENCE), ensemble.runs - 1) * ratios.std(ddof=1) / ensemble.runs**0.5)
        low, high = np.sqrt(max(mean - reach, 0.0)), np.sqrt(mean + reach)
        told.append(f"{name} error: {np.sqrt(mean):.2f} of what is claimed, {low:.2f} to {high:.2f} with 95 %")
    return told


def picture(result: CovarianceAnalysis) -> bytes:
    """Claimed sigma with its band and the rms of the runs for each axis; below the normalised squares."""
    ensemble, runs = result.ensemble, result.ensemble.runs
    time = ensemble.time
    with figure(3, 1, size=(9.0, 8.2), left=0.9, sharex=True) as (drawing, panels):
        low, high = (np.sqrt(bound) for bound in bounds(runs, 1))
        for axis, name in enumerate(ensemble.axes):
            panel, claimed = panels[axis], result.claimed[:, axis]
            panel.fill_between(time, low * claimed, high * claimed, color=COLOURS[2], alpha=0.2, linewidth=0)
            panel.plot(time, claimed, color=COLOURS[2], label="claimed, 1 sigma")
            label = f"rms of {runs} runs" if runs > 1 else "size of the error"
            panel.plot(time, result.observed[:, axis], color=COLOURS[1], linewidth=1.0, label=label)
            panel.set_ylabel(f"{name}, {ensemble.unit or '1'}")
            panel.set_ylim(0.0, None)
            panel.legend(fontsize=8, loc="upper left", ncols=2)
        panel = panels[2]
        for bound in bounds(runs):
            panel.axhline(bound, color=GREY, linestyle="--", linewidth=1.0)
        panel.plot(time, normalised_squares(ensemble).mean(axis=0), color=COLOURS[0], linewidth=1.0)
        panel.set_ylabel("normalised square")
        panel.set_ylim(0.0, None)
        panel.set_xlabel("time, s")
        title(drawing, panels[0], f"{named(result.experiment)}: {result.verdict.sentence.partition(';')[0]}")
        return png(drawing)


# ---- what all analyses have in common --------------------------------------------------------------------------------


def named(experiment: Experiment) -> str:
    """The system and its variant."""
    variant = experiment.system.variant
    name = experiment.system.name
    return f"{name}, {variant}" if variant and not name.endswith(f"_{variant}") else name


def moments(points: int) -> list[int]:
    """Which points a table shows: so many, evenly, with the first and the last."""
    return sorted({round(at) for at in np.linspace(0, points - 1, MOMENTS)})


def provenance(experiment: Experiment, verb: str, seeds: Sequence[int], window: Window, *words: str) -> dict[str, Any]:
    """What is needed to repeat an analysis."""
    about = experiment.provenance()
    about.pop("seed")
    command = replace(experiment, seed=None).words("analyse")
    command.insert(2, verb)
    command += ["--seeds", seeds_text(seeds)]
    command += ["--from", number(window.start)] if window.start > 0.0 else []
    command += ["--until", number(window.end)] if np.isfinite(window.end) else []
    return about | {"seeds": list(seeds), "command": shlex.join([*command, *words])}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
