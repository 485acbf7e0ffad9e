"""The compiled engine: hands a plan to the C loop in ``source/`` and FMI's function pointers with it."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from navfmu.engine import floating, single, structures
from navfmu.engine.blackbox import BlackBox, Memory
from navfmu.engine.effect import AHEAD, ECHO, EFFECT
from navfmu.engine.fatal import Instances
from navfmu.engine.initial import MOVE
from navfmu.engine.inputs import Inputs
from navfmu.engine.link import TYPES
from navfmu.engine.loading import engine_library, load
from navfmu.engine.loss import LOSS
from navfmu.engine.monitor import MONITOR
from navfmu.engine.operations import OPERATION
from navfmu.engine.plan import Part, Plan
from navfmu.engine.recording import (
    Recording,
    RunError,
    complained,
    dead,
    ended,
    got_to,
    observed,
    recording,
    refusal,
    unmoved,
    warned,
)
from navfmu.engine.structures import ASKED, DISCARD, FAILED, GOES_ON, LOOP, NAMES, WARNING, Callbacks, Master
from navfmu.engine.trigger import SPAN, TRIGGER, WINDOW
from navfmu.errors import NavfmuError
from navfmu.expressions.program import Op
from navfmu.fmi.description import Description
from navfmu.fmi.functions import OPTIONAL

MAY_LACK = {*ASKED, *(name for names in OPTIONAL.values() for name in names)}
_CALLS = (c_char_p * len(NAMES))(*(name.encode() for name in NAMES))
Progress = Callable[[int, int], None]  # called with the steps made and the steps of the run


@cache
def fmi2(path: Path) -> Fmi2:
    """The functions of an FMU's library, which stays loaded."""
    return Fmi2(path)


@cache
def resource_uri(directory: Path) -> str:
    """Where an unpacked FMU has its resources."""
    return (directory.resolve() / "resources").as_uri()


class Fmi2:
    """The functions of one FMU's library, with their C types."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.library = load(path, "the binary")
        texts = [c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int]
        self.instantiate = self._function("fmi2Instantiate", *texts, result=c_void_p)
        self.free_instance = self._function("fmi2FreeInstance", c_void_p, result=None)
        self.setup_experiment = self._function(
            "fmi2SetupExperiment", c_void_p, c_int, c_double, c_double, c_int, c_double
        )
        self.enter_initialization = self._function("fmi2EnterInitializationMode", c_void_p)
        self.terminate = self._function("fmi2Terminate", c_void_p)
        setter = (c_void_p, c_void_p, c_size_t, c_void_p)
        self.set = {kind: self._function(f"fmi2Set{kind}", *setter) for kind in (*TYPES, "String")}
        self.get_integer = self._function("fmi2GetInteger", *setter)
        self.get_state = self._optional("fmi2GetFMUstate", c_void_p, POINTER(c_void_p))
        self.set_state = self._optional("fmi2SetFMUstate", c_void_p, c_void_p)
        self.free_state = self._optional("fmi2FreeFMUstate", c_void_p, POINTER(c_void_p))
        self.addresses = {field: self._address(name) for field, name in LOOP.items()}

    def _function(self, name: str, *arguments: Any, result: Any = c_int) -> Any:
        try:
            function = self.library[name]  # a new object each time, so that types set here stay here
        except AttributeError:
            raise NavfmuError(f"the binary {self.path} has no function {name}") from None
        function.argtypes, function.restype = arguments, result
        return function

    def _optional(self, name: str, *arguments: Any) -> Any:
        return self._function(name, *arguments) if hasattr(self.library, name) else None

    def _address(self, name: str) -> int | None:
        function = self._optional(name) if name in MAY_LACK else self._function(name)
        return None if function is None else ctypes.cast(function, c_void_p).value

    def check(self, description: Description) -> None:
        """Refuse a library that lacks a function of what its description claims."""
        for ability, names in OPTIONAL.items():
            for name in names if getattr(description, ability) else ():
                self._function(name)


@dataclass(eq=False)
class Snapshot:
    """The state of a run at a communication point. Belongs to the engine that made it and lives as long as that."""

    k: int
    states: list[c_void_p]
    memory: list[np.ndarray]


class Compiled:
    """One run of a plan. Several may run at once in threads: the loop holds no lock and shares nothing.

    ``memory`` takes what a run leaves behind: by default that of this process, or a ``BlackBox``, which outlives it.
    """

    def __init__(self, plan: Plan, memory: Memory | BlackBox | None = None) -> None:
        self.plan = plan
        self._kept: list[Any] = []  # everything that the C structures point to
        self._memory: list[np.ndarray] = []  # the part of it that changes while running
        memory = Memory.of(plan) if memory is None else memory
        self._place, self._logs, self.rows = memory.place, memory.logs, memory.rows
        self._place.k = self._place.rows = 0
        self._callbacks = (Callbacks * len(plan.parts))()
        self._components = (structures.Component * len(plan.parts))()
        self._fmus: list[Fmi2] = []
        self._snapshots: list[Snapshot] = []
        self._refused: set[int] = set()  # components that returned an error: they cannot be terminated any more
        self._instances = Instances()  # which of them may be called at all
        self._lost: dict[str, int] = {}
        self._initialised = False
        self._library = engine_library()
        self._terminated = False
        self._names = (c_char_p * len(plan.parts))(*(part.component.name.encode() for part in plan.parts))
        self._step = plan.clock.step
        self._watches = not isinstance(memory, BlackBox)  # else another process sees who ended this one
        self._exposed = [plan.exposed(part) for part in plan.parts]  # the signals that faults can change
        self._disturbed = np.zeros(len(plan.signals), bool)
        for exposed in self._exposed:
            self._disturbed[exposed] = True
        self._effects = np.ascontiguousarray(plan.effects, EFFECT).copy()
        self._losses = np.ascontiguousarray(plan.losses, LOSS).copy()
        self._monitors = np.ascontiguousarray(plan.monitors, MONITOR).copy()
        self._triggers = np.ascontiguousarray(plan.triggers, TRIGGER).copy()
        self._spans = np.ascontiguousarray(plan.spans, SPAN).copy()
        self._master = self._make_master()
        try:
            for number, part in enumerate(plan.parts):
                self._fill(number, self._components[number], part)
                self._instantiate(number, part)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Compiled:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- the run -----------------------------------------------------------------------------------------------------

    @property
    def k(self) -> int:
        """Communication points reached; may be read from another thread."""
        return self._place.k

    def initialise(self) -> None:
        """Set start values and bring every component to t = 0."""
        for number, part in enumerate(self.plan.parts):
            self._configure(number, part)
        self._watch()
        result = self._library.initialise(byref(self._master))
        self._check(result)
        self._initialised = True

    def advance(self, until: int | None = None) -> None:
        """Run to communication point ``until`` (default: the end), or to where ``interrupt`` stopped it."""
        end = self.plan.clock.steps if until is None else min(until, self.plan.clock.steps)
        self._look_for_dead()
        self._watch()
        result = self._library.advance(byref(self._master), end)
        self._check(result)

    def interrupt(self) -> None:
        """Stop at the next communication point; to be called from another thread."""
        self._master.interrupt = 1

    def run(self, progress: Progress | None = None) -> Recording:
        """Initialise, run to the end, terminate."""
        self.complete(progress)
        return self.recording()

    def complete(self, progress: Progress | None = None) -> None:
        """Do the whole run. Ctrl-C and ``progress`` get their turn about ten times a second."""
        self.initialise()
        steps, chunk = self.plan.clock.steps, 16
        while self.k < steps and not self._master.interrupt:
            before = time.perf_counter()
            self.advance(self.k + chunk)
            if progress is not None:
                progress(self.k, steps)
            spent = time.perf_counter() - before
            chunk = max(1, chunk * 2 if spent < 0.05 else chunk // 2 if spent > 0.2 else chunk)
        if progress is not None and self._master.ended >= 0:
            progress(steps, steps)  # there is nothing more to come
        self.terminate()

    def terminate(self) -> None:
        """End the run: FMUs of other makers write now what they have collected. A refusal is one of the run."""
        if self._terminated or not self._initialised:
            return
        self._count_lost()
        self._terminated, refused = True, []
        for number, fmu in enumerate(self._fmus):
            if number not in self._refused and self._instances.alive(number):
                status = self._status(number, "fmi2Terminate", fmu.terminate)
                refused += [(number, status)] if status not in GOES_ON else []
        self._refused |= {number for number, _ in refused}
        for number, status in refused:
            self._refuse(number, "fmi2Terminate", status)

    @floating.ordinary()
    def recording(self) -> Recording:
        """What has been recorded so far."""
        lost = self._count_lost()
        notes = ended(self.plan, self._logs, self._master.ended, self.k, self._master.last)
        notes += warned(self.plan, self._logs, [component.warnings for component in self._components])
        notes += complained(self.plan, self._logs, {*self._refused, self._master.ended})
        notes += floating.strayed(self.plan, [component.strayed for component in self._components])
        over = self.k == self.plan.clock.steps or self._master.ended >= 0
        idle = unmoved(
            self.plan,
            [*self._effects["seen"].tolist(), *self._losses["seen"].tolist()],
            self.k,
            over,
            self._master.turn,
            self._acted(),
        )
        seen = observed(self.plan, self._monitors, self.k)
        rows = self.rows[: self._place.rows].copy()
        return recording(self.plan, rows, notes, lost, idle, seen, self._acted(), self.k, over)

    def _acted(self) -> list[list[tuple[int, int]]]:
        """The communication points first <= k < end at which each trigger acted."""
        firsts, counts = self._triggers["first_span"].tolist(), self._triggers["spans"].tolist()
        return [self._spans[first : first + count].tolist() for first, count in zip(firsts, counts, strict=True)]

    def _count_lost(self) -> dict[str, int]:
        """Samples that were lost so far; what was read last, once an FMU has refused a call or is gone."""
        for number, fmu in enumerate(() if self._refused or self._terminated else self._fmus):
            counters = self.plan.parts[number].counters
            if counters and self._instances.alive(number):
                references = (ctypes.c_uint32 * len(counters))(*(counter.reference for counter in counters))
                values = (c_int * len(counters))()
                status = self._status(number, "fmi2GetInteger", fmu.get_integer, references, len(counters), values)
                if status in GOES_ON:
                    name = self.plan.parts[number].component.name
                    self._lost |= {f"{name}.{c.name}": n for c, n in zip(counters, values, strict=True)}
        return self._lost

    def _check(self, result: int) -> None:
        """The loop has returned: raise the sentence for a call that failed in it."""
        number, call = self._place.component, NAMES[self._place.call]
        self._nowhere()
        if result != FAILED:
            return
        status, more = self._master.status, ""
        if status == DISCARD and call == LOOP["do_step"]:
            more = got_to(self._master.last)
        self._instances.returned(number, status)
        self._refuse(number, call, status, more)

    def _look_for_dead(self) -> None:
        """Go no further when the FMU of a component has failed for good in another run."""
        number = self._instances.dead()
        if number is not None:
            partial = self.recording() if self._initialised else None
            raise RunError(dead(self.plan.parts[number].component), partial)

    def _refuse(self, number: int, call: str, status: int, more: str = "") -> NoReturn:
        self._refused.add(number)
        name, when = self.plan.parts[number].component.name, self.plan.clock.time(self.k)
        partial = self.recording() if self._initialised else None
        sentence = refusal(name, call, status, when, self._logs[number].refused())
        raise RunError(sentence + more, partial, component=name, call=call, time=when)

    # ---- states ------------------------------------------------------------------------------------------------------

    def snapshot(self) -> Snapshot:
        """The state of the whole run, to come back to with ``restore``."""
        for part in self.plan.parts:
            if not part.component.restores:
                raise NavfmuError(f"component '{part.component.name}' cannot save its state (canGetAndSetFMUstate)")
        snapshot = Snapshot(self.k, [], [array.copy() for array in self._memory])
        self._snapshots.append(snapshot)
        self._may_go_back()
        for number, fmu in enumerate(self._fmus):
            state = c_void_p()
            self._call(number, "fmi2GetFMUstate", fmu.get_state, byref(state))
            snapshot.states.append(state)
        return snapshot

    def restore(self, snapshot: Snapshot) -> None:
        """Go back (or forward) to a snapshot of this engine; what is run from there overwrites the recording."""
        if snapshot not in self._snapshots:
            raise NavfmuError("a snapshot can be restored only in the engine that made it, and only until it is freed")
        for number, (fmu, state) in enumerate(zip(self._fmus, snapshot.states, strict=True)):
            self._call(number, "fmi2SetFMUstate", fmu.set_state, state)
        for array, saved in zip(self._memory, snapshot.memory, strict=True):
            array[...] = saved
        self._place.k, self._place.rows = snapshot.k, snapshot.k // self.plan.record_every + 1
        self._master.turn, self._master.calm = -1, 0
        for component in self._components:
            component.searched = 1
        if self._master.ended >= 0:
            self._master.ended, self._master.interrupt = -1, 0

    def free(self, snapshot: Snapshot) -> None:
        """Release the memory of a snapshot."""
        self._snapshots.remove(snapshot)
        for number, (fmu, state) in enumerate(zip(self._fmus, snapshot.states, strict=False)):
            if self._instances.alive(number):
                self._status(number, "fmi2FreeFMUstate", fmu.free_state, byref(state))
        self._may_go_back()

    def _may_go_back(self) -> None:
        """Steps tell FMUs whether a state before their beginning may be set again: while a snapshot is held."""
        for component in self._components:
            component.never_back = int(not self._snapshots)

    def close(self) -> None:
        """Terminate and free all instances. The recording stays."""
        for snapshot in list(self._snapshots):
            self.free(snapshot)
        with suppress(RunError):
            self.terminate()
        for number, fmu in enumerate(self._fmus):
            instance = self._components[number].instance
            if instance and self._instances.alive(number):
                with self._calling(number, "fmi2FreeInstance"):
                    fmu.free_instance(instance)
                single.give_back(self.plan.parts[number].component)
            self._components[number].instance = None
        self._fmus = []

    # ---- preparation -------------------------------------------------------------------------------------------------

    def _keep(self, array: np.ndarray, kind: Any, *, changes: bool = False) -> int:
        """The address of an array that lives as long as the engine; changing ones belong to snapshots."""
        array = np.ascontiguousarray(array, kind)
        self._kept.append(array)
        if changes:
            self._memory.append(array)
        return array.__array_interface__["data"][0]  # array.ctypes.data, but quicker

    def _make_master(self) -> Master:
        plan, count = self.plan, len(self.plan.signals)
        signal = np.zeros((3, count))
        signal[:, plan.first_driven :] = plan.driven
        columns = [c.slot + (count if c.true and self._disturbed[c.slot] else 0) for c in plan.recorded]
        first_driven_effect = plan.first_driven_effect
        return Master(
            place=ctypes.addressof(self._place),
            component=ctypes.addressof(self._components),
            order=self._keep(np.array(plan.order), np.int32),
            move=self._keep(plan.initial, MOVE),
            moves=len(plan.initial),
            effect=self._keep(self._effects, EFFECT, changes=True),
            echo=self._keep(plan.echoes, ECHO),
            loss=self._keep(self._losses, LOSS, changes=True),
            behind=self._keep(np.zeros(len(plan.parts)), np.int64, changes=True),
            reach=self._keep(plan.reach, np.int32),
            readers=self._keep(plan.readers, np.int32),
            memory=self._keep(plan.memory.copy(), np.float64, changes=True),
            without=self._keep(np.zeros(count), np.float64),
            turned=self._keep(np.zeros(count), np.float64),
            trigger=self._keep(self._triggers, TRIGGER, changes=True),
            triggers=len(plan.triggers),
            acting=self._keep(np.zeros(len(plan.triggers)), np.int32, changes=True),
            acted=self._keep(np.zeros(len(plan.triggers)), np.int32, changes=True),
            faults=len(plan.fault_ids),
            window=self._keep(plan.windows, WINDOW),
            span=self._keep(self._spans, SPAN, changes=True),
            monitor=self._keep(self._monitors, MONITOR, changes=True),
            monitors=len(plan.monitors),
            operation=self._keep(plan.operations, OPERATION),
            signal=self._keep(signal.reshape(-1), np.float64, changes=True),
            components=len(plan.parts),
            signals=count,
            first_driven=plan.first_driven,
            driven=len(plan.driven),
            first_driven_effect=first_driven_effect,
            driven_effects=len(plan.effects) - first_driven_effect,
            algorithm=int(plan.algorithm == "gauss_seidel"),
            columns=len(columns),
            column=self._keep(np.array(columns), np.int32),
            rows=self.rows.ctypes.data,
            record_every=plan.record_every,
            step=plan.clock.step,
            numerator=plan.clock.numerator,
            denominator=plan.clock.denominator,
            ended=-1,
            turn=-1,
        )

    def _inputs(self, group: Inputs) -> structures.Inputs:
        return structures.Inputs(
            count=len(group.names),
            scaled=int(group.scaled),
            references=self._keep(group.references, np.uint32),
            source=self._keep(np.where(group.ahead, self._ahead(group.source), group.source), np.int32),
            factor=self._keep(group.factor, np.float64),
            offset=self._keep(group.offset, np.float64),
        )

    def _fill(self, number: int, to: structures.Component, part: Part) -> None:
        try:
            with self._calling(number, "the loading of its binary"):
                fmu = fmi2(part.component.fmu.library)
                fmu.check(part.component.description)
        except NavfmuError as error:
            raise NavfmuError(f"component '{part.component.name}': {error}") from None
        to.strayed = 0  # a library is loaded once in a process: notes must not depend on what ran before
        self._fmus.append(fmu)
        for name, address in fmu.addresses.items():
            setattr(to, name, address)
        to.never_back = 1
        to.smooth, to.real, to.integer, to.boolean = map(
            self._inputs, (part.smooth, part.real, part.integer, part.boolean)
        )
        smooth = len(part.smooth.names)
        to.ahead = self._keep(self._ahead(part.smooth.source), np.int32)
        to.first_order = self._keep(np.ones(smooth), np.int32)
        to.start = self._keep(np.zeros(smooth), np.float64, changes=True)
        to.slope = self._keep(np.zeros(smooth), np.float64)
        to.real_value = self._keep(np.zeros(len(part.real.names)), np.float64, changes=True)
        to.integer_value = self._keep(np.zeros(len(part.integer.names)), np.int32, changes=True)
        to.boolean_value = self._keep(np.zeros(len(part.boolean.names)), np.int32, changes=True)
        to.reals, to.integers, to.booleans = (len(part.outputs[kind]) for kind in TYPES)
        to.first_signal = part.first_signal
        to.real_reference, to.integer_reference, to.boolean_reference = (
            self._keep(part.outputs[kind], np.uint32) for kind in TYPES
        )
        to.whole = self._keep(np.zeros(max(to.integers, to.booleans)), np.int32)
        to.first_effect, to.effects = part.first_effect, part.effects
        exposed = self._exposed[number]
        to.exposures, to.exposed = len(exposed), self._keep(exposed, np.int32)
        to.foreseen = int((self.plan.readers[exposed] & AHEAD).any())
        to.copied = int(to.foreseen or part.losses > 0 or self._wanted(exposed))
        to.searched = 1
        to.first_loss, to.losses = part.first_loss, part.losses

    def _wanted(self, exposed: np.ndarray) -> bool:
        """Whether a true value is recorded, or asked for."""
        recorded = [column.slot for column in self.plan.recorded if column.true]
        asked = self.plan.operations["place"][self.plan.operations["kind"] == Op.LOAD_SIGNAL] - len(self.plan.signals)
        return bool(np.isin(exposed, [*recorded, *asked]).any())

    def _ahead(self, source: np.ndarray) -> np.ndarray:
        """Where to find the value at the end of a step: what no fault can change is where it always is."""
        return np.where(self._disturbed[source], source + 2 * len(self.plan.signals), source)

    def _instantiate(self, number: int, part: Part) -> None:
        component, fmu = part.component, self._fmus[number]
        log, callbacks = self._logs[number], self._callbacks[number]
        self._library.prepare_callbacks(byref(callbacks), byref(log))
        resources = resource_uri(component.fmu.folder).encode()
        texts = (component.name.encode(), 1, component.description.guid.encode(), resources)  # 1: co-simulation
        single.take(component)
        self._instances.add(component)
        with self._calling(number, "fmi2Instantiate"):
            instance = fmu.instantiate(*texts, ctypes.addressof(callbacks), 0, 1)
        if not instance:
            single.give_back(component)
            said = log.complaint() or "it gave no reason"
            raise RunError(f"component '{component.name}' could not be instantiated: {said}")
        self._components[number].instance = instance

    def _configure(self, number: int, part: Part) -> None:
        fmu = self._fmus[number]
        stop = self.plan.clock.time(self.plan.clock.steps)
        tolerance = part.component.description.tolerance
        given = (0, 0.0) if tolerance is None else (1, tolerance)
        self._call(number, "fmi2SetupExperiment", fmu.setup_experiment, *given, 0.0, 1, stop)
        for kind, values in part.settings.items():
            if values.names:
                ctype = {"Real": c_double, "String": c_char_p}.get(kind, c_int)
                encoded = [v.encode() if isinstance(v, str) else v for v in values.values]
                array = (ctype * len(encoded))(*encoded)
                references = (ctypes.c_uint32 * len(encoded))(*values.references.tolist())
                self._call(number, f"fmi2Set{kind}", fmu.set[kind], references, len(encoded), array)
        self._call(number, "fmi2EnterInitializationMode", fmu.enter_initialization)

    def _call(self, number: int, name: str, function: Any, *arguments: Any) -> None:
        self._look_for_dead()
        status = self._status(number, name, function, *arguments)
        if status not in GOES_ON:
            self._refuse(number, name, status)

    def _status(self, number: int, name: str, function: Any, *arguments: Any) -> int:
        """The status of a call, which is noted."""
        with self._calling(number, name):
            status = function(self._components[number].instance, *arguments)
        self._components[number].warnings += status == WARNING
        self._instances.returned(number, status)
        return status

    @contextmanager
    def _calling(self, number: int, name: str) -> Iterator[None]:
        """Leave word of the call that comes now, and see that it leaves nothing behind."""
        self._place.component, self._place.call = number, NAMES.index(name)
        self._watch()
        with floating.ordinary():
            try:
                yield
            finally:
                self._components[number].strayed |= floating.make_ordinary()
                self._nowhere()

    def _nowhere(self) -> None:
        """Leave word that the call came back."""
        self._place.component = -1
        self._library.watch(None, None, None, 0.0)

    def _watch(self) -> None:
        """Have it told who ends this process, if an FMU does."""
        if self._watches:
            self._library.watch(
                ctypes.addressof(self._place), ctypes.addressof(self._names), ctypes.addressof(_CALLS), self._step
            )


def run(plan: Plan, progress: Progress | None = None, memory: Memory | BlackBox | None = None) -> Recording:
    """Run a plan from beginning to end."""
    with Compiled(plan, memory) as engine:
        engine.complete(progress)
    return engine.recording()  # with what FMUs have said until they were freed
