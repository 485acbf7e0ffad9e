"""The panels of a run as a short text that a browser unpacks: thinned out, in 16 bits, deflated, in base 64.

Unpacked it is one line of JSON, then the columns one after the other: of each all low bytes of the differences between
neighbours, then all high bytes. A value is ``offset + step * number``; the number -32768 is none (NaN, infinity).
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from navfmu.report.panel import Curve, Panel

NONE = -32768
LARGEST = 32767
ALL = 800  # points up to which nothing is thinned out
LEVEL = 9  # of compression


def packed(panels: Sequence[Panel], about: dict[str, Any], stretches: int) -> str:
    """The text; ``about`` is any plain data beside them. ``stretches``: see :func:`kept`."""
    sampled = [curve for panel in panels for curve in panel.curves if curve.sampled]
    points = kept([curve.y for curve in sampled if curve.peaks], len(sampled[0].x), stretches) if sampled else None
    columns: dict[int, int] = {}
    heads, bodies, sources = [], [], []

    def column(values: np.ndarray, curve: Curve) -> int:
        if id(values) not in columns:
            columns[id(values)] = len(heads)
            sources.append(values)  # an id is one's own only as long as there is its owner
            head, body = _encoded(np.asarray(values, np.float64)[points if curve.sampled else slice(None)])
            heads.append(head)
            bodies.append(body)
        return columns[id(values)]

    drawn = [
        {
            "title": panel.title,
            "x": panel.x,
            "y": panel.y,
            "timed": panel.timed,
            "equal": panel.equal,
            "curves": [
                {
                    "name": curve.name,
                    "x": column(curve.x, curve),
                    "y": column(curve.y, curve),
                    "look": curve.look,
                    "colour": curve.colour,
                    "texts": list(curve.texts),
                    "symbol": curve.symbol,
                }
                for curve in panel.curves
            ],
        }
        for panel in panels
    ]
    head = json.dumps(about | {"panels": drawn, "columns": heads}, allow_nan=False, separators=(",", ":"))
    return base64.b64encode(zlib.compress(head.encode() + b"\n" + b"".join(bodies), LEVEL)).decode()


def kept(peaks: Sequence[np.ndarray], count: int, stretches: int) -> np.ndarray:
    """Which of ``count`` points are kept: all of up to ``ALL``.

    Of more, each of so many ``stretches`` of equal length keeps its first and last point and, of each of the ``peaks``
    (shape (count,)), the least, the greatest and the first that is no number.
    """
    if count <= ALL or stretches >= count:
        return np.arange(count)
    found: set[int] = {count - 1}
    edges = np.linspace(0, count, stretches + 1).astype(int)
    for first, end in pairwise(edges):
        found |= {int(first), int(end) - 1}
        for values in peaks:
            part = np.asarray(values[first:end], np.float64)
            finite = np.isfinite(part)
            if finite.any():
                found.add(int(first + np.argmin(np.where(finite, part, np.inf))))
                found.add(int(first + np.argmax(np.where(finite, part, -np.inf))))
            if not finite.all():
                found.add(int(first + np.argmin(finite)))
    return np.array(sorted(found))


def _encoded(values: np.ndarray) -> tuple[list[float], bytes]:
    """[length, offset, step] and the bytes of a column."""
    finite = np.isfinite(values)
    some = np.clip(values[finite], -1e300, 1e300)
    low, high = (float(some.min()), float(some.max())) if some.size else (0.0, 0.0)
    whole = bool(np.all(some == np.rint(some))) and high - low <= 2 * LARGEST
    step = 1.0 if whole else high / (2 * LARGEST) - low / (2 * LARGEST)
    offset, step = (low + LARGEST * step, step) if step > 0 else (low, 1.0)
    numbers = np.full(len(values), NONE, np.int32)
    numbers[finite] = np.clip(np.rint((some - offset) / step), -LARGEST, LARGEST)
    differences = np.diff(numbers, prepend=0).astype(np.uint16)
    return [len(values), offset, step], (differences & 0xFF).astype(np.uint8).tobytes() + (differences >> 8).astype(
        np.uint8
    ).tobytes()


def unpacked(text: str) -> tuple[dict[str, Any], list[np.ndarray]]:
    """What was packed, and its columns; the twin of what the page's script does."""
    head, _, body = zlib.decompress(base64.b64decode(text)).partition(b"\n")
    about, columns, place = json.loads(head), [], 0
    for length, offset, step in about["columns"]:
        low = np.frombuffer(body, np.uint8, length, place).astype(np.uint16)
        high = np.frombuffer(body, np.uint8, length, place + length).astype(np.uint16)
        numbers = np.cumsum(low | (high << 8), dtype=np.uint16).astype(np.int16)
        columns.append(np.where(numbers == NONE, np.nan, offset + step * numbers.astype(np.float64)))
        place += 2 * length
    return about, columns
