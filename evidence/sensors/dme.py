"""The distance measuring equipment: its errors, whom it asks when, and how many aircraft a transponder serves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from evidence.section import Section, illustrated
from navfmu import Fault, System
from navfmu.constants import NAUTICAL_MILE
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png
from navfmu.system import shipped

HEADING = "Distance measuring equipment"
SPEED = 46.3
"""90 kn in m/s."""
SIGMA, DISTANCE = 0.17 * NAUTICAL_MILE, 0.5 * NAUTICAL_MILE
"""Thesis (3.38), m."""
SHARE = (315.0 / 370.0) ** 2
"""Of the receiver, ICAO Annex 10, volume I, 3.5.3.1.3.3."""
SEEDS, LONG = 100, 1200
LAGS = np.arange(0, 61, 4)
PROBABILITY = 1e-6
"""That errors as told are beyond the bound at one lag."""
AIRCRAFT = np.arange(0, 301, 20)
SECONDS, PLAYED = 4000, 60.0
DEAD_TIME, CAPACITY = 60e-6, 3000.0
TIMELINE = {
    "one receiver": {"mode": 1},
    "two receivers": {"mode": 2},
    "scan of five, 2 s each": {"mode": 1, "interval": 2.0, "lock_in": 1.0},
    "scanning, one station off from 20 to 28 s": {"mode": 3, "memory_time": 5.0},
}
SHOWN = 60
PHASES = ("asleep", "searches", "tracks", "remembers")
PLACE = {"latitude": 0.659, "longitude": -2.117, "altitude": 1500.0}


def run(out: Path) -> Section:
    """Measure, and draw the picture."""
    found = Found.measured()
    write_file(out / "sensors" / "dme.png", picture(found))
    return section(found)


@dataclass(frozen=True)
class Found:
    """What was measured."""

    errors: np.ndarray
    """Of five stations every second in flight at SPEED, m, (SEEDS, LONG, 5), without the wide-band noise."""
    phases: Mapping[str, np.ndarray]
    """By schedule, (SHOWN, 5), from 1, what was done at each station in each second."""
    pulses: np.ndarray
    """Interrogations of each of two stations in turn in each minute of tracking both, (2,)."""
    answered: np.ndarray
    """Share of replies with AIRCRAFT."""
    ranged: np.ndarray
    """Share of seconds with a range with AIRCRAFT, of one receiver that tracks all the time."""
    played: np.ndarray
    """Share of replies with AIRCRAFT of a transponder that is played pulse by pulse."""

    @classmethod
    def measured(cls) -> Found:
        system = System.load(shipped.path("dme.fmu"))
        table = _stations()
        flight = {**table, "mode": 3, "noise_sigma": 0.0, "receiver_share": SHARE, "velocity_n": [SPEED, 0.0, 0.0]}
        readings = [
            _run(system, LONG + 10, ["ranging.slant_range"], seed=seed, **flight)[10:] for seed in range(1, SEEDS + 1)
        ]
        exact = _run(system, 10, ["ranging.slant_range"], **flight | {"bias_sigma": 0.0})[-1]
        phases = {}
        for name, given in TIMELINE.items():
            off = [("dme.station_off[1]", 20.0, 8.0)] if given["mode"] == 3 else []
            phases[name] = _run(system, SHOWN, ["phase"], faults=off, **table, **given)
        minute = _run(system, 60, ["interrogation_rate"], **table | {"station_count": 2}, mode=1)
        one = {**table, "station_count": 1, "mode": 3}
        answered, ranged = [], []
        for aircraft in AIRCRAFT:
            rows = _run(system, SECONDS, ["answered_share", "ranging.measured"], traffic=[aircraft] * 5, **one)[10:]
            answered.append(rows[-1, 0])
            ranged.append(rows[:, 5].mean())
        rates = 30.5 * AIRCRAFT + 25.0
        played = np.array([play(rate, PLAYED) for rate in rates])
        return cls(
            np.array(readings) - exact, phases, minute.sum(axis=0)[:2], np.array(answered), np.array(ranged), played
        )

    @property
    def covariance(self) -> np.ndarray:
        """Of the errors over SIGMA^2 at LAGS by run, of one station with itself and with the next: (2, SEEDS, lags)."""
        found = []
        for other in (self.errors, np.roll(self.errors, 1, axis=2)):
            count = self.errors.shape[1]
            found.append([np.mean(self.errors[:, : count - k] * other[:, k:], axis=(1, 2)) / SIGMA**2 for k in LAGS])
        return np.moveaxis(np.array(found), 1, 2)


def play(rate: float, duration: float, seed: int = 1) -> float:
    """Share of Poisson interrogations (of ``rate`` a second) that a transponder answers, pulse by pulse: after one
    that it hears it is deaf for DEAD_TIME, and it gives CAPACITY replies a second, a tenth of them in a tenth of it."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.exponential(1.0 / rate, int(rate * duration)))
    deaf, window, given, replies = -1.0, -1, 0, 0
    for time in times.tolist():
        if time < deaf:
            continue
        deaf = time + DEAD_TIME
        if int(10.0 * time) != window:
            window, given = int(10.0 * time), 0
        if given < 0.1 * CAPACITY:
            given += 1
            replies += 1
    return replies / len(times)


def _stations() -> dict[str, Any]:
    """Five stations 30 km around PLACE."""
    bearing = np.radians(np.arange(5) * 72.0)
    return {
        "station_count": 5,
        "station_latitude": PLACE["latitude"] + 30e3 * np.cos(bearing) / 6.37e6,
        "station_longitude": PLACE["longitude"] + 30e3 * np.sin(bearing) / 6.37e6 / np.cos(PLACE["latitude"]),
        "station_altitude": np.full(5, 100.0),
    }


def _run(system: System, stop: float, record: list[str], seed: int = 1, faults: Any = (), **given: Any) -> np.ndarray:
    """What is recorded at 1 s, 2 s ... stop, (stop, columns)."""
    frame = system.run(
        stop=float(stop), step=1.0, seed=seed, record=[f"dme.{name}" for name in record], record_period=1.0,
        parameters={f"dme.{name}": value for name, value in (PLACE | given).items()},
        faults=[Fault("off", target, "input", start, long, {"value": True}) for target, start, long in faults],
    )  # fmt: skip
    return frame.to_numpy(float)[1:]


def make_claims(found: Found) -> list[Claim]:
    """Each panel's, in their order."""
    runs = found.covariance
    expected = np.exp(-LAGS * SPEED / DISTANCE) * np.array([[1.0], [SHARE]])
    error = runs.std(axis=1, ddof=1) / np.sqrt(runs.shape[1])
    beyond = np.max(np.abs(runs.mean(axis=1) - expected) / error)
    bound = float(stats.norm.isf(0.5 * PROBABILITY))
    missed = np.max(np.abs(found.answered - found.played))
    hundred = found.ranged[AIRCRAFT == 100][0]
    return [
        Claim(
            f"Errors of 0.17 nmi over 0.5 nmi, {SHARE:.0%} common", beyond, bound, False, "standard errors",
            "Errors are not those of (3.38) with a common part",
        ),
        Claim(
            "Turns ask a station no more than tracking does", float(np.max(found.pulses)), 1500.0, False,
            "pulse pairs a minute", "Turns ask a station more than tracking does",
        ),
        Claim(
            "Replies are as played pulse by pulse", missed, 0.02, False, "",
            "Replies are not as played pulse by pulse",
        ),
        Claim(
            "A hundred aircraft are served", hundred, 0.999, True, "of the seconds",
            "A hundred aircraft are not served",
        ),
    ]  # fmt: skip


def section(found: Found) -> Section:
    """Claims, and the picture."""
    words = "Covariance of the errors, phases of five stations by schedule, capacity"
    return illustrated(HEADING, make_claims(found), lambda: picture(found), words)


def picture(found: Found) -> bytes:
    """Covariance of the errors; what is done at each station in a minute; replies by the number of aircraft."""
    claims = make_claims(found)
    with figure(1, 3, size=(13.0, 4.4)) as (drawing, (errors, schedule, capacity)):
        runs = found.covariance
        bar = stats.norm.isf(0.5 * PROBABILITY) * runs.std(axis=1, ddof=1) / np.sqrt(runs.shape[1])
        fine = np.linspace(0.0, LAGS[-1], 241)
        for which, (name, level) in enumerate((("one station", 1.0), ("two stations", SHARE))):
            label = f"{name}, {runs.shape[1] * found.errors.shape[1] / 3600.0:.0f} h, bars: 1 - {PROBABILITY:.0e}"
            mean, colour = runs[which].mean(axis=0), COLOURS[which]
            errors.errorbar(LAGS, mean, bar[which], fmt="o", ms=3, lw=1, color=colour, label=label)
            errors.plot(fine, level * np.exp(-fine * SPEED / DISTANCE), color=colour, lw=1)
        errors.set_xlabel("lag, s, at 90 kn; lines: exp(-V t / 0.5 nmi)")
        errors.set_ylabel("covariance over (0.17 nmi)^2")

        colours, place, ticks = (None, COLOURS[4], COLOURS[0], COLOURS[3]), 0, []
        for name, phases in found.phases.items():
            schedule.text(0.0, -place, name, fontsize=8, va="center")
            for station in range(5):
                place += 1
                for number, colour in enumerate(colours, 1):
                    bars = [(second, 1.0) for second in np.flatnonzero(phases[:, station] == number) if colour]
                    schedule.broken_barh(bars, (-place - 0.4, 0.8), color=colour)
                ticks.append((-place, str(station + 1)))
            place += 1.4
        for colour, name in zip(colours[1:], PHASES[1:], strict=True):
            schedule.plot([], [], color=colour, lw=5, label=name)
        schedule.set_yticks([at for at, _ in ticks], [name for _, name in ticks], fontsize=7)
        schedule.set_ylim(-place + 0.4, 2.6)
        schedule.set_xlabel("time, s")
        schedule.set_ylabel("station")
        schedule.grid(axis="y", visible=False)

        capacity.plot(AIRCRAFT, found.answered, color=COLOURS[0], label="replies")
        capacity.plot(AIRCRAFT, found.played, "o", ms=4, color=COLOURS[1], label="played by the pulse")
        capacity.plot(AIRCRAFT, found.ranged, color=COLOURS[2], label="seconds with a range")
        capacity.axvline(100.0, color=GREY, lw=1, ls=":")
        capacity.axhline(0.5, color=GREY, lw=1, ls="--", label="least_replies")
        capacity.set_xlabel("other aircraft at the transponder, 5 % of which search")
        capacity.set_ylabel("share")
        capacity.set_ylim(0.0, 1.35)
        titles = claims[0].sentence, claims[1].sentence, f"{claims[2].sentence};\n{claims[3].sentence.lower()}"
        for ax, title in zip((errors, schedule, capacity), titles, strict=True):
            ax.set_title(title, fontsize=9)
            ax.legend(fontsize=7, loc="upper right", ncols=3 if ax is schedule else 1)
        drawing.subplots_adjust(wspace=0.24)
        return png(drawing)
