"""The reference engine: the same plan in plain Python on FMPy, written to be read and not to be fast.

It is the oracle of the compiled engine: recordings must agree to the last bit, for both algorithms, with and without
faults. It shares the plan with it, and the C function that formats an FMU's messages, nothing else.
"""

from __future__ import annotations

import math
from contextlib import suppress
from ctypes import byref
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions

from navfmu.engine import floating, single
from navfmu.engine.fatal import FATAL, Instances
from navfmu.engine.initial import GIVE, LEAVE, READ
from navfmu.engine.injector import Injector
from navfmu.engine.inputs import Inputs
from navfmu.engine.link import TYPES
from navfmu.engine.loading import engine_library
from navfmu.engine.monitor import Observer
from navfmu.engine.operations import program_of
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
    room,
    unmoved,
    warned,
)
from navfmu.engine.structures import (
    ASKED,
    DISCARD,
    LAST_SUCCESSFUL_TIME,
    NAMES,
    OK,
    TERMINATED,
    WARNING,
    Callbacks,
    Log,
)
from navfmu.engine.trigger import Trigger
from navfmu.errors import NavfmuError


@dataclass
class Snapshot:
    """The state of a run at a communication point."""

    k: int
    states: list[Any]
    values: list[float]
    truth: list[float]
    ahead: list[float]
    begin: list[list[float]]
    triggers: list[Any]
    behind: list[int]
    lost_at: list[int]
    injectors: list[Any]
    observers: list[np.void]


class FMU2Counting(FMU2Slave):
    """FMPy's instance (which wants a name like this), which also sees what calls leave behind."""

    warnings = 0  # calls that returned Warning
    strayed = 0  # what they changed of how this thread calculates

    def _call(self, fname: str, *args: Any) -> Any:
        try:
            result = super()._call(fname, *args)
        finally:
            self.strayed |= floating.make_ordinary()
        if isinstance(result, int) and result < OK:  # which FMPy takes for one
            raise FMICallException(fname, result)
        self.warnings += fname in NAMES and fname not in ASKED and result == WARNING
        return result


class _Ended(Exception):
    """An FMU wants to end the run and has not made the step."""


class Reference:
    """One run of a plan."""

    @floating.ordinary()
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.k = 0
        count = len(plan.signals)
        self.values = [0.0] * count  # as they left
        self.truth = [0.0] * count  # before faults
        self.ahead = [0.0] * count  # at the end of the step, with the faults of its beginning
        self.begin: list[list[float]] = [[] for _ in plan.parts]  # smooth inputs at the beginning of the step
        self.rows = room(plan)
        self._triggers = [
            Trigger(
                row,
                plan.windows,
                program_of(plan.operations, row["first_operation"], row["operations"], plan.fault_ids),
            )
            for row in plan.triggers
        ]
        self._injectors = [self._injector(part.first_effect, part.first_effect + part.effects) for part in plan.parts]
        self._driver = self._injector(plan.first_driven_effect, len(plan.effects))
        self._observers = [Observer(row, plan.operations, plan.fault_ids) for row in plan.monitors]
        self._behind = [0] * len(plan.parts)  # steps that each has lost and not made up for
        self._lost_at = plan.losses["seen"].tolist()
        self._logs = (Log * len(plan.parts))()
        self._fmus: list[FMU2Counting] = []
        self._gone: list[FMU2Counting] = []  # once they are freed
        self._refused: set[int] = set()
        self._instances = Instances()
        self._lost: dict[str, int] = {}
        self._initialised = self._terminated = False
        self._ended, self._last = -1, math.nan  # the component that has ended the run; how far a discarded step got (s)
        self._turn = -1  # the component at which a step was left that is not complete
        self._snapshots = 0  # that are held
        try:
            for number, part in enumerate(plan.parts):
                self._instantiate(number, part)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Reference:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @floating.ordinary()
    def initialise(self) -> None:
        """Set start values and bring every component to t = 0."""
        for number, part in enumerate(self.plan.parts):
            self._configure(number, part)
        self._move_triggers(0)
        self._drive(0)
        for move in self.plan.initial:
            {READ: self._read, GIVE: self._give, LEAVE: self._leave}[int(move["kind"])](move)
        self._record()
        self._observe()
        self._initialised = True

    @floating.ordinary()
    def advance(self, until: int | None = None) -> None:
        """Run to communication point ``until`` (default: the end)."""
        end = self.plan.clock.steps if until is None else min(until, self.plan.clock.steps)
        step = {"jacobi": self._jacobi, "gauss_seidel": self._gauss_seidel}[self.plan.algorithm]
        while self.k < end and self._ended < 0:
            self._look_for_dead()
            self._move_triggers(self.k + 1)
            try:
                step()
            except _Ended:
                return
            self._turn = -1
            self.k += 1
            self._drive(self.k)
            self._record()
            self._observe()

    def run(self, progress: Any = None) -> Recording:
        """Initialise, run to the end, terminate."""
        self.complete(progress)
        return self.recording()

    def complete(self, progress: Any = None) -> None:
        """Do the whole run."""
        self.initialise()
        steps = self.plan.clock.steps
        while self.k < steps and self._ended < 0:
            self.advance(self.k + 100)
            if progress is not None:
                progress(self.k if self._ended < 0 else steps, steps)
        self.terminate()

    @floating.ordinary()
    def terminate(self) -> None:
        """End the run; a refusal is one of the run."""
        if self._terminated or not self._initialised:
            return
        self._count_lost()
        self._terminated, refused = True, []
        for number, fmu in enumerate(self._fmus):
            if number not in self._refused and self._instances.alive(number):
                try:
                    fmu.terminate()
                except FMICallException as error:
                    self._instances.returned(number, error.status)
                    refused.append((number, error))
        self._refused |= {number for number, _ in refused}
        for number, error in refused:
            self._refuse(number, error)

    @floating.ordinary()
    def recording(self) -> Recording:
        """What has been recorded so far."""
        rows, lost = self.rows[: self.k // self.plan.record_every + 1].copy(), self._count_lost()
        fmus = self._fmus or self._gone
        counts = [fmu.warnings for fmu in fmus]
        notes = ended(self.plan, self._logs, self._ended, self.k, self._last) + warned(self.plan, self._logs, counts)
        notes += complained(self.plan, self._logs, {*self._refused, self._ended})
        notes += floating.strayed(self.plan, [fmu.strayed for fmu in fmus])
        over = self.k == self.plan.clock.steps or self._ended >= 0
        seen = [point for injector in (*self._injectors, self._driver) for point in injector.seen]
        seen += self._lost_at
        acted = [trigger.spans for trigger in self._triggers]
        idle = unmoved(self.plan, seen, self.k, over, self._turn, acted)
        found = observed(self.plan, [observer.row for observer in self._observers], self.k)
        return recording(self.plan, rows, notes, lost, idle, found, acted, self.k, over)

    def _count_lost(self) -> dict[str, int]:
        """Samples that were lost so far; what was read last, once an FMU has refused a call or is gone."""
        for number, fmu in enumerate(() if self._refused or self._terminated else self._fmus):
            counters, name = self.plan.parts[number].counters, self.plan.parts[number].component.name
            if counters and self._instances.alive(number):
                try:
                    values = fmu.getInteger([counter.reference for counter in counters])
                    self._lost |= {f"{name}.{c.name}": n for c, n in zip(counters, values, strict=True)}
                except FMICallException as error:
                    self._instances.returned(number, error.status)
        return self._lost

    def _injector(self, first: int, end: int) -> Injector:
        """The effects first <= n < end of the plan."""
        plan, rows = self.plan, list(self.plan.effects[first:end])
        reach = [plan.reached(row["first_reach"], row["reaches"]) for row in rows]
        pairs = [
            list(zip(plan.reached(row["first_pair"], n), plan.reached(row["first_pair"] + n, n), strict=True))
            for row, n in zip(rows, self.plan.effects["pairs"][first:end].tolist(), strict=True)
        ]
        return Injector(rows, reach, pairs, self._triggers, plan.clock, plan.readers.tolist(), plan.record_every)

    def _move_triggers(self, k: int) -> None:
        if k:
            signals, active = self._visible()
            for trigger in self._triggers:  # all are asked before one of them moves
                trigger.ask(signals, self.plan.clock.time(k - 1), active)
        for trigger in self._triggers:
            trigger.move(k, self.plan.clock)

    # ---- initial values ----------------------------------------------------------------------------------------------

    def _read(self, move: np.void) -> None:
        """One output, in initialisation mode."""
        number, kind = int(move["component"]), TYPES[move["type"]]
        (value,) = self._call(number, f"get{kind}", [int(move["reference"])])
        part = self.plan.parts[number]
        truth = {slot: self.truth[slot] for slot in range(part.first_signal, part.first_signal + part.signals)}
        self._send(number, truth | {int(move["slot"]): _number(kind, value)}, 0, int(move["slot"]))

    def _give(self, move: np.void) -> None:
        """One input, in initialisation mode."""
        value, kind = self.values[move["slot"]], TYPES[move["type"]]
        if (move["factor"], move["offset"]) != (1.0, 0.0):
            value = float(move["factor"]) * value + float(move["offset"])
        self._call(int(move["component"]), f"set{kind}", [int(move["reference"])], [_typed(kind, value)])

    def _leave(self, move: np.void) -> None:
        """The end of a component's initialisation, with all its inputs and outputs."""
        number = int(move["component"])
        part = self.plan.parts[number]
        self._begin_smooth(number, part)
        if part.smooth.names:
            self._call(number, "setReal", part.smooth.references.tolist(), self.begin[number])
        self._set_held(number, part)
        self._call(number, "exitInitializationMode")
        self._read_outputs(number, part, 0)

    # ---- algorithms --------------------------------------------------------------------------------------------------

    def _jacobi(self) -> None:
        for number, part in enumerate(self.plan.parts):
            if not self._loses(number, part):
                self._set_held(number, part)
        for number, part in enumerate(self.plan.parts):
            self._turn = number
            if self._loses(number, part):
                self._stand_still(number, part)
            else:
                self._make_step(number)
                self._read_outputs(number, part, self.k + 1)

    def _gauss_seidel(self) -> None:
        for number in self.plan.order:
            part, self._turn = self.plan.parts[number], number
            if self._loses(number, part):
                self._stand_still(number, part)
                continue
            self._set_smooth(number, part)
            self._set_held(number, part)
            self._make_step(number)
            self._read_outputs(number, part, self.k + 1)

    # ---- one component -----------------------------------------------------------------------------------------------

    def _set_held(self, number: int, part: Part) -> None:
        for kind, group in zip(TYPES, (part.real, part.integer, part.boolean), strict=True):
            if group.names:
                now, ahead = _inputs(group, self.values), _inputs(group, self.ahead)
                values = [a if is_ahead else n for n, a, is_ahead in zip(now, ahead, group.ahead, strict=True)]
                self._call(number, f"set{kind}", group.references.tolist(), [_typed(kind, value) for value in values])

    def _begin_smooth(self, number: int, part: Part) -> None:
        self.begin[number] = _inputs(part.smooth, self.values)

    def _set_smooth(self, number: int, part: Part) -> None:
        if not part.smooth.names:
            return
        references = part.smooth.references.tolist()
        ends = _inputs(part.smooth, self.ahead)
        slopes = [(end - begin) / self._length(number) for begin, end in zip(self.begin[number], ends, strict=True)]
        self._call(number, "setReal", references, self.begin[number])
        self._call(number, "setRealInputDerivatives", references, [1] * len(references), slopes)
        self._begin_smooth(number, part)

    def _make_step(self, number: int) -> None:
        begin, h = self.plan.clock.time(self.k - self._behind[number]), self._length(number)
        self._behind[number] = 0
        try:
            self._fmus[number].doStep(begin, h, int(not self._snapshots))
        except FMICallException as error:
            if error.status != DISCARD:
                self._refuse(number, error)
            self._discarded(number, error)

    def _length(self, number: int) -> float:
        """How long the coming step of a component is (s): it makes up for those that it has lost."""
        return self.plan.clock.step * (self._behind[number] + 1)

    def _loses(self, number: int, part: Part) -> bool:
        """Whether the coming step of a component is lost."""
        lost = False
        for place in range(part.first_loss, part.first_loss + part.losses):
            if self._triggers[self.plan.losses["trigger"][place]].before.acts:
                lost = True
                if self._lost_at[place] < 0:
                    self._lost_at[place] = 3 * self.k + 1
        return lost

    def _stand_still(self, number: int, part: Part) -> None:
        """The step is lost: the outputs are what they were, under the faults of the next point."""
        self._behind[number] += 1
        held = {slot: self.truth[slot] for slot in range(part.first_signal, part.first_signal + part.signals)}
        self._send(number, held, self.k + 1)

    def _discarded(self, number: int, error: FMICallException) -> None:
        """A step was discarded: because the FMU wants to end the run? Then the step may have been made all the same."""
        fmu, terminated, self._last = self._fmus[number], False, math.nan
        try:
            terminated = fmu.getBooleanStatus(TERMINATED)
        except FMICallException as answer:
            self._unless_fatal(number, answer)
        try:
            self._last = fmu.getRealStatus(LAST_SUCCESSFUL_TIME)
        except FMICallException as answer:
            self._unless_fatal(number, answer)
        if not terminated:
            self._refuse(number, error, got_to(self._last))
        self._ended = number
        clock = self.plan.clock
        if not self._last > clock.time(self.k + 1) - 1e-9 * clock.step:
            raise _Ended

    def _unless_fatal(self, number: int, error: FMICallException) -> None:
        """Put up with a question that an FMU does not answer."""
        if error.status == FATAL:
            self._refuse(number, error)

    def _outputs(self, number: int, part: Part) -> dict[int, float]:
        values: list[float] = []
        for kind in TYPES:
            references = part.outputs[kind].tolist()
            if references:
                read = self._call(number, f"get{kind}", references)
                values += [_number(kind, value) for value in read]
        return dict(enumerate(values, part.first_signal))

    def _read_outputs(self, number: int, part: Part, k: int) -> None:
        self._send(number, self._outputs(number, part), k)

    def _send(self, number: int, truth: dict[int, float], k: int, only: int | None = None) -> None:
        """True values leave at communication point ``k``; of those of 0 perhaps ``only`` one."""
        ahead = self._injectors[number].ahead(truth, k - 1)
        leaving = self._injectors[number].leave(truth, k, only)
        if k == 0:
            ahead = leaving  # no step yet: what leaves is what every input gets
        for slot, value in truth.items():
            self.truth[slot], self.ahead[slot], self.values[slot] = value, ahead[slot], leaving[slot]

    def _drive(self, k: int) -> None:
        truth = {self.plan.first_driven + i: float(value) for i, value in enumerate(self.plan.driven)}
        for slot, value in self._driver.leave(truth, k).items():
            self.values[slot] = value

    def _record(self) -> None:
        row, rest = divmod(self.k, self.plan.record_every)
        if rest == 0:
            self.rows[row] = [(self.truth if c.true else self.values)[c.slot] for c in self.plan.recorded]

    def _observe(self) -> None:
        signals, active = self._visible()
        faults = self._triggers[: len(self.plan.fault_ids)]
        for observer in self._observers:
            observer.observe(signals, self.k, self.plan.clock.time(self.k), active, faults)

    def _visible(self) -> tuple[list[float], dict[str, bool]]:
        """What expressions see: all signals, and whether each fault acts, "" for any."""
        acting = [trigger.now.acts for trigger in self._triggers[: len(self.plan.fault_ids)]]
        active = dict(zip(self.plan.fault_ids, acting, strict=True)) | {"": any(acting)}
        return [*self.values, *self.truth], active

    # ---- states ------------------------------------------------------------------------------------------------------

    @floating.ordinary()
    def snapshot(self) -> Snapshot:
        """The state of the whole run, to come back to with ``restore``."""
        for part in self.plan.parts:
            if not part.component.restores:
                raise NavfmuError(f"component '{part.component.name}' cannot save its state (canGetAndSetFMUstate)")
        self._look_for_dead()
        self._snapshots += 1
        states = [self._call(number, "getFMUstate") for number in range(len(self._fmus))]
        triggers = [trigger.state() for trigger in self._triggers]
        injectors = [injector.state() for injector in (*self._injectors, self._driver)]
        lists = list(self.values), list(self.truth), list(self.ahead), [list(begin) for begin in self.begin]
        observers = [observer.state() for observer in self._observers]
        return Snapshot(self.k, states, *lists, triggers, list(self._behind), list(self._lost_at), injectors, observers)

    @floating.ordinary()
    def restore(self, snapshot: Snapshot) -> None:
        """Go back (or forward) to a snapshot of this engine."""
        self._look_for_dead()
        for number, state in enumerate(snapshot.states):
            self._call(number, "setFMUstate", state)
        for trigger, saved in zip(self._triggers, snapshot.triggers, strict=True):
            trigger.set_state(saved)
        for injector, state in zip((*self._injectors, self._driver), snapshot.injectors, strict=True):
            injector.set_state(state)
        for observer, seen in zip(self._observers, snapshot.observers, strict=True):
            observer.set_state(seen)
        self.k, self._ended, self._turn = snapshot.k, -1, -1
        self._behind, self._lost_at = list(snapshot.behind), list(snapshot.lost_at)
        self.values, self.truth, self.ahead = list(snapshot.values), list(snapshot.truth), list(snapshot.ahead)
        self.begin = [list(begin) for begin in snapshot.begin]

    @floating.ordinary()
    def free(self, snapshot: Snapshot) -> None:
        """Release the memory of a snapshot."""
        self._snapshots -= 1
        for number, (fmu, state) in enumerate(zip(self._fmus, snapshot.states, strict=True)):
            if self._instances.alive(number):
                try:
                    fmu.freeFMUstate(state)
                except FMICallException as error:
                    self._instances.returned(number, error.status)

    @floating.ordinary()
    def close(self) -> None:
        """Terminate and free all instances."""
        with suppress(RunError):
            self.terminate()
        for number, fmu in enumerate(self._fmus):
            if fmu.component is not None and self._instances.alive(number):
                fmu.fmi2FreeInstance(fmu.component)
                single.give_back(self.plan.parts[number].component)
        self._gone, self._fmus = self._fmus or self._gone, []

    # ---- calls -------------------------------------------------------------------------------------------------------

    def _instantiate(self, number: int, part: Part) -> None:
        component, log = part.component, self._logs[number]
        try:
            fmu = FMU2Counting(
                guid=component.description.guid,
                modelIdentifier=component.description.model_identifier,
                unzipDirectory=str(component.fmu.folder.resolve()),
                instanceName=component.name,
                libraryPath=str(component.fmu.library),
            )
        except Exception as error:  # also of a library that lacks a function, whether or not it is needed
            raise NavfmuError(f"component '{component.name}': FMPy cannot load its binary: {error}") from None
        finally:
            floating.make_ordinary()
        callbacks = fmi2CallbackFunctions()
        engine_library().prepare_callbacks(Callbacks.from_buffer(callbacks), byref(log))
        single.take(component)
        self._instances.add(component)
        try:
            fmu.instantiate(callbacks=callbacks, loggingOn=True)
        except Exception:  # FMPy raises Exception itself
            single.give_back(component)
            said = log.complaint() or "it gave no reason"
            raise RunError(f"component '{component.name}' could not be instantiated: {said}") from None
        self._fmus.append(fmu)

    def _configure(self, number: int, part: Part) -> None:
        self._look_for_dead()
        stop = self.plan.clock.time(self.plan.clock.steps)
        self._call(number, "setupExperiment", part.component.description.tolerance, 0.0, stop)
        for kind, settings in part.settings.items():
            if settings.names:
                self._call(number, f"set{kind}", settings.references.tolist(), settings.values)
        self._call(number, "enterInitializationMode")

    def _call(self, number: int, name: str, *arguments: Any) -> Any:
        try:
            return getattr(self._fmus[number], name)(*arguments)
        except FMICallException as error:
            self._refuse(number, error)

    def _look_for_dead(self) -> None:
        """Go no further when the FMU of a component has failed for good in another run."""
        number = self._instances.dead()
        if number is not None:
            partial = self.recording() if self._initialised else None
            raise RunError(dead(self.plan.parts[number].component), partial)

    def _refuse(self, number: int, error: FMICallException, more: str = "") -> NoReturn:
        self._refused.add(number)
        self._instances.returned(number, error.status)
        name, when = self.plan.parts[number].component.name, self.plan.clock.time(self.k)
        raise RunError(
            refusal(name, error.function, error.status, when, self._logs[number].refused()) + more,
            self.recording() if self._initialised else None,
            component=name,
            call=error.function,
            time=when,
        ) from None


def _number(kind: str, value: Any) -> float:
    """What an FMU has returned, as a signal."""
    return float(value != 0) if kind == "Boolean" else float(value)


def _typed(kind: str, value: float) -> float | int:
    """A signal, as an FMU gets it."""
    return value if kind == "Real" else int(value) if kind == "Integer" else int(value != 0.0)


def _inputs(group: Inputs, signals: list[float]) -> list[float]:
    """The values of a group of inputs; what is not scaled keeps its bits."""
    values = [signals[slot] for slot in group.source.tolist()]
    scales = zip(values, group.factor.tolist(), group.offset.tolist(), strict=True)
    return [value if (factor, offset) == (1.0, 0.0) else factor * value + offset for value, factor, offset in scales]


def run(plan: Plan, progress: Any = None) -> Recording:
    """Run a plan from beginning to end."""
    with Reference(plan) as engine:
        engine.complete(progress)
    return engine.recording()
