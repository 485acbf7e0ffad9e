"""Even power series: tuples of the coefficients of the powers 0, 2, 4 ... of the variable.

Those made here have fractions, so they are exact; :func:`product` and :func:`quotient` take any numbers.
"""

from __future__ import annotations

from fractions import Fraction
from math import factorial

Series = tuple
TERMS = 8
"""How many powers are kept: up to the 14th, enough for algorithms of order 12."""


def sinc(k: int | Fraction) -> Series:
    """Return sin(k a) / (k a)."""
    return tuple(Fraction(-1) ** n * Fraction(k) ** (2 * n) / factorial(2 * n + 1) for n in range(TERMS))


def cosine(k: int | Fraction) -> Series:
    """Return cos(k a)."""
    return tuple(Fraction(-1) ** n * Fraction(k) ** (2 * n) / factorial(2 * n) for n in range(TERMS))


def product(first: Series, second: Series) -> Series:
    """Return the product, cut to the powers that both have."""
    return tuple(sum(first[i] * second[n - i] for i in range(n + 1)) for n in range(min(len(first), len(second))))


def quotient(first: Series, second: Series) -> Series:
    """Return the series that gives ``first`` when it is multiplied by ``second``, whose first term is not 0."""
    found: list = []
    for n in range(min(len(first), len(second))):
        found.append((first[n] - sum(found[i] * second[n - i] for i in range(n))) / second[0])
    return tuple(found)


def solve(rows: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Return x with rows x = right, by elimination; the rows are independent."""
    count = len(right)
    table = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for i in range(count):
        pivot = next(k for k in range(i, count) if table[k][i])
        table[i], table[pivot] = table[pivot], table[i]
        table[i] = [x / table[i][i] for x in table[i]]
        for k in range(count):
            if k != i:
                table[k] = [x - table[k][i] * y for x, y in zip(table[k], table[i], strict=True)]
    return [row[-1] for row in table]
