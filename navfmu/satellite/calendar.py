"""GPS time and the calendar: weeks since 1980-01-06 and seconds of the week, without leap seconds."""

from __future__ import annotations

from datetime import date, timedelta

from navfmu.errors import NavfmuError

WEEK = 604800.0
DAY = 86400.0
START = date(1980, 1, 6)
ROLLOVER = 1024
"""A satellite tells its week modulo this."""
LAST = 10_000
"""Weeks from here on are none: it is the year 2171."""
CLOSE = 26
"""Weeks between an almanac and the date it is wanted for, at most: older ones are taken for a wrong rollover."""
LEAPS = (
    "1981-07 1982-07 1983-07 1985-07 1988-01 1990-01 1991-01 1992-07 1993-07 1994-07 1996-01 1997-07 1999-01 2006-01 "
    "2009-01 2012-07 2015-07 2017-01"
).split()
"""Months since whose first day UTC is one more second behind GPS time (bulletin C of the IERS)."""


def gps_time(day: date, seconds: float) -> tuple[int, float]:
    """Return week and second of the week of so many seconds after the beginning of a day."""
    weeks, days = divmod((day - START).days, 7)
    return weeks, days * DAY + seconds


def first_day(week: int) -> date:
    """Return the Sunday on which a week begins."""
    return START + timedelta(weeks=week)


def leap_seconds(day: date) -> int:
    """Return by how many seconds UTC is behind GPS time."""
    return sum(day >= date.fromisoformat(f"{month}-01") for month in LEAPS)


def full_week(week: int, near: date | None, what: str) -> int:
    """Return the week without rollover that a week modulo 1024, or a full one, is near a date.

    Refused are a week below 1024 without a date, and a week too far from the date to be meant; ``what`` (the file and
    the line) begins the sentence.
    """
    if not 0 <= week < LAST:
        raise NavfmuError(f"{what}: the week is {week}; expected 0 to {LAST - 1}")
    if near is None:
        if week >= ROLLOVER:
            return week
        dates = ", ".join(f"{w} ({first_day(w)})" for w in _turns(week))
        raise NavfmuError(
            f"{what}: week {week} is counted modulo {ROLLOVER}, it may be {dates}; expected a date near it"
        )
    wanted, _ = gps_time(near, 0.0)
    found = min([week] if week >= ROLLOVER else _turns(week), key=lambda w: abs(w - wanted))
    if abs(found - wanted) > CLOSE:
        raise NavfmuError(
            f"{what}: week {week}{f', taken as {found},' if found != week else ''} began on {first_day(found)}, "
            f"{abs(found - wanted)} weeks from {near}; expected at most {CLOSE}"
        )
    return found


def _turns(week: int) -> range:
    return range(week, week + 3 * ROLLOVER, ROLLOVER)
