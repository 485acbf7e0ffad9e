"""Height of mean sea level above the ellipsoid: a surface of cubic splines fitted to EGM96.

EGM96 (Lemoine and others, NASA/TP-1998-206861) is the geoid of WGS-84 as NIMA TR8350.2 of 1997 has it, a work of the
United States' government without copyright. Its heights every 15 minutes of arc, file WW15MGH.DAC, are approximated by

    N(latitude, longitude) = sum_ij c_ij b(latitude / s - i) b(longitude / s - j),   s = 2.5 degrees              (1)

with b the cubic B-spline. The coefficients c are those of least squares over all 1 038 240 heights, each with the
weight cos(latitude) + 0.1, the poles with 100; they are kept in cm. ``tools/geoid.py`` makes ``egm96.npy`` of the
heights and measures what is left: 0.99 m rms over the sphere, 5.2 m at most on 99.5 % of it, and 17.2 m in one place,
the island of Hawaii. Without the table the error is the height itself, 31 m rms and up to 107 m. With half the step the
table is four times as large and the rms 0.46 m: that is taken when somebody needs it.

Latitude and longitude in rad, any longitude; heights in m. NaN for a latitude or longitude of NaN.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

STEP = float(np.radians(2.5))
"""s, rad."""
COEFFICIENTS = 0.01 * np.load(Path(__file__).with_name("egm96.npy")).astype(float)
"""c, m: latitudes from -92.5 to 92.5 degrees, longitudes from 0 to 357.5."""
ROWS, COLUMNS = 72, 144
"""Cells from pole to pole and around."""
LATITUDES = STEP * (np.arange(ROWS + 3) - 1.0) - 0.5 * np.pi
LONGITUDES = STEP * (np.arange(COLUMNS + 3) - 1.0)
TABLE = COEFFICIENTS[:, np.arange(-1, COLUMNS + 2) % COLUMNS]
"""c at LATITUDES and LONGITUDES, (75, 147): the first and the last columns are there twice, so that no cell is cut."""


def corners(latitude, longitude):
    """Coefficients at the ends of the cell of TABLE that holds a point, (2, 2)."""
    row = int(np.searchsorted(LATITUDES[1:-1], latitude, side="right"))
    column = int(np.searchsorted(LONGITUDES[1:-1], longitude, side="right"))
    return TABLE[row : row + 2, column : column + 2]


def height(latitude, longitude, corners=corners):
    """N of (1), m.

    ``corners(latitude, longitude)`` is how TABLE is searched, here or in a grid that holds it. A point needs the
    sixteen coefficients of four cells, which are searched by their middles.
    """
    row, along = _cell(latitude + 0.5 * np.pi, ROWS)
    column, across = _cell(np.mod(longitude, 2.0 * np.pi), COLUMNS)
    found = [
        [corners((row + i) * STEP - 0.5 * np.pi, (column + j) * STEP) for j in (-0.5, 1.5)] for i in (-0.5, 1.5)
    ]  # fmt: skip
    return _weights(along) @ np.block(found) @ _weights(across)


def _cell(angle, cells):
    """Which cell an angle is in, and how far, 0 to 1."""
    place = angle / STEP
    cell = np.clip(np.floor(place), 0.0, cells - 1.0)
    return cell, np.clip(place - cell, 0.0, 1.0)


def _weights(part):
    """b at the four knots around a point."""
    rest = 1.0 - part
    return np.array(
        [
            rest * rest * rest / 6.0,
            2.0 / 3.0 - part * part * (1.0 - 0.5 * part),
            2.0 / 3.0 - rest * rest * (1.0 - 0.5 * rest),
            part * part * part / 6.0,
        ]
    )
