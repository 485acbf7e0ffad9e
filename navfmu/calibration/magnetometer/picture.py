"""Pictures of a calibration: the fields and their surface, strength before and after, what of the sphere was seen."""

from __future__ import annotations

import numpy as np

from navfmu.calibration.magnetometer.choice import Chosen
from navfmu.calibration.magnetometer.swinging import Swing, design, needle, wrap
from navfmu.errors import visible
from navfmu.report.figure import COLOURS, GREY, figure, png

MICRO = 1e6
SHOWN = 3000
"""Samples that are drawn, about."""


def draw(chosen: Chosen, measured: np.ndarray, source: str) -> bytes:
    """Three panels for fields (samples, 3), T."""
    locus, axes = chosen.locus, len(chosen.locus.centre)
    some = measured[:: 1 + len(measured) // SHOWN]
    corrected = locus.corrected(some[:, :axes])
    with figure(1, 3, size=(13.0, 4.6), above=0.3, squeeze=False) as (drawing, panels):
        seen, strength, sphere = panels[0]
        drawing.suptitle(f"{visible(source)}: {chosen.method}", x=0.01, ha="left", fontsize=9.5, parse_math=False)
        for values, colour, word in ((some, GREY, "measured"), (corrected, COLOURS[0], "corrected")):
            seen.plot(*MICRO * values[:, :2].T, ".", ms=2, color=colour, label=word)
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        seen.plot(*MICRO * locus.field * np.stack([np.cos(turn), np.sin(turn)]), "-", color=COLOURS[1], lw=1)
        seen.set(xlabel="field x, uT", ylabel="field y, uT", aspect="equal", title="Fields, and the size of Earth's")
        seen.legend(markerscale=5)
        place = np.linspace(0.0, 100.0, len(some))
        for values, colour in ((some[:, :axes], GREY), (corrected, COLOURS[0])):
            strength.plot(place, MICRO * np.linalg.norm(values, axis=1), ".", ms=2, color=colour)
        strength.axhline(MICRO * locus.field, color=COLOURS[1], lw=1)
        strength.set(xlabel="share of the recording, %", ylabel="strength, uT")
        strength.set_title(f"Strength, {MICRO * locus.sigma:.2g} uT rms left")
        direction = corrected / np.linalg.norm(corrected, axis=1)[:, None]
        around = np.degrees(np.arctan2(direction[:, 1], direction[:, 0]))
        up = np.degrees(np.arcsin(direction[:, 2])) if axes == 3 else np.zeros(len(around))
        sphere.plot(around, up, ".", ms=2, color=COLOURS[0])
        sphere.set(xlim=(-180, 180), ylim=(-90, 90), xticks=range(-180, 181, 90), yticks=range(-90, 91, 30))
        spanned = "a level turn" if chosen.angle is None else f"a strip of {np.degrees(chosen.angle):.0f} deg"
        sphere.set(xlabel="field from nose to right, deg", ylabel="field below, deg", title=f"Seen: {spanned}")
        return png(drawing)


def draw_swing(found: Swing, measured: np.ndarray, heading: np.ndarray, source: str) -> bytes:
    """Errors of the needle by heading, rad, the series (3.52), and what it leaves."""
    with figure(1, 1, size=(8.0, 4.4), above=0.2) as (drawing, axis):
        fine = np.linspace(0.0, 2.0 * np.pi, 361)
        at = np.degrees(np.mod(heading, 2.0 * np.pi))
        axis.plot(at, np.degrees(wrap(needle(measured) - heading)), ".", color=GREY, label="needle")
        axis.plot(np.degrees(fine), np.degrees(design(fine) @ found.coefficients), color=COLOURS[0], label="(3.52)")
        axis.plot(at, np.degrees(found.left), ".", color=COLOURS[1], label="left")
        axis.set(xlabel="heading, deg", ylabel="error, deg", xlim=(0, 360), xticks=range(0, 361, 45))
        axis.set_title(f"{visible(source)}: swinging", parse_math=False)
        axis.legend(ncols=3)
        return png(drawing)
