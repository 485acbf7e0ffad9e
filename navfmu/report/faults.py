"""Faults as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

HEADINGS = ("fault", "target", "type", "time, s")
OWN = ("id", "target", "type", "start", "duration", "fmea", "description", "file")  # the other entries are its values


def cells(fault: Mapping[str, Any]) -> list[str]:
    """What ``HEADINGS`` names, of a fault's description as plain data."""
    values = ", ".join(f"{key} = {value}" for key, value in fault.items() if key not in OWN)
    start = fault["start"]
    when = f"{start:g} to {start + fault['duration']:g}" if "duration" in fault else f"from {start:g}"
    target = fault["target"] if isinstance(fault["target"], str) else ", ".join(fault["target"])
    return [fault["id"], target, fault["type"] + (f" ({values})" if values else ""), when]
