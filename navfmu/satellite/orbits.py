"""Orbits and clocks of satellites as a table that FMUs read: a row for each ephemeris, almanac entries being some."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from navfmu.errors import NavfmuError
from navfmu.files.numbers import label
from navfmu.satellite.calendar import DAY, WEEK, first_day
from navfmu.satellite.lines import Lines

SATELLITES = 32
APART = 1e4
"""Weeks between the places of one satellite and of the next."""
COLUMNS = (
    ("place", "1"),
    ("prn", "1"),
    ("toe_week", "1"),
    ("toe", "s"),
    ("semi_major_axis", "m"),
    ("eccentricity", "1"),
    ("inclination", "rad"),
    ("node", "rad"),
    ("perigee", "rad"),
    ("mean_anomaly", "rad"),
    ("node_rate", "rad/s"),
    ("inclination_rate", "rad/s"),
    ("mean_motion_difference", "rad/s"),
    ("cuc", "rad"),
    ("cus", "rad"),
    ("crc", "m"),
    ("crs", "m"),
    ("cic", "rad"),
    ("cis", "rad"),
    ("toc_week", "1"),
    ("toc", "s"),
    ("clock_bias", "s"),
    ("clock_drift", "1"),
    ("clock_drift_rate", "1/s"),
    ("group_delay", "s"),
    ("accuracy", "m"),
    ("health", "1"),
    ("issue", "1"),
    ("sent_week", "1"),
    ("sent", "s"),
    ("limit", "s"),
)
"""(name, unit); what they mean, and from which point in time they count, IS-GPS-200 table 20-III says. ``place`` is
10 000 prn + week + second / 604800 of t_oe, by which rows are found; ``limit`` is how far from t_oe they hold."""
RANGES = {
    "prn": (1, SATELLITES),
    "toe": (0.0, WEEK - 1e-9),
    "sqrt_a": (5000.0, 5300.0),
    "eccentricity": (0.0, 0.1),
    "inclination": (0.6, 1.3),
    "node": (-6.4, 6.4),
    "perigee": (-6.4, 6.4),
    "mean_anomaly": (-6.4, 6.4),
    "node_rate": (-1e-7, 1e-7),
    "inclination_rate": (-1e-7, 1e-7),
    "mean_motion_difference": (-1e-7, 1e-7),
    **dict.fromkeys(("cuc", "cus", "cic", "cis"), (-1e-4, 1e-4)),
    **dict.fromkeys(("crc", "crs"), (-2000.0, 2000.0)),
    "clock_bias": (-0.01, 0.01),
    "clock_drift": (-1e-8, 1e-8),
    "clock_drift_rate": (-1e-12, 1e-12),
    "group_delay": (-1e-6, 1e-6),
    "accuracy": (0.0, 1e4),
    "health": (0, 255),
}
"""What an orbit of GPS can have; beyond it columns have shifted, or units are others."""


@dataclass(frozen=True)
class Orbits:
    """What a file of orbits holds.

    Attributes
    ----------
    rows : (n, columns) in the order of ``place``, one for each satellite and t_oe
    ionosphere : Klobuchar's alpha and beta, (2, 4) in s, s/semicircle ..., where the file has them
    remarks : what was done with what was found
    """

    source: str
    kind: str
    rows: np.ndarray
    ionosphere: np.ndarray | None = None
    remarks: tuple[str, ...] = ()

    def column(self, name: str) -> np.ndarray:
        """One column, (n,)."""
        return self.rows[:, [known for known, _ in COLUMNS].index(name)]

    def table(self) -> dict[str, np.ndarray]:
        """The columns as a file of numbers has them, label -> (n,)."""
        return {label(*column): numbers for column, numbers in zip(COLUMNS, self.rows.T, strict=True)}

    def sentences(self) -> list[str]:
        """What there is to say, for the user."""
        prn = np.unique(self.column("prn")).astype(int)
        at = self.column("toe_week") * WEEK + self.column("toe")
        ends = [at.min(), at.max()]
        dates = " to ".join(dict.fromkeys(map(moment, ends)))
        weeks = " to ".join(dict.fromkeys("week {:.0f}, {:.0f} s".format(*divmod(end, WEEK)) for end in ends))
        told = [f"{self.kind}: {len(self.rows)} orbit(s) of {len(prn)} satellite(s), {dates}, in GPS time {weeks}"]
        if gone := sorted(set(range(1, SATELLITES + 1)) - set(prn.tolist())):
            told.append(f"satellites that are not in the file: {', '.join(map(str, gone))}")
        if ill := np.unique(self.column("prn")[self.column("health") != 0]).astype(int).tolist():
            told.append(f"satellites that call themselves unhealthy: {', '.join(map(str, ill))}")
        return told + list(self.remarks)


def moment(seconds: float) -> str:
    """Seconds since GPS time began, for people: date and time of day, to a second."""
    week, second = divmod(round(float(seconds)), int(WEEK))
    days, rest = divmod(second, int(DAY))
    day = first_day(week)
    return f"{day.fromordinal(day.toordinal() + days)} {rest // 3600:02d}:{rest % 3600 // 60:02d}:{rest % 60:02d} GPS"


def check(lines: Lines, at: int, name: str, value: float) -> float:
    """Return a value that can be one of GPS."""
    low, high = RANGES.get(name, (-np.inf, np.inf))
    if not low <= value <= high:
        raise lines.wrong(at, f"{name} is {value:.10g}; expected {low:g} to {high:g}")
    return value


def orbits(
    lines: Lines,
    kind: str,
    found: Sequence[Mapping[str, float]],
    ionosphere: np.ndarray | None = None,
    remarks: Sequence[str] = (),
) -> Orbits:
    """Make the table: in the order of place, of two rows of one satellite and t_oe the one that was sent later."""
    if not found:
        raise NavfmuError(f"{lines.path}: holds no satellite of GPS; expected {lines.expected}")
    full = [{**row, "semi_major_axis": row["sqrt_a"] ** 2} for row in found]
    rows = np.array([[row.get(name, 0.0) for name, _ in COLUMNS] for row in full], float)
    names = [name for name, _ in COLUMNS]
    week, second = (rows[:, names.index(name)] for name in ("toe_week", "toe"))
    rows[:, 0] = APART * rows[:, names.index("prn")] + week + second / WEEK
    return _ordered(str(lines.path), kind, rows, ionosphere, [*lines.remarks, *remarks])


def joined(parts: Sequence[Orbits]) -> Orbits:
    """The orbits of several files, as of neighbouring days, in one table; the ionosphere is that of the last one."""
    known = [part.ionosphere for part in parts if part.ionosphere is not None]
    return _ordered(
        ", ".join(part.source for part in parts),
        ", ".join(dict.fromkeys(part.kind for part in parts)),
        np.concatenate([part.rows for part in parts]),
        known[-1] if known else None,
        [remark for part in parts for remark in part.remarks],
    )


def _ordered(source: str, kind: str, rows: np.ndarray, ionosphere: np.ndarray | None, remarks: Sequence[str]) -> Orbits:
    names = [name for name, _ in COLUMNS]
    sent = rows[:, names.index("sent_week")] * WEEK + rows[:, names.index("sent")]
    rows = rows[np.lexsort((sent, rows[:, 0]))]
    told = rows[:, [k for k, name in enumerate(names) if name not in ("sent_week", "sent")]]
    first = np.append(True, np.any(np.diff(told, axis=0), axis=1))  # it was known from then on
    if again := int(np.count_nonzero(~first)):
        remarks = [*remarks, f"{again} orbit(s) are left out: they were sent before"]
    rows = rows[first]
    last = np.append(np.diff(rows[:, 0]) > 0.0, True)
    if gone := int(np.count_nonzero(~last)):
        remarks = [
            *remarks,
            f"{gone} orbit(s) are left out: for the same time of the same satellite one was sent later",
        ]
    return Orbits(source, kind, rows[last], ionosphere, tuple(remarks))
