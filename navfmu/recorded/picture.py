"""A picture of an imported track: what was recorded, what the smoothing made of it, and the difference."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from navfmu.constants import FOOT, KNOT, STANDARD_GRAVITY
from navfmu.errors import visible
from navfmu.files.writing import replacing
from navfmu.recorded.importer import Imported


def draw(imported: Imported, path: str | Path) -> None:
    """Write a PNG with the ground track, altitude, speed, accelerations and the residuals."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    recording, flight, residuals = imported.recording, imported.flight, imported.residuals
    time = np.arange(0.0, flight.duration, 0.5)
    rows, minutes = residuals.time / 60.0, time / 60.0
    measured = imported.measured
    north, east, _ = flight.velocity(time)
    speed = np.hypot(north, east)
    course_rate = np.gradient(np.unwrap(np.arctan2(east, north)), time)

    figure, axes = plt.subplots(4, 2, figsize=(15, 17))
    ((track, hist), (altitude, vertical), (speeds, along), (turn, cross)) = axes
    track.plot(
        np.degrees(recording.longitude[~measured]), np.degrees(recording.latitude[~measured]), ".", ms=2, c="orange"
    )
    track.plot(np.degrees(recording.longitude[measured]), np.degrees(recording.latitude[measured]), ".", ms=2, c="grey")
    track.plot(np.degrees(flight.longitude(time)), np.degrees(flight.latitude(time)), lw=0.7, c="C0")
    track.set(
        title="ground track (grey: measured, orange: not used)", xlabel="longitude (deg)", ylabel="latitude (deg)"
    )
    track.set_aspect(1.0 / np.cos(np.mean(recording.latitude)))
    hist.hist(residuals.timing[np.isfinite(residuals.timing)], bins=80, color="C0")
    hist.set(title="time errors ascribed to the positions (at most 4 standard deviations)", xlabel="s", ylabel="rows")
    altitude.plot(rows, recording.altitude / FOOT, ".", ms=2, c="grey")
    altitude.plot(minutes, flight.altitude(time) / FOOT, lw=0.7)
    altitude.set(title="altitude (dots: recorded, line: smoothed)", ylabel="ft")
    vertical.plot(rows, residuals.altitude / FOOT, ".", ms=2)
    vertical.set(title="altitude, recorded minus smoothed", ylabel="ft")
    if recording.speed is not None:
        speeds.plot(rows, recording.speed / KNOT, ".", ms=2, c="grey")
    speeds.plot(minutes, speed / KNOT, lw=0.7)
    speeds.set(title="ground speed (dots: recorded, line: smoothed)", ylabel="kn")
    along.plot(rows, residuals.along, ".", ms=2)
    along.set(title="along track, recorded minus smoothed", ylabel="m")
    turn.plot(minutes, np.degrees(np.arctan2(speed * course_rate, STANDARD_GRAVITY)), lw=0.6)
    turn.set(title="bank angle of a coordinated turn in still air", ylabel="deg", xlabel="min")
    cross.plot(rows, residuals.cross, ".", ms=2)
    cross.set(title="across track, recorded minus smoothed", ylabel="m", xlabel="min")
    for ax in axes.flat[2:]:
        ax.grid(alpha=0.3)
    figure.suptitle(visible(Path(imported.source).name), parse_math=False)
    figure.tight_layout()
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=90)
    plt.close(figure)
