"""What stands in an expression, as it is read; ``at`` is the place of its first character, counted from 1."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Node:
    """A part of an expression."""

    at: int


@dataclass(frozen=True, slots=True)
class Quantity(Node):
    """A number with its unit, which is empty if none is written."""

    number: float
    unit: str


@dataclass(frozen=True, slots=True)
class Truth(Node):
    """true or false."""

    value: bool


@dataclass(frozen=True, slots=True)
class Name(Node):
    """A signal, or a word that stands for something."""

    text: str


@dataclass(frozen=True, slots=True)
class Call(Node):
    """A function of values."""

    function: str
    arguments: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Unary(Node):
    """ "-" or "not" before a value."""

    sign: str
    operand: Node


@dataclass(frozen=True, slots=True)
class Binary(Node):
    """Two values with a sign between them; ``at`` is the place of the sign."""

    sign: str
    left: Node
    right: Node
