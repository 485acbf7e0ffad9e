"""How many DME stations 200 airports need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navfmu.constants import FOOT
from navfmu.figures import Comparison, Difference, Found, Task, row
from navfmu.navaids.sight import ANTENNA, horizon
from navfmu.report.figure import COLOURS, figure, png, title

AREA = (4600e3, 1665e3)
"""A rectangle, m, as large as the 48 states, 7.66 million km2."""
STATIONS, AIRPORTS = 932, 200
"""Fig 2.11; the 200 busiest airports."""
DRAWS = 40
OPTIONS = ((2, 1500.0, 318, 25), (2, 500.0, 356, 32), (3, 1500.0, 442, 76), (3, 500.0, 512, 119))
"""How many stations at which height (ft); stations in all, and how many of them are new."""
NAMES = ("I", "II", "III", "IV")


@row(
    "Double and triple coverage of 200 airports down to 1500 and 500 ft takes 318 to 512 stations",
    "thesis section 2.6, Fig 2.13 (after its reference [55])",
)
def t33(task: Task) -> Found:
    """Count them by line of sight alone, for stations and airports at random places."""
    rng = np.random.default_rng(task.seed)
    even, near = [], []
    for number in range(DRAWS):
        country = Country.drawn(rng)
        even.append(country.counts())
        near.append(country.with_stations_at_airports().counts())
        task.progress(number + 1, DRAWS)
    found, at = np.array(even), np.array(near)
    words = f"Stations by option: printed, and {DRAWS} countries of stations and airports at random places"
    return Found(compared(found, at), picture(found, at), words, NOTES)


NOTES = (
    "What is printed of options I and II does not add up: 273 existing and 25 new stations are 298, not 318, and 356 "
    "and 32 are 388, not 356.",
    "Where stations and airports are the thesis does not say: ours are spread evenly over as large an area, the Earth "
    "is smooth, and the stations that serve most airports are taken first.",
)


@dataclass(frozen=True)
class Country:
    """Places in m, (stations, 2) and (airports, 2)."""

    stations: np.ndarray
    airports: np.ndarray

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Country:
        """Places that are all as likely."""
        return cls(rng.uniform(size=(STATIONS, 2)) * AREA, rng.uniform(size=(AIRPORTS, 2)) * AREA)

    def with_stations_at_airports(self) -> Country:
        """The same, but a station stands at each airport."""
        return Country(np.concatenate([self.airports, self.stations[len(self.airports) :]]), self.airports)

    def counts(self) -> list[tuple[int, int]]:
        """Stations in all and new ones, of each option."""
        return [self.needed(least, height * FOOT) for least, height, *_ in OPTIONS]

    def needed(self, least: int, height: float) -> tuple[int, int]:
        """With so many stations at a height (m) above each airport: existing ones first, then new ones at airports."""
        far = float(horizon(height) + horizon(ANTENNA))
        need = np.full(len(self.airports), least)
        old = taken(within(self.stations, self.airports, far), need)
        new = taken(np.repeat(within(self.airports, self.airports, far), least, axis=0), need)
        return old + new, new


def within(stations: np.ndarray, airports: np.ndarray, far: float) -> np.ndarray:
    """Which stations are heard over which airports, (stations, airports)."""
    return np.linalg.norm(stations[:, None] - airports, axis=2) <= far


def taken(heard: np.ndarray, need: np.ndarray) -> int:
    """How many stations are taken, each time the one that serves most airports that lack one; ``need`` is reduced."""
    left = heard.copy()
    count = 0
    while (serves := np.sum(left & (need > 0), axis=1)).max() > 0:
        best = int(np.argmax(serves))
        need -= left[best] & (need > 0)
        left[best] = False
        count += 1
    return count


def compared(found: np.ndarray, at: np.ndarray) -> list[Comparison]:
    """Printed numbers of stations, all and new ones, beside ours, (draws, options, 2), and those ``at`` airports."""
    comparisons = []
    for i, option in enumerate(OPTIONS):
        least, height, *printed = option
        for column, text in enumerate(("stations", "of them new")):
            ours, spread = found[:, i, column], 2.6 * float(np.std(found[:, i, column]))
            what = f"option {NAMES[i]}, {least} at {height:g} ft: {text}"
            why = f"one country of ours in a hundred is farther than {spread:.0f} from their mean"
            known = (all_of, new_of)[column](printed[column], float(np.mean(at[:, i, column])), least)
            edges = printed[column] - spread, printed[column] + spread
            mean = float(np.mean(ours))
            comparisons.append(Comparison(what, str(printed[column]), mean, *edges, why, difference=known))
    low, high = (float(x) for x in np.quantile(found[:, 3, 0] / STATIONS, [0.005, 0.995]))
    share = Comparison(
        "option IV of all stations that there are", "about 1/2", float(np.mean(found[:, 3, 0])) / STATIONS, 0.4, 0.6,
        f"a figure that is said to be about a half; our countries have {low:.2f} to {high:.2f}, 512 of 932 are 0.55",
    )  # fmt: skip
    return [*comparisons, share]


def all_of(printed: int, at: float, least: int) -> Difference:
    """Why all stations together may be more or fewer."""
    return Difference(
        0.67 * printed,
        1.5 * printed,
        "the thesis gives no places, and airports are not spread evenly; which stations are taken was not looked for "
        f"as here. With a station at each airport ours are {at:.0f}",
    )


def new_of(printed: int, at: float, least: int) -> Difference:
    """Why new stations may be more or fewer."""
    return Difference(
        min(printed, at),
        float(least * AIRPORTS),
        f"old stations stand near airports, not evenly: with one at each airport ours are {at:.0f}, and all together "
        "hardly fewer",
    )


def picture(found: np.ndarray, at: np.ndarray) -> bytes:
    """Stations in all and new ones, printed and ours."""
    with figure(1, 2, size=(11.0, 4.4)) as (drawing, axes):
        place = np.arange(len(OPTIONS))
        for axis, column, text in zip(axes, (0, 1), ("All stations", "New stations"), strict=True):
            printed = [option[2 + column] for option in OPTIONS]
            axis.bar(place - 0.27, printed, 0.25, color=COLOURS[1], label="thesis")
            for ours, off, text_of in ((found, 0.0, "spread evenly"), (at, 0.27, "a station at each airport")):
                colour = COLOURS[0] if ours is found else COLOURS[5]
                axis.bar(place + off, ours[:, :, column].mean(axis=0), 0.25, color=colour, label=f"ours, {text_of}")
                for i in place:
                    axis.plot(np.full(len(ours), i + off), ours[:, i, column], "_", color="black", ms=6, mew=0.4)
            axis.set_xticks(place, [f"{n}: {o[0]} at {o[1]:g} ft" for n, o in zip(NAMES, OPTIONS, strict=True)])
            axis.tick_params(axis="x", labelsize=8)
            axis.legend()
            title(drawing, axis, text)
        return png(drawing)
