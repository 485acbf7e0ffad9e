"""Which nodes of a graph calculate the same: what is written twice is recorded once."""

from __future__ import annotations

import struct
from dataclasses import fields
from typing import Any

import numpy as np

from navfmu.export.record.graph import Array, Node, Operand, in_order


class Alike:
    """The nodes that were met, each with a number that those have in common that are calculated in the same way."""

    def __init__(self) -> None:
        self._numbers: dict[Node, int] = {}
        self._first: dict[tuple, Node] = {}

    def first(self, node: Node) -> Node:
        """Return the first node that was met and is the same to the bit, which may be this one."""
        for one in in_order([node], self._numbers):
            if one not in self._numbers:
                first = self._first.setdefault(self._what(one), one)
                self._numbers[one] = self._numbers.get(first, len(self._numbers))
        return self._first[self._what(node)]

    def _what(self, node: Node) -> tuple:
        if isinstance(node, Array):
            how = (node.how,)  # what is compared part by part: two of the same are no one of these
            if node.op in ("Map", "Fold", "Run", "Repeat"):
                how = tuple(self._part(getattr(node.how, field.name)) for field in fields(node.how))
            return (node.op, *how, *map(self._read, node.operands))
        if node.op == "number":
            return (node.op, struct.pack("<d", *node.of))
        if node.op == "element":
            source, place = node.of
            return (node.op, self._source(source), place)
        return (node.op, *(self._numbers[n] for n in node.of))

    def _part(self, part: Any) -> Any:
        if isinstance(part, Node):
            self.first(part)
            return self._numbers[part]
        return struct.pack("<d", part) if isinstance(part, float) else part

    def _source(self, source: Any) -> Any:
        """Vectors with one name are not one: those of another task have the same."""
        return (id(source), source) if isinstance(source, str) else self._numbers[source]

    def _read(self, operand: Operand) -> tuple:
        source = operand.source
        what = source.tobytes() if isinstance(source, np.ndarray) else self._source(source)
        return what, None if operand.places is None else operand.places.tobytes(), operand.size
