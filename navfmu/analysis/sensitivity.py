"""Sensitivity: the response of the error to each parameter that makes errors, per unit; their superposition; circles.

The method of AGARD-CP-298, paper 25 (Bose): each error source alone, its response scaled, and the root sum square of
all. There one run stands for an error that is constant; here all have runs with many seeds. The same seed draws the
same numbers in each run, so that responses keep their signs and add up run by run where the navigator is linear. That
it is linear is not assumed but seen: at half the size a response is half as great, and the sum of all is the error with
all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.analysis.budget import ALL, REST, ensembles
from navfmu.analysis.circle import FACTORS, printed, radius
from navfmu.analysis.covariance import WHOLE, named, provenance
from navfmu.analysis.ensemble import Window, recorded, rows_of, with_seeds
from navfmu.analysis.finding import Finding
from navfmu.analysis.sources import ERRORS, Sources
from navfmu.campaign.seeds import seeds_text
from navfmu.fmi import names
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu.report.scene import with_unit
from navfmu.system.experiment import Experiment
from navfmu.system.pool import fly_all

HALF = 0.5  # of the size of a parameter, at which its response is half as great if it is linear
LINEAR = 0.1  # how far from linear a response may be


@dataclass(frozen=True)
class Response:
    """What one parameter does to the error."""

    name: str  # "drifter.slope_sigma"
    size: float  # the greatest of its elements
    unit: str
    squares: np.ndarray  # mean square of the response, both axes together, (points,)
    bent: float  # rms of twice the response at half the size, less the response, over its rms; 0 where it is linear

    @property
    def rms(self) -> float:
        """Over runs and time."""
        return float(np.sqrt(self.squares.mean()))


@dataclass(frozen=True)
class Sensitivity:
    """Responses, the greatest first; errors and the sum of all responses of all runs, (runs, points, 2)."""

    experiment: Experiment
    seeds: tuple[int, ...]
    window: Window
    axes: tuple[str, str]
    unit: str
    time: np.ndarray
    responses: tuple[Response, ...]
    error: np.ndarray
    sum: np.ndarray
    rest: np.ndarray  # (points,), mean square of the error with none of them
    remarks: tuple[str, ...]

    @property
    def squares(self) -> np.ndarray:
        """Mean squares of both errors and of their product at the end, as a packed covariance, (3,)."""
        first, second = self.error[:, -1].T
        return np.array([np.mean(first * first), np.mean(first * second), np.mean(second * second)])

    @property
    def total(self) -> float:
        """Root mean square of the error over runs and time."""
        return float(np.sqrt(2.0 * np.mean(self.error**2)))

    @property
    def root_sum_square(self) -> float:
        """Of all responses and of what is left without them."""
        return float(np.sqrt(sum(r.squares.mean() for r in self.responses) + self.rest.mean()))

    @property
    def left(self) -> float:
        """Rms of the errors less the sum of the responses, over the rms of the errors."""
        return float(np.sqrt(np.mean((self.error - self.sum) ** 2) / np.mean(self.error**2)))


def sensitivity(
    experiment: Experiment,
    seeds: Sequence[int] = (1,),
    window: Window = WHOLE,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sensitivity:
    """Run the experiment with all parameters of errors, with none, and with each alone, whole and half.

    The parameters are those of the sources in the system's report file that are not 0. The answer does not depend on
    ``jobs``.
    """
    asked, seeds = recorded(experiment), tuple(seeds)
    first = with_seeds(asked, seeds[:1])[seeds[0]]
    sources = Sources.of(first, ERRORS, window)
    singles = sources.singles()
    silent = sources.factors(ERRORS, 0.0, *sources.names)
    designs: dict[tuple[str, float], dict[str, float]] = {(ALL, 1.0): {}, (REST, 0.0): silent}
    for name, elements in singles.items():
        designs |= {(name, size): silent | dict.fromkeys(elements, size) for size in (1.0, HALF)}
    runs = {
        (design, seed): run
        for design, factors in designs.items()
        for seed, run in with_seeds(sources.moved(factors), seeds).items()
    }
    found = ensembles(asked, designs, seeds, fly_all(runs, jobs, progress, rows_of), window)
    rest, whole = found[REST, 0.0], found[ALL, 1.0]
    responses, total = [], rest.error.copy()
    for name, elements in singles.items():
        response, half = (found[name, size].error - rest.error for size in (1.0, HALF))
        total += response
        squares = np.sum(response**2, axis=-1).mean(axis=0)
        power = float(np.mean(response**2))
        bent = float(np.sqrt(np.mean((half / HALF - response) ** 2) / power)) if power > 0.0 else 0.0
        size = max(abs(value) for value, _ in elements.values())
        unit = next(variable.unit for _, variable in elements.values()) or "1"
        responses.append(Response(name, size, unit, squares, bent))
    idle = [f"{r.name} changes nothing: errors are the same without it" for r in responses if r.rms == 0.0]
    return Sensitivity(
        experiment=first,
        seeds=seeds,
        window=window,
        axes=whole.axes,
        unit=whole.unit,
        time=whole.time,
        responses=tuple(sorted(responses, key=lambda response: -response.rms)),
        error=whole.error,
        sum=total,
        rest=np.sum(rest.error**2, axis=-1).mean(axis=0),
        remarks=(*sources.remarks, *idle),
    )


def finding(result: Sensitivity) -> Finding:
    """The responses for people and for files."""
    unit, runs = result.unit or "1", len(result.seeds)
    first = result.responses[0]
    bent = [r.name for r in result.responses if r.bent > LINEAR and r.rms > 0.01 * result.total]
    sentences = [
        f"{first.name} does most: {_number(first.rms)} of {_number(result.total)} {unit} (rms over runs and time)",
        f"root sum square of all responses: {_number(result.root_sum_square)} {unit}; run by run and with their signs "
        f"they add up to the error but for {100 * result.left:.2g} % (rms)",
        f"not linear (half the size does not do half): {', '.join(bent)}"
        if bent
        else f"all that do more than 1 % of the error are linear: half the size does half, within {100 * LINEAR:g} %",
        *(_circle(result, share) for share in FACTORS),
    ]
    return Finding(
        kind="sensitivity",
        title=f"Sensitivity of {named(result.experiment)}",
        lead=f"{runs} {'runs' if runs > 1 else 'run'} (seeds {seeds_text(result.seeds)}) of each of "
        f"{len(result.responses)} parameters, {len(result.time)} points from {result.time[0]:g} s to "
        f"{result.time[-1]:g} s",
        sentences=sentences,
        headings=["parameter", "its size", f"response, {unit}", f"at the end, {unit}", "per unit", "not linear, %"],
        table=[_cells(response, unit) for response in result.responses],
        rows=[
            {
                "parameter": r.name,
                "size": r.size,
                "unit": r.unit,
                "response": r.rms,
                "response_at_the_end": float(np.sqrt(r.squares[-1])),
                "response_per_unit": r.rms / r.size,
                "not_linear": r.bent,
            }
            for r in result.responses
        ],
        image=picture(result),
        caption="Bars: root mean square, over runs and time, of the error that each parameter alone makes.",
        provenance=provenance(result.experiment, "sensitivity", result.seeds, result.window),
        explanation="A response is the error with one parameter at its size and all others 0, less that with all 0; "
        "its length in both axes, as root mean square over runs and time. Per unit: divided by the size, the "
        "greatest element of an array. Not linear: how far twice the response at half the size is from it.",
        remarks=result.remarks,
        numbers={"root_sum_square": result.root_sum_square, "all": result.total, "left": result.left},
    )


def _circle(result: Sensitivity, share: float) -> str:
    """The circle of a share at the end: exact, by the printed sum, and how many runs that holds."""
    exact, sums = float(radius(result.squares, share)), float(printed(result.squares, share))
    lengths = np.hypot(*result.error[:, -1].T)
    inside, runs = int(np.sum(lengths <= exact)), len(lengths)
    return (
        f"circle of {100 * share:g} % at the end: {_number(exact)} {result.unit} of the ellipse of {runs} runs "
        f"({inside} are inside), {_number(sums)} by {FACTORS[share]} (s1 + s2)"
    )


def _cells(response: Response, unit: str) -> list[str]:
    per = with_unit(f"{response.rms / response.size:.3g}", f"{unit} per {response.unit}")
    size = with_unit(f"{response.size:.3g}", response.unit)
    end = _number(float(np.sqrt(response.squares[-1])))
    return [response.name, size, _number(response.rms), end, per, f"{100 * response.bent:.1f}"]


def picture(result: Sensitivity) -> bytes:
    """A bar for each parameter that does something."""
    shown = [response for response in result.responses if response.rms > 0.0]
    with figure(1, 1, size=(9.0, 1.5 + 0.27 * len(shown)), left=3.0) as (drawing, panel):
        places = np.arange(len(shown))[::-1]
        panel.barh(places, [response.rms for response in shown], color=COLOURS[0], height=0.7)
        for place, response in zip(places, shown, strict=True):
            panel.annotate(f" {_number(response.rms)}", (response.rms, place), va="center", fontsize=8)
        panel.set_yticks(places, [names.array(response.name) for response in shown])
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        panel.set_xlim(0.5 * min(response.rms for response in shown), 3.0 * shown[0].rms)
        panel.set_xlabel(f"response, {result.unit or '1'}")
        told = f"{named(result.experiment)}: {shown[0].name} does most, {_number(shown[0].rms)} of"
        title(drawing, panel, f"{told} {_number(result.total)} {result.unit}")
        return png(drawing)


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"
