"""Derivatives of the elements of an array: a sparse matrix whose pattern is constant.

Which element depends on which element of x follows from the text of a function, not from values. So what is surely zero
is neither stored nor calculated, and a run with floats does the operations that are recorded when the same text is
traced: the entries may be floats or traced values, the pattern is always known.
"""

from __future__ import annotations

from functools import cached_property, reduce
from typing import Any

import numpy as np
from numpy import concatenate, full, zeros


class Slopes:
    """Derivatives of an array's elements, taken row by row, by the elements of x.

    Parameters
    ----------
    pattern
        Which element depends on which element of x, truth values of shape (elements, size of x).
    entries
        The derivatives where ``pattern`` holds, row by row, shape (number of them,).
    """

    def __init__(self, pattern: np.ndarray, entries: Any) -> None:
        self.pattern, self.entries = pattern, entries

    @classmethod
    def none(cls, elements: int, columns: int) -> Slopes:
        """Of elements that do not depend on x."""
        return cls(zeros((elements, columns), bool), zeros(0))

    @classmethod
    def joined(cls, parts: list[Slopes]) -> Slopes:
        """Of the elements of several arrays, one array after the other."""
        if len(parts) == 1:
            return parts[0]
        filled = [part.entries for part in parts if part.entries.size]
        entries = concatenate(filled) if filled else zeros(0)
        return cls(concatenate([part.pattern for part in parts]), entries)

    @classmethod
    def chosen(cls, condition: Any, first: Slopes, second: Slopes) -> Slopes:
        """Those of the ``first`` elements where a condition holds (one for each element, or for all), else of the
        ``second``."""
        pattern = first.pattern | second.pattern
        held = condition if np.ndim(condition) == 0 else condition[pattern.nonzero()[0]]
        return cls(pattern, np.where(held, first._on(pattern), second._on(pattern)))

    @cached_property
    def places(self) -> np.ndarray:
        """Where the derivatives are in ``entries``; at those that are zero stands what is behind the last of them."""
        places = full(self.pattern.shape, self.entries.size)
        places[self.pattern] = range(self.entries.size)
        return places

    @cached_property
    def elements(self) -> np.ndarray:
        """The elements that depend on x."""
        return self.pattern.any(axis=1).nonzero()[0]

    def _on(self, pattern: np.ndarray) -> Any:
        """The entries of a pattern that holds this one, zeros included."""
        if self.entries.size == np.count_nonzero(pattern):
            return self.entries
        return concatenate([self.entries, zeros(1)])[self.places[pattern]]

    def dense(self) -> Any:
        """The full matrix, shape (elements, size of x)."""
        return concatenate([self.entries, zeros(1)])[self.places]

    def moved(self, sources: np.ndarray) -> Slopes:
        """Of elements that are copies of those at ``sources``, counted from 1; 0 is a constant."""
        pattern = concatenate([zeros((1, self.pattern.shape[1]), bool), self.pattern])[sources]
        taken = self.places[(sources - 1)[:, None], range(self.pattern.shape[1])][pattern]
        return Slopes(pattern, self.entries[taken])

    def scaled(self, factor: Any) -> Slopes:
        """Times a number, or times one for each of ``elements``."""
        if isinstance(factor, float) and abs(factor) == 1.0:
            return self if factor > 0.0 else Slopes(self.pattern, -self.entries)
        if np.ndim(factor):
            counts = self.pattern.sum(axis=1)[self.elements]
            factor = factor if (counts == 1).all() else factor[np.arange(len(counts)).repeat(counts)]
        return Slopes(self.pattern, factor * self.entries)

    def __add__(self, other: Slopes) -> Slopes:
        if np.array_equal(self.pattern, other.pattern):
            return Slopes(self.pattern, self.entries + other.entries)
        both = self.pattern & other.pattern
        pools = [self.entries, other.entries]
        if both.any():
            pools.append(self.entries[self.places[both]] + other.entries[other.places[both]])
        pattern, first, second = self.pattern | other.pattern, self.entries.size, other.entries.size
        places = zeros(pattern.shape, int)
        places[self.pattern] = range(first)
        places[other.pattern] = range(first, first + second)
        places[both] = range(first + second, first + second + np.count_nonzero(both))
        return Slopes(pattern, concatenate(pools)[places[pattern]])

    def summed(self, groups: np.ndarray, count: int) -> Slopes:
        """Of ``count`` sums over elements; ``groups`` says for each element to which sum it goes.

        Each sum goes from the first term to the last.
        """
        columns = self.pattern.shape[1]
        element, column = self.pattern.nonzero()
        target = groups[element] * columns + column
        pattern = zeros(count * columns, bool)
        pattern[target] = True
        order = target.argsort(kind="stable")
        _, begins, terms = np.unique(target[order], return_index=True, return_counts=True)
        longest = (-terms).argsort(kind="stable")  # so the sums that have an n-th term stand first, for each n
        begins, terms = begins[longest], terms[longest]

        def added(sums: Any, n: int) -> Any:
            going_on = np.count_nonzero(terms > n)
            longer = sums[:going_on] + self.entries[order[begins[:going_on] + n]]
            return longer if going_on == len(terms) else concatenate([longer, sums[going_on:]])

        sums = reduce(added, range(1, terms.max(initial=0)), self.entries[order[begins]])
        return Slopes(pattern.reshape(count, columns), sums[longest.argsort()])
