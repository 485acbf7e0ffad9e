"""Pictures of recorded flights: one of each flight, and one of how honest the sigmas are on all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from evidence.recorded.figures import Angle, Position
from evidence.recorded.flight import ANGLES, LOST, SEEDS, VARIANTS, Flown
from navfmu.report.figure import COLOURS, GREY, figure, png


def of_flight(flown: Flown) -> bytes:
    """Track and stations, how many can be used, their geometry, and the error of every variant."""
    track, chosen = flown.track, flown.chosen
    minutes = track["time"] / 60.0
    with figure(2, 2, size=(12.0, 8.0)) as (drawing, ((where, count), (dilution, error))):
        where.plot(np.degrees(track["longitude"]), np.degrees(track["latitude"]), color=COLOURS[0], lw=1, label="track")
        for station in chosen.stations:
            place = np.degrees([station.longitude, station.latitude])
            where.plot(*place, "^", color=COLOURS[1])
            where.annotate(station.ident, place, xytext=(4, 4), textcoords="offset points")
        where.set_aspect(1.0 / np.cos(np.mean(track["latitude"])))
        where.set_title(f"{flown.title}: the flight and its DME stations")
        where.set_xlabel("longitude, deg")
        where.set_ylabel("latitude, deg")
        where.legend()

        count.step(minutes, flown.heard.count, color=GREY, label="in reach")
        count.step(minutes, chosen.count, color=COLOURS[0], label="of those chosen")
        count.set_title("Usable stations")
        count.set_xlabel("time, min")
        count.set_ylabel("number")
        count.legend()

        dilution.plot(minutes, np.minimum(chosen.hdop, 10.0), color=COLOURS[0])
        dilution.set_title("Geometry: HDOP of the usable chosen stations (cut at 10)")
        dilution.set_xlabel("time, min")
        dilution.set_ylabel("HDOP")

        for colour, (variant, runs) in zip(COLOURS, flown.runs.items(), strict=False):
            values = np.array([run["evaluation.horizontal_error"].to_numpy() for run in runs])
            time = runs[0].index.to_numpy() / 60.0
            most = np.percentile(values, 95, axis=0, method="higher")
            error.plot(time, np.median(values, axis=0), color=colour, lw=1, label=f"{VARIANTS[variant]}: median")
            error.plot(time, most, color=colour, lw=0.7, ls="--", label="95th percentile")
        error.axhline(926.0, color=GREY, lw=1)
        error.axvline(LOST / 60.0, color=GREY, lw=1, ls=":")
        error.set_title(f"Horizontal error without GPS from minute {LOST / 60:.0f} on, {SEEDS} seeds")
        error.set_xlabel("time, min")
        error.set_ylabel("m")
        error.legend(fontsize=8)
        return png(drawing)


def of_sigmas(
    attitude: Mapping[str, Mapping[str, Angle]],
    navigators: Mapping[str, Mapping[str, Position]],
    titles: tuple[str, str],
) -> bytes:
    """Normalised squared errors of all flights, each divided by what an honest filter has, so that 1 is honest."""
    with figure(1, 2, size=(12.0, 4.8), below=0.9) as (drawing, (left, right)):
        _bars(left, {name: {a: one[a].nees for a in ANGLES} for name, one in attitude.items()}, 1.0, ANGLES)
        shown = {flight: {v: p.nees for v, p in one.items()} for flight, one in navigators.items()}
        _bars(right, shown, 2.0, list(VARIANTS))
        for axis, title in zip((left, right), titles, strict=True):
            axis.set_title(title)
        return png(drawing)


def _bars(axis, values: Mapping[str, Mapping], honest: float, kinds: Sequence[str]) -> None:
    places = np.arange(len(values))
    for i, (kind, colour) in enumerate(zip(kinds, COLOURS, strict=False)):
        at = [k for k, one in enumerate(values.values()) if kind in one]
        means = [one[kind] for one in values.values() if kind in one]
        axis.errorbar(
            places[at] + 0.2 * (i - 1),
            [m.value / honest for m in means],
            [m.half / honest for m in means],
            fmt="o",
            color=colour,
            capsize=3,
            label=VARIANTS.get(kind, kind),
        )
    axis.axhline(1.0, color=GREY, lw=1)
    axis.axhspan(0.5, 1.5, color=GREY, alpha=0.1, label="0.5 to 1.5")
    axis.set_ylim(0.0, None)
    axis.set_xticks(
        places, [name.replace("_in_", "\nin ").replace("_", " ") for name in values], rotation=30, ha="right"
    )
    axis.set_ylabel("normalised squared error (1: honest)")
    axis.legend(fontsize=8)
