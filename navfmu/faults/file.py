"""Reads a fault file: TOML with one ``[[fault]]`` table for each fault. Errors name the file and the line."""

from __future__ import annotations

import dataclasses
import math
import re
import tomllib
from pathlib import Path

from navfmu.errors import NavfmuError, nearest
from navfmu.faults.fault import COMMON, Fault, FaultError

TOP_LEVEL = ("fault", "description")


def load_faults(path: str | Path) -> list[Fault]:
    """The faults of a file, in its order."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise NavfmuError(f"fault file {path} does not exist") from None
    except UnicodeDecodeError:
        raise NavfmuError(f"fault file {path} cannot be read: it is not text in UTF-8") from None
    except OSError as error:
        raise NavfmuError(f"fault file {path} cannot be read: {error.strerror or error}") from None
    return parse_faults(text, str(path))


def parse_faults(text: str, name: str = "faults") -> list[Fault]:
    """The faults of a text; ``name`` is the file's name in messages."""
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NavfmuError(f"{name}: {_line_first(str(error))}") from None
    for key in document:
        if key not in TOP_LEVEL:
            hint = nearest(key, TOP_LEVEL)
            raise NavfmuError(f"{name}, line {_key_line(text, key)}: unknown entry '{key}'{hint} (expected [[fault]])")
    entries = document.get("fault", [])
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise NavfmuError(f"{name}, line {_key_line(text, 'fault')}: faults are written as tables [[fault]]")
    if not entries:
        raise NavfmuError(f"{name}: holds no fault; expected at least one table [[fault]]")
    tables = [number for number, line in enumerate(text.splitlines(), 1) if re.match(r"\s*\[\[\s*fault\s*\]\]", line)]
    faults: list[Fault] = []
    for index, entry in enumerate(entries):
        first = tables[index] if index < len(tables) else 1
        last = tables[index + 1] - 1 if index + 1 < len(tables) else len(text.splitlines())
        faults.append(_fault(entry, text, name, first, last))
        if faults[-1].id in {fault.id for fault in faults[:-1]}:
            line = _key_line(text, "id", first, last)
            raise NavfmuError(f"{name}, line {line}: the id '{faults[-1].id}' is already taken")
    return faults


def _fault(entry: dict, text: str, name: str, first: int, last: int) -> Fault:
    for key in ("id", "target", "type"):
        if key not in entry:
            label = f"fault '{entry['id']}'" if "id" in entry else "this fault"
            raise NavfmuError(f"{name}, line {first}: {label} has no '{key}'")
    parameters = {key: value for key, value in entry.items() if key not in COMMON}
    try:
        fault = Fault(
            id=entry["id"],
            target=entry["target"],
            type=entry["type"],
            start=entry.get("start", 0.0),
            duration=entry.get("duration", math.inf),
            parameters=parameters,
            fmea=str(entry.get("fmea", "")),
            description=str(entry.get("description", "")),
        )
    except FaultError as error:
        line = _key_line(text, error.key, first, last)
        raise FaultError(error.fault, f"{name}, line {line}", error.sentence, error.key) from None
    return dataclasses.replace(fault, where=f"{name}, line {first}")


def _key_line(text: str, key: str, first: int = 1, last: int | None = None) -> int:
    """Line on which a key is written, between two lines; the first of them if it is not found."""
    pattern = re.compile(rf"""\s*(\[+\s*)?["']?{re.escape(key)}["']?\s*(=|\]|\.)""")
    for number, line in enumerate(text.splitlines()[first - 1 : last], first):
        if pattern.match(line):
            return number
    return first


def _line_first(message: str) -> str:
    """ "Invalid value (at line 3, column 9)" -> "line 3, column 9: invalid value"."""
    found = re.fullmatch(r"(.*) \(at (.*)\)", message)
    if not found:
        return message
    sentence, place = found.groups()
    return f"{place}: {sentence[:1].lower()}{sentence[1:]}"
