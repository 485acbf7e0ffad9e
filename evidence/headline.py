"""The thesis's headline (section 7.3, Figs 7.13-7.15) over 100 seeds: dead reckoning drifts, ranges bound the error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from evidence.section import Section
from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.outcome import Cell, Outcome
from navfmu.errors import NavfmuError
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.statistics.radial import beyond
from navfmu.system.system import System
from navfmu.terminal.progress import Progress

CAMPAIGN = Path(__file__).parents[1] / "system_ssp" / "backup_navigator" / "campaigns" / "headline.toml"
LOST = 300.0
"""Time at which GPS is lost, s."""
AXES = ("north", "east")
SIGNALS = [f"evaluation.{a}_error" for a in AXES] + [f"navigator.{a}_sigma" for a in AXES]
NAMES = {
    "open_loop": "dead reckoning alone",
    "main": "one receiver, intermittent",
    "two_receivers": "two receivers",
    "scanning": "scanning receiver",
    "r_as_printed": "one receiver, (6.40) as printed",
}
RECEIVERS = ("main", "two_receivers", "scanning")
HALF, MOST = 500.0, 926.0
"""Bounds of the median and of the 95th percentile of the flights, m."""
SHARE, SAMPLES, PRINTED = 95.0, 98.9, 10.0
"""Bounds of the share inside 3 sigma, %: of the flights at every time, of all samples, of those of (6.40) as printed.

An honest filter has 99.46 % of its flights inside at any time: of 100 more than 5 are outside at a given time with a
probability of 2e-5, and at some time of the half hour with 0.4 to 1.1 %, as a flight is outside for 7 to 20 s at a
stretch (300 other flights of each receiver, 100 drawn again and again, shifted in time against one another).
The shares of single flights scatter by 1.4 %, so that of 100 flights together is above 98.9 with a probability of
1 - 3e-5; 99.5 would be beyond an honest filter more often than not. Of one flight's time no such bound holds, for
errors live for minutes: where the wind is three sigma the best filter is outside for 5 % of a flight.
"""
DRIFT = "Half of the flights on dead reckoning alone end beyond 0.5 nmi"
BOUNDED = "At every time 95 % of the flights are within 0.5 nmi"


def run(out: Path) -> Section:
    """Fly, tabulate and draw; the picture is also written to ``out``/headline.png."""
    campaign = load_campaign(CAMPAIGN)
    with Progress("headline, 100 seeds") as progress:
        outcome = run_campaign(campaign, out / "headline", None, progress)
    flights = {variant: Flights.of(outcome, variant) for variant in campaign.systems}
    found = section(flights, dilution(), campaign.seeds, outcome.cells)
    write_file(out / "headline.png", picture(flights, found.claims))
    return found


def section(flights: dict[str, Flights], hdop: pd.Series, seeds: Sequence[int], cells: Sequence[Cell] = ()) -> Section:
    """What the flights of every receiver show."""
    claims = make_claims(flights)

    def write(page: Page) -> None:
        page.heading("Headline: thirty minutes without GPS")
        page.text(
            f"{len(seeds)} flights per receiver, seeds {seeds[0]} to {seeds[-1]}; GPS is lost at minute 5. "
            "'At every minute' is the largest value over the 30 whole minutes that follow. The share inside 3 sigma is "
            "over all seconds of all flights; a share of runs has the uncertainty of a binomial with this many runs."
        )
        page.items(claim.sentence for claim in claims)
        listed = ", ".join(f"{value:.2f} at {second / 60:.0f} min" for second, value in hdop.iloc[4::5].items())
        page.text(
            "Stations thesis_like (the coordinates of thesis Fig 7.12 are not in its text; these were chosen for the "
            f"approach): the dilution of precision along the flight is {hdop.min():.2f} to {hdop.max():.2f}; {listed}."
        )
        page.picture(picture(flights, claims), "Horizontal error of every receiver against time since GPS was lost")
        page.table(HEADINGS, [[NAMES[name], *f.row()] for name, f in flights.items()])
        page.text(
            "Predicted by the covariance: the share of samples above 0.5 nmi that a zero-mean normal error with the "
            "filter's own covariance would have. For the filter as shipped it stands beside what was measured."
        )
        page.table(
            ["requirement", "receiver", "verdict", "finding"],
            [[c.requirement.id, NAMES[c.variant], "holds" if c.passed else "VIOLATED", c.sentence] for c in cells],
        )

    return Section(claims, write)


def make_claims(flights: dict[str, Flights]) -> list[Claim]:
    """Dead reckoning drifts, every receiver bounds it and says how well, the filter as printed does not."""
    alone, printed = flights["open_loop"], flights["r_as_printed"]
    claims = [
        Claim(
            DRIFT, alone.percentile(50)[-1], MOST, unit="m",
            opposite="Half of the flights on dead reckoning alone end within 0.5 nmi",
        )
    ]  # fmt: skip
    for name in RECEIVERS:
        f, who = flights[name], NAMES[name]
        claims += [
            Claim(
                f"At every time half of the flights are within {HALF:g} m, {who}",
                np.max(f.percentile(50)), HALF, False, "m",
                f"Not at every time half of the flights are within {HALF:g} m, {who}",
            ),
            Claim(
                f"{BOUNDED}, {who}", np.max(f.percentile(95)), MOST, False, "m",
                f"Not at every time 95 % of the flights are within 0.5 nmi, {who}",
            ),
            Claim(
                f"At every time at least {SHARE:g} % of the flights are inside their filter's own 3 sigma, {who}",
                round(100 * np.min(np.mean(f.inside, axis=0)), 9), SHARE, True, "%",
                f"Not at every time {SHARE:g} % of the flights are inside their filter's own 3 sigma, {who}",
            ),
            Claim(
                f"Of all samples at least {SAMPLES:g} % are inside the filter's own 3 sigma, {who}",
                100 * np.mean(f.inside), SAMPLES, True, "%",
                f"Of all samples fewer than {SAMPLES:g} % are inside the filter's own 3 sigma, {who}",
            ),
        ]  # fmt: skip
    claims.append(
        Claim(
            f"With (6.40) as printed at most {PRINTED:g} % of the samples are inside 3 sigma: it claims too much",
            100 * np.mean(printed.inside), PRINTED, False, "%",
            f"With (6.40) as printed more than {PRINTED:g} % of the samples are inside 3 sigma",
        )
    )  # fmt: skip
    failed = sum(f.failed for f in flights.values())
    claims.append(
        Claim("Every flight ends", failed, 0, False, opposite=f"{failed} flights ended with an error and are left out")
    )
    return claims


def titles(claims: Sequence[Claim]) -> tuple[str, str]:
    """Of the two panels of the picture."""
    drifts = next(claim.holds for claim in claims if claim.text == DRIFT)
    bounded = {name: c.holds for name in RECEIVERS for c in claims if c.text == f"{BOUNDED}, {NAMES[name]}"}
    left = f"Dead reckoning {'drifts away' if drifts else 'stays near'}, DME ranges "
    left += "bound it" if bounded["main"] else "do not bound it"
    if all(bounded.values()):
        return left, "With any receiver 95 % stay within 0.5 nmi"
    return left, f"95 % do {'not' if not any(bounded.values()) else 'not always'} stay within 0.5 nmi"


def dilution() -> pd.Series:
    """HDOP of the navigator's stations along the flight at each whole minute without GPS, by time in s."""
    flight = System.load("backup_navigator", "scanning").run(
        seed=1, faults="gps_lost", record=["navigator.hdop"], record_period=60.0
    )
    return flight["navigator.hdop"][flight.index > LOST]


HEADINGS = (
    "navigator", "largest median at every minute, m", "largest 95th percentile, m", "runs above 926 m within 15 min, %",
    "runs ever above 926 m, %", "time above 926 m, %", "predicted by the covariance, %", "inside own 3 sigma, %",
    "of the worst flight, %",
)  # fmt: skip


@dataclass(frozen=True)
class Flights:
    """The flights of one receiver after the loss of GPS: arrays of shape (runs, seconds)."""

    time: np.ndarray  # s since the loss
    error: dict[str, np.ndarray]  # m, by axis
    sigma: dict[str, np.ndarray]  # m, by axis
    failed: int = 0  # flights that ended with an error

    @classmethod
    def of(cls, outcome: Outcome, variant: str) -> Flights:
        """The flights of a campaign."""
        judged = outcome.of(variant, "gps_lost")
        flown = [each for each in judged if each.error is None]
        if not flown:
            raise NavfmuError(f"headline: every flight of '{variant}' ended with an error: {judged[0].error}")
        series = [outcome.series(each, SIGNALS) for each in flown]
        after = series[0]["time"] > LOST
        values = {name: np.array([each[name][after] for each in series]) for name in SIGNALS}
        error = {axis: values[f"evaluation.{axis}_error"] for axis in AXES}
        sigma = {axis: values[f"navigator.{axis}_sigma"] for axis in AXES}
        return cls(series[0]["time"][after] - LOST, error, sigma, len(judged) - len(flown))

    @property
    def horizontal(self) -> np.ndarray:
        """Horizontal error, m."""
        return np.hypot(*self.error.values())

    @property
    def inside(self) -> np.ndarray:
        """Where both errors are within three standard deviations."""
        return np.all([np.abs(self.error[a]) <= 3.0 * self.sigma[a] for a in AXES], axis=0)

    def percentile(self, q: float) -> np.ndarray:
        """Over the runs, at each second."""
        return np.percentile(self.horizontal, q, axis=0, method="higher")

    def row(self) -> list[str]:
        """What HEADINGS names."""
        minutes = np.isin(np.round(self.time), np.arange(60, 1801, 60))
        above = ~(self.horizontal <= MOST)  # NaN is not within
        shares = (
            np.mean(np.any(above[:, self.time <= 900.0], axis=1)),
            np.mean(np.any(above, axis=1)),
            np.mean(above),
            np.mean(beyond(MOST, self.sigma["north"], self.sigma["east"])),
            np.mean(self.inside),
            np.min(np.mean(self.inside, axis=1)),
        )
        largest = [np.max(self.percentile(q)[minutes]) for q in (50, 95)]
        return [*(f"{value:.0f}" for value in largest), *(f"{100 * share:.1f}" for share in shares)]


def picture(flights: dict[str, Flights], claims: Sequence[Claim]) -> bytes:
    """Median and 95th percentile against time, one panel without and one with ranges."""
    colour = dict(zip(NAMES, COLOURS, strict=False))
    with figure(1, 2, size=(11.0, 4.6), below=0.6) as (drawing, (left, right)):
        panels = [(left, ["open_loop", "main"]), (right, ["main", "two_receivers", "scanning"])]
        for axis, names in panels:
            for name in names:
                f = flights[name]
                minutes = f.time / 60.0
                axis.plot(minutes, f.percentile(50), color=colour[name], label=f"{NAMES[name]}: median")
                axis.plot(minutes, f.percentile(95), color=colour[name], ls="--", lw=1, label="95th percentile")
            axis.axhline(MOST, color=GREY, lw=1)
            axis.annotate("0.5 nmi", (30.0, MOST), ha="right", va="bottom", color=GREY)
            axis.set_xlim(0.0, 30.0)
            axis.set_ylim(0.0, None)
            axis.set_xlabel("time since GPS was lost, min")
            axis.set_ylabel("horizontal error, m")
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, fontsize=8)
        for axis, title in zip((left, right), titles(claims), strict=True):
            axis.set_title(title)
        return png(drawing)
