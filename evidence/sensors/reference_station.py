"""A receiver 30 km from a reference station: what corrections leave, by their age and the mask of the station."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.earth import earth
from navfmu import System
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY
from navfmu.ssp.writer import SystemSource
from navfmu.system import shipped

STATION = {"latitude": float(np.radians(37.7)), "longitude": float(np.radians(-121.8)), "altitude": 100.0}
ROVER = {**STATION, "latitude": STATION["latitude"] + 30e3 / 6.36e6}
TIMES = 60
"""Of a day."""
FRESH, OLD = 60, 60
"""s: fixes with corrections 1 s old, and ages from 0 on of one message."""
MASKS = (5.0, 10.0, 15.0, 20.0)
"""Of the station, degrees; the receiver's is 5, the solver's 10."""
AXES = ("north", "east", "down")
BOX = 3.0
"""m in each axis: AGARD CP-298 (1981), Peterson."""
SMOOTHED = 0.005
"""Hz of a code loop that stands for smoothing by the carrier over 100 s."""


@dataclass(frozen=True)
class Station:
    """Errors north, east, down, m."""

    fresh: np.ndarray
    """With corrections, and of the receiver alone: (TIMES, FRESH, 2, 3)."""
    aged: np.ndarray
    """By the age in s, corrections carried on by their rates, and held: (TIMES, OLD, 2, 3)."""
    masked: np.ndarray
    """By MASKS of the station: (TIMES, FRESH, MASKS, 3)."""

    @classmethod
    def measured(cls) -> Station:
        with tempfile.TemporaryDirectory() as folder:
            system = System.load(_system(Path(folder)))
            old = {"differential.message_period": float(OLD), "differential.latency": 0.0}
            fresh, aged, masked = [], [], []
            for k in range(TIMES):
                fresh.append(_flown(system, k, FRESH)[-FRESH:])
                by = [_flown(system, k, 2 * OLD, {**old, "differential.carried": carried}) for carried in (True, False)]
                aged.append(np.stack([run[-OLD:, 0] for run in by], axis=1))
                by = [_flown(system, k, FRESH, {"station.elevation_mask": np.radians(mask)}) for mask in MASKS]
                masked.append(np.stack([run[-FRESH:, 0] for run in by], axis=1))
        return cls(np.array(fresh), np.array(aged), np.array(masked))

    @property
    def claims(self) -> list[Claim]:
        settled = np.abs(self.fresh[:, 5:])
        with_it, alone = rms(self.fresh[:, 5:])
        return [
            Claim(
                "With a reference station 30 km away all fixes are within 3 m in each axis",
                float(np.max(settled[..., 0, :])), BOX, False, "m",
                "With a reference station fixes are off by more than 3 m",
            ),
            Claim(
                "Without the station the height is worse", float(alone[2] / with_it[2]), 3.0, True, "times",
                "Without a reference station the height is as good",
            ),
            Claim(
                "Corrections a minute old leave less than 3 m (rms)",
                float(np.max(rms(self.aged[:, -10:, 1]))), BOX, False, "m",
                "Corrections a minute old leave more than 3 m (rms)",
            ),
        ]  # fmt: skip

    @property
    def told(self) -> list[str]:
        """Figures without a bound, as sentences."""

        def by_axis(values: np.ndarray) -> str:
            return ", ".join(f"{value:.2f}" for value in values) + " m"

        with_it, alone = rms(self.fresh[:, 5:])
        told = [f"Rms north, east, down: with a reference station {by_axis(with_it)}, alone {by_axis(alone)}"]
        for index, name in enumerate(("carried on", "held")):
            ages = (by_axis(rms(self.aged[:, at : at + 10, index])) for at in (0, 20, OLD - 10))
            told.append(f"Corrections {name}, ages to 10, from 20 to 30, from 50 to 60 s: {'; '.join(ages)}")
        masks = (f"{mask:g} degrees {by_axis(rms(self.masked[:, 5:, i]))}" for i, mask in enumerate(MASKS))
        return [*told, "By the station's mask: " + "; ".join(masks)]

    def draw(self, panel) -> None:
        """Errors by the age of corrections."""
        age = np.arange(OLD)
        held, carried = (np.sqrt(np.mean(self.aged[:, :, index] ** 2, axis=0)) for index in (1, 0))
        alone = rms(self.fresh[:, 5:])[1]
        for axis, name in enumerate(AXES):
            colour = COLOURS[axis]
            panel.plot(age, held[:, axis], color=colour, label=f"{name}, held")
            panel.plot(age, carried[:, axis], color=colour, lw=1, ls="--", label="carried on by rates" * (axis == 2))
            panel.axhline(alone[axis], color=colour, lw=1, ls=":", label="without a station" * (axis == 2))
        panel.axhline(BOX, color=GREY, lw=1)
        panel.set(xlabel="age of corrections, s; 30 km from the station", ylabel="error, m, rms")
        panel.set_ylim(0.0)


def rms(errors: np.ndarray) -> np.ndarray:
    """Over times of the day and seconds, the first two axes."""
    return np.sqrt(np.mean(errors**2, axis=(0, 1)))


def _system(folder: Path) -> Path:
    source = SystemSource("reference_station", fmus=shipped.path("gps_differential.fmu").parent)
    source.component("errors", "gps_errors.fmu")
    for receiver in ("station", "rover"):
        source.component(receiver, "gps_signals.fmu")
        for name in ("range_error", "ionosphere_error", "zenith_error"):
            source.connect(f"errors.{name}", f"{receiver}.{name}")
    source.component("differential", "gps_differential.fmu")
    source.connect("station.signals", "differential.reference").connect("rover.signals", "differential.signals")
    for name, signals in (("solver", "differential.differential"), ("alone", "rover.signals")):
        source.component(name, "gps_solver.fmu").connect(signals, f"{name}.signals")
    return source.pack(folder / "reference_station.ssp")


def _flown(system: System, k: int, stop: int, given: dict | None = None) -> np.ndarray:
    """Errors each second from 1 s on, (stop, 2, 3): with corrections, alone."""
    told = {f"differential.reference_{name}": value for name, value in STATION.items()}
    shared = dict.fromkeys(("own_sigma", "ionosphere_sigma", "troposphere_sigma"), 0.0)
    for number, (name, place) in enumerate((("errors", {}), ("station", STATION), ("rover", ROVER))):
        of_receiver = {**shared, "loop_bandwidth": SMOOTHED, "start_seconds": 345609.0 + 86400.0 * k / TIMES}
        values = {**place, **(of_receiver if place else {}), "seed": 3 * k + number}
        told |= {f"{name}.{key}": value for key, value in values.items()}
    names = [f"{name}.fix.{what}" for name in ("solver", "alone") for what in STATION]
    frame = system.run(
        stop=float(stop), step=1.0, record=names, record_period=1.0, parameters={**told, **(given or {})}
    )
    at = frame.to_numpy(float)[1:]
    c_ne = earth.north_east_down(ROVER["latitude"], ROVER["longitude"])
    here = earth.to_ecef(*ROVER.values())
    return np.stack([(earth.to_ecef(*at[:, i : i + 3].T).T - here) @ c_ne.T for i in (0, 3)], axis=1)
