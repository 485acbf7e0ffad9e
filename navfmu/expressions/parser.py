"""Reads the text of an expression; what is wrong with it is a sentence with the place."""

from __future__ import annotations

import re
from functools import cache, reduce
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError, visible
from navfmu.expressions.tree import Binary, Call, Name, Node, Quantity, Truth, Unary

LONGEST = 2000  # characters
_NUMBER = re.compile(r"[\d.]+(?:[eE][-+]?\d+)?")
_WORDS = {  # what the grammar calls its signs, for people
    "COMPARE": "a comparison",
    "SIGN": "'+' or '-'",
    "TIMES": "'*' or '/'",
    "QUANTITY": "a number",
    "NAME": "a name",
    "QUOTED": "a name in quotes",
    "LPAR": "'('",
    "RPAR": "')'",
    "COMMA": "','",
    "AND": "'and'",
    "OR": "'or'",
    "NOT": "'not'",
    "TRUTH": "'true' or 'false'",
    "$END": "the end",
}


class ExpressionError(NavfmuError):
    """An expression that cannot be; ``at`` is the place of the character."""

    def __init__(self, text: str, at: int, sentence: str) -> None:
        shown = text if len(text) <= 200 else f"{text[:200]}..."
        super().__init__(f"in '{visible(shown)}', character {at}: {sentence}")
        self.at = at


def parse(text: str) -> Node:
    """The tree of an expression."""
    from lark import LarkError, UnexpectedCharacters, UnexpectedEOF, UnexpectedToken

    if len(text) > LONGEST:
        raise ExpressionError(text, LONGEST + 1, f"expected at most {LONGEST} characters, not {len(text)}")
    try:
        return _reader().parse(text)
    except UnexpectedCharacters as error:
        raise ExpressionError(text, error.pos_in_stream + 1, f"'{text[error.pos_in_stream]}' has no meaning") from None
    except UnexpectedEOF as error:
        raise ExpressionError(text, len(text) + 1, f"it ends where {_expected(error.expected)} is missing") from None
    except UnexpectedToken as error:
        over = error.token.type == "$END"
        found = "it ends" if over else f"there is '{error.token}'"
        place = len(text.rstrip()) + 1 if over else error.token.start_pos + 1
        raise ExpressionError(text, place, f"{found}, expected {_expected(error.expected)}") from None
    except LarkError as error:
        raise ExpressionError(text, 1, str(error).splitlines()[0]) from None


def _expected(names: Any) -> str:
    values = {"QUANTITY", "NAME", "LPAR"}
    words = ["a value"] if values <= set(names) else []
    hidden = {*values, "QUOTED", "TRUTH", "NOT", "SIGN"} if words else set()
    words += [_WORDS.get(name, name.lower()) for name in _WORDS if name in names and name not in hidden]
    words = [word for word in words if word]
    return " or ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


@cache
def _reader() -> Any:
    """The parser, made when it is needed: it takes some 30 ms."""
    from lark import Lark, Transformer, v_args

    @v_args(inline=True)
    class Tree(Transformer):
        """Makes nodes of what the grammar finds."""

        def quantity(self, token: Any) -> Node:
            number = _NUMBER.match(token)[0]  # type: ignore[index]
            return Quantity(_at(token), float(number), token[len(number) :].strip())

        def name(self, token: Any) -> Node:
            return Name(_at(token), str(token).strip("'"))

        def truth(self, token: Any) -> Node:
            return Truth(_at(token), str(token) == "true")

        def opposite(self, token: Any, operand: Node) -> Node:
            return Unary(_at(token), "not", operand)

        def call(self, token: Any, *arguments: Any) -> Node:
            return Call(_at(token), str(token), tuple(argument for argument in arguments if argument is not None))

        def signed(self, sign: Any, operand: Node) -> Node:
            return Unary(_at(sign), "-", operand) if sign == "-" else operand

        def sum(self, first: Node, *rest: Any) -> Node:
            return reduce(lambda left, pair: Binary(_at(pair[0]), str(pair[0]), left, pair[1]), _pairs(rest), first)

        product = sum

        def comparison(self, first: Node, *rest: Any) -> Node:
            lefts = [first, *rest[1::2]]  # a < b < c asks both
            found = [
                Binary(_at(sign), str(sign), left, right)
                for left, (sign, right) in zip(lefts, _pairs(rest), strict=False)
            ]
            return _joined("and", found)

        def both(self, *operands: Node) -> Node:
            return _joined("and", operands)

        def either(self, *operands: Node) -> Node:
            return _joined("or", operands)

    grammar = Path(__file__).with_name("grammar.lark").read_text("utf-8")
    return Lark(grammar, parser="lalr", transformer=Tree())


def _at(token: Any) -> int:
    return token.start_pos + 1


def _pairs(rest: Any) -> list[tuple[Any, Any]]:
    return list(zip(rest[::2], rest[1::2], strict=True))


def _joined(word: str, operands: Any) -> Node:
    return reduce(lambda left, right: Binary(right.at, word, left, right), operands)
