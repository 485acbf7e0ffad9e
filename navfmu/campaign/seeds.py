"""Seeds as people write them: "1-8", "1-4,10", or a list."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from navfmu.errors import NavfmuError


def parse_seeds(value: str | Sequence[int | str], error: Callable[[str], NavfmuError]) -> tuple[int, ...]:
    """Seeds from a list of numbers or a text such as "1-8" or "1-4,10"; ``error`` makes an error of a sentence."""
    seeds: list[int] = []
    for part in value.split(",") if isinstance(value, str) else value:
        if isinstance(part, int):
            seeds.append(part)
            continue
        found = re.fullmatch(r"\s*(\d+)\s*(?:-\s*(\d+)\s*)?", part)
        if found is None:
            raise error(f"'{part}' is not a seed; expected, for example, [1, 2, 3] or \"1-8\"")
        first, last = int(found[1]), int(found[2] or found[1])
        if last < first or last - first > 1_000_000:
            raise error(f"'{part.strip()}' is not a range of seeds; expected the lower first, a million at most")
        seeds += range(first, last + 1)
    if not seeds:
        raise error("no seeds are given")
    if len(set(seeds)) < len(seeds):
        raise error("a seed is given twice")
    for seed in seeds:
        if not 0 <= seed < 2**31:
            raise error(f"the seed {seed} is out of range: expected 0 to 2147483647")
    return tuple(seeds)


def seeds_text(seeds: Sequence[int]) -> str:
    """The seeds as ``parse_seeds`` reads them: runs of neighbours by their ends."""
    parts: list[list[int]] = []
    for seed in seeds:
        if parts and seed == parts[-1][1] + 1:
            parts[-1][1] = seed
        else:
            parts.append([seed, seed])
    return ",".join(f"{first}" if first == last else f"{first}-{last}" for first, last in parts)
