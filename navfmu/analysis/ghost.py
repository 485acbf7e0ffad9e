"""The other place where two circles cross."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymap3d

from navfmu.analysis.fix import measured, solve
from navfmu.analysis.line import DISTANCE, Line
from navfmu.analysis.place import Place, moved

APART = 10.0
"""Places that are nearer (m) are one."""


def ghost(lines: Sequence[Line], place: Place) -> Place | None:
    """The other place that two distances allow, where their circles cross a second time; None where they do not."""
    if len(lines) != 2 or any(line.kind != DISTANCE for line in lines):
        return None
    first, second = (
        np.array(pymap3d.geodetic2enu(one.latitude, one.longitude, one.elevation, *place.values(), deg=False)[:2])
        for one in (line.station for line in lines)
    )
    along = (second - first) / np.hypot(*(second - first))
    across = first - along * (first @ along)  # from the place to the line through both stations
    if 2.0 * np.hypot(*across) < APART:
        return None
    start = moved(*place.values(), 2.0 * across[1], 2.0 * across[0])
    lat, lon = solve(lines, measured(lines, place), *map(float, start), place.altitude)
    other = Place(float(lat), float(lon), place.altitude)
    far = float(np.hypot(*place.offset(other.latitude, other.longitude)))
    return other if np.isfinite(far) and far > APART else None
