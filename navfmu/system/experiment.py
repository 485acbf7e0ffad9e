"""An experiment: everything that determines a run, in one value.

The command line, ``System.run``, sweeps, campaigns, cache keys, provenance and the command that repeats a run are
views of it.
"""

from __future__ import annotations

import hashlib
import json
import math
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from navfmu.engine.clock import Clock
from navfmu.errors import NavfmuError, check_progress, nearest, visible
from navfmu.fmi.seconds import seconds, short
from navfmu.fmi.values import checked, expand
from navfmu.system.assembly import Assembly
from navfmu.system.provenance import environment, versions

if TYPE_CHECKING:
    import numpy as np
    import pandas

    from navfmu.engine.blackbox import BlackBox
    from navfmu.engine.monitor import Monitor
    from navfmu.engine.plan import Plan
    from navfmu.faults import Fault

ENGINES = ("compiled", "reference")
ALGORITHMS = ("gauss_seidel", "jacobi")
ROWS = 10_000  # recorded at every step up to here, then more rarely, unless a period is given
FORMAT = 4  # of what a key covers; raise it when that changes


@dataclass(frozen=True, eq=False)
class Experiment:
    """A system, and what is done with it. Whatever does not fit together is a ``NavfmuError``.

    ``stop`` and ``step`` are those of the system's default experiment unless given; times are in s, or texts such as
    "35 min". ``seed`` goes to every
    component with a parameter of that name and to the faults. ``parameters`` are laid over those of the system:
    ``{"imu.gyro_drift_sigma": "1 deg/h"}``. ``faults`` names fault files or holds faults. ``record`` names signals,
    arrays or bundles ("imu.reading"), components, patterns ("imu.*"), and values before faults
    ("imu.reading.rate[1]@true"); every ``record_period`` (s) a row is recorded. ``monitors`` are asked at every step.
    """

    system: Assembly
    stop: float = None  # type: ignore[assignment]  # after __post_init__ none of these is None but the seed
    step: float = None  # type: ignore[assignment]
    algorithm: str = "gauss_seidel"
    seed: int | None = None
    faults: Sequence[Fault] = ()
    record: Sequence[str] = None  # type: ignore[assignment]
    record_period: float = None  # type: ignore[assignment]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    engine: str = "compiled"
    monitors: Sequence[Monitor] = ()

    def __post_init__(self) -> None:
        stop = self._suggested("stop", self.system.structure.stop_time)
        step = self._suggested("step", self.system.structure.step)
        self._choice("algorithm", ALGORITHMS)
        self._choice("engine", ENGINES)
        if self.seed is not None and not _is_seed(self.seed):
            raise NavfmuError(f"the seed is {self.seed!r}, expected a whole number from 0 to 2147483647")
        clock = Clock.of(step, stop)
        period = _time("record_period", self.record_period)
        if period is None:
            period = _default_period(clock.time(clock.steps), clock.step)
        clock.multiple(period, "recording period")
        for name, value in (
            ("stop", clock.time(clock.steps)),
            ("step", clock.step),
            ("seed", None if self.seed is None else int(self.seed)),
            ("faults", self.system.faults(self.faults)),
            ("record", self._names()),
            ("record_period", float(period)),
            ("parameters", self._parameters()),
            ("monitors", tuple(self.monitors)),
        ):
            object.__setattr__(self, name, value)

    def _suggested(self, name: str, suggestion: float | None) -> float:
        value = _time(name, getattr(self, name))
        if value is not None:
            return value
        if suggestion is None:
            what = {"stop": "stop time"}.get(name, name)
            raise NavfmuError(f"{self.system.structure.origin}: suggests no {what}; give one")
        return suggestion

    def _choice(self, name: str, known: Sequence[str]) -> None:
        value = getattr(self, name)
        if value not in known:
            have = " and ".join(known)
            raise NavfmuError(f"unknown {name} '{value}'{nearest(value, known)} (there are {have})")

    def _names(self) -> tuple[str, ...]:
        names = [self.record] if isinstance(self.record, str) else self.record
        if names is not None and not isinstance(names, Sequence):
            raise NavfmuError(f"record: {names!r} is no list of names of signals, such as ['imu.reading', 'gps.*']")
        if names is not None and not len(names) and self.system.signals():
            raise NavfmuError("record: the list of signals is empty; leave it out to take those of the system")
        for name in names or ():
            if not isinstance(name, str):
                raise NavfmuError(f"record: {name!r} is not the name of a signal, such as 'imu.reading' or 'imu.*'")
        return tuple(self.system.signals(names))

    def _parameters(self) -> dict[str, Any]:
        if not isinstance(self.parameters, Mapping):
            raise NavfmuError(
                f"parameters are {self.parameters!r}, expected values by name: {{'imu.gyro_drift_sigma': '1 deg/h'}}"
            )
        return {_name(name, value): _plain(value) for name, value in self.parameters.items()}

    # -- running it ----------------------------------------------------------------------------------------------

    def start_values(self) -> dict[str, dict[str, Any]]:
        """The values set before initialisation, by component and variable: the system's, the seed, the parameters."""
        start, given = {}, {name: {} for name in self.system.fmus}
        for component, values in self._settings().values():
            given[component] |= values
        for name, fmu in self.system.fmus.items():
            start[name] = {**self.system.values[name]}
            own = fmu.description.by_name.get("seed")
            if self.seed is not None and own is not None and own.type == "Integer" and own.causality == "parameter":
                start[name]["seed"] = checked(fmu.description, own, self.seed, f"{name}, seed")
            start[name] |= given[name]
        return start

    def _settings(self) -> dict[str, tuple[str, dict[str, Any]]]:
        """What each parameter sets: its component, and a value for each variable."""
        found = {}
        for name, value in self.parameters.items():
            component, _, variable = name.partition(".")
            where = f"parameter '{name}'"
            self.system.known(component, where)
            values = expand(self.system.fmus[component].description, {variable: value}, where)
            self.system.refuse_connected(component, values, where)
            found[name] = component, values
        return found

    @property
    def notes(self) -> list[str]:
        """What the user should know before it is run: of the system, and which of two settings of one value holds."""
        return [*self.system.notes, *map(visible, (*self._contradictions(), *self._equal_noise()))]

    def _contradictions(self) -> Iterator[str]:
        """The later parameter holds, and a parameter rather than the seed."""
        last: dict[tuple[str, str], tuple[str, Any]] = {}
        for name, (component, values) in self._settings().items():
            differ = [v for v, value in values.items() if last.get((component, v), ("", value))[1] != value]
            if differ:
                before = last[component, differ[0]][0]
                yield f"'{before}' and '{name}' set '{component}.{differ[0]}' to different values: the last one holds"
            last |= {(component, variable): (name, value) for variable, value in values.items()}
        for (component, variable), (_, value) in last.items():
            if variable == "seed" and self.seed not in (None, value):
                yield f"the seed of '{component}' is {value}, as its parameter says, not that of the run"

    def _equal_noise(self) -> Iterator[str]:
        """Components that draw from one stream of one seed: the readings of two sensors are wrong alike."""
        first: dict[tuple[int, int], str] = {}
        for name, values in self.start_values().items():
            found = self.system.fmus[name].description.by_name
            if "seed" in found and "stream" in found:
                seed, stream = (int(values.get(word, found[word].start or 0)) for word in ("seed", "stream"))
                other = first.setdefault((seed, stream), name)
                if other != name:
                    yield (
                        f"'{other}' and '{name}' have the same noise, as they have the same seed {seed} and the same "
                        f"stream {stream}: give one of them another value of the parameter stream"
                    )

    def plan(self) -> Plan:
        """The plan that an engine executes."""
        from navfmu.engine.component import Component
        from navfmu.engine.plan import make_plan

        start = self.start_values()
        return make_plan(
            [Component(name, fmu, start[name]) for name, fmu in self.system.fmus.items()],
            self.system.links,
            step=self.step,
            stop=self.stop,
            algorithm=self.algorithm,
            record=self.record,
            record_period=self.record_period,
            faults=self.faults,
            monitors=self.monitors,
            phases=self.phases,
            seed=1 if self.seed is None else self.seed,
        )

    @property
    def phases(self) -> Mapping[str, str]:
        """Conditions with a name, where something may use them."""
        return self.system.phases if self.monitors or any(fault.condition for fault in self.faults) else {}

    @property
    def phases_asked(self) -> dict[str, str]:
        """Those that faults and monitors name; what they say belongs to the key."""
        monitors = (text for monitor in self.monitors for text in (monitor.value, monitor.when))
        return self._phases_in([*monitors, *(fault.condition for fault in self.faults)])

    def _phases_in(self, texts: Sequence[str]) -> dict[str, str]:
        if not self.phases:
            return {}
        from navfmu.system.phase import named_in

        return named_in(self.phases, texts)

    @property
    def points(self) -> np.ndarray:
        """The times (s) at which a row is recorded, as long as no FMU ends the run."""
        import numpy as np

        clock = Clock.of(self.step, self.stop)
        every = clock.multiple(self.record_period, "recording period")
        return np.arange(0, clock.steps + 1, every) * clock.numerator / clock.denominator

    def run(
        self,
        progress: Callable[[int, int], None] | None = None,
        memory: Callable[[Plan], BlackBox] | None = None,
    ) -> pandas.DataFrame:
        """Run it and return the recording as a table (:func:`navfmu.system.result.as_frame`).

        ``progress`` is called with the steps made and all steps a few times a second. ``memory`` makes the file that
        the compiled engine writes into, where another process is to read along (:mod:`navfmu.engine.blackbox`).
        """
        from navfmu.system.result import as_frame

        check_progress(progress)
        plan, about = self.plan(), self.provenance()  # of files as they are seen from here: an FMU may go elsewhere
        if self.engine == "reference":
            from navfmu.engine import reference

            recording = reference.run(plan, progress)
        else:
            from navfmu.engine import compiled

            if memory is None:
                recording = compiled.run(plan, progress)
            else:
                with memory(plan) as box:
                    recording = compiled.run(plan, progress, box)
        frame = as_frame(recording)
        frame.attrs["notes"] = [*self.notes, *map(visible, (*plan.notes, *recording.notes))]
        frame.attrs["provenance"] = about
        return frame

    # -- views of it ---------------------------------------------------------------------------------------------

    def describe(self) -> dict[str, Any]:
        """The experiment as plain data, from which ``restored`` makes it again."""
        return {
            "system": str(self.system.place),
            "variant": self.system.variant,
            "digest": self.system.digest,
            "stop": self.stop,
            "step": self.step,
            "algorithm": self.algorithm,
            "engine": self.engine,
            "seed": self.seed,
            "parameters": dict(self.parameters),
            "faults": [fault.describe() for fault in self.faults],
            "record": list(self.record),
            "record_period": self.record_period,
            "monitors": [monitor.describe() for monitor in self.monitors],
            "phases": self.phases_asked,
        }

    @classmethod
    def restored(cls, description: Mapping[str, Any], system: Assembly) -> Self:
        """The experiment of a description, with its system, which must be the same as then."""
        from navfmu.engine.monitor import Monitor
        from navfmu.faults import Fault

        if system.digest != description["digest"]:
            raise NavfmuError(
                f"{description['system']}: is not the system that was run: its FMUs, connections or values have changed"
            )
        given = {
            name: description[name] for name in description if name not in ("system", "variant", "digest", "phases")
        }
        faults = [Fault.of(entry) for entry in given["faults"]]
        monitors = [Monitor(**entry) for entry in given["monitors"]]
        made = cls(system, **given | {"faults": faults, "monitors": monitors})
        if made.phases_asked != description["phases"]:
            raise NavfmuError(f"{description['system']}: its phases are not those that were asked")
        return made

    def provenance(self) -> dict[str, Any]:
        """What is needed to repeat the run, and to see that it is the same."""
        return self.describe() | {
            "fmus": self.system.hashes(),
            "versions": versions(),
            "command": self.command(),
        }

    @property
    def key(self) -> str:
        """A hash of everything that determines the recording: 32 hexadecimal digits."""
        content = self.describe() | {"format": FORMAT, "environment": environment()}
        content["parameters"] = list(self.parameters.items())  # they are laid over one another in their order
        content.pop("system")  # wherever it lies
        content.pop("variant")
        for fault in content["faults"]:
            fault.pop("file", None)
        text = json.dumps(content, sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:32]

    def command(self) -> str:
        """The command that repeats the run."""
        words = [*self.words("run"), "--step", number(self.step), "--algorithm", self.algorithm]
        if self.engine != ENGINES[0]:
            words += ["--engine", self.engine]
        if self.record != tuple(self.system.signals()):
            words += ["--record", ",".join(self.record)]
        return shlex.join([*words, "--record-period", number(self.record_period)])

    def _are_those_of(self, files: Sequence[str]) -> bool:
        """Whether the faults begin with all those of these files, as they are in them, in their order."""
        try:
            there = [fault.describe() for fault in self.system.faults(files)]
        except NavfmuError:
            return False
        own = [fault.describe() for fault in self.faults]
        return own[: len(there)] == there and not any(fault.get("file") for fault in own[len(there) :])

    def words(self, verb: str) -> list[str]:
        """The beginning of a command line: system, parameters, faults, stop and seed."""
        words = ["navfmu", verb, str(self.system.place)]
        if self.system.variant is not None:
            words += ["--variant", self.system.variant]
        for name, value in self.parameters.items():
            words += ["--set", f"{name}={_word(value)}"]
        files = tuple(dict.fromkeys(fault.file for fault in self.faults if fault.file))  # from everywhere
        if not self._are_those_of(files):
            files = ()
        words += [word for file in files for word in ("--faults", file)]
        words += [word for fault in self.faults if fault.file not in files for word in ("--fault", fault.inline())]
        words += ["--stop", number(self.stop), "--expect", self._outside(files)]
        return words if self.seed is None else [*words, "--seed", str(self.seed)]

    def _outside(self, files: Sequence[str]) -> str:
        """What a command names and does not hold, as ``--expect`` takes it: a hash of the system, one of the faults.

        Phases for which faults wait belong to the system.
        """
        faults = [fault.describe() for fault in self.faults if fault.file in files]
        for fault in faults:
            fault.pop("file")  # wherever it lies
        phases = self._phases_in([fault.condition for fault in self.faults])
        system = _digest([self.system.digest, phases]) if phases else self.system.digest
        return "-".join(digest[:12] for digest in (system, *([_digest(faults)] if faults else [])))

    def expect(self, words: str) -> None:
        """Refuse when the system or the fault files are others than those of a command with ``--expect words``."""
        here = self._outside({fault.file for fault in self.faults if fault.file})
        if words == here:
            return
        system_is_it = words.split("-")[0] == here.split("-")[0]
        what = "faults in the fault files are" if system_is_it else f"system in {self.system.place} is"
        raise NavfmuError(
            f"--expect {words}: the {what} not what the command was written for ({here}); without --expect it runs "
            "what is there now"
        )


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def _time(name: str, value: Any) -> Any:
    """A time in s where a text gives it; the clock says what is wrong with others."""
    return seconds(value, name) if isinstance(value, str) else value


def _is_seed(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and 0 <= value < 2**31


def _name(name: object, value: Any) -> str:
    """The name of a parameter, which is that of a component and one of its own."""
    if isinstance(value, Mapping):
        inner, given = next(iter(value.items()), ("gyro_drift_sigma", "1 deg/h"))
        raise NavfmuError(
            f"parameter '{name}' is a table, expected a value for each name: {{'{name}.{inner}': {short(given)}}}"
        )
    if not isinstance(name, str) or not all(name.partition(".")):
        raise NavfmuError(f"parameter {name!r} names none; expected component.parameter, as 'imu.gyro_drift_sigma'")
    return name


def _default_period(stop: float, step: float) -> float:
    """Every step if that gives at most ``ROWS`` rows, else the next of 0.1 s, 1 s, 10 s ... that is a multiple."""
    if stop / step <= ROWS:
        return step
    period = 0.1
    while period < 1e9:
        count = round(period / step)
        if stop / period <= ROWS and count >= 1 and abs(count * step - period) <= 1e-9 * period:
            return period
        period = round(period * 10, 1)
    return step


def _plain(value: Any) -> Any:
    """A value as JSON has it: lists for arrays, numbers of Python for those of NumPy."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, Path):
        return str(value)
    return float(value) if isinstance(value, Real) and not isinstance(value, (bool, int, float)) else value


def _word(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_word, value))}]"
    if isinstance(value, float) and math.isfinite(value):
        return number(value)
    return str(value)


def number(value: float) -> str:
    """A number as one types it: the shortest that reads back the same."""
    return repr(float(value)).removesuffix(".0")
