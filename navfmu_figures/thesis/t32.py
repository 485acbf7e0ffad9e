"""What a calibrated magnetometer leaves of a heading."""

from __future__ import annotations

from typing import Any

import numpy as np

from navfmu import System
from navfmu.calibration.magnetometer.swinging import needle, wrap
from navfmu.figures import Comparison, Found, Task, row
from navfmu.report.figure import COLOURS, GREY, figure, png, title

MILLIGAUSS = 1e-7
"""T."""
LEFT = 7.0
"""mG, the largest mean of what a calibration leaves of an axis, p. 98 with Fig 3.27."""
RATE, NOISE = 20, 3.5
"""Hz and deg: the wide-band noise of a heading in Fig 3.29."""
FIRST = 1.0 + 1.0 / RATE
"""s until the first sample with a field."""
SECONDS = 3000
"""Of a heading that stands still."""
NONE = {"crustal_level": 0.0} | {
    f"{error}_sigma": 0.0 for error in ("hard_iron", "soft_iron", "scale_factor", "misalignment", "noise")
}
PLACE = {"latitude": np.radians(37.7), "longitude": np.radians(-121.8), "altitude": 0.0}
"""Livermore."""
HEADINGS = np.arange(0.0, 360.0, 10.0)


@row(
    "Calibration leaves 2.5 degrees of heading that stay and 0.8 degrees that are white, once a second",
    "thesis section 3.12, (3.48), (3.82)-(3.86), Figs 3.27, 3.29, 3.30",
    fmus=["magnetometer"],
)
def t32(task: Task) -> Found:
    """Turn a magnetometer that is left with 7 mG in each axis, and let a noisy one stand still."""
    system = System.load(task.fmu("magnetometer"))
    still = fields(system, task.seed, 1.0 + FIRST, 0.0)[-1]
    level = float(np.hypot(still[0], still[1]))
    errors = turned(system, task.seed)
    noisy = fields(system, task.seed, SECONDS + FIRST, 0.0, noise_sigma=np.radians(NOISE) * level)
    off = np.degrees(wrap(needle(noisy) - needle(still[None])))[-RATE * SECONDS :]
    seconds = off.reshape(SECONDS, RATE).mean(axis=1)
    words = "Errors of the needle with 7 mG left in each axis, and noise at 20 Hz and averaged over a second"
    return Found(compared(errors, seconds), picture(errors, off, seconds), words, NOTES)


NOTES = (
    "Why what stays is taken for a Gauss-Markov process of 120 s the thesis leaves to its judgement: there is nothing "
    "to find again.",
)


def turned(system: System, seed: int) -> np.ndarray:
    """Errors of the needle at HEADINGS, deg, with LEFT in each axis."""
    iron = LEFT * MILLIGAUSS
    shown = [[fields(system, seed, FIRST, heading, hard_iron=left)[-1] for left in (0.0, iron)] for heading in HEADINGS]
    exact, left = np.array(shown).transpose(1, 0, 2)
    return np.degrees(wrap(needle(left) - needle(exact)))


def fields(system: System, seed: int, stop: float, heading: float, **errors: Any) -> np.ndarray:
    """What the triad shows at 20 Hz, T, (samples, 3), at a heading in deg."""
    given = NONE | PLACE | {"heading": np.radians(heading), "sample_period": 1.0 / RATE} | errors
    frame = system.run(
        stop=stop,
        step=1.0 / RATE,
        record_period=1.0 / RATE,
        seed=seed,
        parameters={f"magnetometer.{name}": value for name, value in given.items()},
        record="magnetometer.field.field_b",
    )
    return frame.to_numpy()


def compared(errors: np.ndarray, seconds: np.ndarray) -> list[Comparison]:
    """The largest error of all headings, and the spread of means of a second, deg."""
    count = len(seconds)
    free = 3.9 * np.sqrt(0.5 / count)
    return [
        Comparison(
            "largest error of heading with 7 mG in each axis", "2.5 deg", float(np.max(np.abs(errors))), 2.45, 2.55,
            "the printed figure has no more digits", "deg",
        ),
        Comparison(
            "white noise of a heading once a second", "0.8 deg", float(np.std(seconds)),
            0.75 - free * 0.8, 0.85 + free * 0.8,
            f"the digits of the printed figure, and what {count} samples scatter by", "deg",
        ),
    ]  # fmt: skip


def picture(errors: np.ndarray, off: np.ndarray, seconds: np.ndarray) -> bytes:
    """As Figs 3.30 and 3.29."""
    with figure(1, 2, size=(11.0, 4.2)) as (drawing, (needles, noise)):
        needles.plot(HEADINGS, errors, "o-", ms=3, lw=0.9, color=COLOURS[0], label="ours")
        for edge in (-2.5, 2.5):
            needles.axhline(edge, color=COLOURS[1], lw=0.9, label="thesis, largest" if edge > 0 else None)
        needles.set(xlabel="heading, deg", ylabel="error of the needle, deg")
        needles.legend()
        title(drawing, needles, "7 mG left in each axis, Fig 3.30")
        bins = np.linspace(-12.0, 12.0, 97)
        noise.hist(off, bins, density=True, histtype="step", color=GREY, label=f"{RATE} Hz: {np.std(off):.2f} deg")
        noise.hist(seconds, bins, density=True, histtype="step", color=COLOURS[0],
                   label=f"means of a second: {np.std(seconds):.2f} deg")  # fmt: skip
        noise.set(xlabel="error of heading, deg", ylabel="density")
        noise.legend()
        title(drawing, noise, "White noise, Fig 3.29")
        return png(drawing)
