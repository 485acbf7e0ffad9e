"""A station's day beside an independent solution of it: what that found, whether it is the same, and how both look.

The solution stands in ``gnss/`` of the folder that NAVFMU_DATA names: errors of all positions, and every 5 min or 2 h
those with a model left out, protection levels, and tests for a satellite with a bias.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from evidence.sensors.observed import FILES, errors, rms, velocities
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page

NEEDED = (*FILES, "esbc1770_spp.parquet", "esbc1770_ablation.csv", "esbc1770_fde.csv", "esbc1770_hpl.csv")
AXES = ("east", "north", "up")
ON = {"exclusions": 0, "withhold": False}
"""What is spoilt is shown, whatever integrity monitoring says: parameters of ``gps_solver``."""
DAY = 86400.0


@dataclass(frozen=True)
class Independent:
    """What the independent solution found."""

    folder: Path

    @cached_property
    def solution(self) -> pd.DataFrame:
        return pd.read_parquet(self.folder / "esbc1770_spp.parquet")

    @property
    def hours(self) -> np.ndarray:
        """GPS time of the day of each epoch."""
        return of_day(self.solution["tow_s"])

    def errors(self, name: str = "err") -> np.ndarray:
        """East, north, up: of positions (m), or ``verr`` of velocities (m/s), (epochs, 3)."""
        return self.solution[[f"own_{name}_{axis}" for axis in "enu"]].to_numpy()

    @cached_property
    def biased(self) -> pd.DataFrame:
        """One satellite with a bias: which was excluded, and the sum of squares."""
        return pd.read_csv(self.folder / "esbc1770_fde.csv")

    @cached_property
    def protected(self) -> pd.DataFrame:
        """Protection levels."""
        return pd.read_csv(self.folder / "esbc1770_hpl.csv")

    def beside(self, spoilt: Mapping[str, np.ndarray]) -> pd.DataFrame:
        """Rms errors of ours with something left out, by its name, and theirs."""
        known = pd.read_csv(self.folder / "esbc1770_ablation.csv").set_index("variant")
        ours = pd.DataFrame({name: rms(off) for name, off in spoilt.items()}, index=[f"ours_{axis}" for axis in "enu"])
        return ours.T.join(known[["rms_e", "rms_n", "rms_u"]])


def levels(found: Mapping[str, np.ndarray], rows: np.ndarray, known: pd.DataFrame) -> pd.DataFrame:
    """Protection levels and errors of ours at the epochs of theirs."""
    off = errors(found)[rows]
    return known.assign(
        ours=found["horizontal_protection"][rows],
        ours_vertical=found["vertical_protection"][rows],
        off=np.hypot(off[:, 0], off[:, 1]),
        off_vertical=np.abs(off[:, 2]),
    )


def excluded(used: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Which satellite was left out at each epoch, 0 for none; two are told by their sum."""
    return np.sum(np.where(used, number, 0.0), axis=1)


def accurate(found: Mapping[str, np.ndarray], known: Callable[[str], np.ndarray], how: str = "") -> list[Claim]:
    """Positions and velocities have the errors of the independent solution; ``how`` they were found begins it."""
    claims = []
    for what, ours, name, unit in (
        ("positions", errors(found), "err", "m"),
        ("velocities", velocities(found), "verr", "m/s"),
    ):
        of_ours, of_theirs = rms(ours), rms(known(name))
        told = "/".join(f"{value:.2g}" if unit == "m/s" else f"{value:.3f}" for value in of_ours)
        begin = f"{how}, {what}" if how else what.capitalize()
        claims.append(
            Claim(
                f"{begin} of {len(ours)} epochs are off by {told} {unit} east/north/up (rms): as an independent "
                "solution, within",
                100.0 * float(np.max(np.abs(of_ours / of_theirs - 1.0))), 10.0, False, "%",
                f"{begin} are off by {told} {unit}, otherwise than an independent solution",
            )
        )  # fmt: skip
    return claims


def missed(spoilt: pd.DataFrame, what: str) -> Claim:
    """What is left out is missed as much."""
    ours, theirs = spoilt.to_numpy()[:, :3], spoilt.to_numpy()[:, 3:]
    return Claim(
        f"{what} is missed as much as in the independent solution: errors within",
        100.0 * float(np.max(np.abs(ours / theirs - 1.0))), 20.0, False, "%",
        f"{what} is missed otherwise than in the independent solution",
    )  # fmt: skip


def discovered(cases: pd.DataFrame, what: str) -> Claim:
    """The satellite with a bias is excluded, and none where there is no bias."""
    right = (cases["ours_excluded"] == cases["excluded_prn"].fillna(0.0)) & ~cases["alarm"].astype(bool)
    biased = int(np.count_nonzero(cases["bias_m"]))
    return Claim(
        f"{what} of 30, 100 and 1000 m are found, and the satellite ({biased} cases), and {len(cases) - biased} "
        "epochs without one are silent",
        int(right.sum()), len(cases), True, "",
        f"Of {what[0].lower()}{what[1:]} of 30 m or more one is not found, or an epoch without one is not silent",
    )  # fmt: skip


def protected(levels: pd.DataFrame, pairs: Mapping[str, str]) -> Claim:
    """Our levels are theirs; ``pairs`` are the columns."""
    apart = np.concatenate([np.abs(levels[ours] / levels[theirs] - 1.0) for ours, theirs in pairs.items()])
    return Claim(
        f"Protection levels of {len(levels)} epochs are those of the independent solution: 99 of 100 within",
        100.0 * float(np.quantile(apart, 0.99)), 0.1, False, "%",
        "Protection levels differ from those of the independent solution",
    )  # fmt: skip


def table(page: Page, spoilt: pd.DataFrame) -> None:
    """What was left out, and how much it is missed."""
    page.table(
        ["left out", "rms east, north, up, m", "independent"],
        [
            [str(name), *(" ".join(f"{value:.2f}" for value in part) for part in (row[:3], row[3:]))]
            for name, row in zip(spoilt.index, spoilt.to_numpy(), strict=True)
        ],
    )


def picture(
    hours: np.ndarray,
    errors: np.ndarray,
    spoilt: pd.DataFrame,
    cases: pd.DataFrame,
    levels: pd.DataFrame,
    claims: Sequence[Claim],
    whose: str,
    what: str,
) -> bytes:
    """Errors of a day, what is left out, biased satellites, protection levels, under a claim each."""
    with figure(2, 2, size=(14.0, 8.6)) as (drawing, axes):
        panels = list(np.ravel(axes))
        _errors(panels[0], hours, errors)
        _left_out(panels[1], spoilt, whose)
        _cases(panels[2], cases, what)
        _levels(panels[3], levels)
        for panel, claim in zip(panels, claims, strict=True):
            title(drawing, panel, claim.sentence.partition(":")[0].partition(" (")[0])
            panel.legend(fontsize=8, ncols=2)
        return png(drawing, 80)


def _errors(panel: Any, hours: np.ndarray, errors: np.ndarray) -> None:
    for k, axis in enumerate(AXES):
        panel.plot(hours, errors[:, k], "-", color=COLOURS[k], lw=0.7, label=axis)
    panel.set(xlabel="GPS time of day, h", ylabel="error of position, m", xlim=(0, 24))


def _left_out(panel: Any, spoilt: pd.DataFrame, whose: str) -> None:
    values, place = spoilt.to_numpy(), np.arange(len(spoilt))
    for k, axis in enumerate(AXES):
        panel.plot(values[:, k], place + 0.2 * (k - 1), "o", ms=5, color=COLOURS[k], label=f"{axis}, {whose}")
        panel.plot(values[:, k + 3], place + 0.2 * (k - 1), "k+", ms=9, label="independent" if k == 0 else None)
    names = [str(name).partition(" (")[0].replace(" position at ", "\nat ") for name in spoilt.index]
    panel.set(xscale="log", yticks=place, yticklabels=names, xlabel="rms error, m")
    panel.invert_yaxis()


def _cases(panel: Any, cases: pd.DataFrame, what: str) -> None:
    for k, (bias, some) in enumerate(cases.groupby("bias_m")):
        number = np.arange(len(some))
        panel.plot(number, some["ours"], "o", ms=5, color=COLOURS[k], label=f"{what} {bias:g} m")
        panel.plot(number, some["wsse"], "k+", ms=9, label="independent" if k == 0 else None)
    panel.plot(number, some["ours_threshold"], "_", ms=16, color=GREY, label="threshold, 1e-5")
    panel.set(yscale="log", xlabel="epoch, every 2 h", ylabel="weighted sum of squares", ylim=(0.05, 3e6))


def _levels(panel: Any, levels: pd.DataFrame) -> None:
    hours = of_day(levels["tow_s"])
    for k, (name, theirs, what) in enumerate((("", "hpl", "horizontal"), ("_vertical", "vpl", "vertical"))):
        known = levels[f"{theirs}_we_wgt"]
        panel.plot(hours, known, "-", color=GREY, lw=3, alpha=0.5, label="independent" if k == 0 else None)
        panel.plot(hours, levels[f"ours{name}"], "-", color=COLOURS[k], lw=1, label=f"{what} protection level")
        panel.plot(hours, levels[f"off{name}"], ".", ms=3, color=COLOURS[k], label=f"{what} error")
    panel.set(yscale="log", xlabel="GPS time of day, h", ylabel="m", xlim=(0, 24), ylim=(5e-3, 2e2))


def of_day(seconds: Any) -> np.ndarray:
    """Hours of the day, of seconds of the week."""
    return np.mod(np.asarray(seconds, float), DAY) / 3600.0
