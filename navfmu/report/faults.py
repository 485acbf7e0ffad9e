"""Faults as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

HEADINGS = ("fault", "target", "type", "time")
TIMES = ("start", "duration", "when", "during", "hold")
OWN = ("id", "target", "type", *TIMES, "fmea", "description", "file")  # the other entries are its values


def cells(fault: Mapping[str, Any]) -> list[str]:
    """What ``HEADINGS`` names, of a fault's description as plain data."""
    values = ", ".join(f"{key} = {value}" for key, value in fault.items() if key not in OWN)
    target = fault["target"] if isinstance(fault["target"], str) else ", ".join(fault["target"])
    return [fault["id"], target, fault["type"] + (f" ({values})" if values else ""), _time(fault)]


def _time(fault: Mapping[str, Any]) -> str:
    """When it acts."""
    start, duration = fault["start"], fault.get("duration")
    held = f" has held for {fault['hold']:g} s" if fault.get("hold") else ""
    if "when" in fault:
        after = f"from {start:g} s on, " if start else ""
        return f"{after}once {fault['when']}{held}" + (f", for {duration:g} s" if duration else "")
    window = f"{start:g} to {start + duration:g} s" if duration else f"from {start:g} s"
    if "during" in fault:
        return f"{window}, while {fault['during']}{held}" if start or duration else f"while {fault['during']}{held}"
    return window
