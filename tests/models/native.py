"""Running a component in tests: its native FMU through FMPy, or the interpreter."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from ctypes import c_double, c_uint
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter


class Native:
    """A native FMU; names of whole arrays are allowed in ``record``, ``inputs`` and parameters."""

    def __init__(self, component: type, folder: Path) -> None:
        path = build(component, folder)[0]
        self.folder = folder / f"{component.layout.name}-unzipped"
        fmpy.extract(str(path), str(self.folder))
        self.description = fmpy.read_model_description(str(path))
        self.fields = component.layout.fields
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="tested",
        )
        self.fmu.instantiate()

    def run(
        self,
        stop: float,
        step: float,
        record: Iterable[str],
        parameters: dict[str, Any] | None = None,
        inputs: Callable[[float], dict[str, Any]] | None = None,
    ) -> dict[str, np.ndarray]:
        """Values at 0, step, ... stop, of reals and single integers.

        Inputs are set before each step (those that change).
        """
        fmu = self.fmu
        fmu.reset()
        fmu.setupExperiment(startTime=0.0)
        for name, value in (parameters or {}).items():
            self._set(fmu, name, value)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        count = round(stop / step)
        wanted = [self.fields[name] for name in record]
        fields = [field for field in wanted if field.type == "Real"]
        counted = [field for field in wanted if field.type == "Integer"]
        numbered = {field.name: np.empty(count + 1) for field in counted}

        def look(k: int) -> None:
            for field in counted:
                numbered[field.name][k] = fmu.getInteger([field.index])[0]

        references = [i for f in fields for i in range(f.index, f.index + f.size)]
        values = np.empty((count + 1, len(references)))
        # FMPy's lists would take most of the time: one array of references, the rows of the result as buffers
        numbers = (c_uint * len(references))(*references)
        rows = [(c_double * len(references)).from_buffer(row) for row in values]
        fmu.fmi2GetReal(fmu.component, numbers, len(references), rows[0])
        look(0)
        for k in range(count):
            if inputs is not None:
                for name, value in inputs(k * step).items():
                    self._set(fmu, name, value)
            fmu.fmi2DoStep(fmu.component, k * step, step, 1)
            fmu.fmi2GetReal(fmu.component, numbers, len(references), rows[k + 1])
            look(k + 1)
        fmu.terminate()
        result, column = {"time": np.arange(count + 1) * step, **numbered}, 0
        for field in fields:
            block = values[:, column : column + field.size]
            result[field.name] = block if field.shape else block[:, 0]
            column += field.size
        return result

    def _set(self, fmu: FMU2Slave, name: str, value: Any) -> None:
        field = self.fields[name]
        numbers = np.ravel(np.broadcast_to(np.asarray(value, float), field.shape))
        references = list(range(field.index, field.index + field.size))
        if field.type == "Real":
            fmu.setReal(references, numbers.tolist())
        elif field.type == "Integer":
            fmu.setInteger(references, [int(x) for x in numbers])
        else:
            fmu.setBoolean(references, [bool(x) for x in numbers])


def interpret(component: type, **values: Any) -> Interpreter:
    """An initialised interpreter; parameters and inputs by keyword."""
    run = Interpreter(component)
    for name, value in values.items():
        run.set(name, value)
    run.setup()
    return run
