"""The front door: a system of FMUs that can be run.

from navfmu import System

flight = System.load("backup_navigator", variant="scanning")
result = flight.run(stop=2100, seed=7, faults="gps_lost.toml", record=["evaluation.horizontal_error"])
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError, NavfmuWarning, nearest
from navfmu.system.assembly import Assembly
from navfmu.system.experiment import Experiment

if TYPE_CHECKING:
    import pandas

    from navfmu.engine.plan import Plan

ARGUMENTS = tuple(field.name for field in fields(Experiment) if field.name != "system")


class System(Assembly):
    """A system structure with its FMUs unpacked. Running it changes nothing in it: threads may share it."""

    def experiment(self, **given: Any) -> Experiment:
        """An experiment with this system; the arguments are the fields of :class:`Experiment`."""
        for name in given:
            if name not in ARGUMENTS:
                hint = nearest(name, ARGUMENTS)
                raise NavfmuError(f"an experiment has no '{name}'{hint} (it has: {', '.join(ARGUMENTS)})")
        return Experiment(self, **given)

    def plan(self, **given: Any) -> Plan:
        """The plan that an engine executes; the arguments are those of ``run``."""
        return self.experiment(**given).plan()

    def run(self, progress: Callable[[int, int], None] | None = None, **given: Any) -> pandas.DataFrame:
        """Run from 0 to ``stop`` with the communication step ``step`` (s, or "35 min") and return the recording.

        The arguments are the fields of :class:`Experiment`: ``stop``, ``step``, ``algorithm``, ``seed``, ``faults``,
        ``record``, ``record_period``, ``parameters``, ``engine``. ``progress`` is called with the steps made and all
        steps a few times a second.

        The answer has the time (s) as index, one column for each signal, and in ``attrs`` the units, the notes and
        what is needed to repeat the run. Each note is also given as a ``NavfmuWarning``, which pytest shows.
        """
        frame = self.experiment(**given).run(progress)
        for note in frame.attrs["notes"]:
            warnings.warn(note, NavfmuWarning, stacklevel=2)
        return frame
