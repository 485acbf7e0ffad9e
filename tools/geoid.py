"""The table of the geoid: ``python -m tools.geoid WW15MGH.DAC`` fits models/earth/egm96.npy and says what is left.

WW15MGH.DAC holds the heights of EGM96 in cm, two bytes each, the higher one first: 721 rows from the North Pole south,
1440 columns from Greenwich to the east, every 15 minutes of arc. The National Geospatial-Intelligence Agency gives it
away at https://earth-info.nga.mil with the heights of six places, which are checked here.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import RectBivariateSpline

from models.earth import geoid

FILE = Path(geoid.__file__).with_name("egm96.npy")
SHAPE = (721, 1440)
LATITUDE = 90.0 - 0.25 * np.arange(SHAPE[0])
LONGITUDE = 0.25 * np.arange(SHAPE[1])
PLACES = (
    (38.6281550, 269.7791550, -31.628),
    (-14.6212170, 305.0211140, -2.969),
    (46.8743190, 102.4487290, -43.575),
    (-23.6174460, 133.8747120, 15.871),
    (38.6254730, 359.9995000, 50.066),
    (-0.4667440, 0.0023000, 17.329),
)
"""Latitude, longitude in degrees and height in m by the agency's own program, OUTINTPT.DAT."""


def heights(path: Path) -> np.ndarray:
    """Heights of the file in m, checked at the six places."""
    data = path.read_bytes()
    if len(data) != 2 * SHAPE[0] * SHAPE[1]:
        raise SystemExit(f"{path} has {len(data)} bytes; expected WW15MGH.DAC with {2 * SHAPE[0] * SHAPE[1]}")
    z = 0.01 * np.frombuffer(data, ">i2").reshape(SHAPE)
    around = np.arange(-8, SHAPE[1] + 8)
    spline = RectBivariateSpline(LATITUDE[::-1], 0.25 * around, z[::-1, around % SHAPE[1]])
    worst = max(abs(spline(*place[:2])[0, 0] - place[2]) for place in PLACES)
    if worst > 0.01:
        raise SystemExit(f"{path} differs by {worst:.3f} m from the heights that are published; expected at most 1 cm")
    return z


def bases() -> tuple[np.ndarray, np.ndarray]:
    """The splines at the rows and at the columns of the file: (721, 75) and (1440, 144)."""
    step = np.degrees(geoid.STEP)
    rows = _spline((LATITUDE[:, None] + 90.0) / step + 1.0 - np.arange(geoid.ROWS + 3))
    columns = (LONGITUDE[:, None] / step - np.arange(geoid.COLUMNS)) % geoid.COLUMNS
    return rows, _spline(np.minimum(columns, geoid.COLUMNS - columns))


def fit(z: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Coefficients of least squares, in cm: (75, 144)."""
    weight = np.sqrt(np.where(np.abs(LATITUDE) == 90.0, 100.0, np.cos(np.radians(LATITUDE)) + 0.1))[:, None]
    half = np.linalg.lstsq(weight * rows, weight * z, rcond=None)[0]
    return np.rint(100.0 * np.linalg.lstsq(columns, half.T, rcond=None)[0].T).astype(np.int16)


def _spline(x: np.ndarray) -> np.ndarray:
    """Cubic B-spline."""
    x = np.abs(x)
    return np.where(x < 1.0, 2.0 / 3.0 - x * x + 0.5 * x**3, np.maximum(2.0 - x, 0.0) ** 3 / 6.0)


def main() -> None:
    z = heights(Path(sys.argv[1]))
    rows, columns = bases()
    np.save(FILE, fit(z, rows, columns))
    error = 0.01 * rows @ np.load(FILE) @ columns.T - z
    area = np.broadcast_to(np.cos(np.radians(LATITUDE))[:, None], SHAPE)
    order = np.argsort(np.abs(error), axis=None)
    share = np.cumsum(area.ravel()[order]) / np.sum(area)
    within = [np.abs(error).ravel()[order][np.searchsorted(share, part)] for part in (0.95, 0.995)]
    row, column = np.unravel_index(order[-1], SHAPE)
    rms, rms_of_heights = (np.sqrt(np.average(x**2, weights=area)) for x in (error, z))
    print(f"heights {rms_of_heights:.1f} m rms, {z.min():.1f} to {z.max():.1f} m")
    print(f"error {rms:.2f} m rms; 95 % of the sphere within {within[0]:.1f} m, 99.5 % within {within[1]:.1f} m")
    print(f"largest {np.max(np.abs(error)):.1f} m at {LATITUDE[row]:g}, {LONGITUDE[column]:g} degrees")
    print(f"at the poles {np.max(np.abs(error[[0, -1]])):.2f} m")


if __name__ == "__main__":
    main()
