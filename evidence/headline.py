"""The thesis's headline (section 7.3, Figs 7.13-7.15) over 100 seeds: dead reckoning drifts, ranges bound the error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from navfmu.campaign import load_campaign, run_campaign
from navfmu.campaign.outcome import Outcome
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.report.page import Page
from navfmu.report.statistics.radial import beyond
from navfmu.system.system import System
from navfmu.terminal.progress import Progress

CAMPAIGN = Path(__file__).parents[1] / "system_ssp" / "backup_navigator" / "campaigns" / "headline.toml"
LOST = 300.0
"""Time at which GPS is lost, s."""
HALF_MILE = 926.0
AXES = ("north", "east")
SIGNALS = [f"evaluation.{a}_error" for a in AXES] + [f"navigator.{a}_sigma" for a in AXES]
NAMES = {
    "open_loop": "dead reckoning alone",
    "main": "one receiver, intermittent",
    "two_receivers": "two receivers",
    "scanning": "scanning receiver",
    "r_as_printed": "one receiver, (6.40) as printed",
}


def run(out: Path, page: Page) -> None:
    """Fly, tabulate and draw; the picture is also written to ``out``/headline.png."""
    campaign = load_campaign(CAMPAIGN)
    with Progress("headline, 100 seeds") as progress:
        outcome = run_campaign(campaign, out / "headline", None, progress)
    flights = {variant: Flights(outcome, variant) for variant in campaign.systems}
    image = picture(flights)
    (out / "headline.png").write_bytes(image)

    count = len(campaign.seeds)
    page.heading("Headline: thirty minutes without GPS")
    page.text(
        f"{count} flights per receiver, seeds {campaign.seeds[0]} to {campaign.seeds[-1]}; GPS is lost at minute 5. "
        "'At every minute' is the largest value over the 30 whole minutes that follow. The share inside 3 sigma is "
        "over all seconds of all flights; a share of runs has the uncertainty of a binomial with this many runs."
    )
    hdop = dilution()
    listed = ", ".join(f"{value:.2f} at {second / 60:.0f} min" for second, value in hdop.iloc[4::5].items())
    page.text(
        "Stations thesis_like (the coordinates of thesis Fig 7.12 are not in its text; these were chosen for the "
        f"approach): the dilution of precision along the flight is {hdop.min():.2f} to {hdop.max():.2f}; {listed}."
    )
    page.picture(image, "Horizontal error of every receiver against time since GPS was lost")
    page.table(HEADINGS, [[NAMES[name], *f.row()] for name, f in flights.items()])
    page.text(
        "Predicted by the covariance: the share of samples above 0.5 n.mi. that a zero-mean normal error with the "
        "filter's own covariance would have. For the filter as shipped it stands beside what was measured."
    )
    page.table(
        ["requirement", "receiver", "verdict", "finding"],
        [[c.requirement.id, NAMES[c.variant], "holds" if c.passed else "VIOLATED", c.sentence] for c in outcome.cells],
    )


def dilution() -> pd.Series:
    """HDOP of the navigator's stations along the flight at each whole minute without GPS, by time in s."""
    flight = System.load("backup_navigator", "scanning").run(
        seed=1, faults="gps_lost", record=["navigator.hdop"], record_period=60.0
    )
    return flight["navigator.hdop"][flight.index > LOST]


HEADINGS = (
    "navigator", "largest median at every minute, m", "largest 95th percentile, m", "runs above 926 m within 15 min, %",
    "runs ever above 926 m, %", "time above 926 m, %", "predicted by the covariance, %", "inside own 3 sigma, %",
)  # fmt: skip


class Flights:
    """The flights of one receiver after the loss of GPS: arrays of shape (runs, seconds)."""

    def __init__(self, outcome: Outcome, variant: str) -> None:
        columns: dict[str, list[np.ndarray]] = {name: [] for name in SIGNALS}
        for judged in outcome.of(variant, "gps_lost"):
            series = outcome.series(judged, SIGNALS)
            after = series["time"] > LOST
            self.time = series["time"][after] - LOST
            for name in SIGNALS:
                columns[name].append(series[name][after])
        values = {name: np.array(rows) for name, rows in columns.items()}
        self.error = {a: values[f"evaluation.{a}_error"] for a in AXES}
        self.sigma = {a: values[f"navigator.{a}_sigma"] for a in AXES}
        self.horizontal = np.hypot(*self.error.values())

    def percentile(self, q: float) -> np.ndarray:
        """Over the runs, at each second."""
        return np.percentile(self.horizontal, q, axis=0, method="higher")

    def inside_three_sigma(self) -> float:
        """Share of the samples at which both errors are within three standard deviations."""
        return float(np.mean(np.all([np.abs(self.error[a]) <= 3.0 * self.sigma[a] for a in AXES], axis=0)))

    def row(self) -> list[str]:
        """What HEADINGS names."""
        minutes = np.isin(np.round(self.time), np.arange(60, 1801, 60))
        above = self.horizontal > HALF_MILE
        shares = (
            np.mean(np.any(above[:, self.time <= 900.0], axis=1)),
            np.mean(np.any(above, axis=1)),
            np.mean(above),
            np.mean(beyond(HALF_MILE, self.sigma["north"], self.sigma["east"])),
            self.inside_three_sigma(),
        )
        largest = [np.max(self.percentile(q)[minutes]) for q in (50, 95)]
        return [*(f"{value:.0f}" for value in largest), *(f"{100 * share:.1f}" for share in shares)]


def picture(flights: dict[str, Flights]) -> bytes:
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
            axis.axhline(HALF_MILE, color=GREY, lw=1)
            axis.annotate("0.5 n.mi.", (30.0, HALF_MILE), ha="right", va="bottom", color=GREY)
            axis.set_xlim(0.0, 30.0)
            axis.set_ylim(0.0, None)
            axis.set_xlabel("time since GPS was lost, min")
            axis.set_ylabel("horizontal error, m")
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, fontsize=8)
        left.set_title("Dead reckoning drifts away, DME ranges bound it")
        right.set_title("With any receiver 95 % stay within 0.5 n.mi.")
        return png(drawing)
