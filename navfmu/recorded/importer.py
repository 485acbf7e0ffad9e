"""From a CSV file to a smooth flight, with an account of what was found and done on the way."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from navfmu.constants import FOOT, KNOT
from navfmu.errors import NavfmuError, check_progress
from navfmu.recorded import defects as found
from navfmu.recorded.smooth import Flight, Manoeuvre, Noise, Residuals, smooth
from navfmu.recorded.track import FEWEST_ROWS, Recording, read

HOLE = 15.0  # s without a measured position that are worth a line in the report
SHORTEST_FLIGHT = 60.0
PASSES = 5  # of smoothing, until the estimate of the timing jitter holds


@dataclass(frozen=True)
class Imported:
    """A smoothed flight with its recording (the airborne part) and the account of the import."""

    source: str
    recording: Recording
    measured: np.ndarray
    defects: found.Defects
    noise: Noise
    flight: Flight
    residuals: Residuals

    def sentences(self) -> list[str]:
        """What was found in the recording, for the user."""
        return self.defects.sentences

    def residual_table(self) -> list[tuple[str, str, int, float, float, float]]:
        """Rows (quantity, unit, number, root mean square, 95th percentile of the size, largest size)."""
        r = self.residuals
        quantities = (
            ("along track", "m", r.along),
            ("across track", "m", r.cross),
            ("time of position", "s", r.timing),
            ("altitude", "ft", r.altitude / FOOT),
            ("ground speed", "kn", r.speed / KNOT),
            ("track angle", "deg", np.degrees(r.track)),
            ("vertical rate", "ft/min", r.climb / FOOT * 60.0),
        )
        rows = []
        for name, unit, values in quantities:
            size = np.abs(values[np.isfinite(values)])
            if len(size):
                summary = (np.sqrt(np.mean(size**2)), np.percentile(size, 95.0), size.max())
                rows.append((name, unit, len(size), *(float(x) for x in summary)))
        return rows


def import_track(
    path: str | Path,
    minimum_speed: float = 60.0 * KNOT,
    skip_incomplete: bool = False,
    manoeuvre: Manoeuvre | None = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> Imported:
    """Read, examine and smooth a recorded track.

    Parameters
    ----------
    minimum_speed : m/s over ground above which the aircraft counts as flying
    skip_incomplete : leave out rows that lack a required value instead of refusing the file
    manoeuvre : how hard the aircraft may accelerate; the default suits transport and general aviation
    progress : called with the passes of smoothing that are done, the most there can be, and a note
    """
    check_progress(progress)
    recording = read(path, skip_incomplete)
    account = found.Defects()
    say = account.sentences.append
    if recording.unused_columns:
        say(f"columns not used: {', '.join(recording.unused_columns)}")
    if recording.skipped_rows:
        say(f"{recording.skipped_rows} incomplete row(s) left out")
    whole = recording
    recording = found.airborne_part(recording, minimum_speed)
    if len(recording) < FEWEST_ROWS:
        raise NavfmuError(f"{path}: the airborne part has {len(recording)} row(s); at least {FEWEST_ROWS} are needed")
    recording, measured, known, alive, lost = _measured_part(recording)
    if len(recording) < len(whole):
        say(
            f"airborne part: {recording.time[0]:.0f} s to {recording.time[-1]:.0f} s of the recording "
            f"({len(recording)} of {len(whole)} rows)"
        )
    if lost:
        say(f"{lost} row(s) at the ends only repeat or extend the last position and were cut off")
    if measured.sum() < FEWEST_ROWS or recording.time[-1] - recording.time[0] < SHORTEST_FLIGHT:
        raise NavfmuError(
            f"{path}: the airborne part has {int(measured.sum())} measured position(s) in "
            f"{recording.time[-1] - recording.time[0]:.0f} s; "
            f"at least {FEWEST_ROWS} in {SHORTEST_FLIGHT:.0f} s are needed"
        )
    recording, remarks = found.checked_track(recording, measured)
    account.sentences.extend(remarks)
    _account_for_rows(account, recording, measured, alive)
    noise, flight, residuals = _smooth_with_estimated_jitter(recording, measured, known, alive, manoeuvre, progress)
    account.jitter = noise.time
    ahead = residuals.along[measured] / np.maximum(found.ground_speed(recording)[measured], found.MOVING)
    say(
        f"timing jitter of the positions: standard deviation {account.jitter:.2f} s "
        f"(from the median; with all stragglers {np.sqrt(np.mean(ahead**2)):.2f} s)"
    )
    return Imported(str(path), recording, measured, account, noise, flight, residuals)


def _smooth_with_estimated_jitter(
    recording: Recording,
    measured: np.ndarray,
    known: np.ndarray,
    alive: np.ndarray,
    manoeuvre: Manoeuvre | None,
    progress: Callable[[int, int, str], None] | None,
) -> tuple[Noise, Flight, Residuals]:
    """Smooth, estimate the time errors from the distances along the track, and smooth again until both agree.

    The first estimate compares neighbouring rows and therefore misses errors that change slowly.
    """
    first = float(np.clip(found.timing_jitter(recording, measured), 0.02, 5.0))
    jitter = first
    for number in range(PASSES):
        if progress is not None:
            progress(number, PASSES, f"smoothing, pass {number + 1} of at most {PASSES}")
        noise = Noise(time=jitter)
        flight, residuals = smooth(recording, measured, known, alive, noise, manoeuvre)
        ahead = residuals.along[measured] / np.maximum(found.ground_speed(recording)[measured], found.MOVING)
        robust = 1.4826 * np.median(np.abs(ahead))
        estimate = float(np.clip(robust, 0.02, min(5.0, 4.0 * max(first, 0.1))))
        if abs(estimate - jitter) <= 0.05 * jitter:
            break
        jitter = estimate
    return noise, flight, residuals


def _measured_part(recording: Recording) -> tuple[Recording, np.ndarray, np.ndarray, np.ndarray, int]:
    """Cut echoes off both ends; return the rest with its masks (see ``smooth``)."""
    repeated = found.repeated_rows(recording)
    interpolated = found.interpolated_rows(recording) & ~repeated
    measured = ~(repeated | interpolated)
    known = ~found.frozen_rows(recording, repeated)
    alive = known & ~interpolated
    at = np.flatnonzero(measured)
    part = slice(at[0], at[-1] + 1)
    return recording.rows(part), measured[part], known[part], alive[part], len(recording) - (at[-1] + 1 - at[0])


def _account_for_rows(account: found.Defects, recording: Recording, measured: np.ndarray, alive: np.ndarray) -> None:
    repeated = found.repeated_rows(recording)
    account.repeated = int(repeated.sum())
    account.interpolated = int((~measured & ~repeated).sum())
    if account.repeated:
        account.sentences.append(f"{account.repeated} row(s) repeat the position before them and are not measurements")
    if account.interpolated:
        account.sentences.append(
            f"{account.interpolated} row(s) lie on straight lines between measurements (interpolated by whoever wrote "
            "the file) and are not used as measurements"
        )
    at = np.flatnonzero(measured)
    for a, b in itertools.pairwise(at):
        if recording.time[b] - recording.time[a] > HOLE:
            living = recording.speed is not None and alive[a + 1 : b].any()
            bridge = "recorded speed and track" if living else "the smoothest flight between its ends"
            account.holes.append(found.Hole(recording.time[a], recording.time[b], bridge))
    if account.holes:
        longest = max(account.holes, key=lambda h: h.end - h.start)
        account.sentences.append(
            f"{len(account.holes)} hole(s) of more than {HOLE:.0f} s without positions; the longest lasts "
            f"{longest.end - longest.start:.0f} s from {longest.start:.0f} s and is bridged by {longest.bridged_by}"
        )
