"""Error budget: what each source alone makes of the error, and what is left without it.

Either of errors, by the parameters of sensors, in runs with many seeds: the same seed draws the same numbers in each
run, so that contributions add up with their signs where the navigator is linear. Or of what is claimed, by the
parameters of the estimator, without any errors: a covariance analysis for each source. An estimator whose gains follow
from its covariance is then another one without a source, and the sum says how far contributions still add up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from navfmu.analysis.covariance import WHOLE, named, provenance
from navfmu.analysis.ensemble import Ensemble, Rows, Window, recorded, rows_of, together, with_seeds
from navfmu.analysis.finding import Finding
from navfmu.analysis.sources import CLAIMS, ERRORS, KINDS, Sources
from navfmu.campaign.seeds import seeds_text
from navfmu.errors import NavfmuError, nearest
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.system.experiment import Experiment
from navfmu.system.pool import fly_all

ADDS_UP = 0.25  # how far a root sum square may be from the whole, where few runs tell of it
REST, ALL = "rest", "all"


@dataclass(frozen=True)
class Budget:
    """Mean squares of the error (both axes together, square of ``unit``) over ``time``, each of shape (points,)."""

    of: str  # "errors" or "claims"
    experiment: Experiment
    seeds: tuple[int, ...]
    window: Window
    unit: str
    time: np.ndarray
    all: np.ndarray
    rest: np.ndarray  # with no source
    alone: Mapping[str, np.ndarray]  # the greatest first, over the time
    without: Mapping[str, np.ndarray]
    superposed: float | None  # rms of all errors less the sum of those of single sources, over the rms of all
    remarks: tuple[str, ...]

    @cached_property
    def contributions(self) -> dict[str, np.ndarray]:
        """What each source adds to the rest, (points,)."""
        return {name: np.maximum(square - self.rest, 0.0) for name, square in self.alone.items()}

    @cached_property
    def sum(self) -> np.ndarray:
        """Square of the root-sum-square of all contributions and the rest, (points,)."""
        return self.rest + sum(self.contributions.values())

    @property
    def ratio(self) -> float:
        """Root sum square of all contributions over what all sources make together, over the time."""
        return float(np.sqrt(self.sum.sum() / self.all.sum()))

    @property
    def adds_up(self) -> bool:
        """Whether the squares of the sources make up that of all."""
        return abs(self.ratio - 1.0) < ADDS_UP

    @property
    def largest(self) -> str:
        """The source without which least is left, over the time."""
        return min(self.without, key=lambda name: float(self.without[name].sum()))

    @property
    def told(self) -> str:
        """What there is to say of the largest source."""
        what = "error" if self.of == ERRORS else "claimed error"
        less = [_number(float(np.sqrt(square.mean()))) for square in (self.all, self.without[self.largest])]
        told = f"{self.largest} is the largest source of the {what}: {less[0]} {self.unit} rms, {less[1]} without it"
        return f"{told}, {100 * self.share(self.largest):.0f} % of the squares" if self.adds_up else told

    def share(self, name: str) -> float:
        """Of a source in the sum of all squares over the time."""
        return float(self.contributions[name].sum() / self.sum.sum())


def budget(
    experiment: Experiment,
    of: str = ERRORS,
    seeds: Sequence[int] = (1,),
    window: Window = WHOLE,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Budget:
    """Run the experiment with all sources, with none, with each alone and with all but each.

    ``of`` is "errors", in runs with each of the ``seeds``, or "claims", without errors and with the first seed. The
    sources stand in the system's report file. The answer does not depend on ``jobs``.
    """
    if of not in KINDS:
        raise NavfmuError(f"a budget of '{of}'{nearest(of, KINDS)}; expected {' or '.join(KINDS)}")
    asked = recorded(experiment)
    seeds = tuple(seeds) if of == ERRORS else tuple(seeds)[:1]
    first = with_seeds(asked, seeds[:1])[seeds[0]]
    sources = Sources.of(first, of, window)
    calm = sources.factors(ERRORS, 0.0, *sources.names) if of == CLAIMS else {}
    designs = {(ALL, ""): [], (REST, ""): sources.names}
    designs |= {("alone", name): [other for other in sources.names if other != name] for name in sources.names}
    designs |= {("without", name): [name] for name in sources.names}
    runs = {
        (design, seed): run
        for design, silent in designs.items()
        for seed, run in with_seeds(sources.moved(calm | sources.factors(of, 0.0, *silent)), seeds).items()
    }
    rows = fly_all(runs, jobs, progress, rows_of)
    found = ensembles(asked, designs, seeds, rows, window)
    squares = {design: _squares(ensemble, of) for design, ensemble in found.items()}
    alone = {name: squares["alone", name] for name in sources.names}
    order = sorted(alone, key=lambda name: -float(alone[name].sum()))
    idle = [
        f"{name} changes nothing: errors are the same with it and without it"
        for name in order
        if np.array_equal(alone[name], squares[REST, ""]) and np.array_equal(squares["without", name], squares[ALL, ""])
    ]
    return Budget(
        of=of,
        experiment=first,
        seeds=seeds,
        window=window,
        unit=found[ALL, ""].unit,
        time=found[ALL, ""].time,
        all=squares[ALL, ""],
        rest=squares[REST, ""],
        alone={name: alone[name] for name in order},
        without={name: squares["without", name] for name in order},
        superposed=_superposed(found, sources.names) if of == ERRORS else None,
        remarks=(*sources.remarks, *idle),
    )


def ensembles(
    asked: Experiment,
    designs: Mapping[Any, Any],
    seeds: Sequence[int],
    rows: Mapping[Any, Rows],
    window: Window,
) -> dict[Any, Ensemble]:
    """The ensemble of each design, at the points that all of them have."""
    found = {design: together(asked, {seed: rows[design, seed] for seed in seeds}, window, False) for design in designs}
    time = next(iter(found.values())).time
    for ensemble in found.values():
        time = np.intersect1d(time, ensemble.time)
    return {
        design: Ensemble(e.axes, e.unit, time, e.error[:, at], e.covariance[:, at])
        for design, e in found.items()
        for at in [np.isin(e.time, time)]
    }


def _squares(ensemble: Ensemble, of: str) -> np.ndarray:
    """Sum of both variances, as found or as claimed, (points,)."""
    covariance = ensemble.squares if of == ERRORS else ensemble.claimed
    return covariance[:, 0] + covariance[:, 2]


def _superposed(found: Mapping[Any, Ensemble], names: Sequence[str]) -> float:
    """How far errors of single sources do not add up to those of all, run by run and with their signs."""
    rest = found[REST, ""].error
    all_ = found[ALL, ""].error
    left = all_ - rest - sum(found["alone", name].error - rest for name in names)
    return float(np.sqrt(np.mean(left**2) / np.mean(all_**2)))


def finding(result: Budget) -> Finding:
    """The budget for people and for files."""
    unit = result.unit or "1"
    runs = len(result.seeds)
    ratio = np.sqrt(result.sum / result.all)
    sentences = [
        result.told,
        f"root sum square of the sources: {result.ratio:.2f} of what all make together "
        f"({ratio.min():.2f} to {ratio.max():.2f} over the time)",
    ]
    if not result.adds_up:
        sentences.append(
            "squares of single sources do not add up, and shares mean little: without a source the estimator trusts "
            "others, and is another one; what is left without each is what it would claim"
            if result.of == CLAIMS
            else "squares of single sources do not add up, and shares mean little: errors depend on each other, or "
            "the runs are too few"
        )
    if result.superposed is not None:
        sentences.append(
            f"run by run, single errors add up to those of all but for {100 * result.superposed:.2g} % (rms): so much "
            "of the error is not linear"
        )
    columns = [f"alone, {unit}", f"without it, {unit}", "share, %"]
    headings = ["source", *columns, *(f"at the end: {column}" for column in columns)]
    return Finding(
        kind="budget",
        title=f"Budget of {result.of} of {named(result.experiment)}",
        lead=f"{runs} {'runs' if runs > 1 else 'run'} (seeds {seeds_text(result.seeds)}) of each combination of "
        f"{len(result.alone)} sources, {len(result.time)} points from {result.time[0]:g} s to {result.time[-1]:g} s",
        sentences=sentences,
        headings=headings,
        table=_table(result),
        rows=_rows(result),
        image=picture(result),
        caption="Above: the root mean square of the error that each source alone makes; dashed: their root sum square. "
        "Below: shares of the squares.",
        provenance=provenance(result.experiment, "budget", result.seeds, result.window, "--of", result.of),
        explanation="Errors are the length of both axes together, as root mean square over runs and time. Alone: all "
        "other sources are 0. Without it: this one is. A share is that of the square in the sum of all squares. What "
        "the estimator is told of its sensors stays as it is in the mean of a run with all sources.",
        remarks=result.remarks,
        numbers={
            "largest": result.largest,
            "shares": {name: result.share(name) for name in result.alone},
            "ratio": result.ratio,
            "superposed": result.superposed,
        },
    )


def _table(result: Budget) -> list[list[str]]:
    def cells(name: str, square: np.ndarray, without: np.ndarray | None, part: np.ndarray | None) -> list[str]:
        row = [name]
        for pick in (np.mean, lambda values: values[-1]):
            row += [_number(np.sqrt(pick(square))), "-" if without is None else _number(np.sqrt(pick(without)))]
            row.append("-" if part is None else f"{100 * pick(part) / pick(result.sum):.1f}")
        return row

    table = [
        cells(name, square, result.without[name], result.contributions[name]) for name, square in result.alone.items()
    ]
    table.append(cells("none of them", result.rest, None, result.rest))
    table.append(cells("root sum square", result.sum, None, None))
    return [*table, cells("all together", result.all, None, None)]


def _rows(result: Budget) -> list[dict[str, Any]]:
    def row(at: int) -> dict[str, Any]:
        found = {"time": float(result.time[at]), "all": float(np.sqrt(result.all[at]))}
        found |= {"root_sum_square": float(np.sqrt(result.sum[at])), "none": float(np.sqrt(result.rest[at]))}
        for name in result.alone:
            found[f"{name}, alone"] = float(np.sqrt(result.alone[name][at]))
            found[f"{name}, without"] = float(np.sqrt(result.without[name][at]))
        return found

    return [row(at) for at in range(len(result.time))]


def picture(result: Budget) -> bytes:
    """The error of each source alone over time, and the shares of their squares."""
    with figure(2, 1, size=(9.0, 7.4), left=0.9, right=1.9, sharex=True) as (drawing, panels):
        panel = panels[0]
        panel.plot(result.time, np.sqrt(result.all), color=COLOURS[-1], label="all together")
        panel.plot(result.time, np.sqrt(result.sum), color=GREY, linestyle="--", label="root sum square")
        for colour, (name, square) in zip(_colours(), result.alone.items(), strict=False):
            panel.plot(result.time, np.sqrt(square), color=colour, linewidth=1.2, label=name)
        panel.set_ylabel(f"error, {result.unit or '1'}")
        panel.set_ylim(0.0, None)
        panel.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        share = 100 * np.stack(list(result.contributions.values())) / np.maximum(result.sum, 1e-300)
        panels[1].stackplot(result.time, share, colors=_colours()[: len(share)], alpha=0.8, linewidth=0)
        panels[1].set_ylabel("share of the squares, %")
        panels[1].set_ylim(0.0, 100.0)
        panels[1].set_xlim(result.time[0], result.time[-1])
        panels[1].set_xlabel("time, s")
        title(drawing, panel, f"{named(result.experiment)}: {result.told}", whole=True)
        return png(drawing)


def _colours() -> list[str]:
    return [*COLOURS[:-1], "#8C564B", "#7F7F7F", "#BCBD22", "#17BECF", "#AEC7E8", "#FFBB78"]


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"
