"""Increments of angle and velocity: what coning, sculling, pulses and vibration leave, beside the closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from evidence.section import Section
from models.inertial import coning, sculling
from navfmu import System
from navfmu.files.writing import write_file
from navfmu.report.claim import Claim
from navfmu.report.figure import COLOURS, GREY, figure, png, title
from navfmu.report.page import Page
from navfmu.system import shipped

STEP, EACH = 1e-3, 5
"""Sampling period, s, and samples of an increment."""
AROUND = np.array([8, 10, 12, 16, 20, 24, 32])
"""Samples in which the motion goes round."""
SAMPLES = (1, 2, 3, 4)
SWING, SHAKE = 1e-5, 2.0
"""Half-angle of the cone, rad, and specific force of sculling, m/s2."""
QUIET = {
    f"{sensor}_{error}_sigma": [0.0] * 3
    for sensor in ("gyro", "accelerometer")
    for error in ("null_shift", "scale_factor", "drift", "noise")
} | {"misalignment_sigma": [0.0] * 3}
PULSE, RATE, NOISE = float(np.radians(2.0 / 3600.0)), [0.0031, 0.0, 0.0], [3e-3, 0.0, 0.0]
"""Angle of a pulse, rad; the rate at which they are counted, rad/s, and its noise, one pulse in an increment of 10.

About one axis, so that there is no coning of pulses.
"""
LEVELS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
"""Amplitudes of vibration, m/s2."""
RECTIFICATION = 2e-4
"""s2/m."""


def run(out: Path) -> Section:
    """Shake, compare and draw."""
    found = Increments()
    made = section(found)
    write_file(out / "sensors" / "increments.png", picture(found, made.claims))
    return made


def section(found: Increments) -> Section:
    """What was found."""
    claims = [found.coned, found.sculled, found.counted, found.rectified]

    def write(page: Page) -> None:
        page.heading("Increments of angle and velocity", 3)
        page.items(claim.sentence for claim in claims)
        page.picture(picture(found, claims), "Coning, sculling, pulses and rectification beside their closed forms")

    return Section(claims, write)


def shake(stop: float, record_period: float, what: Sequence[str], **parameters: Any) -> list[np.ndarray]:
    """Values of an imu without errors of its own from t = 0 on, (rows, 3) each, m/s2, rad and so on."""
    recorded = System.load(shipped.path("imu.fmu")).run(
        stop=stop,
        step=STEP,
        parameters={f"imu.{name}": value for name, value in (QUIET | {"sample_period": STEP} | parameters).items()},
        record=[f"imu.{name}" for name in what],
        record_period=record_period,
    )
    return [recorded[[f"imu.{name}[{i}]" for i in (1, 2, 3)]].to_numpy(copy=True) for name in what]


def response(samples: int, a: np.ndarray) -> np.ndarray:
    """Error of coning over the coning rate when it turns by ``a`` from sample to sample: (5) less what is found."""
    passed = 0.5 * a / np.tan(0.5 * a)
    square = (passed * np.sinc(a / (2 * np.pi))) ** 2
    numbers = coning.before(samples - 1, "trapezoid")
    applied = sum((-2 * float(c) * a * square * np.sin(p * a) for p, c in enumerate(numbers, 1)), np.zeros_like(a))
    return applied - (passed**2 * np.sinc(a / np.pi) - 1.0)


@dataclass(frozen=True)
class Increments:
    """What is measured, each part when it is first asked for."""

    @cached_property
    def errors(self) -> tuple[np.ndarray, np.ndarray]:
        """Of coning and of sculling, over what is right: (samples, turns) each."""
        found = np.array([[self._error(samples, int(around)) for around in AROUND] for samples in SAMPLES])
        return found[..., 0], found[..., 1]

    def _error(self, samples: int, around: int) -> tuple[float, float]:
        angles, velocities = shake(
            2 * EACH * around * STEP,
            EACH * STEP,
            ("increment.angle", "increment.velocity"),
            vibrating=True,
            vibration_frequency=1.0 / (around * STEP),
            vibration_swing_sine=[SWING, 0.0, 0.0],
            vibration_swing_cosine=[0.0, SWING, 0.0],
            vibration_shake_sine=[0.0, SHAKE, 0.0],
            vibration_shake_cosine=[0.0] * 3,
            accelerometer_rectification=[0.0] * 3,
            specific_force=[0.0] * 3,
            increment_samples=EACH,
            coning_samples=samples,
        )
        attitude, gained = Rotation.identity(), np.zeros(3)
        for angle, velocity in zip(angles[-around:], velocities[-around:], strict=True):
            gained = gained + attitude.apply(sculling.at_the_beginning(angle, velocity))
            attitude = attitude * Rotation.from_rotvec(angle)
        duration = EACH * around * STEP
        coned = 0.5 * SWING**2 * 2 * np.pi / (around * STEP) * duration
        return attitude.as_rotvec()[2] / coned, gained[2] / (0.5 * SWING * SHAKE * duration)

    @property
    def coned(self) -> Claim:
        off = np.abs(self.errors[0] - [response(m, 2 * np.pi / AROUND) for m in SAMPLES])
        return Claim(
            "Coning is taken away to order 2m by m samples: off the closed form, of the coning rate",
            float(np.max(off)), 1e-8, False, opposite="What is left of coning is not the closed form",
        )  # fmt: skip

    @property
    def sculled(self) -> Claim:
        off = np.abs(self.errors[1] + [response(m, 2 * np.pi / AROUND) for m in SAMPLES])
        return Claim(
            "Sculling has the same orders: off the closed form, of the sculling acceleration",
            float(np.max(off)), 1e-8, False, opposite="What is left of sculling is not the closed form",
        )  # fmt: skip

    @cached_property
    def pulses(self) -> tuple[np.ndarray, np.ndarray]:
        """Errors of the summed angle over 100 s, in pulses, of counting and of rounding each increment: (rows, 3)."""
        parameters = {"rate": RATE, "gyro_noise_sigma": NOISE, "increment_samples": 10, "coning_samples": 1}
        stop, period = 100.0, 10 * STEP
        exact, counted = (
            shake(stop, period, ("increment.angle",), angle_quantum=quantum, **parameters)[0]
            for quantum in (0.0, PULSE)
        )
        rounded = PULSE * np.rint(exact / PULSE)
        return tuple(np.cumsum(angles - exact, axis=0) / PULSE for angles in (counted, rounded))

    @property
    def counted(self) -> Claim:
        return Claim(
            "Pulses are never off the angle by more than half of one: largest error of their sum, in pulses",
            float(np.max(np.abs(self.pulses[0]))), 0.5 + 1e-6, False,
            opposite="Pulses are off the angle by more than half of one",
        )  # fmt: skip

    @cached_property
    def shifts(self) -> np.ndarray:
        """Mean specific force of 40 Hz, shaken to and fro along the first axis and round in the others, (levels, 3)."""
        found = []
        for level in LEVELS:
            readings, = shake(
                1.0,
                STEP,
                ("reading.specific_force",),
                vibrating=True,
                vibration_frequency=40.0,
                vibration_swing_sine=[0.0] * 3,
                vibration_swing_cosine=[0.0] * 3,
                vibration_shake_sine=[level, level, 0.0],
                vibration_shake_cosine=[0.0, 0.0, 2.0 * level],
                accelerometer_rectification=[RECTIFICATION] * 3,
                specific_force=[0.0] * 3,
            )  # fmt: skip
            found.append(np.mean(readings[1:], axis=0))
        return np.array(found)

    @property
    def rectified(self) -> Claim:
        expected = 0.5 * RECTIFICATION * np.outer(LEVELS**2, [1.0, 1.0, 4.0])
        return Claim(
            "Vibration shifts the null by k a²/2: off it",
            1e6 * float(np.max(np.abs(self.shifts - expected))), 1e-3, False, "um/s2",
            "Vibration does not shift the null by k a²/2",
        )  # fmt: skip


def picture(found: Increments, claims: Sequence[Claim]) -> bytes:
    """A panel for each claim."""
    with figure(2, 2, size=(11.0, 8.0)) as (drawing, axes):
        ticks = (0.2, 0.3, 0.4, 0.6, 0.8)
        (cone, scull), (pulse, shift) = axes
        drawing.subplots_adjust(hspace=0.35, wspace=0.25)
        turn = 2 * np.pi / AROUND
        smooth = np.geomspace(turn.min(), turn.max(), 200)
        for panel, errors, what in zip((cone, scull), found.errors, ("coning rate", "sculling"), strict=True):
            for m, row, colour in zip(SAMPLES, errors, COLOURS, strict=False):
                panel.loglog(turn, np.abs(row), "o", ms=4, color=colour, label=f"imu.fmu, m = {m}: order {2 * m}")
                panel.loglog(smooth, np.abs(response(m, smooth)), "-", lw=0.8, color=colour)
            panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            panel.set_xticks([], minor=True)
            panel.set(
                xlabel="angle of the motion from sample to sample, rad",
                ylabel=f"drift, of the {what} (lines: closed form)",
            )

        time = np.arange(len(found.pulses[0])) * 10 * STEP
        counted, rounded = found.pulses
        pulse.plot(time, counted[:, 0], color=COLOURS[0], lw=0.6, label="imu.fmu: the remainder is kept")
        pulse.plot(time, rounded[:, 0], color=COLOURS[1], lw=0.8, label="each increment rounded by itself")
        pulse.axhspan(-0.5, 0.5, color=GREY, alpha=0.2, lw=0, label="half a pulse")
        pulse.set(xlabel="time at 0.18 deg/s with noise, s", ylabel="error of the summed angle, pulses of 2 arcsec")

        smooth = np.linspace(0.0, LEVELS[-1], 100)
        for i, name, factor in ((0, "to and fro, a", 1.0), (2, "twice that", 4.0)):
            shift.plot(LEVELS, 1e3 * found.shifts[:, i], "o", ms=4, color=COLOURS[i], label=f"imu.fmu: {name}")
            shift.plot(smooth, 1e3 * 0.5 * RECTIFICATION * factor * smooth**2, "-", lw=0.8, color=COLOURS[i])
        shift.set(xlabel="amplitude a of 40 Hz, m/s²", ylabel="null shift, mm/s² (lines: k a²/2, k = 2e-4 s²/m)")

        for panel, claim in zip((cone, scull, pulse, shift), claims, strict=True):
            title(drawing, panel, claim.sentence.partition(":")[0])
            panel.legend(fontsize=8)
        return png(drawing, 80)
