"""The operations of all expressions of a plan, one after the other, on its signals and its faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from navfmu.expressions.program import Op, Program, Source

# One operation of a program, laid out as struct Operation in source/expression.h.
OPERATION = np.dtype([("kind", np.int32), ("place", np.int32), ("number", np.float64)], align=True)

Place = Callable[[Source], tuple[int, float, float]]  # of a signal: its place, and what scales it


class Operations:
    """The table of them; ``faults`` are the ids of those of the run."""

    def __init__(self, place: Place, faults: Sequence[str]) -> None:
        self._place, self._faults = place, faults
        self._rows: list[tuple[int, int, float]] = []

    def add(self, program: Program | None) -> tuple[int, int]:
        """Where the operations of a program begin, and how many they are; none for none."""
        first = len(self._rows)
        for op, argument in program.operations if program else ():
            if op == Op.LOAD_SIGNAL:
                self._load(program.sources[int(argument)])
            elif op == Op.ACTIVE and argument >= 0:
                self._active(program.faults[int(argument)])
            else:
                self._rows.append((op, -1 if op == Op.ACTIVE else 0, argument if op == Op.CONSTANT else 0.0))
        return first, len(self._rows) - first

    def _load(self, source: Source) -> None:
        """A signal of the plan; what is scaled on its way to an input is scaled here, too."""
        slot, factor, offset = self._place(source)
        self._rows.append((Op.LOAD_SIGNAL, slot, 0.0))
        if (factor, offset) != (1.0, 0.0):
            self._rows += [(Op.CONSTANT, 0, factor), (Op.MULTIPLY, 0, 0.0), (Op.CONSTANT, 0, offset), (Op.PLUS, 0, 0.0)]

    def _active(self, fault: str) -> None:
        """Whether a fault acts; one that the run does not have does not."""
        known = fault in self._faults
        self._rows.append((Op.ACTIVE, self._faults.index(fault), 0.0) if known else (Op.CONSTANT, 0, 0.0))

    @property
    def table(self) -> np.ndarray:
        """All rows."""
        table = np.zeros(len(self._rows), OPERATION)
        for row, operation in zip(table, self._rows, strict=True):
            row["kind"], row["place"], row["number"] = operation
        return table


def program_of(operations: np.ndarray, first: int, count: int, faults: Sequence[str]) -> Program | None:
    """A program of the table, whose sources are the signals of the plan and whose faults those of the run."""
    if not count:
        return None
    rows = operations[first : first + count].tolist()
    loads = (Op.LOAD_SIGNAL, Op.ACTIVE)
    return Program(
        "", tuple((Op(k), float(p) if k in loads else n) for k, p, n in rows), (), tuple(faults), False, None
    )
