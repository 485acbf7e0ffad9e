"""How a thread calculates with doubles: a run does so in the ordinary way, whatever FMUs and other libraries do.

Ordinary is: rounded to the nearest, subnormal numbers kept, no trap. The C loop sees to it after each call to an FMU
(source/floating.h), and this file around the calls that are made from Python.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from navfmu.engine.loading import engine_library
from navfmu.engine.plan import Plan
from navfmu.engine.structures import STRAYS


@contextmanager
def ordinary() -> Iterator[None]:
    """Inside, this thread calculates in the ordinary way; afterwards as before."""
    library = engine_library()
    before = library.floating_now()
    library.make_ordinary()
    try:
        yield
    finally:
        library.put_back(before)


def make_ordinary() -> int:
    """From now on this thread calculates in the ordinary way; returns in what it did not (a sum of ``STRAYS``)."""
    return engine_library().make_ordinary()


def strayed(plan: Plan, changes: Sequence[int]) -> list[str]:
    """The sentences for components that changed how their thread calculates; ``changes`` are sums of ``STRAYS``."""
    sentences = []
    for part, change in zip(plan.parts, changes, strict=True):
        if change:
            what = " and ".join(words for number, words in STRAYS.values() if change & number)
            sentences.append(f"component '{part.component.name}' changed {what}: put back after each of its calls")
    return sentences
