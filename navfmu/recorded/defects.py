"""What is wrong with a recorded track before any smoothing: each defect is measured, named and kept apart.

A row of a recording may be a measurement or an echo of one. Receivers write the last position again while nothing is
received (*repeated* rows), and tools that put messages on an even time grid draw straight lines between them
(*interpolated* rows). Neither is a measurement; taken as such they stop the aircraft in mid-air or cut its corners.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from pymap3d import rcurve

from navfmu.constants import KNOT
from navfmu.errors import NavfmuError
from navfmu.recorded.track import Recording

MOVING = 20.0 * KNOT
POSITION_STEP = 1.5e-6 * np.pi / 180.0  # about the last printed digit of a position, rad
LONG_INTERRUPTION = 30.0  # s below the minimum speed that end a flight
KINK = np.radians(12.0)
CONFIRMS = np.radians(4.0)
ODD_SPEED = 0.1
COURSE_AGREES = np.radians(20.0)


@dataclass(frozen=True)
class Hole:
    """A stretch without position measurements, seconds of the recording's clock."""

    start: float
    end: float
    bridged_by: str


@dataclass
class Defects:
    """What was found; ``sentences`` tells it to the user."""

    repeated: int = 0
    interpolated: int = 0
    jitter: float = 0.0
    holes: list[Hole] = field(default_factory=list)
    sentences: list[str] = field(default_factory=list)


def local_metric(latitude: np.ndarray, altitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Metres per radian of latitude and of longitude on WGS-84."""
    north_south, east_west = rcurve.meridian(latitude, deg=False), rcurve.transverse(latitude, deg=False)
    return north_south + altitude, (east_west + altitude) * np.cos(latitude)


def wrap(angle: np.ndarray) -> np.ndarray:
    """The same angle within -pi to pi."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def increments(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """North and east displacement from each row to the next, m."""
    north, east = local_metric(recording.latitude, recording.altitude)
    return (
        0.5 * (north[1:] + north[:-1]) * np.diff(recording.latitude),
        0.5 * (east[1:] + east[:-1]) * np.diff(recording.longitude),
    )


def ground_speed(recording: Recording) -> np.ndarray:
    """Speed over ground of each row: the recorded column, or a running median of what the positions imply."""
    if recording.speed is not None and np.isfinite(recording.speed).all():
        return recording.speed
    implied = np.hypot(*increments(recording)) / np.diff(recording.time)
    padded = np.pad(implied, 3, mode="edge")  # len(implied) + 6
    windows = np.lib.stride_tricks.sliding_window_view(padded, 6)
    speed = np.median(windows, axis=1)
    if recording.speed is not None:
        speed = np.where(np.isfinite(recording.speed), recording.speed, speed)
    return speed


def airborne_part(recording: Recording, minimum_speed: float) -> Recording:
    """The longest flight in the recording.

    A flight is a stretch with at least ``minimum_speed`` (m/s over ground), interrupted for at most half a minute.
    Rows at its ends with an altitude of exactly zero, the code of many recorders for 'on the ground', are left out.
    """
    fast = ground_speed(recording) >= minimum_speed
    if not fast.any():
        raise NavfmuError(
            f"{recording.name}: the track never reaches {minimum_speed / KNOT:.0f} kn over ground, so all of it was "
            "taken to be on the ground; lower --minimum-speed for a slower aircraft"
        )
    at = np.flatnonzero(fast)
    breaks = np.flatnonzero(recording.time[at[1:]] - recording.time[at[:-1]] > _longest_step(at))
    starts, ends = np.r_[at[0], at[breaks + 1]], np.r_[at[breaks], at[-1]]
    longest = int(np.argmax(recording.time[ends] - recording.time[starts]))
    first, last = starts[longest], ends[longest]
    up = np.flatnonzero(recording.altitude[first : last + 1] != 0.0)
    if len(up) == 0:
        raise NavfmuError(f"{recording.name}: the altitude is 0 in every row that moves; all of it is on the ground")
    return recording.rows(slice(first + up[0], first + up[-1] + 1))


def _longest_step(at: np.ndarray) -> np.ndarray:
    """Allowed time between neighbouring fast rows: a hole in the file itself is not a landing."""
    neighbours = np.diff(at) == 1
    return np.where(neighbours, np.inf, LONG_INTERRUPTION)


def repeated_rows(recording: Recording) -> np.ndarray:
    """Rows that repeat the position of the row before while the aircraft moves."""
    same = (np.diff(recording.latitude) == 0) & (np.diff(recording.longitude) == 0)
    moving = ground_speed(recording)[1:] > MOVING if recording.speed is not None else True
    return np.r_[False, same & moving]


def interpolated_rows(recording: Recording) -> np.ndarray:
    """Rows on a straight line that somebody drew between two measurements.

    They lie between their neighbours at even speed to the last digit. So do the rows of a really straight flight;
    a drawn line differs from that by a speed that is not the aircraft's, or by a kink at one of its ends where the
    recorded track does not confirm its direction.
    """
    time = recording.time
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    on_line = np.ones(len(time) - 2, bool)
    for axis in (recording.latitude, recording.longitude):
        on_line &= np.abs(axis[:-2] + share * (axis[2:] - axis[:-2]) - axis[1:-1]) <= POSITION_STEP
    north, east = (displacement / np.diff(time) for displacement in increments(recording))
    implied, course = np.hypot(north, east), np.arctan2(east, north)
    on_line &= (implied[1:] > 0) & (implied[:-1] > 0)
    interpolated = np.zeros(len(time), bool)
    for first, last in runs(np.r_[False, on_line, False]):
        before, after = max(first - 2, 0), min(last + 1, len(north) - 1)  # increments next to those of the line
        kink = max(abs(wrap(course[i] - course[first])) for i in (before, after))
        if recording.speed is not None:
            speed = np.nanmean(recording.speed[first - 1 : last + 2])  # NaN, and so no drawn line, if all are
        else:
            speed = 0.5 * (implied[before] + implied[after])
        rows = slice(first - 1, last + 2)
        if recording.track is not None and np.all(np.abs(wrap(recording.track[rows] - course[first])) < CONFIRMS):
            kink = 0.0
        drawn = kink > KINK or abs(implied[first] - speed) > max(ODD_SPEED * speed, 3.0 * KNOT)
        interpolated[first : last + 1] = drawn
    return interpolated


def frozen_rows(recording: Recording, repeated: np.ndarray) -> np.ndarray:
    """Repeated rows in which the other columns stand still as well, up to the end of their hole: echoes too."""
    frozen = repeated.copy()
    for column in (recording.speed, recording.track):
        if column is not None:
            frozen &= np.r_[False, np.diff(column) == 0]
    for first, last in runs(repeated):
        alive = np.flatnonzero(~frozen[first : last + 1])
        if len(alive):
            frozen[first : first + alive[-1] + 1] = False
    return frozen


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of every run of True."""
    edges = np.flatnonzero(np.diff(np.r_[0, mask.astype(int), 0]))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def timing_jitter(recording: Recording, measured: np.ndarray) -> float:
    """Standard deviation of the time errors of the positions, s.

    Between two measured rows the aircraft needs the distance divided by its speed; what this differs from the
    recorded interval is the difference of two time errors. Uses the median, so single jumps do not count.
    """
    rows = np.flatnonzero(measured)
    north, east = local_metric(recording.latitude, recording.altitude)
    distance = np.hypot(
        north[rows[1:]] * np.diff(recording.latitude[rows]), east[rows[1:]] * np.diff(recording.longitude[rows])
    )
    speed = np.maximum(ground_speed(recording), MOVING)
    interval = np.diff(recording.time[rows])
    error = distance / (0.5 * (speed[rows[1:]] + speed[rows[:-1]])) - interval
    near = interval <= 2.5 * np.median(interval)  # a chord over a longer interval may cut a turn
    return float(1.4826 * np.median(np.abs(error[near] - np.median(error[near]))) / np.sqrt(2.0))


def checked_track(recording: Recording, measured: np.ndarray) -> tuple[Recording, list[str]]:
    """The recording with its track column verified against the positions, repaired or left out.

    A known defect of published tracks is the direction in one signed byte: 232 deg has become -24. It is recognised by
    its values (-128 to 127) and by agreeing with the course over ground when 256 is added where needed.
    """
    if recording.track is None:
        return recording, []
    north, east = increments(recording)
    course = np.full(len(recording), np.nan)
    both = measured[1:] & measured[:-1] & (np.hypot(north, east) / np.diff(recording.time) > MOVING)
    course[1:][both] = np.arctan2(east, north)[both]
    known = np.isfinite(course) & np.isfinite(recording.track)
    if known.sum() < 10:
        return recording, []
    share = np.mean(np.abs(wrap(recording.track - course))[known] < COURSE_AGREES)
    if share >= 0.8:
        return recording, []
    degrees = np.round(np.degrees(recording.track))
    low = degrees % 256.0
    certain = low >= 104.0  # 104 + 256 = 360: here only one direction has this byte
    byte = bool(np.all((degrees[np.isfinite(degrees)] >= -128) & (degrees[np.isfinite(degrees)] <= 127)))
    direct = np.radians(low)
    test = known & certain
    if byte and test.sum() >= 10 and np.mean(np.abs(wrap(direct - course))[test] < COURSE_AGREES) >= 0.8:
        other = np.radians(low + 256.0)
        with np.errstate(invalid="ignore"):
            choose_other = ~certain & (np.abs(wrap(other - course)) < np.abs(wrap(direct - course)))
        track = np.where(choose_other, other, direct)
        track[~certain & ~np.isfinite(course)] = np.nan
        sentence = (
            "track_deg holds the direction in one signed byte (232 has become -24); it was repaired with the course "
            "over ground from the positions"
        )
        return replace(recording, track=track), [sentence]
    sentence = f"track_deg agrees with the positions in only {100 * share:.0f} % of the rows; the column is not used"
    return replace(recording, track=None), [sentence]
