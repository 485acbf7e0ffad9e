"""FMUs that returned fmi2Fatal: nothing of any instance that they had then may be called any more (FMI 2.0, 2.1.3).

That concerns the other components of the run with the same FMU, and other runs in this process. What is instantiated
later is a new beginning.
"""

from __future__ import annotations

from collections import Counter

from navfmu.engine.component import Component

FATAL = 4  # fmi2Fatal
_times: Counter[str] = Counter()  # that a library has returned it, in this process


def happened() -> bool:
    """Whether an FMU has returned it in this process."""
    return bool(_times)


class Instances:
    """The instances of one run, in the order of its components."""

    def __init__(self) -> None:
        self._libraries: list[str] = []
        self._times: list[int] = []

    def add(self, component: Component) -> None:
        """Note what is going to be instantiated."""
        self._libraries.append(str(component.fmu.library.resolve()))
        self._times.append(_times[self._libraries[-1]])

    def returned(self, number: int, status: int) -> None:
        """Note the status of a call."""
        if status == FATAL:
            _times[self._libraries[number]] += 1

    def alive(self, number: int) -> bool:
        """Whether functions of this instance may be called."""
        return _times[self._libraries[number]] == self._times[number]

    def dead(self) -> int | None:
        """The first instance of which nothing may be called; None if there is none."""
        return next((number for number in range(len(self._libraries)) if not self.alive(number)), None)
