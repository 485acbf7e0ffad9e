"""SEM almanacs: numbers in a fixed order, angles in semicircles, inclinations from 54 degrees."""

from __future__ import annotations

import math
import re
from datetime import date

from navfmu.satellite.almanac import entry
from navfmu.satellite.calendar import full_week
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import Orbits, orbits

KIND = "SEM almanac"
FIELDS = (
    ("prn",),
    ("number of the satellite",),
    ("index of accuracy",),
    ("eccentricity", "inclination", "node_rate"),
    ("sqrt_a", "node", "perigee"),
    ("mean_anomaly", "clock_bias", "clock_drift"),
    ("health",),
    ("configuration",),
)
"""Lines of a satellite (ICD-GPS-870, appendix 30)."""
SEMICIRCLES = ("inclination", "node_rate", "node", "perigee", "mean_anomaly")
FROM = 0.30
"""Semicircles that are to be added to the inclination."""


def is_sem(lines: Lines) -> bool:
    """Whether a file looks like one: a number of satellites and a name, then a week and a time."""
    text = [t for t in lines.text[:4] if t.strip()][:2]
    return (
        len(text) == 2
        and bool(re.match(r"\s*\d+\s+\S", text[0]))
        and bool(re.fullmatch(r"\s*\d+\s+[\d.]+\s*", text[1]))
    )


def read(lines: Lines, near: date | None) -> Orbits:
    """Read an almanac; ``near`` is a date by which its week is told from the same one 1024 weeks before or after."""
    told = [at for at, text in enumerate(lines.text, 1) if text.strip()]
    number = lines.whole(told[0], lines.text[told[0] - 1].split()[0], "the number of satellites")
    week, toa = lines.text[told[1] - 1].split()
    week = full_week(lines.whole(told[1], week, "the week"), near, f"{lines.path}, line {told[1]}")
    toa = lines.number(told[1], toa, "the time of applicability")
    rest = told[2:]
    if len(rest) != number * len(FIELDS):
        raise lines.wrong(
            rest[-1] if rest else told[1],
            f"there are {len(rest)} lines for {number} satellites that the file says it has; expected "
            f"{number * len(FIELDS)}",
        )
    found = []
    for k in range(number):
        values = {}
        for at, names in zip(rest[k * len(FIELDS) :], FIELDS, strict=False):
            texts = lines.text[at - 1].split()
            if len(texts) != len(names):
                raise lines.wrong(at, f"has {len(texts)} number(s); expected {', '.join(names)}")
            for name, text in zip(names, texts, strict=True):
                scale = math.pi if name in SEMICIRCLES else 1.0
                offset = FROM if name == "inclination" else 0.0
                values[name] = (lines.number(at, text, name) + offset) * scale
        if any(row["prn"] == values["prn"] for row in found):
            raise lines.wrong(rest[k * len(FIELDS)], f"satellite {values['prn']:g} comes again; expected each once")
        found.append(entry(lines, rest[k * len(FIELDS)], week, toa, values))
    return orbits(lines, KIND, found)
