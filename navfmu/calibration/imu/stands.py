"""Stands of an inertial unit: the means of its readings where it rests, or turns steadily on a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.ndimage import median_filter

from navfmu.calibration.allan.sensor import GYRO, SENSORS
from navfmu.calibration.allan.stretches import FEWEST, SHORTEST, quiet
from navfmu.calibration.columns import Columns, opened
from navfmu.calibration.imu.earth import gravity, rotation_n, to_body
from navfmu.calibration.times import GAP, TIME, usual
from navfmu.errors import NavfmuError
from navfmu.recorded.replay.asked import check_turn, turn
from navfmu.recorded.replay.file import File

SPIKE = 10.0
"""A sample this many sigma off the median of itself and two neighbours on either side is no reading."""
NORMAL = 2.03
"""Sigma of normal numbers over the median of their distances from such a median."""
STEADY = 0.01
"""Without a table, a stand whose rate is this far from that of most, rad/s, is a turn: three times what a sensitivity
of 0.1 deg/s/g makes of a unit turned upside down."""
DEAD = 0.04
"""Share of seconds without any change of a reading, at most."""
PLAUSIBLE = 0.1
"""Share of gravity by which a mean specific force may be larger or smaller."""
ANGLES = ("roll", "pitch", "heading")
TABLE_RATE = "table_rate"
QUANTITIES = {
    TIME: (1, "s"),
    **{sensor.quantity: (3, sensor.unit) for sensor in SENSORS},
    **{angle: (1, "rad") for angle in ANGLES},
    TABLE_RATE: (1, "rad/s"),
}


@dataclass(frozen=True)
class Stands:
    """Means (stands, 3) of what gyros and accelerometers read, rad/s and m/s2, and of what was there, in b.

    ``true_rate`` and ``true_force`` are None where no attitude was told; then the size of the specific force is known,
    ``gravity`` m/s2. ``begin`` and ``seconds`` (stands,) say when, and how long.
    """

    source: str
    begin: np.ndarray
    seconds: np.ndarray
    rate: np.ndarray
    specific_force: np.ndarray
    gravity: float
    true_rate: np.ndarray | None = None
    true_force: np.ndarray | None = None
    sentences: tuple[str, ...] = ()


def stands(
    path: str | Path,
    latitude: float,
    altitude: float = 0.0,
    columns: Mapping[str, tuple[str, ...]] | None = None,
    units: Mapping[str, str] | None = None,
    axes: tuple[str, ...] = ("x", "y", "z"),
) -> Stands:
    """Read a table of samples; ``latitude`` rad and ``altitude`` m say where the unit stood, ``axes`` which axes of the
    file are forward, right, down.

    With the columns roll, pitch and heading, in rad, of a table that a unit stands on, and perhaps table_rate, rad/s
    about the vertical, down, what was there is known, else its size.
    """
    check_turn(axes, "--axes")
    file = opened(path, "rate_x")
    found = Columns(file, QUANTITIES, columns or {}, units or {})
    time = found.values(TIME)
    to_frd = turn(axes, "--axes")
    samples = np.hstack([found.values(sensor.quantity) @ to_frd.T for sensor in SENSORS])
    told = any(map(found.has, (*ANGLES, TABLE_RATE)))
    angles = np.stack([found.values(angle) for angle in ANGLES], axis=1) if told else np.zeros((len(time), 3))
    turning = found.values(TABLE_RATE) if found.has(TABLE_RATE) else np.zeros(len(time))
    period, interval = usual(file, time), np.diff(time)
    _check_alive(file, samples, period)
    smooth, wrong = _without_spikes(samples)
    parts = _pieces(smooth, interval, period, np.column_stack([angles[:, :2], turning]), angles[:, 2])
    here = gravity(latitude, altitude)
    sentences = list(file.told)
    if not told:
        parts, turns = _resting(samples, parts)
        if turns:
            sentences.append(f"{turns} steady turns are left out: {TABLE_RATE} and {', '.join(ANGLES)} would tell them")
    if not parts:
        raise NavfmuError(
            f"{file.path}: nothing is at rest for {SHORTEST} s in these {time[-1] - time[0]:.0f} s; expected a unit "
            "that stands in several attitudes, one after the other"
        )
    spikes = sum(int(wrong[part].sum()) for part in parts)
    if spikes:
        sentences.append(f"{spikes} samples are left out: they are {SPIKE:g} sigma off their neighbours")
    means = np.array([[np.mean(samples[part][~wrong[part]], axis=0)] for part in parts])[:, 0]
    rate, force = means[:, :3], means[:, 3:]
    _check_plausible(file, force, here)
    lengths = np.array([(part.stop - part.start) * period for part in parts])
    sentences.append(f"{len(parts)} stands of {lengths.min():.0f} to {lengths.max():.0f} s")
    begin = time[[part.start for part in parts]]
    if not told:
        _check_rates(file, rate)
        return Stands(file.path, begin, lengths, rate, force, here, sentences=tuple(sentences))
    acting = [_acting(angles[part], turning[part], latitude, here) for part in parts]
    true_rate, true_force = (np.array(one) for one in zip(*acting, strict=True))
    _check_rates(file, rate - true_rate)
    _check_told(file, force, true_force, here)
    return Stands(file.path, begin, lengths, rate, force, here, true_rate, true_force, tuple(sentences))


def _check_alive(file: File, samples: np.ndarray, period: float) -> None:
    """Refuse columns that often do not change for a second: where they rest is not to be seen then."""
    second = max(FEWEST, round(1.0 / period))
    whole = samples[: len(samples) // second * second].reshape(-1, second, samples.shape[1])
    dead = np.mean(np.ptp(whole, axis=1) == 0.0, axis=0)
    worst = int(np.argmax(dead))
    if dead[worst] > DEAD:
        raise NavfmuError(
            f"{file.path}: {SENSORS[worst // 3].quantity} {'xyz'[worst % 3]} does not change in "
            f"{100.0 * dead[worst]:.0f} % of the seconds; expected noise that neither the range of the sensor cuts off "
            "nor its resolution hides"
        )


def _without_spikes(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Samples with medians in the place of spikes, and the rows (n,) that have one."""
    middle = median_filter(samples, size=(5, 1), mode="nearest")
    off = np.abs(samples - middle)
    half = np.median(off, axis=0)
    sigma = np.where(half > 0.0, NORMAL * half, np.std(off, axis=0))
    spike = off > SPIKE * sigma
    return np.where(spike, middle, samples), np.any(spike, axis=1)


def _pieces(
    samples: np.ndarray, interval: np.ndarray, period: float, told: np.ndarray, heading: np.ndarray
) -> list[slice]:
    """Quiet stretches in which what is ``told`` (n, 3) stays, and the heading, too, where the table does not turn."""
    turning = told[1:, 2] != 0.0
    changed = np.any(np.diff(told, axis=0) != 0.0, axis=1) | (~turning & (np.diff(heading) != 0.0))
    edges = [0, *(np.flatnonzero(changed | (interval > GAP * period)) + 1).tolist(), len(samples)]
    return [
        slice(first + part.start, first + part.stop)
        for first, last in pairwise(edges)
        for part in quiet(samples[first:last], period)
    ]


def _resting(samples: np.ndarray, parts: list[slice]) -> tuple[list[slice], int]:
    """Those parts that turn as most do, which is not at all, and how many others there are."""
    if not parts:
        return parts, 0
    rates = np.array([samples[part, :3].mean(axis=0) for part in parts])
    still = np.linalg.norm(rates - np.median(rates, axis=0), axis=1) < STEADY
    return [part for part, one in zip(parts, still, strict=True) if one], int(np.sum(~still))


def _acting(angles: np.ndarray, turning: np.ndarray, latitude: float, here: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean rate and specific force in b (3,) of attitudes (n, 3) on a table that turns about the vertical."""
    to_b = to_body(*angles.T)
    rate_n = rotation_n(latitude) + np.multiply.outer(turning, [0.0, 0.0, 1.0])
    return np.einsum("nij,nj->ni", to_b, rate_n).mean(axis=0), to_b.mean(axis=0) @ [0.0, 0.0, -here]


def _check_plausible(file: File, force: np.ndarray, here: float) -> None:
    sizes = np.linalg.norm(force, axis=1)
    worst = float(sizes[np.argmax(np.abs(sizes / here - 1.0))])
    if abs(worst / here - 1.0) > PLAUSIBLE:
        raise NavfmuError(
            f"{file.path}: the specific force of a stand is {worst:.4g} m/s2; expected {here:.4g} within a tenth; name "
            "the unit of the file, as in --unit specific_force=g"
        )


def _check_rates(file: File, off: np.ndarray) -> None:
    worst, most = float(np.max(np.linalg.norm(off, axis=1))), GYRO.plausible[1]
    if worst > most:
        raise NavfmuError(
            f"{file.path}: a rate is {worst:.3g} rad/s off the true one; expected {most:g} at most; name the unit of "
            "the file, as in --unit rate=deg/s, or --unit table_rate=deg/s"
        )


def _check_told(file: File, force: np.ndarray, true: np.ndarray, here: float) -> None:
    off = np.degrees(np.arccos(np.clip(np.sum(force * true, axis=1) / np.linalg.norm(force, axis=1) / here, -1.0, 1.0)))
    if off.max() > 20.0:
        raise NavfmuError(
            f"{file.path}: a specific force is {off.max():.0f} degrees off the one of its roll and pitch; expected 20 "
            "at most: axes forward, right, down, at rest (0, 0, -9.8), and --unit roll=deg --unit pitch=deg --unit "
            "heading=deg where angles are degrees"
        )
