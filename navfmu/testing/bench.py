"""A system on the test bench: what is done to it, what is required of it, and its runs."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from navfmu.campaign.requirement import MAIN
from navfmu.engine.recording import RunError
from navfmu.errors import NavfmuError, NavfmuWarning, nearest
from navfmu.faults import Fault
from navfmu.files.reading import what_is
from navfmu.fmi.names import stands_for
from navfmu.system.experiment import Experiment
from navfmu.system.result import as_frame
from navfmu.system.run_report import to_record
from navfmu.system.system import ARGUMENTS, System
from navfmu.testing.asked import Asked
from navfmu.testing.flown import Flown
from navfmu.testing.hidden import hidden
from navfmu.testing.logbook import Logbook
from navfmu.testing.marks import Setting
from navfmu.testing.target import check_target, usual_type
from navfmu.testing.twins import with_twins

if TYPE_CHECKING:
    import pandas

    from navfmu.export import Component

FINDINGS = {  # what makes a run another one than the test is about, unless it is allowed
    "idle": "a fault changed nothing",
    "not_finite": "a recorded value is NaN or infinite",
    "early_end": "an FMU ended the run before the stop time",
}
OWN = {
    "parameters": "s.parameters",
    "faults": "s.fault and s.faults",
    "monitors": "s.require",
}  # of an experiment, and where


class Bench:
    """What ``system(...)`` returns, ``s`` in the examples.

    ``parameters`` are laid over those of the system: ``s.parameters["imu.gyro_drift_sigma"] = "1 deg/h"``.
    """

    @hidden
    def __init__(
        self,
        name: str | os.PathLike,
        variant: str | None,
        setting: Setting,
        logbook: Logbook,
        folder: Path,
        given: Mapping[str, Any],
    ) -> None:
        given = dict(given)
        twins: Sequence[str] | Mapping[str, type[Component]] = given.pop("twins", ())
        self.parameters: dict[str, Any] = _table(given.pop("parameters", {}))
        self._folder = folder
        self._native = System.load(
            self._beside(name), None if variant == MAIN else variant, strict=given.pop("strict", False)
        )
        self.system = with_twins(self._native, twins)
        self._twins, self._setting, self._logbook = tuple(twins), setting, logbook
        self._faults: list[Fault] = []
        self._asked: list[Asked] = []
        self._last: Flown | None = None
        self._waiting: list[str] = []  # what no run has shown yet
        self._given: dict[str, Any] = {}
        self._given = self._arguments(given)

    def __enter__(self) -> Self:
        return self

    @hidden
    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._waiting.clear()
        self.close()

    @hidden
    def close(self) -> None:
        """Refuse what was asked for and never run."""
        waiting, self._waiting = self._waiting, []
        if waiting:
            raise NavfmuError(f"{', '.join(waiting)}: no run came after it, so nothing was tested; call s.run")

    # -- what is done to it --------------------------------------------------------------------------------------

    @hidden
    def fault(
        self,
        target: str | Sequence[str],
        type: str | None = None,
        *,
        at: float | str | None = None,
        duration: float | str | None = None,
        id: str | None = None,
        **parameters: Any,
    ) -> Fault:
        """Let something fail in the runs that follow, from ``at`` on (s, or "5 min"; default: the start).

        Without a type an unconnected input gets its value (a Boolean: true), a bundle is a dropout, and a tunable
        parameter gets its value. All entries of a fault file may be given (docs/faults.md), ``start`` as ``at``; a name
        that Python has for itself ends in an underscore.
        """
        if "start" in parameters:
            raise NavfmuError(f"fault({target!r}): the start of a fault is at={parameters['start']!r} here")
        kind = usual_type(self.system, target) if type is None else type
        times = {name: value for name, value in (("start", at), ("duration", duration)) if value is not None}
        entries = {name.rstrip("_"): value for name, value in parameters.items()}
        fault = Fault(self._free(target) if id is None else id, target, kind, **times, **entries)
        for name in fault.targets:
            check_target(self.system, name)
        self._add([fault])
        return fault

    @hidden
    def faults(self, *files: str | os.PathLike | Fault) -> None:
        """Let the faults of files act: of paths, also beside the test, or names of files inside the system."""
        for file in files:
            named = isinstance(file, (str, os.PathLike))
            self._add(self.system.faults([self._beside(file) if named else file]))

    def _add(self, faults: Sequence[Fault]) -> None:
        self._faults = list(self.system.faults([*self._faults, *faults]))
        self._waiting += [f"fault '{fault.id}'" for fault in faults]

    def _free(self, target: str | Sequence[str]) -> str:
        """An id that no fault has yet."""
        name = target if isinstance(target, str) else ", ".join(map(str, target))
        taken = {fault.id for fault in self._faults}
        return next(n for n in (name, *(f"{name} {k}" for k in range(2, len(taken) + 3))) if n not in taken)

    # -- what is required of it ----------------------------------------------------------------------------------

    @hidden
    def require(self, signal: str | None = None, **entries: Any) -> None:
        """Require something of a signal: the entries are those of ``[[requirement]]`` in a campaign file.

            s.require("evaluation.horizontal_error", at_most="0.5 nmi", percent=95, from_=300, id="NAV-1")

        Before the first run it is required of every run; after a run, of that run. A run that does not hold it is an
        AssertionError that says when and by how much.
        """
        asked = Asked.of(signal, entries, self.system)
        if self._last is not None:
            self._judge(self._last, [asked])
            return
        self._asked.append(asked)
        self._waiting.append(f"requirement {asked.words}")

    def _judge(self, run: Flown, asked: Sequence[Asked]) -> None:
        """Raise what a run violates, with its plot."""
        run.asked += asked
        for one in asked:
            ids = [fault.id for fault in run.experiment.faults]
            one.check_fault(ids)
            for sentence in one.unknown(ids):
                warnings.warn(sentence, NavfmuWarning, stacklevel=4)
        seen = run.frame.attrs["observed"]
        if any(one.key not in seen for one in asked):  # required after the run: it is made again, and asked
            monitors = [one.monitor for one in dict.fromkeys(asked)]
            seen = replace(run.experiment, monitors=monitors).run().attrs["observed"]
        violated = [(one, text) for one in asked if (text := one.judge(seen))]
        if violated:
            signals = [signal for one, _ in violated for signal in one.requirement.signals]
            self._refuse(run, [text for _, text in violated], signals)

    def _refuse(self, run: Flown, sentences: Sequence[str], signals: Sequence[str] = ()) -> None:
        self._logbook.keep(run, signals)
        place = "".join(f"; plot in {where}" for what, where in run.files if what == "plot")
        raise AssertionError("\n".join(f"{sentence}, {run.name}" for sentence in sentences) + place)

    # -- its runs ------------------------------------------------------------------------------------------------

    @hidden
    def run(
        self, stop: float | str | None = None, *, allow: str | Sequence[str] = (), **given: Any
    ) -> pandas.DataFrame:
        """Run it to ``stop`` (s, or "35 min"; default: that of the system), and return the recording.

        The other arguments are ``step``, ``algorithm``, ``seed``, ``record``, ``record_period`` and ``engine``, as
        :meth:`navfmu.System.run` has them; without ``record`` all is recorded that the system's report shows. The
        answer is the same data frame: time (s) as index, a column for each signal.

        A run in which a fault changed nothing, a value is NaN or infinite, or which an FMU ended early, is an
        AssertionError; ``allow`` names those that may be: "idle", "not_finite", "early_end".
        """
        allowed = self._allowed(allow)
        arguments = self._given | self._arguments({} if stop is None else {"stop": stop}) | self._arguments(given)
        arguments |= self._setting.given
        arguments |= {"record": self._record(arguments.get("record")), "parameters": dict(self.parameters)}
        monitors = [asked.monitor for asked in dict.fromkeys(self._asked)]
        experiment = self.system.experiment(**arguments, faults=self._faults, monitors=monitors)
        for fault, why in experiment.plan().idle.items():
            if "idle" not in allowed:
                raise NavfmuError(f"fault '{fault}' {why}: it cannot act; allow='idle' runs it all the same")
        native = self._native.experiment(**arguments, faults=self._faults)
        run = Flown(self._logbook.flown + 1, experiment, None, native.command(), self._twins)
        self._logbook.enter(run)
        self._waiting.clear()
        frame = self._fly(run)
        self._last = run
        found = [text for name, text in _findings(experiment, frame) if name not in allowed]
        if found:
            self._refuse(run, found)
        for note in frame.attrs["notes"]:
            warnings.warn(note, NavfmuWarning, stacklevel=3)
        self._judge(run, self._asked)
        return frame

    def _record(self, given: Sequence[str] | None) -> list[str]:
        """What is recorded: what was given, or else what reports show, and what is required."""
        if given is not None and not all(isinstance(name, str) for name in _listed(given)):
            return given  # the experiment says what is wrong
        names = to_record(None, self.system) if given is None else self.system.signals(given)
        signals = dict.fromkeys(signal for asked in self._asked for signal in asked.requirement.signals)
        return names + [signal for signal in signals if not any(stands_for(name, signal) for name in names)]

    def _fly(self, run: Flown) -> pandas.DataFrame:
        """The recording; of a run that an FMU refused, what there is of it is kept for the failed test."""
        try:
            frame = run.experiment.run()
        except RunError as error:
            if error.recording is not None and len(error.recording.time):
                run.frame = as_frame(error.recording)
                run.frame.attrs["notes"] = list(error.recording.notes)
                run.frame.attrs["provenance"] = run.experiment.provenance() | {"error": str(error)}
            raise
        run.frame = frame.copy(deep=False)  # the test may add columns to its own
        return frame

    def _arguments(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Arguments of an experiment; what marks say, too, must be the same."""
        for name, where in OWN.items():
            if name in given:
                raise NavfmuError(f"'{name}' are given with {where} here")
        unknown = {name: value for name, value in given.items() if name not in ARGUMENTS}
        if unknown:
            self.system.experiment(**unknown)  # which says what there is
        marked = self._setting.given
        for name, value in given.items():
            if name in marked and value != marked[name]:
                mark = {"seed": "seeds"}.get(name, name)
                raise NavfmuError(
                    f"the {name} is {value!r} here, and {marked[name]!r} by the test's mark '{mark}'; leave one out"
                )
        return dict(given)

    def _allowed(self, names: str | Sequence[str]) -> Sequence[str]:
        names = _listed(names)
        for name in names:
            if not isinstance(name, str) or name not in FINDINGS:
                known = ", ".join(f"'{key}' ({what})" for key, what in FINDINGS.items())
                raise NavfmuError(f"allow: there is no {name!r}{nearest(name, FINDINGS)}; there are {known}")
        return names

    def _beside(self, name: str | os.PathLike) -> str:
        """A path seen from the test's folder, where there is something; else the name as it is."""
        if not isinstance(name, (str, os.PathLike)):
            raise NavfmuError(f"system({name!r}): expected a path, or the name of a shipped system")
        text = os.fspath(name)
        return str(self._folder / text) if text.strip() and what_is(self._folder / text) is not None else text


def _table(parameters: object) -> dict[str, Any]:
    """The parameters of a system as a table of one's own."""
    if not isinstance(parameters, Mapping):
        raise NavfmuError(f"parameters are {parameters!r}, expected values by name: {{'imu.gyro_drift_sigma': 0.1}}")
    return dict(parameters)


def _listed(value: object) -> Sequence[Any]:
    """What may be one or several, as several."""
    return value if isinstance(value, (list, tuple)) else [value]


def _findings(experiment: Experiment, frame: pandas.DataFrame) -> list[tuple[str, str]]:
    """What makes the run another one than the test is about: which of ``FINDINGS``, and the sentence."""
    found = [("idle", f"fault '{fault}' {why} (allow='idle')") for fault, why in frame.attrs["idle"].items()]
    found += [
        ("not_finite", f"'{name}' is not finite at {count} of {len(frame)} recorded points (allow='not_finite')")
        for name, count in frame.attrs["not_finite"].items()
    ]
    if len(frame) < len(experiment.points):
        end = f"the last recorded point is at t = {frame.index[-1]:.9g} s, {experiment.stop:.9g} s were asked for"
        found.append(("early_end", f"an FMU ended the run early: {end} (allow='early_end')"))
    return found
