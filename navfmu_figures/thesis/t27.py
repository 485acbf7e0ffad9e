"""Fixes by distances and bearings of two stations, and their ellipses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pymap3d import vincenty

from navfmu.analysis.circle import principal
from navfmu.analysis.fix import covariance, methods, solve
from navfmu.analysis.fix_picture import ellipse
from navfmu.analysis.line import DISTANCE, Line
from navfmu.analysis.place import Place, moved
from navfmu.constants import NAUTICAL_MILE
from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.navaids.station import Station
from navfmu.report.figure import COLOURS, figure, png, title

ORIGIN = Place(float(np.radians(37.7)), float(np.radians(-121.8)), 0.0)
"""Where the axes of Fig D.4 begin is not printed; the ellipses hardly depend on it."""
STATIONS = {"A": (8.6, -1.5), "B": (7.6, 14.9)}
"""nmi to north and east."""
DISTANCES, BEARINGS = (13.9, 24.7), (187.0, 226.0)
"""Measured, nmi and deg."""
STATED, OF_THE_TABLE = 0.17, 0.1
"""One sigma of a distance, nmi: what section D.5 says, and what Table D.1 is computed with."""
TURN = np.radians(1.0)
TABLE = {
    "rho-rho A B": (0.0750, 0.2131),
    "rho-theta A": (0.1003, 0.2419),
    "rho-theta B": (0.0998, 0.4321),
    "theta-theta A B": (0.2198, 0.7598),
    "all of A B": (0.0749, 0.2075),
}
"""Table D.1: short and long axis, nmi."""


def station(ident: str) -> Station:
    """One of Fig D.4, at sea level."""
    north, east = STATIONS[ident]
    far, bearing = NAUTICAL_MILE * np.hypot(north, east), np.degrees(np.arctan2(east, north)) % 360.0
    latitude, longitude = np.radians(vincenty.vreckon(*np.degrees(ORIGIN.values()[:2]), far, bearing))
    longitude = (longitude + np.pi) % (2.0 * np.pi) - np.pi
    return Station(ident, "", float(latitude), float(longitude), 0.0, 110.0, 100 * NAUTICAL_MILE)


def lines(sigma: float) -> dict[str, tuple[Line, ...]]:
    """The five fixes, with this sigma of a distance, nmi."""
    return methods([station(ident) for ident in STATIONS], sigma * NAUTICAL_MILE, float(TURN))


@dataclass(frozen=True)
class Bearings:
    """``true`` bearings of the place that both distances give, and their mean ``turn`` from the printed ones; deg."""

    true: np.ndarray
    turn: float

    @classmethod
    def of_distances(cls) -> Bearings:
        """By the circles' southern crossing."""
        some = lines(STATED)
        start = map(float, moved(*ORIGIN.values(), -10e3, -10e3))
        found = solve(some["rho-rho A B"], NAUTICAL_MILE * np.array(DISTANCES), *start, 0.0)
        true = np.degrees([line.seen(*found, np.zeros(()))[0] for line in some["theta-theta A B"]])
        return cls(true, float(np.mean(true - BEARINGS)))


def place(turn: float) -> Place:
    """By all four lines, with bearings that are turned by so much, deg."""
    told = np.concatenate([NAUTICAL_MILE * np.array(DISTANCES), np.radians(np.add(BEARINGS, turn))])
    found = solve(lines(STATED)["all of A B"], told, ORIGIN.latitude, ORIGIN.longitude, 0.0)
    return Place(float(found[0]), float(found[1]), 0.0)


def axes(where: Place, sigma: float) -> dict[str, tuple[float, float]]:
    """Short and long axis of each fix, one sigma, nmi."""
    return {name: _axes(packed) for name, packed in covariances(where, sigma).items()}


def covariances(where: Place, sigma: float) -> dict[str, np.ndarray]:
    """Of each fix, packed, m2."""
    return {name: covariance(some, *map(np.asarray, where.values())) for name, some in lines(sigma).items()}


def without_weights(where: Place, sigma: float) -> tuple[float, float]:
    """Axes of least squares of all four lines that takes 1 nmi for as good as 1 rad; nmi."""
    some = lines(sigma)["all of A B"]
    unit = np.array([1.0 if line.kind == DISTANCE else NAUTICAL_MILE for line in some])
    rows = np.array([line.seen(*map(np.asarray, where.values()))[1] for line in some]) * unit[:, None]
    noise = np.array([line.sigma for line in some]) * unit
    gain = np.linalg.pinv(rows) * noise
    spread = gain @ gain.T
    return _axes(np.array([spread[0, 0], spread[0, 1], spread[1, 1]]))


def _axes(packed: np.ndarray) -> tuple[float, float]:
    long, short = (float(axis) / NAUTICAL_MILE for axis in principal(packed))
    return short, long


@row("Two distances fix a position better than bearings do", "thesis Appendix D, Table D.1, Figs D.4 and D.5")
def t27(task: Task) -> Found:
    """The ellipses of Table D.1."""
    bearings = Bearings.of_distances()
    where = place(bearings.turn)
    table, stated = axes(where, OF_THE_TABLE), axes(where, STATED)
    notes = [
        "(D.11) is printed with an H' too many, and (D.3) the other way round than (D.4); neither is in the table.",
        "`navfmu analyse fix` solves 20 000 fixes with errors beside the ellipses: 95 % circles are the same to 1 %.",
    ]
    words = "Ellipses of one sigma with the noise of the table, and with the noise that is stated"
    found = [*turned(bearings), *compared(table, without_weights(where, OF_THE_TABLE)), *best(table, stated)]
    return Found(found, picture(where), words, notes)


def turned(bearings: Bearings) -> list[Comparison]:
    """The printed bearings beside those of the place that the distances give."""
    why = (
        f"both bearings are turned by the same {bearings.turn:.1f} deg to half a degree: they count from magnetic "
        "north, as a VOR's do, where the coordinates count from true north"
    )
    return [
        Comparison(
            f"bearing from {ident} at the place of both distances", f"{printed:g} deg", float(true), printed - 0.5,
            printed + 0.5, "no more digits are printed", "deg",
            Difference(printed + bearings.turn - 0.5, printed + bearings.turn + 0.5, why),
        )
        for ident, printed, true in zip(STATIONS, BEARINGS, bearings.true, strict=True)
    ]  # fmt: skip


def compared(table: dict[str, tuple[float, float]], unweighted: tuple[float, float]) -> list[Comparison]:
    """The printed axes beside ours with the noise of the table."""
    found = []
    for name, printed in TABLE.items():
        for which, one, ours in zip(("short", "long"), printed, table[name], strict=True):
            why = "the digits of the measured distances and bearings move axes by 1 % and more"
            known = None
            if (name, which) == ("all of A B", "long"):
                known = Difference(
                    0.150, 0.158,
                    "the table calls it weighted, and it is that of least squares without weights, in nmi and rad, in "
                    f"which a bearing counts next to nothing: {unweighted[1]:.4f} nmi",
                )  # fmt: skip
            found.append(
                Comparison(f"{name}: {which} axis", f"{one:.4f} nmi", ours, 0.99 * one, 1.01 * one, why, "nmi", known)
            )
    digits = "as the other axes"
    short, long = TABLE["all of A B"]
    return [
        *found,
        Comparison("all of A B without weights: short axis", f"{short} nmi", unweighted[0], 0.99 * short, 1.01 * short,
                   digits, "nmi"),
        Comparison("all of A B without weights: long axis", f"{long} nmi", unweighted[1], 0.99 * long, 1.01 * long,
                   digits, "nmi"),
    ]  # fmt: skip


def noise(table: dict[str, tuple[float, float]]) -> float:
    """The sigma of a distance, nmi, of which those printed axes are that come of distances alone."""
    alone = (("rho-rho A B", 0), ("rho-rho A B", 1), ("rho-theta A", 0), ("rho-theta B", 0))
    return OF_THE_TABLE * float(np.mean([TABLE[name][which] / table[name][which] for name, which in alone]))


def best(table: dict[str, tuple[float, float]], stated: dict[str, tuple[float, float]]) -> list[Comparison]:
    """Whether two distances are best."""
    names = ("rho-theta A", "rho-theta B", "theta-theta A B")
    why = "rho-rho is the better one, is the claim"
    near = Difference(
        1.2, 1.4,
        "with 0.17 nmi a distance of 13.9 nmi and a bearing of 1 deg, which is 0.24 nmi there and crosses at 90 deg, "
        "are better than two distances that cross at 39 deg: the claim holds of far stations",
    )  # fmt: skip
    return [
        Comparison(
            "sigma of a distance of which the table is", "0.17 nmi", noise(table), 0.165, 0.175, "its digits", "nmi",
            Difference(0.099, 0.101, "all four axes that come of distances alone are those of 0.1 nmi"),
        ),
        *(
            Comparison(
                f"drms of rho-rho over that of {name}, sigma {whose}", "less than 1", ratio(of, name), 0.0, 1.0, why,
                difference=near if (whose, name) == ("as stated", "rho-theta A") else None,
            )
            for whose, of in (("of the table", table), ("as stated", stated))
            for name in names
        ),
    ]  # fmt: skip


def ratio(of: dict[str, tuple[float, float]], name: str) -> float:
    """drms of rho-rho over that of another fix."""
    return float(np.hypot(*of["rho-rho A B"]) / np.hypot(*of[name]))


def picture(where: Place) -> bytes:
    """Fig D.5, and the same with the stated noise."""
    with figure(1, 2, size=(11.0, 5.2)) as (drawing, panels):
        for axis, sigma in zip(panels, (OF_THE_TABLE, STATED), strict=True):
            _ellipses(axis, covariances(where, sigma))
            axis.set(aspect="equal", xlim=(-0.8, 0.8), ylim=(-0.8, 0.8))
            axis.set(xlabel="error to the east, nmi", ylabel="error to the north, nmi")
            title(drawing, axis, f"Distances of {sigma:g} nmi, bearings of 1 deg")
        panels[0].legend(loc="upper left", fontsize=8)
        return png(drawing)


def _ellipses(axis, found: dict[str, np.ndarray]) -> None:
    colours: Sequence[str] = COLOURS
    for colour, (name, packed) in zip(colours, found.items(), strict=False):
        axis.plot(*(part / NAUTICAL_MILE for part in ellipse(packed)), color=colour, lw=1.6, label=name)
