"""Drawn expressions: C computes what NumPy computes, for all that a model may contain and for every number.

The C code returns the result of every step of an expression, and NumPy repeats each step on the operands that C had: so
a difference belongs to one function and is not made larger by those that follow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from evidence.compiled import Compiled, linked
from evidence.drawn import Expression, Step, draw, inputs
from evidence.functions import NAMES, PLACES
from evidence.section import Section
from navfmu.report.claim import Claim
from navfmu.report.page import Page
from navfmu.terminal.progress import Progress

COUNT, SEED = 10_000, 1
BATCH = 250  # expressions in one library
DRAWS = 6  # of inputs, for each expression


@dataclass
class Found:
    """What a number of expressions showed."""

    expressions: int = 0
    numbers: int = 0  # compared
    places: float = 0.0  # units in the last place: the largest difference of library functions
    wrong: int = 0  # numbers of all other functions whose bits differ
    differences: list[str] = field(default_factory=list)  # in words, with the source

    def compare(self, expression: Expression, native: Compiled, rng: np.random.Generator) -> None:
        """Run the C code of an expression with some inputs, and repeat each of its steps."""
        self.expressions += 1
        steps = expression.steps
        starts = np.cumsum([0, *(math.prod(step.shape) for step in steps)])
        known = inputs(rng, DRAWS)  # and the results of the steps in C
        got, expected = np.empty((DRAWS, starts[-1])), np.empty((DRAWS, starts[-1]))
        with np.errstate(all="ignore"):
            for k, values in enumerate(known):
                got[k] = native(*values.values())
                for i, step in enumerate(steps):
                    place = slice(starts[i], starts[i + 1])
                    one = got[k, place].reshape(step.shape)
                    expected[k, place] = np.ravel(_repeated(step, values)) if _comparable(step, values) else one.ravel()
                    values[f"a{i}"] = one.astype(step.dtype)[()]
        self.numbers += got.size
        apart = distance(got, expected)
        for i, step in enumerate(steps):
            place = slice(starts[i], starts[i + 1])
            one = apart[:, place]
            if step.function.any_zero:
                one = np.where(got[:, place] == expected[:, place], 0.0, one)
            if step.function.places:
                self.places = max(self.places, float(np.max(one, initial=0.0)))
            else:
                self.wrong += np.count_nonzero(one)
            for k in np.flatnonzero(np.any(one > step.function.places, axis=1)):
                told = "".join(f"{name} = {known[k][name]!r}\n" for name in step.operands)
                result = f"C gives {got[k, place].tolist()}, NumPy {expected[k, place].tolist()}"
                self.differences.append(f"{expression.source(i)}\nwith\n{told}{result}")


def _repeated(step: Step, known: dict[str, Any]) -> Any:
    return eval(step.repeated, NAMES | {name: known[name] for name in step.operands})


def _comparable(step: Step, known: dict[str, Any]) -> bool:
    """Whether whole numbers stay where a double has them all: C has them in doubles, as FMI has 32 bits for them."""
    operands = {name: known[name] for name in step.operands}
    whole = {name: value.astype(float) for name, value in operands.items() if value.dtype.kind == "i"}
    if any(np.any(np.abs(value) >= 2.0**31) for value in whole.values()):
        return False
    return not (whole and step.dtype is int and np.any(np.abs(_repeated(step, operands | whole)) >= 2.0**53))


def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return how many doubles apart numbers are: 0 for the same bits and for two NaN, infinity for 0.0 and -0.0."""

    def place(x: np.ndarray) -> np.ndarray:
        bits = np.ascontiguousarray(x).view(np.uint64).reshape(x.shape)
        return np.where(bits >> np.uint64(63), ~bits, bits | np.uint64(1 << 63))

    apart = (np.maximum(place(a), place(b)) - np.minimum(place(a), place(b))).astype(float)
    apart = np.where((a == b) & (apart > 0), np.inf, apart)
    return np.where(np.isnan(a) & np.isnan(b), 0.0, np.where(np.isnan(a) | np.isnan(b), np.inf, apart))


def check(number: int, seed: int = SEED) -> Found:
    """Draw expressions, compile them in batches, two at a time, and compare."""
    found = Found()
    with ThreadPoolExecutor(2) as pool, Progress("drawn expressions") as progress:
        drawn = [draw([seed, i]) for i in range(number)]
        made = [expression.traced() for expression in drawn]
        batches = pool.map(linked, [made[first : first + BATCH] for first in range(0, number, BATCH)])
        ready = (native for batch in batches for native in batch)
        for i, (expression, native) in enumerate(zip(drawn, ready, strict=True)):
            progress(i, number)
            found.compare(expression, native, np.random.default_rng([seed, i, 1]))
    return found


def run(out: Path) -> Section:
    """Compare ten thousand expressions; those that differ are in ``out``/expressions.txt."""
    found = check(COUNT)
    if found.differences:
        out.mkdir(parents=True, exist_ok=True)
        (out / "expressions.txt").write_text("\n\n".join(found.differences), encoding="utf-8")
    return section(found)


def section(found: Found) -> Section:
    """What drawn expressions show."""
    claims: Sequence[Claim] = [
        Claim(
            "C computes the bits that NumPy computes: arithmetic, comparison, selection, sums, products, conversions",
            float(found.wrong), 0.0, at_least=False, unit=f"of {found.numbers} numbers",
        ),
        Claim(
            "Exponentials, logarithms, powers, angles in C are NumPy's within units in the last place",
            found.places, float(PLACES), at_least=False, unit="units",
        ),
    ]  # fmt: skip

    def write(page: Page) -> None:
        page.heading("What C computes")
        page.text(
            f"{found.expressions} expressions over all functions that a model may contain were drawn, traced and "
            f"compiled, and run {DRAWS} times each, with NaN, infinities, -0.0, denormals and huge numbers among the "
            "inputs. All NaN count as one. Sums of matrix products begin at 0 and go from the first to the last term."
        )
        if found.differences:
            page.text(f"{len(found.differences)} differences are in expressions.txt. The first:")
            page.text(found.differences[0])

    return Section(claims, write)
