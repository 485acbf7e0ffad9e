"""Names that stand for several signals: arrays, bundles, components and patterns."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.values import group


def is_pattern(name: str) -> bool:
    """Whether a name has wildcards; brackets are those of arrays."""
    return any(sign in name for sign in "*?")


def stands_for(name: str, signal: str) -> bool:
    """Whether a name means a signal: "imu", "imu.reading.rate" and "*.rate[1]" all mean "imu.reading.rate[1]"."""
    if is_pattern(name):
        return fnmatchcase(signal, name.replace("[", "[[]"))
    return bool(group([signal], name))


def chosen(signals: Sequence[str], names: Iterable[str], where: str) -> list[str]:
    """The signals that are meant by names, in the order of the names; a name that means none is an error."""
    found: dict[str, None] = {}
    for name in names:
        meant = [signal for signal in signals if stands_for(name, signal)]
        if name in signals:  # and not also those that begin with it
            meant = [name]
        if not meant:
            parts = (re.split(r"(?=[.\[])", signal) for signal in signals)
            bases = {"".join(p[: i + 1]) for p in parts for i in range(len(p))}
            raise NavfmuError(f"{where}: there is no signal '{name}'{nearest(name, sorted(bases))}")
        found |= dict.fromkeys(meant)
    return list(found)
