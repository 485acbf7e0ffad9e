"""A flight whose GPS is taken away every 10 s: tracks, and errors by the time since then."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from evidence.recorded_sensors.flown import COVARIANCE, STRAPDOWN, Cut, Flown, fix_sigma
from models.navigation import navigator
from navfmu.report.figure import COLOURS, GREY, figure, png, title

ALONE, RANGED, LIMIT = COLOURS[1], COLOURS[0], COLOURS[2]
SHOWN = 4
"""Tracks of so many cuts are drawn in one map."""
FEWEST = 2
"""Cuts of which a median is drawn."""


def drawn(flown: Flown) -> bytes:
    """Above without, below with DME (of one seed): the track and those after some cuts; errors of all of them."""
    with figure(2, 2, size=(12.0, 10.0), left=0.85, below=0.5, gridspec_kw={"width_ratios": (1.0, 1.35)}) as (
        drawing,
        axes,
    ):
        rows = (("no GPS, no DME", flown.alone, ALONE), ("no GPS, DME", flown.ranging[0], RANGED))
        places = [track(flown)] + [way(flown, cut) for _, cuts, _ in rows for cut in cuts[:: spread(cuts)]]
        around = [(np.min(part), np.max(part)) for part in np.hstack(places)]
        for (left, right), (words, cuts, colour) in zip(axes, rows, strict=True):
            map_(left, flown, cuts, colour, around)
            title(drawing, left, f"{flown.flight.name}: {words}")
            every = cuts if cuts is flown.alone else flown.ranged
            most = max(np.max(cut.distance) for cut in every)
            errors(right, flown, every, colour, 1.3 * (most if cuts is flown.alone else max(most, fix_sigma())))
            several = "" if cuts is flown.alone else f", {len(flown.ranging)} seeds"
            title(drawing, right, f"Error after {len(cuts)} cuts{several}")
        axes[1][1].axhline(fix_sigma(), color=LIMIT, ls="--", label="sigma of a fix by three ranges")
        axes[1][0].legend(loc="upper left", bbox_to_anchor=(-0.05, -0.11), ncols=2)
        for axis in axes[:, 1]:
            axis.legend(loc="upper left", frameon=True, framealpha=0.9, edgecolor="none")
        return png(drawing)


def spread(cuts: Sequence[Cut]) -> int:
    """Every how many cuts one is drawn in a map."""
    return -(-len(cuts) // SHOWN)


def track(flown: Flown) -> np.ndarray:
    """East and north of the recorded fixes in flight, m from the first one there."""
    fixes = flown.flight.gps
    fixes = fixes[fixes["time"].between(*flown.flight.airborne)]
    return local(flown, fixes["latitude"].to_numpy(), fixes["longitude"].to_numpy())


def way(flown: Flown, cut: Cut) -> np.ndarray:
    """East and north of a navigator after its cut, m."""
    return local(flown, cut.solution["latitude"].to_numpy(), cut.solution["longitude"].to_numpy())


def local(flown: Flown, latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """East and north, m from the first fix in flight."""
    fixes = flown.flight.gps
    first = fixes[fixes["time"] >= flown.flight.airborne[0]].iloc[0]
    place = first["latitude"], first["longitude"], first["altitude"]
    return navigator.offset(*place, latitude, longitude)[::-1]


def map_(axis: Any, flown: Flown, cuts: Sequence[Cut], colour: str, around: Sequence[tuple[float, float]]) -> None:
    """The recorded track, and that of some navigators from their cuts to the end, with 3 sigma there."""
    axis.plot(*track(flown), color=GREY, lw=1.6, label="recorded by GPS")
    for number, cut in enumerate(cuts[:: spread(cuts)]):
        east, north = way(flown, cut)
        axis.plot(east, north, color=colour, lw=0.9, alpha=0.8, label="navigator, after a cut" if not number else None)
        axis.plot(east[0], north[0], "o", color="black", ms=4, label="GPS taken away" if not number else None)
    covariance = cut.solution[list(COVARIANCE)].iloc[-1]
    ellipse = three_sigma(*covariance) + np.array([[east[-1]], [north[-1]]])
    axis.plot(*ellipse, color=colour, ls="--", lw=0.9, label="3 sigma at the end, of the last of them")
    middle = [0.5 * (low + high) for low, high in around]
    half = 0.55 * max(high - low for low, high in around)
    axis.set_xlim(middle[0] - half, middle[0] + half)
    axis.set_ylim(middle[1] - half, middle[1] + half)
    axis.set_aspect("equal")
    axis.set_xlabel("east, m")
    axis.set_ylabel("north, m")


def three_sigma(nn: float, ne: float, ee: float) -> np.ndarray:
    """East and north of the ellipse with three times the standard deviations, m."""
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    root = np.linalg.cholesky(np.array([[ee, ne], [ne, nn]]))
    return 3.0 * root @ np.stack([np.cos(angle), np.sin(angle)])


def errors(axis: Any, flown: Flown, cuts: Sequence[Cut], colour: str, most: float) -> None:
    """Errors by the time since the cut: of each, the median, what the navigators say of it, and the baseline."""
    longest = flown.flight.airborne[1] - flown.flight.learned
    since = np.arange(0.0, longest, 1.0)
    for cut in cuts[: len(flown.alone)]:
        axis.plot(cut.distance.index - cut.time, cut.distance, color=colour, lw=0.5, alpha=0.3)
    middle = [(cut.distance.index - cut.time, cut.distance) for cut in cuts]
    axis.plot(
        since,
        medians(since, middle, FEWEST * len(cuts) // len(flown.alone)),
        color=colour,
        lw=2.4,
        label="median of the cuts",
    )
    sigmas = [(c.errors.index - c.time, 3.0 * np.sqrt(0.5 * (c.errors["nn"] + c.errors["ee"]))) for c in cuts]
    axis.plot(
        since, medians(since, sigmas, 1), color="black", ls=":", label="3 sigma of an axis, as the navigators say"
    )
    if flown.baseline and cuts is flown.alone:
        theirs = [(times - cut, error) for cut, (times, error) in zip(flown.flight.cuts, flown.baseline, strict=True)]
        axis.plot(
            since,
            medians(since, theirs, FEWEST),
            color=GREY,
            lw=1.6,
            label="with the log's own heading, which kept GPS: median",
        )
    if STRAPDOWN in flown.by and cuts is flown.alone:
        integrated = [(cut.distance.index - cut.time, cut.distance) for cut in flown.by[STRAPDOWN]]
        axis.plot(since, medians(since, integrated, FEWEST), color=COLOURS[3], lw=1.6, label=f"{STRAPDOWN}: median")
    axis.set_xlim(0.0, longest)
    axis.set_ylim(0.0, most)
    axis.set_xlabel("time without GPS, s")
    axis.set_ylabel("horizontal error, m")


def medians(since: np.ndarray, curves: Sequence[tuple[Any, Any]], fewest: int) -> np.ndarray:
    """Median of curves (times, values) at times; nan where fewer go on."""
    values = np.array([np.interp(since, times, each, right=np.nan) for times, each in curves])
    there = np.sum(np.isfinite(values), axis=0) >= max(fewest, 1)
    found = np.full(len(since), np.nan)
    found[there] = np.nanmedian(values[:, there], axis=0)
    return found
