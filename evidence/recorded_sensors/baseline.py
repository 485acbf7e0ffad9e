"""Dead reckoning as one would do it in an afternoon, with the heading of the log's own filter, which kept its GPS.

Wind and a factor of the airspeed are fitted to GPS velocity in the time before a cut that a navigator has to learn;
then airspeed and wind are added up.
"""

from __future__ import annotations

import numpy as np

from evidence.recorded_sensors.flight import Flight
from models.navigation import navigator

STEP = 0.05


def distances(flight: Flight, late: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Of each cut times of the log (s) and horizontal errors (m); none where the log has no attitude or airspeed.

    ``late``: by how much GPS comes late, s.
    """
    if not (flight.folder / "reference.parquet").exists():
        return []
    log, air, gps = flight.stream("reference"), flight.stream("air"), flight.gps
    if "yaw" not in log or "indicated_airspeed" not in air:
        return []
    log, air = log[["time", "yaw"]].dropna(), air[["time", "indicated_airspeed"]].dropna()
    time = np.arange(flight.airborne[0], flight.airborne[1] - late, STEP)
    heading = np.interp(time, log["time"], np.unwrap(log["yaw"]))
    through_air = np.interp(time, air["time"], air["indicated_airspeed"]) * np.stack([np.cos(heading), np.sin(heading)])
    first, at = gps.iloc[0], gps["time"] - late
    flown = navigator.offset(
        first["latitude"], first["longitude"], first["altitude"], gps["latitude"], gps["longitude"]
    )
    track = np.stack([np.interp(time, at, one) for one in flown])
    over_ground = np.stack([np.interp(time, at, gps[f"velocity_{one}"]) for one in ("north", "east")])
    learning = flight.learned - flight.airborne[0]
    found = []
    for cut in flight.cuts:
        before, after = (time >= cut - learning) & (time < cut), time >= cut
        seen = np.vstack([np.kron(np.eye(2), np.ones(before.sum())), through_air[:, before].ravel()]).T
        north, east, factor = np.linalg.lstsq(seen, over_ground[:, before].ravel(), rcond=None)[0]
        velocity = factor * through_air[:, after] + np.array([[north], [east]])
        way = np.cumsum(STEP * velocity, axis=1) - STEP * velocity
        error = track[:, after][:, :1] + way - track[:, after]
        found.append((time[after], np.hypot(*error)))
    return found
