"""What dead reckoning and inertial navigation by themselves come to in half an hour."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.claims import FMUS, Flight, first_above, horizontal
from navfmu_figures.thesis.error_models import ABEAM, CRUISE_NORTH, KNOWN, unit

STOP = 1800.0
HALF_MILE, SAID = 926.0, 700.0
"""Half a nautical mile, and what the text takes it for (p. 178), m."""
CONVENTIONS = {"1 Hz": 1.0, "100 Hz": 0.01}
"""Samples per second that the wide-band noise of Table 5.2 is that of, and their period, s."""
SAMPLE, FILTER = 0.1, 1.0
GRADES = ("tactical", "automotive", "consumer")
RECKONING = "dead reckoning"


@dataclass(frozen=True)
class Errors:
    """Horizontal errors, m, by seconds, (5.61)."""

    reckoning: pd.Series
    inertial: Mapping[tuple[str, str], pd.Series]
    """By grade and convention."""


@row(
    "A tactical inertial navigator passes half a mile at 550 s and dead reckoning at 1200 s; the others are worse",
    "thesis section 5.5, pp. 172-181, Tables 5.1, 5.2, (5.57)-(5.61), Figs 5.4, 5.5",
    fmus=[*FMUS, "navigator_reckoning", "navigator_inertial"],
)
def t20(task: Task) -> Found:
    """Covariances of both along half an hour to the north, from no error on."""
    errors = grown(task)
    words = "Horizontal error without aiding by time, and the first ten minutes"
    return Found([*tactical(errors), *reckoning(errors), *others(errors)], picture(errors), words, NOTES)


NOTES = (
    "The text takes half a nautical mile for 700 m (p. 178); it is 926 m. Both are given.",
    "Table 5.2 gives wide-band noise in deg/s and g. Taken as densities, as of samples at 1 Hz, the tactical unit "
    "passes 700 m when the text says so; taken as that of samples at 100 Hz it does so three minutes later.",
    "The ones on the diagonal of P2P (5.41) would let a position error grow by itself; they are zeros. A2V (5.45) is "
    "the cross product with the specific force.",
    "Known at the start, (5.59), (5.60), and altitude and vertical velocity held, p. 174.",
)


def grown(task: Task) -> Errors:
    """Fly both."""
    flight = Flight(task.folder / "reckoning", task.fmus, CRUISE_NORTH, ABEAM)
    reckoned = horizontal(flight.claims("navigator_reckoning", STOP, KNOWN))
    flight = Flight(task.folder / "inertial", task.fmus, CRUISE_NORTH, ABEAM, SAMPLE)
    inertial = {}
    for grade in GRADES:
        for convention, period in CONVENTIONS.items():
            values = {
                **unit(grade),
                "noise_period": period,
                "sample_period": SAMPLE,
                "filter_period": FILTER,
                "dme_aiding": False,
            }
            inertial[grade, convention] = horizontal(flight.claims("navigator_inertial", STOP, values, inertial=True))
            task.progress(len(inertial), len(GRADES) * len(CONVENTIONS))
    return Errors(reckoned, inertial)


def tactical(errors: Errors) -> list[Comparison]:
    """When the tactical unit passes half a mile, and is passed by dead reckoning."""
    ours = errors.inertial["tactical", "1 Hz"]
    sampled = errors.inertial["tactical", "100 Hz"]
    digits = "'approximately 550 seconds', read off Fig 5.4 to half a division of 50 s"
    mile = Difference(600.0, 650.0, "the text takes 0.5 nmi for 700 m, and 926 m are passed a minute later")
    noise = Difference(700.0, 760.0, "noise of samples at 100 Hz has a tenth of the deviation of one at 1 Hz")
    passed = first_above(ours - errors.reckoning.reindex(ours.index), 0.0)
    wind = Difference(
        1500.0, 1750.0,
        "Table 5.1 makes dead reckoning worse than Fig 5.4 shows: at 1200 s the wind of (3.36) alone, in closed form, "
        f"has {wind_alone(1200.0):.0f} m, where the tactical unit has {ours.loc[1200.0]:.0f} m",
    )  # fmt: skip
    return [
        Comparison("tactical passes 700 m, noise at 1 Hz", "550 s", first_above(ours, SAID), 525.0, 575.0, digits, "s"),
        Comparison("tactical passes 926 m, noise at 1 Hz", "550 s", first_above(ours, HALF_MILE), 525.0, 575.0, digits,
                   "s", difference=mile),
        Comparison("tactical passes 700 m, noise at 100 Hz", "550 s", first_above(sampled, SAID), 525.0, 575.0, digits,
                   "s", difference=noise),
        Comparison("dead reckoning is better than tactical from", "1200 s", passed, 1150.0, 1250.0,
                   "'approximately 1200 seconds'", "s", difference=wind),
    ]  # fmt: skip


def wind_alone(time: float, sigma: float = 5.0, tau: float = 400.0) -> float:
    """Horizontal error, m, of a wind of two axes that is known at first: the integral of a Gauss-Markov process."""
    x = time / tau
    gained = 2.0 * x - 3.0 + 4.0 * np.exp(-x) - np.exp(-2.0 * x)
    return float(np.sqrt(2.0) * sigma * tau * np.sqrt(gained))


def reckoning(errors: Errors) -> list[Comparison]:
    """When dead reckoning passes half a mile."""
    why = "'in less than 7 minutes' (p. 184)"
    return [
        Comparison("dead reckoning passes 926 m", "before 420 s", first_above(errors.reckoning, HALF_MILE), 0.0, 420.0,
                   why, "s"),
    ]  # fmt: skip


def others(errors: Errors) -> list[Comparison]:
    """From when on the cheaper units are worse than dead reckoning."""
    found = []
    for grade in GRADES[1:]:
        ours = errors.inertial[grade, "1 Hz"]
        first = first_above(ours - errors.reckoning.reindex(ours.index), 0.0)
        why = "it begins without an error, and a t-cubed curve is below a line at first: Fig 5.5 shows no crossing"
        found.append(Comparison(f"{grade} is worse from", "throughout", first, 0.0, 90.0, why, "s"))
    return found


def picture(errors: Errors) -> bytes:
    """Figs 5.4 and 5.5."""
    with figure(1, 2, size=(11.5, 4.4)) as (drawing, axes):
        for axis, stop, top in zip(axes, (30.0, 10.0), (9.0, 2.0), strict=True):
            axis.plot(errors.reckoning.index / 60.0, errors.reckoning / 1e3, color="k", label=RECKONING)
            for (grade, convention), one in errors.inertial.items():
                colour = COLOURS[GRADES.index(grade)]
                style = "-" if convention == "1 Hz" else "--"
                label = f"{grade} unit" if convention == "1 Hz" else None
                axis.plot(one.index / 60.0, one / 1e3, style, color=colour, label=label)
            axis.axhline(HALF_MILE / 1e3, color="0.5", lw=0.8)
            axis.set(xlabel="time, min", ylabel="horizontal error, 1 sigma, km", xlim=(0.0, stop), ylim=(0.0, top))
        axes[0].legend(title="dashed: noise of samples at 100 Hz")
        worse = first_above(errors.inertial["tactical", "1 Hz"] - errors.reckoning, 0.0)
        title(drawing, axes[0], f"A tactical unit is better than dead reckoning for {worse / 60.0:.0f} min")
        passed = first_above(errors.reckoning, HALF_MILE)
        title(drawing, axes[1], f"Dead reckoning is half a mile off after {passed / 60.0:.0f} min")
        return png(drawing)
