"""The marks of a test that say how its systems are run: ``seeds``, ``algorithm`` and ``step``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import product
from typing import Any

from navfmu.errors import NavfmuError

MARKS = {
    "seeds": 'seeds("1-5"): run the test with each of these seeds; also a list of numbers.',
    "algorithm": 'algorithm("jacobi"): run the systems of the test so; with several names, the test with each.',
    "step": 'step("20 ms"): communication step size, a text or seconds; with several, the test with each.',
}


@dataclass(frozen=True)
class Setting:
    """How the marks of a test want its systems to be run; None where they do not say."""

    seed: int | None = None
    algorithm: str | None = None
    step: float | str | None = None

    @property
    def given(self) -> dict[str, Any]:
        """What the marks say, as arguments of an experiment."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}

    @property
    def id(self) -> str:
        """How pytest shows it in the name of the test: "seed3-jacobi-step0.01"."""
        words = {"seed": f"seed{self.seed}", "algorithm": f"{self.algorithm}", "step": f"step{self.step}"}
        return "-".join(words[name] for name in self.given).replace(" ", "")


def settings(arguments: Callable[[str], Sequence[Any] | None]) -> list[Setting]:
    """Every setting that a test is run with; ``arguments`` of a mark are None where the test does not have it."""
    values = {name: _values(name, arguments(name)) for name in MARKS}
    return [Setting(*chosen) for chosen in product(*values.values())]


def _values(mark: str, given: Sequence[Any] | None) -> Sequence[Any]:
    if given is None:
        return [None]
    if mark != "seeds":
        if not given:
            raise NavfmuError(f"the mark '{mark}' says nothing; expected, for example, {MARKS[mark].partition(':')[0]}")
        return given
    from navfmu.campaign.seeds import parse_seeds

    value = given[0] if len(given) == 1 and not isinstance(given[0], int) else list(given)
    return parse_seeds(value, lambda sentence: NavfmuError(f"the mark 'seeds': {sentence}"))
