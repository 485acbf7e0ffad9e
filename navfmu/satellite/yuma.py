"""YUMA almanacs: blocks of lines "name: value", one for each satellite."""

from __future__ import annotations

from datetime import date

from navfmu.satellite.almanac import entry
from navfmu.satellite.calendar import full_week
from navfmu.satellite.lines import Lines
from navfmu.satellite.orbits import Orbits, orbits

KIND = "YUMA almanac"
FIELDS = {
    "id": "prn",
    "health": "health",
    "eccentricity": "eccentricity",
    "time of applicability": "toa",
    "orbital inclination": "inclination",
    "rate of right ascen": "node_rate",
    "sqrt(a)": "sqrt_a",
    "right ascen at week": "node",
    "argument of perigee": "perigee",
    "mean anom": "mean_anomaly",
    "af0": "clock_bias",
    "af1": "clock_drift",
    "week": "week",
}
"""Names in the file, without units, and ours. "Right Ascen at Week" is a longitude at the week's beginning."""


def is_yuma(lines: Lines) -> bool:
    """Whether a file looks like one."""
    return any(text.strip().lower().startswith("id:") for text in lines.text[:10])


def read(lines: Lines, near: date | None) -> Orbits:
    """Read an almanac; ``near`` is a date by which its week is told from the same one 1024 weeks before or after."""
    found = []
    for first, block in _blocks(lines):
        if gone := [name for name, own in FIELDS.items() if own not in block]:
            raise lines.wrong(first, f"the satellite that begins here has no '{gone[0]}'; the block is cut off")
        values = {own: lines.number(at, text, own) for own, (at, text) in block.items()}
        at, told = block["week"]
        week = full_week(lines.whole(at, told, "the week"), near, f"{lines.path}, line {at}")
        toa = values["toa"]
        if any(row["prn"] == values["prn"] for row in found):
            raise lines.wrong(first, f"satellite {values['prn']:g} comes again; expected each once")
        found.append(entry(lines, first, week, toa, values))
    return orbits(lines, KIND, found)


def _blocks(lines: Lines) -> list[tuple[int, dict[str, tuple[int, str]]]]:
    """Blocks from one ID to the next: the number of the first line, and our name -> (line, text)."""
    blocks = []
    for at, text in enumerate(lines.text, 1):
        name, colon, value = text.partition(":")
        own = FIELDS.get(_bare(name))
        if own == "prn":
            blocks.append((at, {}))
        if not colon or own is None:
            if text.strip() and not text.lstrip().startswith("*"):
                raise lines.wrong(at, f"is '{text.strip()[:60]}'; expected one of {', '.join(FIELDS)}")
            continue
        if not blocks:
            raise lines.wrong(at, f"'{name.strip()}' comes before the first ID")
        if own in blocks[-1][1]:
            raise lines.wrong(at, f"'{name.strip()}' comes twice in the block of a satellite")
        blocks[-1][1][own] = (at, value)
    return blocks


def _bare(name: str) -> str:
    """A name without its unit: "Af0(s)" is "af0", "SQRT(A)  (m 1/2)" is "sqrt(a)"."""
    name = " ".join(name.lower().split())
    return "sqrt(a)" if name.startswith("sqrt(a)") else name.partition("(")[0].strip()
