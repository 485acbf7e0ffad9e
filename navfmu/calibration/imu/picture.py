"""A picture of a calibration: the attitudes of the stands, and what the errors leave of the readings."""

from __future__ import annotations

import numpy as np

from navfmu.calibration.allan.sensor import ACCELEROMETER, GYRO
from navfmu.calibration.imu.determination import Determination
from navfmu.errors import visible
from navfmu.report.figure import COLOURS, GREY, figure, png


def draw(found: Determination, source: str) -> bytes:
    """A panel each: directions of gravity in the unit, residuals of the gyros, of the accelerometers."""
    stands = found.stands
    down = -stands.specific_force / np.linalg.norm(stands.specific_force, axis=1)[:, None]
    rates, forces = found.residuals
    with figure(1, 3, size=(13.5, 4.2), above=0.25) as (drawing, (where, gyros, accelerometers)):
        drawing.suptitle(visible(source), x=0.01, ha="left", fontsize=9.5, parse_math=False)
        round_ = np.linspace(0.0, 2.0 * np.pi, 100)
        # as a map of equal angles from "down": level in the middle, upside down on the rim
        tilt, way = np.degrees(np.arccos(np.clip(down[:, 2], -1.0, 1.0))), np.arctan2(down[:, 1], down[:, 0])
        where.plot(tilt * np.sin(way), tilt * np.cos(way), "o", ms=5, color=COLOURS[0])
        for radius, name in ((90.0, "z level"), (180.0, "z up")):
            where.plot(radius * np.sin(round_), radius * np.cos(round_), color=GREY, lw=0.8)
            where.annotate(name, (0.0, radius), color=GREY, fontsize=8, ha="center", va="bottom")
        where.set(aspect="equal", xlim=(-200, 200), ylim=(-200, 205))
        where.set_xlabel("y down, right of the middle, deg from z down")
        where.set_ylabel("x down, above the middle, deg")
        where.set_title(f"{len(down)} stands: which way is down in the unit", fontsize=10)
        panels = ((gyros, GYRO, rates, 0), (accelerometers, ACCELEROMETER, forces, 1))
        for axis, sensor, left, kind in panels:
            for column, name, colour in zip(left.T, "xyz" if left.shape[1] == 3 else ["size"], COLOURS, strict=False):
                axis.plot(np.arange(1, len(column) + 1), column, "o", ms=3.5, color=colour, label=name)
            sigma = found.fit.sigma[kind]
            for side in (-1.0, 1.0):
                axis.axhline(side * sigma, color=GREY, lw=0.8, ls="--", label="one sigma" if side > 0.0 else None)
            axis.set_xlabel("stand")
            axis.set_ylabel(f"{sensor.quantity}, {sensor.unit}")
            axis.set_title(f"what the errors leave, sigma {sigma:.2g} {sensor.unit}", fontsize=10)
            axis.legend(ncols=4, fontsize=8)
        return png(drawing)
