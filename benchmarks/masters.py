"""One system in several masters: each can make more steps of it, without recording, and show its last outputs."""

from __future__ import annotations

import ctypes
import tempfile
import time
import zipfile
from pathlib import Path

from benchmarks.bare import Bare
from navfmu.engine.compiled import Compiled
from navfmu.engine.plan import Plan
from navfmu.ssp.document import PARAMETER_SET


class Ours:
    """The compiled engine; it records one row at the end."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.engine = Compiled(plan)
        self.engine.initialise()

    def run(self, steps: int) -> float:
        before = time.perf_counter()
        self.engine.advance(self.engine.k + steps)
        return time.perf_counter() - before

    def outputs(self) -> dict[str, float]:
        """Outputs that are connected or recorded, by "component.variable"."""
        signals = (ctypes.c_double * len(self.plan.signals)).from_address(self.engine._master.signal)
        return dict(zip(self.plan.signals, signals, strict=True))


class BareLoop:
    """The generated C loop over instances of its own."""

    def __init__(self, plan: Plan) -> None:
        self.plan, self.k = plan, 0
        self.engine = Compiled(plan)
        self.engine.initialise()
        self.loop = Bare(plan, self.engine)

    def run(self, steps: int) -> float:
        seconds = self.loop.run(self.k, steps)
        self.k += steps
        return seconds

    def outputs(self) -> dict[str, float]:
        return dict(zip(self.plan.signals, self.loop.signals.tolist(), strict=True))


class FmpyLoop:
    """A Jacobi loop over FMPy's API as its users write it: references prepared, a list of values for each call."""

    def __init__(self, plan: Plan) -> None:
        from fmpy.fmi2 import FMU2Slave

        self.plan, self.k, self.s = plan, 0, [0.0] * len(plan.signals)
        self.parts = []
        for part in plan.parts:
            component = part.component
            slave = FMU2Slave(
                guid=component.description.guid,
                unzipDirectory=str(component.fmu.folder),
                modelIdentifier=component.description.model_identifier,
                instanceName=component.name,
            )
            slave.instantiate()
            slave.setupExperiment(startTime=0.0)
            for kind, settings in part.settings.items():
                if len(settings.references):
                    getattr(slave, f"set{kind}")(settings.references.tolist(), list(settings.values))
            slave.enterInitializationMode()
            groups = (("Real", part.smooth), ("Real", part.real), ("Integer", part.integer), ("Boolean", part.boolean))
            sets = [
                (getattr(slave, f"set{kind}"), group.references.tolist(), group.source.tolist(), kind)
                for kind, group in groups
                if len(group.references)
            ]
            gets, slot = [], part.first_signal
            for kind, references in part.outputs.items():
                if len(references):
                    gets.append((getattr(slave, f"get{kind}"), references.tolist(), slot, slot + len(references)))
                slot += len(references)
            self.parts.append((slave, sets, gets))
        for number in range(len(plan.parts)):
            self._get(*self.parts[number])
        for number in plan.order:
            self._set(*self.parts[number])
            self.parts[number][0].exitInitializationMode()
            self._get(*self.parts[number])

    def _set(self, slave, sets, gets) -> None:
        s = self.s
        for put, references, source, kind in sets:
            values = [s[i] for i in source]
            put(references, values if kind == "Real" else [int(v) for v in values])

    def _get(self, slave, sets, gets) -> None:
        for get, references, first, end in gets:
            self.s[first:end] = get(references)

    def run(self, steps: int) -> float:
        step = self.plan.clock.step
        before = time.perf_counter()
        for k in range(self.k, self.k + steps):
            t = self.plan.clock.time(k)
            for part in self.parts:
                self._set(*part)
            for part in self.parts:
                part[0].doStep(currentCommunicationPoint=t, communicationStepSize=step)
                self._get(*part)
        self.k += steps
        return time.perf_counter() - before

    def outputs(self) -> dict[str, float]:
        return dict(zip(self.plan.signals, map(float, self.s), strict=True))


class Ecos:
    """ecospy on the SSP."""

    def __init__(self, ssp: Path, plan: Plan) -> None:
        import ecospy

        ecospy.EcosLib.set_log_level("warn")
        self.plan = plan
        self.simulation = ecospy.EcosSimulation(ssp_path=str(ssp), step_size=plan.clock.step)
        assert self.simulation.init(parameter_set=PARAMETER_SET)

    def run(self, steps: int) -> float:
        before = time.perf_counter()
        self.simulation.step(steps)
        return time.perf_counter() - before

    def outputs(self) -> dict[str, float]:
        get = self.simulation
        getters = {"Real": get.get_real, "Integer": get.get_integer, "Boolean": get.get_bool}
        types = {
            f"{p.component.name}.{v.name}": v.type for p in self.plan.parts for v in p.component.description.variables
        }
        return {name: float(getters[types[name]](name.replace(".", "::", 1))) for name in self.plan.signals}


class Libcosim:
    """libcosimpy on the unpacked SSP, with an observer of last values that is read at the end only."""

    def __init__(self, ssp: Path, plan: Plan) -> None:
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

        log_output_level(CosimLogLevel.WARNING)
        self.plan = plan
        self.folder = tempfile.TemporaryDirectory()
        with zipfile.ZipFile(ssp) as archive:
            archive.extractall(self.folder.name)
        self.execution = CosimExecution.from_ssp_file(self.folder.name, step_size=round(plan.clock.step * 1e9))
        self.observer = None

    def run(self, steps: int) -> float:
        before = time.perf_counter()
        assert self.execution.step(steps)
        return time.perf_counter() - before

    def outputs(self) -> dict[str, float]:
        from libcosimpy.CosimObserver import CosimObserver

        observer = CosimObserver.create_last_value()
        assert self.execution.add_observer(observer)
        assert self.execution.step(1)  # observers see a step only; compare() takes this into account
        values = {}
        for part in self.plan.parts:
            index = self.execution.slave_index_from_instance_name(part.component.name)
            for kind, references in part.outputs.items():
                if len(references):
                    read = getattr(observer, f"last_{kind.lower()}_values")
                    values[part.component.name, kind] = read(index, references.tolist())
        flat = [
            value
            for part in self.plan.parts
            for kind, references in part.outputs.items()
            if len(references)
            for value in values[part.component.name, kind]
        ]
        return dict(zip(self.plan.signals, map(float, flat), strict=True))


def check_equal(ssp: Path, plan: Plan, steps: int = 500) -> None:
    """All masters give the same bits after some steps, or their times would not be comparable."""
    expected: dict[int, dict[str, float]] = {}
    ours = Ours(plan)
    ours.run(steps)
    expected[steps] = ours.outputs()
    ours.run(1)
    expected[steps + 1] = ours.outputs()
    for master in (BareLoop(plan), FmpyLoop(plan), Ecos(ssp, plan), Libcosim(ssp, plan)):
        master.run(steps)
        made = steps + isinstance(master, Libcosim)
        assert master.outputs() == expected[made], f"{type(master).__name__} differs"


def check_bare(plan: Plan, steps: int = 500) -> None:
    """The bare loop gives the bits of the engine, in any algorithm."""
    ours, bare = Ours(plan), BareLoop(plan)
    ours.run(steps)
    bare.run(steps)
    assert bare.outputs() == ours.outputs(), "BareLoop differs"
