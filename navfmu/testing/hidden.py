"""Errors of the package in a test: a sentence at the test's own line, without the package's inside."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from navfmu.errors import NavfmuError, NavfmuWarning

P = ParamSpec("P")
R = TypeVar("R")


def hidden(function: Callable[P, R]) -> Callable[P, R]:
    """The function; what it refuses or finds violated is raised from where it is called."""

    @wraps(function)
    def call(*arguments: P.args, **given: P.kwargs) -> R:
        __tracebackhide__ = True
        try:
            return function(*arguments, **given)
        except (NavfmuError, NavfmuWarning, AssertionError) as error:  # a warning where pytest makes them errors
            raise error.with_traceback(None) from None

    return call
