"""Loops whose count is a value: ``repeat(function, value, count, most)``."""

from navfmu.repetition.repeat import outside, repeat

__all__ = ["outside", "repeat"]
