"""RINEX navigation files, versions 2 to 4: the broadcast ephemerides of GPS, and Klobuchar's coefficients."""

from __future__ import annotations

import re

import numpy as np

from navfmu.satellite.calendar import ROLLOVER, WEEK, first_day, gps_time
from navfmu.satellite.header import Header, read_header
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import Orbits, check, orbits

KIND = "RINEX navigation"
FIELDS = (
    ("clock_bias", "clock_drift", "clock_drift_rate"),
    ("issue", "crs", "mean_motion_difference", "mean_anomaly"),
    ("cuc", "eccentricity", "cus", "sqrt_a"),
    ("toe", "cic", "node", "cis"),
    ("inclination", "crc", "perigee", "node_rate"),
    ("inclination_rate", "", "toe_week", ""),
    ("accuracy", "health", "group_delay", ""),
    ("sent",),
)
"""What stands in the lines of an ephemeris (RINEX 3.05 table A6, 2.11 table A4, and LNAV of 4.00); nobody asks for what
has no name."""
WIDTH = 19
LIMIT = 7200.0
"""An ephemeris holds for two hours before and after t_oe: they are fitted over four hours."""
CLOCK_STEP = 16.0
"""t_oc is a multiple of this, s: IS-GPS-200 table 20-I."""
UNKNOWN = 0.9999e9
"""A time of transmission that RINEX does not know."""
FAR = 43200.0
"""s between t_oc and t_oe, or between t_oe and transmission, that are taken for another week."""
SATELLITE = re.compile(r"([A-Z])[ \d]\d ")
TITLE = re.compile(r"> ([A-Z]{3}) ([A-Z])[ \d]{2} (\S+)")
"""What a message begins with in version 3, and in version 4, where a line tells its type, satellite and kind."""
EPHEMERIS, IONOSPHERE = ("G", "EPH G LNAV"), "ION G LNAV"
LENGTHS = {**dict.fromkeys(EPHEMERIS, len(FIELDS)), IONOSPHERE: 3}
"""Lines of the messages that are read."""


def read(lines: Lines) -> Orbits:
    """Read the ephemerides of GPS; other systems are left out."""
    header = read_header(lines, "N")
    found, others, counted = [], {}, 0
    ionosphere = _ionosphere(lines, header)
    at = header.end + 1
    while at <= len(lines):
        if not lines.line(at, "an ephemeris").strip():
            at += 1
            continue
        what, begin, at = _record(lines, at, header)
        if what in EPHEMERIS:
            row, modulo = _ephemeris(lines, begin, header)
            found.append(row)
            counted += modulo
        elif what == IONOSPHERE:
            ionosphere = _ionosphere_of_message(lines, begin)
        else:
            others[what] = others.get(what, 0) + 1
    remarks = [f"{number} message(s) of satellites {what} are left out" for what, number in others.items()]
    if counted:
        remarks.append(f"{counted} week(s) are counted modulo {ROLLOVER} in the file; their dates say which they are")
    return orbits(lines, KIND, found, ionosphere, remarks)


def _record(lines: Lines, at: int, header: Header) -> tuple[str, int, int]:
    """What begins in a line, the line of its first numbers, and the line behind it."""
    if header.version < 3.0:
        return EPHEMERIS[0], at, at + LENGTHS[EPHEMERIS[0]]
    text = lines.line(at, "an ephemeris")
    titled = header.version >= 4.0
    pattern, expected = (TITLE, "'> EPH G05 LNAV'") if titled else (SATELLITE, "a satellite, as in 'G05 '")
    if not (told := pattern.match(text)):
        raise lines.wrong(at, f"begins with '{text[:15].rstrip()}'; expected {expected}")
    what, begin = " ".join(told.groups()), at + titled
    if what in LENGTHS:
        return what, begin, begin + LENGTHS[what]
    behind = begin + 1
    while behind <= len(lines) and not pattern.match(lines.line(behind, "an ephemeris")):
        behind += 1
    return what, begin, behind


def _ephemeris(lines: Lines, at: int, header: Header) -> tuple[dict[str, float], bool]:
    """The row of an ephemeris, and whether its week was counted modulo 1024."""
    first = lines.line(at, "an ephemeris")
    old = header.version < 3.0
    prn = lines.whole(at, first[:2] if old else first[1:3], "the satellite")
    row = {"prn": check(lines, at, "prn", prn)}
    fields = first[2:22].split() if old else first[3:23].split()
    if len(fields) != 6:
        raise lines.wrong(at, f"the time is '{first[3:23].strip()}'; expected year, month, day, hour, minute, second")
    day, seconds = lines.instant(at, fields)
    for line, names in enumerate(FIELDS):
        text = lines.line(at + line, f"line {line + 1} of the {len(FIELDS)} of satellite {prn}")
        begin = (3 if old else 4) + (WIDTH if line == 0 else 0)
        for number, name in enumerate(names):
            value = text[begin + number * WIDTH :][:WIDTH]
            if name == "sent" and not value.strip():
                row[name] = UNKNOWN
            elif name:
                row[name] = check(lines, at + line, name, lines.number(at + line, value, f"{name} of satellite {prn}"))
    row["toc_week"], row["toc"] = gps_time(day, seconds)
    if row["toc"] % CLOCK_STEP:
        raise lines.wrong(
            at,
            f"the clock's time is {row['toc']:g} s of the week, no multiple of {CLOCK_STEP:g} s; expected GPS time "
            "(UTC is behind it by the leap seconds)",
        )
    modulo = _weeks(lines, at, row)
    row["limit"] = LIMIT
    return row, modulo


def _weeks(lines: Lines, at: int, row: dict[str, float]) -> bool:
    """Set the weeks of t_oe and transmission from that of the clock, which has a date."""
    told, prn = row["toe_week"], row["prn"]
    row["toe_week"] = row["toc_week"] + round((row["toc"] - row["toe"]) / WEEK)
    apart = (row["toe_week"] - row["toc_week"]) * WEEK + row["toe"] - row["toc"]
    if abs(apart) > FAR:
        raise lines.wrong(
            at + 3, f"t_oe of satellite {prn} is {apart / 3600.0:.1f} h from its clock's time; expected 12 at most"
        )
    off = (told - row["toe_week"] + ROLLOVER / 2) % ROLLOVER - ROLLOVER / 2
    if abs(off) > (min(row["toe"], WEEK - row["toe"]) <= LIMIT):  # near midnight writers do not agree on the week
        raise lines.wrong(
            at + 5,
            f"the week of satellite {prn} is {told:g}, but its clock's time is in week {row['toc_week']}, which began "
            f"on {first_day(row['toc_week'])}",
        )
    early = row["toe"] - row["sent"]
    early -= WEEK * round(early / WEEK)
    known = row["sent"] < UNKNOWN and abs(early) <= FAR
    sent = row["toe"] - (early if known else LIMIT)
    weeks = np.floor(sent / WEEK)
    row["sent_week"], row["sent"] = row["toe_week"] + weeks, sent - weeks * WEEK
    return off == 0 and told != row["toe_week"]


def _ionosphere(lines: Lines, header: Header) -> np.ndarray | None:
    """Klobuchar's alpha and beta, (2, 4), of a header."""
    if header.version < 3.0:
        pair = [header.one("ION ALPHA"), header.one("ION BETA")]
        begin = 2
    else:
        told = {text[:4]: (at, text) for at, text in header.all("IONOSPHERIC CORR")}
        pair = [told.get("GPSA"), told.get("GPSB")]
        begin = 5
    if None in pair:
        return None
    return np.reshape(
        [_coefficient(lines, at, text[begin + 12 * k :][:12]) for at, text in pair for k in range(4)], (2, 4)
    )


def _ionosphere_of_message(lines: Lines, at: int) -> np.ndarray:
    """The same of a message of version 4, where the eight follow each other behind a time, four in a line."""
    found = []
    for k in range(1, 9):
        text = lines.line(at + k // 4, "a message of the ionosphere")
        found.append(_coefficient(lines, at + k // 4, text[4 + WIDTH * (k % 4) :][:WIDTH]))
    return np.reshape(found, (2, 4))


def _coefficient(lines: Lines, at: int, text: str) -> float:
    return lines.number(at, text, "a coefficient of the ionosphere")
