"""Half an hour without GPS: who is within half a nautical mile, and who was said to be."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy import stats

from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, figure, png, title
from navfmu_figures.thesis.flown import FMUS, Flights, Flown, Side

RUNS = 200
LOST, STOP = 300.0, 2100.0
LIMIT = 926.0
"""Half a nautical mile, m."""
OPEN = "open loop"
AIDED = {"1 receiver": 1, "2 receivers": 2, "scanning": 3}
RARE = 1e-3
DRAWS = 400
"""Directions in which the share of a normal error outside a circle is summed."""


def sides() -> dict[str, Side]:
    """The navigator of the thesis three times, and one without ranges."""
    aided = {name.replace(" ", "_"): Side("navigator_reduced", {}, mode) for name, mode in AIDED.items()}
    return {
        OPEN.replace(" ", "_"): Side("navigator_reckoning"),
        **{f"with_{name}": side for name, side in aided.items()},
    }


@row(
    "Open loop leaves half a nautical mile within 15 minutes; the aided navigators stay within, on the one flight",
    "thesis section 7.3, pp. 213-221, Figs 7.12 to 7.15",
    fmus=[*FMUS, "navigator_reckoning", "navigator_reduced"],
)
def t25(task: Task) -> Found:
    """RUNS flights of the kind of Fig 7.12 with circles and a straight approach."""
    flown = Flights(task, sides()).fly(RUNS, STOP, (LOST, None))
    by_name = dict(zip((OPEN, *AIDED), flown.values(), strict=True))
    words = f"Horizontal errors of {RUNS} flights by navigator: half and 95 % of them, and half a nautical mile"
    return Found(compared(by_name), picture(by_name), words, NOTES)


NOTES = (
    "The text gives no coordinates of the transponders: ours are two whose lines cross near 90 degrees, as in Fig "
    "7.12.",
    "The thesis shows one flight. Its R (6.40) leaves the bias of 0.17 nmi out; ours has it as noise with its "
    "correlation.",
)


def after(flown: Flown) -> Flown:
    """Without GPS, every ten seconds."""
    return flown.at(np.arange(LOST + 10.0, STOP + 1.0, 10.0))


def outside(flown: Flown) -> np.ndarray:
    """The probability, by what was claimed, that an error is more than LIMIT, of each run and time.

    The radius of a normal error in a direction u, of which all are as likely after whitening, is that of Rayleigh.
    """
    angles = np.linspace(0.0, np.pi, DRAWS, endpoint=False)
    a = np.sqrt(flown.nn)[..., None]
    b = (flown.ne / np.sqrt(flown.nn))[..., None]
    c = np.sqrt(np.maximum(flown.ee - flown.ne**2 / flown.nn, 0.0))[..., None]
    north, east = a * np.cos(angles), b * np.cos(angles) + c * np.sin(angles)
    return np.mean(np.exp(-0.5 * LIMIT**2 / (north**2 + east**2)), axis=-1)


def share(values: np.ndarray) -> tuple[float, float]:
    """A mean over runs, and its standard deviation, from one value of each run."""
    return float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(len(values)))


def compared(by_name: Mapping[str, Flown]) -> list[Comparison]:
    """What is printed of one flight, among ours, and shares of time as they were claimed."""
    found = [leaving(by_name[OPEN]), *(staying(name, by_name[name]) for name in AIDED)]
    return [*found, *(as_claimed(name, flown) for name, flown in by_name.items())]


def staying(name: str, flown: Flown) -> Comparison:
    """The share of flights that are within LIMIT all the time."""
    within = np.all(after(flown).error <= LIMIT, axis=1)
    low, high = stats.binomtest(int(np.sum(within)), len(within)).proportion_ci(1.0 - RARE)
    why = (
        f"the one flight of the thesis does, which is no wonder if one in twenty does; of ours {100 * low:.0f} to "
        f"{100 * high:.0f} % ({len(within)} flights)"
    )
    what = f"flights that stay within 0.5 nmi all the time, {name}"
    return Comparison(what, "the one flown", 100.0 * float(np.mean(within)), 5.0, 100.0, why, "%")


def as_claimed(name: str, flown: Flown) -> Comparison:
    """The share of time beyond LIMIT, which the covariance predicts."""
    one = after(flown)
    claimed = 100.0 * float(np.mean(outside(one)))
    seen, sigma = share(100.0 * np.mean(one.error > LIMIT, axis=1))
    reach = float(stats.norm.isf(0.5 * RARE)) * sigma
    why = f"{claimed:.2f} % by covariance, and a mean of {len(one.error)} flights scatters by {sigma:.2f} %"
    what = f"time beyond 0.5 nmi, {name}"
    return Comparison(what, "by the covariance", seen, claimed - reach, claimed + reach, why, "%")


def leaving(flown: Flown) -> Comparison:
    """The share of flights in which open loop is beyond LIMIT at some time of the first 15 minutes."""
    early = flown.at(np.arange(LOST + 10.0, LOST + 901.0, 10.0))
    gone = 100.0 * float(np.mean(np.any(early.error > LIMIT, axis=1)))
    why = "on the thesis's one flight it is: more than half of ours are, so that one flight tells nothing else"
    return Comparison("flights beyond 0.5 nmi within 15 min, open loop", "the one flown", gone, 50.0, 100.0, why, "%")


def picture(by_name: Mapping[str, Flown]) -> bytes:
    """Errors by time, and the share of flights beyond half a mile with what was claimed."""
    with figure(1, 2, size=(12.0, 4.4)) as (drawing, (errors, shares)):
        for (name, flown), colour in zip(by_name.items(), COLOURS, strict=False):
            one = after(flown)
            minutes = (one.time - LOST) / 60.0
            errors.plot(minutes, np.median(one.error, axis=0), color=colour, label=name)
            errors.plot(minutes, np.quantile(one.error, 0.95, axis=0), color=colour, lw=0.8, ls="--")
            shares.plot(minutes, 100.0 * np.mean(one.error > LIMIT, axis=0), color=colour, label=name)
            shares.plot(minutes, 100.0 * np.mean(outside(one), axis=0), color=colour, lw=0.8, ls="--")
        errors.axhline(LIMIT, color="0.4", lw=0.8)
        errors.set(xlabel="time without GPS, min", ylabel="horizontal error, m", ylim=(0.0, 4000.0))
        errors.legend(title="half of the flights (dashed: 95 %)")
        aided = max(float(np.max(np.median(after(by_name[name]).error, axis=0))) for name in AIDED)
        title(drawing, errors, f"Half of the aided flights are within {aided:.0f} m at all times")
        shares.set(xlabel="time without GPS, min", ylabel="beyond 0.5 nmi, %", ylim=(0.0, 100.0))
        shares.legend(title="seen (dashed: by covariance)")
        title(
            drawing, shares, f"Shares of {len(next(iter(by_name.values())).error)} flights beyond half a nautical mile"
        )
        return png(drawing)
