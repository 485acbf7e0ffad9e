"""A calibration as a text for other programs."""

from __future__ import annotations

import json
from dataclasses import asdict

from navfmu.calibration.magnetometer.calibration import Calibration


def as_csv(found: Calibration) -> str:
    """Text with a header."""
    lines = [f"{row.name},{row.value:.6g},{row.sigma:.6g},{row.unit}" for row in found.rows]
    return "\n".join(["name,value,sigma,unit", *lines]) + "\n"


def as_json(found: Calibration) -> str:
    """One object: source and method, what there is to say, and the rows."""
    told = {"source": found.source, "method": found.method, "sentences": found.sentences}
    return json.dumps({**told, "values": [asdict(row) for row in found.rows]}, indent=2) + "\n"
