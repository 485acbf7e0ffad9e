"""A system of FMUs that can be run.

from navfmu import System

flight = System.load("backup_navigator", variant="scanning")
result = flight.run(stop=2100, seed=7, faults="gps_lost.toml", record=["evaluation.horizontal_error"])
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from navfmu.errors import NavfmuError, nearest
from navfmu.fmi.fmu import Fmu, Variable, load
from navfmu.fmi.units import Unit, conversion
from navfmu.fmi.values import checked, expand
from navfmu.ssp import reader
from navfmu.ssp.structure import Component, Connection, Setting, Structure
from navfmu.system import shipped

if TYPE_CHECKING:
    import pandas

    from navfmu.engine import plan as engine_plan
    from navfmu.engine.recording import Recording
    from navfmu.faults import Fault

ENGINES = ("compiled", "reference")
ROWS = 10_000  # recorded at every step up to here, then more rarely, unless a period is given
NAVIGATION = ("evaluation", "navigator")  # components whose outputs are recorded when no signal is named


@dataclass(frozen=True, eq=False)
class System:
    """A system structure with its FMUs unpacked. Running it changes nothing in it: threads may share it."""

    structure: Structure
    fmus: Mapping[str, Fmu]  # by component
    values: Mapping[str, Mapping[str, Any]]  # start values by component and variable, from the documents
    links: tuple[tuple[str, str, float, float], ...]  # source, target, factor, offset
    variant: str | None = None

    @classmethod
    def load(cls, path: str | Path, variant: str | None = None) -> System:
        """Load an .ssp, a folder with SystemStructure.ssd, an .ssd, one .fmu, or a shipped system by its name."""
        file = shipped.system(str(path))
        if file.suffix.lower() == ".fmu":
            if variant is not None:
                raise NavfmuError(f"{file}: a single FMU has no variants")
            return cls.of(_single(file))
        return cls.of(reader.read(file, variant, shipped.find), variant)

    @classmethod
    def of(cls, structure: Structure, variant: str | None = None) -> System:
        """Open the FMUs of a structure and check that everything in it fits them."""
        fmus = {name: _open(component, structure) for name, component in structure.components.items()}
        for name, component in structure.components.items():
            _check_connectors(component, fmus[name])
        values = {
            name: _settings(component, fmus[name], structure.ignored)
            for name, component in structure.components.items()
        }
        links = tuple(_link(connection, structure, fmus) for connection in structure.connections)
        system = cls(structure, fmus, values, links, variant)
        system._check_unconnected()
        return system

    @property
    def name(self) -> str:
        """The name that the system structure gives itself."""
        return self.structure.name

    @property
    def digest(self) -> str:
        """A hash of everything that determines a run beside its arguments: FMUs, connections, values."""
        total = hashlib.sha256()
        for name, fmu in self.fmus.items():
            total.update(f"{name}={fmu.digest};{sorted(self.values[name].items())!r};".encode())
        total.update(repr(self.links).encode())
        return total.hexdigest()

    def hashes(self) -> dict[str, str]:
        """SHA-256 of each component's FMU."""
        return {name: fmu.digest for name, fmu in self.fmus.items()}

    def variable(self, name: str, where: str = "signal") -> Variable:
        """The variable that "component.variable" names."""
        component, _, rest = name.partition(".")
        self._known(component, where)
        return self.fmus[component].description.variable(rest, f"{where} '{name}'")

    def value(self, name: str) -> Any:
        """The start value of "component.variable": the system's, or else that of the FMU."""
        variable = self.variable(name)
        component = name.partition(".")[0]
        return self.values[component].get(variable.name, variable.start)

    def plan(
        self,
        stop: float | None = None,
        step: float | None = None,
        algorithm: str = "gauss_seidel",
        seed: int | None = None,
        faults: str | Path | Sequence[str | Path | Fault] | None = None,
        record: Sequence[str] | None = None,
        record_period: float | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> engine_plan.Plan:
        """The plan that an engine executes; the arguments are those of ``run``."""
        from navfmu.engine.component import Component
        from navfmu.engine.plan import Connection, make_plan

        stop, step = self._experiment(stop, step)
        start = self._start_values(parameters or {}, seed)
        components = [Component.of_fmu(name, fmu, start[name]) for name, fmu in self.fmus.items()]
        return make_plan(
            components,
            [Connection(*link) for link in self.links],
            step=step,
            stop=stop,
            algorithm=algorithm,
            record=self.signals(record),
            record_period=_default_period(stop, step) if record_period is None else record_period,
            faults=self.faults(faults),
            seed=1 if seed is None else seed,
        )

    def run(
        self,
        stop: float | None = None,
        step: float | None = None,
        algorithm: str = "gauss_seidel",
        seed: int | None = None,
        faults: str | Path | Sequence[str | Path | Fault] | None = None,
        record: Sequence[str] | None = None,
        record_period: float | None = None,
        parameters: Mapping[str, Any] | None = None,
        engine: str = "compiled",
        progress: Callable[[int, int], None] | None = None,
    ) -> pandas.DataFrame:
        """Run from 0 to ``stop`` (s) with the communication step ``step`` (s) and return the recording.

        ``seed`` goes to every component with a parameter of that name and to the faults. ``record`` names signals,
        arrays or bundles ("imu.reading"), patterns ("imu.*"), and values before faults ("imu.reading.rate[1]@true").
        ``parameters`` are laid over those of the system: ``{"imu.gyro_drift_sigma": "1 deg/h"}``. Without ``stop`` and
        ``step`` those of the system's default experiment are used. ``progress`` is called with the steps made and all
        steps a few times a second.

        The answer has the time (s) as index, one column for each signal, and in ``attrs`` the units, and what is
        needed to repeat the run.
        """
        if engine not in ENGINES:
            raise NavfmuError(
                f"unknown engine '{engine}'{nearest(engine, ENGINES)} (there are {' and '.join(ENGINES)})"
            )
        chosen = self.faults(faults)
        plan = self.plan(stop, step, algorithm, seed, chosen, record, record_period, parameters)
        return self.execute(plan, seed, parameters, chosen, engine, progress)

    def execute(
        self,
        plan: engine_plan.Plan,
        seed: int | None = None,
        parameters: Mapping[str, Any] | None = None,
        faults: Sequence[Fault] = (),
        engine: str = "compiled",
        progress: Callable[[int, int], None] | None = None,
    ) -> pandas.DataFrame:
        """Run a plan made by ``plan``; seed, parameters and faults are named again only for the record."""
        if engine == "reference":
            from navfmu.engine.reference import run
        else:
            from navfmu.engine.compiled import run
        recording = run(plan, progress)
        frame = as_frame(recording)
        frame.attrs["notes"] = [*plan.notes, *recording.warnings]
        frame.attrs["provenance"] = self._provenance(plan, seed, parameters or {}, faults, engine)
        return frame

    def faults(self, faults: str | Path | Sequence[str | Path | Fault] | None) -> list[Fault]:
        """Faults from files (also by their names inside the system's package), and those given as they are."""
        from navfmu.faults import load_faults

        given = [faults] if isinstance(faults, (str, Path)) else faults or ()
        found: list[Fault] = []
        for entry in given:
            found += load_faults(self.attachment("faults", entry)) if isinstance(entry, (str, Path)) else [entry]
        ids = [fault.id for fault in found]
        for fault in found:
            if ids.count(fault.id) > 1:
                raise NavfmuError(f"two faults have the id '{fault.id}'; give them different ones")
        return found

    def attachment(self, kind: str, name: str | Path) -> Path:
        """A file by path, or by its name among the package's own: ``extra/faults/gps_lost.toml`` by "gps_lost"."""
        path = Path(name)
        if path.exists():
            return path
        folder = self.structure.file.parent
        for place in (folder / "extra" / kind, folder / kind):
            for candidate in (place / path.name, place / f"{path.name}.toml"):
                if candidate.is_file():
                    return candidate
        if path.suffix in ("", ".toml") and path.parent == Path():
            known = [file.stem for place in (folder / "extra" / kind, folder / kind) for file in place.glob("*.toml")]
            have = f" (the system has: {', '.join(sorted(known))})" if known else ""
            raise NavfmuError(f"{kind}: there is no file '{name}'{nearest(path.stem, known)}{have}")
        return path

    def _provenance(
        self,
        plan: engine_plan.Plan,
        seed: int | None,
        parameters: Mapping[str, Any],
        faults: Sequence[Fault],
        engine: str,
    ) -> dict[str, Any]:
        """What is needed to repeat a run."""
        from navfmu.system.provenance import command, versions

        return {
            "system": str(self.structure.origin),
            "variant": self.variant,
            "digest": self.digest,
            "fmus": self.hashes(),
            "stop": plan.clock.time(plan.clock.steps),
            "step": plan.clock.step,
            "algorithm": plan.algorithm,
            "engine": engine,
            "seed": seed,
            "parameters": {name: _plain(value) for name, value in parameters.items()},
            "faults": [describe_fault(fault) for fault in faults],
            "versions": versions(),
            "command": command(),
        }

    # -- checks and defaults -------------------------------------------------------------------------------------

    def _refuse_connected(self, component: str, values: Mapping[str, Any], where: str) -> None:
        """A value for an input that another component feeds would do nothing; that is not left unsaid."""
        fed = {target: source for source, target, _, _ in self.links}
        for name in values:
            source = fed.get(f"{component}.{name}")
            if source is not None:
                raise NavfmuError(
                    f"{where}: '{name}' is connected to '{source}', so a value of its own would have no effect; "
                    "change the source, or let a fault act on it"
                )

    def _known(self, component: str, where: str) -> None:
        if component not in self.fmus:
            raise NavfmuError(f"{where}: there is no component '{component}'{nearest(component, self.fmus)}")

    def _experiment(self, stop: float | None, step: float | None) -> tuple[float, float]:
        stop = self.structure.stop_time if stop is None else stop
        step = self.structure.step if step is None else step
        for name, value in (("stop time", stop), ("step", step)):
            if value is None:
                raise NavfmuError(f"{self.structure.origin}: suggests no {name}; give one")
        return stop, step

    def _start_values(self, parameters: Mapping[str, Any], seed: int | None) -> dict[str, dict[str, Any]]:
        given: dict[str, dict[str, Any]] = {name: {} for name in self.fmus}
        for name, value in parameters.items():
            component, _, variable = name.partition(".")
            self._known(component, f"parameter '{name}'")
            where = f"parameter '{name}'"
            values = expand(self.fmus[component].description, {variable: value}, where)
            self._refuse_connected(component, values, where)
            given[component] |= values
        if seed is not None and not (isinstance(seed, Integral) and 0 <= seed < 2**31):
            raise NavfmuError(f"the seed is {seed!r}, expected a whole number from 0 to 2147483647")
        start = {}
        for name, fmu in self.fmus.items():
            start[name] = {**self.values[name]}
            own = fmu.description.by_name.get("seed")
            if seed is not None and own is not None and own.type == "Integer" and own.causality == "parameter":
                start[name]["seed"] = checked(fmu.description, own, seed, f"{name}, seed")
            start[name] |= given[name]
        return start

    def signals(self, record: Sequence[str] | None = None) -> list[str]:
        """Names to record: those given, where the name of a component stands for all its outputs.

        Without names: the outputs of the evaluation and the navigator, or else all outputs.
        """
        if record is not None:
            names = [record] if isinstance(record, str) else record
            return [f"{name}.*" if name in self.fmus else name for name in names]
        chosen = [name for name in NAVIGATION if name in self.fmus] or list(self.fmus)
        return [
            f"{name}.{variable.name}"
            for name in chosen
            for variable in self.fmus[name].description.variables
            if variable.causality == "output" and variable.type != "String"
        ]

    def _check_unconnected(self) -> None:
        fed = {target for _, target, _, _ in self.links}
        for name, fmu in self.fmus.items():
            for variable in fmu.description.variables:
                if variable.causality != "input" or f"{name}.{variable.name}" in fed:
                    continue
                if variable.start is None and variable.name not in self.values[name]:
                    raise NavfmuError(
                        f"{self.structure.file}: input '{name}.{variable.name}' is not connected and has no start "
                        "value; connect it or give it one in a parameter set"
                    )


def _open(component: Component, structure: Structure) -> Fmu:
    """Load a component's FMU; messages about a packed one name the package and not the folder it was unpacked to."""
    try:
        return load(component.source)
    except NavfmuError as error:
        folder = structure.file.parent
        if structure.origin in (folder, structure.file) or not component.source.is_relative_to(folder.resolve()):
            raise
        inside = component.source.relative_to(folder.resolve()).as_posix()
        raise NavfmuError(str(error).replace(str(component.source), f"{structure.origin}: {inside}")) from None


def as_frame(recording: Recording) -> pandas.DataFrame:
    """A recording with time (s) as index and units in ``attrs``; Booleans and Integers in their own types."""
    import numpy as np
    import pandas

    columns = {}
    for name, kind, values in zip(recording.names, recording.types, recording.values.T, strict=True):
        columns[name] = values != 0.0 if kind == "Boolean" else values.astype(np.int64) if kind == "Integer" else values
    frame = pandas.DataFrame(columns, index=pandas.Index(recording.time, name="time"))
    frame.attrs["units"] = dict(zip(recording.names, recording.units, strict=True))
    return frame


def describe_fault(fault: Fault) -> dict[str, Any]:
    """A fault as plain data; what is not limited (its duration) is left out."""
    fields = {"id": fault.id, "target": fault.target, "type": fault.type, "start": fault.start}
    if fault.duration != float("inf"):
        fields["duration"] = fault.duration
    return fields | ({"fmea": fault.fmea} if fault.fmea else {}) | {k: _plain(v) for k, v in fault.parameters.items()}


def _default_period(stop: float, step: float) -> float | None:
    """Every step if that gives at most ``ROWS`` rows, else the next of 0.1 s, 1 s, 10 s ... that is a multiple."""
    if not (isinstance(stop, Real) and isinstance(step, Real) and step > 0) or stop / step <= ROWS:
        return None
    period = 0.1
    while period < 1e9:
        count = round(period / step)
        if stop / period <= ROWS and count >= 1 and abs(count * step - period) <= 1e-9 * period:
            return period
        period = round(period * 10, 1)
    return None


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def _single(file: Path) -> Structure:
    fmu = load(file)
    about = fmu.description
    component = Component(about.model_identifier, file, {}, [], str(file), about.description)
    return Structure(
        about.model_name,
        about.description,
        file,
        file,
        {component.name: component},
        [],
        about.stop_time,
        about.step_size,
    )


def _check_connectors(component: Component, fmu: Fmu) -> None:
    for connector in component.connectors.values():
        where = f"{component.where}, connector '{connector.name}'"
        variable = fmu.description.variable(connector.name, where)
        if connector.type not in (None, variable.type) and (connector.type, variable.type) != (
            "Integer",
            "Enumeration",
        ):
            raise NavfmuError(f"{where}: is {connector.type}, but the FMU's variable is {variable.type}")
        if connector.kind in ("input", "output", "parameter") and connector.kind != variable.causality:
            raise NavfmuError(f"{where}: is an {connector.kind}, but the FMU's variable is {variable.causality}")
        if connector.unit is not None and variable.unit:
            conversion(_unit_of(fmu, variable), connector.unit, where)


def _unit_of(fmu: Fmu, variable: Variable) -> Unit | None:
    if not variable.unit or variable.type != "Real":
        return None
    return fmu.description.units.get(variable.unit) or Unit(variable.unit)


def _settings(component: Component, fmu: Fmu, ignored: list[str]) -> dict[str, Any]:
    """The values of a component in its own types and units; names that the FMU does not have are listed."""
    values: dict[str, Any] = {}
    for setting in component.settings:
        variable = fmu.description.by_name.get(setting.name)
        if variable is None:
            hint = nearest(setting.name, fmu.description.by_name)
            ignored.append(f"{setting.where}: '{component.name}' has no variable '{setting.name}'{hint}")
            continue
        where = f"{setting.where}: {component.name}"
        values[setting.name] = checked(fmu.description, variable, _converted(setting, fmu, variable, where), where)
    return values


def _converted(setting: Setting, fmu: Fmu, variable: Variable, where: str) -> Any:
    value = setting.value
    if variable.type == "Real" and not isinstance(value, (bool, str)):
        factor, offset = conversion(setting.unit, _unit_of(fmu, variable), f"{where}: '{variable.name}'")
        return setting.factor * (factor * value + offset) + setting.offset
    if (setting.factor, setting.offset) != (1.0, 0.0):
        return setting.factor * value + setting.offset
    return value


def _link(connection: Connection, structure: Structure, fmus: Mapping[str, Fmu]) -> tuple[str, str, float, float]:
    """Source, target and the one factor and offset that do all conversions of a connection."""
    where = f"{connection.where} {connection}"
    ends = []
    for component, name in (connection.start, connection.end):
        variable = fmus[component].description.variable(name, where)
        unit = _unit_of(fmus[component], variable)
        ends.append((variable, unit, structure.components[component].connectors[name].unit or unit))
    (source, source_unit, start_unit), (target, target_unit, end_unit) = ends
    if source.causality != "output" or target.causality != "input":
        raise NavfmuError(f"{where}: goes from {source.causality} to {target.causality}, expected output to input")
    steps = [conversion(source_unit, start_unit, where)]
    if connection.convert_units:
        steps.append(conversion(start_unit, end_unit, where))
    steps += [(connection.factor, connection.offset), conversion(end_unit, target_unit, where)]
    factor, offset = 1.0, 0.0
    for a, b in steps:
        factor, offset = a * factor, a * offset + b
    return ".".join(connection.start), ".".join(connection.end), factor, offset
